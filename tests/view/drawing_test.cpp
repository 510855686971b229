// The viewer's drawing: stages, whole pictures, interruption, errors beside the last good picture, scripts.
#include <trilens/error.h>
#include <trilens/utilities.h>
#include <trilens/version.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "support/test.h"
#include "view/script.h"
#include "view/viewer.h"

using namespace trilens;

namespace {

std::string small_scene_file(const std::string& folder) {
    const std::string file = folder + "/scene.json";
    for (const SceneExample& example : scene_examples())
        if (example.name == std::string("mirror-sphere")) std::ofstream(file) << example.json;
    return file;
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// What the command draws.
PictureRequest plain_request() {
    PictureRequest request;
    request.frame.facets = FacetUse::kWorthwhile;
    return request;
}

SceneRequest small_request(const std::string& folder) {
    SceneRequest request{small_scene_file(folder), {}, 0};
    request.overrides = {{"/film/width", "64"}, {"/film/height", "48"}};
    return request;
}

}  // namespace

TEST_CASE("the last stage of all pixels is the renderer's own picture", "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_stages");
    const SceneRequest request = small_request(folder);
    Session session = open_session(request);
    Painter painter;
    painter.begin({1, session.file, session.folder, session.now});
    std::vector<DrawStage> stages;
    while (painter.draw_next()) stages.push_back(painter.drawn().stage);
    CHECK(painter.drawn().error.empty());
    CHECK(stages.size() == 5);
    CHECK(painter.drawn().stage == DrawStage::kDone);
    const Renderer renderer(load_scene(request));
    const Image image = renderer.draw(plain_request()).image;
    const Image mine = painter.picture();
    for (const char* channel : {"R", "G", "B"})
        CHECK(mine.find(channel)->floats() == image.find(channel)->floats());
    // What is shown last has 8 x 8 samples, tone mapped as a PNG is.
    SceneRequest fine = request;
    fine.overrides.push_back({"/film/spp", "8"});
    const Pixels expected = tone_pixels(Renderer(load_scene(fine)).draw(plain_request()).image, "", {});
    REQUIRE(painter.drawn().left);
    CHECK(painter.drawn().left->rgba == expected.rgba);
}

TEST_CASE("what differs between two states alone decides what is read again, never what is shown", "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_changes");
    Session session = open_session(small_request(folder));
    Painter kept;
    const std::vector<std::pair<std::string, Json>> changes{
        {"/cameras/0/yfov", 30},       {"/cameras/0/lookAt/eye", Json::array({0.3, 0.5, 4.0})},
        {"/film/width", 48},           {"/render/maxDepth", 1},
        {"/meshes/0/name", "renamed"}, {"/cameras/0/lookAt/at", Json::array({0, 0.1, 0})}};
    std::uint64_t number = 0;
    for (const auto& [pointer, value] : changes) {
        INFO(pointer);
        set_value(session, pointer, value);
        const auto drawn_by = [&](Painter& painter) {
            painter.begin({++number, session.file, session.folder, session.now});
            while (painter.next() <= DrawStage::kPixels) painter.draw_next();
            CHECK(painter.drawn().error == "");
            return painter.drawn().left;
        };
        Painter fresh;
        const auto one = drawn_by(kept), other = drawn_by(fresh);
        REQUIRE(one);
        REQUIRE(other);
        CHECK(one->width == other->width);
        CHECK(one->rgba == other->rgba);
    }
}

TEST_CASE("a state that is no scene shows its error and its place beside the last good picture", "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_errors");
    SceneViewer viewer(small_request(folder));
    REQUIRE(viewer.drawing().wait_done(60));
    const auto good = viewer.drawn();
    REQUIRE(good->left);
    viewer.set("/cameras/0/yfov", 500);
    REQUIRE(viewer.drawing().wait_done(60));
    const auto bad = viewer.drawn();
    CHECK(has(bad->error, "/cameras/0/yfov"));
    CHECK(bad->left == good->left);
    CHECK_FALSE(viewer.save(folder + "/none.png"));
    CHECK_FALSE(std::filesystem::exists(folder + "/none.png"));
    // Not a number never reaches the scene.
    viewer.undo_step();
    viewer.set("/cameras/0/yfov", std::nan(""));
    CHECK(has(viewer.error(), "/cameras/0/yfov"));
    viewer.set("/cameras/0/yfov", 40);
    REQUIRE(viewer.drawing().wait_done(60));
    CHECK(viewer.error().empty());
    // The file changes on the disk into something that is no scene, and back.
    const std::string file = folder + "/scene.json";
    std::ofstream(file) << "{ no scene";
    viewer.look_for_changes();
    CHECK(has(viewer.error(), "scene.json"));
    REQUIRE(viewer.drawing().wait_done(60));
    CHECK(viewer.drawn()->left);
    small_scene_file(folder);
    viewer.reload_files();
    REQUIRE(viewer.drawing().wait_done(60));
    CHECK(viewer.error().empty());
}

