// The kinds of general linear cameras: rays built as each kind is defined, and the criterion of Yu and
// McMillan in their own coordinates as a second answer.
#include "camera/model/general_linear.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "camera/camera.h"
#include "every_camera.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

using Rays = std::array<Ray, 3>;

GeneralLinearKind kind_of(const Rays& rays) {
    const auto camera = general_linear_camera(rays, {0, 0, 1}, 1e-7);
    REQUIRE(camera);
    return camera->kind;
}

/// A ray that meets both lines, at those places along them.
Ray through(const Ray& one, double at_one, const Ray& other, double at_other) {
    const Vec3 from = one.origin + at_one * one.direction;
    return {from, other.origin + at_other * other.direction - from};
}

/// Anywhere on their lines, any length, the same sense.
Rays shaken(Rays rays, Draw& draw) {
    for (Ray& ray : rays) {
        ray.origin += draw.uniform(-0.5, 0.5) * ray.direction;
        ray.direction *= draw.uniform(0.5, 2);
    }
    return rays;
}

/// The characteristic equation as the paper writes it: rays [s, t, u, v] between z = 0 and z = 1.
struct Characteristic {
    double a = 0, b = 0, c = 0;
};
Characteristic characteristic(const Rays& rays) {
    std::array<double, 3> s, t, u, v;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 at0 = rays[k].origin - rays[k].origin.z / rays[k].direction.z * rays[k].direction;
        const Vec3 at1 = at0 + rays[k].direction / rays[k].direction.z;
        s[k] = at0.x, t[k] = at0.y, u[k] = at1.x, v[k] = at1.y;
    }
    const auto det = [](const std::array<double, 3>& p, const std::array<double, 3>& q) {
        return p[0] * (q[1] - q[2]) - q[0] * (p[1] - p[2]) + (p[1] * q[2] - p[2] * q[1]);
    };
    std::array<double, 3> du, dv;
    for (std::size_t k = 0; k < 3; ++k) du[k] = u[k] - s[k], dv[k] = v[k] - t[k];
    return {det(du, dv), det(s, v) - det(t, u) - 2 * det(s, t), det(s, t)};
}

}  // namespace

TEST_CASE("a general linear camera combines its rays from the eye's plane, their directions of unit depth",
          "[camera]") {
    Draw draw(8);
    for (int round = 0; round < 50; ++round) {
        CameraDescription from;
        from.eye = draw.in_cube(1);
        from.at = from.eye + draw.away(1, 3);
        const Vec3 w = normalize(from.at - from.eye);
        ThreeRayCamera kind;
        std::array<Vec3, 3> direction, point;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 p = from.eye + draw.in_cube(2);
            const Vec3 d = draw.uniform(0.3, 4) * (w + draw.in_cube(0.5));
            const double across = draw.uniform(0, 1);
            const Vec2 at = k == 0 ? Vec2(0.1 * across, 0) : k == 1 ? Vec2(1, across) : Vec2(0, 1);
            kind.placed_rays[k] = {p, d, at};
            direction[k] = d / dot(d, w);
            point[k] = p - dot(p - from.eye, w) * direction[k];
        }
        from.kind = kind;
        from.up = unit_across(w);
        const Camera camera = make_camera(from, {61, 47});
        for (int i = 0; i < 20; ++i) {
            const double a = draw.uniform(-0.2, 1), b = draw.uniform(-0.2, 1), c = 1 - a - b;
            const Vec2 place = a * kind.placed_rays[0].screen + b * kind.placed_rays[1].screen +
                               c * kind.placed_rays[2].screen;
            const std::optional<Ray> ray = exact_ray(camera, {61 * place.x, 47 * place.y});
            REQUIRE(ray);
            CHECK(length(ray->origin - (a * point[0] + b * point[1] + c * point[2])) < 1e-9);
            CHECK(length(ray->direction - (a * direction[0] + b * direction[1] + c * direction[2])) < 1e-9);
        }
    }
}

