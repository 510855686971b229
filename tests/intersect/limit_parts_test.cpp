// Surfaces that are prepared as far as rays come, against such as are prepared whole.
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "intersect/limit_tracer.h"
#include "random_scene.h"
#include "support/test.h"
#include "surfaces/surfaces.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("a surface prepared face by face, as rays come, is met where one prepared whole is",
          "[intersect][law]") {
    Random random(81);
    // An octahedron out of shape: sub-faces of triangles, or triangles under Loop.
    for (const SubdivisionScheme scheme : {SubdivisionScheme::kCatmullClark, SubdivisionScheme::kLoop}) {
        Cage cage;
        cage.scheme = scheme;
        cage.points = {{1, 0, 0}, {-1, 0.1, 0}, {0, 1.2, 0}, {0.2, -1, 0}, {0, 0, 1.5}, {0.1, 0, -1}};
        for (const int pole : {4, 5})
            for (int k = 0; k < 4; ++k) {
                constexpr std::array<int, 4> kRing{0, 2, 1, 3};
                const int a = kRing[static_cast<std::size_t>(k)],
                          b = kRing[static_cast<std::size_t>((k + 1) % 4)];
                cage.face_vertex_counts.push_back(3);
                for (const int v : {pole == 4 ? a : b, pole == 4 ? b : a, pole})
                    cage.face_vertex_indices.push_back(v);
            }
        const auto surface = make_limit_surface(cage, "cage", {});
        const LimitTracer whole(*surface, make_grid(*surface, 16));
        const std::vector<Box> hulls = face_hulls(*surface);
        REQUIRE(hulls.size() == surface->face_count());
        for (Id face = 0; face < surface->face_count(); ++face)
            for (int i = 0; i < 50; ++i) {
                double u = random.uniform(0, 1), v = random.uniform(0, 1);
                if (surface->domain(face) == FaceDomain::kTriangle && u + v > 1) u = 1 - u, v = 1 - v;
                CHECK(hulls[face].holds(surface->eval(face, {u, v}).position));
            }
        std::set<Id> made;
        const LimitTracer by_face(*surface, {hulls, [&](Id face) {
                                                 made.insert(face);
                                                 return make_part_grid(*surface, 5, {face, 0, 0, 5});
                                             }});
        CHECK(made.empty());
        int met = 0, unlike = 0;
        for (int i = 0; i < 3000; ++i) {
            const Vec3 from = 3.0 * random.direction(), at = 0.8 * random.uniform(0, 1) * random.direction();
            const Ray ray{from, at - from};
            const auto one = whole.first_hit(ray), other = by_face.first_hit(ray);
            met += one.has_value();
            unlike += one.has_value() != other.has_value() || (one && std::fabs(one->t - other->t) > 1e-9);
        }
        CHECK(met > 1500);
        CHECK(unlike == 0);
        CHECK(made.size() == surface->face_count());

        // Parts of faces: the same facets, so the same candidates and the same hits but for the rounding of
        // points that faces share.
        const std::vector<GridPart> parts = grid_parts(*surface, 16, 4);
        const std::vector<Box> boxes = part_boxes(*surface, 16, parts);
        REQUIRE(boxes.size() == parts.size());
        std::set<Id> parts_made;
        const LimitTracer by_part(*surface, {boxes, [&](Id part) {
                                                 parts_made.insert(part);
                                                 return make_part_grid(*surface, 16, parts[part]);
                                             }});
        CHECK(parts_made.empty());
        int in_parts = 0;
        for (int i = 0; i < 3000; ++i) {
            const Vec3 from = 3.0 * random.direction(), at = 0.8 * random.uniform(0, 1) * random.direction();
            const Ray ray{from, at - from};
            const auto one = whole.first_hit(ray), other = by_part.first_hit(ray);
            in_parts += one.has_value();
            CHECK(one.has_value() == other.has_value());
            if (one && other) CHECK(std::fabs(one->t - other->t) <= 1e-12);
        }
        CHECK(in_parts > 1500);
        CHECK(parts_made.size() > parts.size() / 2);
        const std::size_t made_at_once = parts_made.size();
        by_part.first_hit({{9, 9, 9}, {1, 0, 0}});
        CHECK(parts_made.size() == made_at_once);
    }
}
