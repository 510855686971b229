#include "inverse/design/design.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/util/error.h"
#include "base/util/format.h"
#include "inverse/design/mirror_fit.h"
#include "inverse/solve/least_squares.h"

namespace trilens {

namespace {

/// Weights of the four control values around a place, and of its first and second derivatives; `t` in 0..1 of
/// the middle interval. Source: de Boor, A Practical Guide to Splines.
struct CubicWeights {
    std::array<double, 4> value{}, first{}, second{};
};

CubicWeights cubic_weights(double t) {
    const double s = 1 - t;
    return {{s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
             t * t * t / 6},
            {-s * s / 2, (3 * t * t - 4 * t) / 2, -(3 * s * s - 4 * s) / 2, t * t / 2},
            {s, 3 * t - 2, 3 * s - 2, t}};
}

}  // namespace

HeightField::HeightField(const Vec2& sides, const std::array<int, 2>& counts)
    : size(sides),
      controls(counts),
      heights(static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1])) {}

Vec2 HeightField::spacing() const {
    return {size.x / (controls[0] - 3), size.y / (controls[1] - 3)};
}

Vec2 HeightField::control_place(int column, int row) const {
    return Vec2(column - 1, row - 1) * spacing() - 0.5 * size;
}

HeightBasis HeightField::basis(const Vec2& at) const {
    const Vec2 step = spacing(), in = (at + 0.5 * size) / step;
    const int column = std::clamp(static_cast<int>(std::floor(in.x)), 0, controls[0] - 4),
              row = std::clamp(static_cast<int>(std::floor(in.y)), 0, controls[1] - 4);
    const CubicWeights across = cubic_weights(in.x - column), up = cubic_weights(in.y - row);
    HeightBasis result;
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t k = 4 * j + i;
            result.index[k] = (static_cast<std::size_t>(row) + j) * static_cast<std::size_t>(controls[0]) +
                              static_cast<std::size_t>(column) + i;
            result.z[k] = across.value[i] * up.value[j];
            result.x[k] = across.first[i] * up.value[j] / step.x;
            result.y[k] = across.value[i] * up.first[j] / step.y;
            result.xx[k] = across.second[i] * up.value[j] / (step.x * step.x);
            result.xy[k] = across.first[i] * up.first[j] / (step.x * step.y);
            result.yy[k] = across.value[i] * up.second[j] / (step.y * step.y);
        }
    return result;
}

Height HeightField::height(const Vec2& at) const {
    const HeightBasis b = basis(at);
    Height h;
    for (std::size_t k = 0; k < 16; ++k) {
        const double c = heights[b.index[k]];
        h.z += b.z[k] * c, h.x += b.x[k] * c, h.y += b.y[k] * c;
        h.xx += b.xx[k] * c, h.xy += b.xy[k] * c, h.yy += b.yy[k] * c;
    }
    return h;
}

double largest_curvature(const Height& h) {
    // First and second fundamental forms of a graph (do Carmo, section 3-3).
    const double e = 1 + h.x * h.x, f = h.x * h.y, g = 1 + h.y * h.y, w = std::sqrt(e * g - f * f);
    const double gauss = (h.xx * h.yy - h.xy * h.xy) / (w * w * w * w);
    const double mean = (e * h.yy - 2 * f * h.xy + g * h.xx) / (2 * w * w * w);
    return std::abs(mean) + std::sqrt(std::max(0.0, mean * mean - gauss));
}

namespace {

/// Of the anchor's row, over the rectangle's side: so heavy that nothing slides along the rays.
constexpr double kAnchorWeight = 1e4;
/// A step in heights, over the rectangle's side, after which the surface rests.
constexpr double kRests = 1e-9;
constexpr double kDifferenceShare = 1e-4;  // of the rectangle's side, for curls
/// 1 / side: a curl above this is told as a warning: about 0.06 degrees over a rectangle of side 1.
constexpr double kTellingCurl = 0.005;

/// Builds and solves one linear least squares problem for all heights.
class HeightSolver {
  public:
    HeightSolver(const DesignWish& wish, const HeightField& field)
        : wish_(wish), equations_(field.heights.size()) {
        add_fairness(field);
        const HeightBasis at = field.basis(wish.anchor);
        add(at, at.z, 0, std::pow(kAnchorWeight / side(), 2));
    }

    double side() const { return std::max(wish_.patch.size.x, wish_.patch.size.y); }

    void add(const HeightBasis& at, const std::array<double, 16>& coefficients, double value, double weight) {
        equations_.add(at.index, coefficients, value, weight);
    }
    std::vector<double> solve() const { return equations_.solve(); }

