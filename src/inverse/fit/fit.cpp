#include "inverse/fit/fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/math/box.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/names.h"
#include "inverse/fit/fit_problem.h"
#include "inverse/solve/least_squares.h"
#include "render/world/world.h"
#include "scene/read/override.h"

namespace trilens {
namespace {

constexpr double kHighCorrelation = 0.95;
constexpr double kMuchNoise = 2;  // sigmas

std::size_t camera_named(const Scene& scene, const std::string& name) {
    if (name.empty()) return scene.own_camera;
    std::vector<std::string> names;
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
        if (scene.cameras[c].name == name || std::to_string(c) == name) return c;
        names.push_back(scene.cameras[c].name);
    }
    throw UsageError(fmt::format("there is no camera \"{}\"{}", name, suggestion(name, names)));
}

bool is_finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::vector<FitPair> prepare_pairs(const Scene& scene, std::span<const Correspondence> given,
                                   const FitRequest& request) {
    check_path_word(request.path);
    std::vector<FitPair> pairs;
    for (std::size_t i = 0; i < given.size(); ++i) {
        const Correspondence& from = given[i];
        if (!is_finite(from.point) || !is_finite(Vec3(from.pixel, from.sigma)) || from.sigma < 0)
            throw InputError("", fmt::format("pairs/{}", i), "is not finite, or has a negative sigma");
        FitPair pair;
        pair.pixel = pair.guess = from.pixel;
        pair.point = from.point;
        pair.sigma = from.sigma > 0 ? from.sigma : request.sigma;
        pair.word = from.path.empty() ? request.path : from.path;
        try {
            pair.camera = camera_named(scene, from.camera);
            check_path_word(pair.word);
            if (request.match == FitMatch::kId && from.image < 0)
                throw UsageError("names no image, which a match by id asks for");
        } catch (const UsageError& wrong) {
            if (from.place.empty()) throw UsageError(fmt::format("pair {}: {}", i, wrong.what()));
            throw InputError("", from.place, wrong.what());
        }
        pairs.push_back(std::move(pair));
    }
    return pairs;
}

/// How far the points and the cameras reach.
double extent_of(const Scene& scene, std::span<const FitPair> pairs) {
    Box box;
    for (const FitPair& pair : pairs) {
        box.include(pair.point);
        box.include(scene.cameras[pair.camera].eye);
    }
    const double extent = box.empty() ? 0 : length(box.high - box.low);
    return extent > 0 ? extent / 2 : 1;
}

std::vector<FitProblem::Prior> find_priors(const FitRequest& request, Json& document,
                                           const std::vector<FitParameter>& parameters,
                                           const std::string& file) {
    std::vector<FitProblem::Prior> found;
    for (const PriorValue& prior : request.priors) {
        const std::vector<std::string> pointer{prior.pointer};
        const std::vector<FitParameter> named = find_parameters(document, pointer, file, 1);
        if (!(prior.sigma > 0) || !std::isfinite(prior.sigma))
            throw InputError(file, prior.pointer, "a prior's sigma must be above 0");
        if (prior.values.size() != 1 && prior.values.size() != named.size())
            throw InputError(
                file, prior.pointer,
                fmt::format("a prior here needs 1 value or {}, not {}", named.size(), prior.values.size()));
        for (std::size_t k = 0; k < named.size(); ++k) {
            const auto free = std::find_if(parameters.begin(), parameters.end(),
                                           [&](const FitParameter& p) { return p.name == named[k].name; });
            if (free == parameters.end())
                throw InputError(file, named[k].name, "has a prior, but is not free");
            found.push_back({static_cast<std::size_t>(free - parameters.begin()),
                             prior.values[prior.values.size() == 1 ? 0 : k], prior.sigma});
        }
    }
    return found;
}

double rms_of(const std::vector<FitPair>& pairs, std::span<const double> residuals) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (pairs[i].is_lost) continue;
        sum += std::pow(residuals[2 * i] * pairs[i].sigma, 2) +
               std::pow(residuals[2 * i + 1] * pairs[i].sigma, 2);
        ++count;
    }
    return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

