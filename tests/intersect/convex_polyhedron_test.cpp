// Segments against convex polyhedra: as Newton's method on their faces has them, and which surfaces are such.
#include "intersect/convex_polyhedron.h"

#include <map>

#include "intersect/limit_tracer.h"
#include "support/draw.h"
#include "support/test.h"
#include "test_surfaces.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Flat faces of three or four corners each, all of one kind, counter-clockwise seen from the front.
class FlatFaces final : public Surface {
  public:
    FlatFaces(std::vector<Vec3> points, std::vector<std::vector<Id>> faces, bool tells = true)
        : points_(std::move(points)), faces_(std::move(faces)), tells_(tells) {}
    std::size_t face_count() const override { return faces_.size(); }
    FaceDomain domain(Id) const override {
        return faces_[0].size() == 4 ? FaceDomain::kSquare : FaceDomain::kTriangle;
    }
    bool is_flat(Id) const override { return tells_; }
    FaceBorder border(Id face) const override {
        FaceBorder border;
        const std::vector<Id>& corner = faces_[face];
        for (std::size_t k = 0; k < corner.size(); ++k) {
            const Id a = corner[k], b = corner[(k + 1) % corner.size()];
            border.corners[k] = a;
            border.sides[k] = {static_cast<Id>(points_.size()) * std::min(a, b) + std::max(a, b),
                               FaceSide::Part::kWhole, a > b};
        }
        return border;
    }
    SurfacePoint eval(Id face, const Vec2& at) const override {
        const Vec2 uv = clamped(domain(face), at);
        const std::vector<Id>& corner = faces_[face];
        const Vec3 &a = points_[corner[0]], &b = points_[corner[1]], &d = points_[corner.back()];
        const Vec3 twist = corner.size() == 4 ? a - b + points_[corner[2]] - d : Vec3(0);
        SurfacePoint p;
        p.position = a + uv.x * (b - a) + uv.y * (d - a) + uv.x * uv.y * twist;
        p.du = b - a + uv.y * twist;
        p.dv = d - a + uv.x * twist;
        p.duv = twist;
        set_normal(p);
        return p;
    }
    const std::vector<Vec3>& points() const { return points_; }

  private:
    std::vector<Vec3> points_;
    std::vector<std::vector<Id>> faces_;
    bool tells_;
};

const std::vector<std::vector<Id>> kBoxFaces{{4, 5, 7, 6}, {1, 0, 2, 3}, {5, 1, 3, 7},
                                             {0, 4, 6, 2}, {6, 7, 3, 2}, {0, 1, 5, 4}};

/// A frustum of a sheared box, its front as given or turned in.
FlatFaces random_box(Draw& draw, bool turned, bool tells) {
    const Vec3 middle = draw.in_cube(3), x = draw.away(0.1, 2), y = draw.away(0.1, 2);
    const Vec3 z =
        draw.uniform(0.1, 2) * normalize(cross(x, y) + 0.3 * draw.in_cube(1) * length(cross(x, y)));
    const double narrow = draw.uniform(0.3, 1);
    std::vector<Vec3> points;
    for (int i = 0; i < 8; ++i) {
        const double size = i & 4 ? narrow : 1;
        points.push_back(middle + size * (i & 1 ? 1.0 : -1.0) * x + size * (i & 2 ? 1.0 : -1.0) * y +
                         (i & 4 ? 1.0 : -1.0) * z);
    }
    std::vector<std::vector<Id>> faces = kBoxFaces;
    if (turned)
        for (std::vector<Id>& face : faces) std::swap(face[1], face[3]);
    return {points, faces, tells};
}

FlatFaces random_tetrahedron(Draw& draw, bool tells) {
    std::vector<Vec3> points{draw.in_cube(1), draw.in_cube(1), draw.in_cube(1), draw.in_cube(1)};
    if (triple(points[1] - points[0], points[2] - points[0], points[3] - points[0]) < 0)
        std::swap(points[0], points[1]);
    return {points, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, tells};
}

}  // namespace

