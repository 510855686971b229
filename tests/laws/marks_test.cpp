// Points and labels on pictures: balls that are drawn as splats against the same balls traced by rays, what
// hides them, and that nothing else of a picture changes.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "base/util/parallel.h"
#include "laws/pictures.h"
#include "laws/worlds.h"
#include "render/marks/marks.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A mirror ball, a ball of glass, a floor, a wall, and what `more` adds to the meshes and the scene.
std::string marked_room(const std::string& meshes, const std::string& more) {
    return R"({"version": 1, "film": {"width": 160, "height": 120},
        "cameras": [{"name": "main", "yfov": 45, "lookAt": {"eye": [0.1, 0.7, 5], "at": [0, 0, 0]}}],
        "background": {"color": [0.3, 0.4, 0.6]},
        "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0, "baseColorFactor": [0.9, 0.8, 0.7]},
                      {"name": "glass", "transmissionFactor": 1, "ior": 1.5},
                      {"name": "red", "baseColorFactor": [0.8, 0.1, 0.1], "unlit": true},
                      {"name": "lime", "baseColorFactor": [0.5, 1, 0.2], "unlit": true}],
        "meshes": [
            {"name": "mirror", "role": "optic", "material": "chrome", "resolution": 16,
             "primitive": {"type": "sphere", "center": [1.2, 0, -0.4], "radius": 0.9}},
            {"name": "lens", "role": "optic", "material": "glass", "resolution": 16,
             "primitive": {"type": "sphere", "center": [-0.9, -0.1, 1.4], "radius": 0.6}},
            {"name": "wall", "role": "object", "material": "red", "points": [[-0.2, -1.2, 0.5], [0.1, -1.2, 0.5], [0.1, 0.4, 0.5], [-0.2, 0.4, 0.5]],
             "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]},
            {"name": "floor", "role": "object", "material": "red", "points": [[-9, -1.2, 9], [9, -1.2, 9], [9, -1.2, -9], [-9, -1.2, -9]],
             "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]})" +
           meshes + "]" + more + "}";
}

std::string text_of(const Vec3& p) {
    return "[" + std::to_string(p.x) + "," + std::to_string(p.y) + "," + std::to_string(p.z) + "]";
}

std::vector<Vec3> places_around(std::size_t count) {
    Draw draw(11);
    std::vector<Vec3> places;
    while (places.size() < count) {
        const Vec3 place(draw.uniform(-2, 2.6), draw.uniform(-1.1, 1.4), draw.uniform(-2.5, 2.5));
        if (length(place - Vec3(1.2, 0, -0.4)) > 1.1 && length(place - Vec3(-0.9, -0.1, 1.4)) > 0.8 &&
            std::fabs(place.z - 0.5) > 0.2)
            places.push_back(place);
    }
    return places;
}

std::string cloud_of(const std::vector<Vec3>& places, double radius, const std::string& more = "") {
    std::string list;
    for (const Vec3& place : places) list += (list.empty() ? "" : ",") + text_of(place);
    return R"({"at": [)" + list + R"(], "color": [0.5, 1, 0.2], "radius": )" + std::to_string(radius) + more +
           "}";
}

double total(const Image& image, const char* channel) {
    double sum = 0;
    for (const float value : image.find(channel)->floats()) sum += double{value};
    return sum;
}

constexpr const char* kNoMarks = R"(, "lights": [])";

}  // namespace

TEST_CASE("splats are the traced balls, directly, in a mirror and through glass", "[marks][law]") {
    const std::vector<Vec3> places = places_around(60);
    constexpr double kRadius = 0.035;
    std::string balls;
    for (std::size_t i = 0; i < places.size(); ++i)
        balls +=
            R"(, {"name": "ball )" + std::to_string(i) +
            R"(", "role": "object", "material": "lime", "primitive": {"type": "sphere", "segments": 24, "center": )" +
            text_of(places[i]) + R"(, "radius": )" + std::to_string(kRadius) + "}}";
    const auto with_balls = world_from("balls", marked_room(balls, kNoMarks), 16),
               without = world_from("none", marked_room("", kNoMarks), 16),
               with_splats =
                   world_from("splats",
                              marked_room("", R"(, "points": [)" +
                                                  cloud_of(places, kRadius, R"(, "minWeight": 0)") + "]"),
                              16);
    const Image truth = drawn_by(*with_balls, 4, Engine::kLimitTruth),
                plain_truth = drawn_by(*without, 4, Engine::kLimitTruth);
    for (const Engine engine : {Engine::kLimitTruth, Engine::kExact}) {
        const Image plain = drawn_by(*without, 4, engine), splats = drawn_by(*with_splats, 4, engine);
        const PictureError of_splats = picture_error(splats, truth), of_nothing = picture_error(plain, truth);
        CAPTURE(engine, of_splats.rms, of_splats.bias, of_nothing.rms, of_nothing.bias);
        CHECK(of_nothing.rms > 0.06);
        // Outlines are those of 4 x 4 samples in both, at other places; the rest is splats over rims.
        CHECK(of_splats.rms < 0.08 * of_nothing.rms);
        CHECK(std::fabs(of_splats.bias) < 0.03 * std::fabs(of_nothing.bias));
        for (const char* part : {"direct.G", "reflect.G", "refract.G"}) {
            INFO(part);
            const double wanted = total(truth, part) - total(plain_truth, part);
            CHECK(std::fabs(wanted) > 3);
            CHECK(total(splats, part) - total(plain, part) == Approx(wanted).epsilon(0.08));
        }
    }
}

