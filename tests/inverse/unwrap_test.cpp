// Unwrapping: against the sky that a traced photograph shows, against facets, against differences.
#include <cmath>

#include "ball_worlds.h"
#include "base/util/error.h"
#include "inverse/maps/film_images.h"
#include "inverse/maps/proxy.h"
#include "inverse/unwrap/photo.h"
#include "inverse/unwrap/unwrap.h"
#include "render/project/project.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

UnwrapRequest to_equirect(int width) {
    UnwrapRequest request;
    request.target = {TargetKind::kEquirect, width, width / 2};
    return request;
}

Vec3 direction_of(int x, int y, int width) {
    const double longitude = ((x + 0.5) / width - 0.5) * 2 * 3.14159265358979323846;
    const double latitude = (0.5 - (y + 0.5) / (width / 2.0)) * 3.14159265358979323846;
    return {std::sin(longitude) * std::cos(latitude), std::sin(latitude),
            -std::cos(longitude) * std::cos(latitude)};
}

/// What the unwrapped pixels that few others blur are off from the sky.
struct SkyDifference {
    double squares = 0, worst = 0;
    int count = 0;

    double rms() const { return std::sqrt(squares / (3 * count)); }
};

SkyDifference off_the_sky(const Unwrapped& made) {
    const int width = made.image.width;
    const auto value = [&](const char* name, int x, int y) {
        return made.image.find(name)->floats()[static_cast<std::size_t>(y * width + x)];
    };
    SkyDifference off;
    for (int y = 0; y < made.image.height; ++y)
        for (int x = 0; x < width; ++x) {
            if (value("A", x, y) == 0 || value("res.min", x, y) < 0.4f) continue;
            const Vec3 by = Vec3(value("R", x, y), value("G", x, y), value("B", x, y)) -
                            sky_colour(direction_of(x, y, width));
            off.squares += dot(by, by);
            off.worst = std::max(off.worst, length(by));
            ++off.count;
        }
    return off;
}

}  // namespace

TEST_CASE("a traced photograph through a glass ball unwraps to the sky behind it", "[inverse][law]") {
    const auto world = glass_under_sky(256, 256, 4, 512);
    for (const std::optional<Path> path : {std::optional<Path>(), std::optional(Path::kRefract)}) {
        UnwrapRequest request = to_equirect(256);
        request.path = path;
        const Unwrapped made = unwrap(*world, request, {{"photo", photograph(*world), 0}});
        const SkyDifference off = off_the_sky(made);
        INFO(off.count << " pixels, " << off.rms() << " off in the mean");
        CHECK(off.count > 4500);
        CHECK(off.rms() < 2e-3);
    }
}

TEST_CASE("a traced photograph of a mirror ball unwraps to the sky that it shows", "[inverse][law][oracle]") {
    const auto world = ball_under_sky(256, 256, 4, 512);
    const Unwrapped made = unwrap(*world, to_equirect(256), {{"photo", photograph(*world), 0}});
    // What the ball does not show: the cone behind it, as closed form has it. The rim's ray grazes: it goes
    // straight on, so all directions are seen but those within asin(1 / 4) of the eye's axis.
    const double blind = 0.5 * (1 - std::cos(std::asin(0.25)));
    CHECK(made.coverage == Approx(1 - blind).margin(2e-3));
    CHECK(made.worst_accepted <= 0.01);
    CHECK(made.exact_places < 256 * 128);

    const SkyDifference off = off_the_sky(made);
    REQUIRE(off.count > 20000);
    CHECK(off.rms() < 2e-3);
    CHECK(off.worst < 0.05);
}