TEST_CASE("a convex polyhedron is met between two points where the first hit says, at edges and corners too",
          "[intersect][law]") {
    int met = 0, missed = 0, different = 0, grazing = 0;
    for (int body = 0; body < 40; ++body) {
        const auto made = [&](bool tells) {
            Draw draw(static_cast<std::uint64_t>(50 + body));
            return body % 4 == 3 ? random_tetrahedron(draw, tells) : random_box(draw, body % 2 == 1, tells);
        };
        const FlatFaces told = made(true), untold = made(false);
        REQUIRE(ConvexPolyhedron::of(told));
        REQUIRE_FALSE(ConvexPolyhedron::of(untold));
        const LimitTracer clipped(told, grid_of(told, 2)), solved(untold, grid_of(untold, 2));
        Draw draw(static_cast<std::uint64_t>(1000 + body));
        const std::vector<Vec3>& points = told.points();
        const auto corner = [&] {
            return points[static_cast<std::size_t>(draw.uniform(0, static_cast<double>(points.size())))];
        };
        for (int i = 0; i < 1500; ++i) {
            const Vec3 from = i % 5 == 0
                                  ? told.eval(static_cast<Id>(i) % 4, {draw.uniform(0, 1), 0.3}).position
                                  : draw.in_cube(6);
            Vec3 to = draw.in_cube(4);
            if (i % 3 == 1) to = corner();
            if (i % 3 == 2) {
                const double share = draw.uniform(0, 1);
                to = share * corner() + (1 - share) * corner();
            }
            if (i % 4 == 0) to += draw.log_uniform(1e-15, 1e-6) * draw.unit();
            const Ray ray{from, draw.log_uniform(0.1, 10) * (to - from)};
            const double t_min = i % 2 == 0 ? 1e-6 : draw.uniform(0, 0.5), t_max = t_min + draw.uniform(0, 1);
            const bool meets = clipped.meets(ray, t_min, t_max);
            if (meets != solved.meets(ray, t_min, t_max)) {
                // Only where the last bits decide: then not far beside it the other answer holds.
                ++different;
                int as_solved = 0;
                for (int k = 0; k < 30; ++k) {
                    const Ray beside{ray.origin + 1e-9 * draw.unit(), ray.direction};
                    as_solved += clipped.meets(beside, t_min, t_max) != meets;
                }
                CHECK(as_solved > 0);
            }
            const auto known = ConvexPolyhedron::of(told)->meets(ray, t_min, t_max);
            grazing += !known;
            met += meets;
            missed += !meets;
        }
    }
    INFO(met << " met, " << missed << " missed, " << grazing << " undecided, " << different << " different");
    CHECK(different < 30);
    CHECK(met > 5000);
    CHECK(missed > 5000);
    CHECK(grazing < 30000);  // most of them aim at edges
}

