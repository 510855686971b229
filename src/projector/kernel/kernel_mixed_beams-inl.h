// Beams around vectors whose samples have facets of their own, and around all of them, from their rays.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_MIXED_BEAMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_MIXED_BEAMS_INL_H
#undef TRILENS_KERNEL_MIXED_BEAMS_INL_H
#else
#define TRILENS_KERNEL_MIXED_BEAMS_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "projector/kernel/kernel_group_beam-inl.h"
#include "projector/kernel/kernel_rays-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// An axis and two directions across it, and what the group's rays do along them.
struct MixedFrame {
    float axis[3], side[2][3];
    float speed = 0, start = 0, behind = 0;  // most, most, least of the origins
    float doubt = 0;                         // of a height of unit normal
    // By vector: slopes of the directions to each side, and offsets of the planes that they make.
    alignas(64) float low[2][kLanes] = {}, high[2][kLanes] = {}, offset[4][kLanes] = {};
};

HWY_INLINE Floats inner(const float* a, const Floats (&b)[3]) {
    return multiply_add(set(a[0]), b[0], multiply_add(set(a[1]), b[1], set(a[2]) * b[2]));
}

/// False: directions do not have a middle.
HWY_INLINE bool set_axis(const Floats (&sum)[3], MixedFrame& frame) {
    double axis[3], across[2][3], square = 0;
    for (int a = 0; a < 3; ++a) {
        axis[a] = sum_of_lanes(sum[a]);
        square += axis[a] * axis[a];
    }
    if (!(square > 1e-30) || !std::isfinite(square)) return false;
    for (double& a : axis) a /= std::sqrt(square);
    directions_across(axis, across);
    for (int a = 0; a < 3; ++a) {
        frame.axis[a] = static_cast<float>(axis[a]);
        for (int k = 0; k < 2; ++k) frame.side[k][a] = static_cast<float>(across[k][a]);
    }
    return true;
}

/// Widens slopes and lowers offsets by what the slopes may be off.
HWY_INLINE void turn_planes(float least_cosine, MixedFrame& frame) {
    // With c the least cosine and u = 2^-24: slopes are off by 28 u / c^2, the planes' normals by 7 u / c.
    const float turn = 0x1p-18f / least_cosine;
    const float lower = turn * std::max(std::fabs(frame.start), std::fabs(frame.behind));
    for (int k = 0; k < 2; ++k) {
        store(load(frame.low[k]) - set(turn), frame.low[k]);
        store(load(frame.high[k]) + set(turn), frame.high[k]);
        for (float* offset : {frame.offset[2 * k], frame.offset[2 * k + 1]})
            store(load(offset) - set(lower), offset);
    }
}

/// Fills the frame from the rays of the group's vectors that `state` names. False: some ray goes too much
/// across the axis for planes.
HWY_NOINLINE bool measure_rays(const KernelScene& scene, const MixedGroup& group, const KernelState& state,
                               const NarrowRays* rays, MixedFrame& frame) {
    constexpr float kLeastSquare = 0.01f;  // of the cosine to the axis
    Floats sum[3] = {set(0.0f), set(0.0f), set(0.0f)};
    for (std::uint32_t v = 0; v < state.vectors; ++v)
        for (int a = 0; a < 3; ++a) sum[a] = sum[a] + rays[v].direction[a];
    if (!set_axis(sum, frame)) return false;
    const Vec3 from = group.centre - scene.tree->centre, half = scene.tree->half;
    Floats cosine = set(1.0f), speed = set(0.0f), size = speed;
    Floats start = set(-kNever), behind = set(kNever);
    for (std::uint32_t v = 0; v < state.vectors; ++v) {
        const Floats(&d)[3] = rays[v].direction;
        const Floats(&own)[3] = rays[v].origin;
        const Floats along = inner(frame.axis, d), inverse = reciprocal(along);
        const Floats length = multiply_add(d[0], d[0], multiply_add(d[1], d[1], d[2] * d[2]));
        cosine = least(cosine, along * absolute(along) / length);
        speed = largest(speed, along);
        size = largest(size, absolute(own[0]) + absolute(own[1]) + absolute(own[2]));
        Floats o[3];
        for (int a = 0; a < 3; ++a) o[a] = own[a] + set(static_cast<float>(from[a]));
        const Floats ahead = inner(frame.axis, o);
        start = largest(start, ahead);
        behind = least(behind, ahead);
        for (int k = 0; k < 2; ++k) {
            const Floats slope = inner(frame.side[k], d) * inverse, beside = inner(frame.side[k], o);
            const float low = least_lane(slope), high = largest_lane(slope);
            frame.low[k][v] = low;
            frame.high[k][v] = high;
            frame.offset[2 * k][v] = least_lane(subtract_product(set(low), ahead, beside));
            frame.offset[2 * k + 1][v] = least_lane(multiply_subtract(set(high), ahead, beside));
        }
    }
    const float least_cosine = least_lane(cosine);
    frame.speed = largest_lane(speed);
    if (!(least_cosine > kLeastSquare) || !std::isfinite(frame.speed)) return false;
    const double far = std::fabs(from.x) + std::fabs(from.y) + std::fabs(from.z);
    const double reach = half.x + half.y + half.z + 2 * far + static_cast<double>(largest_lane(size));
    frame.doubt = static_cast<float>(2 * kPlaneDoubt * (reach + 1e-6 * group.origin_terms));
    frame.start = largest_lane(start);
    frame.behind = least_lane(behind);
    turn_planes(least_cosine, frame);
    return true;
}

