// Laws of exact images: against Alhazen's problem, virtual images, Snell at a flat water surface, and the
// mirror law itself.
#include "specular/specular_point.h"

#include <algorithm>

#include "camera/linear/linear_cameras.h"
#include "support/closed_forms.h"
#include "support/draw.h"
#include "support/test.h"
#include "support/test_surfaces.h"

using namespace trilens_test;

namespace {

/// How far the reflected or refracted direction at an image misses the point: sine of the angle, from the
/// laws themselves.
double mirror_miss(const LinearCamera& camera, const Vec3& position, const Vec3& normal, const Vec3& x) {
    const Vec3 in = normalize(incident_direction(camera, position));
    const Vec3 out = in - 2.0 * dot(in, normal) * normal;
    return length(cross(out, normalize(x - position))) + (dot(out, x - position) > 0 ? 0 : 2);
}

}  // namespace

TEST_CASE("images in a mirror sphere are the solutions of Alhazen's problem", "[specular][oracle]") {
    Draw draw(11);
    std::size_t all = 0, in_rooms = 0, missed = 0;
    for (int round = 0; round < 400; ++round) {
        const double size = draw.log_uniform(1e-4, 1e4);
        const CubeSphere sphere(size * draw.in_cube(1), size);
        const bool room = round % 2 == 0;  // eye and point inside the sphere: up to four images
        const double nearest = room ? 0.05 : 1.05, farthest = room ? 0.95 : 20;
        const Vec3 eye = sphere.center + size * draw.away(nearest, farthest);
        SpecularQuery query;
        query.point = sphere.center + size * draw.away(nearest, farthest);
        query.camera = camera_at(eye, room ? eye + size * draw.unit() : sphere.center);
        const std::vector<SpecularPoint> found = specular_points(sphere, regular_starts(sphere, 5), query);
        const std::vector<Vec3> expected = alhazen(sphere, eye, query.point);

        // Every solution is reached from near it, and is exact to 1e-9 of the film's width.
        std::size_t before_camera = 0;
        for (const Vec3& p : expected) {
            const Vec3 normal = (p - sphere.center) / size;
            const double cosine = std::fabs(dot(normalize(eye - p), normal));
            const double reach = 0.05 * cosine * std::fmin(1, length(eye - p) / size);
            SurfaceParameter start = sphere.sphere_place(normal);
            start.uv += reach * Vec2(draw.in_cube(1));
            const auto image = refine_specular_point(sphere, start, query);

            const double w = screen_from_world(query.camera, p).z;
            REQUIRE(image.has_value() == (w > 0));
            if (!image) continue;
            ++before_camera;
            const double film = 1 + length(pixel_of(query.camera, p)) / 1000;
            CHECK(length(pixel_of(query.camera, p) - image->pixel) < 1e-6 * film);
            CHECK(image->t == Approx(length(query.point - p) / length(eye - p)).epsilon(1e-9));
            CHECK(image->front == (dot(eye - p, normal) > 0));
        }

        // From starts all over the sphere nothing else is found, and little is missed.
        for (const SpecularPoint& image : found) {
            const auto is_it = [&](const Vec3& p) { return length(p - image.position) < 1e-6 * size; };
            CHECK(std::any_of(expected.begin(), expected.end(), is_it));
        }
        REQUIRE(found.size() <= before_camera);
        all += before_camera;
        in_rooms += room ? before_camera : 0;
        missed += before_camera - found.size();
    }
    CHECK(all > 500);
    CHECK(in_rooms > 150);
    CHECK(missed <= all / 50);
}

