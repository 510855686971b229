#include "inverse/fit/fit_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "json/schema.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

/// Of a large step of a parameter: for central differences. Places and tangents are linear in most
/// parameters; in the others what is left out is below 1e-9 of the derivative.
constexpr double kDifference = 1e-5;
constexpr std::size_t kPairsPerThread = 8;
constexpr double kLeastBend = 0.02;  // sigmas
/// Images near folds move so many times as far as the median image, for the same angle of their last rays.
constexpr double kFoldRate = 5;
constexpr double kFoldVariance = 1.25;  // of FoldWhitening: beyond is near a fold

/// How much of what changes in spreads is taken over: all, then less and less.
double settling_gain(int linearised) {
    constexpr int kAll = 10;
    return std::ldexp(1, std::min(0, kAll - linearised));
}

constexpr int kMostImageSteps = 40;
constexpr double kImageStep = 1e-7;       // pixels: Newton's last step, whose own error is its square
constexpr double kLongestImageStep = 50;  // pixels

Vec2 seen_offset(const std::array<Vec3, 2>& metric, const Vec3& offset) {
    return {dot(metric[0], offset), dot(metric[1], offset)};
}

/// The median of how fast images move, as far as it is known; else infinite.
double usual_rate_of(const std::vector<FitPair>& pairs) {
    std::vector<double> rates;
    for (const FitPair& pair : pairs)
        if (const double rate = fastest_motion(pair.metric).rate * pair.distance; rate > 0)
            rates.push_back(rate);
    return rates.empty() ? std::numeric_limits<double>::infinity() : median_of(std::move(rates));
}

/// Whether a pair's path is known, if only how many events it has.
bool knows_path(const FitPair& pair) {
    return pair.events > 0 || pair.word == "D";
}

/// Whether a ray's path begins with the pair's: the same optics, each reflecting or transmitting as before,
/// between the same media.
bool keeps_path(const ShotPath& path, const FitPair& pair) {
    if (path.events.size() < pair.events) return false;
    return std::equal(pair.path.begin(), pair.path.end(), path.events.begin(),
                      [](const OpticEvent& was, const OpticEvent& is) {
                          return was.optic == is.optic && was.reflects == is.reflects &&
                                 was.before == is.before && was.after == is.after;
                      });
}

}  // namespace

FitProblem::FitProblem(const Scene& scene, Json document, std::vector<FitParameter> parameters,
                       std::vector<FitPair> pairs)
    : maker_(scene),
      start_(document),
      document_(std::move(document)),
      parameters_(std::move(parameters)),
      pairs_(std::move(pairs)),
      scene_(maker_.make(document_, parameters_)) {}

LeastSquares FitProblem::least_squares() {
    LeastSquares problem;
    problem.unknowns = parameters_.size();
    problem.group = 2;
    problem.group_count = pairs_.size();
    problem.loss.threshold = huber;
    problem.linearise = [this] { return linearise(); };
    problem.residuals_after = [this](std::span<const double> step) { return residuals_after(step); };
    problem.accept = [this](std::span<const double> step) { move(step, document_, scene_); };
    return problem;
}

/// False where the moved document is no scene.
bool FitProblem::move(std::span<const double> step, Json& document, FitScene& scene) const {
    for (std::size_t i = 0; i < step.size(); ++i)
        if (step[i] != 0)
            move_parameter(part_of(document, parameters_[i]), parameters_[i], step[i] * parameters_[i].scale);
    if (find_problem(document, scene_schema_json())) return false;
    std::map<std::pair<ScenePart, std::size_t>, const FitParameter*> parts;
    for (const FitParameter& parameter : parameters_) parts[{parameter.part, parameter.index}] = &parameter;
    try {
        for (const auto& [key, parameter] : parts)
            maker_.set_part(scene, *parameter, part_of(document, *parameter), true);
    } catch (const InputError&) {
        return false;  // a camera at what it looks at, a flat mesh: the step is too long
    }
    ask_media(scene);
    return true;
}

