// Designed mirrors: known surfaces come back, two solvers agree, and curl says what no mirror can do.
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <tuple>

#include "base/util/error.h"
#include "camera/camera.h"
#include "inverse/design/design.h"
#include "inverse/design/mirror_fit.h"
#include "support/test.h"
#include "trilens/render.h"
#include "trilens/scene.h"
#include "trilens/surface.h"

using namespace trilens;

namespace {

DesignWish driver_wish() {
    return parse_wish(wish_example(), "example");
}

/// The same mirror with its eye and wall on the axis.
DesignWish wish_on_axis() {
    DesignWish wish = driver_wish();
    wish.eye = {0, 0, 0.87};
    wish.wish.origin = {-4.14, -2.277, 10};
    wish.wish.u = {8.28, 0, 0};
    wish.wish.v = {0, 4.554, 0};
    return wish;
}

/// The wish that a surface z(x, y) through (0, 0, 0) fulfils: what its reflections show on a wall at z = 9,
/// as a map over the eye's view.
DesignWish wish_of_surface(const std::function<Height(const Vec2&)>& surface, int nodes) {
    DesignWish wish = driver_wish();
    wish.wish = {};
    wish.wish.type = WishType::kMap;
    wish.wish.columns = wish.wish.rows = nodes;
    const PatchFrame frame(wish.patch);
    const Vec3 eye = wish.eye, look = -normalize(eye), right = normalize(Vec3(1, 0, 0) - look.x * look),
               up = cross(right, look);
    for (int row = 0; row < nodes; ++row)
        for (int column = 0; column < nodes; ++column) {
            const Vec2 st = Vec2(column, row) / (nodes - 1.0) - 0.5;
            const Vec3 through =
                st.x * wish.patch.size.x * right.x * right + st.y * wish.patch.size.y * up.y * up;
            const Vec3 ray = normalize(through - eye);
            double t = -eye.z / ray.z;
            for (int k = 0; k < 50; ++k) {
                const Vec3 p = eye + t * ray;
                const Height h = surface(Vec2(p));
                t -= (p.z - h.z) / (ray.z - h.x * ray.x - h.y * ray.y);
            }
            const Vec3 place = eye + t * ray;
            const Height h = surface(Vec2(place));
            const Vec3 n = normalize(Vec3(-h.x, -h.y, 1)), out = ray - 2 * dot(ray, n) * n;
            wish.wish.values.push_back(place + (9 - place.z) / out.z * out);
        }
    return wish;
}

Height paraboloid(const Vec2& at) {
    Height h;
    h.z = -0.6 * at.x * at.x - 0.4 * at.y * at.y + 0.1 * at.x * at.y + 0.05 * at.x;
    h.x = -1.2 * at.x + 0.1 * at.y + 0.05;
    h.y = -0.8 * at.y + 0.1 * at.x;
    h.xx = -1.2, h.yy = -0.8, h.xy = 0.1;
    return h;
}

}  // namespace

TEST_CASE("a B-spline's heights have the derivatives that they say, and are the cage's limit surface",
          "[inverse]") {
    DesignWish wish = driver_wish();
    wish.patch.controls = {7, 9};
    Design design;
    design.surface = HeightField(wish.patch.size, wish.patch.controls);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(-0.5, 0.5);
    for (double& height : design.surface.heights) height = 0.02 * share(random);
    const double h = 1e-5;
    for (int k = 0; k < 50; ++k) {
        const Vec2 at = 0.98 * Vec2(share(random), share(random)) * wish.patch.size;
        const Height here = design.surface.height(at), right = design.surface.height(at + Vec2(h, 0)),
                     left = design.surface.height(at - Vec2(h, 0)),
                     up = design.surface.height(at + Vec2(0, h)),
                     down = design.surface.height(at - Vec2(0, h));
        CHECK(std::abs((right.z - left.z) / (2 * h) - here.x) < 1e-6);
        CHECK(std::abs((up.z - down.z) / (2 * h) - here.y) < 1e-6);
        CHECK(std::abs((right.x - left.x) / (2 * h) - here.xx) < 1e-3);
        CHECK(std::abs((up.y - down.y) / (2 * h) - here.yy) < 1e-3);
        CHECK(std::abs((right.y - left.y) / (2 * h) - here.xy) < 1e-3);
    }
    const auto surface = make_surface(design_cage(wish, design));
    REQUIRE(surface->face_count() == 4 * 6);
    const PatchFrame frame(wish.patch);
    double worst = 0;
    for (Id face = 0; face < surface->face_count(); ++face)
        for (const Vec2& uv : {Vec2(0.2, 0.3), Vec2(0.9, 0.5)}) {
            const Vec3 local = frame.to_patch(surface->eval(face, uv).position);
            worst = std::max(worst, std::abs(local.z - design.surface.height(Vec2(local)).z));
        }
    CHECK(worst < 1e-12);
}

