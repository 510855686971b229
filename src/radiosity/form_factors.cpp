#include "radiosity/form_factors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/raymesh/triangle_corners.h"
#include "base/util/check.h"
#include "base/util/parallel.h"
#include "projector/projector.h"
#include "shade/lights/light_sample.h"

namespace trilens {
namespace {

constexpr double kTurn = 2.39996322972865332;  // the golden angle: no two hemicubes of a few stand alike
constexpr int kMostScalings = 1000;
// Scaling ends where this many steps bring its worst row less than this share nearer: then no scaling fits.
constexpr int kScalingsLooked = 20;
constexpr double kLeastGain = 0.01;

/// Evenly spread places on a triangle.
Vec3 spread_weights(std::size_t i) {
    Vec2 place = recurrent_place(i);
    if (place.x + place.y > 1) place = Vec2(1) - place;
    return {1 - place.x - place.y, place.x, place.y};
}

double row_sum(const FormFactorRow& row) {
    double sum = 0;
    for (const double factor : row.factor) sum += factor;
    return sum;
}

}  // namespace

std::vector<Vec3> middles_of_parts(int n) {
    std::vector<Vec3> middles;
    for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
            const double x = i + 1.0 / 3, y = j + 1.0 / 3;
            middles.push_back(Vec3(n - x - y, x, y) / double(n));
            if (i + j + 1 < n)
                middles.push_back(Vec3(n - x - y - 2.0 / 3, x + 1.0 / 3, y + 1.0 / 3) / double(n));
        }
    return middles;
}

std::vector<double> triangle_areas(const TriangleScene& scene) {
    std::vector<double> areas;
    for (Id t = 0; t < scene.size(); ++t) {
        const std::array<Vec3, 3> corner = corners_of(scene, t);
        areas.push_back(
            has_no_area(corner) ? 0 : 0.5 * length(cross(corner[1] - corner[0], corner[2] - corner[0])));
    }
    return areas;
}

FormFactors::FormFactors(std::shared_ptr<const TriangleScene> scene, const FormFactorParams& params)
    : scene_(std::move(scene)), params_(params), hemicube_(params.resolution) {
    for (Id t = 0; t < scene_->size(); ++t) {
        const std::array<Vec3, 3> corner = corners_of(*scene_, t);
        normals_.push_back(has_no_area(corner)
                               ? Vec3(0)
                               : normalize_or_zero(cross(corner[1] - corner[0], corner[2] - corner[0])));
    }
    if (params_.method == FormFactorMethod::kHemicube)
        prepared_.emplace(*scene_);
    else
        tracer_.emplace(scene_);
}

HemicubePlace FormFactors::place_of(Id side, const Vec3& weights) const {
    const Id triangle = side / 2;
    const std::array<Vec3, 3> corner = corners_of(*scene_, triangle);
    HemicubePlace place;
    place.normal = side % 2 == 0 ? normals_[triangle] : -normals_[triangle];
    place.origin =
        weights.x * corner[0] + weights.y * corner[1] + weights.z * corner[2] + params_.offset * place.normal;
    const auto [first, second] = tangent_basis(place.normal);
    const double angle = kTurn * static_cast<double>(side);
    place.tangent = std::cos(angle) * first + std::sin(angle) * second;
    return place;
}

Id FormFactors::side_seen(Id triangle, const Vec3& from) const {
    const Vec3& on_it = scene_->points[scene_->triangles[triangle][0]];
    return side_of(triangle, dot(normals_[triangle], from - on_it) < 0);
}

template <typename Add>
void FormFactors::for_each_pixel(const HemicubePlace& place, const Add& add) const {
    std::vector<Visible> visible(hemicube_.grid().size());
    find_visible(*prepared_, hemicube_.mesh(place), hemicube_.owned(), hemicube_.grid(), visible);
    for (std::size_t s = 0; s < visible.size(); ++s)
        add(visible[s].seen() ? side_seen(visible[s].triangle, place.origin) : static_cast<Id>(side_count()),
            hemicube_.factors()[s]);
}

template <typename Add>
void FormFactors::follow_ray(const HemicubePlace& place, std::size_t i, const Add& add) const {
    const auto count = static_cast<std::size_t>(params_.rays);
    const Vec2 disk = disk_place(stratified_place(i, count));
    const double up = std::sqrt(std::max(0.0, 1 - dot(disk, disk)));
    const Vec3 direction =
        disk.x * place.tangent + disk.y * cross(place.normal, place.tangent) + up * place.normal;
    const Hit hit = tracer_->first_hit({place.origin, direction});
    add(hit.seen() ? side_seen(hit.triangle, place.origin) : static_cast<Id>(side_count()),
        1.0 / params_.rays);
}

Vec3 FormFactors::irradiance_at(const HemicubePlace& given, std::span<const Vec3> radiosity) const {
    TRILENS_CHECK(radiosity.size() == side_count(), "a radiosity per side");
    HemicubePlace place = given;
    place.origin += params_.offset * place.normal;
    Vec3 sum(0);
    const auto add = [&](Id side, double factor) {
        if (side < side_count()) sum += factor * radiosity[side];
    };
    if (params_.method == FormFactorMethod::kHemicube)
        for_each_pixel(place, add);
    else
        for (std::size_t i = 0; i < static_cast<std::size_t>(params_.rays); ++i) follow_ray(place, i, add);
    return sum;
}

