// Points through whole paths: what the exact truth shows at a pixel is projected back to that pixel.
#include <algorithm>
#include <cmath>
#include <optional>

#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;
using namespace trilens_test;

namespace {

Mesh ball_mesh(const std::string& name, const Vec3& centre, double radius, Id material) {
    Mesh mesh;
    mesh.name = name;
    mesh.role = Role::kOptic;
    mesh.material = material;
    mesh.resolution = 12;
    mesh.primitive = Primitive{.center = centre, .kind = SpherePrimitive{radius}};
    return mesh;
}

/// A mirror ball and a glass ball over a floor, a wall behind them.
Scene two_balls() {
    Scene scene;
    scene.film = {64, 48, 1};
    CameraDescription camera;
    camera.name = "main";
    camera.eye = {0.3, 0.8, 4};
    camera.at = {0, -0.2, 0};
    scene.cameras.push_back(camera);
    Material chrome, glass, red;
    chrome.metallic_factor = 1;
    glass.transmission_factor = 1;
    red.unlit = true;
    scene.materials = {chrome, glass, red};
    Mesh room;
    room.name = "room";
    room.object.points = {{-6, -1, -5}, {6, -1, -5}, {6, -1, 6}, {-6, -1, 6}, {6, 5, -5}, {-6, 5, -5}};
    room.object.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 1, 4}, {0, 4, 5}};
    room.object.material = {2, 2, 2, 2};
    scene.meshes = {ball_mesh("mirror", {-0.85, -0.1, -0.6}, 0.8, 0),
                    ball_mesh("glass", {0.7, -0.3, 0.5}, 0.7, 1), room};
    return scene;
}

const WorldImage* image_at(const PointProjection& found, const std::vector<Step>& steps, const Vec2& pixel,
                           double within) {
    for (const WorldImage& image : found.images)
        if (image.steps == steps && length(image.pixel - pixel) < within) return &image;
    return nullptr;
}

Vec3 world_axis(int k) {
    Vec3 axis(0);
    axis[k] = 1;
    return axis;
}

/// The exact ray of a film place over the optics of an explained end; none where it does not go that way.
std::optional<ShotRay> shot_along(const Renderer& renderer, const PixelEnd& end, const Vec2& place) {
    std::string word;
    for (const Step& step : end.steps)
        if (step.event != Event::kPass) word += step.event == Event::kReflect ? 'R' : 'T';
    ShootRequest along;
    along.path = EventWord(word);
    const ShotRay shot = renderer.shoot(std::span(&place, 1), along).rays[0];
    return shot.followed() ? std::optional(shot) : std::nullopt;
}

}  // namespace

TEST_CASE("a point that the truth shows over whole paths is projected to the pixel that shows it",
          "[laws][law][thorough]") {
    const Renderer renderer(two_balls());
    PictureRequest truth;
    truth.engine = Engine::kLimitTruth;
    ProjectRequest request;
    request.derivatives = true;
    struct Asked {
        std::vector<Step> steps;
        Vec2 pixel{0};
        Vec3 point{0};
    };
    std::vector<Asked> asked;
    for (int y = 3; y < 48; y += 4)
        for (int x = 2; x < 64; x += 4) {
            const PixelExplanation pixel = renderer.explain(truth, x, y);
            for (const PixelEnd& end : pixel.ends) {
                if (!end.principal || !end.hit.seen()) continue;
                const std::vector<Step>& steps = end.steps;
                asked.push_back({steps, {x + 0.5, y + 0.5}, renderer.seen_triangle(end.hit).position});
            }
        }

    // Each point, and for the derivatives two beside it along each axis.
    constexpr double kBeside = 1e-5;
    std::vector<Vec3> points;
    for (const Asked& one : asked) {
        points.push_back(one.point);
        for (int k = 0; k < 3; ++k) {
            points.push_back(one.point + kBeside * world_axis(k));
            points.push_back(one.point - kBeside * world_axis(k));
        }
    }
    const std::vector<PointProjection> found = renderer.project(points, request);
    std::size_t missed = 0, longest = 0, differentiated = 0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
        const Asked& one = asked[i];
        longest = std::max(longest, one.steps.size());
        const WorldImage* image = image_at(found[7 * i], one.steps, one.pixel, 1e-5);
        if (!image) {
            ++missed;
            continue;
        }
        CHECK(image->visible);
        if (!image->has_derivative) continue;
        for (int k = 0; k < 3; ++k) {
            const Vec2 slope(image->derivative[0][k], image->derivative[1][k]);
            const double far = 3 * kBeside * (1 + length(slope));
            const std::size_t at = 7 * i + 1 + 2 * static_cast<std::size_t>(k);
            const WorldImage *after = image_at(found[at], one.steps, one.pixel, far),
                             *before = image_at(found[at + 1], one.steps, one.pixel, far);
            if (!after || !before) continue;
            const Vec2 expected = (after->pixel - before->pixel) / (2 * kBeside);
            CHECK(slope.x == Approx(expected.x).epsilon(2e-3).margin(0.05));
            CHECK(slope.y == Approx(expected.y).epsilon(2e-3).margin(0.05));
            ++differentiated;
        }
    }
    INFO(asked.size() << " asked, " << missed << " missed, longest " << longest);
    CHECK(asked.size() > 60);
    CHECK(longest >= 3);
    CHECK(differentiated > 100);
    CHECK(missed * 100 <= asked.size());
}