TEST_CASE("rays of each general linear camera are named as what they are", "[camera]") {
    Draw draw(21);
    for (int round = 0; round < 200; ++round) {
        const Vec3 eye = draw.in_cube(1);
        Rays pinhole, parallel;
        for (Ray& ray : pinhole) ray = {eye, Vec3(0, 0, 2) + draw.in_cube(0.8)};
        const Vec3 way = Vec3(0, 0, 1) + draw.in_cube(0.4);
        for (Ray& ray : parallel) ray = {draw.in_cube(2), way};
        CHECK(kind_of(shaken(pinhole, draw)) == GeneralLinearKind::kPinhole);
        CHECK(kind_of(shaken(parallel, draw)) == GeneralLinearKind::kOrthographic);

        // Two slits across z, two apart.
        const double turn = draw.uniform(0.4, 2.7);
        const Ray one{Vec3(0, 0, 0), Vec3(1, 0, 0)},
            other{Vec3(0, 0, 2), Vec3(std::cos(turn), std::sin(turn), 0)};
        const Rays slits{through(one, 0, other, 0.1), through(one, 1, other, 0.2),
                         through(one, 0.3, other, 1)};
        CHECK(kind_of(shaken(slits, draw)) == GeneralLinearKind::kCrossedSlits);
        const auto camera = general_linear_camera(shaken(slits, draw), {0, 0, 1}, 1e-7);
        REQUIRE(camera->meets.size() == 2);
        // The middle ray meets both.
        for (const Ray& slit : {one, other}) {
            double nearest = 1e9;
            for (const Vec3& meet : camera->meets)
                nearest = std::min(nearest, length(cross(meet - slit.origin, slit.direction)));
            CHECK(nearest < 1e-8);
        }

        // The eye walks along a line; rays parallel to a plane that the line is not.
        const Rays pushbroom{Ray{Vec3(0, 0, 0), Vec3(0, draw.uniform(-1, 1), 2)},
                             Ray{Vec3(1, 0, 0), Vec3(0, draw.uniform(-1, 1), 2)},
                             Ray{Vec3(2.5, 0, 0), Vec3(0, draw.uniform(1.2, 2), 2)}};
        CHECK(kind_of(shaken(pushbroom, draw)) == GeneralLinearKind::kPushbroom);

        // Parallel to a plane, turning with the height: (x, y) at depth z goes to (x + k y z, y).
        const double k = draw.uniform(0.3, 1);
        Rays twisted;
        for (Ray& ray : twisted) {
            const Vec3 at = draw.in_cube(1);
            ray = {Vec3(at.x, at.y, 0), Vec3(k * at.y, 0, 1)};
        }
        CHECK(kind_of(shaken(twisted, draw)) == GeneralLinearKind::kTwistedOrthographic);

        // Turning about the axis: the map of the planes has no real eigenvalue, so no depth flattens it.
        Rays bilinear;
        for (Ray& ray : bilinear) {
            const Vec3 at = draw.in_cube(1);
            ray = {Vec3(at.x, at.y, 0), Vec3(-k * at.y, k * at.x, 1)};
        }
        CHECK(kind_of(shaken(bilinear, draw)) == GeneralLinearKind::kBilinear);

        // Through a line, each point of it with a plane of rays: the map has one eigenvalue, but is no
        // multiple.
        Rays pencil;
        for (Ray& ray : pencil) {
            const Vec3 at = draw.in_cube(1);
            ray = {Vec3(at.x, at.y, 0), Vec3(-0.5 * at.x + k * at.y, -0.5 * at.y, 1)};
        }
        CHECK(kind_of(shaken(pencil, draw)) == GeneralLinearKind::kPencil);

        Rays plane;
        for (Ray& ray : plane) ray = {Vec3(draw.uniform(-1, 1), 0, 0), Vec3(draw.uniform(-1, 1), 0, 2)};
        CHECK(kind_of(shaken(plane, draw)) == GeneralLinearKind::kPlane);
    }
}

TEST_CASE("an eye that every ray leaves but for rounding is a pinhole", "[camera][law]") {
    Draw draw(23);
    for (int round = 0; round < 2000; ++round) {
        const Vec3 eye = draw.in_cube(20), mean = draw.unit();
        Rays rays;
        for (Ray& ray : rays) {
            ray = {eye, mean + draw.in_cube(0.02)};
            for (int k = 0; k < 3; ++k) ray.origin[k] *= 1 + draw.uniform(-2e-16, 2e-16);
        }
        const auto camera = general_linear_camera(rays, mean);
        REQUIRE(camera);
        CHECK(camera->kind == GeneralLinearKind::kPinhole);
        REQUIRE(camera->meets.size() == 1);
        CHECK(length(camera->meets[0] - eye) < 1e-9);
    }
}

