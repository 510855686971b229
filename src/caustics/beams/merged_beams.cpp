#include "caustics/beams/merged_beams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "caustics/beams/quadratic.h"

namespace trilens {
namespace {

/// Light may be off by this share of the beam's strongest; where nothing tells how far it is, it may differ
/// from linear by so much.
constexpr double kLightOff = 0.02, kLightBends = 0.1;
/// But no less than the same share of paths that carry so much of the brightest.
constexpr double kFaintest = 0.01;
/// Rays turned farther from each other fall too differently for one plane.
constexpr double kLeastAlong = 0.1;

bool falls_on_object(const LightPath& path) {
    return std::isfinite(path.object);
}
bool goes_on(const LightPath& path) {
    return std::isfinite(path.optic);
}

/// What a quadratic interpolates.
struct SampleValue {
    Vec3 place{0}, light{0};
};

struct QuadraticBeam {
    std::array<SampleValue, 6> node;  // at the corners, and in the middles across from them
    SampleValue at(const Vec3& w) const {
        const std::array<double, 6> weights = quadratic_weights(w);
        SampleValue sum;
        for (std::size_t k = 0; k < 6; ++k)
            sum.place += weights[k] * node[k].place, sum.light += weights[k] * node[k].light;
        return sum;
    }
    SampleValue on_chord(std::size_t across) const {
        const SampleValue &a = node[(across + 1) % 3], &b = node[(across + 2) % 3];
        return {0.5 * (a.place + b.place), 0.5 * (a.light + b.light)};
    }
};

/// The side in whose middle a sample lies, by the corner across; 3: none.
std::size_t side_of_middle(const Vec3& weights) {
    for (std::size_t k = 0; k < 3; ++k)
        if (weights[static_cast<int>(k)] == 0 && weights[static_cast<int>((k + 1) % 3)] == 0.5) return k;
    return 3;
}

/// Where the samples fall on the plane across the first one's ray, where that meets an object; empty: not all
/// do.
std::vector<SampleValue> fallen(std::span<const MergeSample> samples, double size) {
    const LightPath& first = *samples[0].path;
    const Vec3 axis = first.ray.direction;
    const Vec3 there = first.ray.origin + (falls_on_object(first) ? first.object : size) * axis;
    std::vector<SampleValue> values;
    for (const MergeSample& sample : samples) {
        const auto& [origin, direction] = sample.path->ray;
        const double along = dot(direction, axis);
        if (!(along > kLeastAlong)) return {};
        values.push_back({origin + dot(there - origin, axis) / along * direction, sample.path->light});
    }
    return values;
}

/// Whether what the samples meet lies in one plane.
bool is_on_one_plane(std::span<const MergeSample> samples, double room) {
    const auto met = [&](std::size_t i) {
        const LightPath& path = *samples[i].path;
        return path.ray.origin + path.object * path.ray.direction;
    };
    const Vec3 normal = normalize_or_zero(cross(met(1) - met(0), met(2) - met(0)));
    for (std::size_t i = 3; i < samples.size(); ++i)
        if (!(std::fabs(dot(met(i) - met(0), normal)) <= room)) return false;
    return true;
}

}  // namespace

bool is_one_beam(std::span<const MergeSample> samples, double measure, const MergeParams& params) {
    const LightPath& first = *samples[0].path;
    double strength = 0;
    for (const MergeSample& sample : samples) {
        if (falls_on_object(*sample.path) != falls_on_object(first) ||
            goes_on(*sample.path) != goes_on(first))
            return false;
        strength = std::max(strength, strength_of(sample.path->light));
    }
    if (!first.falls()) return true;
    if (falls_on_object(first) && !is_on_one_plane(samples, params.tolerance)) return false;
    const std::vector<SampleValue> values = fallen(samples, params.size);
    if (values.empty()) return false;

    QuadraticBeam beam;
    for (std::size_t k = 0; k < 3; ++k) beam.node[k] = values[k];
    for (std::size_t k = 0; k < 3; ++k) beam.node[3 + k] = beam.on_chord(k);
    std::size_t middles = 0;
    for (std::size_t i = 3; i < samples.size(); ++i) {
        const std::size_t k = side_of_middle(samples[i].weights);
        if (k < 3) beam.node[3 + k] = values[i], ++middles;
    }
    // Only what lies beside these six tells anything of the quadratic.
    const bool is_known = middles == 3 && samples.size() > 6;
    if (!is_known)
        for (std::size_t k = 0; k < 3; ++k) beam.node[3 + k] = beam.on_chord(k);
    const double area =
        0.5 * length(cross(values[1].place - values[0].place, values[2].place - values[0].place));
    const bool is_faint = strength * measure < params.faint * area;
    const double room = is_faint ? INFINITY
                                 : (is_known ? 1 : kNearlyStraight) * params.tolerance * kFaintOff *
                                       params.brightest / strength;
    const double light_room =
        (is_known ? kLightOff : kLightBends) * std::max(strength, kFaintest * params.brightest);
    return std::all_of(samples.begin() + 3, samples.end(), [&](const MergeSample& sample) {
        const SampleValue& exact = values[static_cast<std::size_t>(&sample - samples.data())];
        const SampleValue quadratic = beam.at(sample.weights);
        return length(exact.place - quadratic.place) <= room &&
               strength_of(glm::abs(exact.light - quadratic.light)) <= light_room;
    });
}

}  // namespace trilens
