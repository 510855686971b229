// Cameras that are not linear: the map of points and the rays are each other's inverses, both written from
// their own formulas; the RayMesh comes to the exact rays with order 2.
#include "camera/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "camera/model/film_mesh.h"
#include "camera/model/general_linear.h"
#include "every_camera.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr FilmSize kFilm{320, 240};
constexpr double kPi = 3.14159265358979323846;

Camera camera_of(const CameraDescription& from, const FilmSize& film = kFilm) {
    return make_camera(from, film);
}

/// Whether the images of points at t, or up to a tenth nearer or farther, fold within eight pixels of the
/// place: there an error of the rays moves an image by its square root, however fine the mesh.
bool near_fold(const CameraModel& model, const Vec2& at, double t) {
    constexpr int kAround = 16;
    constexpr double kReach = 8;
    int positive = 0, negative = 0;
    for (int k = 0; k < kAround; ++k)
        for (const double reach : {0.5 * kReach, kReach}) {
            const double angle = 2 * kPi * k / kAround;
            const auto spread = film_spread(model, at + reach * Vec2(std::cos(angle), std::sin(angle)), 0.01);
            if (!spread) continue;
            for (const double depth : {0.9 * t, t, 1.1 * t}) ++(spread->at(depth) > 0 ? positive : negative);
        }
    return positive > 0 && negative > 0;
}

/// Whether there are places without rays within a coarse cell: there cells are finer than elsewhere.
bool near_border(const CameraModel& model, const Vec2& at) {
    constexpr double kReach = 12;
    for (int k = 0; k < 8; ++k)
        if (!model.ray(at + kReach * Vec2(std::cos(kPi * k / 4), std::sin(kPi * k / 4)))) return true;
    return false;
}

/// Of the facets up to each, on the screen.
std::vector<double> areas_up_to(const RayMesh& mesh) {
    std::vector<double> areas;
    double sum = 0;
    for (const IdTriple& facet : mesh.facets) {
        const Vec2 a(mesh.screen[facet[0]]), b(mesh.screen[facet[1]]), c(mesh.screen[facet[2]]);
        areas.push_back(sum += 0.5 * std::fabs(cross(b - a, c - a)));
    }
    return areas;
}

/// The mean distance over random places of the film between the place and where the exact camera shows what
/// the mesh's ray passes at `t`, in pixels; and the largest. Places at a fold take no part, and are counted.
struct Off {
    double mean = 0, median = 0, largest = 0;
    std::size_t count = 0, at_folds = 0;
};

Off mesh_off(const Camera& camera, double t, bool folds, bool borders) {
    Draw draw(5);
    Off off;
    std::vector<double> all;
    const std::vector<double> areas = areas_up_to(camera.mesh);
    for (int round = 0; round < 4000; ++round) {
        const auto chosen = std::upper_bound(areas.begin(), areas.end() - 1, draw.uniform(0, areas.back()));
        const auto f = static_cast<std::size_t>(chosen - areas.begin());
        const Vec3 weights = draw.weights();
        Vec3 at(0);
        for (int k = 0; k < 3; ++k)
            at += weights[k] * camera.mesh.screen[camera.mesh.facets[f][static_cast<std::size_t>(k)]];
        if (!borders && near_border(*camera.model, Vec2(at))) continue;
        if (folds && near_fold(*camera.model, Vec2(at), t)) {
            ++off.at_folds;
            continue;
        }
        const Ray ray = interpolated_ray(camera.mesh, f, weights);
        double nearest = -1;
        for (std::size_t branch = 0; branch < camera.model->branch_count(); ++branch) {
            if (!camera.model->shows(branch, Vec2(at.x, at.y))) continue;
            for (const FilmImage& place : camera.model->places(ray.origin + t * ray.direction, branch)) {
                Vec2 by = place.pixel - Vec2(at.x, at.y);
                if (camera.model->period() > 0) by.x = std::remainder(by.x, camera.model->period());
                by.x /= camera.model->stretch(Vec2(at.x, at.y));
                if (nearest < 0 || length(by) < nearest) nearest = length(by);
            }
        }
        if (nearest < 0) continue;
        off.mean += nearest;
        off.largest = std::max(off.largest, nearest);
        all.push_back(nearest);
        ++off.count;
    }
    off.mean /= static_cast<double>(off.count);
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
    off.median = all[all.size() / 2];
    return off;
}

}  // namespace

