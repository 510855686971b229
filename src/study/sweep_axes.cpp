#include "study/sweep.h"

#include <cmath>
#include <filesystem>

#include "base/util/error.h"
#include "base/util/names.h"

namespace trilens {
namespace {

using Apply = void (*)(const AxisValue& value, PointRequest& request);

struct AxisEntry {
    AxisKind kind;
    Apply apply;
};

double number_of(const AxisValue& value) {
    if (!value.number) throw UsageError("the value \"" + value.text + "\" stands for no number");
    return *value.number;
}

int whole(const AxisValue& value) {
    const double number = number_of(value);
    if (!(std::fabs(number) <= 1e9)) throw UsageError("the value \"" + value.text + "\" is too large");
    return static_cast<int>(number);
}

template <typename E>
E named(const AxisValue& value) {
    if (const std::optional<E> found = find_named<E>(value.text)) return *found;
    throw UsageError("the value \"" + value.text + "\" is none of the axis" +
                     suggestion(value.text, names_of<E>()));
}

void override_with(const std::string& pointer, const std::string& value, PointRequest& request) {
    request.scene.overrides.push_back({.pointer = pointer, .value = value, .set_by = "--over"});
}

/// The classic engine with K pieces; an axis of engines may still say another.
void set_pieces(Curves curves, const AxisValue& value, PointRequest& request) {
    request.picture.engine.engine = Engine::kClassic;
    request.picture.engine.classic.curves = curves;
    request.picture.engine.classic.pieces = whole(value);
}

void set_size(const AxisValue& value, PointRequest& request) {
    const std::size_t x = value.text.find('x');
    override_with("/film/width", value.text.substr(0, x), request);
    override_with("/film/height", value.text.substr(x + 1), request);
}

void set_clip(const AxisValue& value, PointRequest& request) {
    request.picture.engine.engine = Engine::kClassic;
    request.picture.engine.classic.clip = named<Clip>(value);
}

void set_rays(const AxisValue& value, PointRequest& request) {
    request.picture.frame.rays = named<CornerRays>(value);
}

void set_grid(const AxisValue& value, PointRequest& request) {
    request.picture.frame.grid = named<GridKind>(value);
}

void set_scene(const AxisValue& value, PointRequest& request) {
    const std::filesystem::path file = value.text;
    request.scene.file =
        file.is_absolute() ? value.text : (std::filesystem::path(request.paths_start_here) / file).string();
}

/// With what the camera sees itself, so that its displacement is measured.
void set_camera_facets(const AxisValue& value, PointRequest& request) {
    request.camera_facets = whole(value);
    std::vector<std::string>& layers = request.picture.layers.layers;
    if (layers.empty()) layers = {"Z", "optic", "direct", "reflect", "refract"};
    layers.push_back("position");
}

constexpr auto kWhole = ValueKind::kWhole;

/// One line per axis. A setting that scenes have for every optic is an axis by pushing its key and value to
/// PointRequest::of_optics.
const std::vector<AxisEntry>& axis_entries() {
    static const std::vector<AxisEntry> entries = {
        {{"scene", "", "scene", ValueKind::kText}, set_scene},
        {{"optic", "", "optic", ValueKind::kText}, [](const auto& v, auto& r) { r.optic = v.text; }},
        {{"camera", "", "camera", ValueKind::kText}, [](const auto& v, auto& r) { r.camera = v.text; }},
        {{"engine", "", "engine", ValueKind::kWord, 0, 0, false, engine_names()},
         [](const auto& v, auto& r) { r.picture.engine.engine = find_engine(v.text); }},
        {{"resolution", "n", "resolution n [n × n facets per cage face]", kWhole, 1, kMaxResolution, true},
         [](const auto& v, auto& r) { r.picture.frame.resolution = whole(v); }},
        {{"camera-facets", "f", "N [N × N facets of the camera]", kWhole, 1, kMostCameraFacets, true},
         set_camera_facets},
        {{"tessellate", "tessellate", "K [K × K smaller triangles]", kWhole, 1, 1024, true},
         [](const auto& v, auto& r) { set_pieces(Curves::kTessellate, v, r); }},
        {{"slices", "slices", "K [pieces of a curved edge]", kWhole, 1, 1024, true},
         [](const auto& v, auto& r) { set_pieces(Curves::kSlices, v, r); }},
        {{"clip", "", "clipping", ValueKind::kWord, 0, 0, false, names_of<Clip>()}, set_clip},
        {{"rays", "", "corner rays", ValueKind::kWord, 0, 0, false, names_of<CornerRays>()}, set_rays},
        {{"grid", "", "facets' grid", ValueKind::kWord, 0, 0, false, names_of<GridKind>()}, set_grid},
        {{"max-error", "px", "largest predicted error [px]", ValueKind::kNumber, 0, 1000},
         [](const auto& v, auto& r) { r.picture.frame.max_error = number_of(v); }},
        {{"size", "", "pixels", ValueKind::kSize, 1, kMostPixels, true, {}, kMostFilmSide}, set_size},
        {{"spp", "spp", "samples per pixel, across", kWhole, 1, kMaxSpp},
         [](const auto& v, auto& r) { override_with("/film/spp", v.text, r); }},
        {{"max-depth", "depth", "optic hits after the first", kWhole, 0, kMostDepth},
         [](const auto& v, auto& r) { override_with("/render/maxDepth", v.text, r); }},
    };
    return entries;
}

const AxisEntry* find_entry(const std::string& name) {
    for (const AxisEntry& entry : axis_entries())
        if (entry.kind.name == name) return &entry;
    return nullptr;
}

/// Where the other optics of a scene stand in the file, the last first.
std::vector<SceneOverride> without_other_optics(const Scene& scene, const std::string& optic) {
    std::vector<SceneOverride> removals;
    std::vector<std::string> names;
    for (std::size_t m = scene.meshes.size(); m-- > 0;) {
        if (scene.meshes[m].role != Role::kOptic) continue;
        names.push_back(scene.meshes[m].name);
        if (names.back() != optic) removals.push_back({"/meshes/" + std::to_string(m), "", true});
    }
    if (removals.size() == names.size())
        throw InputError(scene.file, "/meshes",
                         "there is no optic \"" + optic + "\"" + suggestion(optic, names));
    return removals;
}

/// The camera's facets in the place of its facets or tolerance.
std::vector<SceneOverride> with_camera_facets(const PointRequest& request, const Scene& scene) {
    const std::size_t index = find_camera(scene, request.camera);
    const CameraDescription& camera = scene.cameras[index];
    const std::string place = "/cameras/" + std::to_string(index);
    if (!chooses_facets(camera))
        throw InputError(scene.file, place,
                         "\"" + camera.name + "\" is " + kind_name(camera) +
                             ": the axis camera-facets is for cameras that choose their own");
    std::vector<SceneOverride> changes;
    if (camera.tolerance > 0) changes.push_back({place + "/tolerance", "", true});
    changes.push_back({place + "/facets", std::to_string(request.camera_facets)});
    return changes;
}

/// The scene with the changes that have to know it first.
Scene load_changed(const PointRequest& request, const std::vector<SceneOverride>& removals) {
    SceneRequest changed = request.scene;
    changed.overrides.insert(changed.overrides.end(), removals.begin(), removals.end());
    Scene scene = load_scene(changed);
    std::vector<SceneOverride> changes;
    if (request.camera_facets > 0) changes = with_camera_facets(request, scene);
    for (std::size_t m = 0; m < scene.meshes.size(); ++m)
        for (const auto& [key, value] : request.of_optics)
            if (scene.meshes[m].role == Role::kOptic)
                changes.push_back({"/meshes/" + std::to_string(m) + "/" + key, value});
    if (changes.empty()) return scene;
    changed.overrides.insert(changed.overrides.end(), changes.begin(), changes.end());
    return load_scene(changed);
}

}  // namespace

std::vector<AxisKind> axis_kinds() {
    std::vector<AxisKind> kinds;
    for (const AxisEntry& entry : axis_entries()) kinds.push_back(entry.kind);
    return kinds;
}

AxisKind find_axis_kind(const std::string& name, const std::string& where) {
    if (!name.empty() && name[0] == '/') return pointer_kind(name);
    // As the tables of results call it.
    if (const AxisEntry* entry = find_entry(name == "tessellation" ? "tessellate" : name)) return entry->kind;
    std::vector<std::string> names;
    for (const AxisEntry& entry : axis_entries()) names.push_back(entry.kind.name);
    throw UsageError(where + ": unknown axis \"" + name + "\"" + suggestion(name, names) +
                     "; a JSON pointer into the scene, such as /materials/0/ior, is one too");
}

PointRequest request_at(PointRequest request, const Coordinates& point) {
    // The engine last: slices and their like only propose one.
    const AxisValue* engine = nullptr;
    for (const Coordinate& one : point) {
        if (one.axis == "engine") engine = &one.value;
        const AxisEntry* const entry = find_entry(one.axis);
        if (entry)
            entry->apply(one.value, request);
        else
            override_with(one.axis, one.value.text, request);
    }
    if (engine) find_entry("engine")->apply(*engine, request);
    return request;
}

Scene load_point_scene(const PointRequest& request) {
    const bool changes = !request.optic.empty() || !request.of_optics.empty() || request.camera_facets > 0;
    if (request.loaded && request.scene.file.empty()) {
        if (!request.scene.overrides.empty() || changes)
            throw UsageError("an axis that changes the scene's text needs a scene file");
        return *request.loaded;
    }
    if (!changes) return load_scene(request.scene);
    if (request.optic.empty()) return load_changed(request, {});
    return load_changed(request, without_other_optics(load_scene(request.scene), request.optic));
}

}  // namespace trilens