TEST_CASE("rows of a design's rays are their derivatives", "[inverse][law]") {
    const DesignWish wish = driver_wish();
    const WishedRays rays(wish);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> share(-0.5, 0.5);
    for (int k = 0; k < 100; ++k) {
        const Vec2 at = Vec2(share(random), share(random)) * wish.patch.size;
        Height h;
        h.z = 0.01 * share(random), h.x = 0.4 * share(random), h.y = 0.4 * share(random);
        const RayRows rows = ray_rows(rays, at, h, 0.2);
        const auto change = [&](double Height::*member, double step) {
            Height low = h, high = h;
            low.*member -= step, high.*member += step;
            return (ray_residual(rays, at, high) - ray_residual(rays, at, low)) / (2 * step);
        };
        CHECK(length(change(&Height::z, 1e-6) - rows.by_z) < 1e-6);
        CHECK(length(change(&Height::x, 1e-6) - rows.by_x) < 1e-8);
        CHECK(length(change(&Height::y, 1e-6) - rows.by_y) < 1e-8);
    }
}

TEST_CASE("the map of a known paraboloid has no curl on it, and gives it back by both solvers",
          "[inverse][law]") {
    DesignWish wish = wish_of_surface(paraboloid, 161);
    wish.fairness = 0;
    const WishedRays rays(wish);
    for (const Vec2& at : patch_samples(wish.patch.size, {7, 5}))
        CHECK(std::abs(slope_curl(rays, Vec3(at, paraboloid(at).z), 1e-5)) < 1e-3);

    const Design newton = design_mirror(wish),
                 linear = design_mirror(wish, {DesignMethod::kPicard, false, 60});
    REQUIRE(newton.converged);
    REQUIRE(linear.converged);
    CHECK(newton.errors.max < 1e-4);
    CHECK(newton.curl < 1e-3);
    double from_truth = 0, apart = 0;
    for (const Vec2& at : patch_samples(wish.patch.size, {9, 9})) {
        from_truth = std::max(from_truth, std::abs(newton.surface.height(at).z - paraboloid(at).z));
        apart = std::max(apart, std::abs(newton.surface.height(at).z - linear.surface.height(at).z));
    }
    CHECK(from_truth < 1e-7);
    CHECK(apart < 1e-7);
}

TEST_CASE("a driver's mirror beats the best sphere, on and off its axis, and curl tells how far",
          "[inverse][law]") {
    const Design on = design_mirror(wish_on_axis(), {DesignMethod::kGaussNewton, true, 20});
    CHECK(on.errors.mean < 0.001);
    CHECK(on.sphere->errors.mean > 0.2);
    CHECK(on.curl < 0.01);

    const Design off = design_mirror(driver_wish(), {DesignMethod::kGaussNewton, true, 20});
    CHECK(off.converged);
    CHECK(off.errors.mean < 0.5 * off.sphere->errors.mean);
    CHECK(off.curl > 0.1);
    // A map that no mirror has: more control points change nothing.
    DesignWish fine = driver_wish();
    fine.patch.controls = {20, 20};
    CHECK(std::abs(design_mirror(fine).errors.mean / off.errors.mean - 1) < 0.02);

    // The sphere as control points is the sphere.
    const DesignWish wish = driver_wish();
    const HeightField sphere = design_of_sphere(wish, off).surface;
    for (const Vec2& at : patch_samples(wish.patch.size, {6, 5}))
        CHECK(std::abs(sphere.height(at).z - sphere_height(1 / off.sphere->radius, off.sphere->tilt, at)->z) <
              1e-6);

    // Without its anchor the surface would slide along the rays; with it its middle stays in the rectangle.
    CHECK(std::abs(off.surface.height({0, 0}).z) < 1e-6);
    CHECK(off.sag < 0.05);
}

TEST_CASE(
    "errors and sag are those all over the rectangle, and a surface that keeps to its samples is told of",
    "[inverse][law][thorough]") {
    // By reflecting at places of a grid of its own.
    const auto all_over = [](const DesignWish& wish, const Design& design) {
        const WishedRays rays(wish);
        std::vector<double> degrees;
        for (const Vec2& at : patch_samples(wish.patch.size, {157, 131}))
            degrees.push_back(ray_error(rays, at, design.surface.height(at)));
        return design_errors(degrees);
    };
    DesignWish wish = wish_on_axis();
    for (const auto& [samples, controls, is_told] :
         {std::tuple(40, 12, false), {40, 30, false}, {40, 40, true}, {8, 12, true}}) {
        wish.samples = {samples, samples}, wish.patch.controls = {controls, controls};
        const Design design = design_mirror(wish);
        const DesignErrors truth = all_over(wish, design);
        INFO(samples << " samples, " << controls << " control points");
        CHECK(design.errors.mean == Approx(truth.mean).epsilon(0.1));
        CHECK(design.errors.max > 0.8 * truth.max);
        double lowest = INFINITY, highest = -INFINITY;
        for (int row = 0; row <= 200; ++row)
            for (int column = 0; column <= 200; ++column) {
                const double z = design.surface.height((Vec2(column, row) / 200.0 - 0.5) * wish.patch.size).z;
                lowest = std::min(lowest, z), highest = std::max(highest, z);
            }
        CHECK(design.sag == Approx(highest - lowest).epsilon(1e-3));
        const bool told = std::any_of(
            design.warnings.begin(), design.warnings.end(),
            [](const auto& warning) { return warning.find("take more samples") != std::string::npos; });
        CHECK(told == is_told);
    }
}