TEST_CASE("a flat mirror shows the virtual image, or nothing where that lies outside the mirror",
          "[specular]") {
    Draw draw(12);
    int seen = 0;
    for (int round = 0; round < 500; ++round) {
        const double size = draw.log_uniform(1e-4, 1e4);
        const Patch mirror(size * draw.in_cube(1), size, 0);
        auto above = [&] { return mirror.center + size * draw.above(2, 0.01, 5); };
        const Vec3 eye = above(), x = above();
        SpecularQuery query;
        query.camera = camera_at(eye, mirror.center);
        query.point = x;

        const double high = eye.z - mirror.center.z, low = x.z - mirror.center.z;
        const Vec3 hit = eye + (Vec3(x.x, x.y, mirror.center.z - low) - eye) * (high / (high + low));
        const Vec3 local = (hit - mirror.center) / size;
        const double margin = std::fmax(std::fabs(local.x), std::fabs(local.y));
        if (std::fabs(margin - 1) < 1e-6 || !(screen_from_world(query.camera, hit).z > 0)) continue;
        const auto image = refine_specular_point(mirror, {0, 0.5 + 0.5 * Vec2(draw.in_cube(1))}, query);
        REQUIRE(image.has_value() == (margin < 1));
        if (!image) continue;
        ++seen;
        CHECK(length(image->position - hit) < 1e-11 * size * (1 + length(hit) / size));
        CHECK(image->t == Approx(low / high).epsilon(1e-8));
    }
    CHECK(seen > 100);
}

TEST_CASE("a flat water surface shows points where Snell's law puts them", "[specular][oracle]") {
    Draw draw(13);
    for (int round = 0; round < 500; ++round) {
        const double size = draw.log_uniform(1e-4, 1e4), half = 100 * size;
        const Patch water(Vec3(0), half, 0);
        const bool from_below = round % 2 == 1;
        const double side = from_below ? -1 : 1;
        const Vec3 eye = size * Vec3(1, 1, side) * draw.above(3, 0.05, 5);
        const Vec3 x = size * Vec3(1, 1, -side) * draw.above(3, 0.05, 5);
        SpecularQuery query;
        query.camera = camera_at(eye, 0.5 * (eye + x));
        query.point = x;
        query.event = SpecularEvent::kRefract;
        (from_below ? query.eye_index : query.point_index) = draw.uniform(1, 2.5);

        // n1 sin1 - n2 sin2 rises with the distance s along the water: bisect.
        const Vec2 along(x - eye);
        const long double d = length(along), high = std::fabs(eye.z), deep = std::fabs(x.z);
        long double low = 0, far = d;
        for (int step = 0; step < 200; ++step) {
            const long double s = (low + far) / 2;
            const long double law = query.eye_index * s / std::hypot(s, high) -
                                    query.point_index * (d - s) / std::hypot(d - s, deep);
            (law < 0 ? low : far) = s;
        }
        const Vec2 crossing = Vec2(eye) + along * static_cast<double>(low / d);
        const auto image = refine_specular_point(
            water, {0, Vec2(0.5) + (Vec2(eye) + along * draw.uniform(0, 1)) / (2 * half)}, query);
        REQUIRE(image);
        CHECK(length(image->position - Vec3(crossing, 0)) < 1e-11 * size);
        CHECK(image->front == !from_below);
        CHECK(length(image->pixel - pixel_of(query.camera, Vec3(crossing, 0))) < 1e-6);
    }
}

TEST_CASE("equal indices: refraction is a straight line through the surface", "[specular]") {
    Draw draw(14);
    const CubeSphere sphere(Vec3(0), 1);
    for (int round = 0; round < 100; ++round) {
        const Vec3 eye = draw.away(1.5, 10), x = draw.away(0, 0.9);
        SpecularQuery query;
        query.camera = camera_at(eye, Vec3(0));
        query.point = x;
        query.event = SpecularEvent::kRefract;
        query.eye_index = query.point_index = 1.3;
        const auto images = specular_points(sphere, regular_starts(sphere, 3), query);
        REQUIRE(images.size() == 1);
        CHECK(length(images[0].pixel - pixel_of(query.camera, x)) < 1e-8);
    }
}

