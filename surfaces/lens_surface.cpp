#include "surfaces/lens_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "surfaces/primitive_shapes.h"
#include "surfaces/primitives/disk_map.h"
#include "surfaces/primitives/primitive_bounds.h"

namespace trilens {
namespace {

constexpr Id kSideFaces = DiskMap::kFaces;
constexpr Id kFirstOfEdge = 2 * kSideFaces;
constexpr Id kFaces = kFirstOfEdge + 4;

/// Points so far beyond a rim, as a share of its size, are on it: no ray slips between a side and the edge.
constexpr double kRimSlack = 1e-12;

/// The front's disk is mirrored, for its outside looks against the axis.
Vec2 mirrored(const Vec2& p) {
    return {p.x, -p.y};
}

/// The front's faces, the back's, the edge's; corners of the back are numbered from 8 on.
std::vector<std::array<Id, 4>> lens_corners() {
    std::vector<std::array<Id, 4>> corners = DiskMap::corners();
    for (std::array<Id, 4> face : DiskMap::corners()) {
        for (Id& corner : face) corner += 8;
        corners.push_back(face);
    }
    // Corners of the rims from -45 degrees on.
    constexpr std::array<Id, 4> kFront{6, 5, 4, 7}, kBack{13, 14, 15, 12};
    for (std::size_t k = 0; k < 4; ++k)
        corners.push_back({kFront[k], kFront[(k + 1) % 4], kBack[(k + 1) % 4], kBack[k]});
    return corners;
}

class LensSurface final : public Surface {
  public:
    LensSurface(const LensPrimitive& lens, const Vec3& center, const Mat3& world_from_local)
        : lens_(lens),
          center_(center),
          world_from_local_(world_from_local),
          disks_{DiskMap(lens.front.aperture), DiskMap(lens.back.aperture)},
          rims_{sag_of_rim(lens.front), lens.thickness + sag_of_rim(lens.back)},
          is_closed_form_(is_conicoid(lens.front) && is_conicoid(lens.back)) {}

    std::size_t face_count() const override { return kFaces; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    FaceBorder border(Id face) const override { return borders_[face]; }
    bool has_closed_form() const override { return is_closed_form_; }
    std::unique_ptr<const SurfaceBounder> make_bounder() const override {
        return make_primitive_bounder(lens_, *this);
    }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        const auto clamp = [](double x) { return x > 0 ? std::min(x, 1.0) : 0.0; };
        const Vec2 inside(clamp(uv.x), clamp(uv.y));
        SurfacePoint point = face < kFirstOfEdge ? eval_side(face / kSideFaces, face % kSideFaces, inside)
                                                 : eval_edge(face - kFirstOfEdge, inside);
        for (Vec3* vector :
             {&point.position, &point.du, &point.dv, &point.duu, &point.duv, &point.dvv, &point.normal})
            *vector = world_from_local_ * *vector;
        point.position += center_;
        return point;
    }

    std::optional<SurfaceHit> intersect(const Ray& ray, double t_min) const override {
        if (!is_closed_form_) return std::nullopt;
        const Mat3 local_from_world = glm::transpose(world_from_local_);
        const Ray local{local_from_world * (ray.origin - center_), local_from_world * ray.direction};
        if (!(dot(local.direction, local.direction) > 0)) return std::nullopt;
        Nearest nearest{t_min};
        meet_side(0, local, nearest);
        meet_side(1, local, nearest);
        meet_edge(local, nearest);
        if (nearest.place.face == kNone) return std::nullopt;
        return SurfaceHit{nearest.place.face, nearest.place.uv, nearest.t,
                          eval(nearest.place.face, nearest.place.uv)};
    }

  private:
    const LensSide& side(Id which) const { return which == 0 ? lens_.front : lens_.back; }
    double vertex(Id which) const { return which == 0 ? 0 : lens_.thickness; }

    SurfacePoint eval_side(Id which, Id face, const Vec2& uv) const {
        DiskMap::Flat flat = disks_[which].at(face, uv);
        if (which == 0)
            for (Vec2* part : {&flat.p, &flat.u, &flat.v, &flat.uu, &flat.uv, &flat.vv})
                *part = mirrored(*part);
        const Sag sag = sag_at(side(which), dot(flat.p, flat.p));
        const double su = 2 * dot(flat.p, flat.u), sv = 2 * dot(flat.p, flat.v);
        const auto second = [&](const Vec2& a, const Vec2& b, const Vec2& ab, double sa_sb) {
            return Vec3(ab, sag.by_ss * sa_sb + 2 * sag.by_s * (dot(a, b) + dot(flat.p, ab)));
        };
        SurfacePoint point;
        point.position = Vec3(flat.p, vertex(which) + sag.z);
        point.du = Vec3(flat.u, sag.by_s * su);
        point.dv = Vec3(flat.v, sag.by_s * sv);
        point.duu = second(flat.u, flat.u, flat.uu, su * su);
        point.duv = second(flat.u, flat.v, flat.uv, su * sv);
        point.dvv = second(flat.v, flat.v, flat.vv, sv * sv);
        point.normal = normalize(Vec3(-2 * sag.by_s * flat.p, 1.0)) * (which == 0 ? -1.0 : 1.0);
        return point;
    }