  private:
    /// Second differences of the control points in x and in y: changes of slope over the whole rectangle.
    void add_fairness(const HeightField& field) {
        const int columns = field.controls[0], rows = field.controls[1];
        const Vec2 step = field.spacing();
        const double weight = wish_.fairness / (static_cast<double>(columns) * rows);
        const auto index = [&](int column, int row) {
            return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(column);
        };
        const auto bend = [&](std::array<std::size_t, 3> three, double spacing) {
            const double scale = side() / (spacing * spacing);
            equations_.add(three, std::array<double, 3>{scale, -2 * scale, scale}, 0, weight);
        };
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < columns; ++column) {
                if (column + 2 < columns)
                    bend({index(column, row), index(column + 1, row), index(column + 2, row)}, step.x);
                if (row + 2 < rows)
                    bend({index(column, row), index(column, row + 1), index(column, row + 2)}, step.y);
            }
    }

    const DesignWish& wish_;
    NormalEquations equations_;
};

[[noreturn]] void fail_at_place(const DesignWish& wish, const Vec2& at, const char* why) {
    throw ComputationError(
        fmt::format("no {} sends the eye's ray at ({:.4g}, {:.4g}) of the rectangle as wished: {}",
                    optic_word(wish), at.x, at.y, why));
}

/// Takes the solver's heights; their largest change.
double take_heights(HeightSolver& solver, HeightField& field) {
    std::vector<double> heights = solver.solve();
    if (heights.empty())
        throw ComputationError(
            "the samples do not fix all control points: take more samples, fewer controls, or a "
            "fairness above 0");
    double change = 0;
    for (std::size_t i = 0; i < heights.size(); ++i)
        change = std::max(change, std::abs(heights[i] - field.heights[i]));
    field.heights = std::move(heights);
    return change;
}

/// One linear step; the largest change of a height.
double picard_step(const DesignWish& wish, const WishedRays& rays, std::span<const Vec2> samples,
                   HeightField& field) {
    HeightSolver solver(wish, field);
    const double weight = 1.0 / static_cast<double>(samples.size());
    for (const Vec2& at : samples) {
        const HeightBasis basis = field.basis(at);
        const NeededSlopes needed = needed_slopes(rays, Vec3(at, field.height(at).z));
        if (needed.refusal) fail_at_place(wish, at, needed.refusal);
        solver.add(basis, basis.x, needed.slopes.x, weight);
        solver.add(basis, basis.y, needed.slopes.y, weight);
    }
    return take_heights(solver, field);
}

/// Of the rays, their rows linear in the heights about the present ones.
double gauss_newton_step(const DesignWish& wish, const WishedRays& rays, std::span<const Vec2> samples,
                         HeightField& field) {
    HeightSolver solver(wish, field);
    const double weight = 1.0 / static_cast<double>(samples.size());
    for (const Vec2& at : samples) {
        const HeightBasis basis = field.basis(at);
        const Height now = field.height(at);
        const RayRows rows = ray_rows(rays, at, now, solver.side());
        for (int k = 0; k < 3; ++k) {
            std::array<double, 16> row{};
            for (std::size_t c = 0; c < 16; ++c)
                row[c] = rows.by_z[k] * basis.z[c] + rows.by_x[k] * basis.x[c] + rows.by_y[k] * basis.y[c];
            // residual + row . (new - now) = 0
            const double there = rows.by_z[k] * now.z + rows.by_x[k] * now.x + rows.by_y[k] * now.y;
            solver.add(basis, row, there - rows.residual[k], weight);
        }
    }
    return take_heights(solver, field);
}

