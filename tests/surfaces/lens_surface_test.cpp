// Laws of lenses' surfaces: sides and edge close, hits are the first, and both agree with the solid.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "base/description/lens_sag.h"
#include "base/util/error.h"
#include "support/draw.h"
#include "support/test.h"
#include "surfaces/surfaces.h"

using namespace trilens;
using namespace trilens_test;

namespace {

LensPrimitive lens_of(double thickness, const LensSide& front, const LensSide& back) {
    return {thickness, front, back};
}

/// Biconvex with unlike rims, meniscus, plano-concave, hyperboloid before ellipsoid, plate; the first with a
/// hole.
std::vector<LensPrimitive> conicoid_lenses() {
    return {lens_of(0.9, {0.5, 0, {}, 1.2}, {-0.4, 0, {}, 0.9}),
            lens_of(0.3, {0.6, 0, {}, 1.1}, {0.7, 0, {}, 0.8}),
            lens_of(0.2, {-0.5, 0, {}, 1.0}, {0, 0, {}, 1.3}),
            lens_of(1.1, {0.9, -2.5, {}, 0.9}, {-0.6, 1.3, {}, 0.7}),
            lens_of(0.4, {0, 0, {}, 1}, {0, 0, {}, 1}),
            {0.9, {0.5, 0, {}, 1.2}, {-0.4, 0, {}, 0.9}, 0.3}};
}

LensPrimitive aspheric_lens() {
    return lens_of(0.8, {0.5, -1, {0.03, -0.02, 0.01}, 1.1}, {-0.2, 0, {0, 0.015, 0, -0.004}, 1});
}

/// Whose front departs along its sphere's normals, with a hole.
LensPrimitive holed_asphere() {
    LensPrimitive lens = aspheric_lens();
    lens.front = {0.5, 0, {}, 1.1, {0.03, -0.02, 0.01}};
    lens.hole = 0.4;
    return lens;
}

/// A biconic saddle before a toric side that is an asphere along x, with rims of other sizes; and two
/// cylinders that cross, with a hole.
std::vector<LensPrimitive> anamorphic_lenses() {
    LensSide biconic{0.4, -0.5, {}, 1.2}, toric{-0.3, 0.4, {0.01, -0.02}, 0.9}, along{0.5, 0, {}, 1.1};
    biconic.form = SideForm::kBiconic;
    biconic.across_curvature = -0.2;
    biconic.across_conic = 1.5;
    toric.form = SideForm::kToricX;
    toric.across_curvature = -0.5;
    along.form = SideForm::kToricY;
    LensSide across = along;
    across.form = SideForm::kToricX;
    across.curvature = -0.5;
    return {lens_of(1, biconic, toric), {0.9, along, across, 0.3}};
}

double sag(const LensSide& side, const Vec2& p) {
    return sag_over(side, p).z;
}

/// By the solid's own definition: between the sides, and within the edge.
bool is_in_solid(const LensPrimitive& lens, const Vec3& p) {
    const double r = std::hypot(p.x, p.y);
    const Vec2 across(p), out = across / r;
    const double low = sag(lens.front, lens.front.aperture * out),
                 high = lens.thickness + sag(lens.back, lens.back.aperture * out);
    const double share = (r - lens.front.aperture) / (lens.back.aperture - lens.front.aperture);
    const double edge = low + share * (high - low);  // z of the edge at r
    if (r > std::max(lens.front.aperture, lens.back.aperture) || r < lens.hole) return false;
    const double before = r <= lens.front.aperture ? sag(lens.front, across) : edge;
    const double behind = r <= lens.back.aperture ? lens.thickness + sag(lens.back, across) : edge;
    return p.z > before && p.z < behind;
}

/// Where a ray comes into the solid, or out of it, by small steps and bisection.
std::optional<double> first_change(const LensPrimitive& lens, const Ray& ray, double from, double to) {
    constexpr int kSteps = 4000;
    const bool inside = is_in_solid(lens, ray.origin + from * ray.direction);
    for (int i = 1; i <= kSteps; ++i) {
        double high = from + (to - from) * i / kSteps, low = from + (to - from) * (i - 1) / kSteps;
        if (is_in_solid(lens, ray.origin + high * ray.direction) == inside) continue;
        for (int k = 0; k < 60; ++k) {
            const double middle = 0.5 * (low + high);
            (is_in_solid(lens, ray.origin + middle * ray.direction) == inside ? low : high) = middle;
        }
        return high;
    }
    return std::nullopt;
}

std::unique_ptr<Surface> surface_of(const LensPrimitive& lens) {
    return make_primitive_surface({.axis = {0, 0, 1}, .kind = lens});
}

}  // namespace

