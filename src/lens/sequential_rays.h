// Exact rays through a lens, surface after surface in the order of its prescription, and the spots that
// beams make.
#pragma once

#include <optional>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "lens/first_order.h"

namespace trilens {

/// Which places of a surface let rays through.
enum class ApertureRule { kAll, kGiven };  // kGiven: within apertures, where they are given

/// Refracts or reflects a ray by each surface in turn: z along the axis, the origin at the first vertex as it
/// is without its own tilt. The result starts on the last surface, unit. None where the ray misses a surface,
/// is totally reflected, or is stopped by an aperture, or in a hole.
std::optional<Ray> trace_lens(const LensPrescription& lens, const Ray& ray,
                              SpectralLine line = SpectralLine::kD,
                              ApertureRule apertures = ApertureRule::kGiven);

struct SpotRequest {
    double pupil_radius = 0;   // of the beam in the entrance pupil; 0: the stop's
    double field_degrees = 0;  // from the axis, in the plane of the imaging section
    SpectralLine line = SpectralLine::kD;
    int rings = 8;           // of rays: 6 k on the k-th, and one in the middle
    double focus_shift = 0;  // of the plane, from the paraxial focus at the d line, along the light
};

/// Where a beam from infinity meets a plane across the axis, in the image's frame. Field, focus and pupil are
/// those of the imaging section.
struct Spot {
    std::vector<Vec2> points;  // x and y in the plane, of rays that come through
    std::size_t asked = 0;     // rays that were sent
    // Not numbers where no ray comes through.
    Vec2 centroid{0};
    double rms_radius = 0;  // about the centroid
    double radius = 0;      // of the farthest ray from it
};

/// Throws InputError where the pupil has no size that is known, UsageError for rings outside of 1..200 and a
/// field of 90 degrees or more.
Spot spot_of(const LensPrescription& lens, const SpotRequest& request);

}  // namespace trilens