std::vector<ParameterDifference> FitProblem::differences() const {
    std::vector<ParameterDifference> all;
    for (const FitParameter& parameter : parameters_) {
        ParameterDifference difference{scene_, scene_, kDifference * parameter.scale,
                                       parameter.part == ScenePart::kCamera};
        const auto put = [&](double amount, FitScene& scene) {
            Json part = part_of(document_, parameter);
            move_parameter(part, parameter, amount);
            maker_.set_part(scene, parameter, part, false);
        };
        put(-difference.step, difference.minus);
        put(difference.step, difference.plus);
        all.push_back(std::move(difference));
    }
    return all;
}

std::optional<ShotPath> FitProblem::shoot(const FitScene& scene, const FitPair& pair,
                                          const Vec2& pixel) const {
    return shoot_path(scene, pair.camera, pixel, pair.word);
}

/// Newton's method on the film: the ray through a place, and how its image of the point moves from there.
std::optional<FitProblem::Image> FitProblem::image_of(const FitScene& scene, const FitPair& pair) const {
    if (!knows_path(pair)) return std::nullopt;
    Image image{pair.guess, {}};
    const auto follow = [&](const Vec2& pixel) {
        std::optional<ShotPath> shot = shoot(scene, pair, pixel);
        return shot && keeps_path(*shot, pair) ? std::move(shot) : std::nullopt;
    };
    std::optional<ShotPath> path = follow(image.pixel);
    for (int k = 0; path && k < kMostImageSteps; ++k) {
        cut_path(*path, pair.events);
        const Vec3 nearest = nearest_on_last(*path, pair.point);
        const std::optional<PathDerivatives> derivatives =
            path_derivatives(scene, {pair.camera, image.pixel}, path->events, nearest, {});
        if (!derivatives) return std::nullopt;
        Vec2 step = seen_offset(derivatives->by_point, pair.point - nearest);
        const double size = length(step);
        if (size < kImageStep) {
            image.pixel += step;
            image.path = std::move(*path);
            return image;
        }
        if (size > kLongestImageStep) step *= kLongestImageStep / size;
        // A ray beside the optic: half of the step stays on it, or a half of that.
        std::optional<ShotPath> next;
        for (int half = 0; half < 8 && !next; ++half, step *= 0.5) {
            next = follow(image.pixel + step);
            if (next) image.pixel += step;
        }
        path = std::move(next);
    }
    return std::nullopt;
}

void FitProblem::take_path(FitPair& pair) const {
    std::optional<ShotPath> path = shoot(scene_, pair, pair.pixel);
    if (!path || path->events.empty()) return;
    pair.events = events_towards(*path, pair.point);
    cut_path(*path, pair.events);
    pair.guess = pair.pixel;
    pair.path = std::move(path->events);
}

/// Where the ray of a place on the film, over the pair's path, passes nearest to its point.
std::optional<Vec3> FitProblem::passes(const FitPair& pair, const Vec2& pixel) const {
    std::optional<ShotPath> path = shoot(scene_, pair, pixel);
    if (!path || !keeps_path(*path, pair)) return std::nullopt;
    cut_path(*path, pair.events);
    return nearest_on_last(*path, pair.point);
}

/// With its metric and distance. In the first part of a fit it holds images to kFoldRate, no more. In the
/// second it is that of rays at the places of a rule for means over the pixel's noise, if those a sigma away
/// along which images move most tell of a bend; rays that take another path are left out. It settles: it
/// changes with the parameters, and they with it.
FoldWhitening FitProblem::whitening_at(FitPair& pair, const Vec2& pixel) const {
    const FastestMotion motion = fastest_motion(pair.metric);
    const double most = std::pow(motion.rate * pair.distance / usual_rate_, 2);
    if (!(most > kFoldRate * kFoldRate)) return {};
    if (residual == FitResidual::kRay) return {motion.along, most / (kFoldRate * kFoldRate)};

    const std::optional<Vec3> here = passes(pair, pixel);
    if (!here) return {};
    const Vec2 along = motion.along, across(-along.y, along.x);
    const auto residual_at = [&](double z, double w) -> std::optional<double> {
        const std::optional<Vec3> there = passes(pair, pixel + pair.sigma * (z * along + w * across));
        if (!there) return std::nullopt;
        return dot(along, seen_offset(pair.metric, *there - *here)) / pair.sigma;
    };
    bool bends = pair.spread > 0;
    for (const double side : {-1.0, 1.0})
        bends |= std::abs(residual_at(side, 0).value_or(side) - side) > kLeastBend;
    if (!bends) return {};
    const double unit = std::pow(pair.sigma / motion.rate, 2);
    const double gain = pair.spread > 0 ? settling_gain(images_linearised_) : 1;
    pair.spread += gain * (normal_mean_square(residual_at) * unit - pair.spread);
    // Whatever it is, it leaves the image the weight of the median's.
    return {along, std::clamp(pair.spread / unit, 1.0, most)};
}