TEST_CASE("a mirror seen from its back unwraps as one seen from its front", "[inverse][law]") {
    const auto unwrapped = [](const char* normal) {
        const auto world =
            make_world(parse_scene(std::string(R"({"version": 1, "film": {"width": 64, "height": 48},
            "cameras": [{"yfov": 50, "lookAt": {"eye": [0, 0.3, 3], "at": [0, 0, 0]}}],
            "materials": [{"name": "mirror", "metallicFactor": 1}, {"name": "white", "unlit": true}],
            "meshes": [{"role": "optic", "material": "mirror", "resolution": 4,
                        "primitive": {"type": "plane", "size": [2, 2], "normal": )") +
                                   normal + R"(}},
                       {"name": "wall", "role": "object", "material": "white",
                        "primitive": {"type": "plane", "center": [0, 0, 5], "normal": [0, 0, -1], "size": [4, 4]}}]})"),
                       ignore);
        UnwrapRequest request;
        request.target = {TargetKind::kObject, 30, 30};
        request.target.object = 1;
        return unwrap(*world, request, {{"photo", photograph(*world), 0}});
    };
    const Unwrapped front = unwrapped("[0, 0, 1]"), back = unwrapped("[0, 0, -1]");
    CHECK(front.coverage > 0.5);
    CHECK(back.coverage == Approx(front.coverage).epsilon(1e-9));
}

TEST_CASE("two photographs fill each other's blind cone; a mask leaves one out", "[inverse]") {
    const auto world = ball_under_sky(128, 128, 4, 256);
    const UnwrapPhoto front{"front", photograph(*world, 0), 0}, side{"side", photograph(*world, 1), 1};
    const Unwrapped both = unwrap(*world, to_equirect(128), {front, side});
    CHECK(both.coverage == Approx(1).margin(1e-9));
    CHECK(both.image.find("image.photo"));
    UnwrapRequest blended = to_equirect(128);
    blended.images = UnwrapImages::kBlend;
    const Unwrapped mean = unwrap(*world, blended, {front, side});
    double squares = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) {
            const auto at = static_cast<std::size_t>(y * 128 + x);
            const Vec3 sky = sky_colour(direction_of(x, y, 128));
            for (const Unwrapped* made : {&both, &mean})
                squares += std::pow(made->image.find("G")->floats()[at] - sky.y, 2);
        }
    CHECK(std::sqrt(squares / (2 * 128 * 64)) < 0.01);

    UnwrapPhoto masked = side;
    auto dark = std::make_shared<Texture>(*side.picture);
    std::fill(dark->rgb.begin(), dark->rgb.end(), 0.0f);
    masked.mask = dark;
    const Unwrapped one = unwrap(*world, to_equirect(128), {front, masked});
    CHECK(one.coverage < 0.99);
}

TEST_CASE("two exposures make one panorama of high dynamic range", "[inverse]") {
    const auto world = ball_under_sky(128, 128, 4, 256);
    const auto exposed = [&](double exposure) {
        auto photo = std::make_shared<Texture>(*photograph(*world));
        for (float& value : photo->rgb) value = std::min(1.0f, static_cast<float>(exposure) * value);
        UnwrapPhoto shot{"photo", photo, 0};
        shot.exposure = exposure;
        shot.white = 0.99;
        return shot;
    };
    UnwrapRequest request = to_equirect(128);
    for (const UnwrapImages images : {UnwrapImages::kBest, UnwrapImages::kBlend}) {
        request.images = images;
        const Unwrapped made = unwrap(*world, request, {exposed(2), exposed(0.5)});
        double worst = 0;
        int count = 0, longer = 0;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 128; ++x) {
                const auto at = static_cast<std::size_t>(y * 128 + x);
                if (made.image.find("res.min")->floats()[at] < 0.25f) continue;
                worst = std::max(worst, std::fabs(made.image.find("R")->floats()[at] -
                                                  sky_colour(direction_of(x, y, 128)).x));
                longer += made.image.find("image.photo")->ids()[at] == 0;
                ++count;
            }
        REQUIRE(count > 5000);
        CHECK(worst < 0.05);
        CHECK(longer > count / 10);
        CHECK(longer < count * 9 / 10);
    }
}

TEST_CASE("lamps smaller than a panorama's pixel keep their light over two exposures, and masks hide them",
          "[inverse][law]") {
    const auto world = ball_under_sky(128, 128, 4, 256);
    auto bright = std::make_shared<Texture>(*photograph(*world)), mask = std::make_shared<Texture>(*bright);
    std::fill(mask->rgb.begin(), mask->rgb.end(), 1.0f);
    for (const int x : {40, 52, 61, 75, 88})
        for (int c = 0; c < 3; ++c) {
            const auto at = static_cast<std::size_t>(3 * ((40 + x / 3) * 128 + x) + c);
            bright->rgb[at] = 500, mask->rgb[at] = 0;
        }
    const auto exposed = [&](double exposure) {
        auto photo = std::make_shared<Texture>(*bright);
        for (float& value : photo->rgb) value = std::min(1.0f, static_cast<float>(exposure) * value);
        UnwrapPhoto shot{"photo", photo, 0};
        shot.exposure = exposure, shot.white = 0.98;
        return shot;
    };
    UnwrapPhoto masked{"photo", bright, 0};
    masked.mask = mask;
    const UnwrapRequest small = to_equirect(32);
    const Unwrapped truth = unwrap(*world, small, {UnwrapPhoto{"photo", bright, 0}}),
                    merged = unwrap(*world, small, {exposed(1), exposed(1e-3)}),
                    hidden = unwrap(*world, small, {masked});
    const auto& light = truth.image.find("G")->floats();
    double lamps = 0, worst = 0, left = 0;
    for (std::size_t i = 0; i < light.size(); ++i) {
        lamps += light[i] > 2;
        worst = std::max(worst, std::fabs(double{merged.image.find("G")->floats()[i]} - light[i]) /
                                    std::max(1.0, double{light[i]}));
        left = std::max(left, double{hidden.image.find("G")->floats()[i]});
    }
    CHECK(lamps >= 3);
    CHECK(worst < 1e-4);
    CHECK(left < 1.1);
}

