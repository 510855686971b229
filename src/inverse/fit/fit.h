// Calibration: parameters of a scene from pairs of pixels and world points that are seen there, over mirrors
// and through glass.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/util/error.h"
#include "scene/data/scene.h"
#include "scene/data/scene_inputs.h"

namespace trilens {

/// A pixel and the world point that is seen there.
struct Correspondence {
    Vec2 pixel{0};           // from the film's top left; a pixel's centre is at .5
    Vec3 point{0};           // world
    double sigma = 0;        // standard deviation of the pixel, in x and in y; 0: FitRequest::sigma
    std::string camera;      // its name, or its place among the cameras; empty: the scene's own
    std::string path;        // "R", "TT", "D" (direct): see FitRequest::path; empty: the request's
    int image = -1;          // FitMatch::kId: which of the images that project lists for the point, from 0
    std::string place = {};  // where it was read, file and line: what is wrong with it is told with that
};

/// Pairs of a text file: a header that names its columns, of x, y, X, Y, Z (pixel and world) and, if wanted,
/// sigma, camera, path and image, then a pair per line, separated by commas; without a header the five come
/// first. Empty lines and lines that begin with # are passed over. Throws InputError with file and line.
std::vector<Correspondence> read_correspondences(const std::string& file);
std::vector<Correspondence> parse_correspondences(const std::string& text, const std::string& name);

/// How a pair's pixel is told from the other images of its point. kRay: the ray through the pixel is
/// followed, and asks for no image. kNearest: over the optics of that image of the point which, in the scene
/// where the fit begins, lies nearest to the pixel. kId: of the one that the pair names.
enum class FitMatch { kRay, kNearest, kId };

/// A free number that is held near a value: its own residual (number - value) / sigma.
struct PriorValue {
    std::string pointer;         // one number's, or one of several
    std::vector<double> values;  // one for all of them, or one for each
    double sigma = 1;            // > 0
};

struct FitRequest {
    /// JSON pointers of what is unknown: a number, an array of numbers, or a mesh's quaternion
    /// transform/rotate, which turns about the world's axes. Only cameras, optics and their materials move
    /// images.
    std::vector<std::string> free = {};
    std::vector<PriorValue> priors = {};
    /// What happens at the optics that a ray meets, in order: R reflected, T transmitted, ? either; D:
    /// nothing, the point is seen directly. Empty: mirrors reflect, glass transmits.
    std::string path;
    FitMatch match = FitMatch::kRay;
    double huber = 8;    // sigmas of its pair from which a residual counts linearly; infinite: it never does
    double sigma = 0.5;  // pixels: of pairs that have none of their own
    int most_iterations = 100;
};

struct FittedParameter {
    std::string pointer;
    double start = 0, value = 0;  // of a turn: degrees about the axis, from where the fit began
    double sigma = 0;             // standard deviation; 0 where nothing fixes it
};

enum class PairState { kUsed, kLost, kOutlier };

/// "used", "lost", "outlier".
constexpr const char* pair_state_name(PairState state) {
    return state == PairState::kUsed ? "used" : state == PairState::kLost ? "lost" : "outlier";
}

/// A pair after the fit. Lost: its ray does not meet what the path says, or its point has no image near over
/// the optics that its ray meets. Outlier: it lies beyond FitRequest::huber.
struct FittedPair {
    PairState state = PairState::kUsed;
    Vec2 residual{0};  // pixels: image of the point minus pixel, near a fold less (see fit_scene); NaN: lost
    std::string path;  // its events, as FitRequest::path has them
};

struct FitResult {
    std::vector<FittedParameter> parameters;
    std::vector<std::vector<double>> covariance;   // of parameters, in their units, from the pairs' sigmas
    std::vector<std::vector<double>> correlation;  // of parameters, -1..1
    std::vector<FittedPair> pairs;                 // in order
    std::size_t used = 0, lost = 0, outliers = 0;
    double rms_start = 0, rms = 0;  // pixels, over pairs that are not lost: root of the mean of dx^2 + dy^2
    /// Pixels in x and in y: the standard deviation that residuals show, of pairs that are not lost. Robust:
    /// the median of their lengths to begin with, then the mean square of those within three of what it turns
    /// out to be, corrected for what lies beyond. Of pairs with sigmas of their own: the root mean square of
    /// those, times the factor that residuals show. 0: too few.
    double noise = 0;
    int iterations = 0;
    bool converged = false;
    std::size_t rank = 0;                           // below the number of parameters: see undetermined
    std::vector<std::string> undetermined;          // motions that no pair tells of, in words
    std::vector<std::vector<double>> null_vectors;  // the same: unit vectors of parameters in large steps
    std::vector<std::string> warnings;  // of correlated parameters, pairs, cameras, a rms that rose
    std::vector<SceneOverride> changes;             // what carries the scene's JSON to the fitted one
    std::string document;                           // the fitted scene's JSON
};

/// The parameters for which the images of all points lie nearest to their pixels, by Levenberg and Marquardt
/// with Huber's loss: first along the pixels' rays, then by the exact images; near folds along the rays to
/// the end, with the noise of a pixel there to second order. Objects hide nothing, and glass has its `ior`
/// for every colour. What cameras stand in is asked anew at each step, as pictures have it; the exact images
/// of the second part keep theirs, or are lost, and a camera that ends in other glass than it began in is
/// warned of. The same result for any number of threads.
///
/// Throws InputError for pointers that name no number, a scene without JSON (Scene::resolved), pairs that are
/// too few or not finite, cameras whose rays have no common eye and are not parallel; UsageError for cameras
/// and paths that there are not, and pairs without the image that FitMatch::kId asks for (InputError with the
/// place of pairs that have one); ComputationError where every pair is lost.
FitResult fit_scene(const Scene& scene, std::span<const Correspondence> pairs, const FitRequest& request,
                    const Progress& progress = {});

// A fit as one self-contained HTML page: parameters, correlations, and residuals over the film.

/// The residuals of all pairs as arrows over the film (an SVG document): from the pixel, `longer` times as
/// long as they are; outliers in another colour, lost pairs as crosses.
struct FitArrows {
    std::string svg;
    double longer = 1;
};
FitArrows residual_arrows(const Scene& scene, std::span<const Correspondence> pairs, const FitResult& result);

/// The page. `title`: of the scene.
std::string fit_html(const Scene& scene, std::span<const Correspondence> pairs, const FitResult& result);

}  // namespace trilens