TEST_CASE("a point along an exact ray is shown where the ray leaves the film", "[camera]") {
    Draw draw(1);
    for (CameraDescription from : every_camera()) {
        INFO(from.name);
        from.facets = 4;
        const Camera camera = camera_of(from);
        int tested = 0, missed = 0;
        for (int round = 0; round < 1000; ++round) {
            const Vec2 at(draw.uniform(0, kFilm.width), draw.uniform(0, kFilm.height));
            const std::optional<Ray> ray = exact_ray(camera, at);
            if (!ray) continue;
            const double t = draw.log_uniform(0.2, 20);
            double nearest = 1e9;
            for (const FilmImage& image : film_positions(camera, ray->origin + t * ray->direction)) {
                // Every image is one: its own ray passes the point at its t.
                const Ray there = *exact_ray(camera, image.pixel);
                CHECK(length(there.origin + image.t * there.direction - ray->origin - t * ray->direction) <
                      1e-6 * (1 + t));
                CHECK(length(there.origin - image.origin) < 1e-6);
                nearest = std::min(nearest, length(image.pixel - at));
            }
            if (!(nearest < 1e-4)) UNSCOPED_INFO("missed at " << at.x << ", " << at.y << " t " << t);
            missed += !(nearest < 1e-4);
            ++tested;
        }
        CHECK(tested > 400);
        CHECK(missed == 0);
    }
}

TEST_CASE("the RayMesh comes to the exact rays with order 2", "[camera][law]") {
    for (CameraDescription from : every_camera()) {
        INFO(from.name);
        const bool folds = std::holds_alternative<MultiPerspectiveCamera>(from.kind) ||
                           std::holds_alternative<PlanarContextCamera>(from.kind);
        for (const double t : {1.0, 4.0, 1000.0}) {
            std::array<Off, 3> off;
            for (std::size_t k = 0; k < off.size(); ++k) {
                from.facets = 40 << k;
                off[k] = mesh_off(camera_of(from), t, folds, false);
                CHECK(off[k].count > 3000);
                CHECK(off[k].at_folds < 600);
            }
            INFO("at folds " << off[0].at_folds << " " << off[2].at_folds);
            INFO("t " << t << ": mean " << off[0].mean << " " << off[1].mean << " " << off[2].mean
                      << ", largest " << off[0].largest << " " << off[1].largest << " " << off[2].largest);
            // Affine combinations of three rays: the mesh is exact.
            if (std::holds_alternative<ThreeRayCamera>(from.kind) ||
                std::holds_alternative<PushbroomCamera>(from.kind)) {
                CHECK(off[0].largest < 1e-8);
                continue;
            }
            CHECK(std::log2(off[0].mean / off[2].mean) / 2 > 1.9);
        }
    }
}

TEST_CASE("a tolerance is kept all over the film", "[camera][golden]") {
    for (CameraDescription from : every_camera()) {
        INFO(from.name);
        const bool folds = std::holds_alternative<MultiPerspectiveCamera>(from.kind) ||
                           std::holds_alternative<PlanarContextCamera>(from.kind);
        from.tolerance = 0.25;
        const Camera camera = camera_of(from);
        for (const double far : {1.0, 30.0}) {
            const Off off = mesh_off(camera, far * camera.model->focus(), folds, true);
            INFO(far << ": mean " << off.mean << " largest " << off.largest << " at folds " << off.at_folds);
            CHECK(off.largest <= 0.25 * 1.1);
            CHECK(off.count > 3000);
            CHECK(off.at_folds < 600);
        }
    }
}

TEST_CASE("what panoramas and fisheyes show where, by hand", "[camera][oracle]") {
    CameraDescription from;
    from.eye = {0, 0, 0};
    from.at = {0, 0, -1};
    const auto pixel = [&](const Vec3& point) {
        const auto images = film_positions(camera_of(from), point);
        REQUIRE(images.size() == 1);
        return images[0].pixel;
    };
    from.kind = SphericalCamera{};
    CHECK(length(pixel({0, 0, -2}) - Vec2(160, 120)) < 1e-9);
    CHECK(length(pixel({3, 0, 0}) - Vec2(240, 120)) < 1e-9);  // a quarter turn to the right
    CHECK(length(pixel({0, 1, -1}) - Vec2(160, 60)) < 1e-9);  // 45 degrees up
    CHECK(length(pixel({-1, 0, 1}) - Vec2(40, 120)) < 1e-9);  // 135 degrees to the left
    from.kind = CylindricalCamera{.yfov = 90};
    CHECK(length(pixel({3, 0, 0}) - Vec2(240, 120)) < 1e-9);
    CHECK(length(pixel({0, 1, -2}) - Vec2(160, 60)) < 1e-9);  // half way to the top: slope 1/2
    from.kind = FisheyeCamera{.fov = 180};
    CHECK(length(pixel({1, 0, -1}) - Vec2(220, 120)) < 1e-9);  // 45 of 90 degrees
    from.kind = FisheyeCamera{.mapping = FisheyeMapping::kOrthographic};
    CHECK(length(pixel({1, 0, -1}) - Vec2(160 + 120 / std::sqrt(2.0), 120)) < 1e-9);
    from.kind = FisheyeCamera{.mapping = FisheyeMapping::kStereographic};
    CHECK(length(pixel({0, 1, -1}) - Vec2(160, 120 - 120 * std::tan(kPi / 8))) < 1e-9);
    from.kind = FisheyeCamera{.mapping = FisheyeMapping::kEquisolid};
    CHECK(length(pixel({0, -1, -1}) - Vec2(160, 120 + 120 * std::sin(kPi / 8) * std::sqrt(2.0))) < 1e-9);
    CHECK_FALSE(exact_ray(camera_of(from), {20, 120}));
    CHECK(exact_ray(camera_of(from), {41, 120}));
}

