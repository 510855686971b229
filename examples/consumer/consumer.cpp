// Everything that the command does, from a program of one's own: builds a scene in memory, draws it by
// projection and by ray tracing, compares, projects a point, sweeps. Usage: consumer FOLDER
#include <trilens/trilens.h>

#include <cstdio>
#include <string>

namespace {

/// A mirror sphere over a floor, without any file.
trilens::Scene make_scene() {
    trilens::Scene scene;
    scene.film = {160, 120, 1};
    scene.background.color = {0.3, 0.5, 0.8};
    trilens::CameraDescription camera;
    camera.name = "main";
    camera.eye = {0, 1, 5};
    scene.cameras.push_back(camera);

    trilens::Material chrome;
    chrome.name = "chrome";
    chrome.metallic_factor = 1;
    trilens::Material red;
    red.name = "red";
    red.base_color_factor = {0.8, 0.1, 0.1};
    red.unlit = true;
    scene.materials = {chrome, red};

    trilens::Mesh ball;
    ball.name = "ball";
    ball.role = trilens::Role::kOptic;
    ball.material = 0;
    ball.primitive = trilens::Primitive{};
    trilens::Mesh floor;
    floor.name = "floor";
    floor.object.points = {{-3, -1, -3}, {3, -1, -3}, {3, -1, 3}, {-3, -1, 3}};
    floor.object.triangles = {{0, 2, 1}, {0, 3, 2}};
    floor.object.material = {1, 1};
    scene.meshes = {ball, floor};
    return scene;
}

bool check(bool holds, const char* what) {
    std::printf("%s: %s\n", what, holds ? "yes" : "NO");
    return holds;
}

}  // namespace

int main(int argc, char** argv) try {
    const std::string folder = argc > 1 ? argv[1] : ".";
    bool good = check(trilens::version() == trilens::kVersion, "library and headers are of one version");

    const trilens::Renderer renderer(make_scene());
    trilens::PictureRequest request;
    request.frame.resolution = 32;
    const trilens::Picture projected = renderer.draw(request);
    request.engine = trilens::Engine::kLimitTruth;
    const trilens::Picture truth = renderer.draw(request);
    trilens::write_image(folder + "/projected.exr", projected.image);
    trilens::write_image(folder + "/projected.png", projected.image);
    const trilens::Image back = trilens::read_image(folder + "/projected.exr");
    good &= check(back.find("R")->floats() == projected.image.find("R")->floats(),
                  "an image reads back as written");

    const std::vector<trilens::LayerComparison> layers =
        trilens::compare_layers(truth.image, projected.image);
    const trilens::Displacement moved = trilens::total_displacement(layers, "reflect");
    good &= check(moved.summary && moved.summary->mean < 0.1,
                  "the projection is within a tenth of a pixel of the truth");

    const std::vector<trilens::Vec3> points{{0.5, -1, 2}};
    const trilens::PointProjection where = renderer.project(points)[0];
    good &= check(where.complete && where.images.size() == 2,
                  "a point of the floor has a direct and a mirrored image");

    const trilens::PixelExplanation pixel = renderer.explain(request, 80, 60);
    good &= check(pixel.optic == 0, "the middle of the picture shows the ball");
    good &= check(renderer.draw_lines({}).svg.find("<svg") != std::string::npos, "lines are drawn");

    trilens::Scene broken = make_scene();
    broken.meshes[1].object.triangles[0][0] = 99;
    try {
        const trilens::Renderer none(std::move(broken));
        good = check(false, "a broken scene is refused");
    } catch (const trilens::InputError& error) {
        good &= check(true, error.what());
    }

    trilens::SweepRequest sweep;
    sweep.scene.file = folder + "/scene.json";
    sweep.folder = folder + "/sweep";
    sweep.over = {{"resolution", {"2", "4", "8"}}};
    trilens::replace_text_file(sweep.scene.file, trilens::scene_examples()[0].json);
    sweep.scene.overrides = {{"/film/width", "96"}, {"/film/height", "72"}, {"/film/spp", "1"}};
    const trilens::SweepSummary summary = trilens::run_sweep(sweep);
    good &= check(summary.count(trilens::RunState::kDone) == 3, "a sweep of three runs is done");
    return good ? 0 : 1;
} catch (const trilens::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