std::string events_of(const FitPair& pair) {
    if (pair.word == "D") return "D";
    std::string word;
    for (const OpticEvent& event : pair.path) word += event.reflects ? 'R' : 'T';
    return word;
}

/// The standard deviation in x and in y of residuals with these lengths, of which less than half are wrong:
/// the fixed point of the mean square within kNoiseCut of it, which of normal residuals is kNoiseShare of the
/// whole. `freedom`: how many numbers more there are than unknowns.
double noise_of(std::vector<double> lengths, double freedom) {
    constexpr double kNoiseCut = 3, kMedianLength = 1.1774100225154747;  // sqrt(2 ln 2)
    const double beyond = std::exp(-kNoiseCut * kNoiseCut / 2);
    const double share = 1 - kNoiseCut * kNoiseCut / 2 * beyond / (1 - beyond);
    if (lengths.empty() || !(freedom > 0)) return 0;
    std::sort(lengths.begin(), lengths.end());
    double noise = lengths[lengths.size() / 2] / kMedianLength;
    for (int k = 0; k < 100; ++k) {
        double squares = 0, count = 0;
        for (const double length : lengths)
            if (length <= kNoiseCut * noise) squares += length * length, ++count;
        const double last = std::exchange(noise, std::sqrt(squares / (2 * count * share)));
        if (std::abs(noise - last) <= 1e-12 * last) break;
    }
    return noise * std::sqrt(2 * static_cast<double>(lengths.size()) / freedom);
}

void tell_pairs(FitProblem& problem, const Linearisation& at, double huber, FitResult& result) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> lengths;  // in sigmas
    double variances = 0;
    for (std::size_t i = 0; i < problem.pairs().size(); ++i) {
        const FitPair& pair = problem.pairs()[i];
        FittedPair told{PairState::kLost, Vec2(none), events_of(pair)};
        if (!pair.is_lost) {
            told.residual = pair.sigma * Vec2(at.residuals[2 * i], at.residuals[2 * i + 1]);
            lengths.push_back(length(told.residual) / pair.sigma);
            variances += pair.sigma * pair.sigma;
            told.state = lengths.back() > huber ? PairState::kOutlier : PairState::kUsed;
        }
        result.used += told.state == PairState::kUsed;
        result.lost += told.state == PairState::kLost;
        result.outliers += told.state == PairState::kOutlier;
        result.pairs.push_back(std::move(told));
    }
    if (lengths.empty()) return;
    const auto count = static_cast<double>(lengths.size());
    const double stated = std::sqrt(variances / count);
    result.noise = stated * noise_of(std::move(lengths), 2 * count - static_cast<double>(result.rank));
    if (result.noise > kMuchNoise * stated)
        result.warnings.push_back(fmt::format(
            "the pixels' noise turned out to be {:.3g} px, and sigma says {:.3g}: the standard deviations "
            "that are told follow the latter, and so does what counts as an outlier",
            result.noise, stated));
}

void warn_of_pairs(double huber, FitResult& result) {
    const std::size_t count = result.pairs.size();
    if (result.lost > 0)
        result.warnings.push_back(
            fmt::format("{} of {} pairs are lost: their rays miss the optics, or their points "
                        "have no image near",
                        result.lost, count));
    if (2 * result.outliers > count)
        result.warnings.push_back(fmt::format(
            "{} of {} pairs are outliers, more than {:g} sigma from their images: what was found fits few of "
            "them, and its standard deviations hold for those alone; are points in the scene's unit, and "
            "pixels those of its film?",
            result.outliers, count, huber));
    else if (result.outliers > 0)
        result.warnings.push_back(
            fmt::format("{} of {} pairs are outliers, more than {:g} sigma from their images: they pull a "
                        "little all the same, of "
                        "which standard deviations know nothing; what is left out of the file pulls no more",
                        result.outliers, count, huber));
    constexpr double kNoRise = 1e-3;  // pixels
    if (result.rms > result.rms_start + kNoRise)
        result.warnings.push_back(fmt::format(
            "the rms rose, from {:.4g} to {:.4g} px: some pairs fit worse than before, or others are lost",
            result.rms_start, result.rms));
}