TEST_CASE("points' images are reported while they are found, before the first row, and can be stopped",
          "[marks]") {
    const auto world = world_from(
        "reported", marked_room("", R"(, "points": [)" + cloud_of(places_around(130), 0.02) + "]"), 8);
    std::vector<double> told;
    draw_picture(*world, {}, {[&](double done) { told.push_back(done); }}, ignore);
    CHECK(std::is_sorted(told.begin(), told.end()));
    CHECK(told.front() < 0.3 * 65 / 130);
    CHECK(told.back() == 1);
    // Stopped at the first report.
    std::atomic<bool> cancel = false;
    std::size_t reports = 0;
    const Progress stopping{[&](double) { ++reports, cancel = true; }, &cancel};
    CHECK_THROWS_AS(draw_picture(*world, {}, stopping, ignore), Interrupted);
    CHECK(reports == 1);
}

TEST_CASE("a splat smaller than a pixel keeps its light", "[marks][law]") {
    for (const double radius : {1e-4, 1e-3, 0.004, 0.02, 0.06}) {
        std::string room =
            marked_room("", R"(, "points": [{"at": [[0.3, 0.9, 2]], "color": [0, 4, 0], "radius": )" +
                                std::to_string(radius) + "}]");
        const auto world = world_from("small", room, 8);
        const PlacedMarks placed = place_marks(*world, {});
        const auto direct = std::find_if(placed.marks.begin(), placed.marks.end(),
                                         [](const PlacedMark& mark) { return mark.path == Path::kDirect; });
        REQUIRE(direct != placed.marks.end());
        // Pixels per unit: half the film's height over the tangent of half its angle, over the depth.
        const Vec3 eye(0.1, 0.7, 5), way = Vec3(0.3, 0.9, 2) - eye;
        const double depth = dot(way, normalize(-eye));
        const double pixels = 60 / std::tan(22.5 * std::numbers::pi / 180) / depth * radius;
        const double area = std::numbers::pi * std::sqrt(direct->spread.determinant()) * direct->opacity;
        const double slant = length(way) / depth;  // a ball off the axis is longer than wide
        CAPTURE(radius, pixels);
        CHECK(area == Approx(std::numbers::pi * pixels * pixels * slant).epsilon(0.01));
        const auto without = world_from("small", marked_room("", kNoMarks), 8);
        const double light = total(drawn_by(*world, 1, Engine::kExact), "direct.G") -
                             total(drawn_by(*without, 1, Engine::kExact), "direct.G");
        CHECK(light == Approx(area * (4 - 0.4)).epsilon(0.2).margin(1e-4));
    }
}

TEST_CASE("what stands before a point hides it, and is counted", "[marks][law]") {
    // Behind the wall, before it, off the film.
    const auto world = world_from(
        "hidden",
        marked_room("", R"(, "points": [{"at": [[-0.05, -0.3, 0.3], [-0.05, -0.3, 0.8], [0, 90, 0]]}])"), 8);
    const PlacedMarks placed = place_marks(*world, {});
    CHECK(placed.places == 3);
    CHECK(placed.hidden >= 1);
    for (const PlacedMark& mark : placed.marks) CHECK(!(mark.point == 0 && mark.path == Path::kDirect));
    CHECK(std::count_if(placed.marks.begin(), placed.marks.end(), [](const PlacedMark& mark) {
              return mark.point == 1 && mark.path == Path::kDirect;
          }) == 1);
    std::vector<std::string> told;
    tell_marks(*world, placed, [&](const std::string& text) { told.push_back(text); });
    CHECK(told.empty());
    const auto off =
        world_from("off", marked_room("", R"(, "points": [{"at": [[0, 90, 0]], "minWeight": 1}])"), 8);
    tell_marks(*off, place_marks(*off, {}), [&](const std::string& text) { told.push_back(text); });
    REQUIRE(told.size() == 1);
    CHECK(told[0].find("none of 1 points and labels is seen") == 0);
}