TEST_CASE("a parallel camera sees a sphere's and a paraboloid's images by the mirror law", "[specular]") {
    Draw draw(15);
    const CubeSphere sphere(Vec3(0.2, -0.1, 0.3), 1.5);
    const Patch bowl(Vec3(0), 2, 0.3);
    for (int round = 0; round < 200; ++round) {
        OrthographicParams params;
        params.look_at = {5.0 * draw.unit(), 0.3 * draw.in_cube(1), {0.3, 1, 0.1}};
        SpecularQuery query;
        query.camera = make_orthographic(params);
        query.point = draw.away(2, 9);
        const auto on_sphere = specular_points(sphere, regular_starts(sphere, 4), query);

        // Outside a convex mirror's shadow, a point has one image on the front; others lie on the hidden
        // inner side.
        const Vec3 from_center = query.point - sphere.center;
        const double along = dot(from_center, query.camera.view_direction);
        const bool in_shadow =
            along > 0 && length(from_center - along * query.camera.view_direction) < sphere.radius;
        const auto in_front =
            std::count_if(on_sphere.begin(), on_sphere.end(), [](const auto& p) { return p.front; });
        CHECK(in_front == (in_shadow ? 0 : 1));
        const auto in_bowl = specular_points(bowl, regular_starts(bowl, 8), query);
        auto check_law = [&](const Surface& surface, const std::vector<SpecularPoint>& images) {
            for (const SpecularPoint& image : images) {
                const SurfacePoint at = surface.eval(image.at.face, image.at.uv);
                CHECK(mirror_miss(query.camera, at.position, at.normal, query.point) < 1e-11);
                CHECK(image.t == Approx(image.distance));
            }
        };
        check_law(sphere, on_sphere);
        check_law(bowl, in_bowl);
    }
}

TEST_CASE("parallel rays along a paraboloid's axis image every point of the bowl to its focus",
          "[specular][law]") {
    const double bend = 0.4;
    const Patch bowl(Vec3(0), 1, bend);
    SpecularQuery query;
    query.camera = make_orthographic({{{0, 0, 9}, {0, 0, 0}, {0, 1, 0}}, 4, 400, 400});
    query.point = Vec3(0, 0, 1 / (4 * bend));
    for (const SurfaceParameter& start : regular_starts(bowl, 6)) {
        const auto image = refine_specular_point(bowl, start, query);
        REQUIRE(image);  // the caustic's point: each start is its own image
        CHECK(length(image->at.uv - start.uv) < 1e-12);
    }
}

TEST_CASE("overridden normals obey the mirror law, not Fermat's principle", "[specular]") {
    // A plane whose normals point away from a centre far below: the thesis' sphere on a plane.
    struct BorrowedPlane : Patch {
        Vec3 away_from{0, 0, -3};
        BorrowedPlane() : Patch(Vec3(0), 2, 0) {}
        SurfacePoint eval(Id face, const Vec2& uv) const override {
            SurfacePoint point = Patch::eval(face, uv);
            point.normal = normalize(point.position - away_from);
            return point;
        }
    };
    const BorrowedPlane plane;
    const Patch flat(Vec3(0), 2, 0);
    Draw draw(16);
    int seen = 0;
    for (int round = 0; round < 300; ++round) {
        const Vec3 eye = draw.above(2, 1, 4);
        SpecularQuery query;
        query.camera = camera_at(eye, Vec3(0));
        query.point = draw.above(4, 0.5, 4);
        query.own_normals = false;
        for (const SpecularPoint& image : specular_points(plane, regular_starts(plane, 4), query)) {
            ++seen;
            const SurfacePoint at = plane.eval(0, image.at.uv);
            CHECK(mirror_miss(query.camera, at.position, at.normal, query.point) < 1e-11);
        }
        // On a surface with its own normals both Jacobians lead to the same image.
        const auto differences = refine_specular_point(flat, {0, {0.5, 0.5}}, query);
        query.own_normals = true;
        const auto exact = refine_specular_point(flat, {0, {0.5, 0.5}}, query);
        REQUIRE(differences.has_value() == exact.has_value());
        if (exact) CHECK(length(exact->position - differences->position) < 1e-11);
    }
    CHECK(seen > 150);
}