TEST_CASE("forward by facets and backward by exact search meet with the square of the facets",
          "[inverse][law]") {
    // Places of the same directions through n x n facets, unrefined, against the exact ones.
    const auto world = ball_under_sky(256, 256, 3, 64);
    Draw draw(3);
    std::vector<Vec3> points;
    for (int i = 0; i < 300; ++i) {
        const Vec3 d = draw.unit();
        if (d.z > -0.5) points.push_back(1e6 * d);
    }
    const auto exact = project_points(*world, {}, points);
    std::vector<double> mean;
    for (const int n : {8, 16, 32}) {
        ProjectRequest by_facets;
        by_facets.frame.resolution = n;
        by_facets.search = ImageSearch::kFacets;
        by_facets.refine = false;
        const auto found = project_points(*world, by_facets, points);
        double sum = 0;
        int count = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            for (const WorldImage& image : exact[i].images)
                for (const WorldImage& other : found[i].images)
                    if (image.path == Path::kReflect && other.path == Path::kReflect)
                        sum += length(image.pixel - other.pixel), ++count;
        REQUIRE(count > 150);
        mean.push_back(sum / count);
    }
    CHECK(std::log2(mean[0] / mean[1]) > 1.7);
    CHECK(std::log2(mean[1] / mean[2]) > 1.7);
}

TEST_CASE("the resolution of an unwrapped picture is how its source places move", "[inverse][oracle]") {
    const auto world = ball_under_sky(256, 256, 4, 64);
    const Unwrapped made = unwrap(*world, to_equirect(720), {{"photo", photograph(*world), 0}});
    const auto at = [&](const char* name, int x, int y) {
        return double(made.image.find(name)->floats()[static_cast<std::size_t>(y * 720 + x)]);
    };
    int checked = 0;
    for (int y = 100; y < 260; y += 7)
        for (int x = 60; x < 660; x += 11) {
            if (at("A", x - 1, y) * at("A", x + 1, y) * at("A", x, y - 1) * at("A", x, y + 1) == 0) continue;
            if (at("res.min", x, y) < 0.7) continue;  // differences tell little at the rim
            // Half a degree per pixel; east-west shrinks with the cosine of the latitude.
            const double cl = std::cos((0.5 - (y + 0.5) / 360) * 3.14159265358979323846);
            const Vec2 east = Vec2(at("src.X", x + 1, y) - at("src.X", x - 1, y),
                                   at("src.Y", x + 1, y) - at("src.Y", x - 1, y)) /
                              cl;
            const Vec2 north(at("src.X", x, y + 1) - at("src.X", x, y - 1),
                             at("src.Y", x, y + 1) - at("src.Y", x, y - 1));
            const double det = std::fabs(east.x * north.y - east.y * north.x);
            CHECK(at("res.min", x, y) * at("res.max", x, y) == Approx(det).epsilon(0.02));
            const double squares = std::pow(at("res.min", x, y), 2) + std::pow(at("res.max", x, y), 2);
            CHECK(squares == Approx(dot(east, east) + dot(north, north)).epsilon(0.02));
            ++checked;
        }
    CHECK(checked > 200);
}

TEST_CASE("proxies lie where they say, and their places move as differences do", "[inverse][oracle]") {
    const auto world = ball_under_sky(64, 64, 4, 64);
    Scene scene;
    const Target target({TargetKind::kEquirect, 360, 180}, scene);
    Draw draw(8);
    const Vec3 center(0.1, 0.2, -0.3);
    for (const char* text : {"infinity", "sphere:5", "box:-3,-2,-4,5,6,7"}) {
        const Proxy proxy(parse_proxy(text), *world, center);
        for (int i = 0; i < 100; ++i) {
            const Vec2 pixel(draw.uniform(1, 359), draw.uniform(5, 175));
            const WorldPlace place = proxy.along(*target.place(pixel));
            CHECK(length(normalize(place.point - center) - target.place(pixel)->at) < 1e-9);
            const double step = 1e-5;
            const Vec3 moved = (proxy.along(*target.place(pixel + Vec2(step, 0))).point -
                                proxy.along(*target.place(pixel - Vec2(step, 0))).point) /
                               (2 * step);
            CHECK(length(moved - place.dx) < 1e-4 * (length(place.dx) + length(place.point) * 1e-3));
            const Vec3 back = proxy.direction_met({center, target.place(pixel)->at});
            CHECK(length(normalize(back) - target.place(pixel)->at) < 1e-9);
        }
    }
    for (const char* text : {"sphere", "sphere:x", "box:1,2,3", "cylinder:3", "", "sphere:nan"})
        CHECK_THROWS_AS(parse_proxy(text), UsageError);
    CHECK_THROWS_AS(Proxy(parse_proxy("sphere:-1"), *world, center), UsageError);
    CHECK_THROWS_AS(Proxy(parse_proxy("box:1,1,1,2,2,2"), *world, center), UsageError);
    CHECK_THROWS_AS(Proxy(parse_proxy("nowhere.obj"), *world, center), InputError);
}