TEST_CASE("states that change faster than pictures come still bring pictures, and the last one in full",
          "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_fast");
    SceneViewer viewer(small_request(folder));
    for (int i = 0; i < 300; ++i) {
        viewer.move({CameraMove::Kind::kOrbit, {1.2, 0, 0}});
        if (i % 10 == 0) viewer.drawing().wait_shown(0.02);
    }
    REQUIRE(viewer.drawing().wait_done(120));
    const DrawTimes times = viewer.drawing().times();
    CHECK(times.latencies.size() > 5);
    // A whole turn: the picture of the beginning, but for rounding.
    Session session = viewer.session();
    Painter painter;
    painter.begin({1, session.file, session.folder, session.now});
    while (painter.draw_next()) {
    }
    CHECK(viewer.drawn()->left->rgba == painter.drawn().left->rgba);
}

TEST_CASE("paths of a pixel begin at the eye, lie on the mirror and end where the place's images look",
          "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_paths");
    Session session = open_session(small_request(folder));
    ViewSettings& settings = session.now.settings;
    settings.pixel = Vec2(32.5, 24.5);
    settings.pick = PlacePick{false, Vec2(32.5, 24.5)};
    settings.birds_eye.shown = true;
    Painter painter;
    painter.begin({1, session.file, session.folder, session.now});
    while (painter.next() <= DrawStage::kLines && painter.draw_next()) {
    }
    REQUIRE(painter.drawn().error == "");
    REQUIRE(painter.drawn().pixel_paths);
    REQUIRE_FALSE(painter.drawn().pixel_paths->empty());
    const PathLine& path = painter.drawn().pixel_paths->front();
    REQUIRE(path.corners.size() == 3);
    CHECK(path.word == "R");
    CHECK(path.corners[0].event == "eye");
    CHECK(path.corners[1].event == "reflect");
    REQUIRE(painter.drawn().birds_eye);
    CHECK(painter.drawn().birds_eye->picture.width == 32);
    CHECK_FALSE(painter.drawn().birds_eye->lines.empty());
    if (path.corners[2].event != "seen") return;
    // The place that the pixel shows has an image at that pixel.
    REQUIRE(painter.drawn().place_images);
    bool found = false;
    for (const PlaceImage& image : painter.drawn().place_images->images)
        found = found ||
                (image.line.word == "R" && std::hypot(image.pixel.x - 32.5, image.pixel.y - 24.5) < 1e-4);
    CHECK(found);
}

TEST_CASE("a mark off the film is told of, and the picture still gets all its samples", "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_off_film");
    Session session = open_session(small_request(folder));
    session.now.settings.pixel = Vec2(900, 24);
    Painter painter;
    painter.begin({1, session.file, session.folder, session.now});
    while (painter.draw_next()) {
    }
    CHECK(painter.drawn().error.empty());
    CHECK(painter.drawn().stage == DrawStage::kDone);
    CHECK_FALSE(painter.drawn().warnings.empty());
    CHECK_FALSE(painter.drawn().pixel_paths);
}

TEST_CASE("a coarse picture is the trace of fewer pixels, and all pixels follow it", "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_coarse");
    SceneRequest request = small_request(folder);
    request.overrides = {{"/film/width", "256"}, {"/film/height", "192"}};
    Session session = open_session(request);
    session.now.settings.frame.resolution = 2;  // facets that show something else
    session.now.settings.frame.facets = FacetUse::kAll;
    Painter painter;
    painter.begin({1, session.file, session.folder, session.now});
    REQUIRE(painter.draw_next());
    CHECK(painter.drawn().stage == DrawStage::kCoarse);
    CHECK(painter.drawn().film_width == 256);
    SceneRequest few = request;
    few.overrides = {{"/film/width", "16"}, {"/film/height", "12"}, {"/film/spp", "1"}};
    PictureRequest truth;
    truth.engine = Engine::kLimitTruth;
    const auto coarse = painter.drawn().left;
    REQUIRE(coarse);
    CHECK(coarse->rgba == tone_pixels(Renderer(load_scene(few)).draw(truth).image, "", {}).rgba);
    REQUIRE(painter.draw_next());
    CHECK(painter.drawn().left->width == 256);
}

