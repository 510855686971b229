// Axes: what --over means is read, all else is refused with its reason; the points that axes span.
#include "sweep/store/axis.h"

#include <string>
#include <vector>

#include "base/util/error.h"
#include "support/test.h"
#include "sweep/plan/plan.h"

using namespace trilens;

namespace {

const AxisKind kResolution{"resolution", "n", "n", ValueKind::kWhole, 1, 1024, true};
const AxisKind kAxisEngine{"engine", "", "engine", ValueKind::kWord, 0, 0, false, {"exact", "classic"}};
const AxisKind kSize{"size", "", "pixels", ValueKind::kSize, 1, 1e9, true, {}, 32768};
const AxisKind kScene{"scene", "", "scene", ValueKind::kText};

Axis parse_axis(const std::string& text, bool keeps_order = false) {
    const AxisRequest request = parse_over(text);
    for (const AxisKind& kind : {kResolution, kAxisEngine, kSize, kScene})
        if (kind.name == request.axis) return make_axis(kind, request, "--over " + text, keeps_order);
    return make_axis(pointer_kind(request.axis), request, "--over " + text, keeps_order);
}

std::vector<double> numbers(const std::string& text) {
    std::vector<double> values;
    for (const AxisValue& value : parse_axis(text).values) values.push_back(value.number.value());
    return values;
}

std::vector<std::string> texts(const std::string& text) {
    std::vector<std::string> values;
    for (const AxisValue& value : parse_axis(text).values) values.push_back(value.text);
    return values;
}

std::vector<std::string> ids(const SweepAxes& axes) {
    std::vector<std::string> all;
    for (const PlannedRun& run : make_plan(axes, [](const Coordinates& point) {
             return RunKeys{point_text(point), "t"};
         }))
        all.push_back(run.id);
    return all;
}

}  // namespace

TEST_CASE("sweep: axes of whole numbers", "[sweep]") {
    using Values = std::vector<double>;
    CHECK(parse_axis("resolution=1,2,4,8").kind.name == "resolution");
    CHECK(numbers("resolution=1,2,4,8") == Values{1, 2, 4, 8});
    CHECK(numbers("resolution=8,1,4") == Values{1, 4, 8});
    CHECK(numbers("resolution=7") == Values{7});
    CHECK(numbers("resolution=1..64:x2") == Values{1, 2, 4, 8, 16, 32, 64});
    CHECK(numbers("resolution=3..50:x3") == Values{3, 9, 27});
    CHECK(numbers("resolution=8..32:+8") == Values{8, 16, 24, 32});
    CHECK(numbers("resolution=8..31:+8") == Values{8, 16, 24});
    CHECK(numbers("resolution=5..5:x2") == Values{5});
    CHECK(numbers("resolution=1,2,4..16:+4,100") == Values{1, 2, 4, 8, 12, 16, 100});
    CHECK(numbers("resolution=1..1024:x1024") == Values{1, 1024});
    CHECK(numbers("resolution=1..1000:+1").size() == 1000);
    CHECK(texts("resolution=1,16") == std::vector<std::string>{"1", "16"});
}

TEST_CASE("sweep: axes of other kinds", "[sweep]") {
    CHECK(texts("engine=classic,exact") == std::vector<std::string>{"classic", "exact"});
    CHECK(numbers("size=64x48,32x24") == std::vector<double>{32 * 24, 64 * 48});
    CHECK(texts("size=64x48,32x24") == std::vector<std::string>{"32x24", "64x48"});
    CHECK(texts("/materials/0/ior=1.3..1.6:+0.1") == std::vector<std::string>{"1.3", "1.4", "1.5", "1.6"});
    CHECK(texts("/materials/0/ior=0.5..4:x2") == std::vector<std::string>{"0.5", "1", "2", "4"});
    CHECK(numbers("/a=-1,-2.5") == std::vector<double>{-2.5, -1});
    CHECK(texts("/cameras/0/lookAt/eye=[1,0,4],[2,0,4]") == std::vector<std::string>{"[1,0,4]", "[2,0,4]"});
    CHECK(texts("/meshes/0/file=\"a,b.obj\",c.obj") == std::vector<std::string>{"\"a,b.obj\"", "c.obj"});
    CHECK(texts("/meshes/0/file=../a.obj,b.obj") == std::vector<std::string>{"../a.obj", "b.obj"});
    CHECK(texts("scene=../a.json,b.json") == std::vector<std::string>{"../a.json", "b.json"});
}

