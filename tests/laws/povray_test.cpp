// The truth against an independent ray tracer: POV-Ray draws the same balls, mirrors and nested glass.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "render/picture/sample_colour.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kPovrayWidth = 320, kPovrayHeight = 240;

/// A ball in both languages.
struct Ball {
    Vec3 center{0};
    double radius = 1;
    double ior = 0;  // 0: a mirror
    int priority = 0;
};

/// A unlit square of one colour.
struct Square {
    std::array<Vec3, 4> corner;
    Vec3 colour{1};
};

/// What both programs draw.
struct Stage {
    std::vector<Ball> balls;
    std::vector<Square> squares;
    Vec3 eye{0.3, 0.8, 4.5}, at{0, 0.1, 0};
    double yfov = 40;
    bool fresnel = false;
};

/// Checkers on the walls of a closed room around the balls: every square's colour is its own.
std::vector<Square> povray_room() {
    std::vector<Square> squares;
    constexpr int kCells = 4;
    const Vec3 low(-4, -1.5, -5), high(4, 4, 6);
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side)
            for (int i = 0; i < kCells; ++i)
                for (int j = 0; j < kCells; ++j) {
                    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
                    const auto at = [&](int u, int v) {
                        Vec3 p(0);
                        p[axis] = side ? high[axis] : low[axis];
                        p[a] = low[a] + (high[a] - low[a]) * u / kCells;
                        p[b] = low[b] + (high[b] - low[b]) * v / kCells;
                        return p;
                    };
                    // 96 colours, at least 1/8 apart in one channel.
                    const int number = static_cast<int>(squares.size());
                    squares.push_back(
                        {{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)},
                         {(number % 5 + 1) / 5.0, (number / 5 % 5 + 1) / 5.0, (number / 25 + 1) / 5.0}});
                }
    return squares;
}

std::string triple_text(const Vec3& v, const char* open, const char* close) {
    char text[120];
    std::snprintf(text, sizeof text, "%s%.17g,%.17g,%.17g%s", open, v.x, v.y, v.z, close);
    return text;
}
std::string json(const Vec3& v) {
    return triple_text(v, "[", "]");
}
std::string pov(const Vec3& v) {
    return triple_text(v, "<", ">");
}

std::string scene_json(const Stage& stage) {
    std::ostringstream out;
    out.precision(17);
    out << "{\"version\":1,\"film\":{\"width\":" << kPovrayWidth << ",\"height\":" << kPovrayHeight
        << "},\"cameras\":[{\"name\":\"main\",\"yfov\":" << stage.yfov
        << ",\"lookAt\":{\"eye\":" << json(stage.eye) << ",\"at\":" << json(stage.at)
        << ",\"up\":[0,1,0]}}],\"materials\":[";
    for (std::size_t i = 0; i < stage.balls.size(); ++i) {
        out << "{\"name\":\"ball" << i << "\",";
        if (stage.balls[i].ior == 0)
            out << "\"metallicFactor\":1,\"baseColorFactor\":[1,1,1]},";
        else
            out << "\"transmissionFactor\":1,\"ior\":" << stage.balls[i].ior << "},";
    }
    for (std::size_t i = 0; i < stage.squares.size(); ++i)
        out << (i ? "," : "") << "{\"name\":\"square" << i
            << "\",\"unlit\":true,\"baseColorFactor\":" << json(stage.squares[i].colour) << "}";
    out << "],\"meshes\":[";
    for (std::size_t i = 0; i < stage.balls.size(); ++i)
        out << "{\"name\":\"ball" << i << "\",\"role\":\"optic\",\"material\":\"ball" << i
            << "\",\"priority\":" << stage.balls[i].priority
            << ",\"primitive\":{\"type\":\"sphere\",\"center\":" << json(stage.balls[i].center)
            << ",\"radius\":" << stage.balls[i].radius << "}},";
    for (std::size_t i = 0; i < stage.squares.size(); ++i) {
        const auto& c = stage.squares[i].corner;
        out << (i ? "," : "") << "{\"name\":\"square" << i << "\",\"role\":\"object\",\"material\":\"square"
            << i << "\",\"points\":[" << json(c[0]) << "," << json(c[1]) << "," << json(c[2]) << ","
            << json(c[3]) << "],\"faceVertexCounts\":[4],\"faceVertexIndices\":[0,1,2,3]}";
    }
    out << "],\"render\":{\"maxDepth\":30,\"fresnel\":" << (stage.fresnel ? "true" : "false") << "}}";
    return out.str();
}