TEST_CASE("while states change no picture of many samples is begun", "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_rest");
    SceneViewer viewer(small_request(folder));
    REQUIRE(viewer.drawing().wait_done(60));
    for (int turn = 0; turn < 30; ++turn) {
        const Stopwatch watch;
        viewer.move({CameraMove::Kind::kOrbit, {3, 0, 0}});
        REQUIRE(viewer.drawing().wait_shown(60));
        // Long enough for 4 x 4 samples of so small a film.
        std::this_thread::sleep_for(std::chrono::milliseconds(70));
        const DrawStage stage = viewer.drawn()->stage;
        // A busy machine may take so long that the hand was at rest.
        if (watch.seconds() < 0.1) CHECK(stage < DrawStage::kFine);
    }
    REQUIRE(viewer.drawing().wait_done(60));
    CHECK(viewer.drawn()->stage == DrawStage::kDone);
}

TEST_CASE("the comparison's numbers are those of the library, and its pictures are there", "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_comparison");
    SceneRequest request = small_request(folder);
    request.resolution = 4;
    request.overrides.push_back({"/film/spp", "1"});
    Session session = open_session(request);
    const Renderer renderer(load_scene(request));
    PictureRequest truth;
    truth.engine = Engine::kLimitTruth;
    const Image of_truth = renderer.draw(truth).image, mine = renderer.draw(plain_request()).image;
    const Metrics expected = compare(of_truth, mine).metrics;
    for (const ShownPicture right : {ShownPicture::kTruth, ShownPicture::kDifference,
                                     ShownPicture::kDisplacement, ShownPicture::kFlip}) {
        session.now.settings.right = right;
        session.now.settings.wipe = 0.5;
        Painter painter;
        painter.begin({1, session.file, session.folder, session.now});
        while (painter.next() <= DrawStage::kComparison && painter.draw_next()) {
        }
        REQUIRE(painter.drawn().error == "");
        REQUIRE(painter.drawn().comparison);
        CHECK(painter.drawn().comparison->metrics.rmse == expected.rmse);
        CHECK(painter.drawn().comparison->metrics.flip == expected.flip);
        REQUIRE(painter.drawn().right);
        if (right == ShownPicture::kTruth)
            CHECK(painter.drawn().right->rgba == tone_pixels(of_truth, "", {}).rgba);
        if (right == ShownPicture::kDisplacement) {
            REQUIRE(painter.drawn().comparison->displacement);
            CHECK(painter.drawn().comparison->displacement->mean ==
                  total_displacement(compare_layers(of_truth, mine), "").summary->mean);
        }
    }
}

