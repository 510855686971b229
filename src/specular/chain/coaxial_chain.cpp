#include "specular/chain/coaxial_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/raymesh/flat_face.h"

namespace trilens {
namespace {

constexpr double kCoaxialRounding = 64 * std::numeric_limits<double>::epsilon();
constexpr double kParallelSine = 1e-14;    // of the angle between planes that count as parallel
constexpr double kFaceBorder = 1e-12;      // in (u, v): a place beyond a border by no more lies on it
constexpr double kOnAxis = 1e-8;           // of the way to the point: so near to the axis it counts as on it
/// Newton's method ends where its step, as a share, has a square below rounding.
constexpr double kLastCoaxialStep = 1e-9;
constexpr int kMostCoaxialSteps = 100, kMostSphereSteps = 20;
constexpr double kLeastAngleSlope = 0.02;  // proofs of one path over spheres that leave less are none

bool is_in(FaceDomain domain, const Vec2& uv, double border) {
    return uv.x >= -border && uv.y >= -border &&
           (domain == FaceDomain::kSquare ? uv.x <= 1 + border && uv.y <= 1 + border
                                          : uv.x + uv.y <= 1 + border);
}

}  // namespace

std::optional<CoaxialChain> CoaxialChain::of(const PathChain& chain, std::span<const ChainFace> faces) {
    if (chain.eye.is_direction || faces.size() != chain.events.size() || faces.empty()) return std::nullopt;
    CoaxialChain made(chain, faces);
    if (made.set_planes() || made.set_spheres()) return made;
    return std::nullopt;
}

std::optional<CoaxialPath> CoaxialChain::path_to(const Vec3& point) const {
    return are_planes_ ? over_planes(point) : over_spheres(point);
}

// Parallel planes.

/// None where the face is not flat, or its parameters are not affine.
std::optional<CoaxialChain::PlaneFace> CoaxialChain::plane_face(const Surface& surface, Id face) {
    const std::optional<FlatFace> flat = FlatFace::of(surface, face);
    if (!flat || !flat->is_affine()) return std::nullopt;
    const Vec3 &u = flat->by_u(), &v = flat->by_v(), across = cross(u, v);
    PlaneFace plane;
    plane.domain = surface.domain(face);
    plane.corner = flat->corner();
    plane.normal = flat->normal();
    if (!(dot(across, across) > 0)) return std::nullopt;
    plane.by_u = cross(v, across) / dot(u, cross(v, across));
    plane.by_v = cross(across, u) / dot(v, cross(across, u));
    return plane;
}

bool CoaxialChain::set_planes() {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        const auto plane = plane_face(*chain_.events[i].surface, faces_[i].face);
        if (!plane) return false;
        if (i == 0) axis_ = plane->normal;
        if (length(cross(plane->normal, axis_)) > kParallelSine) return false;
        planes_.push_back(*plane);
        place_.push_back(dot(plane->corner - chain_.eye.place, axis_));
    }
    are_planes_ = true;
    return set_plane_order();
}

/// False where no path can meet the planes in their order, from those sides.
bool CoaxialChain::set_plane_order() {
    double forward = place_[0] > 0 ? 1 : -1, from = 0;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        forward_.push_back(forward);
        const double depth = forward * (place_[i] - from);
        const double rounding = kCoaxialRounding * (length(chain_.eye.place) + length(planes_[i].corner));
        // Planes that touch have no stretch between them.
        if (!(depth > (i == 0 ? 0 : -rounding))) return false;
        depth_.push_back(std::fabs(depth) <= rounding ? 0 : depth);
        if ((forward * dot(axis_, planes_[i].normal) <= 0) != faces_[i].front) return false;
        from = place_[i];
        if (chain_.events[i].reflects) forward = -forward;
    }
    forward_.push_back(forward);
    return depth_[0] > 0;
}