TEST_CASE("what another optic cuts off is no image, and depth 0 knows no other optic", "[laws][law]") {
    Scene scene = two_balls();
    const Vec3 behind(2.2, -0.9, -3.0);  // seen through the glass ball alone, its rays bent twice
    ProjectRequest request;
    const auto histories = [&](const Scene& of) {
        std::vector<std::size_t> lengths;
        const std::vector<PointProjection> found = Renderer(of).project(std::vector<Vec3>{behind}, request);
        for (const WorldImage& image : found[0].images)
            if (image.path == Path::kRefract) lengths.push_back(image.steps.size());
        return lengths;
    };
    const std::vector<std::size_t> whole = histories(scene);
    REQUIRE_FALSE(whole.empty());
    CHECK(std::all_of(whole.begin(), whole.end(), [](std::size_t steps) { return steps >= 2; }));
    scene.render.max_depth = 0;
    const std::vector<std::size_t> first = histories(scene);
    CHECK(std::all_of(first.begin(), first.end(), [](std::size_t steps) { return steps == 1; }));
}

TEST_CASE("the magnification that facets have in closed form is that of the exact images",
          "[laws][oracle][law]") {
    const Renderer renderer(two_balls());
    PictureRequest picture;
    picture.frame.resolution = 48;
    const PixelExplanation none = renderer.explain(picture, 0, 0);
    CHECK(none.ends.empty());
    ProjectRequest request;
    request.derivatives = true;
    struct Seen {
        std::vector<Step> steps;
        Vec2 pixel{0};
        Vec3 towards{0};  // unit
        double magnification = 0;
    };
    std::vector<Seen> seen;
    std::vector<Vec3> points;
    for (int y = 9; y < 48; y += 6)
        for (int x = 8; x < 64; x += 5) {
            const PixelExplanation pixel = renderer.explain(picture, x, y);
            for (const PixelEnd& end : pixel.ends) {
                if (!end.principal || !end.hit.seen() || end.magnification == 0) continue;
                const std::vector<Step>& steps = end.steps;
                seen.push_back({steps, {x + 0.5, y + 0.5}, normalize(end.ray.direction), end.magnification});
                points.push_back(renderer.seen_triangle(end.hit).position);
            }
        }
    const std::vector<PointProjection> found = renderer.project(points, request);
    std::size_t mirrored = 0;
    std::vector<double> error;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const WorldImage* image = image_at(found[i], seen[i].steps, seen[i].pixel, 0.5);
        if (!image || !image->has_derivative) continue;
        // The film's area for a unit square at right angles to the ray.
        const double exact = dot(seen[i].towards, cross(image->derivative[0], image->derivative[1]));
        error.push_back(std::fabs(seen[i].magnification / exact - 1));
        mirrored += exact < 0;
    }
    const std::size_t compared = error.size();
    std::sort(error.begin(), error.end());
    REQUIRE(compared > 20);
    CHECK(mirrored > 5);
    CHECK(error[compared / 2] < 0.02);
    CHECK(error[compared * 9 / 10] < 0.1);
}