    SurfacePoint eval_edge(Id quarter, const Vec2& uv) const {
        const double angle = kHalfTurn / 4 * (2 * uv.x - 1), speed = kHalfTurn / 2;
        const Vec2 out = quarter_turns({std::cos(angle), std::sin(angle)}, quarter);
        const Vec2 around = speed * quarter_turns(out, 1);
        const double wider = lens_.back.aperture - lens_.front.aperture, height = rims_[1] - rims_[0];
        const double radius = (1 - uv.y) * lens_.front.aperture + uv.y * lens_.back.aperture;
        SurfacePoint point;
        point.position = Vec3(radius * out, (1 - uv.y) * rims_[0] + uv.y * rims_[1]);
        point.du = Vec3(radius * around, 0);
        point.dv = Vec3(wider * out, height);
        point.duu = Vec3(-radius * speed * speed * out, 0);
        point.duv = Vec3(wider * around, 0);
        point.normal = normalize(Vec3(height * out, -wider));
        return point;
    }

    /// The first hit of those that were looked at.
    struct Nearest {
        double t_min = 0;
        double t = std::numeric_limits<double>::infinity();
        SurfaceParameter place{};
    };

    /// Where the ray starts anew, at its point nearest to one on the axis: equations have numbers of the
    /// lens' own size there.
    static double start_at(const Ray& ray, double z) {
        return dot(Vec3(0, 0, z) - ray.origin, ray.direction) / dot(ray.direction, ray.direction);
    }

    /// The conicoid c (r^2 + (1 + k) z^2) = 2 z about the side's vertex, its sheet through the vertex.
    void meet_side(Id which, const Ray& ray, Nearest& nearest) const {
        const LensSide& of = side(which);
        const double c = of.curvature, q = 1 + of.conic, start = start_at(ray, vertex(which));
        const Vec3 d = ray.direction, o = ray.origin + start * d - Vec3(0, 0, vertex(which));
        const double rim = of.aperture * (1 + kRimSlack);
        for (const double root : quadric_roots({c * (o.x * o.x + o.y * o.y + q * o.z * o.z) - 2 * o.z,
                                                c * (o.x * d.x + o.y * d.y + q * o.z * d.z) - d.z,
                                                c * (d.x * d.x + d.y * d.y + q * d.z * d.z)})) {
            const double t = start + root;
            if (!(t > nearest.t_min && t < nearest.t)) continue;
            const Vec3 point = o + root * d;
            const Vec2 p(point);
            if (!(q * c * point.z < 1) || !(length(p) <= rim)) continue;
            SurfaceParameter place = disks_[which].place(which == 0 ? mirrored(p) : p);
            place.face += which * kSideFaces;
            nearest.t = t;
            nearest.place = place;
        }
    }

    /// A cone, or a cylinder, between the rims.
    void meet_edge(const Ray& ray, Nearest& nearest) const {
        const double height = rims_[1] - rims_[0], slack = kRimSlack * lens_.front.aperture;
        const double slope = (lens_.back.aperture - lens_.front.aperture) / height;
        const double start = start_at(ray, 0.5 * (rims_[0] + rims_[1]));
        const Vec3 from = ray.origin + start * ray.direction;
        const Vec2 o(from), d(ray.direction);
        const double wide = lens_.front.aperture + slope * (from.z - rims_[0]),
                     grows = slope * ray.direction.z, distance = length(o);
        for (const double root : quadric_roots({(distance - wide) * (distance + wide),
                                                dot(o, d) - wide * grows, dot(d, d) - grows * grows})) {
            const double t = start + root;
            if (!(t > nearest.t_min && t < nearest.t)) continue;
            const Vec3 point = from + root * ray.direction;
            if (!(point.z >= rims_[0] - slack && point.z <= rims_[1] + slack)) continue;
            // The edge's quarters begin at -45 degrees.
            const Vec2 turned = Vec2(point.x - point.y, point.x + point.y);
            const auto [quarter, along] = quarter_of(turned);
            nearest.t = t;
            nearest.place = {kFirstOfEdge + quarter,
                             {along, std::clamp((point.z - rims_[0]) / height, 0.0, 1.0)}};
        }
    }

    LensPrimitive lens_;
    Vec3 center_;
    Mat3 world_from_local_;
    std::array<DiskMap, 2> disks_;
    std::array<double, 2> rims_;  // their z
    bool is_closed_form_;
    std::vector<FaceBorder> borders_ = borders_of(lens_corners());
};

}  // namespace

std::unique_ptr<Surface> make_lens_surface(const LensPrimitive& lens, const Vec3& center,
                                           const Mat3& world_from_local) {
    return std::make_unique<LensSurface>(lens, center, world_from_local);
}

}  // namespace trilens