TEST_CASE("near rays mirrored in a sphere meet at Coddington's two foci", "[camera][oracle]") {
    // Convex, radius 1; object at `away`, the middle ray at angle i to the normal: 1/s + 1/t = -2 / cos i in
    // the plane of incidence, -2 cos i across it (Coddington 1829).
    Draw draw(24);
    for (int round = 0; round < 300; ++round) {
        const double i = draw.uniform(0.1, 1.2), away = draw.uniform(0.5, 5);
        const Vec3 normal(0, 0, 1), eye = normal + away * Vec3(std::sin(i), 0, std::cos(i));
        const auto mirrored = [&](const Vec3& on) {
            const Vec3 n = normalize(on), in = n - eye;
            return Ray{n, normalize(in - 2 * dot(in, n) * n)};
        };
        const double small = 1e-4, turn = draw.uniform(0, 6);
        const auto at = [&](double angle) {
            return mirrored(normal + small * Vec3(std::cos(angle + turn), std::sin(angle + turn), 0));
        };
        const Ray middle = mirrored(normal);
        const auto camera = general_linear_camera({at(0), at(2), at(4.3)}, middle.direction);
        REQUIRE(camera);
        REQUIRE(camera->kind == GeneralLinearKind::kCrossedSlits);
        std::vector<double> found;
        for (const Vec3& meet : camera->meets) found.push_back(dot(meet - middle.origin, middle.direction));
        std::sort(found.begin(), found.end());
        const double across = -1 / (2 * std::cos(i) + 1 / away), along = -1 / (2 / std::cos(i) + 1 / away);
        CHECK(found[0] == Approx(across).epsilon(2e-3));
        CHECK(found[1] == Approx(along).epsilon(2e-3));
    }
}

TEST_CASE("the facets of every camera are of the kind that the camera is", "[camera][law]") {
    const FilmSize film{320, 240};
    for (CameraDescription from : every_camera()) {
        INFO(from.name);
        from.facets = 12;
        const Camera camera = make_camera(from, film);
        const FacetKinds kinds = facet_kinds(camera);
        const std::size_t all = camera.mesh.facets.size();
        const auto are_all = [&](GeneralLinearKind kind) {
            // At a pole two corners of a facet have one ray.
            const std::size_t poles = std::holds_alternative<SphericalCamera>(from.kind) ||
                                              std::holds_alternative<InwardSphereCamera>(from.kind)
                                          ? 24
                                          : 0;
            return kinds.count(kind) + kinds.without == all && kinds.without == poles;
        };
        if (std::holds_alternative<PushbroomCamera>(from.kind))
            CHECK(are_all(GeneralLinearKind::kPushbroom));
        else if (std::holds_alternative<CrossedSlitsCamera>(from.kind) ||
                 std::holds_alternative<ThreeRayCamera>(from.kind))
            CHECK(are_all(std::holds_alternative<CrossedSlitsCamera>(from.kind)
                              ? GeneralLinearKind::kCrossedSlits
                              : *facet_kind(camera.mesh, 0, camera.axis)));
        else if (camera.model->eye())
            CHECK(are_all(GeneralLinearKind::kPinhole));
        else if (std::holds_alternative<MultiPerspectiveCamera>(from.kind))
            CHECK(kinds.count(GeneralLinearKind::kPinhole) > all / 2);
    }
    CameraDescription linear;
    CHECK(facet_kinds(make_camera(linear, film)).count(GeneralLinearKind::kPinhole) == 2);
    linear.kind = ObliqueCamera{};
    CHECK(facet_kinds(make_camera(linear, film)).count(GeneralLinearKind::kOrthographic) == 2);
    linear.kind = OrthographicCamera{};
    CHECK(facet_kinds(make_camera(linear, film)).count(GeneralLinearKind::kOrthographic) == 2);
}

