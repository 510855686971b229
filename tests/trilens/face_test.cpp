// The public face: what other programs may hand in is checked, told of, and ends nothing.
#include "trilens/trilens.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <string>

#include "support/test.h"

using namespace trilens;

namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

/// A mirror sphere over a triangle.
Scene small_scene() {
    Scene scene;
    scene.film = {64, 48, 1};
    CameraDescription camera;
    camera.name = "main";
    camera.eye = {0, 0.5, 5};
    scene.cameras.push_back(camera);
    Material chrome, red;
    chrome.metallic_factor = 1;
    red.unlit = true;
    scene.materials = {chrome, red};
    Mesh ball;
    ball.name = "ball";
    ball.role = Role::kOptic;
    ball.material = 0;
    ball.primitive = Primitive{};
    Mesh floor;
    floor.name = "floor";
    floor.object.points = {{-4, -1, -4}, {4, -1, -4}, {0, -1, 4}};
    floor.object.triangles = {{0, 1, 2}};
    floor.object.material = {1};
    scene.meshes = {ball, floor};
    return scene;
}

Renderer renderer_of(const std::function<void(Scene&)>& change) {
    Scene scene = small_scene();
    change(scene);
    return Renderer(std::move(scene));
}

std::string shipped(const std::string& name) {
    return trilens_test::source_dir() + "/scenes/" + name + ".json";
}

}  // namespace