/// With m the stretch of the least index and p the tangent of its angle with the axis, Snell's invariant
/// n_i sin a_i gives each stretch's tangent as n_m p / sqrt(n_i^2 + (n_i^2 - n_m^2) p^2): of a stretch of
/// depth d the path goes d times that away from the axis. The sum rises and is concave in p, so that Newton's
/// method climbs to the one root from what small angles give.
std::optional<CoaxialPath> CoaxialChain::over_planes(const Vec3& point) const {
    const std::size_t k = faces_.size();
    const Vec3 way = point - chain_.eye.place;
    const double height = dot(way, axis_), last_depth = forward_[k] * (height - place_[k - 1]);
    if (!(last_depth > 0)) return std::nullopt;
    const auto depth = [&](std::size_t stretch) { return stretch < k ? depth_[stretch] : last_depth; };
    double least = std::numeric_limits<double>::infinity(), paraxial = 0;
    for (std::size_t i = 0; i <= k; ++i)
        if (depth(i) > 0) least = std::min(least, index(i));
    for (std::size_t i = 0; i <= k; ++i) paraxial += depth(i) * least / index(i);

    const Vec3 off_axis = way - height * axis_;
    const double off = length(off_axis);
    const Vec3 across = off > 0 ? off_axis / off : Vec3(0);
    const auto root = [&](std::size_t i, double p) {
        const double n = index(i);
        return std::sqrt(n * n + (n * n - least * least) * p * p);
    };
    double p = off / paraxial, slope = paraxial;
    for (int step = 0; step < kMostCoaxialSteps && off > 0; ++step) {
        double reached = 0;
        slope = 0;
        for (std::size_t i = 0; i <= k; ++i) {
            if (depth(i) == 0) continue;
            const double w = root(i, p), part = depth(i) * least / w;
            reached += part * p;
            slope += part * (index(i) / w) * (index(i) / w);
        }
        const double by = (off - reached) / slope;
        p += by;
        if (!(std::fabs(by) > kLastCoaxialStep * p)) break;
    }
    // A stretch of no depth must let the light through, too.
    const double invariant = least * p / std::sqrt(1 + p * p);
    CoaxialPath path;
    double from_axis = 0;
    for (std::size_t i = 0; i < k; ++i) {
        if (!(index(i) >= invariant && index(i + 1) >= invariant)) return std::nullopt;
        if (depth_[i] > 0) from_axis += depth_[i] * least * p / root(i, p);
        const PlaneFace& plane = planes_[i];
        const Vec2 uv = plane.uv(chain_.eye.place + place_[i] * axis_ + from_axis * across);
        if (!is_in(plane.domain, uv, kFaceBorder)) return std::nullopt;
        path.at.push_back({faces_[i].face, clamped_to(plane.domain, uv)});
        path.places.push_back(chain_.eye.place + place_[i] * axis_ + from_axis * across);
        path.normals.push_back(plane.normal);
    }

    // Around the axis the first place turns with the point; along `across` both move with p.
    const double first = depth_[0] * least / root(0, p);
    const double first_slope = first * (index(0) / root(0, p)) * (index(0) / root(0, p));
    const double outward = first_slope / slope, around = off > kOnAxis * paraxial ? first * p / off : outward;
    const double by_height = -outward * forward_[k] * least * p / root(k, p);
    const Vec3 gradient = (outward - around) * across + by_height * axis_;
    path.first_by_point =
        glm::outerProduct(across, gradient) + around * (Mat3(1) - glm::outerProduct(axis_, axis_));
    return path;
}

std::optional<Ray> CoaxialChain::last_ray(const Vec3& direction) const {
    const double along = dot(direction, axis_);
    if (!are_planes_ || !(along * forward_[0] > 0)) return std::nullopt;
    const Vec3 off_axis = direction / std::fabs(along) - forward_[0] * axis_;
    const double tangent = length(off_axis),
                 invariant = index(0) * tangent / std::sqrt(1 + tangent * tangent);
    const Vec3 across = tangent > 0 ? off_axis / tangent : Vec3(0);
    Ray ray;
    double from_axis = depth_[0] * tangent;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        ray.origin = chain_.eye.place + place_[i] * axis_ + from_axis * across;
        if (!is_in(planes_[i].domain, planes_[i].uv(ray.origin), kFaceBorder)) return std::nullopt;
        const double sine = invariant / index(i + 1), cosine = std::sqrt(1 - sine * sine);
        if (!(cosine > 0)) return std::nullopt;
        ray.direction = forward_[i + 1] * cosine * axis_ + sine * across;
        if (i + 1 < faces_.size()) from_axis += depth_[i + 1] * sine / cosine;
    }
    return ray;
}

