#include "trilens/sweep_scenes.h"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <string>
#include <utility>

#include "base/util/error.h"

namespace trilens {
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
        load_scene(request_at(base, {{"scene", scene}}));
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
