// Linear views in the standard terms against the textbook's canonical volumes, and clipping against division.
#include "camera/linear/linear_cameras.h"

#include <array>
#include <string>

#include "base/util/error.h"
#include "camera/camera.h"
#include "support/canonical_volume.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

ViewVolume random_volume(Draw& draw, bool parallel) {
    ViewVolume volume;
    volume.vrp = draw.in_cube(3);
    volume.vpn = draw.in_cube(1) + Vec3(0, 0, 2);
    volume.vup = draw.in_cube(0.5) + Vec3(0, 1, 0);
    volume.prp = {draw.uniform(-2, 2), draw.uniform(-2, 2), draw.uniform(4, 9)};
    const double u = draw.uniform(-3, 1), v = draw.uniform(-3, 1);
    volume.window = {u, u + draw.uniform(1, 4), v, v + draw.uniform(1, 4)};
    volume.parallel = parallel;
    volume.front = draw.uniform(-1, 2);
    volume.back = volume.front - draw.uniform(1, 20);
    return volume;
}

/// World point of viewing coordinates, by the definition of the axes.
Vec3 world_of(const ViewVolume& volume, const Vec3& uvn) {
    const Vec3 n = normalize(volume.vpn), u = normalize(cross(volume.vup, n)), v = cross(n, u);
    return volume.vrp + uvn.x * u + uvn.y * v + uvn.z * n;
}

/// The volume's point at these shares of window and depth (0 front, 1 back), by geometry alone.
Vec3 point_in(const ViewVolume& volume, double across, double up, double depth) {
    const auto& [umin, umax, vmin, vmax] = volume.window;
    const Vec3 on_window(umin + across * (umax - umin), vmin + up * (vmax - vmin), 0);
    const double n = volume.front + depth * (volume.back - volume.front);
    if (volume.parallel) {
        const Vec3 dop = Vec3(0.5 * (umin + umax), 0.5 * (vmin + vmax), 0) - volume.prp;
        return world_of(volume, on_window + n / dop.z * dop);
    }
    const double share = (n - volume.prp.z) / (0 - volume.prp.z);
    return world_of(volume, volume.prp + share * (on_window - volume.prp));
}

bool near(const Vec3& a, const Vec3& b, double within) {
    return length(a - b) <= within * (1 + length(b));
}

Vec3 mapped(const Mat4& matrix, const Vec3& point) {
    const Vec4 p = matrix * Vec4(point, 1);
    return Vec3(p.x, p.y, p.z) / p.w;
}

}  // namespace

TEST_CASE("Npar and Nper take view volumes to the canonical ones", "[camera]") {
    Draw draw(11);
    for (int round = 0; round < 50; ++round) {
        ViewVolume volume = random_volume(draw, true);
        for (const double across : {0.0, 0.3, 1.0})
            for (const double up : {0.0, 0.8, 1.0})
                for (const double depth : {0.0, 0.4, 1.0}) {
                    volume.parallel = true;
                    const Vec3 in_box(2 * across - 1, 2 * up - 1, -depth);
                    CHECK(near(mapped(npar(volume), point_in(volume, across, up, depth)), in_box, 1e-9));

                    volume.parallel = false;
                    const double z_min = nper_front(volume), z = z_min + depth * (-1 - z_min);
                    const Vec3 in_frustum(-z * in_box.x, -z * in_box.y, z);
                    const Vec3 point = point_in(volume, across, up, depth);
                    CHECK(near(mapped(nper(volume), point), in_frustum, 1e-9));
                    const Vec3 made_parallel = mapped(parallel_from_perspective(z_min) * nper(volume), point);
                    CHECK(made_parallel.x == Approx(in_box.x).margin(1e-9));
                    CHECK(made_parallel.y == Approx(in_box.y).margin(1e-9));
                    if (depth == 0) CHECK(std::abs(made_parallel.z) < 1e-9);
                    if (depth == 1) CHECK(made_parallel.z == Approx(-1));
                }
    }
}