TEST_CASE("what cannot be unwrapped is told in one message", "[inverse][bad-input]") {
    const auto world = ball_under_sky(64, 64, 4, 64);
    auto small = std::make_shared<Texture>(Texture{2, 2, std::vector<float>(12, 1.0f), {}});
    CHECK_THROWS_WITH(unwrap(*world, to_equirect(64), {{"p.exr", small, 0}}),
                      ContainsSubstring("2 x 2") && ContainsSubstring("64 x 64"));
    CHECK_THROWS_AS(unwrap(*world, to_equirect(64), {}), UsageError);
    CHECK_THROWS_AS(unwrap(*world, to_equirect(64), {{"p", photograph(*world), 7}}), UsageError);
    UnwrapRequest request = to_equirect(64);
    request.optic = 3;
    CHECK_THROWS_AS(unwrap(*world, request, {{"p", photograph(*world), 0}}), UsageError);
    request = to_equirect(64);
    request.path = Path::kRefract;
    CHECK_THROWS_WITH(unwrap(*world, request, {{"p", photograph(*world), 0}}),
                      ContainsSubstring("nothing of the target"));

    // Inside a ball the mirror hides all that is not in it.
    std::string json = ball_json(64, 64, 0.5);
    json.replace(json.find("\"maxDepth\": 0"), 13, "\"maxDepth\": 2");
    const auto inside = world_of(json);
    CHECK_THROWS_WITH(unwrap(*inside, to_equirect(64), {{"p", photograph(*inside), 0}}),
                      ContainsSubstring("nothing of the target"));
    for (const char* text : {"equirect:10", "equirect:axb", "cubemap:-3", "fisheye:10:x", "plane:1,2,3,4x4",
                             "nobody", "ball:3x3"})
        CHECK_THROWS_AS(Target(parse_target(text, world->scene), world->scene), Error);
}

TEST_CASE("a flat object's rectangle is that of its faces that have an area", "[inverse]") {
    ObjectMesh sheet;
    sheet.points = {{1, 2, 0}, {5, 2, 0}, {5, 2, -3}, {1, 2, -3}, {0, 0, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    const std::optional<FlatRectangle> plain = flat_rectangle(sheet);
    REQUIRE(plain);
    CHECK(length(plain->u - Vec3(4, 0, 0)) + length(plain->v - Vec3(0, 0, -3)) < 1e-12);
    for (const IdTriple& empty : {IdTriple{3, 3, 3}, IdTriple{2, 2, 1}, IdTriple{0, 0, 3}}) {
        ObjectMesh with = sheet;
        with.triangles.insert(with.triangles.begin(), empty);
        const std::optional<FlatRectangle> same = flat_rectangle(with);
        REQUIRE(same);
        CHECK(same->origin == plain->origin);
        CHECK(same->u == plain->u);
        CHECK(same->v == plain->v);
    }
}

TEST_CASE("the bicubic filter keeps lines straight, and a footprint is the mean of what it covers",
          "[inverse]") {
    Texture ramp{40, 30, {}, {}};
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x)
            for (const double v : {x + 0.5, y + 0.5, 0.1 * (x + 0.5) * (y + 0.5)})
                ramp.rgb.push_back(static_cast<float>(v));
    Draw draw(4);
    for (int i = 0; i < 200; ++i) {
        const Vec2 at(draw.uniform(8, 32), draw.uniform(8, 22));
        const Vec3 expected(at.x, at.y, 0.1 * at.x * at.y);
        CHECK(length(sample_bicubic(ramp, at) - expected) < 1e-4);
        const Mat2 j(Vec2(draw.uniform(-5, 5), draw.uniform(-5, 5)),
                     Vec2(draw.uniform(-5, 5), draw.uniform(-5, 5)));
        const Vec3 mean = sample_footprint(ramp, at, j);
        CHECK(std::fabs(mean.x - at.x) < 1e-4);
        CHECK(std::fabs(mean.y - at.y) < 1e-4);
    }
}
