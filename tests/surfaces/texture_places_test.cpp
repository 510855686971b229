// Where pictures lie on surfaces: directions of u and v against differences of uv along the surface; mapped
// normals against their definition.
#include "surfaces/texture_places.h"

#include <cmath>

#include "support/draw.h"
#include "support/test.h"
#include "surfaces/normal_override.h"
#include "surfaces/surfaces.h"

using namespace trilens;
using trilens_test::Draw;

namespace {

/// Along which unit direction of the surface u (0) or v (1) alone grows, by differences.
Vec3 growth(const Surface& surface, const TexturePlaces& places, Id face, const Vec2& p, int which) {
    constexpr double kStep = 1e-5;
    const auto at = [&](const Vec2& q) {
        const SurfacePoint point = surface.eval(face, q);
        return std::pair(point.position, places(face, q, point).uv);
    };
    const auto [pa, ua] = at(p + Vec2(kStep, 0));
    const auto [pb, ub] = at(p - Vec2(kStep, 0));
    const auto [pc, uc] = at(p + Vec2(0, kStep));
    const auto [pd, ud] = at(p - Vec2(0, kStep));
    const Vec3 by_a = pa - pb, by_b = pc - pd;
    const Vec2 uv_a = ua - ub, uv_b = uc - ud;
    const double area = uv_a.x * uv_b.y - uv_a.y * uv_b.x;
    return normalize(which == 0 ? (uv_b.y * by_a - uv_a.y * by_b) / area
                                : (uv_a.x * by_b - uv_b.x * by_a) / area);
}

void check_growth(const Surface& surface, const TexturePlaces& places, Draw& draw) {
    for (int trial = 0; trial < 200; ++trial) {
        const Id face = static_cast<Id>(draw.uniform(0, 1) * static_cast<double>(surface.face_count()));
        Vec2 p(draw.uniform(0.1, 0.9), draw.uniform(0.1, 0.9));
        if (surface.domain(face) == FaceDomain::kTriangle && p.x + p.y > 0.9) p = 0.45 * p;
        const SurfacePoint point = surface.eval(face, p);
        const TexturePlace place = places(face, p, point);
        if (place.uv.x < 0.001 || place.uv.x > 0.999) continue;  // where u begins again
        CHECK(length(normalize(place.along_u) - growth(surface, places, face, p, 0)) < 1e-5);
        CHECK(length(normalize(place.along_v) - growth(surface, places, face, p, 1)) < 1e-5);
    }
}

/// A quad, a pentagon and a triangle that share edges.
Cage mixed_cage() {
    Cage cage;
    cage.points = {{0, 0, 0}, {1, 0, 0.1},     {1.1, 1, 0.3}, {0, 1, 0},
                   {2, 0, 0}, {2.4, 0.7, 0.2}, {1.8, 1.4, 0}, {0.4, 1.9, 0.4}};
    cage.face_vertex_counts = {4, 5, 3};
    cage.face_vertex_indices = {0, 1, 2, 3, 1, 4, 5, 6, 2, 3, 2, 7};
    return cage;
}

}  // namespace

TEST_CASE("a mirrored primitive has the other's picture mirrored", "[surfaces][law]") {
    Draw draw(41);
    const auto mirrored = [](const Vec3& v) { return Vec3(-v.x, v.y, v.z); };
    for (const PrimitiveKind& kind :
         {PrimitiveKind(SpherePrimitive{1.3}), PrimitiveKind(CylinderPrimitive{0.7, 2}),
          PrimitiveKind(ConePrimitive{0.7, 2}), PrimitiveKind(PlanePrimitive{{2, 3}}),
          PrimitiveKind(ParaboloidPrimitive{})}) {
        Primitive one{draw.unit(), draw.unit(), {}, kind};
        one.tangent = normalize(cross(one.axis, draw.unit()));
        Primitive other{mirrored(one.center), mirrored(one.axis), mirrored(one.tangent), kind, true};
        CAPTURE(kind_name(one));
        const auto surface = make_primitive_surface(one);
        const TexturePlaces places = places_on_primitive(one), of_other = places_on_primitive(other);
        for (int trial = 0; trial < 50; ++trial) {
            const Vec2 p(draw.uniform(0.1, 0.4), draw.uniform(0.1, 0.4));
            const SurfacePoint at = surface->eval(0, p);
            SurfacePoint there = at;
            there.position = mirrored(at.position), there.normal = mirrored(at.normal);
            const TexturePlace place = places(0, p, at), mirror = of_other(0, p, there);
            CHECK(length(place.uv - mirror.uv) < 1e-12);
            CHECK(length(mirrored(place.along_u) - mirror.along_u) < 1e-12);
            CHECK(length(mirrored(place.along_v) - mirror.along_v) < 1e-12);
        }
    }
}

