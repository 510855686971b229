#include "sweep/plan/plan.h"

#include <cstddef>
#include <map>

#include "base/util/error.h"
#include "base/util/hash.h"

namespace trilens {
namespace {

// Part of every hash: raise it when what a run stores changes.
constexpr const char* kFormat = "trilens.sweep/3";

/// Hash of parts such that no two lists of parts read the same.
std::string hash_parts(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += std::to_string(part.size()) + ":" + part;
    return hash_text(text);
}

/// Optics whose names tell them apart from each other and from "all": where they do not, the object's id is
/// added.
std::vector<SweptOptic> distinct_optics(const std::vector<SweptOptic>& optics) {
    std::map<std::string, int> uses = {{"all", 1}};
    for (const SweptOptic& optic : optics) ++uses[optic.name];
    std::vector<SweptOptic> distinct = optics;
    for (SweptOptic& optic : distinct)
        if (uses[optic.name] > 1) optic.name += " #" + std::to_string(optic.object);
    return distinct;
}

PlannedRun planned_run(const SweepAxes& axes, const Coordinates& point, const RunKeys& keys) {
    PlannedRun run{point_id(axes, point), point, "", hash_parts({kFormat, "truth", keys.truth})};
    run.optics = distinct_optics(keys.optics);
    std::vector<std::string> parts = {kFormat, run.truth, keys.job};
    for (const SweptOptic& optic : run.optics) {
        parts.push_back(std::to_string(optic.object));
        parts.push_back(optic.name);
    }
    run.hash = hash_parts(parts);
    return run;
}

}  // namespace

std::vector<PlannedRun> make_plan(const SweepAxes& axes,
                                  const std::function<RunKeys(const Coordinates&)>& keys) {
    const std::vector<Coordinates> points = make_points(axes);
    std::map<std::string, const Coordinates*> names;
    for (const Coordinates& point : points) {
        const auto [known, is_new] = names.emplace(point_id(axes, point), &point);
        if (!is_new)
            throw UsageError("two points have one name, " + known->first + ": " + point_text(*known->second) +
                             "; and " + point_text(point));
    }
    std::vector<PlannedRun> plan;
    for (const Coordinates& point : points) plan.push_back(planned_run(axes, point, keys(point)));
    return plan;
}

}  // namespace trilens
