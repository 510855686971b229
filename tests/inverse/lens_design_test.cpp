// Designed lenses: closed forms come back, light takes equally long on all ways to a focus, and what rays
// through the scene do is what the design says.
#include <algorithm>
#include <cmath>

#include "base/util/error.h"
#include "inverse/design/design.h"
#include "inverse/design/mirror_fit.h"
#include "support/test.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;

namespace {

/// A lens of 20 x 16 cm half a metre before the eye, on its axis.
DesignWish lens_wish() {
    DesignWish wish;
    wish.eye = {0, 0, 0.5};
    wish.patch.size = {0.2, 0.16};
    wish.patch.controls = {24, 20};
    wish.lens = {1.5, 0.08};
    wish.fairness = 0;
    wish.samples = {60, 50};
    return wish;
}

/// The same of one value everywhere: one direction, or one point.
DesignWish constant_wish(const Vec3& value, bool is_direction) {
    DesignWish wish = lens_wish();
    wish.wish.type = WishType::kMap;
    wish.wish.is_directions = is_direction;
    wish.wish.columns = wish.wish.rows = 4;
    wish.wish.values.assign(16, value);
    return wish;
}

/// A slanting wall behind, seen smaller than without the lens.
DesignWish wall_wish() {
    DesignWish wish = lens_wish();
    wish.wish.origin = {-0.15, -0.13, -0.7};
    wish.wish.u = {0.3, 0, 0.04};
    wish.wish.v = {0, 0.25, 0.05};
    return wish;
}

/// Of a point `distance` before it whose light is parallel in glass of index n: the hyperboloid of equal
/// optical lengths, |P - E| + n z = distance (Descartes' oval with its other focus at infinity).
double collimating_height(double distance, double n, double radius) {
    const double b = distance * (n - 1), a = n * n - 1;
    return (b - std::sqrt(b * b + a * radius * radius)) / a;
}

/// How far beside `place` a ray leaves the back that meets `point` behind: Snell's law, by halving its angle.
double snell_exit(const Vec3& place, const Vec3& point, const DesignLens& lens) {
    const double depth = place.z + lens.thickness, beyond = -lens.thickness - point.z;
    const double across = length(Vec2(point) - Vec2(place));
    double low = 0, high = std::asin(1 / lens.ior);
    for (int k = 0; k < 200; ++k) {
        const double angle = (low + high) / 2;
        const double sine = std::min(1.0, lens.ior * std::sin(angle));
        const double meets = depth * std::tan(angle) + beyond * sine / std::sqrt(1 - sine * sine);
        (meets < across ? low : high) = angle;
    }
    return depth * std::tan(low);
}

/// A thin lens before a wall parallel to it, `beyond` behind its back, seen a little smaller than through a
/// plate.
DesignWish near_wall_wish(double beyond) {
    DesignWish wish = lens_wish();
    wish.lens->thickness = 0.05;
    const double scale = 0.97 * (0.5 + 0.05 / 1.5 + beyond) / 0.5;
    wish.wish.u = {scale * 0.2, 0, 0};
    wish.wish.v = {0, scale * 0.16, 0};
    wish.wish.origin = Vec3(0, 0, -0.05 - beyond) - (wish.wish.u + wish.wish.v) / 2.0;
    return wish;
}

}  // namespace

TEST_CASE("the lens that makes a point's light parallel is the closed form's hyperboloid",
          "[inverse][law][oracle]") {
    const DesignWish wish = constant_wish({0, 0, -1}, true);
    const Design lens = design_mirror(wish);
    CHECK(lens.converged);
    CHECK(lens.errors.max < 1e-3);  // degrees
    CHECK(lens.curl < 1e-8);
    double worst = 0;
    for (const Vec2& at : patch_samples(wish.patch.size, {31, 27}))
        worst =
            std::max(worst, std::abs(lens.surface.height(at).z - collimating_height(0.5, 1.5, length(at))));
    INFO("off by " << worst);
    CHECK(worst < 1e-7);
    // Its radius of curvature in the middle: (n - 1) times the distance.
    const double curvature = largest_curvature(lens.surface.height({0, 0}));
    CHECK(std::abs(curvature * 0.5 * 0.5 - 1) < 1e-3);
}