/// By the ray of its pixel; over the path that is known, if it is to be kept.
std::optional<PathDerivatives> FitProblem::linearise_ray(
    FitPair& pair, std::span<const ParameterDifference> parameters) const {
    std::optional<ShotPath> path = shoot(scene_, pair, pair.pixel);
    if (!path || (path->events.empty() && pair.word != "D")) return std::nullopt;
    const bool is_known = residual == FitResidual::kImage || keeps_paths;
    if (is_known && !keeps_path(*path, pair)) return std::nullopt;
    // A word says how many events there are.
    cut_path(*path, is_known            ? pair.events
                    : pair.word.empty() ? events_towards(*path, pair.point)
                                        : path->events.size());
    const Vec3 nearest = nearest_on_last(*path, pair.point);
    std::optional<PathDerivatives> derivatives =
        path_derivatives(scene_, {pair.camera, pair.pixel}, path->events, nearest, parameters);
    if (!derivatives) return std::nullopt;
    pair.guess = pair.pixel;
    pair.events = path->events.size();
    pair.path = std::move(path->events);
    pair.metric = derivatives->by_point;
    pair.distance = length(nearest - path->last.origin);
    pair.whitening = whitening_at(pair, pair.pixel);
    if (residual == FitResidual::kImage) pair.is_near_fold |= pair.whitening.variance > kFoldVariance;
    pair.off = pair.whitening.of(seen_offset(pair.metric, pair.point - nearest));
    for (Vec2& moved : derivatives->by_parameter) moved = pair.whitening.of(moved);
    return derivatives;
}

/// By the image of its point.
std::optional<PathDerivatives> FitProblem::linearise_image(
    FitPair& pair, std::span<const ParameterDifference> parameters) const {
    std::optional<Image> image = image_of(scene_, pair);
    if (!image) return std::nullopt;
    std::optional<PathDerivatives> derivatives =
        path_derivatives(scene_, {pair.camera, image->pixel}, image->path.events, pair.point, parameters);
    if (!derivatives) return std::nullopt;
    pair.guess = image->pixel;
    pair.path = std::move(image->path.events);
    pair.metric = derivatives->by_point;
    pair.distance = length(pair.point - image->path.last.origin);
    pair.whitening = whitening_at(pair, pair.guess);
    pair.is_near_fold = pair.whitening.variance > kFoldVariance;
    if (!pair.is_near_fold) pair.whitening = {}, pair.spread = 0;
    pair.off = pair.guess - pair.pixel;
    return derivatives;
}

/// In the second part a pair whose image lies near a fold, or is gone from there, is measured along its ray
/// from then on.
std::optional<PathDerivatives> FitProblem::linearise_either(
    FitPair& pair, std::span<const ParameterDifference> parameters) const {
    if (residual == FitResidual::kRay) {
        pair.is_near_fold = false;
        pair.spread = 0;
        return linearise_ray(pair, parameters);
    }
    if (pair.is_near_fold) return linearise_ray(pair, parameters);
    if (finds_paths && !knows_path(pair)) take_path(pair);
    if (!knows_path(pair)) return std::nullopt;
    std::optional<PathDerivatives> derivatives = linearise_image(pair, parameters);
    if (derivatives && !pair.is_near_fold) return derivatives;
    FitPair by_ray = pair;
    by_ray.spread = 0;
    std::optional<PathDerivatives> along = linearise_ray(by_ray, parameters);
    if (along && by_ray.is_near_fold) {
        pair = std::move(by_ray);
        return along;
    }
    // Its pixel's ray goes another way: by the image, which weighs less.
    pair.is_near_fold = false;
    if (derivatives) {
        pair.off = pair.whitening.of(pair.off);
        for (Vec2& moved : derivatives->by_parameter) moved = pair.whitening.of(moved);
    }
    return derivatives;
}

