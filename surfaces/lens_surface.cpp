#include "surfaces/lens_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/description/lens_sag.h"
#include "surfaces/primitive_shapes.h"
#include "surfaces/primitives/disk_map.h"
#include "surfaces/primitives/primitive_bounds.h"

namespace trilens {
namespace {

/// Points so far beyond a rim, as a share of its size, are on it: no ray slips between a side and the edge.
constexpr double kRimSlack = 1e-12;

/// The front's disk is mirrored, for its outside looks against the axis.
Vec2 mirrored(const Vec2& p) {
    return {p.x, -p.y};
}

/// Four quarters between two rims, each given by its corners from -45 degrees on.
void add_edge(const std::array<Id, 4>& front, const std::array<Id, 4>& back,
              std::vector<std::array<Id, 4>>& corners) {
    for (std::size_t k = 0; k < 4; ++k)
        corners.push_back({front[k], front[(k + 1) % 4], back[(k + 1) % 4], back[k]});
}

/// The front's faces, the back's, the edge's, the hole's; corners of the back are numbered from 8 on.
std::vector<std::array<Id, 4>> lens_corners(bool has_hole) {
    const std::vector<std::array<Id, 4>> side = has_hole ? RingMap::corners() : DiskMap::corners();
    std::vector<std::array<Id, 4>> corners = side;
    for (std::array<Id, 4> face : side) {
        for (Id& corner : face) corner += 8;
        corners.push_back(face);
    }
    if (has_hole) {
        add_edge({5, 4, 7, 6}, {12, 13, 14, 15}, corners);
        add_edge({0, 1, 2, 3}, {9, 8, 11, 10}, corners);
    } else {
        add_edge({6, 5, 4, 7}, {13, 14, 15, 12}, corners);
    }
    return corners;
}

/// From a rim of the front straight to one of the back: a cone, or a cylinder, where both are round, and then
/// their z. A hole's is mirrored as the front is: its outside looks towards the axis.
struct Edge {
    double front_radius, back_radius;
    bool of_hole = false;
    double front_z = 0, back_z = 0;

    Vec2 turned(const Vec2& p) const { return of_hole ? mirrored(p) : p; }
};

class LensSurface final : public Surface {
  public:
    LensSurface(const LensPrimitive& lens, const Vec3& center, const Mat3& world_from_local)
        : lens_(lens),
          center_(center),
          world_from_local_(world_from_local),
          disks_{DiskMap(lens.front.aperture), DiskMap(lens.back.aperture)},
          rings_{RingMap(lens.hole, lens.front.aperture), RingMap(lens.hole, lens.back.aperture)},
          edges_{Edge{lens.front.aperture, lens.back.aperture}},
          side_faces_(lens.hole > 0 ? RingMap::kFaces : DiskMap::kFaces),
          is_closed_form_(is_conicoid(lens.front) && is_conicoid(lens.back)) {
        if (lens.hole > 0) edges_.push_back({lens.hole, lens.hole, true});
        for (Edge& edge : edges_) {
            edge.front_z = sag_over(lens.front, {edge.front_radius, 0}).z;
            edge.back_z = lens.thickness + sag_over(lens.back, {edge.back_radius, 0}).z;
        }
    }

    std::size_t face_count() const override { return borders_.size(); }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    FaceBorder border(Id face) const override { return borders_[face]; }
    bool has_closed_form() const override { return is_closed_form_; }
    std::unique_ptr<const SurfaceBounder> make_bounder() const override {
        return make_primitive_bounder(lens_, *this);
    }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        const auto clamp = [](double x) { return x > 0 ? std::min(x, 1.0) : 0.0; };
        const Vec2 inside(clamp(uv.x), clamp(uv.y));
        const Id of_edges = face - std::min(face, 2 * side_faces_);
        SurfacePoint point = face < 2 * side_faces_
                                 ? eval_side(face / side_faces_, face % side_faces_, inside)
                                 : eval_edge(edges_[of_edges / 4], of_edges % 4, inside);
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
        for (std::size_t i = 0; i < edges_.size(); ++i) meet_edge(i, local, nearest);
        if (nearest.place.face == kNone) return std::nullopt;
        return SurfaceHit{nearest.place.face, nearest.place.uv, nearest.t,
                          eval(nearest.place.face, nearest.place.uv)};
    }

  private:
    const LensSide& side(Id which) const { return which == 0 ? lens_.front : lens_.back; }
    double vertex(Id which) const { return which == 0 ? 0 : lens_.thickness; }

    SurfacePoint eval_side(Id which, Id face, const Vec2& uv) const {
        DiskMap::Flat flat = edges_.size() > 1 ? rings_[which].at(face, uv) : disks_[which].at(face, uv);
        if (which == 0)
            for (Vec2* part : {&flat.p, &flat.u, &flat.v, &flat.uu, &flat.uv, &flat.vv})
                *part = mirrored(*part);
        const SideSag sag = sag_over(side(which), flat.p);
        const auto second = [&](const Vec2& a, const Vec2& b, const Vec2& ab) {
            return Vec3(ab, sag.bend(a, b) + dot(sag.slope, ab));
        };
        SurfacePoint point;
        point.position = Vec3(flat.p, vertex(which) + sag.z);
        point.du = Vec3(flat.u, dot(sag.slope, flat.u));
        point.dv = Vec3(flat.v, dot(sag.slope, flat.v));
        point.duu = second(flat.u, flat.u, flat.uu);
        point.duv = second(flat.u, flat.v, flat.uv);
        point.dvv = second(flat.v, flat.v, flat.vv);
        point.normal = normalize(Vec3(-sag.slope, 1.0)) * (which == 0 ? -1.0 : 1.0);
        return point;
    }