TEST_CASE("light takes equally long on all ways through a lens to its focus", "[inverse][law]") {
    const Vec3 focus(0.03, -0.02, -0.8);
    const DesignWish wish = constant_wish(focus, false);
    const Design lens = design_mirror(wish),
                 linear = design_mirror(wish, {DesignMethod::kPicard, false, 100});
    CHECK(lens.converged);
    CHECK(linear.converged);
    CHECK(lens.errors.max < 1e-3);
    const WishedRays rays(wish);
    double shortest = 1e9, longest = 0, apart = 0;
    for (const Vec2& at : patch_samples(wish.patch.size, {21, 17})) {
        const Height h = lens.surface.height(at);
        const Ray out = leaving_ray(rays, at, h);
        const Vec3 place(at, h.z);
        const double way =
            length(place - wish.eye) + 1.5 * length(out.origin - place) + length(focus - out.origin);
        shortest = std::min(shortest, way), longest = std::max(longest, way);
        apart = std::max(apart, std::abs(h.z - linear.surface.height(at).z));
    }
    INFO("ways differ by " << longest - shortest << ", heights by " << apart);
    CHECK(longest - shortest < 1e-7);
    CHECK(apart < 1e-7);
}

TEST_CASE("rays through a designed lens' scene are as far from the wish as the design says",
          "[inverse][law]") {
    const DesignWish wish = wall_wish();
    const Design lens = design_mirror(wish, {DesignMethod::kGaussNewton, true, 20});
    CHECK(lens.errors.mean < 0.6 * lens.sphere->errors.mean);
    const Scene scene = parse_scene(design_scene(wish, lens));
    CHECK(scene.warnings.empty());  // its body is closed
    CHECK(parse_scene(design_scene(wish, design_of_sphere(wish, lens))).warnings.empty());
    std::vector<Vec2> places;
    for (int row = 0; row < 48; ++row)
        for (int column = 0; column < 64; ++column)
            places.push_back(Vec2(column + 0.5, row + 0.5) / Vec2(64, 48) *
                             Vec2(scene.film.width, scene.film.height));
    ShootRequest request;
    request.path = EventWord("TT");
    const ShotRays shots = Renderer(scene).shoot(places, request);
    const WishedRays rays(wish);
    std::vector<double> degrees;
    double off_surface = 0;
    for (const ShotRay& shot : shots.rays) {
        if (!shot.followed() || shot.event_count != 2) continue;
        const Vec3 place = shots.events_of(shot)[0].point, from = shots.events_of(shot)[1].point;
        if (from.z > *lens.back + 1e-9 || std::abs(place.x) > 0.0999 || std::abs(place.y) > 0.0799) continue;
        off_surface = std::max(off_surface, std::abs(place.z - lens.surface.height(Vec2(place)).z));
        const double cosine = dot(shot.direction, rays.wanted(place, from));
        degrees.push_back(std::acos(std::min(1.0, cosine)) * 57.29577951308232);
    }
    REQUIRE(degrees.size() > 1500);
    CHECK(off_surface < 1e-9);
    const DesignErrors shot = design_errors(degrees);
    INFO(shot.mean << " and " << lens.errors.mean << " degrees; sphere " << lens.sphere->errors.mean);
    CHECK(std::abs(shot.mean / lens.errors.mean - 1) < 0.05);
    CHECK(shot.max < 1.2 * lens.errors.max);
}

