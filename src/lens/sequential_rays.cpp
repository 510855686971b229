#include "lens/sequential_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/description/lens_sag.h"
#include "base/util/error.h"

namespace trilens {
namespace {

/// z of the side minus z of the ray's point, and how fast that changes along the ray.
struct Gap {
    double value, slope;
};
std::optional<Gap> gap_at(const LensSide& side, const Ray& ray, double t) {
    const Vec3 p = ray.origin + t * ray.direction;
    const SideSag sag = sag_over(side, Vec2(p));
    if (!std::isfinite(sag.z) || !std::isfinite(dot(sag.slope, sag.slope))) return std::nullopt;
    return Gap{sag.z - p.z, dot(sag.slope, Vec2(ray.direction)) - ray.direction.z};
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

/// Snell's law in vectors, whichever way the normal looks.
std::optional<Vec3> refracted_through(const Vec3& in, const Vec3& normal, double eta) {
    const double cosine = dot(in, normal), root = 1 - eta * eta * (1 - cosine * cosine);
    if (!(root >= 0)) return std::nullopt;
    return eta * in + (std::copysign(std::sqrt(root), cosine) - eta * cosine) * normal;
}

/// A ray in a row's frame, on to it and by it; eta: the ratio of indices.
std::optional<Ray> pass(const LensRow& row, const Ray& ray, double eta, ApertureRule apertures) {
    const std::optional<double> t = meet(row.side, ray);
    if (!t) return std::nullopt;
    const Vec3 point = ray.origin + *t * ray.direction;
    const double s = point.x * point.x + point.y * point.y, rim = row.side.aperture;
    if (apertures == ApertureRule::kGiven &&
        ((rim > 0 && s > rim * rim) || s < row.hole * row.hole || s < row.obscuration * row.obscuration))
        return std::nullopt;
    const Vec3 normal = normalize(Vec3(-sag_over(row.side, Vec2(point)).slope, 1));
    if (row.mirror) return Ray{point, ray.direction - 2 * dot(ray.direction, normal) * normal};
    const std::optional<Vec3> direction = refracted_through(ray.direction, normal, eta);
    if (!direction) return std::nullopt;
    return Ray{point, *direction};
}

}  // namespace

std::optional<Ray> trace_lens(const LensPrescription& lens, const Ray& ray, SpectralLine line,
                              ApertureRule apertures) {
    const std::vector<LensPose> poses = lens_poses(lens);
    const std::vector<LensMedium> media = lens_media(lens);
    const bool centred = is_centred(lens);
    Ray now{ray.origin, normalize_or_zero(ray.direction)};
    for (std::size_t i = 0; i < lens.rows.size(); ++i) {
        // Along a straight axis a ray that has turned back never comes to the next surface.
        if (centred && !(now.direction.z * media[i].sense > 0)) return std::nullopt;
        const double eta = index_at(media[i].glass, line) / index_at(media[i + 1].glass, line);
        const std::optional<Ray> passed =
            pass(lens.rows[i], {poses[i].local_point(now.origin), poses[i].local_direction(now.direction)},
                 eta, apertures);
        if (!passed) return std::nullopt;
        now = {poses[i].point(passed->origin), poses[i].direction(passed->direction)};
    }
    return now;
}

namespace {

/// Where a ray meets the plane z of a frame; none where it runs along it.
std::optional<Vec2> place_in_plane(const Ray& ray, const LensPose& frame, double z) {
    const Vec3 origin = frame.local_point(ray.origin), direction = frame.local_direction(ray.direction);
    if (!(std::fabs(direction.z) > 0)) return std::nullopt;
    return Vec2(origin + (z - origin.z) / direction.z * direction);
}

/// Longer than the way through the lens.
double whole_length(const LensPrescription& lens) {
    double sum = 0;
    for (const LensRow& row : lens.rows)
        sum += std::fabs(row.thickness) + length(row.before.shift) + length(row.after.shift);
    return sum;
}

}  // namespace

Spot spot_of(const LensPrescription& lens, const SpotRequest& request) {
    constexpr int kMostRings = 200;
    if (request.rings < 1 || request.rings > kMostRings)
        throw UsageError("a spot has 1 to " + std::to_string(kMostRings) + " rings of rays");
    if (!(std::fabs(request.field_degrees) < 90))
        throw UsageError("a field is within 90 degrees of the axis");
    const LensSection section = imaging_section(lens);
    const FirstOrder first = first_order(section_of(lens, section));
    const double pupil = request.pupil_radius > 0 ? request.pupil_radius : first.entrance_radius;
    if (!(pupil > 0) || !std::isfinite(pupil) || !std::isfinite(first.entrance_pupil))
        throw InputError(lens.file, lens.rows[stop_row(lens)].place,
                         "the stop has no aperture, or no image in front: the size of the beam is not known");
    const double angle = request.field_degrees * std::numbers::pi / 180;
    Vec3 direction(0, 0, std::cos(angle));
    direction[section == LensSection::kX ? 0 : 1] = std::sin(angle);
    const LensPose image = lens_poses(lens).back();
    const double plane = first.back_focal_length - lens.rows.back().thickness +
                         lens_media(lens).back().sense * request.focus_shift;
    const double far = pupil + whole_length(lens) + std::fabs(first.entrance_pupil);

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
            const std::optional<Ray> end = trace_lens(open, {at - far * direction, direction}, request.line);
            const std::optional<Vec2> place = end ? place_in_plane(*end, image, plane) : std::nullopt;
            if (place) spot.points.push_back(*place);
        }
    }
    if (spot.points.empty()) {
        spot.rms_radius = spot.radius = std::numeric_limits<double>::quiet_NaN();
        spot.centroid = Vec2(spot.radius);
        return spot;
    }
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