TEST_CASE("Npar and Nper of the standard view are the textbook's numbers", "[camera][oracle]") {
    // Vrp at the origin, axes those of the world, window 4 x 2: the matrices by hand.
    ViewVolume volume;
    volume.prp = {0, 0, 5};
    volume.window = {-2, 2, -1, 1};
    volume.front = 1;
    volume.back = -5;
    const Mat4 perspective = nper(volume);
    // z after the prp moved is n - 5; the scale of z is 1 / (prp.n - back) = 1/10, x by 2 * 5 / (4 * 10).
    CHECK(perspective[0][0] == Approx(0.25));
    CHECK(perspective[1][1] == Approx(0.5));
    CHECK(perspective[2][2] == Approx(0.1));
    CHECK(perspective[3][2] == Approx(-0.5));
    CHECK(nper_front(volume) == Approx(-0.4));
    const Mat4 parallel = npar(volume);
    CHECK(parallel[0][0] == Approx(0.5));
    CHECK(parallel[1][1] == Approx(1));
    CHECK(parallel[2][2] == Approx(1.0 / 6));
    CHECK(parallel[3][2] == Approx(-1.0 / 6));
}

TEST_CASE("a view volume's camera shows a point where its matrix says", "[camera]") {
    Draw draw(12);
    for (int round = 0; round < 100; ++round) {
        const ViewVolume volume = random_volume(draw, round % 2 == 0);
        CameraDescription from;
        from.kind = volume;
        const Camera camera = make_camera(from, {320, 200});
        for (int k = 0; k < 20; ++k) {
            const double across = draw.uniform(0, 1), up = draw.uniform(0, 1),
                         depth = draw.uniform(0.01, 0.99);
            const Vec3 point = point_in(volume, across, up, depth);
            const std::vector<FilmImage> images = film_positions(camera, point);
            REQUIRE(images.size() == 1);
            CHECK(std::abs(images[0].pixel.x - 320 * across) < 1e-8);
            CHECK(std::abs(images[0].pixel.y - 200 * (1 - up)) < 1e-8);
            // The film's own ray passes the point; it begins on the front plane.
            const Ray ray = *exact_ray(camera, images[0].pixel);
            CHECK(length(cross(point - ray.origin, normalize(ray.direction))) < 1e-9 * (1 + length(point)));
            CHECK(near(ray.origin, point_in(volume, across, up, 0), 1e-9));
            CHECK(film_positions(camera, point_in(volume, across, up, -0.01)).empty());
            CHECK(film_positions(camera, point_in(volume, across, up, 1.01)).empty());
        }
    }
}

TEST_CASE("a perspective with shift is the view volume with its window moved", "[camera]") {
    CameraDescription shifted;
    shifted.eye = {1, 2, 7};
    shifted.at = {1, 2, 0};
    shifted.kind = PerspectiveCamera{.yfov = 50, .shift = {0.25, -0.4}};
    const double half = std::tan(25 * 3.14159265358979323846 / 180), aspect = 1.5;
    const double u = 0.25 * 2 * half * aspect, v = -0.4 * 2 * half;
    CameraDescription off_axis;
    off_axis.kind = ViewVolume{.vrp = {1, 2, 6},  // one unit before the eye
                               .prp = {0, 0, 1},
                               .window = {u - half * aspect, u + half * aspect, v - half, v + half}};
    const Camera a = make_camera(shifted, {300, 200}), b = make_camera(off_axis, {300, 200});
    Draw draw(13);
    for (int k = 0; k < 200; ++k) {
        const Vec3 point = draw.in_cube(4);
        const auto in_a = film_positions(a, point), in_b = film_positions(b, point);
        REQUIRE(in_a.size() == 1);
        REQUIRE(in_b.size() == 1);
        CHECK(length(in_a[0].pixel - in_b[0].pixel) < 1e-9 * (1 + length(in_a[0].pixel)));
    }
}

TEST_CASE("oblique views move points by their depth", "[camera]") {
    CameraDescription from;
    from.eye = {0, 0, 5};
    from.at = {0, 0, 0};
    from.kind = ObliqueCamera{.ymag = 2, .angle = 30, .scale = 0.5};
    const Camera camera = make_camera(from, {400, 400});
    // 100 pixels per unit; a point at depth 2 goes right and up by 0.5 * 2 * (cos 30, sin 30).
    const auto images = film_positions(camera, {0.2, -0.1, 3});
    REQUIRE(images.size() == 1);
    CHECK(images[0].pixel.x == Approx(200 + 100 * (0.2 + std::sqrt(3) / 2)));
    CHECK(images[0].pixel.y == Approx(200 - 100 * (-0.1 + 0.5)));
    CHECK(images[0].t == Approx(2));
    CHECK(film_positions(camera, {0, 0, 5.1}).empty());

    // As a view volume: the prp stands where its way to the window's middle has that slope.
    CameraDescription volume;
    volume.kind = ViewVolume{.vrp = from.eye,
                             .prp = {0.5 * std::sqrt(3) / 2, 0.25, 1},
                             .window = {-2, 2, -2, 2},
                             .parallel = true,
                             .front = 0};
    const Camera same = make_camera(volume, {400, 400});
    Draw draw(14);
    for (int k = 0; k < 100; ++k) {
        const Vec3 point = draw.in_cube(3);
        const auto in_a = film_positions(camera, point), in_b = film_positions(same, point);
        REQUIRE(in_a.size() == 1);
        REQUIRE(in_b.size() == 1);
        CHECK(length(in_a[0].pixel - in_b[0].pixel) < 1e-8);
    }
}

