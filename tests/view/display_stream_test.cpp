// The viewer on a display server: the bytes of lines, the pictures that arrive, a server that goes away.
#include "view/display_stream.h"

#include <trilens/error.h>
#include <trilens/version.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "support/small_server.h"
#include "support/test.h"
#include "view/viewer.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// The operations of a stream of messages, in order.
std::vector<int> operations_in(const std::vector<std::uint8_t>& bytes) {
    std::vector<int> operations;
    for (std::size_t at = 0; at + 5 <= bytes.size();) {
        std::uint32_t length = 0;
        std::memcpy(&length, &bytes[at], 4);
        REQUIRE(at + length <= bytes.size());
        operations.push_back(bytes[at + 4]);
        at += length;
    }
    return operations;
}

/// The lines of the last message of lines, read as tev does: each begun, moved to, led on, stroked.
std::vector<std::vector<std::array<float, 2>>> last_lines(const std::vector<std::uint8_t>& bytes) {
    std::size_t last = bytes.size();
    for (std::size_t at = 0, length = 0; at + 5 <= bytes.size(); at += length) {
        length = 0;
        std::memcpy(&length, &bytes[at], 4);
        if (bytes[at + 4] == 8) last = at;
    }
    REQUIRE(last < bytes.size());
    std::size_t at = last + 6;
    while (bytes[at++] != 0) {
    }
    const auto number = [&](auto value) {
        REQUIRE(at + sizeof value <= bytes.size());
        std::memcpy(&value, &bytes[at], sizeof value);
        at += sizeof value;
        return value;
    };
    CHECK(number(char{}) == 0);  // instead of those before
    std::vector<std::vector<std::array<float, 2>>> lines;
    for (int left = number(std::int32_t{}); left > 0; --left) {
        const int command = number(char{});
        if (command == 4) at += 16;
        if (command == 6) lines.emplace_back();
        if (command != 10 && command != 11) continue;
        REQUIRE(!lines.empty());
        CHECK((command == 10) == lines.back().empty());
        const float x = number(float{}), y = number(float{});
        lines.back().push_back({x, y});
    }
    return lines;
}

SceneRequest ball_request(const std::string& folder) {
    const std::string file = folder + "/scene.json";
    for (const SceneExample& example : scene_examples())
        if (example.name == std::string("mirror-sphere")) std::ofstream(file) << example.json;
    SceneRequest request{file, {}, 0};
    request.overrides = {{"/film/width", "64"}, {"/film/height", "48"}};
    return request;
}

ViewSettings with_facets(ViewSettings settings) {
    settings.overlays.facets = true;
    return settings;
}

}  // namespace

TEST_CASE("lines over a picture have the bytes that tev reads", "[view][display][golden]") {
    const DisplayLine line{{Vec2(1, 2), Vec2(-2, 0)}, Vec3(1, 0, 2)}, point{{Vec2(1, 2)}, Vec3(1)};
    CHECK(vector_graphics_message("a", {line, point}) ==
          DisplayMessage{50, 0, 0,    0,    8,    0, 'a', 0, 0,    5, 0, 0, 0,     // name, how many
                         4,  0, 0,    0x80, 0x3f, 0, 0,   0, 0,    0, 0, 0, 0x40,  // colour
                         0,  0, 0x80, 0x3f, 6,                                     // begin
                         10, 0, 0,    0x80, 0x3f, 0, 0,   0, 0x40,                 // move to
                         11, 0, 0,    0,    0xc0, 0, 0,   0, 0,                    // line to
                         5});                                                      // stroke
}

TEST_CASE("a display server gets the viewer's last picture to the bit, and facets as lines on it",
          "[view][display]") {
    const SceneRequest request = ball_request(trilens_test::scratch_dir("view_display"));
    SmallServer server;
    std::vector<float> drawn_red;
    {
        Session session = open_session(request);
        session.now.settings = with_facets(session.now.settings);
        DisplayStream stream(server.address(), "ball");
        Painter painter;
        std::size_t edges = 0;
        painter.watch([&](const StagePictures& stage, std::vector<std::string>& warnings) {
            stream.send(stage, warnings);
            drawn_red = stage.projected.find("R")->floats();
            if (stage.drawn.stage != DrawStage::kDone) edges = stage.facet_edges.size();
            for (const FacetEdge& edge : stage.facet_edges)
                CHECK((edge.from.x > -64 && edge.from.x < 128 && edge.to.y > -48 && edge.to.y < 96));
        });
        painter.begin({1, session.file, session.folder, session.now});
        while (painter.draw_next()) {
        }
        CHECK(painter.drawn().error == "");
        CHECK(painter.drawn().warnings.empty());
        CHECK(edges > 20);
    }
    const std::vector<std::uint8_t>& bytes = server.received();
    const std::vector<int> operations = operations_in(bytes);
    REQUIRE(operations.size() >= 3);
    CHECK(operations[0] == 4);
    CHECK(operations[1] == 6);
    CHECK(operations.back() == 8);
    std::vector<std::uint8_t> red(4 * drawn_red.size());
    std::memcpy(red.data(), drawn_red.data(), red.size());
    CHECK(std::search(bytes.begin(), bytes.end(), red.begin(), red.end()) != bytes.end());
}