    SurfacePoint eval_edge(const Edge& edge, Id quarter, const Vec2& uv) const {
        const double angle = kHalfTurn / 4 * (2 * uv.x - 1), speed = kHalfTurn / 2;
        const Vec2 unturned = quarter_turns({std::cos(angle), std::sin(angle)}, quarter);
        const Vec2 out = edge.turned(unturned), around = speed * edge.turned(quarter_turns(unturned, 1));
        const double wider = edge.back_radius - edge.front_radius;
        const double radius = (1 - uv.y) * edge.front_radius + uv.y * edge.back_radius;
        const RimPoint front = rim_point(0, edge.front_radius, out, around),
                       back = rim_point(1, edge.back_radius, out, around);
        const double height = back.z - front.z;
        const auto between = [&uv](double a, double b) { return (1 - uv.y) * a + uv.y * b; };
        SurfacePoint point;
        point.position = Vec3(radius * out, between(front.z, back.z));
        point.du = Vec3(radius * around, between(front.u, back.u));
        point.dv = Vec3(wider * out, height);
        point.duu = Vec3(-radius * speed * speed * out, between(front.uu, back.uu));
        point.duv = Vec3(wider * around, back.u - front.u);
        if (is_round(lens_.front) && is_round(lens_.back))
            point.normal = normalize(Vec3(height * out, -wider)) * (edge.of_hole ? -1.0 : 1.0);
        else
            point.normal = normalize(cross(point.du, point.dv));
        return point;
    }

    /// z of a rim, by how far it is turned.
    struct RimPoint {
        double z, u, uu;
    };
    RimPoint rim_point(Id which, double radius, const Vec2& out, const Vec2& around) const {
        if (is_round(side(which))) return {vertex(which) + sag_at(side(which), radius * radius).z, 0, 0};
        const SideSag sag = sag_over(side(which), radius * out);
        const Vec2 along = radius * around;
        return {vertex(which) + sag.z, dot(sag.slope, along),
                sag.bend(along, along) - dot(around, around) * dot(sag.slope, radius * out)};
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
            if (!(length(p) >= lens_.hole * (1 - kRimSlack))) continue;
            const Vec2 turned = which == 0 ? mirrored(p) : p;
            SurfaceParameter place =
                edges_.size() > 1 ? rings_[which].place(turned) : disks_[which].place(turned);
            place.face += which * side_faces_;
            nearest.t = t;
            nearest.place = place;
        }
    }

    void meet_edge(std::size_t which, const Ray& ray, Nearest& nearest) const {
        const Edge& edge = edges_[which];
        const double height = edge.back_z - edge.front_z, slack = kRimSlack * edge.front_radius;
        const double slope = (edge.back_radius - edge.front_radius) / height;
        const double start = start_at(ray, 0.5 * (edge.front_z + edge.back_z));
        const Vec3 from = ray.origin + start * ray.direction;
        const Vec2 o(from), d(ray.direction);
        const double wide = edge.front_radius + slope * (from.z - edge.front_z),
                     grows = slope * ray.direction.z, distance = length(o);
        for (const double root : quadric_roots({(distance - wide) * (distance + wide),
                                                dot(o, d) - wide * grows, dot(d, d) - grows * grows})) {
            const double t = start + root;
            if (!(t > nearest.t_min && t < nearest.t)) continue;
            const Vec3 point = from + root * ray.direction;
            if (!(point.z >= edge.front_z - slack && point.z <= edge.back_z + slack)) continue;
            // The edge's quarters begin at -45 degrees.
            const Vec2 p = edge.turned(Vec2(point));
            const auto [quarter, along] = quarter_of(Vec2(p.x - p.y, p.x + p.y));
            nearest.t = t;
            nearest.place = {2 * side_faces_ + 4 * static_cast<Id>(which) + quarter,
                             {along, std::clamp((point.z - edge.front_z) / height, 0.0, 1.0)}};
        }
    }

    LensPrimitive lens_;
    Vec3 center_;
    Mat3 world_from_local_;
    std::array<DiskMap, 2> disks_;
    std::array<RingMap, 2> rings_;  // instead of disks, around a hole
    std::vector<Edge> edges_;       // the outer one, then the hole's
    Id side_faces_;
    bool is_closed_form_;
    std::vector<FaceBorder> borders_ = borders_of(lens_corners(lens_.hole > 0));
};

}  // namespace

std::unique_ptr<Surface> make_lens_surface(const LensPrimitive& lens, const Vec3& center,
                                           const Mat3& world_from_local) {
    return std::make_unique<LensSurface>(lens, center, world_from_local);
}

}  // namespace trilens
