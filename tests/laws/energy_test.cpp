// Where everything around is white and nothing absorbs, every pixel is white but for what the picture says it
// left out, and no share of light that is left out is more than all of it.
#include <algorithm>
#include <string>

#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kFloat = 1e-6;  // pixels are floats

const std::string kBeside = R"("film":{"width":96,"height":72},"background":{"color":[1,1,1]},"version":1,)";

/// A ball that lies half across the film's middle.
const std::string kGlassBallScene =
    "{" + kBeside +
    R"("cameras":[{"name":"main","yfov":66.9,"lookAt":{"eye":[3.0347,1,2.2893],"at":[2.0231,1,1.5262],"up":[0,1,0]}}],
    "materials":[{"name":"glass","transmissionFactor":1,"ior":1.351}],
    "meshes":[{"name":"ball","role":"optic","material":"glass","primitive":{"type":"sphere","center":[0,0,0],"radius":1}}],
    "render":{"maxDepth":32}})";

std::string glass_box(const std::string& material, const std::string& creases) {
    return R"("materials":[{"name":"glass","transmissionFactor":1,)" + material +
           R"(}],"meshes":[{"name":"box","role":"optic","material":"glass","points":[[-0.75,-0.75,-0.75],[-0.75,-0.75,0.75],
    [-0.75,0.75,-0.75],[-0.75,0.75,0.75],[0.75,-0.75,-0.75],[0.75,-0.75,0.75],[0.75,0.75,-0.75],[0.75,0.75,0.75]],
    "faceVertexCounts":[4,4,4,4,4,4],"faceVertexIndices":[0,1,3,2,4,6,7,5,0,4,5,1,2,3,7,6,0,2,6,4,1,5,7,3])" +
           creases + "}]";
}

/// From inside of a box with round and sharp edges, by rays through two slits.
const std::string kInBox = "{" + kBeside +
                           R"("cameras":[{"name":"main","type":"generalLinear","facets":64,
    "lookAt":{"eye":[-0.0405,0.1389,-0.1248],"at":[-0.4023,0.2042,0.7982],"up":[0,1,0]},"rays":[
    {"point":[0.4322,0.4383,0.0393],"direction":[1.1473,0.6876,1.4775],"screen":[0,0]},
    {"point":[-0.4988,0.4383,-0.3257],"direction":[-0.94,0.5605,0.6683],"screen":[1,0]},
    {"point":[-0.0477,-0.1604,-0.1065],"direction":[-0.1192,-0.8187,1.0876],"screen":[0.5,1]}]}],)" +
                           glass_box(R"("ior":1.8)",
                                     R"(,"creaseIndices":[1,3],"creaseLengths":[2],"creaseSharpnesses":[10],
    "cornerIndices":[3,4,1],"cornerSharpnesses":[10,10,2.2])") +
                           R"(,"render":{"maxDepth":16}})";

/// A box that parts the colours, and holds most of its light back for long.
const std::string kColours =
    "{" + kBeside +
    R"("cameras":[{"name":"main","yfov":30,"lookAt":{"eye":[1.1,1.9,3.5],"at":[0,0,0],"up":[0,1,0]}}],)" +
    glass_box(R"("ior":2.2,"dispersion":2)", R"(,"subdivisionScheme":"bilinear")") +
    R"(,"render":{"maxDepth":2}})";

void say_nothing(const std::string&) {}

/// Its statistics.
LayerStatistics check_energy(const std::string& name, const std::string& scene, int n, Engine engine) {
    INFO(name << ", n = " << n << ", " << engine_name(engine));
    const auto world = world_from(name, scene, n);
    PictureRequest request;
    request.engine = engine;
    const Picture picture = draw_picture(*world, request, {}, say_nothing);
    const LayerStatistics& statistics = picture.statistics;
    CHECK(statistics.optic_pixels > 400);
    double least = 1, most = 0;
    for (const char* name_of_channel : {"R", "G", "B"})
        for (const float value : picture.image.find(name_of_channel)->floats()) {
            least = std::min(least, static_cast<double>(value));
            most = std::max(most, static_cast<double>(value));
        }
    CHECK(most <= 1 + kFloat);
    CHECK(least >= 1 - statistics.faint_light - kFloat);
    CHECK(statistics.deep_light <= 1 + kFloat);
    CHECK(statistics.faint_light < 0.05);
    return statistics;
}

}  // namespace

TEST_CASE("in a white room every pixel is white, but for what the picture says is left out", "[laws][law]") {
    for (const int n : {1, 8})
        for (const Engine engine : {Engine::kExact, Engine::kFacetsTruth, Engine::kLimitTruth}) {
            check_energy("ball", kGlassBallScene, n, engine);
            check_energy("in a box", kInBox, n, engine);
        }
}

TEST_CASE("in a white room every pixel is white, through few facets and many", "[.long][laws][law]") {
    for (const int n : {2, 32}) {
        check_energy("ball", kGlassBallScene, n, Engine::kExact);
        check_energy("in a box", kInBox, n, Engine::kExact);
    }
}

TEST_CASE("light that is left out is a share of each colour, not their sum", "[laws][law]") {
    for (const Engine engine : {Engine::kExact, Engine::kLimitTruth}) {
        const LayerStatistics left = check_energy("colours", kColours, 8, engine);
        CHECK(left.deep_light > 0.6);  // so that three colours' sum would be more than all
    }
}