TEST_CASE("edges, folds and the images of a place arrive at a display server as the lines that are drawn",
          "[view][display]") {
    const SceneRequest request = ball_request(trilens_test::scratch_dir("view_display_lines"));
    SmallServer server;
    std::vector<DisplayLine> drawn;
    {
        Session session = open_session(request);
        session.now.settings.overlays.edges = true;
        session.now.settings.overlays.folds = true;
        session.now.settings.pick = PlacePick{false, Vec2(32.5, 24.5)};
        DisplayStream stream(server.address(), "ball");
        Painter painter;
        painter.watch([&](const StagePictures& stage, std::vector<std::string>& warnings) {
            stream.send(stage, warnings);
            drawn = stage_lines(stage);
        });
        painter.begin({1, session.file, session.folder, session.now});
        while (painter.draw_next()) {
        }
        CHECK(painter.drawn().error == "");
        // The library's own, and the two arms of each image's cross.
        LineChoice folds;
        folds.folds = true;
        const LineDrawing lines = Renderer(load_scene(request)).draw_lines({}, folds);
        REQUIRE(lines.edge_lines.size() > 10);
        REQUIRE(painter.drawn().place_images);
        const std::size_t images = painter.drawn().place_images->images.size();
        REQUIRE(images > 0);
        REQUIRE(drawn.size() == lines.edge_lines.size() + lines.fold_curves.size() + 2 * images);
        for (std::size_t i = 0; i < lines.edge_lines.size(); ++i)
            CHECK(drawn[i].points == lines.edge_lines[i].points);
    }
    const std::vector<std::vector<std::array<float, 2>>> sent = last_lines(server.received());
    REQUIRE(sent.size() == drawn.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
        REQUIRE(sent[i].size() == drawn[i].points.size());
        for (std::size_t k = 0; k < sent[i].size(); ++k) {
            CHECK(sent[i][k][0] == static_cast<float>(drawn[i].points[k].x));
            CHECK(sent[i][k][1] == static_cast<float>(drawn[i].points[k].y));
        }
    }
}

TEST_CASE("a display server that goes away in the middle of a tile is a warning, and pictures go on",
          "[view][display][bad-input]") {
    const SceneRequest request = ball_request(trilens_test::scratch_dir("view_display_away"));
    for (const std::size_t most : {1, 40, 5000}) {
        SmallServer server(most);
        SceneViewer viewer(request);
        viewer.show_on(server.address());
        REQUIRE(viewer.drawing().wait_done(600));
        CHECK(server.received().size() == most);
        // What the system still took is lost without a word; the next pictures are not.
        for (int turn = 0; turn < 3; ++turn) {
            viewer.move({CameraMove::Kind::kOrbit, {5, 0, 0}});
            REQUIRE(viewer.drawing().wait_done(600));
        }
        const auto drawn = viewer.drawn();
        CHECK(viewer.error() == "");
        CHECK(drawn->stage == DrawStage::kDone);
        REQUIRE_FALSE(drawn->warnings.empty());
        CHECK(drawn->warnings.back().find("went away") != std::string::npos);
    }
    SceneViewer viewer(request);
    CHECK_THROWS_AS(viewer.show_on("localhost"), UsageError);
    CHECK_THROWS_AS(viewer.show_on("127.0.0.1:1"), OutputError);
}

TEST_CASE("a number that is none and an optic that nothing sees leave a picture", "[view][bad-input]") {
    const SceneRequest request = ball_request(trilens_test::scratch_dir("view_bad_numbers"));
    SceneViewer viewer(request);
    REQUIRE(viewer.drawing().wait_done(600));
    const Json before = viewer.scene();
    viewer.set("/cameras/0/yfov", std::nan(""));
    CHECK(viewer.error() != "");
    CHECK(viewer.scene() == before);
    // Behind the camera: the picture is drawn, without the optic and without an error.
    viewer.set("/cameras/0/lookAt", {{"eye", {0, 0, 50}}, {"at", {0, 0, 90}}});
    REQUIRE(viewer.drawing().wait_done(600));
    CHECK(viewer.error() == "");
    REQUIRE(viewer.drawn()->left);
    CHECK(viewer.drawn()->left->width == 64);
}