void tell_uncertainty(const FitProblem& problem, const Uncertainty& found, FitResult& result) {
    const std::vector<FitParameter>& parameters = problem.parameters();
    const std::size_t n = parameters.size();
    // What nothing fixes has no variance but rounding, and no correlations.
    constexpr double kNoVariance = 1e-18;  // of large steps: pixels tell of nothing so well
    DenseMatrix covariance = found.covariance;
    for (std::size_t i = 0; i < n; ++i)
        if (found.covariance(i, i) < kNoVariance)
            for (std::size_t j = 0; j < n; ++j) covariance(i, j) = covariance(j, i) = 0;
    const DenseMatrix correlation = correlations(covariance);
    result.covariance.assign(n, std::vector<double>(n));
    result.correlation = result.covariance;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
            result.covariance[i][j] = covariance(i, j) * parameters[i].scale * parameters[j].scale;
            result.correlation[i][j] = correlation(i, j);
            if (j < i && std::abs(correlation(i, j)) > kHighCorrelation)
                result.warnings.push_back(
                    fmt::format("{} and {} are correlated, {:.3f}: these pairs hardly separate "
                                "them",
                                parameters[j].name, parameters[i].name, correlation(i, j)));
        }
    for (std::size_t i = 0; i < n; ++i) result.parameters[i].sigma = std::sqrt(result.covariance[i][i]);
    result.rank = found.rank;
    result.null_vectors = found.null_vectors;
    for (const std::vector<double>& motion : found.null_vectors)
        result.undetermined.push_back(describe_motion(parameters, motion));
}

void tell_changes(const FitProblem& problem, FitResult& result) {
    for (const FitParameter& parameter : problem.parameters()) {
        const char* array = parameter.part == ScenePart::kCamera ? "/cameras/"
                            : parameter.part == ScenePart::kMesh ? "/meshes/"
                                                                 : "/materials/";
        const std::string pointer = array + std::to_string(parameter.index) + parameter.inside;
        const Json& value = part_of(problem.document(), parameter).at(Json::json_pointer(parameter.inside));
        if (result.changes.empty() || result.changes.back().pointer != pointer)
            result.changes.push_back({pointer, value.dump()});
    }
}

std::size_t lost_of(const std::vector<FitPair>& pairs) {
    return static_cast<std::size_t>(
        std::count_if(pairs.begin(), pairs.end(), [](const FitPair& pair) { return pair.is_lost; }));
}

bool all_lost(const std::vector<FitPair>& pairs) {
    return lost_of(pairs) == pairs.size();
}

/// What a lost pair counts for where exact images begin, of what it did until then: less near the answer, for
/// a pixel that noise moved beyond the edge of what can be seen is to be lost there, and must not hold all
/// others where it is not.
double lost_sigmas(const FitProblem& problem, const Linearisation& at) {
    constexpr double kLeast = 12, kOfMedian = 6;
    std::vector<double> lengths;
    for (std::size_t i = 0; i < problem.pairs().size(); ++i)
        lengths.push_back(std::hypot(at.residuals[2 * i], at.residuals[2 * i + 1]));
    return std::clamp(kOfMedian * median_of(std::move(lengths)), kLeast, problem.lost_sigmas);
}

}  // namespace

