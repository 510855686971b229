// What is proven of displacement, held against where traced rays find what mirrors show.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/util/error.h"
#include "camera/linear/linear_cameras.h"
#include "laws/worlds.h"
#include "measure/compare.h"
#include "render/frame/frame.h"
#include "render/frame/image_chain.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kLimit = 0.5;  // pixels
constexpr double kNear = 1e-3;  // of images by differences and places in floats

/// A ball of glass in a closed room, that lets all light through.
constexpr const char* kClearBall = R"({
    "version": 1,
    "film": {"width": 160, "height": 120},
    "cameras": [{"name": "main", "type": "perspective", "yfov": 32,
                 "lookAt": {"eye": [0, 0.4, 4], "at": [0, 0, 0], "up": [0, 1, 0]}}],
    "render": {"fresnel": false},
    "materials": [{"name": "glass", "transmissionFactor": 1, "ior": 1.5}, {"name": "wall"}],
    "meshes": [{"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
                "primitive": {"type": "sphere", "radius": 1}},
               {"name": "room", "role": "object", "material": "wall",
                "primitive": {"type": "box", "size": [12, 8, 12]}}],
    "lights": [{"type": "ambient", "color": [1, 1, 1]}]
})";

PictureRequest certified(double limit) {
    PictureRequest request;
    request.frame.max_error = limit;
    request.frame.certify = true;
    request.layers.layers = {"optic", "reflect", "refract", "stat", "bound"};
    return request;
}

Picture draw(const World& world, PictureRequest request) {
    return draw_picture(world, request, {}, ignore);
}

/// What a pixel shows in the mirror: a place, or (`is_far`) the direction of one in the environment.
struct Seen {
    std::size_t optic = 0;
    Vec3 at{0};
    bool is_far = false;
};

/// How far from `pixel` on the film the exact mirror shows that: Newton's method over traced rays, by
/// differences. None where it does not end.
std::optional<double> traced_displacement(const World& world, const LinearCamera& camera, const Vec2& pixel,
                                          const Seen& seen) {
    const auto mirrored = [&](const Vec2& place) -> std::optional<Ray> {
        const Ray ray = film_ray(camera, place);
        const auto hit = limit_tracer(world, seen.optic).first_hit(ray);
        if (!hit) return std::nullopt;
        const Vec3 d = normalize(ray.direction), &n = hit->point.normal;
        return Ray{hit->point.position, d - 2 * dot(d, n) * n};
    };
    const auto start = mirrored(pixel);
    if (!start) return std::nullopt;
    const Vec3 axis = start->direction, a = unit_across(axis), b = cross(axis, a);
    const auto miss = [&](const Vec2& place) -> std::optional<Vec2> {
        const auto ray = mirrored(place);
        if (!ray) return std::nullopt;
        const Vec3 towards = seen.is_far ? seen.at : seen.at - ray->origin;
        const Vec3 off = towards / dot(towards, axis) - ray->direction / dot(ray->direction, axis);
        return Vec2(dot(off, a), dot(off, b));
    };
    Vec2 place = pixel;
    for (int i = 0; i < 30; ++i) {
        constexpr double kStep = 1e-4;
        const auto here = miss(place), x = miss(place + Vec2(kStep, 0)), y = miss(place + Vec2(0, kStep));
        if (!here || !x || !y) return std::nullopt;
        const Vec2 step = glm::inverse(Mat2((*x - *here) / kStep, (*y - *here) / kStep)) * *here;
        if (!(length(step) < 10)) return std::nullopt;
        place -= step;
        if (length(step) < 1e-7) return length(place - pixel);
    }
    return std::nullopt;
}

struct Held {
    std::size_t certified = 0, asked = 0, traced = 0;
    double largest = 0;
};

/// Every pixel's bound, and every third one's against where rays say that it is.
Held hold_bounds(const World& world, const Image& image) {
    const auto& bound = image.find("bound")->floats();
    const auto& method = image.find("stat.method")->ids();
    const auto& object = image.find("reflectID.object")->ids();
    const LinearCamera camera = *make_frame(world, {}, ignore).camera.linear;
    Held held;
    for (std::size_t p = 0; p < bound.size(); ++p) {
        CHECK(bound[p] <= kLimit);
        if (method[p] == 2) CHECK(bound[p] == 0);
        if (!(bound[p] > 0)) continue;
        ++held.certified;
        held.largest = std::max(held.largest, double{bound[p]});
        if (held.certified % 3 != 0) continue;
        ++held.asked;
        Seen seen{0, Vec3(0), object[p] == kNone};
        for (int axis = 0; axis < 3; ++axis)
            seen.at[axis] = image.find(std::string("reflectP.") + "XYZ"[axis])->floats()[p];
        const std::size_t width = static_cast<std::size_t>(image.data_width);
        const Vec2 pixel(static_cast<double>(p % width) + 0.5, static_cast<double>(p / width) + 0.5);
        const auto displacement = traced_displacement(world, camera, pixel, seen);
        if (!displacement) continue;
        ++held.traced;
        CAPTURE(pixel.x, pixel.y, *displacement, bound[p]);
        CHECK(std::fabs(*displacement - bound[p]) < kNear);
    }
    return held;
}

}  // namespace