TEST_CASE("what a designed mirror shows, traced, is as far from the wish as it says", "[inverse][law]") {
    const DesignWish wish = driver_wish();
    const Design design = design_mirror(wish);
    const std::vector<SceneOverride> small{{"/film", R"({"width": 96, "height": 53, "spp": 1})"}};
    const Scene scene = parse_scene(design_scene(wish, design), "", small);
    CHECK(scene.warnings.empty());
    std::vector<std::string> said;
    const Renderer renderer(scene, [&](const std::string& warning) { said.push_back(warning); });
    CHECK(said.empty());
    PictureRequest request;
    request.engine = Engine::kLimitTruth;
    request.layers.layers = {"reflect", "position"};
    const Image image = renderer.draw(request).image;
    const Channel *x = image.find("reflectP.X"), *y = image.find("reflectP.Y"), *z = image.find("reflectP.Z"),
                  *id = image.find("reflectID.object");
    REQUIRE((x && y && z && id));

    // Where the eye's ray through the pixel meets the wish: the wall's point from the same (s, t).
    const PatchFrame frame(wish.patch);
    const Camera camera = make_camera(scene.cameras[0], {96, 53});
    const WishedRays rays(wish);
    std::vector<double> degrees;
    for (int row = 0; row < 53; ++row)
        for (int column = 0; column < 96; ++column) {
            const std::size_t k = static_cast<std::size_t>(row * 96 + column);
            if (id->ids()[k] == kNone) continue;
            const Ray ray = *exact_ray(camera, {column + 0.5, row + 0.5});
            const Vec3 from = frame.to_patch(ray.origin),
                       along = normalize(frame.to_patch(ray.origin + ray.direction) - from);
            double t = -from.z / along.z;
            for (int i = 0; i < 20; ++i) {
                const Vec3 p = from + t * along;
                const Height h = design.surface.height(Vec2(p));
                t -= (p.z - h.z) / (along.z - h.x * along.x - h.y * along.y);
            }
            const Vec3 place = from + t * along;
            if (std::abs(place.x) > 0.099 || std::abs(place.y) > 0.054) continue;
            const Vec3 seen = frame.to_patch({x->floats()[k], y->floats()[k], z->floats()[k]});
            const double cosine = dot(normalize(seen - place), rays.wanted(place));
            degrees.push_back(std::acos(std::min(1.0, cosine)) * 57.29577951308232);
        }
    REQUIRE(degrees.size() > 2000);
    const DesignErrors traced = design_errors(degrees);
    CHECK(std::abs(traced.mean / design.errors.mean - 1) < 0.05);
    CHECK(traced.max < 1.2 * design.errors.max);
}

TEST_CASE("what no mirror can be made for is refused with its place", "[inverse][bad-input]") {
    const auto refused = [](const std::string& from, const std::string& to) {
        std::string text = wish_example();
        const std::size_t at = text.find(from);
        REQUIRE(at != std::string::npos);
        text.replace(at, from.size(), to);
        try {
            parse_wish(text, "wish.json");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    CHECK(refused("[0.4218, 0, 0.7609]", "[0, 0, -1]").find("/eye: lies behind") != std::string::npos);
    CHECK(refused("[12, 12]", "[3, 12]").find("/patch/controls") != std::string::npos);
    CHECK(refused("[1, 0, 0]", "[0, 0, 2]").find("parallel to the normal") != std::string::npos);
    CHECK(refused("[0.2, 0.11]", "[0.2, 0]").find("/patch/size") != std::string::npos);
    CHECK(refused("\"plane\"", "\"plan\"").find("/wish/type") != std::string::npos);
    CHECK(refused("\"u\": [7.65, 0, 3.169], ", "").find("'u'") != std::string::npos);
    CHECK(refused("\"fairness\"", "\"fairnes\"").find("did you mean 'fairness'") != std::string::npos);
    CHECK(refused("[-7.652, -2.603, 7.654]", "[-7.652, -2.603, -90]").find("goes into it") !=
          std::string::npos);
    CHECK(refused("\"type\": \"plane\", \"origin\"", "\"type\": \"map\", \"file\": \"none.exr\", \"origin\"")
              .find("wish.json") != std::string::npos);
    DesignWish few = driver_wish();
    few.patch.controls = {60, 60};
    few.samples = {8, 8};
    few.fairness = 0;
    CHECK_THROWS_AS(design_mirror(few), ComputationError);
}