/// POV-Ray's own words: the camera by its vectors, so that its left-handed world does not matter.
std::string scene_pov(const Stage& stage) {
    const Vec3 forward = normalize(stage.at - stage.eye), right = normalize(cross(forward, Vec3(0, 1, 0))),
               up = cross(right, forward);
    const double high = 2 * std::tan(stage.yfov * M_PI / 360);
    std::ostringstream out;
    out.precision(17);
    out << "#version 3.7;\nglobal_settings { assumed_gamma 1.0 max_trace_level 31 adc_bailout 1/10000 "
           "ambient_light 1 }\nbackground { rgb 0 }\n"
        << "camera { perspective location " << pov(stage.eye) << " direction " << pov(forward) << " right "
        << pov(high * kPovrayWidth / kPovrayHeight * right) << " up " << pov(high * up) << " }\n";
    for (const Ball& ball : stage.balls) {
        out << "sphere { " << pov(ball.center) << ", " << ball.radius << " ";
        const std::string fresnel = stage.fresnel ? " reflection { 0, 1 fresnel on } conserve_energy" : "";
        if (ball.ior == 0)
            out << "pigment { rgb 0 } finish { ambient 0 diffuse 0 reflection { 1 } } }\n";
        else
            out << "pigment { rgbf 1 } finish { ambient 0 diffuse 0" << fresnel << " } interior { ior "
                << ball.ior << " } }\n";
    }
    for (const Square& square : stage.squares) {
        const auto& c = square.corner;
        for (const std::array<int, 3>& t : {std::array<int, 3>{0, 1, 2}, {0, 2, 3}})
            out << "triangle { " << pov(c[static_cast<std::size_t>(t[0])]) << ", "
                << pov(c[static_cast<std::size_t>(t[1])]) << ", " << pov(c[static_cast<std::size_t>(t[2])])
                << " pigment { rgb " << pov(square.colour) << " } finish { ambient 1 diffuse 0 } }\n";
    }
    return out.str();
}

/// Linear colours from a binary PPM of 16 bits; empty where it is none.
std::vector<Vec3> read_ppm(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    std::string kind;
    int width = 0, height = 0, most = 0;
    in >> kind >> std::ws;
    while (in.peek() == '#') in.ignore(1 << 16, '\n');
    in >> width >> height >> most;
    in.get();
    if (kind != "P6" || width != kPovrayWidth || height != kPovrayHeight || most != 65535) return {};
    std::vector<Vec3> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (Vec3& pixel : pixels)
        for (int c = 0; c < 3; ++c) {
            const int big = in.get(), small = in.get();
            pixel[c] = (256 * big + small) / 65535.0;
        }
    return in ? pixels : std::vector<Vec3>{};
}

std::vector<Vec3> draw_pov(const Stage& stage, const std::string& name) {
    const std::string folder = scratch_dir("povray_" + name);
    std::ofstream(folder + "/scene.pov") << scene_pov(stage);
    const std::string command = "cd '" + folder + "' && povray -D -GA +Iscene.pov +Oscene.ppm +FP16 +W" +
                                std::to_string(kPovrayWidth) + " +H" + std::to_string(kPovrayHeight) +
                                " -A File_Gamma=1.0 >povray.log 2>&1";
    const int status = std::system(command.c_str());
    INFO("see " << folder << "/povray.log");
    REQUIRE(status == 0);
    return read_ppm(folder + "/scene.ppm");
}

CameraRays shifted_rays(CameraRays camera, const Vec2& by) {
    camera.linear->screen_x += by.x * camera.linear->screen_w;
    camera.linear->screen_y += by.y * camera.linear->screen_w;
    for (Vec3& s : camera.mesh.screen) s += Vec3(by.x * s.z, by.y * s.z, 0);
    return camera;
}

Vec3 beauty(const World& world, const SampleViews& views, std::size_t sample) {
    const SampleColour colour = sample_colour(world, views, views.samples[sample]);
    return colour.direct + colour.reflect + colour.refract;
}

double apart(const Vec3& a, const Vec3& b) {
    const Vec3 d = glm::abs(a - b);
    return std::max({d.x, d.y, d.z});
}

struct Against {
    std::size_t differing = 0, off_edge = 0;
    std::size_t trapped = 0;  // light that goes round in the glass beyond the last optic that is followed
    double worst = 0;         // among pixels that agree
    std::string first;
};