TEST_CASE("u and v grow on primitives and cages where their directions say", "[surfaces][law]") {
    Draw draw(7);
    for (const PrimitiveKind& kind :
         {PrimitiveKind(SpherePrimitive{1.3}), PrimitiveKind(CylinderPrimitive{0.7, 2}),
          PrimitiveKind(ConePrimitive{0.8, 1.5}), PrimitiveKind(PlanePrimitive{{2, 3}}),
          PrimitiveKind(ParaboloidPrimitive{1, 0.8})}) {
        Primitive primitive;
        primitive.kind = kind;
        primitive.center = draw.in_cube(2);
        primitive.axis = draw.unit();
        primitive.tangent = normalize(cross(primitive.axis, draw.unit()));
        INFO(kind_name(primitive));
        check_growth(*make_primitive_surface(primitive), places_on_primitive(primitive), draw);
    }
    for (const SubdivisionScheme scheme :
         {SubdivisionScheme::kCatmullClark, SubdivisionScheme::kBilinear, SubdivisionScheme::kLoop}) {
        Cage cage = mixed_cage();
        cage.scheme = scheme;
        if (scheme == SubdivisionScheme::kLoop) {
            cage.face_vertex_counts = {3, 3};
            cage.face_vertex_indices = {0, 1, 2, 0, 2, 3};
        }
        std::vector<Vec2> uvs;
        for (const int point : cage.face_vertex_indices) {
            const Vec3& p = cage.points[static_cast<std::size_t>(point)];
            uvs.push_back({0.3 * p.x - 0.1 * p.y + 0.3, 0.2 * p.y + 0.15 * p.x});
        }
        const auto surface = make_limit_surface(cage, "mixed", {});
        const auto places = places_on_cage(*surface, cage, uvs);
        REQUIRE(places);
        check_growth(*surface, *places, draw);
        // At a face's corner: the uv that was given there.
        CHECK(length((*places)(0, {0, 0}, surface->eval(0, {0, 0})).uv - uvs[0]) < 1e-12);
        uvs.pop_back();
        CHECK(!places_on_cage(*surface, cage, uvs));
    }
}

TEST_CASE("a normal map turns a surface's normal along u and v, and nothing else", "[surfaces][law]") {
    Draw draw(8);
    Primitive ball;
    ball.kind = SpherePrimitive{2};
    const std::shared_ptr<const Surface> plain = make_primitive_surface(ball);
    const Vec3 in_map = normalize(Vec3(0.3, -0.2, 1));
    Vec2 asked(0);
    const TexturePlaces places = places_on_primitive(ball);
    const auto mapped = with_normal_map(plain, places, [&](const Vec2& uv) {
        asked = uv;
        return in_map;
    });
    for (int trial = 0; trial < 100; ++trial) {
        const Vec2 p(draw.uniform(0, 1), draw.uniform(0, 1));
        const SurfacePoint own = plain->eval(1, p), turned = mapped->eval(1, p);
        const TexturePlace place = places(1, p, own);
        CHECK(turned.position == own.position);
        CHECK(asked == place.uv);
        const Vec3 u = normalize(place.along_u), v = normalize(place.along_v);
        CHECK(std::fabs(dot(u, own.normal)) < 1e-12);
        CHECK(length(turned.normal - (in_map.x * u + in_map.y * v + in_map.z * own.normal)) < 1e-12);
        const Ray ray{own.position + 3.0 * own.normal, -own.normal};
        const auto hit = mapped->intersect(ray, 0);
        REQUIRE(hit);
        CHECK(length(hit->point.normal - turned.normal) < 1e-9);
    }
}

TEST_CASE("triangles' own tangents say where u and v grow, whatever the uv say", "[surfaces]") {
    Draw draw(9);
    Cage cage;
    cage.scheme = SubdivisionScheme::kUnsubdivided;
    cage.points = {{0, 0, 0}, {1, 0, 0.1}, {1.1, 1, 0.3}, {0, 1, 0}};
    cage.face_vertex_counts = {3, 3};
    cage.face_vertex_indices = {0, 1, 2, 0, 2, 3};
    const std::vector<Vec2> uvs{{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    const auto surface = make_limit_surface(cage, "two", {});
    const auto by_uv = places_on_cage(*surface, cage, uvs);
    REQUIRE(by_uv);
    for (const double hand : {1.0, -1.0}) {
        std::vector<Vec4> tangents;
        for (std::size_t k = 0; k < 5; ++k) tangents.emplace_back(draw.unit(), hand);
        tangents.emplace_back(0);  // so that the second triangle has none
        const auto places = places_on_cage(*surface, cage, uvs, tangents);
        REQUIRE(places);
        for (int trial = 0; trial < 20; ++trial) {
            const Vec2 p = 0.5 * Vec2(draw.uniform(0, 1), draw.uniform(0, 1));
            const SurfacePoint at = surface->eval(0, p);
            const TexturePlace place = (*places)(0, p, at);
            const Vec3 expected = Vec3((1 - p.x - p.y) * tangents[0] + p.x * tangents[1] + p.y * tangents[2]);
            CHECK(length(place.along_u - expected) < 1e-12);
            CHECK(length(place.along_v - hand * cross(at.normal, expected)) < 1e-12);
            CHECK(place.uv == (*by_uv)(0, p, at).uv);
            const SurfacePoint other = surface->eval(1, p);
            CHECK((*places)(1, p, other).along_u == (*by_uv)(1, p, other).along_u);
            CHECK((*places)(1, p, other).along_v == (*by_uv)(1, p, other).along_v);
        }
    }
}