TEST_CASE("marks change colours alone, in crops as in the whole, for any number of threads", "[marks][law]") {
    const std::string marks = R"(, "points": [)" + cloud_of(places_around(40), 0.05) +
                              R"(], "labels": [{"text": "wall", "at": [0, 0.4, 0.5]}])";
    const auto world = world_from("marked", marked_room("", marks), 8),
               without = world_from("plain", marked_room("", kNoMarks), 8);
    REQUIRE(world->scene.labels[0].letters == nullptr);
    PictureRequest request;
    const auto draw = [&](const World& of) { return draw_picture(of, request, {}, ignore, nullptr).image; };
    const Image marked = draw(*world), plain = draw(*without);
    std::size_t changed = 0;
    for (const Channel& channel : plain.channels) {
        const Channel* other = marked.find(channel.name);
        REQUIRE(other);
        const bool same = channel.values == other->values;
        const bool is_colour = channel.name.size() == 1
                                   ? channel.name != "Z"
                                   : std::string("RGB").find(channel.name.back()) != std::string::npos;
        INFO(channel.name);
        if (!is_colour) CHECK(same);
        changed += !same;
    }
    CHECK(changed >= 6);
    set_thread_count(1);
    const Image alone = draw(*world);
    set_thread_count(3);
    const Image shared = draw(*world);
    set_thread_count(0);
    REQUIRE(alone.channels.size() == shared.channels.size());
    for (std::size_t c = 0; c < alone.channels.size(); ++c)
        CHECK(alone.channels[c].values == shared.channels[c].values);
    request.layers.x0 = 40, request.layers.y0 = 30, request.layers.x1 = 130, request.layers.y1 = 90;
    const Image crop = draw(*world);
    const std::vector<float>&whole = alone.find("G")->floats(), &part = crop.find("G")->floats();
    std::size_t differing = 0;
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 90; ++x)
            differing += part[static_cast<std::size_t>(y * 90 + x)] !=
                         whole[static_cast<std::size_t>((y + 30) * 160 + x + 40)];
    CHECK(differing == 0);
}

TEST_CASE("a splat at a fold ends, one of least weight is left out, and dispersion leaves it its colour",
          "[marks][law]") {
    // Near the focus of the glass ball, as the eye has it, magnification has no bound.
    std::string line;
    for (int i = 0; i < 20; ++i)
        line += (i ? "," : "") +
                text_of(Vec3(-0.9, -0.1, 1.4) + (0.7 + 0.06 * i) * normalize(Vec3(-1, -0.8, -3.6)));
    const auto world =
        world_from("folds", marked_room("", R"(, "points": [{"radius": 0.05, "at": [)" + line + "]}]"), 8);
    const PlacedMarks placed = place_marks(*world, {});
    double longest = 0;
    for (const PlacedMark& mark : placed.marks)
        longest = std::max({longest, std::sqrt(mark.spread.xx), std::sqrt(mark.spread.yy)});
    CAPTURE(placed.marks.size(), placed.cut);
    CHECK(placed.cut > 0);
    CHECK(longest <= kLongestSplat + 0.01);

    const std::string some = R"("at": [[0.3, 0.9, 2], [1, 1.2, 1.5], [-0.4, 0.2, -1]])";
    const auto all = world_from("all", marked_room("", R"(, "points": [{"minWeight": 0, )" + some + "}]"), 8),
               strong = world_from("strong",
                                   marked_room("", R"(, "points": [{"minWeight": 0.5, )" + some + "}]"), 8);
    const PlacedMarks of_all = place_marks(*all, {}), of_strong = place_marks(*strong, {});
    CHECK(of_strong.marks.size() < of_all.marks.size());
    for (const PlacedMark& mark : of_strong.marks)
        CHECK(std::max({mark.light.x, mark.light.y, mark.light.z}) >= 0.5);

    std::string dispersing = marked_room("", R"(, "points": [{"minWeight": 0, )" + some + "}]");
    dispersing.replace(dispersing.find(R"("ior": 1.5)"), 10, R"("ior": 1.5, "dispersion": 1)");
    const auto glass = world_from("dispersing", dispersing, 8);
    std::size_t through = 0;
    for (const PlacedMark& mark : place_marks(*glass, {}).marks)
        if (mark.path == Path::kRefract) {
            ++through;
            CHECK(mark.light.x > 0);
            CHECK(mark.light.x == mark.light.y);
        }
    CHECK(through > 0);
}