FitResult fit_scene(const Scene& scene, std::span<const Correspondence> given, const FitRequest& request,
                    const Progress& progress) {
    const std::string file = scene_title(scene);
    if (scene.resolved.empty())
        throw InputError(file, "", "a scene built in memory has no JSON whose numbers could be fitted");
    if (request.free.empty()) throw UsageError("a fit needs something that is free");
    if (!(request.sigma > 0) || !(request.huber > 0)) throw UsageError("sigma and huber are above 0");
    std::vector<FitPair> pairs = prepare_pairs(scene, given, request);
    Json document = resolved_json(scene);
    const std::vector<FitParameter> parameters =
        find_parameters(document, request.free, file, extent_of(scene, pairs));
    require_same_scene(scene, request.free);
    const std::vector<FitProblem::Prior> priors = find_priors(request, document, parameters, file);
    if (2 * pairs.size() + priors.size() < parameters.size())
        throw InputError(file, "",
                         fmt::format("{} pairs are too few for {} unknowns: each tells of two", pairs.size(),
                                     parameters.size()));

    FitProblem problem(scene, document, parameters, std::move(pairs));
    problem.priors = priors;
    problem.huber = request.huber;
    problem.finds_paths = request.match != FitMatch::kId;
    problem.progress = &progress;
    const std::vector<Media> began = media_of_pairs(problem.scene(), problem.pairs());
    FitResult result;
    LeastSquaresParams params;
    params.most_iterations = request.most_iterations;
    params.negligible_fall = 1e-6;  // squared standard deviations
    if (request.match != FitMatch::kRay) {
        match_images(*make_world(scene, {}), given, request.match, problem);
        problem.residual = FitResidual::kImage;
        result.rms_start = rms_of(problem.pairs(), problem.linearise().residuals);
        problem.residual = FitResidual::kRay;
        problem.keeps_paths = true;
    }
    const std::vector<FitPair> matched = problem.pairs();
    const Linearisation first = problem.linearise();
    if (request.match == FitMatch::kRay) {
        if (all_lost(problem.pairs()))
            throw ComputationError(
                "every pair is lost: no ray through a pixel meets the optics as its path says");
        result.rms_start = rms_of(problem.pairs(), first.residuals);
    }
    if (request.match == FitMatch::kRay || 2 * lost_of(problem.pairs()) < given.size()) {
        // The metric moves with the parameters: what is left is for the exact images.
        LeastSquaresParams rough = params;
        rough.step_tolerance = 1e-7, rough.cost_tolerance = 1e-3;
        result.iterations += minimise(problem.least_squares(), rough).iterations;
        problem.linearise();  // guesses and events of the end
    } else {
        problem.pairs() = matched;
    }

    problem.residual = FitResidual::kImage;
    problem.lost_sigmas = lost_sigmas(problem, problem.linearise());
    const LeastSquaresReport report = minimise(problem.least_squares(), params);
    result.iterations += report.iterations;
    result.converged = report.converged;
    const Linearisation last = problem.linearise();
    if (all_lost(problem.pairs()))
        throw ComputationError("every pair is lost: no point has an image near its pixel");

    for (const FitParameter& parameter : parameters)
        result.parameters.push_back({parameter.name, parameter_value(document, parameter, document),
                                     parameter_value(problem.document(), parameter, document), 0});
    const DenseMatrix weighted = reweighted(problem.least_squares(), last).jacobian;
    const Uncertainty unsure = uncertainty_of(weighted);
    tell_uncertainty(problem, unsure, result);
    tell_pairs(problem, last, request.huber, result);
    result.rms = rms_of(problem.pairs(), last.residuals);
    warn_of_pairs(request.huber, result);
    for (std::string& warning : leverage_warnings(weighted, unsure, problem.pairs()))
        result.warnings.push_back(std::move(warning));
    for (std::string& warning : media_warnings(scene, problem, began))
        result.warnings.push_back(std::move(warning));
    tell_changes(problem, result);
    result.document = problem.document().dump(2) + "\n";
    return result;
}

}  // namespace trilens