Vec2 FitProblem::linearise_pair(FitPair& pair, std::span<const ParameterDifference> parameters,
                                DenseMatrix& jacobian, std::size_t row) const {
    const std::optional<PathDerivatives> derivatives = linearise_either(pair, parameters);
    pair.is_lost = !derivatives;
    if (!derivatives) return Vec2(lost_residual(pair), 0);
    for (std::size_t p = 0; p < parameters_.size(); ++p)
        for (int axis = 0; axis < 2; ++axis)
            jacobian(row + static_cast<std::size_t>(axis), p) =
                derivatives->by_parameter[p][axis] * parameters_[p].scale / pair.sigma;
    return pair.off;
}

Linearisation FitProblem::linearise() {
    if (progress && progress->cancelled()) throw Interrupted();
    usual_rate_ = usual_rate_of(pairs_);
    const std::vector<ParameterDifference> parameters = differences();
    Linearisation at{{}, DenseMatrix(2 * pairs_.size() + priors.size(), parameters_.size())};
    at.residuals.resize(2 * pairs_.size());
    parallel_for(pairs_.size(), kPairsPerThread, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const Vec2 off = linearise_pair(pairs_[i], parameters, at.jacobian, 2 * i) / pairs_[i].sigma;
            at.residuals[2 * i] = off.x, at.residuals[2 * i + 1] = off.y;
        }
    });
    if (residual == FitResidual::kImage) ++images_linearised_;
    add_priors(document_, at.residuals);
    for (std::size_t k = 0; k < priors.size(); ++k)
        at.jacobian(2 * pairs_.size() + k, priors[k].parameter) =
            parameters_[priors[k].parameter].scale / priors[k].sigma;
    return at;
}

/// Of a step that loses the pair: of exact images, near the answer, no reward for it.
double FitProblem::lost_residual(const FitPair& pair) const {
    const double lost = lost_sigmas * pair.sigma;
    return pair.is_lost || residual == FitResidual::kRay ? lost : std::max(lost, length(pair.off));
}

std::optional<Vec2> FitProblem::trial_residual(const FitPair& pair, const FitScene& scene) const {
    if (residual == FitResidual::kImage && !pair.is_near_fold) {
        const std::optional<Image> image = image_of(scene, pair);
        return image ? std::optional(pair.whitening.of(image->pixel - pair.pixel)) : std::nullopt;
    }
    if (pair.is_lost) return std::nullopt;  // it has no metric to be measured in
    std::optional<ShotPath> path = shoot(scene, pair, pair.pixel);
    if (!path || path->events.size() < pair.events) return std::nullopt;
    cut_path(*path, pair.events);
    return pair.whitening.of(seen_offset(pair.metric, pair.point - nearest_on_last(*path, pair.point)));
}

std::optional<std::vector<double>> FitProblem::residuals_after(std::span<const double> step) {
    Json document = document_;
    FitScene scene = scene_;
    if (!move(step, document, scene)) return std::nullopt;
    std::vector<double> residuals(2 * pairs_.size());
    parallel_for(pairs_.size(), kPairsPerThread, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const double sigma = pairs_[i].sigma;
            const Vec2 off =
                trial_residual(pairs_[i], scene).value_or(Vec2(lost_residual(pairs_[i]), 0)) / sigma;
            residuals[2 * i] = off.x, residuals[2 * i + 1] = off.y;
        }
    });
    add_priors(document, residuals);
    return residuals;
}

void FitProblem::add_priors(const Json& document, std::vector<double>& residuals) const {
    for (const Prior& prior : priors)
        residuals.push_back((parameter_value(document, parameters_[prior.parameter], start_) - prior.value) /
                            prior.sigma);
}

}  // namespace trilens