TEST_CASE("points of lenses lie on sides and edge, with normals out of the glass and exact derivatives",
          "[surfaces][oracle]") {
    std::vector<LensPrimitive> lenses = conicoid_lenses();
    lenses.push_back(aspheric_lens());
    lenses.push_back(holed_asphere());
    for (const LensPrimitive& lens : anamorphic_lenses()) lenses.push_back(lens);
    Draw draw(3);
    for (const LensPrimitive& lens : lenses) {
        const auto surface = surface_of(lens);
        const Id of_side = lens.hole > 0 ? 4 : 5, faces = lens.hole > 0 ? 16 : 14;
        REQUIRE(surface->face_count() == faces);
        for (Id face = 0; face < faces; ++face)
            for (int k = 0; k < 20; ++k) {
                CAPTURE(face, k);
                const double u = draw.uniform(0.01, 0.99), v = draw.uniform(0.01, 0.99);
                const SurfacePoint point = surface->eval(face, {u, v});
                const Vec3& p = point.position;
                if (face < of_side) CHECK(std::fabs(p.z - sag(lens.front, Vec2(p))) < 1e-14);
                if (face >= of_side && face < 2 * of_side)
                    CHECK(std::fabs(p.z - lens.thickness - sag(lens.back, Vec2(p))) < 1e-14);
                CHECK(std::fabs(length(point.normal) - 1) < 1e-14);
                CHECK(dot(point.normal, cross(point.du, point.dv)) > 0);
                CHECK(is_in_solid(lens, p - 1e-6 * point.normal));
                CHECK_FALSE(is_in_solid(lens, p + 1e-6 * point.normal));
                constexpr double kStep = 1e-5;
                const auto change = [&](const Vec2& step, Vec3 SurfacePoint::*of) {
                    const Vec2 at(u, v);
                    return (surface->eval(face, at + kStep * step).*of -
                            surface->eval(face, at - kStep * step).*of) /
                           (2 * kStep);
                };
                CHECK(length(change({1, 0}, &SurfacePoint::position) - point.du) < 1e-8);
                CHECK(length(change({0, 1}, &SurfacePoint::position) - point.dv) < 1e-8);
                CHECK(length(change({1, 0}, &SurfacePoint::du) - point.duu) < 1e-7);
                CHECK(length(change({0, 1}, &SurfacePoint::du) - point.duv) < 1e-7);
                CHECK(length(change({0, 1}, &SurfacePoint::dv) - point.dvv) < 1e-7);
            }
    }
}

TEST_CASE("a lens' grid is closed: every edge of facets is that of two, with one direction each",
          "[surfaces][law]") {
    std::vector<LensPrimitive> lenses = conicoid_lenses();
    lenses.push_back(aspheric_lens());
    lenses.push_back(holed_asphere());
    for (const LensPrimitive& lens : anamorphic_lenses()) lenses.push_back(lens);
    for (const LensPrimitive& lens : lenses) {
        const SurfaceGrid grid = make_grid(*surface_of(lens), 4);
        std::vector<std::pair<Id, Id>> edges;
        for (const IdTriple& facet : grid.facets)
            for (std::size_t k = 0; k < 3; ++k)
                edges.emplace_back(grid.corner_point[facet[k]], grid.corner_point[facet[(k + 1) % 3]]);
        std::sort(edges.begin(), edges.end());
        CHECK(std::adjacent_find(edges.begin(), edges.end()) == edges.end());
        const bool closed = std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
            return std::binary_search(edges.begin(), edges.end(), std::pair(edge.second, edge.first));
        });
        CHECK(closed);
        // Its volume by the divergence theorem is positive: fronts look out of the glass.
        double volume = 0;
        for (const IdTriple& facet : grid.facets)
            volume += dot(
                grid.points[grid.corner_point[facet[0]]],
                cross(grid.points[grid.corner_point[facet[1]]], grid.points[grid.corner_point[facet[2]]]));
        CHECK(volume > 0);
    }
}

