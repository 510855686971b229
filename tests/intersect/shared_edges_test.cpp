// Rays through edges and corners: which of the faces that meet there is hit.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "intersect/limit_tracer.h"
#include "random_scene.h"
#include "support/test.h"
#include "surfaces/surfaces.h"

using namespace trilens;
using namespace trilens_test;

namespace {

Cage cage_of(SubdivisionScheme scheme, std::vector<Vec3> points, const std::vector<std::vector<int>>& faces) {
    Cage cage;
    cage.scheme = scheme;
    cage.points = std::move(points);
    for (const std::vector<int>& face : faces) {
        cage.face_vertex_counts.push_back(static_cast<int>(face.size()));
        cage.face_vertex_indices.insert(cage.face_vertex_indices.end(), face.begin(), face.end());
    }
    return cage;
}

Cage three_sided_prism() {
    return cage_of(SubdivisionScheme::kBilinear,
                   {{-0.67, 0.9, -0.25},
                    {-0.13, 0.9, 1.15},
                    {0.81, 0.9, -0.01},
                    {-0.67, -0.9, -0.25},
                    {-0.13, -0.9, 1.15},
                    {0.81, -0.9, -0.01}},
                   {{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}});
}

/// An octahedron out of shape: eight triangles.
Cage bent_octahedron(SubdivisionScheme scheme) {
    return cage_of(scheme, {{1, 0, 0}, {-1, 0.1, 0}, {0, 1.2, 0}, {0.2, -1, 0}, {0, 0, 1.5}, {0.1, 0, -1}},
                   {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

/// A place where faces meet, and how each of them has it.
struct SharedPlace {
    Vec3 point{0};
    std::vector<std::pair<Id, Vec2>> faces;  // in rising order
};

Vec2 on_side(FaceDomain domain, std::size_t side, double share) {
    constexpr std::array<Vec2, 4> kSquare{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
    constexpr std::array<Vec2, 3> kTriangle{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
    if (domain == FaceDomain::kSquare) return (1 - share) * kSquare[side] + share * kSquare[(side + 1) % 4];
    return (1 - share) * kTriangle[side] + share * kTriangle[(side + 1) % 3];
}

/// Of a place `eighths` along a side, in sixteenths along its edge.
int place_on_edge(const FaceSide& side, int eighths) {
    const int along = side.reversed ? 8 - eighths : eighths;
    if (side.part == FaceSide::Part::kWhole) return 2 * along;
    return side.part == FaceSide::Part::kFirstHalf ? along : 8 + along;
}

/// By what the faces say of their borders, at the cage's vertices and on its edges.
std::vector<SharedPlace> shared_places(const Surface& surface, const Cage& cage) {
    std::map<std::pair<Id, int>, SharedPlace> by_corner, by_edge;
    const auto add = [&](SharedPlace& to, Id face, const Vec2& uv) {
        if (to.faces.empty()) to.point = surface.eval(face, uv).position;
        to.faces.emplace_back(face, uv);
    };
    for (Id face = 0; face < surface.face_count(); ++face) {
        const FaceDomain domain = surface.domain(face);
        const FaceBorder border = surface.border(face);
        const std::size_t sides = domain == FaceDomain::kSquare ? 4 : 3;
        for (std::size_t k = 0; k < sides; ++k) {
            if (border.corners[k] < cage.points.size())
                add(by_corner[{border.corners[k], 0}], face, on_side(domain, k, 0));
            for (int i = 1; i < 8; ++i)
                add(by_edge[{border.sides[k].edge, place_on_edge(border.sides[k], i)}], face,
                    on_side(domain, k, i / 8.0));
        }
    }
    std::vector<SharedPlace> places;
    for (const auto* all : {&by_corner, &by_edge})
        for (const auto& [key, place] : *all)
            if (place.faces.size() > 1) places.push_back(place);
    return places;
}

/// The first of the faces that the ray comes to from the front, else the first; none where it lies in one of
/// them but for rounding.
Id face_to_hit(const Surface& surface, const SharedPlace& place, const Vec3& direction) {
    Id first = kNone;
    for (const auto& [face, uv] : place.faces) {
        const double cosine = dot(surface.eval(face, uv).normal, normalize(direction));
        if (std::fabs(cosine) < 1e-6) return kNone;
        if (cosine < 0 && first == kNone) first = face;
    }
    return first == kNone ? place.faces[0].first : first;
}

}  // namespace

TEST_CASE(
    "A ray through an edge or a corner hits the first of its faces that face the ray, whatever grid finds it",
    "[intersect][law]") {
    struct Case {
        Cage cage;
        std::vector<int> grids;
    };
    const std::vector<Case> cases = {{three_sided_prism(), {1, 2, 3, 5, 16}},
                                     {bent_octahedron(SubdivisionScheme::kCatmullClark), {8, 11, 16, 24}},
                                     {bent_octahedron(SubdivisionScheme::kLoop), {8, 11, 16, 24}}};
    Random random(17);
    for (const auto& [cage, grids] : cases) {
        CAPTURE(static_cast<int>(cage.scheme));
        const auto surface = make_limit_surface(cage, "cage", {});
        std::vector<LimitTracer> tracers;
        for (const int n : grids) {
            tracers.emplace_back(*surface, make_grid(*surface, n));
            const std::vector<GridPart> parts = grid_parts(*surface, n, 4);
            tracers.emplace_back(*surface,
                                 LimitTracer::Parts{part_boxes(*surface, n, parts), [&, n, parts](Id part) {
                                                        return make_part_grid(*surface, n, parts[part]);
                                                    }});
        }
        std::size_t asked = 0, wrong = 0, mixed = 0;
        for (const SharedPlace& place : shared_places(*surface, cage))
            for (int i = 0; i < 40; ++i) {
                const Vec3 from = (i % 2 ? 3.0 : 0.2) * random.direction();
                const Ray ray{from, random.uniform(0.1, 2) * (place.point - from)};
                const Id wanted = face_to_hit(*surface, place, ray.direction);
                if (wanted == kNone) continue;
                const double t = length(place.point - from) / length(ray.direction);
                // Only what nothing hides.
                const auto nearest = tracers[0].first_hit(ray);
                if (!nearest || nearest->t < (1 - 1e-9) * t) continue;
                ++asked;
                mixed += wanted != place.faces[0].first;
                for (const LimitTracer& tracer : tracers) {
                    const auto hit = tracer.first_hit(ray);
                    wrong += !hit || hit->face != wanted || std::fabs(hit->t - t) > 1e-8;
                }
            }
        CHECK(asked > 1000);
        if (cage.scheme == SubdivisionScheme::kBilinear) CHECK(mixed > 100);
        CHECK(wrong == 0);
    }
}
