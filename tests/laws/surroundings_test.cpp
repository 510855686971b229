// A camera in glass: other glass around it is told of, by truth and projector alike.
#include "laws/worlds.h"
#include "render/engine.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string balls(const std::string& eye, bool two) {
    return R"({"version":1,"film":{"width":16,"height":12},"cameras":[{"name":"main","yfov":50,"lookAt":{"eye":[)" +
           eye +
           R"(],"at":[0,0,0],"up":[0,1,0]}}],"materials":[{"name":"glass","transmissionFactor":1,"ior":1.5}],"meshes":[
             {"name":"big","role":"optic","material":"glass","primitive":{"type":"sphere","center":[0,0,0],"radius":2}})" +
           (two ? R"(,{"name":"small","role":"optic","material":"glass","priority":1,"primitive":{"type":"sphere","center":[0,0,-0.5],"radius":0.5}})"
                : "") +
           "]}";
}

std::vector<std::string> said(const std::string& scene, Engine engine) {
    const auto world = world_from("surroundings", scene, 2);
    std::vector<std::string> all;
    make_viewer(*world, {}, engine, [&](const std::string& message) {
        if (message.find("inside of") != std::string::npos) all.push_back(message);
    });
    return all;
}

}  // namespace

TEST_CASE("a camera inside of glass with other glass in it is told of", "[laws]") {
    for (const Engine engine : {Engine::kExact, Engine::kLimitTruth}) {
        const std::vector<std::string> inside = said(balls("0,0,1.5", true), engine);
        REQUIRE(inside.size() == 1);
        CHECK(inside[0] == "the camera is inside of big: other glass in it is drawn as if it stood in air");
        CHECK(said(balls("0,0,5", true), engine).empty());
        CHECK(said(balls("0,0,1.5", false), engine).empty());
    }
}
