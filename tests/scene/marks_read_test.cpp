// Point clouds and labels out of scene files: every form of a cloud, and what is refused.
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "base/math/srgb.h"
#include "base/util/error.h"
#include "scene/data/scene_digest.h"
#include "scene/samples/point_cloud.h"
#include "scene/scene_text.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string with_marks(const std::string& marks) {
    return R"({"version": 1, "cameras": [{"yfov": 40, "lookAt": {"eye": [0, 1, 4], "at": [0, 0, 0]}}],)" +
           marks + "}";
}

std::string marks_refusal(const std::string& marks) {
    return error_of(with_marks(marks));
}

template <typename T>
void append(std::string& bytes, T value, bool big) {
    std::string own(sizeof value, '\0');
    std::memcpy(own.data(), &value, sizeof value);
    if (big == (std::endian::native == std::endian::little)) own.assign(own.rbegin(), own.rend());
    bytes += own;
}

struct CloudPoint {
    std::array<float, 3> at;
    std::array<std::uint8_t, 3> color;
};

std::vector<CloudPoint> random_points(std::size_t count) {
    Draw draw(3);
    std::vector<CloudPoint> points(count);
    for (CloudPoint& point : points)
        for (std::size_t k = 0; k < 3; ++k) {
            point.at[k] = static_cast<float>(draw.uniform(-2, 2) * draw.log_uniform(1e-6, 1e6));
            point.color[k] = static_cast<std::uint8_t>(draw.uniform(0, 256));
        }
    return points;
}

/// A file with an element and properties around the points that readers must pass over.
std::string ply_of(const std::vector<CloudPoint>& points, const std::string& format) {
    const bool ascii = format == "ascii", big = format == "binary_big_endian";
    std::string bytes =
        "ply\nformat " + format +
        " 1.0\ncomment made in a test\nelement camera 1\nproperty double focus\nproperty list uchar int "
        "marks\nelement vertex " +
        std::to_string(points.size()) +
        "\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float32 x\nproperty "
        "float y\nproperty list ushort short extra\nproperty float z\nend_header\n";
    if (ascii) {
        bytes += "2.5 2 7 8\n";
    } else {
        append(bytes, 2.5, big);
        append(bytes, std::uint8_t{2}, big);
        append(bytes, std::int32_t{7}, big);
        append(bytes, std::int32_t{8}, big);
    }
    for (const CloudPoint& point : points) {
        if (ascii) {
            char line[200];
            std::snprintf(line, sizeof line, "%d %d %d %.17g %.17g 1 -3 %.17g\n", point.color[0],
                          point.color[1], point.color[2], static_cast<double>(point.at[0]),
                          static_cast<double>(point.at[1]), static_cast<double>(point.at[2]));
            bytes += line;
            continue;
        }
        for (const std::uint8_t one : point.color) append(bytes, one, big);
        append(bytes, point.at[0], big);
        append(bytes, point.at[1], big);
        append(bytes, std::uint16_t{1}, big);
        append(bytes, std::int16_t{-3}, big);
        append(bytes, point.at[2], big);
    }
    return bytes;
}

std::string ply_fault(const std::string& bytes) {
    try {
        parse_ply(bytes, "cloud.ply");
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

}  // namespace

TEST_CASE("a PLY has the same points and colours in each of its three forms", "[scene][points]") {
    const std::vector<CloudPoint> points = random_points(200);
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        INFO(format);
        const ColoredPoints read = parse_ply(ply_of(points, format), "cloud.ply");
        REQUIRE(read.points.size() == points.size());
        REQUIRE(read.colors.size() == points.size());
        std::size_t differing = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const auto c = static_cast<std::size_t>(k);
                differing += read.points[i][k] != static_cast<double>(points[i].at[c]);
                differing += read.colors[i][k] != linear_from_srgb(points[i].color[c] / 255.0);
            }
        CHECK(differing == 0);
    }
}