TEST_CASE("homogeneous clipping keeps what lies in the volume, also of triangles through the eye's plane",
          "[camera]") {
    Draw draw(15);
    int cut = 0;
    for (int round = 0; round < 300; ++round) {
        ViewVolume volume = random_volume(draw, false);
        const Mat4 normalise = parallel_from_perspective(nper_front(volume)) * nper(volume);
        std::array<Vec3, 3> world;
        for (Vec3& corner : world)
            corner = point_in(volume, draw.uniform(-1, 2), draw.uniform(-1, 2), draw.uniform(-2, 2));
        std::array<Vec4, 3> homogeneous;
        for (std::size_t k = 0; k < 3; ++k) homogeneous[k] = normalise * Vec4(world[k], 1);
        const std::vector<Vec4> clipped = clip_homogeneous(homogeneous);
        cut += !clipped.empty() && clipped.size() != 3;
        for (const Vec4& corner : clipped) {
            const double slack = 1e-9 * (1 + std::abs(corner.w));
            CHECK(std::max(std::abs(corner.x), std::abs(corner.y)) <= corner.w + slack);
            CHECK(corner.z <= slack);
            CHECK(corner.z >= -corner.w - slack);
        }
        // Points of the triangle: inside the volume by its planes in the world, or not, and in the polygon
        // likewise, whose corners are convex after division.
        for (int k = 0; k < 20; ++k) {
            double a = draw.uniform(0, 1), b = draw.uniform(0, 1);
            if (a + b > 1) a = 1 - a, b = 1 - b;
            const Vec3 point = world[0] + a * (world[1] - world[0]) + b * (world[2] - world[0]);
            const Vec4 p = normalise * Vec4(point, 1);
            const bool inside = p.w > 0 && std::abs(p.x) < p.w * (1 - 1e-6) &&
                                std::abs(p.y) < p.w * (1 - 1e-6) && p.z < -1e-6 * p.w &&
                                p.z > -p.w * (1 - 1e-6);
            if (!inside) continue;
            REQUIRE(clipped.size() >= 3);
            const auto flat = [](const Vec4& q) { return Vec2(q.x, q.y) / q.w; };
            int left = 0, right = 0;
            for (std::size_t i = 0; i < clipped.size(); ++i) {
                const Vec2 from = flat(clipped[i]), to = flat(clipped[(i + 1) % clipped.size()]);
                const Vec2 way = to - from, off = flat(p) - from;
                const double side = way.x * off.y - way.y * off.x;
                left += side > 1e-9;
                right += side < -1e-9;
            }
            CHECK((left == 0 || right == 0));
        }
    }
    CHECK(cut > 50);
}

TEST_CASE("view volumes that are none are refused by field", "[camera][bad-input]") {
    const auto refused = [](const std::string& field, auto change) {
        CameraDescription from;
        ViewVolume volume{.prp = {0, 0, 5}, .front = 1, .back = -1};
        change(volume);
        from.kind = volume;
        try {
            make_camera(from, {10, 10}, {"room.json", "/cameras/0"});
        } catch (const InputError& error) {
            return std::string(error.what()).find("room.json: /cameras/0/" + field) == 0;
        }
        return false;
    };
    CHECK(refused("prp", [](ViewVolume& v) { v.prp.z = 0; }));
    CHECK(refused("vpn", [](ViewVolume& v) { v.vpn = Vec3(0); }));
    CHECK(refused("vup", [](ViewVolume& v) { v.vup = v.vpn; }));
    CHECK(refused("window", [](ViewVolume& v) { v.window = {1, 1, -1, 1}; }));
    CHECK(refused("window", [](ViewVolume& v) { v.window = {-1, 1, 1, -1}; }));
    CHECK(refused("back", [](ViewVolume& v) { v.back = 2; }));
    CHECK(refused("front", [](ViewVolume& v) { v.front = 6; }));
    CHECK(refused("vrp", [](ViewVolume& v) { v.vrp.x = NAN; }));
}