TEST_CASE("sweep: axes that make no sense are refused, and the text is quoted", "[sweep][bad-input]") {
    const std::vector<std::string> bad = {"resolution=",
                                          "resolution=,",
                                          "resolution=1,",
                                          "resolution=1,,2",
                                          "resolution=1;2",
                                          "resolution=one",
                                          "resolution=1.5",
                                          "resolution= 1",
                                          "resolution=0",
                                          "resolution=-4",
                                          "resolution=1025",
                                          "resolution=99999999999",
                                          "resolution=1,2,1",
                                          "resolution=1..8",
                                          "resolution=1..8:",
                                          "resolution=1..8:x",
                                          "resolution=1..8:2",
                                          "resolution=1..8:x1",
                                          "resolution=1..8:x0",
                                          "resolution=1..8:+0",
                                          "resolution=1..8:-1",
                                          "resolution=8..1:x2",
                                          "resolution=..8:x2",
                                          "resolution=1..:x2",
                                          "resolution=1...8:x2",
                                          "resolution=1..8:x2:x2",
                                          "resolution=1..1025:+1",
                                          "engine=exat",
                                          "size=12",
                                          "size=10x32769",
                                          "size=32000x32000"};
    for (const std::string& text : bad) {
        INFO(text);
        REQUIRE_THROWS_AS(parse_axis(text), UsageError);
        try {
            parse_axis(text);
        } catch (const UsageError& error) {
            CHECK(std::string(error.what()).find("--over " + text) == 0);
            CHECK(error.code() == ExitCode::kUsage);
        }
    }
    for (const char* text : {"", "resolution", "=1"}) CHECK_THROWS_AS(parse_over(text), UsageError);
    CHECK_THROWS_AS(make_axis(kResolution, {"resolution", {}}, "here"), UsageError);
}

TEST_CASE("sweep: the product of axes runs through every combination, zipped ones go side by side",
          "[sweep]") {
    SweepAxes axes{{parse_axis("engine=exact,classic"), parse_axis("resolution=1,2,4")}, false};
    CHECK(ids(axes) == std::vector<std::string>{"exact_n0001", "exact_n0002", "exact_n0004", "classic_n0001",
                                                "classic_n0002", "classic_n0004"});
    axes = {{parse_axis("resolution=4,1", true), parse_axis("/materials/0/ior=1.5,1.3", true)}, true};
    CHECK(ids(axes) == std::vector<std::string>{"n0004_ior1.5", "n0001_ior1.3"});
    axes.axes[0] = parse_axis("resolution=1,2,4");
    CHECK_THROWS_AS(make_points(axes), UsageError);
    axes = {{parse_axis("resolution=1"), parse_axis("resolution=2")}, false};
    CHECK_THROWS_AS(make_points(axes), UsageError);
    axes = {{parse_axis("/a=1..1000:+1"), parse_axis("/b=1..1000:+1")}, false};
    CHECK_THROWS_AS(make_points(axes), UsageError);
}

TEST_CASE("sweep: two points of one name are refused with both of them", "[sweep][bad-input]") {
    const SweepAxes scenes{{parse_axis("scene=a/room.json,b/room.json")}, false};
    try {
        ids(scenes);
        FAIL("two scenes of one name are a plan");
    } catch (const UsageError& error) {
        const std::string message = error.what();
        CHECK(message.find("room") != std::string::npos);
        CHECK(message.find("a/room.json") != std::string::npos);
        CHECK(message.find("b/room.json") != std::string::npos);
    }
    const SweepAxes twice{{parse_axis("resolution=4,4", true), parse_axis("/b=1,1", true)}, true};
    CHECK_THROWS_AS(ids(twice), UsageError);
}

TEST_CASE("sweep: names of runs are names of files, whatever the values hold", "[sweep][law]") {
    const SweepAxes axes{{parse_axis("/meshes/0/file=../a b.obj,/etc/passwd,..")}, false};
    for (const std::string& id : ids(axes)) {
        INFO(id);
        CHECK(id.find_first_of("/ \n\"") == std::string::npos);
        CHECK(id[0] != '.');
    }
    const SweepAxes dots{{parse_axis("scene=..,.")}, false};
    for (const Coordinates& point : make_points(dots)) CHECK(point_id(dots, point)[0] != '.');
    const SweepAxes long_one{{parse_axis("/a=" + std::string(500, 'x'))}, false};
    CHECK(ids(long_one)[0].size() <= 100);
}