TEST_CASE("a mirror shows things as far off as is proven, and nearly all pixels are proven", "[laws][law]") {
    struct Case {
        const char* scene;
        double least_share;  // of the optic's pixels, proven
    };
    for (const auto& [scene, least_share] :
         {Case{"sphere", 0.96}, {"saddle", 0.83}, {"torus", 0.85}, {"closed", 0.9}}) {
        const auto world = shipped_world(scene, 8, 160, 120);
        const Picture picture = draw(*world, certified(kLimit));
        const Held held = hold_bounds(*world, picture.image);
        CAPTURE(scene, held.certified, picture.statistics.optic_pixels, held.asked, held.traced);
        CHECK(held.certified == picture.statistics.certified_pixels);
        CHECK(static_cast<float>(picture.statistics.certified_error) <= held.largest);
        CHECK(held.certified + picture.statistics.traced_pixels == picture.statistics.optic_pixels);
        CHECK(static_cast<double>(held.certified) >=
              least_share * static_cast<double>(picture.statistics.optic_pixels));
        CHECK(static_cast<double>(held.traced) > 0.97 * static_cast<double>(held.asked));
    }
}

TEST_CASE("a comparison with the truth finds no pixel beyond its bound, and most beyond half of it",
          "[laws][law]") {
    struct Case {
        const char* scene;
        int n;
        const char* layer = "reflect";
        bool has_one_path = true;  // the bound is then that of the layer
    };
    // The ring shows folds, where two images of a place meet and the nearest is no measure; the balls see
    // each other.
    for (const auto& [scene, n, layer, has_one_path] : {Case{"sphere", 4},
                                                        {"saddle", 4},
                                                        {"torus", 4},
                                                        {"closed", 4},
                                                        {"cameras/catacaustic", 24},
                                                        {"paths/mirror-balls", 8},
                                                        {"paths/crystal-ball", 8, "refract", false}}) {
        const auto world = shipped_world(scene, n, 320, 240);
        PictureRequest request = certified(kLimit);
        request.frame.facets = FacetUse::kAll;
        Image test = draw(*world, request).image;
        request.engine = Engine::kLimitTruth;
        request.frame.certify = false;
        request.frame.max_error.reset();
        const Image truth = draw(*world, request).image;
        const auto checked = [&] {
            for (const LayerComparison& one : compare_layers(truth, test))
                if (one.layer == layer) return one.bounds;
            return std::optional<BoundCheck>();
        };
        const std::optional<BoundCheck> held = checked();
        REQUIRE(held);
        CAPTURE(scene, held->pixels, *held->excess, *held->tightness_max);
        CHECK(held->pixels > 2000);
        CHECK(held->beyond == 0);
        if (!has_one_path) continue;
        CHECK(std::fabs(*held->tightness_p50 - 1) < 0.01);

        for (float& bound : test.find("bound")->floats()) bound /= 2;
        const std::optional<BoundCheck> broken = checked();
        REQUIRE(broken);
        CHECK(broken->pixels == held->pixels);
        CHECK(broken->beyond > held->pixels / 10);
    }
}

TEST_CASE("flat mirrors are proven exact, to rounding", "[laws][law]") {
    const auto world = shipped_world("flat", 2, 160, 120);
    const Picture picture = draw(*world, certified(kLimit));
    CHECK(picture.statistics.certified_pixels > 1000);
    CHECK(picture.statistics.certified_error < 1e-4);
}

TEST_CASE("what is not proven is traced: normals of a map, and whatever is off by more", "[laws][law]") {
    const auto bumpy = shipped_world("gallery/rippled", 8, 80, 60);
    const Picture of_bumpy = draw(*bumpy, certified(kLimit));
    CHECK(of_bumpy.statistics.certified_pixels == 0);
    CHECK(of_bumpy.statistics.traced_pixels == of_bumpy.statistics.optic_pixels);

    // A limit that facets of that size do not keep where they are not divided so far.
    const auto mirror = shipped_world("sphere", 8, 160, 120);
    const Picture strict = draw(*mirror, certified(1e-3));
    CHECK(strict.statistics.traced_pixels > 0);
    PictureRequest exact;
    exact.engine = Engine::kLimitTruth;
    const Picture truth = draw(*mirror, exact);
    CHECK(truth.statistics.optic_pixels > 0);
    CHECK(truth.statistics.traced_pixels == truth.statistics.optic_pixels);
    CHECK(strict.statistics.certified_error <= 1e-3);
}