TEST_CASE("rays meet a lens first where they come into its solid, and then where they leave it",
          "[surfaces][oracle]") {
    Draw draw(7);
    std::size_t met = 0;
    for (const LensPrimitive& lens : conicoid_lenses()) {
        const auto surface = surface_of(lens);
        REQUIRE(surface->has_closed_form());
        for (int k = 0; k < 120; ++k) {
            const Vec3 origin = draw.away(3, 5), target = draw.in_cube(1.2);
            const Ray ray{origin, normalize(target + Vec3(0, 0, 0.3) - origin)};
            const auto hit = surface->intersect(ray, 0);
            const auto truth = first_change(lens, ray, 0, 10);
            CAPTURE(k, origin.x, origin.y, origin.z, hit ? hit->t : -1, truth.value_or(-1));
            // Steps of the search are 0.0025 long: a ray that is inside for less may be missed.
            if (!truth) {
                if (hit) {
                    const auto next = surface->intersect(ray, hit->t + 1e-9);
                    REQUIRE(next);
                    CHECK(next->t - hit->t < 0.0026);
                }
                continue;
            }
            ++met;
            REQUIRE(hit);
            CHECK(std::fabs(hit->t - *truth) < 1e-9);
            CHECK(length(hit->point.position - ray.origin - hit->t * ray.direction) < 1e-12);
            CHECK(dot(hit->point.normal, ray.direction) < 1e-9);
            CHECK(surface->meets(ray, 0, hit->t + 1e-9));
            CHECK_FALSE(surface->meets(ray, 0, hit->t - 1e-9));
            const auto out = surface->intersect(ray, hit->t + 1e-9);
            const auto out_truth = first_change(lens, ray, hit->t + 1e-7, 10);
            REQUIRE(out);
            if (out_truth) CHECK(std::fabs(out->t - *out_truth) < 1e-9);
        }
    }
    CHECK(met > 200);
}

TEST_CASE("no ray slips between a lens' sides and its edge", "[surfaces][law]") {
    Draw draw(9);
    for (const LensPrimitive& lens : conicoid_lenses()) {
        const auto surface = surface_of(lens);
        for (int k = 0; k < 2000; ++k) {
            // From the middle straight at a place of a rim, which is a corner or an edge of faces.
            const bool of_front = k % 2 == 0;
            const LensSide& side = of_front ? lens.front : lens.back;
            const double turn = k % 3 == 0 ? 0.7853981633974483 * (k % 8) : draw.uniform(0, 6.3);
            const Vec3 rim(side.aperture * std::cos(turn), side.aperture * std::sin(turn),
                           (of_front ? 0 : lens.thickness) + sag(side, {side.aperture, 0}));
            const Vec3 middle(0, 0, 0.5 * lens.thickness);
            CHECK(surface->intersect({middle, rim - middle}, 0));
        }
    }
}

TEST_CASE("aspheric lenses have no closed form, and lenses that cannot be made are refused",
          "[surfaces][bad-input]") {
    CHECK_FALSE(surface_of(aspheric_lens())->has_closed_form());
    for (const LensPrimitive& lens : anamorphic_lenses()) CHECK_FALSE(surface_of(lens)->has_closed_form());
    const auto refused = [](const LensPrimitive& lens, const std::string& why) {
        try {
            surface_of(lens);
        } catch (const InputError& error) {
            return std::string(error.what()).find(why) != std::string::npos;
        }
        return false;
    };
    CHECK(refused(lens_of(0.5, {1, 0, {}, 1}, {0, 0, {}, 1}), "turns back"));
    CHECK(refused(lens_of(0.3, {0.5, 0, {}, 1}, {-0.5, 0, {}, 1}), "sides meet"));
    CHECK(refused(lens_of(0, {0, 0, {}, 1}, {0, 0, {}, 1}), "thickness must be a positive number"));
    CHECK(refused(lens_of(1, {0, 0, {}, -1}, {0, 0, {}, 1}), "aperture must be a positive number"));
}