TEST_CASE("a convex polyhedron's first hit in closed form is the one that is solved for", "[intersect][law]") {
    int met = 0, missed = 0, undecided = 0;
    double worst = 0;
    for (int body = 0; body < 40; ++body) {
        const auto made = [&](bool tells) {
            Draw draw(static_cast<std::uint64_t>(350 + body));
            return body % 4 == 3 ? random_tetrahedron(draw, tells) : random_box(draw, body % 2 == 1, tells);
        };
        const FlatFaces told = made(true), untold = made(false);
        const ConvexPolyhedron polyhedron = *ConvexPolyhedron::of(told);
        const LimitTracer solved(untold, grid_of(untold, 2));
        Draw draw(static_cast<std::uint64_t>(2000 + body));
        for (int i = 0; i < 1500; ++i) {
            // From outside, from a face, and from inside; at an edge or a corner and just beside it.
            Vec3 from = draw.in_cube(6), to = draw.in_cube(4);
            const Vec2 place(draw.uniform(0, 0.5), draw.uniform(0, 0.5));
            if (i % 3 == 1) from = told.eval(static_cast<Id>(i) % 4, place).position;
            if (i % 3 == 2) from = 0.5 * (told.points()[0] + told.points()[3]);
            if (i % 5 == 0) to = told.eval(static_cast<Id>(i) % 4, {0, place.y}).position;
            if (i % 5 == 1) to = told.eval(static_cast<Id>(i) % 4, {0, place.y}).position + 1e-7 * draw.unit();
            const Ray ray{from, draw.log_uniform(0.1, 10) * (to - from)};
            const double t_min = i % 2 == 0 ? solved.self_hit_t_min(ray) : draw.uniform(0, 0.5);
            const std::optional<SurfaceHit> expected = solved.first_hit(ray, t_min);
            std::optional<SurfaceHit> hit;
            if (!polyhedron.find_first_hit(ray, t_min, hit)) {
                ++undecided;
                continue;
            }
            REQUIRE(hit.has_value() == expected.has_value());
            (hit ? met : missed) += 1;
            if (!hit) continue;
            CHECK(hit->face == expected->face);
            const double far = length(from) + length(hit->point.position);
            const Vec3 off = hit->point.position - expected->point.position;
            const double steep = std::fabs(dot(hit->point.normal, normalize(ray.direction)));
            worst = std::max(worst, steep * length(off) / far);
            CHECK(length(from + hit->t * ray.direction - hit->point.position) <= 1e-13 * far);
            CHECK(length(hit->point.normal - expected->point.normal) < 1e-13);
            const SurfacePoint there = told.eval(hit->face, hit->uv);
            CHECK(length(there.position - hit->point.position) <= 1e-14 * far);
            CHECK(length(there.du - hit->point.du) + length(there.dv - hit->point.dv) <= 1e-14 * far);
        }
    }
    INFO(met << " met, " << missed << " missed, " << undecided << " undecided; off by " << worst);
    CHECK(worst < 1e-13);
    CHECK(met > 15000);
    CHECK(missed > 10000);
    CHECK(undecided < 18000);
}

TEST_CASE("bodies that are open, dented, folded or turned in parts are no convex polyhedra", "[intersect]") {
    Draw draw(7);
    const FlatFaces box = random_box(draw, false, true);
    REQUIRE(ConvexPolyhedron::of(box));
    std::vector<std::vector<Id>> faces = kBoxFaces;
    faces.pop_back();
    CHECK_FALSE(ConvexPolyhedron::of(FlatFaces(box.points(), faces)));
    faces = kBoxFaces;
    std::swap(faces[0][1], faces[0][3]);
    CHECK_FALSE(ConvexPolyhedron::of(FlatFaces(box.points(), faces)));
    std::vector<Vec3> points = box.points();
    points.push_back(box.eval(2, {0.5, 0.5}).position * 0.8 + 0.2 * box.eval(3, {0.5, 0.5}).position);
    // One side as four triangles that meet inside of the body, and all others as two.
    std::vector<std::vector<Id>> dented;
    for (std::size_t f = 0; f < kBoxFaces.size(); ++f) {
        const std::vector<Id>& q = kBoxFaces[f];
        if (f != 2) {
            dented.push_back({q[0], q[1], q[2]});
            dented.push_back({q[0], q[2], q[3]});
        } else {
            for (std::size_t k = 0; k < 4; ++k) dented.push_back({q[k], q[(k + 1) % 4], 8});
        }
    }
    CHECK_FALSE(ConvexPolyhedron::of(FlatFaces(points, dented)));
    points.back() = box.eval(2, {0.5, 0.5}).position;
    CHECK(ConvexPolyhedron::of(FlatFaces(points, dented)));
    // Sheets of two sides each, which lie on a box and do not close it.
    std::vector<std::vector<Id>> sheets;
    for (const std::size_t f : {0, 1}) {
        sheets.push_back(kBoxFaces[f]);
        sheets.push_back({kBoxFaces[f][0], kBoxFaces[f][3], kBoxFaces[f][2], kBoxFaces[f][1]});
    }
    CHECK_FALSE(ConvexPolyhedron::of(FlatFaces(box.points(), sheets)));
}