TEST_CASE("an explained pixel's paths weigh what shot rays of their words do", "[laws][law]") {
    const Renderer renderer(
        load_scene(SceneRequest{source_dir() + "/scenes/paths/glass-before-mirror.json", {}, 0}));
    const Film& film = renderer.scene().film;
    PictureRequest truth;
    truth.engine = Engine::kLimitTruth;
    std::size_t compared = 0, tinted = 0;
    for (int y = 20; y < film.height; y += 40)
        for (int x = 20; x < film.width; x += 40)
            for (const PixelEnd& end : renderer.explain(truth, x, y).ends) {
                if (!end.principal) continue;
                const std::optional<ShotRay> shot = shot_along(renderer, end, Vec2(x + 0.5, y + 0.5));
                if (!shot) continue;
                for (int c = 0; c < 3; ++c) CHECK(std::fabs(end.weight[c] - shot->weight[c]) <= 1e-9);
                ++compared;
                tinted += end.weight.x < 0.9;
            }
    CHECK(compared > 40);
    CHECK(tinted > 20);
}

TEST_CASE("an explained pixel says which paths maxDepth ends, and that the truth traces them",
          "[laws][law]") {
    for (const char* depth : {"0", "1", "2"}) {
        CAPTURE(depth);
        SceneRequest request{source_dir() + "/scenes/paths/glass-before-mirror.json", {}, 8};
        request.overrides = {{"/render/maxDepth", depth}};
        const Renderer renderer(load_scene(request));
        const Film& film = renderer.scene().film;
        std::size_t cut = 0, whole = 0, by_facets = 0, agree = 0;
        for (const Engine engine : {Engine::kLimitTruth, Engine::kExact})
            for (int y = 20; y < film.height; y += 40)
                for (int x = 20; x < film.width; x += 40) {
                    PictureRequest picture;
                    picture.engine = engine;
                    const PixelExplanation pixel = renderer.explain(picture, x, y);
                    if (engine == Engine::kLimitTruth && pixel.optic != kNone) CHECK(pixel.traced);
                    for (const PixelEnd& end : pixel.ends) {
                        if (!end.principal) continue;
                        const std::optional<ShotRay> shot = shot_along(renderer, end, Vec2(x + 0.5, y + 0.5));
                        if (!shot) continue;
                        if (engine == Engine::kExact) {
                            ++by_facets, agree += end.cut == shot->cut;
                            continue;
                        }
                        CHECK(end.cut == shot->cut);
                        ++(shot->cut ? cut : whole);
                    }
                }
        CHECK(cut > 3);
        CHECK(whole > 5);
        CHECK(agree == by_facets);
    }
}

TEST_CASE("rays of one's own are followed whatever the length of their directions", "[laws][law]") {
    const Renderer renderer(two_balls());
    const Vec3 origin(0.3, 0.8, 4);
    for (const Vec3& direction : {Vec3(0.1, -0.27, -1), Vec3(-0.3, -0.2, -1), Vec3(0.3, -0.6, -0.2)}) {
        const auto shoot = [&](double factor) {
            const Ray ray{origin, factor * direction};
            return renderer.shoot(std::span(&ray, 1)).rays[0];
        };
        const ShotRay usual = shoot(1);
        REQUIRE(usual.followed());
        CHECK((usual.event_count > 0) == (direction.x != 0.3));
        for (const double factor : {0x1p-1000, 0x1p-520, 0x1p-500, 0x1p500, 0x1p520, 0x1p1020}) {
            const ShotRay scaled = shoot(factor);
            INFO(factor);
            CHECK(scaled.state == usual.state);
            CHECK(scaled.event_count == usual.event_count);
            CHECK(scaled.position == usual.position);
            CHECK(scaled.direction == usual.direction);
            CHECK(scaled.t == usual.t);
        }
        CHECK(length(shoot(1e-155).direction - usual.direction) < 1e-9);
    }
}