double rms(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

/// How many places along each side tell of a surface: four times as many as samples and control points, of
/// many twice as many; and not those of the samples.
std::array<int, 2> check_counts(const DesignWish& wish) {
    constexpr int kManyChecks = 401;
    std::array<int, 2> counts{};
    for (std::size_t k = 0; k < 2; ++k) {
        const int most = std::max(wish.samples[k], wish.patch.controls[k]);
        counts[k] = std::max(2 * most + 1, std::min(4 * most + 1, kManyChecks));
    }
    return counts;
}

/// So many places, the rectangle's edges among them.
std::vector<Vec2> places_to_edges(const Vec2& size, const std::array<int, 2>& counts) {
    std::vector<Vec2> places;
    for (int row = 0; row < counts[1]; ++row)
        for (int column = 0; column < counts[0]; ++column)
            places.push_back((Vec2(column, row) / Vec2(counts[0] - 1, counts[1] - 1) - 0.5) * size);
    return places;
}

/// A surface that meets the samples with so many times less than what is left between them is told of, and
/// from so many degrees.
constexpr double kOverfitted = 3, kTellingError = 1e-4;

/// What is left between the samples, too.
void measure_rays(const DesignWish& wish, const WishedRays& rays, Design& design) {
    const auto error = [&](const Vec2& at) { return ray_error(rays, at, design.surface.height(at)); };
    std::vector<double> degrees;
    for (const Vec2& at : patch_samples(wish.patch.size, check_counts(wish))) degrees.push_back(error(at));
    design.errors = design_errors(std::move(degrees));
    for (const Vec2& at : places_to_edges(wish.patch.size, check_counts(wish)))
        design.errors.max = std::max(design.errors.max, error(at));
    const double at_samples = design_errors(design.error_map.values).mean;
    if (design.errors.mean > kTellingError && design.errors.mean > kOverfitted * at_samples)
        design.warnings.push_back(
            fmt::format("at its samples the surface is off by {:.3g} degrees in the mean, and by {:.3g} all "
                        "over: take more samples, or fewer control points",
                        at_samples, design.errors.mean));
}

/// What the surface is like, up to the rectangle's edges.
struct SurfaceExtent {
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest, curvature = 0;
};
SurfaceExtent extent_of(const DesignWish& wish, const HeightField& surface) {
    SurfaceExtent extent;
    for (const Vec2& at : places_to_edges(wish.patch.size, check_counts(wish))) {
        const Height h = surface.height(at);
        extent.lowest = std::min(extent.lowest, h.z), extent.highest = std::max(extent.highest, h.z);
        extent.curvature = std::max(extent.curvature, largest_curvature(h));
    }
    return extent;
}

/// What is told of the surface that was found.
void measure(const DesignWish& wish, const WishedRays& rays, std::span<const Vec2> samples, Design& design) {
    const double step = kDifferenceShare * std::max(wish.patch.size.x, wish.patch.size.y);
    design.error_map = design.curl_map = {wish.samples[0], wish.samples[1], {}};
    std::vector<double> flat;
    for (const Vec2& at : samples) {
        const Height h = design.surface.height(at);
        design.error_map.values.push_back(ray_error(rays, at, h));
        design.curl_map.values.push_back(slope_curl(rays, Vec3(at, h.z), step));
        flat.push_back(slope_curl(rays, Vec3(at, 0), step));
    }
    measure_rays(wish, rays, design);
    const auto [lowest, highest, curvature] = extent_of(wish, design.surface);
    design.curl = rms(design.curl_map.values);
    design.curl_flat = rms(flat);
    design.sag = highest - lowest;
    if (wish.lens) {
        design.back = -wish.lens->thickness;
        if (!(lowest > *design.back))
            throw ComputationError(fmt::format(
                "the front would cut the back: its lowest point is {:.4g} below the rectangle, and the lens "
                "{:.4g} thick",
                -lowest, wish.lens->thickness));
    }
    design.smallest_radius = 1 / curvature;
    if (design.curl * std::max(wish.patch.size.x, wish.patch.size.y) > kTellingCurl)
        design.warnings.push_back(
            fmt::format("no {} does what is wished: the slopes that it needs have a curl of "
                        "{:.3g} per unit of length (rms), and {:.3g} degrees are left in the mean",
                        optic_word(wish), design.curl, design.errors.mean));
}

}  // namespace

DesignErrors design_errors(std::vector<double> degrees) {
    DesignErrors errors;
    if (degrees.empty()) return errors;
    std::sort(degrees.begin(), degrees.end());
    for (const double one : degrees) errors.mean += one / static_cast<double>(degrees.size());
    errors.p95 = degrees[(degrees.size() - 1) * 95 / 100];
    errors.max = degrees.back();
    return errors;
}

Design design_mirror(const DesignWish& wish, const DesignRequest& request, const Progress& progress) {
    check_wish(wish);
    const WishedRays rays(wish);
    const std::vector<Vec2> samples = patch_samples(wish.patch.size, wish.samples);
    Design design;
    design.surface = HeightField(wish.patch.size, wish.patch.controls);
    const double rest = kRests * std::max(wish.patch.size.x, wish.patch.size.y);
    const auto iterate = [&](auto step, int most) {
        design.converged = false;
        for (int k = 0; k < most && !design.converged; ++k) {
            progress.stop_if_cancelled();
            design.converged = step(wish, rays, samples, design.surface) < rest;
            ++design.iterations;
        }
    };
    constexpr int kRoughSteps = 3;  // from which Gauss and Newton's method is at its goal in as many
    const bool is_picard = request.method == DesignMethod::kPicard;
    iterate(picard_step,
            is_picard ? request.most_iterations : std::min(kRoughSteps, request.most_iterations));
    if (!is_picard) iterate(gauss_newton_step, request.most_iterations);
    if (!all_finite(design.surface.heights)) throw ComputationError("the surface's heights are not finite");
    if (!design.converged)
        design.warnings.push_back(
            fmt::format("the surface still moves after {} iterations", design.iterations));
    measure(wish, rays, samples, design);
    if (request.compare_sphere) design.sphere = best_sphere(wish, rays, samples);
    return design;
}

}  // namespace trilens