TEST_CASE("the making of many optics' surfaces is told, and stops when it is cancelled", "[trilens]") {
    std::string meshes;
    for (int i = 0; i < 9; ++i)
        meshes += (i > 0 ? "," : "") + std::string(R"({"role": "optic", "material": "chrome", "resolution": 2,
            "primitive": {"type": "sphere", "center": [)") +
                  std::to_string(i - 4) + R"(, 0, 0], "radius": 0.4}})";
    const Renderer renderer(parse_scene(
        R"({"version": 1, "film": {"width": 16, "height": 4},
            "cameras": [{"yfov": 40, "lookAt": {"eye": [0, 0, 9], "at": [0, 0, 0]}}],
            "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}], "meshes": [)" +
        meshes + "]}"));
    std::atomic<bool> cancel = false;
    std::string stage;
    std::map<std::string, std::size_t> told;
    Progress progress;
    progress.report = [&](double) { cancel = ++told[stage] == 5 && !stage.empty(); };
    progress.stage = [&](const std::string& what, double) { stage = what; };
    progress.cancel = &cancel;
    CHECK_THROWS_AS(renderer.draw({}, progress), Interrupted);
    CHECK(told["surfaces of 9 optics"] == 5);
    CHECK(told[""] == 0);
    cancel = false;
    renderer.draw({}, progress);
    CHECK(told["surfaces of 9 optics"] > 9);
    CHECK(told[""] > 0);
}

TEST_CASE("a picture that is written while it is drawn has the bytes of one that was held", "[trilens]") {
    namespace fs = std::filesystem;
    const std::string folder = trilens_test::scratch_dir("written_while_drawn"), file = folder + "/a.exr";
    const auto bytes_of = [](const std::string& name) {
        std::ifstream in(name, std::ios::binary);
        return std::vector<unsigned char>(std::istreambuf_iterator<char>(in), {});
    };
    const Renderer renderer(small_scene());
    const EncodedPicture held = renderer.draw_exr({});
    const Picture picture = renderer.write_exr(file, {});
    CHECK(bytes_of(file) == held.bytes);
    CHECK(picture.image.channels.empty());
    CHECK(picture.image.metadata == held.picture.image.metadata);
    CHECK(picture.statistics.optic_pixels == held.picture.statistics.optic_pixels);

    // What does not end well leaves the old file, and nothing beside it.
    const Renderer large = renderer_of([](Scene& scene) { scene.film = {800, 1200, 1}; });
    std::atomic<bool> cancel = false;
    std::size_t names_while_drawn = 0;
    const Progress stop{[&](double) {
                            cancel = true;
                            names_while_drawn =
                                static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
                        },
                        &cancel};
    CHECK_THROWS_AS(large.write_exr(file, {}, stop), Interrupted);
    CHECK(names_while_drawn == 2);
    PictureRequest wrong;
    wrong.layers.layers = {"nothing"};
    CHECK_THROWS_AS(renderer.write_exr(file, wrong), UsageError);
    CHECK_THROWS_AS(renderer.write_exr(folder + "/none/a.exr", {}), OutputError);
    CHECK(bytes_of(file) == held.bytes);
    CHECK(std::distance(fs::directory_iterator(folder), {}) == 1);
}

TEST_CASE("a PNG that is encoded while it is drawn has the bytes of one that was held", "[trilens]") {
    for (const int threads : {1, 3}) {
        set_thread_count(threads);
        const Renderer renderer = renderer_of([](Scene& scene) { scene.film = {210, 333, 1}; });
        PictureRequest request;
        request.layers = {5, 7, 201, 331, {"Z"}};
        for (const ToneMapping& tone : {ToneMapping{}, ToneMapping{0.7, ToneCurve::kAces}}) {
            const EncodedPicture encoded = renderer.draw_png(request, tone);
            CHECK(encoded.bytes == encode_image_as(renderer.draw(request).image, ImageFormat::kPng, tone));
            CHECK(encoded.picture.image.channels.empty());
        }
    }
    set_thread_count(0);
    CHECK_THROWS_AS(renderer_of([](Scene&) {}).draw_png({}, {1e6, ToneCurve::kLinear}), UsageError);
}

TEST_CASE("a scene built in memory is drawn, and one that is none is refused with its place",
          "[trilens][bad-input]") {
    const Picture picture = Renderer(small_scene()).draw({});
    CHECK(picture.statistics.optic_pixels > 100);
    CHECK(picture.image.width == 64);

    const std::vector<std::pair<std::string, std::function<void(Scene&)>>> broken{
        {"/film", [](Scene& s) { s.film.width = 0; }},
        {"/film", [](Scene& s) { s.film.width = s.film.height = 1 << 20; }},
        {"/film/spp", [](Scene& s) { s.film.spp = 0; }},
        {"/cameras", [](Scene& s) { s.cameras.clear(); }},
        {"/cameras/0", [](Scene& s) { s.cameras[0].eye.x = kNotANumber; }},
        {"/materials/1/ior", [](Scene& s) { s.materials[1].ior = 0; }},
        {"/materials/0/baseColorTexture",
         [](Scene& s) {
             auto texture = std::make_shared<Texture>();
             texture->width = texture->height = 2;
             s.materials[0].base_color_texture = texture;
         }},
        {"/meshes/0/material", [](Scene& s) { s.meshes[0].material = 9; }},
        {"/meshes/0/resolution", [](Scene& s) { s.meshes[0].resolution = 0; }},
        {"/meshes/0", [](Scene& s) { s.meshes[0].primitive.reset(); }},
        {"/meshes/1/triangles/0", [](Scene& s) { s.meshes[1].object.triangles[0][1] = 3; }},
        {"/meshes/1/points/2", [](Scene& s) { s.meshes[1].object.points[2].y = kNotANumber; }},
        {"/meshes/1/material", [](Scene& s) { s.meshes[1].object.material.clear(); }},
        {"/meshes/1/uvs", [](Scene& s) { s.meshes[1].object.uvs.resize(5); }}};
    for (const auto& [place, change] : broken) {
        INFO(place);
        try {
            renderer_of(change);
            FAIL("not refused");
        } catch (const InputError& error) {
            CHECK(std::string(error.what()).find(place + ":") != std::string::npos);
        }
    }
}

TEST_CASE("requests that a scene cannot answer are refused", "[trilens][bad-input]") {
    const Renderer renderer(small_scene());
    PictureRequest request;
    request.frame.camera = 3;
    CHECK_THROWS_AS(renderer.draw(request), UsageError);
    request.frame = {0, 4096};
    CHECK_THROWS_AS(renderer.draw(request), UsageError);
    request.frame = {};
    request.layers = {0, 0, 65, 48, {}};
    CHECK_THROWS_AS(renderer.draw(request), UsageError);
    request.layers = {0, 0, 0, 0, {"reflekt"}};
    CHECK_THROWS_AS(renderer.draw(request), UsageError);
    request.layers = {};
    request.engine = ClassicParams{Curves::kSlices, Clip::kScene, 0};
    CHECK_THROWS_AS(renderer.draw(request), UsageError);
    CHECK_THROWS_AS(renderer.explain({}, 64, 0), UsageError);
    CHECK_THROWS_AS(renderer.project(std::vector<Vec3>{{0, kNotANumber, 0}}), InputError);
    CHECK_THROWS_AS(renderer.seen_triangle({}), UsageError);
    Scene scene = small_scene();
    CHECK_THROWS_AS(set_resolution(scene, 1025), InputError);
    CHECK_THROWS_AS(find_camera(scene, "mian"), UsageError);
}

TEST_CASE("images, grids and meshes that do not fit together are refused", "[trilens][bad-input]") {
    Image image = Renderer(small_scene()).draw({}).image;
    CHECK_NOTHROW(encode_image(image));
    const auto refused = [&](const std::function<void(Image&)>& change) {
        Image broken = image;
        change(broken);
        CHECK_THROWS_AS(encode_image(broken), InputError);
    };
    refused([](Image& i) { i.channels.clear(); });
    refused([](Image& i) { i.channels[0].floats().pop_back(); });
    refused([](Image& i) { i.channels[1].name = i.channels[0].name; });
    refused([](Image& i) { i.data_width = 0; });
    refused([](Image& i) { i.metadata["other"] = "x"; });
    CHECK_THROWS_AS(write_image("picture.gif", image), UsageError);

    const auto surface = make_surface(Primitive{});
    CHECK_THROWS_AS(make_surface_grid(*surface, 0), InputError);
    CHECK_THROWS_AS(make_surface_grid(*surface, 1025), InputError);
    SurfaceGrid grid = make_surface_grid(*surface, 2);
    const LinearCamera camera = make_perspective({});
    CHECK_THROWS_AS(make_lens_mesh(grid, camera, 0), InputError);
    RayMesh mesh = make_mirror_mesh(grid, camera);
    TriangleScene scene{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {0}, {0}};
    CHECK_NOTHROW(draw_through(mesh, scene, {0, 0, 8, 8, 1}));
    CHECK_THROWS_AS(draw_through(mesh, scene, {0, 0, 0, 8, 1}), InputError);
    mesh.facets[0][0] = 100'000;
    CHECK_THROWS_AS(draw_through(mesh, scene, {0, 0, 8, 8, 1}), InputError);
    grid.corner_normal.pop_back();
    CHECK_THROWS_AS(make_mirror_mesh(grid, camera), InputError);
}

TEST_CASE("one renderer draws what fresh ones draw, whatever it drew before", "[trilens]") {
    const SceneRequest file{shipped("saddle"), {{"/film/width", "80"}, {"/film/height", "60"}}, 0};
    const Renderer kept(load_scene(file));
    for (const int n : {3, 5, 3}) {
        for (const Engine engine : {Engine::kExact, Engine::kFacetsTruth, Engine::kLimitTruth}) {
            PictureRequest request;
            request.frame.resolution = n;
            request.engine = engine;
            const Image again = kept.draw(request).image,
                        fresh = Renderer(load_scene(file)).draw(request).image;
            REQUIRE(again.channels.size() == fresh.channels.size());
            for (std::size_t c = 0; c < fresh.channels.size(); ++c)
                CHECK(again.channels[c].values == fresh.channels[c].values);
        }
    }
}

TEST_CASE("the complete search lists whatever fine facets lead to, and more than coarse ones", "[trilens]") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Vec3> points;
    for (int i = 0; i < 150; ++i)
        points.push_back({2 * uniform(random), 1.2 * uniform(random), 2 * uniform(random)});
    for (const char* name : {"saddle", "torus"}) {
        const Renderer renderer(load_scene(SceneRequest{shipped(name), {}, 0}));
        const auto complete = renderer.project(points);
        ProjectRequest by_facets;
        by_facets.search = ImageSearch::kFacets;
        by_facets.frame.resolution = 64;
        const auto fine = renderer.project(points, by_facets);
        by_facets.frame.resolution = 4;
        const auto coarse = renderer.project(points, by_facets);
        std::size_t proven = 0, total = 0, total_coarse = 0;
        for (std::size_t p = 0; p < points.size(); ++p) {
            INFO(name << ", point " << p);
            proven += complete[p].complete;
            total += complete[p].images.size();
            total_coarse += static_cast<std::size_t>(
                std::count_if(coarse[p].images.begin(), coarse[p].images.end(),
                              [](const WorldImage& image) { return image.refined; }));
            for (const WorldImage& image : fine[p].images) {
                // What the exact surface hides from the camera is in no list of the complete search.
                if (!image.refined || !image.visible) continue;
                CHECK(std::any_of(
                    complete[p].images.begin(), complete[p].images.end(), [&](const WorldImage& other) {
                        return other.path == image.path && length(other.pixel - image.pixel) < 1e-5;
                    }));
            }
        }
        CHECK(proven >= points.size() - 3);
        CHECK(total >= total_coarse);
    }
}

TEST_CASE("mirrors cast their exact shadow, whatever their resolution", "[trilens][law]") {
    // A sphere of radius 1 about (0, 1.5, 0) over the floor y = -1, lit from straight above: its shadow is
    // the disk of radius 1 about the origin.
    Scene scene = small_scene();
    scene.film = {200, 200, 1};
    scene.cameras[0].eye = {0, -0.5, 6};
    scene.cameras[0].at = {0, -1, 0};
    scene.meshes[0].primitive->center = {0, 1.5, 0};
    scene.materials[1].unlit = false;
    scene.materials[1].base_color_factor = {1, 1, 1};
    Light sun;
    sun.kind = DirectionalLight{.direction = {0, -1, 0}};
    sun.shadows = true;
    scene.lights = {sun};
    const Renderer renderer(std::move(scene));
    const LinearCamera camera = make_perspective({{{0, -0.5, 6}, {0, -1, 0}, {0, 1, 0}}, 40, 200, 200});
    std::size_t dark = 0, bright = 0;
    for (const int n : {1, 8}) {
        PictureRequest request;
        request.frame.resolution = n;
        const Image image = renderer.draw(request).image;
        for (int i = 0; i < 400; ++i) {
            const double radius = i % 2 ? 0.98 : 1.02, angle = 0.01 * i * 3.14159265;
            const Vec3 on_floor(radius * std::cos(angle), -1, radius * std::sin(angle));
            const Vec3 screen = screen_from_world(camera, on_floor);
            const int x = static_cast<int>(screen.x / screen.z), y = static_cast<int>(screen.y / screen.z);
            const PixelExplanation pixel = renderer.explain(request, x, y);
            if (!pixel.hit.seen()) continue;
            const Vec3 seen = renderer.seen_triangle(pixel.hit).position;
            const double from_axis = std::hypot(seen.x, seen.z);
            if (std::fabs(from_axis - 1) < 1e-6) continue;
            const float red = image.find("R")->floats()[static_cast<std::size_t>(y * 200 + x)];
            CHECK((red == 0) == (from_axis < 1));
            ++(from_axis < 1 ? dark : bright);
        }
    }
    CHECK(dark > 100);
    CHECK(bright > 100);
}

TEST_CASE("what a picture leaves out is said, and where it shows the environment stands its direction",
          "[trilens]") {
    std::vector<std::string> told;
    const Warn warn = [&](const std::string& message) { told.push_back(message); };
    const auto mentions = [&](const std::string& words) {
        return std::any_of(told.begin(), told.end(),
                           [&](const std::string& one) { return one.find(words) != std::string::npos; });
    };
    const Image image = Renderer(small_scene()).draw({}, {}, warn).image;
    CHECK_FALSE(mentions("do not see each other"));
    CHECK_FALSE(mentions("bends light once"));
    const std::vector<Id>&object = image.find("reflectID.object")->ids(),
          &optic = image.find("optic.object")->ids();
    std::size_t environment = 0;
    for (std::size_t p = 0; p < image.pixels(); ++p) {
        const auto at = [&](const char* name) { return static_cast<double>(image.find(name)->floats()[p]); };
        const Vec3 place(at("reflectP.X"), at("reflectP.Y"), at("reflectP.Z"));
        if (optic[p] == kNone) CHECK(place == Vec3(0));
        if (optic[p] == kNone || object[p] != kNone) continue;
        CHECK(length(place) == Approx(1).epsilon(1e-6));
        ++environment;
    }
    CHECK(environment > 100);

    Scene two = small_scene();
    two.materials[0] = {};
    two.materials[0].transmission_factor = 1;
    two.meshes.push_back(two.meshes[0]);
    two.meshes.back().name = "other";
    two.meshes.back().primitive->center = {2, 0, 0};
    two.render.max_depth = 0;
    Renderer(std::move(two)).draw({}, {}, warn);
    CHECK(mentions("optics do not see each other"));
    CHECK(mentions("ball: glass bends light once"));
    CHECK(mentions("other: glass bends light once"));
}