/// Beams of the vectors and of their group. The planes' normals are not unit, but no shorter.
HWY_NOINLINE void put_mixed_planes(const MixedFrame& frame, KernelState& state) {
    const Floats doubt = set(frame.doubt), one = set(1.0f);
    state.beams.resize(1);
    VectorBeams& beams = state.beams[0];
    GroupBeam& beam = state.beam;
    beam.planes = 0;
    const auto add = [&](const float* side, float sign, float slope, float offset) HWY_ATTR {
        for (int a = 0; a < 3; ++a) beam.plane[beam.planes][a] = sign * (side[a] - slope * frame.axis[a]);
        beam.offset[beam.planes++] = offset - (1 + std::fabs(slope)) * frame.doubt;
    };
    for (int a = 0; a < 3; ++a) beam.axis[a] = beam.plane[0][a] = frame.axis[a];
    beam.offset[beam.planes++] = frame.behind - frame.doubt;
    for (int k = 0; k < 2; ++k) {
        const Floats low = load(frame.low[k]), high = load(frame.high[k]);
        for (int a = 0; a < 3; ++a) {
            const Floats axis = set(frame.axis[a]), side = set(frame.side[k][a]);
            store(subtract_product(low, axis, side), beams.plane[2 * k][a]);
            store(multiply_subtract(high, axis, side), beams.plane[2 * k + 1][a]);
        }
        store(subtract_product(doubt, one + absolute(low), load(frame.offset[2 * k])), beams.offset[2 * k]);
        store(subtract_product(doubt, one + absolute(high), load(frame.offset[2 * k + 1])),
              beams.offset[2 * k + 1]);
        // The group's normal is a vector's plus a share of the axis.
        const float least = *std::min_element(frame.low[k], frame.low[k] + state.vectors),
                    most = *std::max_element(frame.high[k], frame.high[k] + state.vectors);
        float from_low = kNever, from_high = kNever;
        for (std::uint32_t v = 0; v < state.vectors; ++v) {
            from_low = std::min(from_low, frame.offset[2 * k][v] + (frame.low[k][v] - least) * frame.behind);
            from_high =
                std::min(from_high, frame.offset[2 * k + 1][v] + (most - frame.high[k][v]) * frame.behind);
        }
        add(frame.side[k], 1, least, from_low - 0.25f * frame.doubt);
        add(frame.side[k], -1, most, from_high - 0.25f * frame.doubt);
    }
    beam.start = frame.start + frame.doubt;
    beam.speed_inverse = frame.speed > 0 ? (1 - 0x1p-16f) / frame.speed : 0;
    for (std::uint32_t v = 0; v < kLanes; ++v) beams.farthest[v] = v < state.vectors ? kNever : -kNever;
    state.beams_made = true;
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