TEST_CASE("a PLY that ends early, lies or is none is refused", "[scene][points]") {
    for (const char* format : {"ascii", "binary_little_endian"}) {
        const std::string whole = ply_of(random_points(5), format);
        const std::size_t header = whole.find("end_header");
        for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
            // The last number of a text may lose digits and stay one.
            if (format[0] == 'a' && whole.find('\n', size) == whole.size() - 1 &&
                size > whole.find_last_of(' ') + 1)
                continue;
            if (size > header && size < header + 10) continue;
            CAPTURE(format, size);
            CHECK(ply_fault(whole.substr(0, size)) != "");
        }
    }
    const std::string head = "ply\nformat ascii 1.0\n";
    CHECK(contains(ply_fault("# points\n1 2 3\n"), "line 1: is no PLY file"));
    CHECK(contains(ply_fault("ply\nformat ascii 2.0\n"), "line 2: the format is none of"));
    CHECK(contains(
        ply_fault(head + "element vertex 4000000000\nproperty float x\nproperty float y\nproperty float "
                         "z\nend_header\n1 2 3\n"),
        "more than 20000000"));
    CHECK(contains(
        ply_fault(head + "element vertex 9000000\nproperty float x\nproperty float y\nproperty float "
                         "z\nend_header\n1 2 3\n"),
        "ends before"));
    CHECK(
        contains(ply_fault(head + "element vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n"),
                 "no x, y and z"));
    CHECK(contains(ply_fault(head + "element face 0\nproperty float x\nend_header\n"), "no element vertex"));
    CHECK(contains(ply_fault(head + "element vertex 1\nproperty floot x\n"), "line 4: 'floot' is no type"));
    CHECK(contains(ply_fault(head + "property float x\n"), "before any element"));
    CHECK(contains(ply_fault(head + "element vertex 1\nproperty float x\nproperty float y\nproperty float "
                                    "z\nend_header\n1 nan 3\n"),
                   "vertex 0 has a coordinate that is no number"));
    CHECK(contains(ply_fault(head + "element vertex 1\nproperty list float int x\n"), "no type that counts"));
    const auto colored = [&](const std::string& type, const std::string& red) {
        std::string text = head + "element vertex 1\n";
        for (const char* name : {"x", "y", "z"}) text += std::string("property float ") + name + "\n";
        for (const char* name : {"red", "green", "blue"}) text += "property " + type + " " + name + "\n";
        return text + "end_header\n1 2 3\n" + red + " 1 1\n";
    };
    CHECK(ply_fault(colored("uchar", "255")) == "");
    CHECK(ply_fault(colored("float", "300")) == "");
    for (const char* red : {"256", "300", "-1", "0.5"})
        CHECK(contains(ply_fault(colored("uchar", red)),
                       "cloud.ply: line 11: '" + std::string(red) + "' is no uchar"));
    CHECK(contains(ply_fault(colored("uint16", "65536")), "line 11: '65536' is no ushort"));
    CHECK(contains(ply_fault(colored("char", "100")), "'red' is char: colours are uchar, ushort, float"));
}

TEST_CASE("clouds come inline, as text with and without colours, and as PLY, and are moved",
          "[scene][points]") {
    const std::string folder = scratch_dir("marks_read");
    std::ofstream(folder + "/plain.csv") << "x,y,z\n1,2,3\n-4, 5, 6.5\n";
    std::ofstream(folder + "/colored.csv") << "# seen\n1,2,3,0.5,0.25,1\n-4,5,6.5,0,0,2\n";
    std::ofstream(folder + "/cloud.ply", std::ios::binary)
        << ply_of(random_points(7), "binary_little_endian");
    const Scene scene = load_text(with_marks(R"("points": [
        {"at": [[1, 2, 3]], "radius": 0.5, "transform": {"translate": [10, 0, 0], "scale": [2, 2, 2]}},
        {"name": "plain", "file": "plain.csv", "size": 4, "color": [1, 0, 0]},
        {"file": "colored.csv", "minWeight": 0.25}, {"file": "cloud.ply"}],
        "labels": [{"text": "here", "at": [1, 2, 3], "size": 20, "offset": [3, -4], "dot": 0}])"),
                                  {}, folder + "/scene.json");
    REQUIRE(scene.points.size() == 4);
    CHECK(scene.points[0].places == std::vector<Vec3>{{12, 4, 6}});
    CHECK(scene.points[0].radius == 0.5);
    CHECK(scene.points[0].name == "points 0");
    CHECK(scene.points[1].places == std::vector<Vec3>{{1, 2, 3}, {-4, 5, 6.5}});
    CHECK(scene.points[1].colors.empty());
    CHECK(scene.points[1].size == 4);
    CHECK(scene.points[2].colors == std::vector<Vec3>{{0.5, 0.25, 1}, {0, 0, 2}});
    CHECK(scene.points[2].min_weight == 0.25);
    CHECK(scene.points[3].places.size() == 7);
    CHECK(scene.points[3].colors.size() == 7);
    CHECK(scene.files.size() == 3);
    REQUIRE(scene.labels.size() == 1);
    CHECK(scene.labels[0].style.text == "here");
    CHECK(scene.labels[0].style.size == 20);
    CHECK(scene.labels[0].offset == Vec2(3, -4));
    CHECK(scene.labels[0].letters == nullptr);  // nobody draws letters in this room
}