/// The rays meet the first plane in a triangle. One that is r_1 away from the axis there is so many times as
/// far away at each other plane: a sum whose terms fall or rise with r_1. So places on that lie within the
/// hull of the triangle times the least and times the most of that.
bool CoaxialChain::holds_rays_between(const std::array<Vec3, 3>& directions) const {
    if (!are_planes_) return true;
    std::array<Vec3, 3> off;
    Vec3 middle(0);
    double farthest = 0, reach = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double along = dot(directions[c], axis_);
        if (!(along * forward_[0] > 0)) return false;
        off[c] = place_[0] * (directions[c] / along - axis_);
        middle += off[c] / 3.0;
        farthest = std::max(farthest, length(off[c]));
    }
    for (const Vec3& one : off) reach = std::max(reach, length(one - middle));
    const double ends[2] = {std::max(0.0, length(middle) - reach) / depth_[0], farthest / depth_[0]};
    double least = 1, most = 1;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        if (i > 0 && depth_[i] > 0) {
            double times[2];
            for (int e = 0; e < 2; ++e) {
                const double n = index(i), n0 = index(0);
                const double squared = n * n + (n * n - n0 * n0) * ends[e] * ends[e];
                if (!(squared > 0)) return false;  // reflected totally
                times[e] = depth_[i] / depth_[0] * n0 / std::sqrt(squared);
            }
            least += std::min(times[0], times[1]);
            most += std::max(times[0], times[1]);
        }
        for (const Vec3& one : off)
            for (const double times : {least, most})
                if (!is_in(planes_[i].domain,
                           planes_[i].uv(chain_.eye.place + place_[i] * axis_ + times * one), kFaceBorder))
                    return false;
    }
    const double n = index(faces_.size()), sine = ends[1] / std::sqrt(1 + ends[1] * ends[1]);
    return index(0) * sine < n;
}

// Concentric spheres.

bool CoaxialChain::set_spheres() {
    are_planes_ = false;
    place_.clear();
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        const Surface& surface = *chain_.events[i].surface;
        const double curvature = surface.sphere_curvature();
        if (!(curvature > 0) || surface.sphere_place(Vec3(0, 0, 1)).face == kNone) return false;
        const SurfacePoint some = surface.eval_first_order(0, {0.5, 0.5});
        const Vec3 centre = some.position - some.normal / curvature;
        if (i == 0) axis_ = centre;
        const double far = length(centre) + 1 / curvature;
        if (length(centre - axis_) > kCoaxialRounding * far) return false;
        // From inside out, one after the other.
        if (chain_.events[i].reflects || faces_[i].front || (i > 0 && !(1 / curvature > place_[i - 1])))
            return false;
        place_.push_back(1 / curvature);
    }
    const Vec3 to_eye = chain_.eye.place - axis_;
    eye_radius_ = length(to_eye);
    to_eye_ = normalize_or_zero(to_eye);
    if (!(eye_radius_ < place_[0])) return false;
    least_slope_ = least_angle_slope();
    return least_slope_ >= kLeastAngleSlope;
}

/// Bouguer: n r sin(a) is the same all along a ray, a its angle with the radius. From the eye at radius r_0,
/// leaving at a_0, invariant b = n_0 r_0 sin(a_0), a ray turns about the centre by a_0 - asin(b / n_0 r_1) up
/// to the first sphere and asin(b / n_i r_i) - asin(b / n_i r_(i+1)) from one to the next. The derivative of
/// the sum by a_0 is 1 + n_0 r_0 cos(a_0) (-1 / s(n_0 r_1) + sum of 1 / s(n_i r_i) - 1 / s(n_i r_(i+1))),
/// with s(m) = sqrt(m^2 - b^2): each of these differences grows with b, which is n_0 r_0 at most.
double CoaxialChain::least_angle_slope() const {
    const double most = index(0) * eye_radius_;
    const auto by_root = [&](double m) {
        return m > most ? 1 / std::sqrt(m * m - most * most) : std::numeric_limits<double>::infinity();
    };
    double turned = 0;
    for (std::size_t i = 1; i <= place_.size(); ++i) {
        turned += by_root(index(i) * place_[i - 1]);
        if (i < place_.size()) turned -= by_root(index(i) * place_[i]);
    }
    if (!std::isfinite(turned)) return -1;
    return 1 - most * std::max(by_root(index(0) * place_[0]), turned);
}

