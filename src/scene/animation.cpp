#include "scene/animation.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "base/raymesh/sample_grid.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "json/schema.h"
#include "scene/animation/animation_keys.h"
#include "scene/load.h"
#include "scene/read/override.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

bool same_part(const Json& a, const Json& b, const char* key) {
    return a.contains(key) == b.contains(key) && (!a.contains(key) || a.at(key) == b.at(key));
}

/// Whether a light has an object, now or in the changed scene.
bool shows_lights(const Scene& scene, const Json& changed) {
    if (std::any_of(scene.lights.begin(), scene.lights.end(), is_visible)) return true;
    return changed.contains("lights") && changed.at("lights").size() != scene.lights.size();
}

/// Whether any mesh does.
bool depends_on_views(const Json& scene) {
    if (!scene.contains("meshes")) return false;
    const Json& meshes = scene.at("meshes");
    return std::any_of(meshes.begin(), meshes.end(),
                       [](const Json& mesh) { return mesh.contains("tolerance"); });
}

/// Reads what stands beside meshes, materials and background again, into a copy of `from`.
Scene with_cameras(const Scene& from, const Json& json, const TextureReader& textures) {
    const std::string title = scene_title(from);
    Reading reading(title, from.folder, textures);
    const Node root{json, "", reading.file};
    reading.scene = from;
    reading.scene.film = read_film(root);
    for (std::size_t i = 0; i < reading.scene.cameras.size(); ++i)
        reading.scene.cameras[i] = read_camera(root["cameras"][i], i, reading);
    reading.scene.lights.clear();
    read_lights(root, reading);
    reading.scene.render = read_render(root);
    return std::move(reading.scene);
}

AnimationInfo animation_info(const Json& animation) {
    AnimationInfo info;
    info.fps = animation.value("fps", info.fps);
    bool any = false;
    for (const Json& track : animation.at("tracks")) {
        ++info.tracks;
        for (const Json& key : track.at("keys")) {
            const double frame = key.at("frame").get<double>();
            info.first = any ? std::min(info.first, frame) : frame;
            info.last = any ? std::max(info.last, frame) : frame;
            any = true;
        }
    }
    return info;
}

}  // namespace

std::optional<AnimationInfo> find_animation(const Scene& scene) {
    if (scene.resolved.empty()) return std::nullopt;
    const Json json = resolved_json(scene);
    if (!json.contains("animation")) return std::nullopt;
    return animation_info(json.at("animation"));
}

Scene load_frame(const Scene& scene, double frame, std::span<const SceneOverride> changes,
                 const TextureReader& textures) {
    if (scene.resolved.empty())
        throw UsageError("a scene built in memory has no animation: change its values instead");
    if (!std::isfinite(frame)) throw UsageError("a frame is a finite number");
    const std::string title = scene_title(scene);
    const Json still = resolved_json(scene);
    Json json = still;
    apply_animation(json, frame, title);
    apply_overrides(json, changes, title);
    Scene next;
    if (json.at("cameras").size() == scene.cameras.size() && same_part(still, json, "meshes") &&
        !depends_on_views(json) && same_part(still, json, "materials") &&
        same_part(still, json, "background") &&
        (same_part(still, json, "lights") || !shows_lights(scene, json))) {
        if (const auto found = find_problem(json, scene_schema_json()))
            throw InputError(title, found->place, found->message);
        next = with_cameras(scene, json, textures);
    } else {
        next = load_scene_text(json.dump(), SceneSource(title, scene.folder), {}, textures);
        next.file = scene.file;
        next.folder = scene.folder;
        next.label = scene.label;
        // The scene file itself stands before what it names.
        for (auto read = scene.files.rbegin(); read != scene.files.rend(); ++read) {
            const auto known = std::find_if(next.files.begin(), next.files.end(),
                                            [&](const FileRead& one) { return one.path == read->path; });
            if (known == next.files.end()) next.files.insert(next.files.begin(), *read);
        }
        next.own_camera = std::min(scene.own_camera, next.cameras.size() - 1);
    }
    next.resolved = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    return next;
}

namespace {

/// Whether all that the camera has in the world is its lookAt.
bool turns_with_look_at(const CameraDescription& camera) {
    return std::visit(
        []<typename Kind>(const Kind& kind) {
            return kHasLookAt<Kind> && !requires {
                kind.travel;
            }
            &&!requires {
                kind.slits;
            }
            &&!requires {
                kind.placed_rays;
            }
            &&!requires {
                kind.views;
            };
        },
        camera.kind);
}

}  // namespace

std::vector<SceneOverride> turntable(const Scene& scene, std::size_t camera, int frame, int frames) {
    if (camera >= scene.cameras.size()) throw UsageError(fmt::format("there is no camera number {}", camera));
    if (frames < 1) throw UsageError(fmt::format("a turn takes at least one frame, not {}", frames));
    const CameraDescription& from = scene.cameras[camera];
    if (!turns_with_look_at(from))
        throw UsageError("the camera \"" + from.name + "\" (" + kind_name(from) +
                         ") does not turn with its lookAt alone: animate its values instead");
    const Vec3 axis = normalize_or_zero(from.up), arm = from.eye - from.at;
    if (!is_coordinate(from.eye) || !is_coordinate(from.at))
        throw UsageError("the camera \"" + from.name + "\" stands or looks where no number is");
    if (axis == Vec3(0)) throw UsageError("the camera \"" + from.name + "\" has no up axis to turn about");
    if (frame == 0) return {};
    const double angle = 2 * std::numbers::pi * frame / frames, c = std::cos(angle), s = std::sin(angle);
    // Rodrigues' formula.
    const Vec3 eye = from.at + c * arm + s * cross(axis, arm) + (1 - c) * dot(axis, arm) * axis;
    return {{fmt::format("/cameras/{}/lookAt/eye", camera), Json::array({eye.x, eye.y, eye.z}).dump()}};
}

namespace {

std::optional<int> integer(const std::string& text) {
    int value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end) return std::nullopt;
    return value;
}

}  // namespace

std::vector<int> parse_frames(const std::string& text) {
    const std::size_t dots = text.find("..");
    const auto first = integer(text.substr(0, dots)),
               last = dots == std::string::npos ? first : integer(text.substr(dots + 2));
    if (!first || !last) throw UsageError("frames are A..B, two whole numbers, not \"" + text + "\"");
    const long long count = std::llabs(static_cast<long long>(*last) - *first) + 1;
    if (count > kMostFrames)
        throw UsageError(fmt::format("{} are {} frames, more than {}", text, count, kMostFrames));
    std::vector<int> frames;
    for (int k = 0; k < count; ++k) frames.push_back(*first <= *last ? *first + k : *first - k);
    return frames;
}

std::string frame_file(const std::string& output, int frame) {
    const std::size_t first = output.find('#');
    if (first == std::string::npos)
        throw UsageError("the output \"" + output +
                         "\" of frames needs a place for their numbers: f.####.exr");
    std::size_t end = first;
    while (end < output.size() && output[end] == '#') ++end;
    if (output.find('#', end) != std::string::npos)
        throw UsageError("the output \"" + output + "\" has two places for a frame's number");
    return output.substr(0, first) +
           fmt::format("{}{:0{}}", frame < 0 ? "-" : "", std::llabs(frame), end - first) + output.substr(end);
}

}  // namespace trilens