TEST_CASE("scripts are refused at the step that is none", "[view]") {
    const auto refused = [](const std::string& text) -> std::string {
        try {
            Script("steps.json", text);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(has(refused("{"), "steps.json"));
    CHECK(has(refused("7"), "steps"));
    const std::string unknown = refused(R"([{"orbit": [1, 2]}, {"orbitt": [1, 2]}])");
    CHECK(has(unknown, "/steps/1"));
    CHECK(has(unknown, "did you mean 'orbit'"));
    CHECK(has(refused(R"([{"orbit": [1]}])"), "2 numbers"));
    CHECK(has(refused(R"([{"frames": 3}])"), "without an action"));
    CHECK(refused(R"([{"dolly": 0.5, "frames": 3}, {"wait": "done"}])").empty());

    for (const std::string bad :
         {R"({"wait": -5})", R"({"wait": 1e4})", R"({"wait": "dome"})", R"({"show": {"n": 0}})",
          R"({"show": {"n": 1025}})", R"({"show": {"n": 2.5}})", R"({"show": {"maxError": 0}})",
          R"({"show": {"wipe": 1.5}})", R"({"show": {"scale": -1}})", R"({"show": {"elevation": 90}})",
          R"({"show": {"distance": 0}})", R"({"orbit": [1, 2], "frames": 0})",
          R"({"orbit": [1, 2], "frames": 1.5})", R"({"turntable": 0})", R"({"dolly": 0})", R"({"undo": 0})",
          R"({"redo": 1e9})", R"({"random": -1})"}) {
        INFO(bad);
        const std::string said = refused(R"([{"wait": 0}, )" + bad + "]");
        CHECK(has(said, "steps.json: /steps/1: "));
        CHECK((has(said, "out of range") || has(said, "no whole number") || has(said, "needs 1 number")));
    }
    CHECK(refused(R"([{"wait": 600}, {"show": {"n": null, "wipe": 1, "maxError": null}}, {"undo": 200}])")
              .empty());
}

TEST_CASE("a script's time is a frame of the scene's animation, or bad input", "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_time");
    const auto said = [](SceneViewer& viewer, const std::string& time) -> std::string {
        Script script("steps.json", R"([{"wait": "picture"}, {"time": )" + time + "}]");
        try {
            while (script.advance(viewer)) {
            }
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    SceneViewer still(small_request(folder));
    CHECK(has(said(still, "1"), "steps.json: /steps/1: time: the scene has no animation"));
    std::ofstream(folder + "/moves.json") << R"({"version": 1, "film": {"width": 16, "height": 12},
        "cameras": [{"name": "c", "yfov": 40, "lookAt": {"eye": [0, 0, 4], "at": [0, 0, 0]}}],
        "materials": [{"name": "chrome", "metallicFactor": 1}],
        "meshes": [{"name": "ball", "role": "optic", "material": "chrome",
                    "primitive": {"type": "sphere", "radius": 1}}],
        "animation": {"fps": 24, "tracks": [{"target": "/meshes/0/primitive/radius",
                      "keys": [{"frame": 2, "value": 1}, {"frame": 8, "value": 0.5}]}]}})";
    SceneViewer moves(SceneRequest{folder + "/moves.json", {}, 0});
    CHECK(said(moves, "2").empty());
    CHECK(said(moves, "8").empty());
    CHECK(moves.settings().time == 8);
    CHECK(has(said(moves, "1e9"), "steps.json: /steps/1: time: 1e+09 is out of range: 2 to 8"));
    CHECK(has(said(moves, "1.9"), "out of range"));
    CHECK(moves.settings().time == 8);
}

TEST_CASE("the viewer says that its scene's file is gone, and reads it again once it is back", "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_gone");
    const SceneRequest request = small_request(folder);
    SceneViewer viewer(request);
    const auto look = [&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(510));
        viewer.look_for_changes();
    };
    const std::string away = request.file + ".away";
    look();
    CHECK(viewer.gone().empty());
    std::filesystem::rename(request.file, away);
    look();
    CHECK(has(viewer.gone(), request.file + " is gone"));
    viewer.move({CameraMove::Kind::kOrbit, {10, 0, 0}});
    CHECK(has(viewer.gone(), "is gone"));  // it goes on, and says so still
    CHECK(viewer.error().empty());
    std::filesystem::rename(away, request.file);
    look();
    CHECK(viewer.gone().empty());
    CHECK(has(viewer.message(), request.file + " is back"));

    std::filesystem::remove(request.file);
    look();
    CHECK(has(viewer.gone(), "is gone"));
    Json other = *viewer.session().now.scene;
    other["film"]["spp"] = 3;
    std::ofstream(request.file) << other.dump();
    look();
    CHECK(viewer.gone().empty());
    CHECK(viewer.scene().at("film").at("spp") == 3);
}

TEST_CASE("a script turns the camera, saves the scene as it then is, and random hands break nothing",
          "[view]") {
    const std::string folder = trilens_test::scratch_dir("view_script");
    SceneViewer viewer(small_request(folder));
    Script script("steps.json", R"([{"show": {"n": 4, "birdsEye": true, "facets": true, "wipe": 0.5}},
        {"orbit": [90, 0], "frames": 6}, {"wait": "done"}, {"save": ")" +
                                    folder + R"(/turned.json"},
        {"save": ")" + folder + R"(/turned.png"}, {"save": ")" +
                                    folder + R"(/turned.svg"},
        {"random": 5, "frames": 60}, {"wait": "done"}])");
    const CameraPose before = camera_pose(viewer.scene().at("cameras").at(0), 1);
    while (script.advance(viewer)) {
    }
    REQUIRE(script.reports().size() == 8);
    CHECK(script.reports()[1].frames == 6);
    CHECK(script.reports()[1].error.empty());
    const Scene turned = load_scene(SceneRequest{folder + "/turned.json", {}, 0});
    const Json camera = Json::parse(turned.resolved).at("cameras").at(0);
    const Vec3 arm = before.eye - before.pivot, after = camera_pose(camera, 1).eye - before.pivot;
    CHECK(after.x == Approx(arm.z).margin(1e-9));
    CHECK(after.z == Approx(-arm.x).margin(1e-9));
    CHECK(turned.cameras.size() == 1);  // the bird's eye is none of the scene's
    CHECK(read_image_parts(folder + "/turned.png").at(0).image.width == 64);
    CHECK(std::filesystem::file_size(folder + "/turned.svg") > 100);
}