TEST_CASE("light finds its way out of a lens to a point however near to the back", "[inverse][law][oracle]") {
    double off = 0, missed = 0;
    for (const double ior : {1.3, 1.5, 2.4})
        for (const double thicknesses : {1e-4, 0.1, 0.3, 0.6, 1.0, 3.0, 10.0})
            for (const double across : {0.0, 0.01, 0.03, 0.05}) {
                const Vec3 place(0.03, -0.02, 0.004), aside = across * Vec3(0.6, -0.8, 0);
                DesignWish wish = constant_wish(
                    Vec3(0.03, -0.02, -0.08 * (1 + thicknesses)) + (1 + thicknesses) * aside, false);
                wish.lens->ior = ior;
                INFO(ior << ", " << thicknesses << " thicknesses behind, " << across << " aside");
                const WishedRays rays(wish);
                const NeededSlopes needed = needed_slopes(rays, place);
                REQUIRE(!needed.refusal);
                const Height h{place.z, needed.slopes.x, needed.slopes.y};
                const double exit = snell_exit(place, wish.wish.values[0], *wish.lens);
                off = std::max(off, length(leaving_ray(rays, Vec2(place), h).origin -
                                           (Vec3(Vec2(place), -0.08) + exit * Vec3(0.6, -0.8, 0))));
                if (thicknesses > 0.01) missed = std::max(missed, ray_error(rays, Vec2(place), h));
            }
    INFO("off by " << off << ", " << missed << " degrees");
    CHECK(off < 1e-12);
    CHECK(missed < 1e-9);
    for (const double beyond : {0.005, 0.02, 0.035, 0.045, 0.055, 0.5}) {
        const DesignWish wish = near_wall_wish(beyond);
        const Design lens = design_mirror(wish);
        INFO(beyond << " behind: " << lens.errors.mean << " degrees, curl " << lens.curl);
        CHECK(lens.converged);
        CHECK(lens.errors.mean < 2e-3);
    }
}

TEST_CASE("lenses that cannot be are refused with their place", "[inverse][bad-input]") {
    const auto refused = [](DesignWish wish) {
        try {
            design_mirror(wish);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    DesignWish thin = constant_wish({0, 0, -1}, true);
    thin.lens->thickness = 0.02;
    CHECK(refused(thin).find("the front would cut the back") != std::string::npos);
    DesignWish air = wall_wish();
    air.lens->ior = 1;
    CHECK(refused(air).find("/lens/ior") != std::string::npos);
    DesignWish flat = wall_wish();
    flat.lens->thickness = 0;
    CHECK(refused(flat).find("/lens/thickness") != std::string::npos);
    const std::string behind = "of the lens what is wished does not lie behind its back";
    CHECK(refused(constant_wish({0, 0, 1}, true)).find(behind) != std::string::npos);
    CHECK(refused(constant_wish({0, 0, -0.07}, false)).find(behind) != std::string::npos);
    CHECK(refused(constant_wish({1, 0, -0.1}, true)).find("no front turns") != std::string::npos);
    const std::string text =
        R"({"version": 1, "eye": [0, 0, 1], "patch": {"center": [0, 0, 0], "normal": [0, 0, 1],
        "tangent": [1, 0, 0], "size": [0.2, 0.2]}, "lens": {"ior": 1.5},
        "wish": {"type": "equirectangular", "window": [-5, -5, 5, 5]}})";
    CHECK_THROWS_AS(parse_wish(text, "wish.json"), InputError);
    for (const char* window : {"[-5, -95, 5, 5]", "[-5, -5, 5, 90.5]"}) {
        std::string beyond = text;
        beyond.replace(beyond.find("1.5}"), 4, R"(1.5, "thickness": 0.05})");
        beyond.replace(beyond.find("[-5, -5, 5, 5]"), 14, window);
        CHECK_THROWS_WITH(
            parse_wish(beyond, "wish.json"),
            ContainsSubstring("/wish/window/") && ContainsSubstring("latitude beyond 90 degrees"));
    }
    std::string thick = text;
    thick.replace(thick.find("1.5}"), 4, R"(1.5, "thickness": 0.05})");
    const DesignWish read = parse_wish(thick, "wish.json");
    REQUIRE(read.lens.has_value());
    CHECK(read.lens->thickness == 0.05);
    CHECK(design_mirror(read).errors.mean < 0.1);
}