TEST_CASE("labels that give way are left out where they would cover others, by priority, then by depth",
          "[marks][law]") {
    // Places near each other, whose dots cover one another.
    const auto placed_of = [](const std::vector<std::string>& more) {
        std::string labels;
        for (std::size_t i = 0; i < more.size(); ++i)
            labels += (i ? ", " : "") + std::string(R"({"text": "label", "at": )") +
                      text_of({-2 + 0.05 * static_cast<double>(i), 1.3, 0.1 * static_cast<double>(i)}) +
                      R"(, "minWeight": 0.95, "dot": 40)" + more[i] + "}";
        const auto world = world_from("labels", marked_room("", R"(, "labels": [)" + labels + "]"), 8);
        PlacedMarks placed = place_marks(*world, {});
        std::vector<std::array<FilmBox, 2>> boxes;
        for (const PlacedMark& mark : placed.marks)
            if (world->scene.labels[mark.entry].gives_way) boxes.push_back(mark_boxes(*world, mark));
        for (std::size_t i = 0; i < boxes.size(); ++i)
            for (std::size_t k = 0; k < i; ++k)
                for (const FilmBox& one : boxes[i])
                    for (const FilmBox& other : boxes[k]) CHECK_FALSE(one.meets(other));
        return placed;
    };
    const std::string way = R"(, "givesWay": true)";
    CHECK(placed_of({"", "", "", ""}).marks.size() == 4);
    CHECK(placed_of({"", "", "", ""}).crowded_out == 0);
    // The nearest one, the last, stays; of higher priority another one; and what does not give way before
    // all.
    const PlacedMarks by_depth = placed_of({way, way, way, way});
    REQUIRE(by_depth.marks.size() == 1);
    CHECK(by_depth.marks[0].entry == 3);
    CHECK(by_depth.crowded_out == 3);
    const PlacedMarks by_priority =
        placed_of({way, way + R"(, "priority": 2)", way + R"(, "priority": 1)", way});
    REQUIRE(by_priority.marks.size() == 1);
    CHECK(by_priority.marks[0].entry == 1);
    const PlacedMarks kept = placed_of({"", way + R"(, "priority": 9)", way, ""});
    REQUIRE(kept.marks.size() == 2);
    CHECK(kept.marks[0].entry + kept.marks[1].entry == 3);
    CHECK(kept.crowded_out == 2);
}

TEST_CASE("between its dot and letters far from it a label leaves room for others that give way",
          "[marks][law]") {
    const auto placed_of = [](const std::string& offset, const std::string& second) {
        const std::string way = R"("minWeight": 0.95, "size": 8, "dot": 6, "givesWay": true)";
        const auto world = world_from(
            "offsets",
            marked_room("", R"(, "labels": [{"text": "far", "at": [-2.3, 1.3, 0], "priority": 1, )" + way +
                                R"(, "offset": )" + offset + R"(}, {"text": "i", "offset": [4, 0], "at": )" +
                                second + ", " + way + "}]"),
            8);
        for (Label& label : world->scene.labels)
            label.letters = std::make_shared<const TextMask>(TextMask{12, 8, std::vector<float>(96, 1)});
        return place_marks(*world, {});
    };
    // The camera looks down a little: these are pixels to a few percent.
    const double pixel = 2 * 5.1 * std::tan(22.5 * std::numbers::pi / 180) / 120;
    const auto below = [&](double pixels) { return text_of(Vec3(-2.3, 1.3 - pixels * pixel, 0)); };
    const PlacedMarks between = placed_of("[0, 60]", below(30));
    CHECK(between.marks.size() == 2);
    CHECK(between.crowded_out == 0);
    for (const double at : {0.0, 60.0}) {
        const PlacedMarks on = placed_of("[0, 60]", below(at));
        CAPTURE(at);
        CHECK(on.marks.size() == 1);
        CHECK(on.crowded_out == 1);
    }
    // Off the film there is nothing to cover, however far.
    for (const std::string far : {"[1e6, -1e6]", "[-1e6, 1e6]", "[0, 1e6]"})
        CHECK(placed_of(far, below(30)).marks.size() == 2);
}