/// A ray that leaves the eye, in the plane of axis and point: directions from the centre as cosine and sine
/// of their angle with the axis.
struct CoaxialChain::SphereRay {
    PerEvent<Vec2> meets;               // each sphere
    Vec2 end{0};                        // where it has come as far from the centre as the point lies
    double slope = 1, first_slope = 1;  // of the angles of the end, and of the first sphere
    double end_tangent = 0;             // of the angle with the radius at the end
};

CoaxialChain::SphereRay CoaxialChain::sphere_ray(const Vec2& from_eye, double end_radius) const {
    const double invariant = index(0) * eye_radius_ * from_eye.y,
                 by_angle = index(0) * eye_radius_ * from_eye.x;
    SphereRay ray;
    Vec2 at = from_eye;
    // By the angle whose sine is invariant / m, and back.
    const auto turn = [&](double m, double way) {
        const double sine = invariant / m, cosine = std::sqrt(1 - sine * sine);
        at = {at.x * cosine - way * at.y * sine, at.y * cosine + way * at.x * sine};
        ray.slope += way * by_angle / (m * cosine);
        ray.end_tangent = sine / cosine;
    };
    turn(index(0) * place_[0], -1);
    ray.first_slope = ray.slope;
    ray.meets.push_back(at);
    for (std::size_t i = 1; i <= place_.size(); ++i) {
        turn(index(i) * place_[i - 1], 1);
        turn(index(i) * (i < place_.size() ? place_[i] : end_radius), -1);
        if (i < place_.size()) ray.meets.push_back(at);
    }
    ray.end = at;
    return ray;
}

std::optional<CoaxialPath> CoaxialChain::over_spheres(const Vec3& point) const {
    const Vec3 to = point - axis_;
    const double radius = length(to);
    if (!(radius > place_[place_.size() - 1])) return std::nullopt;
    const Vec3 out = to / radius, along = eye_radius_ > 0 ? to_eye_ : out;
    const double cosine = dot(out, along);
    Vec3 off_axis = out - cosine * along;
    off_axis -= dot(off_axis, along) * along;
    const double sine = length(off_axis);
    const Vec3 across = sine > kCoaxialRounding ? off_axis / sine : unit_across(along);

    // From the straight way on.
    Vec2 from_eye = normalize(Vec2(radius * cosine - eye_radius_, radius * sine));
    for (int step = 0; step < kMostCoaxialSteps; ++step) {
        const SphereRay ray = sphere_ray(from_eye, radius);
        const double ahead = ray.end.x * cosine + ray.end.y * sine,
                     beside = ray.end.x * sine - ray.end.y * cosine;
        // Steps by the steepest slope that there may be come to the root in any case.
        const double by = (ahead > 0 ? beside : std::copysign(1, beside)) /
                          (step < kMostSphereSteps ? ray.slope : 2 - least_slope_);
        const double half = by / 2, norm = 1 + half * half;
        const Vec2 turn((1 - half * half) / norm, by / norm);
        from_eye = {from_eye.x * turn.x - from_eye.y * turn.y, from_eye.y * turn.x + from_eye.x * turn.y};
        if (!(std::fabs(by) > kLastCoaxialStep)) break;
    }

    const SphereRay ray = sphere_ray(from_eye, radius);
    CoaxialPath path;
    for (std::size_t i = 0; i < place_.size(); ++i) {
        const Vec3 normal = ray.meets[i].x * along + ray.meets[i].y * across;
        path.at.push_back(chain_.events[i].surface->sphere_place(normal));
        path.places.push_back(axis_ + place_[i] * normal);
        path.normals.push_back(normal);
    }

    // In the plane the first place moves with the angle at the eye, which moves with the point's angle and
    // radius; out of it all turns about the axis.
    const Vec2& first = ray.meets[0];
    const double by_angle = place_[0] * ray.first_slope / (ray.slope * radius);
    const double around = sine > kOnAxis ? place_[0] * first.y / (radius * sine) : by_angle;
    const Vec3 sideways = cosine * across - sine * along, normal = cross(along, across);
    path.first_by_point =
        glm::outerProduct(first.x * across - first.y * along, by_angle * (sideways - ray.end_tangent * out)) +
        around * glm::outerProduct(normal, normal);
    return path;
}

}  // namespace trilens