TEST_CASE("clouds and labels that are none are refused with their place", "[scene][points]") {
    CHECK(contains(marks_refusal(R"("points": [{}])"), "/points/0"));
    CHECK(contains(marks_refusal(R"("points": [{"at": []}])"), "/points/0/at"));
    CHECK(contains(marks_refusal(R"("points": [{"at": [[0,0,0]], "file": "a.ply"}])"), "/points/0"));
    CHECK(contains(marks_refusal(R"("points": [{"at": [[0,0,0]], "radius": 1, "size": 3}])"),
                   "/points/0/size"));
    CHECK(contains(marks_refusal(R"("points": [{"at": [[0,0,0]], "radius": 0}])"), "/points/0/radius"));
    CHECK(contains(marks_refusal(R"("points": [{"at": [[1e30,0,0]], "transform": {"scale": [10,1,1]}}])"),
                   "/points/0/transform: carries points"));
    CHECK(contains(marks_refusal(R"("points": [{"file": "nowhere.ply"}])"), "nowhere.ply"));
    CHECK(contains(marks_refusal(R"("labels": [{"text": "", "at": [0,0,0]}])"), "/labels/0/text"));
    CHECK(contains(marks_refusal(R"("labels": [{"text": "a"}])"), "/labels/0"));
    CHECK(contains(marks_refusal(R"("labels": [{"text": "a", "at": [0,0,0], "size": 1000}])"),
                   "/labels/0/size"));
    for (const std::string offset : {"[1.1e6, 0]", "[0, 1, 2]", "[0]"})
        CHECK(contains(marks_refusal(R"("labels": [{"text": "a", "at": [0,0,0], "offset": )" + offset + "}]"),
                       "/labels/0/offset"));
    CHECK(marks_refusal(R"("labels": [{"text": "a", "at": [0,0,0], "offset": [-1e6, 1e6]}])").empty());
    const std::string folder = scratch_dir("marks_refused");
    std::ofstream(folder + "/five.csv") << "1,2,3,4,5\n";
    std::ofstream(folder + "/dark.csv") << "1,2,3,4,5,6\n1,2,3,-1,0,0\n";
    CHECK(contains(marks_refusal(R"("points": [{"file": ")" + folder + R"(/five.csv"}])"),
                   "line 1: needs x,y,z"));
    CHECK(contains(marks_refusal(R"("points": [{"file": ")" + folder + R"(/dark.csv"}])"),
                   "point 1 has a negative"));
}

TEST_CASE("marks change a scene's digest, and scenes without any keep theirs", "[scene][points]") {
    const auto digest = [](const std::string& marks) { return scene_digest(load_text(with_marks(marks))); };
    const std::string none = digest(R"("lights": [])");
    CHECK(digest(R"("points": [], "labels": [])") == none);
    const std::string one = digest(R"("points": [{"at": [[0, 0, 0]]}])");
    CHECK(one != none);
    CHECK(digest(R"("points": [{"at": [[0, 0, 0.5]]}])") != one);
    CHECK(digest(R"("points": [{"at": [[0, 0, 0]], "radius": 0.1}])") != one);
    CHECK(digest(R"("labels": [{"text": "a", "at": [0, 0, 0]}])") !=
          digest(R"("labels": [{"text": "b", "at": [0, 0, 0]}])"));
}