TEST_CASE("the seam of a panorama and the far side of an inward sphere show a point twice", "[camera][law]") {
    CameraDescription from;
    from.eye = {0, 0, 0};
    from.at = {0, 0, -1};
    from.kind = SphericalCamera{.hfov = 360};
    CHECK(film_positions(camera_of(from), {0, 0.4, 2}).size() == 2);  // on the seam: both borders
    from.kind = SphericalCamera{.hfov = 180};
    const auto behind = film_positions(camera_of(from), {0.3, 0.4, 2});
    REQUIRE(behind.size() == 1);
    CHECK((behind[0].pixel.x < 0 || behind[0].pixel.x > kFilm.width));

    CameraDescription around;
    around.eye = {0, 0, 5};
    around.kind = InwardSphereCamera{.radius = 2};
    const auto images = film_positions(camera_of(around), {0, 0, 0.5});
    REQUIRE(images.size() >= 2);
    CHECK(images[0].t == Approx(1.5));
    CHECK(length(images[0].pixel - Vec2(160, 120)) < 1e-9);
    CHECK(images.back().t == Approx(2.5));
}

TEST_CASE("crossed slits that cross are a pinhole, a pushbroom that stands still nearly one", "[camera]") {
    // Slits through one point, seen from it: where a perspective shows the same points.
    CameraDescription slits;
    slits.eye = {0, 0, 4};
    slits.kind =
        CrossedSlitsCamera{.slits = {WorldLine{{0, 0, 4}, {0, 1, 0}}, WorldLine{{0, 0, 4 + 1e-7}, {1, 0, 0}}},
                           .window = {-2, 2, -1.5, 1.5}};
    CameraDescription pinhole;
    pinhole.eye = {0, 0, 4};
    const double yfov = 2 * std::atan(1.5 / 4) * 180 / kPi;
    pinhole.kind = PerspectiveCamera{.yfov = yfov};
    const Camera a = camera_of(slits), b = camera_of(pinhole);
    Draw draw(3);
    for (int k = 0; k < 100; ++k) {
        const Vec3 point = draw.in_cube(1.5);
        const auto in_a = film_positions(a, point), in_b = film_positions(b, point);
        REQUIRE(in_a.size() == 1);
        REQUIRE(in_b.size() == 1);
        CHECK(length(in_a[0].pixel - in_b[0].pixel) < 1e-4);
    }
    CameraDescription pushbroom = pinhole;
    pushbroom.kind = PushbroomCamera{.yfov = yfov, .travel = {3, 0, 0}};
    const auto image = film_positions(camera_of(pushbroom), {0.75, 1, 0});
    REQUIRE(image.size() == 1);
    CHECK(image[0].pixel.x == Approx(160 * 1.5));  // a quarter of the way from the middle
    CHECK(image[0].pixel.y == Approx(120 * (1 - 1 / 1.5)));
    CHECK(length(image[0].origin - Vec3(0.75, 0, 4)) < 1e-12);
}

