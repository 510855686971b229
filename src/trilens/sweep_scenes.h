// Which of a sweep's scenes have what its axes vary, and what is done about those that have not.
#pragma once

#include <vector>

#include "sweep/store/results.h"
#include "trilens/sweep_subjects.h"

namespace trilens {

/// What a plan needs to know of the point's scene. Throws as Subjects::facts does, InputError where nothing
/// in the scene could be swept: it has no optic, and no axis is its camera's facets.
const SubjectFacts& sweepable_facts(Subjects& subjects, const PointRequest& request);

/// The axes with camera-facets in the place of resolution, where the scene of `base` is a file without an
/// optic and its camera chooses its facets; said by `warn`. Else the axes as they are. Throws as
/// Subjects::facts does, UsageError for values that camera-facets cannot have.
SweepAxes axes_for_scene(const SweepAxes& axes, const PointRequest& base, Subjects& subjects,
                         const Warn& warn);

/// Takes the scenes out of an axis of scenes that lack what another axis varies (an optic, a camera, a place
/// in the file), each said by `warn`. Throws what is thrown for the first of them where none would be left,
/// and what load_scene throws for a scene that cannot be read whatever is varied.
std::vector<LeftOutScene> leave_out_scenes(SweepAxes& axes, const PointRequest& base, Subjects& subjects,
                                           const Warn& warn);

}  // namespace trilens