namespace {

/// How far from the middle of a pixel the traced rays over these steps find the place that a layer shows, by
/// Newton's method on the film; none where it shows none or they find none.
std::optional<double> traced_over(const World& world, const Frame& frame, const Image& image,
                                  const std::string& layer, std::span<const Step> steps, std::size_t p) {
    const auto& object = image.find(layer + "ID.object")->ids();
    if (object[p] == kNone) return std::nullopt;
    Vec3 place(0);
    for (int axis = 0; axis < 3; ++axis) place[axis] = image.find(layer + "P." + "XYZ"[axis])->floats()[p];
    const std::size_t width = static_cast<std::size_t>(image.data_width);
    const Vec2 pixel(static_cast<double>(p % width) + 0.5, static_cast<double>(p / width) + 0.5);
    const auto found = refine_history_image(history_query(world, frame, steps, place), pixel);
    if (!found) return std::nullopt;
    return length(found->pixel - pixel);
}

}  // namespace

TEST_CASE("through glass things appear as far off as is proven, and most pixels are proven", "[laws][law]") {
    const std::array through{Step{0, Event::kTransmit}, Step{0, Event::kTransmit}},
        off{Step{0, Event::kReflect}, Step{}};
    struct Case {
        std::unique_ptr<World> world;
        bool has_one_path;  // the bound is then that of the layer, else of all paths, faint ones among them
    };
    for (const auto& [world, has_one_path] : {Case{world_from("ball", kClearBall, 8), true},
                                              {shipped_world("paths/crystal-ball", 8, 160, 120), false}}) {
        PictureRequest request = certified(kLimit);
        request.frame.facets = FacetUse::kAll;
        const Picture picture = draw(*world, request);
        const Frame frame = make_frame(*world, {}, ignore);
        const auto& bound = picture.image.find("bound")->floats();
        std::size_t proven = 0, asked = 0, equal = 0;
        for (std::size_t p = 0; p < bound.size(); ++p) {
            if (!(bound[p] > 0) || ++proven % 3 != 0) continue;
            const auto refracted = traced_over(*world, frame, picture.image, "refract", through, p);
            const auto reflected = has_one_path ? std::nullopt
                                                : traced_over(*world, frame, picture.image, "reflect",
                                                              std::span(off).first(1), p);
            if (!refracted) continue;
            ++asked;
            const double most = std::max(*refracted, reflected.value_or(0));
            CAPTURE(p, *refracted, reflected.value_or(0), bound[p]);
            CHECK(most < bound[p] + kNear);
            equal += std::fabs(most - bound[p]) < kNear;
        }
        CAPTURE(has_one_path, proven, asked, equal, picture.statistics.optic_pixels);
        CHECK(5 * proven > 3 * picture.statistics.optic_pixels);
        CHECK(8 * asked > proven);
        if (has_one_path) CHECK(50 * equal > 49 * asked);
    }
}

TEST_CASE("a scene that asks for a proof has the picture that the option gives, and its truth is drawn",
          "[laws][law]") {
    const auto world = shipped_world("sphere", 8, 80, 60);
    PictureRequest request = certified(kLimit);
    const Picture asked = draw(*world, request);
    CHECK(asked.statistics.certified_pixels > 500);
    world->scene.render.max_error = kLimit;
    world->scene.render.certify = true;
    request.frame.max_error.reset();
    request.frame.certify = false;
    const Picture of_scene = draw(*world, request);
    CHECK(of_scene.statistics.certified_pixels == asked.statistics.certified_pixels);
    CHECK(of_scene.image.find("bound")->floats() == asked.image.find("bound")->floats());
    request.engine = Engine::kLimitTruth;
    CHECK(draw(*world, request).statistics.certified_pixels == 0);
    world->scene.render.max_error = 0;
    request.engine = Engine::kExact;
    CHECK_THROWS_AS(draw(*world, request), UsageError);
}

TEST_CASE("a proof needs an error to prove, and facets", "[laws]") {
    const auto world = shipped_world("sphere", 4, 40, 30);
    CHECK_THROWS_AS(draw(*world, certified(0)), UsageError);
    for (const Engine engine : {Engine::kLimitTruth, Engine::kPlanar, Engine::kEnvironment}) {
        PictureRequest request = certified(kLimit);
        request.engine = engine;
        CHECK_THROWS_AS(draw(*world, request), UsageError);
    }
}
