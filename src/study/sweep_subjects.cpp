#include "study/sweep_subjects.h"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <set>
#include <string>
#include <utility>

#include "base/description/digest.h"
#include "base/util/error.h"
#include "scene/data/scene_digest.h"

namespace trilens {
namespace {

/// Everything of a request that decides its scene and camera.
std::string key_of(const PointRequest& request) {
    std::string key = request.scene.file + "\n" + std::to_string(request.scene.resolution) + "\n" +
                      request.camera + "\n" + request.optic + "\n" + std::to_string(request.camera_facets) +
                      "\n";
    for (const SceneOverride& change : request.scene.overrides)
        key += change.pointer + "\n" + change.value + "\n" + (change.removes ? "-" : "+");
    for (const auto& [name, value] : request.of_optics) key += name + "\n" + value + "\n";
    return key;
}

SubjectFacts facts_of(const Scene& scene, const PointRequest& request) {
    const CameraDescription& camera = scene.cameras[find_camera(scene, request.camera)];
    SubjectFacts facts;
    facts.title = scene_title(scene);
    facts.camera = camera.name;
    facts.has_camera_facets = chooses_facets(camera);
    facts.digest = hash_text(scene.resolved + "\n" + scene_digest(scene));
    facts.film = scene.film;
    for (const FileRead& file : scene.files) facts.files.push_back(file.path);
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (scene.meshes[m].role != Role::kOptic) continue;
        facts.optics.push_back({static_cast<Id>(m), scene.meshes[m].name});
        facts.faces += std::max<std::size_t>(6, scene.meshes[m].face_count);
    }
    return facts;
}

}  // namespace

void Subjects::warn_once(const Scene& scene) {
    if (!warn_) return;
    for (const std::string& warning : scene.warnings)
        if (warned_.emplace(warning, true).second) warn_(warning);
}

const SubjectFacts& Subjects::facts(const PointRequest& request) {
    const std::string key = key_of(request);
    {
        const std::lock_guard guard(mutex_);
        const auto known = facts_.find(key);
        if (known != facts_.end()) return known->second;
    }
    const Scene scene = load_point_scene(request);
    SubjectFacts facts = facts_of(scene, request);
    const std::lock_guard guard(mutex_);
    warn_once(scene);
    return facts_.emplace(key, std::move(facts)).first->second;
}

std::vector<std::string> Subjects::files() {
    const std::lock_guard guard(mutex_);
    std::set<std::string> files;
    for (const auto& [key, facts] : facts_) files.insert(facts.files.begin(), facts.files.end());
    return {files.begin(), files.end()};
}

std::shared_ptr<const LoadedSubject> Subjects::load(const PointRequest& request) {
    const std::string key = key_of(request);
    std::shared_ptr<Slot> slot;
    {
        const std::lock_guard guard(mutex_);
        const auto known =
            std::ranges::find(slots_, key, &std::pair<std::string, std::shared_ptr<Slot>>::first);
        slot = known == slots_.end() ? std::make_shared<Slot>() : known->second;
        if (known != slots_.end()) slots_.erase(known);
        slots_.push_front({key, slot});
        while (slots_.size() > kept_) slots_.pop_back();
    }
    // One makes it, the others wait for it; other scenes are made meanwhile.
    const std::lock_guard guard(slot->making);
    if (slot->subject) return slot->subject;
    Scene scene = load_point_scene(request);
    const std::size_t camera = find_camera(scene, request.camera);
    const Stopwatch watch;
    std::unique_ptr<const World> world = make_checked_world(std::move(scene), {});
    slot->subject =
        std::make_shared<const LoadedSubject>(LoadedSubject{std::move(world), camera, watch.seconds()});
    return slot->subject;
}

namespace {

Axis* find_axis(SweepAxes& axes, const std::string& name) {
    const auto found = std::ranges::find(axes.axes, name, [](const Axis& axis) { return axis.kind.name; });
    return found == axes.axes.end() ? nullptr : &*found;
}

/// The first reason why a point of this scene cannot be drawn; null where all can.
std::exception_ptr obstacle(const SweepAxes& axes, const AxisValue& scene, const PointRequest& base,
                            Subjects& subjects) {
    for (const Coordinates& point : make_points(axes)) {
        if (*find_coordinate(point, "scene") != scene) continue;
        try {
            sweepable_facts(subjects, request_at(base, point));
        } catch (const InputError&) {
            return std::current_exception();
        } catch (const UsageError&) {
            return std::current_exception();
        }
    }
    return nullptr;
}

std::string reason_of(const std::exception_ptr& error) {
    try {
        std::rethrow_exception(error);
    } catch (const Error& known) {
        return known.what();
    }
}

/// Without the i-th value; zipped axes lose the one beside it.
void remove_value(SweepAxes& axes, const Axis& from, std::size_t i) {
    for (Axis& axis : axes.axes)
        if (&axis == &from || axes.zip)
            axis.values.erase(axis.values.begin() + static_cast<std::ptrdiff_t>(i));
}

}  // namespace

const SubjectFacts& sweepable_facts(Subjects& subjects, const PointRequest& request) {
    const SubjectFacts& facts = subjects.facts(request);
    if (facts.optics.empty() && request.camera_facets == 0)
        throw InputError(
            facts.title, "/meshes",
            std::string("a sweep needs an optic whose resolution it can vary") +
                (facts.has_camera_facets ? "; the camera's facets are the axis camera-facets" : ""));
    return facts;
}

SweepAxes axes_for_scene(const SweepAxes& axes, const PointRequest& base, Subjects& subjects,
                         const Warn& warn) {
    SweepAxes fitting = axes;
    Axis* const resolution = find_axis(fitting, "resolution");
    if (!resolution || find_axis(fitting, "camera-facets") || find_axis(fitting, "scene") || base.loaded)
        return axes;
    const SubjectFacts& facts = subjects.facts(request_at(base, make_points(axes).at(0)));
    if (!facts.optics.empty() || !facts.has_camera_facets) return axes;
    AxisRequest values{"camera-facets", {}};
    for (const AxisValue& value : resolution->values) values.values.push_back(value.text);
    *resolution = make_axis(find_axis_kind("camera-facets", facts.title), values, facts.title, axes.zip);
    if (warn)
        warn(facts.title + ": has no optic: the facets of its camera \"" + facts.camera +
             "\" are swept (camera-facets) in the place of resolution");
    return fitting;
}

std::vector<LeftOutScene> leave_out_scenes(SweepAxes& axes, const PointRequest& base, Subjects& subjects,
                                           const Warn& warn) {
    std::vector<LeftOutScene> left_out;
    Axis* const scenes = find_axis(axes, "scene");
    if (!scenes) return left_out;
    std::exception_ptr first;
    const SweepAxes all = axes;
    for (const AxisValue& scene : find_axis(axes, "scene")->values) {
        const std::exception_ptr error = obstacle(all, scene, base, subjects);
        if (!error) continue;
        if (!first) first = error;
        // What cannot be read at all is no matter of the axes.
        load_point_scene(request_at(base, {{"scene", scene}}));
        left_out.push_back({scene.text, reason_of(error)});
    }
    if (left_out.size() == scenes->values.size()) std::rethrow_exception(first);
    for (const LeftOutScene& one : left_out) {
        const auto at = std::ranges::find(scenes->values, one.scene, &AxisValue::text);
        remove_value(axes, *scenes, static_cast<std::size_t>(at - scenes->values.begin()));
        if (warn) warn("left out of the sweep: " + one.reason);
    }
    return left_out;
}

}  // namespace trilens