TEST_CASE("a general linear camera of three rays of a kind has facets of that kind", "[camera]") {
    // Between the planes z = 0 and z = -1, as the camera looks along -z.
    const double k = 0.7;
    const auto kind_with = [&](auto way) {
        CameraDescription from;
        ThreeRayCamera kind;
        from.facets = 6;
        from.eye = {0, 0, 0}, from.at = {0, 0, -1};
        const std::array<Vec2, 3> places{Vec2(-1, 1), Vec2(1, 1), Vec2(-1, -1)},
            screens{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
        for (std::size_t i = 0; i < 3; ++i)
            kind.placed_rays[i] = {Vec3(places[i], 0), Vec3(way(places[i]), -1), screens[i]};
        from.kind = kind;
        const Camera camera = make_camera(from, {40, 40});
        const FacetKinds kinds = facet_kinds(camera);
        for (std::size_t one = 0; one < kGeneralLinearKindCount; ++one)
            if (kinds.of_kind[one] == camera.mesh.facets.size())
                return std::string(general_linear_kind_name(static_cast<GeneralLinearKind>(one)));
        return std::string("mixed");
    };
    CHECK(kind_with([&](const Vec2& at) { return k * at; }) == "pinhole");
    CHECK(kind_with([&](const Vec2&) { return Vec2(0.1, 0.2); }) == "orthographic");
    CHECK(kind_with([&](const Vec2& at) { return Vec2(0.1, k * at.y); }) == "pushbroom");
    CHECK(kind_with([&](const Vec2& at) { return Vec2(2 * k * at.x, -k * at.y); }) == "crossedSlits");
    CHECK(kind_with([&](const Vec2& at) { return Vec2(k * at.x + at.y, k * at.y); }) == "pencil");
    CHECK(kind_with([&](const Vec2& at) { return Vec2(k * at.y, 0); }) == "twistedOrthographic");
    CHECK(kind_with([&](const Vec2& at) { return Vec2(-k * at.y, k * at.x); }) == "bilinear");
}

TEST_CASE("facets without rays, with two rays in one or opposite ones have no kind", "[camera]") {
    RayMesh mesh;
    mesh.rays = {{Vec3(0), Vec3(0, 0, 1)},
                 {Vec3(1, 0, 0), Vec3(0, 0, 1)},
                 {Vec3(0, 1, 0), Vec3(0, 0, 2)},
                 {Vec3(1, 1, 0), Vec3(0, 0, -1)}};
    mesh.screen = {Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(0, 1, 1), Vec3(1, 1, 1)};
    mesh.facets = {{kNone, kNone, kNone}, {0, 1, 2}, {0, 0, 2}, {1, 3, 2}};
    CHECK_FALSE(facet_kind(mesh, 0));
    CHECK(facet_kind(mesh, 1) == GeneralLinearKind::kOrthographic);
    CHECK(facet_kind(mesh, 1, Vec3(0, 0, -1)) == GeneralLinearKind::kOrthographic);
    CHECK_FALSE(facet_kind(mesh, 2));
    CHECK_FALSE(facet_kind(mesh, 3));
    const FacetKinds kinds = facet_kinds(mesh);
    CHECK(kinds.without == 3);
    CHECK(kinds.count(GeneralLinearKind::kOrthographic) == 1);
}

TEST_CASE("random rays have as many roots as the paper's characteristic equation", "[camera][oracle][law]") {
    Draw draw(22);
    int slits = 0, bilinear = 0;
    for (int round = 0; round < 2000; ++round) {
        Rays rays;
        for (Ray& ray : rays) ray = {draw.in_cube(1), Vec3(0, 0, 1.5) + draw.in_cube(0.6)};
        const auto [a, b, c] = characteristic(rays);
        const auto camera = general_linear_camera(rays, {0, 0, 3});
        REQUIRE(camera);
        if (b * b - 4 * a * c > 0) {
            ++slits;
            CHECK(camera->kind == GeneralLinearKind::kCrossedSlits);
            // At a root in z the three rays' points lie on one line, and so does the middle ray's.
            for (const Vec3& meet : camera->meets) {
                std::array<Vec3, 3> at;
                const Vec3 axis(0, 0, 1);
                for (std::size_t k = 0; k < 3; ++k)
                    at[k] = rays[k].origin + dot(meet - rays[k].origin, axis) / dot(rays[k].direction, axis) *
                                                 rays[k].direction;
                const Vec3 e = at[1] - at[0], f = at[2] - at[0];
                CHECK(length(cross(e, f)) < 1e-6 * (dot(e, e) + dot(f, f)));
            }
        } else {
            ++bilinear;
            CHECK(camera->kind == GeneralLinearKind::kBilinear);
            CHECK(camera->meets.empty());
        }
    }
    CHECK(slits > 200);
    CHECK(bilinear > 200);
}

TEST_CASE("three rays that make no camera have no kind", "[camera]") {
    const Ray ray{Vec3(0), Vec3(0, 0, 1)};
    const Vec3 axis(0, 0, 1);
    CHECK_FALSE(general_linear_camera({ray, ray, Ray{Vec3(1, 0, 0), Vec3(0, 0, 1)}}, axis));
    CHECK_FALSE(general_linear_camera(
        {ray, Ray{Vec3(1, 0, 0), Vec3(0, 0, -1)}, Ray{Vec3(0, 1, 0), Vec3(0, 0.1, 1)}}, axis));
    CHECK_FALSE(
        general_linear_camera({ray, Ray{Vec3(1, 0, 0), Vec3(0)}, Ray{Vec3(0, 1, 0), Vec3(0, 0, 1)}}, axis));
    CHECK_FALSE(general_linear_camera(
        {ray, Ray{Vec3(1, 0, 0), Vec3(0, 0, 1)}, Ray{Vec3(0, 1, 0), Vec3(0, 0, 1)}}, Vec3(0)));
}
