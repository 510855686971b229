#include "lens/sequential_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/util/error.h"

namespace trilens {
namespace {

/// z of the side minus z of the ray's point, and how fast that changes along the ray.
struct Gap {
    double value, slope;
};
std::optional<Gap> gap_at(const LensSide& side, const Ray& ray, double t) {
    const Vec3 p = ray.origin + t * ray.direction;
    const double s = p.x * p.x + p.y * p.y, c = side.curvature;
    if (!(1 - (1 + side.conic) * c * c * s > 0)) return std::nullopt;
    const Sag sag = sag_at(side, s);
    const double rise = 2 * sag.by_s * (p.x * ray.direction.x + p.y * ray.direction.y);
    return Gap{sag.z - p.z, rise - ray.direction.z};
}

/// Newton's method from the vertex' plane; the origin is the vertex.
std::optional<double> meet(const LensSide& side, const Ray& ray) {
    constexpr int kSteps = 50;
    double t = -ray.origin.z / ray.direction.z;
    double last = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kSteps; ++i) {
        const std::optional<Gap> gap = gap_at(side, ray, t);
        if (!gap || gap->slope == 0) return std::nullopt;
        const double step = -gap->value / gap->slope;
        t += step;
        // Steps shrink quadratically until rounding is left.
        if (std::fabs(step) >= std::fabs(last) && std::fabs(step) < 1e-9 * (1 + std::fabs(t))) return t;
        if (step == 0) return t;
        last = step;
    }
    return std::nullopt;
}

/// Snell's law in vectors; the normal along the axis.
std::optional<Vec3> refracted_through(const Vec3& in, const Vec3& normal, double eta) {
    const double cosine = dot(in, normal), root = 1 - eta * eta * (1 - cosine * cosine);
    if (!(root >= 0)) return std::nullopt;
    return eta * in + (std::sqrt(root) - eta * cosine) * normal;
}

}  // namespace

std::optional<Ray> trace_lens(const LensPrescription& lens, const Ray& ray, SpectralLine line,
                              ApertureRule apertures) {
    Ray now{ray.origin, normalize_or_zero(ray.direction)};
    double z = 0, before = 1;
    for (const LensRow& row : lens.rows) {
        if (!(now.direction.z > 0)) return std::nullopt;
        const Vec3 vertex(0, 0, z);
        const std::optional<double> t = meet(row.side, {now.origin - vertex, now.direction});
        if (!t) return std::nullopt;
        now.origin += *t * now.direction;
        const double s = now.origin.x * now.origin.x + now.origin.y * now.origin.y;
        const double rim = row.side.aperture;
        if (apertures == ApertureRule::kGiven && rim > 0 && s > rim * rim) return std::nullopt;
        const double slope = 2 * sag_at(row.side, s).by_s;
        const Vec3 normal = normalize(Vec3(-slope * now.origin.x, -slope * now.origin.y, 1));
        const double behind = index_at(row.glass, line);
        const std::optional<Vec3> direction = refracted_through(now.direction, normal, before / behind);
        if (!direction) return std::nullopt;
        now.direction = *direction;
        z += row.thickness;
        before = behind;
    }
    return now;
}

Spot spot_of(const LensPrescription& lens, const SpotRequest& request) {
    constexpr int kMostRings = 200;
    if (request.rings < 1 || request.rings > kMostRings)
        throw UsageError("a spot has 1 to " + std::to_string(kMostRings) + " rings of rays");
    if (!(std::fabs(request.field_degrees) < 90))
        throw UsageError("a field is within 90 degrees of the axis");
    const FirstOrder first = first_order(lens);
    const double pupil = request.pupil_radius > 0 ? request.pupil_radius : first.entrance_radius;
    if (!(pupil > 0) || !std::isfinite(pupil) || !std::isfinite(first.entrance_pupil))
        throw InputError(lens.file, lens.rows[stop_row(lens)].place,
                         "the stop has no aperture, or no image in front: the size of the beam is not known");
    const double angle = request.field_degrees * std::numbers::pi / 180;
    const Vec3 direction(0, std::sin(angle), std::cos(angle));
    const double plane = first.length + first.back_focal_length + request.focus_shift;

    // The pupil is the stop's: its rim is the beam's.
    LensPrescription open = lens;
    open.rows[stop_row(lens)].side.aperture = 0;

    Spot spot;
    for (int ring = 0; ring <= request.rings; ++ring) {
        const int count = ring == 0 ? 1 : 6 * ring;
        for (int k = 0; k < count; ++k) {
            ++spot.asked;
            const double turn = 2 * std::numbers::pi * k / count, radius = pupil * ring / request.rings;
            const Vec3 at(radius * std::cos(turn), radius * std::sin(turn), first.entrance_pupil);
            // The pupil may lie behind the first surface: the ray starts before it.
            const Ray start{at - (pupil + first.length + std::fabs(first.entrance_pupil)) * direction,
                            direction};
            const std::optional<Ray> end = trace_lens(open, start, request.line);
            if (!end || !(end->direction.z > 0)) continue;
            const Vec3 p = end->origin + (plane - end->origin.z) / end->direction.z * end->direction;
            spot.points.emplace_back(p.x, p.y);
        }
    }
    if (spot.points.empty()) return spot;
    const auto count = static_cast<double>(spot.points.size());
    for (const Vec2& p : spot.points) spot.centroid += p / count;
    double sum = 0;
    for (const Vec2& p : spot.points) {
        const Vec2 off = p - spot.centroid;
        sum += dot(off, off);
        spot.radius = std::max(spot.radius, length(off));
    }
    spot.rms_radius = std::sqrt(sum / count);
    return spot;
}

}  // namespace trilens