TEST_CASE("the bent ground: flat near the eye, rigid beyond the arc, continuous between", "[camera][law]") {
    CameraDescription from = every_camera().back();
    from.eye = {0, 1.5, 0};
    from.at = {0, 1.4, -1};
    auto& ground = std::get<PlanarContextCamera>(from.kind);
    ground.angle = 60;
    ground.bend = 3;
    const Camera camera = camera_of(from);
    CameraDescription plain = from;
    plain.kind = PerspectiveCamera{.yfov = ground.yfov};
    const Camera perspective = camera_of(plain);
    // Near ground is where a perspective shows it.
    const auto near_here = film_positions(camera, {0.4, 0, -2.5});
    const auto near_there = film_positions(perspective, {0.4, 0, -2.5});
    REQUIRE(!near_here.empty());
    CHECK(length(near_here[0].pixel - near_there[0].pixel) < 1e-9);
    // Far ground is where a perspective shows the turned up plane: 6 + s beyond the eye's foot lies at
    // s along the tail.
    const double a = kPi / 3, r = 3 / a, s = 4;
    const Vec3 bent(0.7, r * (1 - std::cos(a)) + s * std::sin(a), -(3 + r * std::sin(a) + s * std::cos(a)));
    const auto far_here = film_positions(camera, {0.7, 0, -(6 + s)}),
               far_there = film_positions(perspective, bent);
    REQUIRE(!far_here.empty());
    REQUIRE(far_there.size() == 1);
    CHECK(length(far_here.back().pixel - far_there[0].pixel) < 1e-9);
    // Ground point by ground point away from the eye, the film shows them without jumps, ever higher.
    double last = 1e9;
    for (double z = -2; z > -40; z -= 0.05) {
        const auto images = film_positions(camera, {0, 0, z});
        if (images.empty()) {
            CHECK(z < -6);  // above the film
            break;
        }
        const double y = images[0].pixel.y;
        CHECK(y < last);
        if (last < 1e9) CHECK(last - y < 12);
        last = y;
    }
    for (double y = 0; y < 240; y += 0.37) {
        const Ray one = *exact_ray(camera, {100, y}), next = *exact_ray(camera, {100, y + 1e-6});
        CHECK(length(one.origin - next.origin) < 1e-5);
        CHECK(length(one.direction - next.direction) < 1e-5);
    }
}

TEST_CASE("the detail is a perspective, the border sees the context's angle", "[camera]") {
    CameraDescription from;
    from.eye = {0, 0, 0};
    from.at = {0, 0, -1};
    from.kind = DistortionCamera{.yfov = 20, .detail = {0.25, 0.25, 0.75, 0.75}, .context_fov = 160};
    const Camera camera = camera_of(from);
    const double slope = std::tan(kPi / 18);
    CHECK(length(normalize(exact_ray(camera, {160, 60})->direction) - normalize(Vec3(0, slope, -1))) < 1e-12);
    CHECK(length(normalize(exact_ray(camera, {200, 120})->direction) -
                 normalize(Vec3(40 * slope / 60, 0, -1))) < 1e-12);
    for (const Vec2& at : {Vec2(0, 120), Vec2(320, 120), Vec2(160, 0), Vec2(77, 240), Vec2(320, 240)})
        CHECK(-normalize(exact_ray(camera, at)->direction).z == Approx(std::cos(80 * kPi / 180)));
}

TEST_CASE("between views rays pass from one to the next, without a jump", "[camera][law]") {
    for (const CameraDescription& from : every_camera()) {
        if (!std::holds_alternative<MultiPerspectiveCamera>(from.kind)) continue;
        const Camera camera = camera_of(from);
        Ray last = *exact_ray(camera, {100, 60});
        for (double x = 100.01; x < 319; x += 0.01) {
            const std::optional<Ray> ray = exact_ray(camera, {x, 60});
            REQUIRE(ray);
            CHECK(length(ray->origin - last.origin) < 0.01);
            CHECK(length(ray->direction - last.direction) < 0.01);
            last = *ray;
        }
        CHECK(length(last.origin - Vec3(3.5, 1.5, 2.5)) < 1e-9);
        CameraDescription hard = from;
        std::get<MultiPerspectiveCamera>(hard.kind).blend = 0;
        const Camera cut = camera_of(hard);
        CHECK(length(exact_ray(cut, {191.999, 60})->origin - from.eye) < 1e-9);
        CHECK(length(exact_ray(cut, {192.001, 60})->origin - Vec3(3.5, 1.5, 2.5)) < 1e-9);
    }
}

TEST_CASE("distorted and back is where it was", "[camera]") {
    Draw draw(9);
    for (const CameraDescription& from : every_camera()) {
        if (!std::holds_alternative<OpencvLens>(from.kind)) continue;
        INFO(from.name);
        const Camera camera = camera_of(from);
        for (int k = 0; k < 300; ++k) {
            const Vec2 at(draw.uniform(0, 320), draw.uniform(0, 240));
            const Ray ray = *exact_ray(camera, at);
            const auto images = film_positions(camera, ray.origin + 2.0 * ray.direction);
            REQUIRE(images.size() == 1);
            CHECK(length(images[0].pixel - at) < 1e-8);
        }
    }
}