TEST_CASE("few iterations from a near start, and the residual tells the truth", "[specular]") {
    Draw draw(17);
    const CubeSphere sphere(Vec3(0), 1);
    int most = 0;
    for (int round = 0; round < 200; ++round) {
        SpecularQuery query;
        query.camera = camera_at(draw.away(2, 6), Vec3(0));
        query.point = draw.away(1.5, 6);
        for (const SpecularPoint& image : specular_points(sphere, regular_starts(sphere, 4), query)) {
            if (!image.front) continue;
            const Vec2 near = glm::clamp(image.at.uv + 0.02 * Vec2(draw.in_cube(1)), Vec2(0), Vec2(1));
            const auto again = refine_specular_point(sphere, {image.at.face, near}, query);
            REQUIRE(again);
            CHECK(length(again->pixel - image.pixel) < 1e-8);
            CHECK(again->residual < 1e-12);
            most = std::max(most, again->iterations);
        }
    }
    CHECK(most <= 8);
}

TEST_CASE("an image on the edge between two faces is found from both and counted once", "[specular][law]") {
    const CubeSphere sphere(Vec3(0), 1);
    const Vec3 on_edge = normalize(Vec3(1, 1, 0.2));
    SpecularQuery query;
    query.camera = camera_at(4.0 * on_edge, Vec3(0));
    query.point = 3.0 * on_edge;
    const auto images = specular_points(sphere, regular_starts(sphere, 3), query);
    const auto front = std::count_if(images.begin(), images.end(), [](const auto& p) { return p.front; });
    CHECK(front == 1);
    CHECK(length(images[0].position - on_edge) < 1e-12);
}

TEST_CASE("images are the same only on one side of one crossing", "[specular]") {
    SpecularPoint image;
    image.pixel = {10, 20};
    image.distance = 5;
    image.t = 1;
    image.residual = 1e-15;
    SpecularPoint nearby = image, behind = image, deeper = image, apart = image;
    nearby.pixel.x += 0.5 * kSamePixels;
    nearby.residual = 1e-14;
    behind.front = false;
    deeper.position.z += 1;
    apart.pixel.y += 2 * kSamePixels;
    const auto distinct = distinct_images({nearby, behind, image, deeper, apart});
    REQUIRE(distinct.size() == 4);
    CHECK(std::none_of(distinct.begin(), distinct.end(), [](const auto& p) { return p.residual > 5e-15; }));
}

TEST_CASE("starts cover square and triangular domains", "[specular][law]") {
    struct Triangle : Patch {
        Triangle() : Patch(Vec3(0), 1, 0) {}
        FaceDomain domain(Id) const override { return FaceDomain::kTriangle; }
    };
    const Triangle triangle;
    const auto starts = regular_starts(triangle, 4);
    CHECK(starts.size() == 10);
    for (const auto& start : starts) CHECK(start.uv.x + start.uv.y < 1);
    CHECK(regular_starts(CubeSphere(Vec3(0), 1), 3).size() == 54);

    // The flat mirror's image at (x, y) = (0.2, -0.4) lies in the half u + v <= 1; that at (0.2, 0.4) does
    // not.
    for (const double y : {-0.4, 0.4}) {
        SpecularQuery query;
        query.camera = camera_at({0.2, y, 3}, {0.21, y, 0});
        query.point = Vec3(0.2, y, 2);
        const auto images = specular_points(triangle, starts, query);
        REQUIRE(images.size() == (y < 0 ? 1u : 0u));
        if (y < 0) CHECK(length(images[0].position - Vec3(0.2, y, 0)) < 1e-12);
    }
}
