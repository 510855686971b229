#include "inverse/fit/fit_problem.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "json/schema.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

/// The residual of a lost pair, in sigmas: constant, so that it pulls nowhere, and no reward for losing it.
constexpr double kLostResidual = 40;
/// Of a large step of a parameter: for central differences. Places and tangents are linear in most
/// parameters; in the others what is left out is below 1e-9 of the derivative.
constexpr double kDifference = 1e-5;
constexpr std::size_t kPairsPerThread = 8;

constexpr int kMostImageSteps = 40;
constexpr double kImageStep = 1e-7;       // pixels: Newton's last step, whose own error is its square
constexpr double kLongestImageStep = 50;  // pixels

Vec2 seen_offset(const std::array<Vec3, 2>& metric, const Vec3& offset) {
    return {dot(metric[0], offset), dot(metric[1], offset)};
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

Vec2 FitProblem::linearise_pair(FitPair& pair, std::span<const ParameterDifference> parameters,
                                DenseMatrix& jacobian, std::size_t row) const {
    pair.is_lost = true;
    Vec2 off(kLostResidual * pair.sigma, 0);
    std::optional<PathDerivatives> derivatives;
    if (residual == FitResidual::kRay) {
        std::optional<ShotPath> path = shoot(scene_, pair, pair.pixel);
        if (!path || (path->events.empty() && pair.word != "D")) return off;
        cut_path(*path, events_towards(*path, pair.point));
        const Vec3 nearest = nearest_on_last(*path, pair.point);
        derivatives = path_derivatives(scene_, {pair.camera, pair.pixel}, path->events, nearest, parameters);
        if (!derivatives) return off;
        off = seen_offset(derivatives->by_point, pair.point - nearest);
        pair.guess = pair.pixel;
        pair.events = path->events.size();
        pair.path = std::move(path->events);
    } else {
        if (finds_paths && !knows_path(pair)) take_path(pair);
        std::optional<Image> image = image_of(scene_, pair);
        if (!image) return off;
        derivatives =
            path_derivatives(scene_, {pair.camera, image->pixel}, image->path.events, pair.point, parameters);
        if (!derivatives) return off;
        off = image->pixel - pair.pixel;
        pair.guess = image->pixel;
        pair.path = std::move(image->path.events);
    }
    pair.is_lost = false;
    pair.metric = derivatives->by_point;
    for (std::size_t p = 0; p < parameters_.size(); ++p)
        for (int axis = 0; axis < 2; ++axis)
            jacobian(row + static_cast<std::size_t>(axis), p) =
                derivatives->by_parameter[p][axis] * parameters_[p].scale / pair.sigma;
    return off;
}

Linearisation FitProblem::linearise() {
    if (progress && progress->cancelled()) throw Interrupted();
    const std::vector<ParameterDifference> parameters = differences();
    Linearisation at{{}, DenseMatrix(2 * pairs_.size() + priors.size(), parameters_.size())};
    at.residuals.resize(2 * pairs_.size());
    parallel_for(pairs_.size(), kPairsPerThread, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const Vec2 off = linearise_pair(pairs_[i], parameters, at.jacobian, 2 * i) / pairs_[i].sigma;
            at.residuals[2 * i] = off.x, at.residuals[2 * i + 1] = off.y;
        }
    });
    add_priors(document_, at.residuals);
    for (std::size_t k = 0; k < priors.size(); ++k)
        at.jacobian(2 * pairs_.size() + k, priors[k].parameter) =
            parameters_[priors[k].parameter].scale / priors[k].sigma;
    return at;
}

std::optional<Vec2> FitProblem::trial_residual(const FitPair& pair, const FitScene& scene) const {
    if (residual == FitResidual::kImage) {
        const std::optional<Image> image = image_of(scene, pair);
        return image ? std::optional(image->pixel - pair.pixel) : std::nullopt;
    }
    if (pair.is_lost) return std::nullopt;  // it has no metric to be measured in
    std::optional<ShotPath> path = shoot(scene, pair, pair.pixel);
    if (!path || path->events.size() < pair.events) return std::nullopt;
    cut_path(*path, pair.events);
    return seen_offset(pair.metric, pair.point - nearest_on_last(*path, pair.point));
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
                trial_residual(pairs_[i], scene).value_or(Vec2(kLostResidual * sigma, 0)) / sigma;
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