/// Pixels of other colours, and those that stay so when the film is moved by `reach` pixels at most.
Against compare_with_pov(const Stage& stage, const std::string& name, double same, double reach) {
    const std::vector<Vec3> other = draw_pov(stage, name);
    REQUIRE(!other.empty());
    const auto world = world_from("povray_" + name, scene_json(stage), 8);
    SampleViews views;
    make_limit_viewer(*world, make_camera_rays(world->scene, 0))
        ->view({0, 0, kPovrayWidth, kPovrayHeight, 1}, views);
    Against result;
    for (std::size_t p = 0; p < other.size(); ++p) {
        const CutPaths cut = views.samples[p].optic == kNone ? CutPaths() : views.of_optics[p].cut;
        if (of_worst_colour(cut.too_deep) > 0.5) {
            ++result.trapped;
            continue;
        }
        const double left_out = of_worst_colour(cut.faint) + of_worst_colour(cut.too_deep);
        const double off = std::max(0.0, apart(beauty(*world, views, p), other[p]) - left_out);
        if (off <= same) {
            result.worst = std::max(result.worst, off);
            continue;
        }
        ++result.differing;
        const int x = static_cast<int>(p) % kPovrayWidth, y = static_cast<int>(p) / kPovrayWidth;
        bool explained = false;
        for (int k = 0; k < 24 && !explained; ++k) {
            const double far = reach * (k / 8 + 1) / 3.0;
            const Vec2 by(far * std::cos(k * M_PI / 4), far * std::sin(k * M_PI / 4));
            SampleViews one;
            make_limit_viewer(*world, shifted_rays(make_camera_rays(world->scene, 0), by))
                ->view({x, y, x + 1, y + 1, 1}, one);
            explained = apart(beauty(*world, one, 0), other[p]) <= same + left_out;
        }
        if (explained) continue;
        if (result.off_edge++ == 0)
            result.first = std::to_string(x) + "," + std::to_string(y) + " is " +
                           json(beauty(*world, views, p)) + ", with POV-Ray " + json(other[p]);
    }
    std::printf(
        "POV-Ray, %-24s %zu pixels: %zu differ (%.3f %%), %zu off edges, %zu trapped; the others by "
        "%.1e at most\n",
        name.c_str(), other.size(), result.differing,
        100.0 * static_cast<double>(result.differing) / static_cast<double>(other.size()), result.off_edge,
        result.trapped, result.worst);
    std::fflush(stdout);
    return result;
}

/// Of 16 bits; more than a pixel's hundredth is no edge.
constexpr double kSameColour = 2e-5, kEdge = 1e-2;

void check_stage(const Stage& stage, const std::string& name, double same) {
    const Against a = compare_with_pov(stage, name, same, kEdge);
    INFO(a.first);
    CHECK(a.off_edge == 0);
    CHECK(a.differing < kPovrayWidth * kPovrayHeight / 500);
    CHECK(a.trapped < kPovrayWidth * kPovrayHeight / 100);
}

const Ball kGlassBall{{0, 0.1, 0}, 1, 1.5};
const Ball kLeft{{-0.9, 0.2, -0.2}, 0.8}, kRight{{0.95, -0.1, 0.3}, 0.75};

}  // namespace

TEST_CASE("POV-Ray sees the same squares through a glass ball", "[laws][povray][oracle][law]") {
    if (!has_program("povray")) TRILENS_SKIP("needs povray");
    check_stage({{kGlassBall}, povray_room()}, "glass ball", kSameColour);
}

TEST_CASE("POV-Ray sees the same squares in two mirror balls", "[laws][povray][oracle][law]") {
    if (!has_program("povray")) TRILENS_SKIP("needs povray");
    check_stage({{kLeft, kRight}, povray_room()}, "two mirrors", kSameColour);
}

TEST_CASE("POV-Ray sees the same squares through glass in glass", "[laws][povray][oracle][law]") {
    if (!has_program("povray")) TRILENS_SKIP("needs povray");
    Stage stage{{kGlassBall, {{0.15, 0.2, 0.1}, 0.55, 1.2, 1}}, povray_room()};
    check_stage(stage, "water in glass", kSameColour);
    stage.balls[1].ior = 1;  // a bubble
    check_stage(stage, "bubble in glass", kSameColour);
    stage.balls.push_back({{0.2, 0.25, 0.15}, 0.3, 1.8, 2});
    check_stage(stage, "three nested", kSameColour);
}

TEST_CASE("POV-Ray sees the same squares from inside of glass, past other glass and a mirror",
          "[laws][povray][oracle][law]") {
    if (!has_program("povray")) TRILENS_SKIP("needs povray");
    Stage stage{{{{0, 0.1, 0}, 2, 1.5}, {{0.15, 0.2, -0.3}, 0.55, 1.2, 1}, {{-0.9, -0.2, -0.4}, 0.35}},
                povray_room()};
    stage.eye = {0.2, 0.4, 1.4};
    stage.yfov = 70;
    check_stage(stage, "eye in glass", kSameColour);
    stage.balls.erase(stage.balls.begin() + 1);  // POV-Ray's Fresnel knows glass beside air alone
    stage.fresnel = true;
    check_stage(stage, "eye in glass with Fresnel", 1e-3);
}

TEST_CASE("POV-Ray weighs reflection and transmission of a glass ball alike", "[laws][povray][oracle][law]") {
    if (!has_program("povray")) TRILENS_SKIP("needs povray");
    Stage stage{{kGlassBall}, povray_room()};
    stage.fresnel = true;
    check_stage(stage, "glass ball with Fresnel", 1e-3);
}