FormFactorRow FormFactors::row(Id side) const {
    TRILENS_CHECK(side < side_count(), "a side of the scene");
    FormFactorRow row;
    if (normals_[side / 2] == Vec3(0)) {
        row.escaped = 1;
        return row;
    }
    std::vector<double> sums(side_count() + 1);  // by side, and at their end what escapes
    if (params_.method == FormFactorMethod::kHemicube) {
        const std::vector<Vec3> middles = middles_of_parts(params_.subdivision);
        for (const Vec3& weights : middles)
            for_each_pixel(place_of(side, weights), [&](Id at, double factor) {
                sums[at] += factor / static_cast<double>(middles.size());
            });
    } else {
        for (std::size_t i = 0; i < static_cast<std::size_t>(params_.rays); ++i)
            follow_ray(place_of(side, spread_weights(i)), i,
                       [&](Id at, double factor) { sums[at] += factor; });
    }
    // A surface does not see itself, whatever rounding says.
    for (const Id own : {side_of(side / 2, false), side_of(side / 2, true)}) {
        sums.back() += sums[own];
        sums[own] = 0;
    }
    row.escaped = sums.back();
    const auto count = static_cast<std::size_t>(
        std::count_if(sums.begin(), sums.end() - 1, [](double sum) { return sum > 0; }));
    row.side.reserve(count);
    row.factor.reserve(count);
    for (Id j = 0; j < side_count(); ++j) {
        if (!(sums[j] > 0)) continue;
        row.side.push_back(j);
        row.factor.push_back(sums[j]);
    }
    return row;
}

FormFactorMatrix make_matrix(const FormFactors& factors, const Progress& progress) {
    constexpr std::size_t kBatch = 64;
    FormFactorMatrix matrix;
    matrix.rows.resize(factors.side_count());
    for (std::size_t first = 0; first < matrix.rows.size(); first += kBatch) {
        progress.stop_if_cancelled();
        progress(static_cast<double>(first) / static_cast<double>(matrix.rows.size()));
        parallel_for(std::min(kBatch, matrix.rows.size() - first), 1, [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i)
                matrix.rows[first + i] = factors.row(static_cast<Id>(first + i));
        });
    }
    return matrix;
}

FormFactorMatrix made_reciprocal(const FormFactorMatrix& matrix, std::span<const double> area,
                                 double tolerance) {
    const std::size_t count = matrix.rows.size();
    TRILENS_CHECK(area.size() == count, "an area per side");
    // Exchanges A_i F_ij: means of both sides' estimates, entry by entry of the union of their patterns.
    std::vector<std::vector<std::pair<Id, double>>> exchange(count);
    for (Id i = 0; i < count; ++i)
        for (std::size_t k = 0; k < matrix.rows[i].side.size(); ++k) {
            const Id j = matrix.rows[i].side[k];
            const double half = 0.5 * area[i] * matrix.rows[i].factor[k];
            exchange[i].emplace_back(j, half);
            exchange[j].emplace_back(i, half);
        }
    FormFactorMatrix result;
    result.rows.resize(count);
    for (Id i = 0; i < count; ++i) {
        // Both halves of an entry, in an order that is the same in the rows of both of its sides.
        std::sort(exchange[i].begin(), exchange[i].end());
        FormFactorRow& row = result.rows[i];
        for (const auto& [j, part] : exchange[i]) {
            if (row.side.empty() || row.side.back() != j) {
                row.side.push_back(j);
                row.factor.push_back(0);
            }
            row.factor.back() += part;
        }
        exchange[i] = {};
        row.escaped = row.side.empty() ? 1 : matrix.rows[i].escaped;
    }
    std::vector<double> scale(count, 1);
    double looked = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kMostScalings; ++step) {
        double worst = 0;
        std::vector<double> next(count, 1);
        for (Id i = 0; i < count; ++i) {
            const FormFactorRow& row = result.rows[i];
            if (row.side.empty()) continue;
            double sum = 0;
            for (std::size_t k = 0; k < row.side.size(); ++k)
                sum += scale[i] * row.factor[k] * scale[row.side[k]];
            const double wanted = area[i] * (1 - row.escaped);
            worst = std::max(worst, std::fabs(sum - wanted) / area[i]);
            next[i] = sum > 0 ? scale[i] * std::sqrt(wanted / sum) : scale[i];
        }
        if (worst <= tolerance) break;
        if (step % kScalingsLooked == 0) {
            if (worst > (1 - kLeastGain) * looked) break;
            looked = worst;
        }
        scale = std::move(next);
    }
    for (Id i = 0; i < count; ++i) {
        FormFactorRow& row = result.rows[i];
        for (std::size_t k = 0; k < row.side.size(); ++k)
            row.factor[k] *= scale[i] * scale[row.side[k]] / area[i];
        if (row.side.empty()) continue;
        // Where nothing fits both, no power is made rather than exchanges kept alike.
        const double sum = row_sum(row);
        if (sum > 1 + tolerance)
            for (double& factor : row.factor) factor /= sum;
        row.escaped = std::max(0.0, 1 - sum);
    }
    return result;
}

}  // namespace trilens
