// One regression test: a folder with a scene, test.json and references, as data.
#pragma once

#include <string>
#include <vector>

#include "measure/compare.h"
#include "measure/displacement/displacement.h"
#include "measure/limits.h"

namespace trilens {

/// What a picture is held against: a stored picture, or one traced anew, through the exact surfaces or
/// through the facets of the picture's own resolution.
enum class Against { kGolden, kTruth, kFacets };

/// "golden", "truth", "facets".
std::string against_name(Against against);

/// Who makes the stored picture: the engine under test itself, ray tracing as above, or another program.
enum class ReferenceMaker { kRender, kTruth, kFacets, kElsewhere };

/// A value in the scene file, set before it is read: SceneOverride's fields.
struct SceneSetting {
    std::string pointer, value;  // JSON pointer and JSON text
};

struct RenderTest {
    std::string folder;
    std::string scene, reference;  // files; the folder's name is part of them
    std::vector<Against> against;  // at least one, each once
    ReferenceMaker reference_maker = ReferenceMaker::kRender;
    std::string engine = "exact";
    std::string camera;            // empty: the scene's own
    std::vector<int> resolutions;  // rising; empty: as the scene says. The last one's picture is judged
    std::vector<SceneSetting> set;
    CompareOptions compare;  // rules that the test does not ask for are out of reach
    double radius = DisplacementOptions{}.radius;
    std::vector<MetricLimit> max;
    std::vector<std::string> platforms, tags;  // no platforms: all
    std::string about;
};

/// Reads folder/test.json: strict JSON with comments; keys under "extras" or that start with "x-" are free.
/// `against` must be there; the others have defaults:
///   scene "scene.json", reference "ref/main.exr", reference_from "render" ("truth", "facets", "elsewhere"),
///   engine "exact", camera and resolution the scene's own, set {}, layer "" (the beauty), radius 64, tags
///   [], platforms [] fail, failpercent, failrelative, hardfail, allowfailures   compare's own where neither
///   these nor `max` are given;
///     else what is given and failpercent 0, failrelative 0, allowfailures 0, and no fail (0.004 beside
///     failpercent) and no hardfail
///   max {}   where it is empty, every layer of a stored picture of ours is held against the same layer (see
///     layer_rules.h). Else limits by metric: the names of metric_names() and, with several resolutions,
///     displacement_order
///   (also
///     reflect.displacement_order and refract.displacement_order), of which more is better
/// Throws InputError with the file and the place of the first problem, and the nearest known name.
RenderTest read_render_test(const std::string& folder);

/// What `max` may name.
std::vector<std::string> limited_names();

}  // namespace trilens
