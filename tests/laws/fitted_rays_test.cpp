// Laws of fitted corner rays: flat mirrors stay exact, errors get smaller with the same order, and neither
// crops nor threads change a byte.
#include <algorithm>
#include <cmath>

#include "base/util/parallel.h"
#include "laws/worlds.h"
#include "measure/displacement/displacement.h"
#include "render/frame/frame.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const char* const kFittedRoom =
    R"({"name":"floor","role":"object","material":"grey","points":[[-6,-1.5,6],[6,-1.5,6],[6,-1.5,-6],[-6,-1.5,-6]],
       "faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]},
      {"name":"back","role":"object","material":"grey","points":[[-6,-1.5,-6],[6,-1.5,-6],[6,5,-6],[-6,5,-6]],
       "faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]},
      {"name":"front","role":"object","material":"grey","points":[[6,-1.5,6],[-6,-1.5,6],[-6,5,6],[6,5,6]],
       "faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]})";

std::unique_ptr<World> room_with(const std::string& optics, int max_depth, int n) {
    return world_from(
        "fitted",
        R"({"version":1,"film":{"width":200,"height":150},"cameras":[{"lookAt":{"eye":[0.4,0.9,4.2],"at":[0,0,0]}}],
        "materials":[{"name":"grey"},{"name":"chrome","metallicFactor":1},{"name":"glass","transmissionFactor":1}],
        "render":{"maxDepth":)" +
            std::to_string(max_depth) + R"(},"meshes":[)" + optics + "," + kFittedRoom + "]}",
        n);
}

const std::string kTwoPlanes =
    R"({"name":"low","role":"optic","material":"chrome","primitive":{"type":"plane","center":[0,-0.6,0],"normal":[0,1,0.2],"size":[2,2]}},
      {"name":"back","role":"optic","material":"chrome","primitive":{"type":"plane","center":[0,0.2,-1],"normal":[0.1,-0.1,1],"size":[2,1.6]}})";
const std::string kFittedBall =
    R"({"name":"ball","role":"optic","material":"chrome","primitive":{"type":"sphere","radius":1}})";
const std::string kFittedGlassBall =
    R"({"name":"ball","role":"optic","material":"glass","primitive":{"type":"sphere","radius":1}})";

FrameParams with(CornerRays rays) {
    FrameParams frame;
    frame.rays = rays;
    return frame;
}

double difference(const RayMesh& a, const RayMesh& b) {
    REQUIRE(a.rays.size() == b.rays.size());
    double most = 0;
    for (std::size_t c = 0; c < a.rays.size(); ++c) {
        most = std::max(most, length(a.rays[c].origin - b.rays[c].origin));
        most = std::max(most, length(a.rays[c].direction - b.rays[c].direction));
    }
    return most;
}

/// All paths over one optic's facets.
PathBuilder all_paths(const World& world, const Frame& frame, std::size_t optic) {
    auto paths = make_optic_paths(world, frame, optic);
    std::vector<Id> facets(frame.optics[optic].facets->grid().facets.size());
    for (std::size_t f = 0; f < facets.size(); ++f) facets[f] = static_cast<Id>(f);
    paths.prepare(facets);
    return paths;
}

Picture draw_frame(const World& world, const FrameParams& frame, Engine engine,
                   const LayerRequest& window = {}) {
    PictureRequest request;
    request.frame = frame;
    request.engine = engine;
    request.layers = window;
    return draw_picture(world, request, {}, ignore);
}

/// Mean displacement of the layer against the exact surface, pixels.
double mean_error(const World& world, const FrameParams& frame, const Image& truth, const char* layer) {
    const auto found = measure_displacement(truth, draw_frame(world, frame, Engine::kExact).image, layer);
    REQUIRE(found);
    REQUIRE(found->summary);
    return found->summary->mean;
}

/// The channels' bytes in the window.
bool same_in(const Image& whole, const Image& part) {
    for (std::size_t c = 0; c < part.channels.size(); ++c) {
        REQUIRE(whole.channels[c].name == part.channels[c].name);
        const bool ids = part.channels[c].is_id();
        for (int y = 0; y < part.data_height; ++y)
            for (int x = 0; x < part.data_width; ++x) {
                const std::size_t a =
                    static_cast<std::size_t>(y + part.y0) * static_cast<std::size_t>(whole.data_width) +
                    static_cast<std::size_t>(x + part.x0);
                const std::size_t b =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(part.data_width) +
                    static_cast<std::size_t>(x);
                const bool same = ids ? whole.channels[c].ids()[a] == part.channels[c].ids()[b]
                                      : whole.channels[c].floats()[a] == part.channels[c].floats()[b];
                if (!same) return false;
            }
    }
    return true;
}

}  // namespace

TEST_CASE("fitting leaves the rays of flat mirrors as they are, one after the other too", "[laws][law]") {
    const auto one = room_with(kTwoPlanes, 0, 4);
    const Frame exact = make_frame(*one, with(CornerRays::kInterpolated), ignore);
    const Frame fitted = make_frame(*one, with(CornerRays::kFitted), ignore);
    for (std::size_t i = 0; i < 2; ++i)
        CHECK(difference(exact.optics[i].paths[0].mesh, fitted.optics[i].paths[0].mesh) < 1e-12);

    const auto many = room_with(kTwoPlanes, 4, 4);
    const Frame before = make_frame(*many, with(CornerRays::kInterpolated), ignore);
    const Frame after = make_frame(*many, with(CornerRays::kFitted), ignore);
    std::size_t later = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const PathBuilder first = all_paths(*many, before, i), second = all_paths(*many, after, i);
        const OpticPaths &a = first.paths(), &b = second.paths();
        REQUIRE(a.nodes.size() == b.nodes.size());
        REQUIRE(a.leaves.size() == b.leaves.size());
        for (const Id n : nodes_in_order(a)) {
            const PathNode &x = a.nodes[n], &y = b.nodes[n];
            later += x.step_count > 1;
            // Corners of divided facets are numbered apart, so facets are compared, not corners.
            REQUIRE(x.leaves == y.leaves);
            for (std::size_t f = 0; f < x.mesh.facets.size(); ++f) {
                REQUIRE(x.mesh.has_rays(f) == y.mesh.has_rays(f));
                if (!x.mesh.has_rays(f)) continue;
                for (std::size_t k = 0; k < 3; ++k) {
                    const Ray &p = x.mesh.rays[x.mesh.facets[f][k]], &q = y.mesh.rays[y.mesh.facets[f][k]];
                    CHECK(length(p.origin - q.origin) < 1e-12);
                    // Kappa is softened at grazing incidence, so later directions vary in length a little.
                    CHECK(length(p.direction - q.direction) < (x.step_count == 1 ? 1e-12 : 1e-3));
                }
            }
        }
    }
    CHECK(later > 0);
}

TEST_CASE("fitted rays show a ball's mirror image nearer to its place, with order 2", "[laws][law]") {
    const auto world = room_with(kFittedBall, 0, 8);
    const Image truth = draw_frame(*world, {}, Engine::kLimitTruth).image;
    double before = 0;
    for (const int n : {8, 16, 32}) {
        FrameParams frame = with(CornerRays::kInterpolated);
        frame.resolution = n;
        const double interpolated = mean_error(*world, frame, truth, "reflect");
        frame.rays = CornerRays::kFitted;
        const double fitted = mean_error(*world, frame, truth, "reflect");
        CHECK(fitted < interpolated / 2);
        if (before > 0) CHECK(std::log2(before / fitted) > 1.9);
        before = fitted;
    }
}

TEST_CASE("fitted rays show what is behind a glass ball nearer to its place", "[laws][law]") {
    const auto world = room_with(kFittedGlassBall, 4, 8);
    const Image truth = draw_frame(*world, {}, Engine::kLimitTruth).image;
    FrameParams frame = with(CornerRays::kInterpolated);
    frame.resolution = 16;
    const double interpolated = mean_error(*world, frame, truth, "refract");
    frame.rays = CornerRays::kFitted;
    CHECK(mean_error(*world, frame, truth, "refract") < interpolated / 2);
}

TEST_CASE("fitted pictures do not depend on crops or threads", "[laws][law]") {
    for (const int max_depth : {0, 3}) {
        const auto world = room_with(kFittedGlassBall, max_depth, 6);
        LayerRequest window;
        window.layers = layer_names();
        set_thread_count(1);
        const Image whole = draw_frame(*world, with(CornerRays::kFitted), Engine::kExact, window).image;
        set_thread_count(4);
        CHECK(same_in(whole, draw_frame(*world, with(CornerRays::kFitted), Engine::kExact, window).image));
        window.x0 = 80, window.y0 = 55, window.x1 = 120, window.y1 = 90;
        CHECK(same_in(whole, draw_frame(*world, with(CornerRays::kFitted), Engine::kExact, window).image));
        set_thread_count(0);
    }
}

TEST_CASE("fitted rays ask for no facets that nobody sees, nor for those below a pixel", "[laws][law]") {
    // A board hides most of one ball and the whole of another.
    const std::string board =
        R"({"name":"board","role":"object","material":"grey","points":[[-1.2,-1.4,1.5],[0.35,-1.4,1.5],[0.35,2,1.5],[-1.2,2,1.5]],
           "faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]},
          {"name":"hidden","role":"optic","material":"chrome","primitive":{"type":"sphere","center":[-0.5,0,-1.2],"radius":0.3}})";
    const auto world = room_with(kFittedBall + "," + board, 2, 24);
    const auto open = room_with(kFittedBall, 2, 24);
    const auto facets = [&](const World& shown, CornerRays rays, int n) {
        FrameParams frame = with(rays);
        frame.resolution = n;
        return draw_frame(shown, frame, Engine::kExact).statistics.projected_facets;
    };
    const auto fitted = facets(*world, CornerRays::kFitted, 24);
    CHECK(fitted < 1.3 * facets(*world, CornerRays::kInterpolated, 24));
    CHECK(fitted < 0.7 * facets(*open, CornerRays::kFitted, 24));
    CHECK(facets(*open, CornerRays::kFitted, 96) < 1.3 * facets(*open, CornerRays::kInterpolated, 96));

    LayerRequest window;
    window.layers = layer_names();
    const Image whole = draw_frame(*world, with(CornerRays::kFitted), Engine::kExact, window).image;
    window.x0 = 100, window.y0 = 40, window.x1 = 150, window.y1 = 110;
    CHECK(same_in(whole, draw_frame(*world, with(CornerRays::kFitted), Engine::kExact, window).image));
}

TEST_CASE("facets divided for an error keep it, whatever they began with", "[laws][law]") {
    struct Case {
        const std::string& optic;
        int max_depth;
        const char* layer;
    };
    for (const Case& one : {Case{kFittedBall, 0, "reflect"}, Case{kFittedGlassBall, 4, "refract"}}) {
        const auto world = room_with(one.optic, one.max_depth, 4);
        const Image truth = draw_frame(*world, {}, Engine::kLimitTruth).image;
        for (const CornerRays rays : {CornerRays::kInterpolated, CornerRays::kFitted}) {
            FrameParams frame = with(rays);
            const Picture plain = draw_frame(*world, frame, Engine::kExact);
            frame.max_error = 0.5;
            const Picture divided = draw_frame(*world, frame, Engine::kExact);
            const auto before = measure_displacement(truth, plain.image, one.layer);
            const auto after = measure_displacement(truth, divided.image, one.layer);
            REQUIRE((before && before->summary && after && after->summary));
            CHECK(before->summary->p99 > 0.52);
            CHECK(after->summary->p99 <= 0.5);
            CHECK(divided.statistics.predicted_error <= 0.5);
            CHECK(divided.statistics.predicted_error > 0.1);
            CHECK(divided.statistics.projected_facets > plain.statistics.projected_facets);
            CHECK(divided.statistics.traced_pixels < divided.statistics.optic_pixels / 10);
        }
    }
}

TEST_CASE("an error asked for does not depend on crops or threads", "[laws][law]") {
    const auto world = room_with(kFittedGlassBall, 3, 4);
    FrameParams frame;
    frame.max_error = 0.5;
    LayerRequest window;
    window.layers = layer_names();
    set_thread_count(1);
    const Image whole = draw_frame(*world, frame, Engine::kExact, window).image;
    set_thread_count(4);
    window.x0 = 80, window.y0 = 55, window.x1 = 120, window.y1 = 90;
    CHECK(same_in(whole, draw_frame(*world, frame, Engine::kExact, window).image));
    set_thread_count(0);
}

TEST_CASE("a scene that is a thousand times as large looks the same, to the last bit, by parallel rays too",
          "[laws][law][rays]") {
    const auto drawn = [](const std::string& camera, const std::string& grid, double size) {
        const auto at = [size](double x, double y, double z) {
            return "[" + std::to_string(size * x) + "," + std::to_string(size * y) + "," +
                   std::to_string(size * z) + "]";
        };
        const std::string world =
            R"({"version":1,"film":{"width":40,"height":30},"cameras":[{"type":)" + camera +
            (camera == R"("perspective")" ? "" : R"(,"ymag":)" + std::to_string(1.5 * size)) +
            R"(,"lookAt":{"eye":)" + at(0.5, 1, 4) + R"(,"at":)" + at(0, 0, 0) +
            R"(}}],"materials":[{"name":"glass","transmissionFactor":1},{"name":"floor","unlit":true,"baseColorTexture":
            {"pattern":"checker","colors":[[0.1,0.2,0.9],[0.9,0.8,0.1]],"count":[8,8]}}],
            "render":{"maxDepth":3},"meshes":[{"name":"ball","role":"optic","material":"glass","grid":")" +
            grid + R"(","primitive":{"type":"sphere","radius":)" + std::to_string(size) +
            R"(}},{"name":"floor","role":"object","material":"floor","points":[)" + at(-6, -1.5, 6) + "," +
            at(6, -1.5, 6) + "," + at(6, -1.5, -6) + "," + at(-6, -1.5, -6) +
            R"(],"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3],
            "uvs":[[0,0],[1,0],[1,1],[0,1]],"uvIndices":[0,1,2,3]}]})";
        return draw_picture(*world_from("sizes", world, 5), {}, {}, {}).image.find("R")->floats();
    };
    for (const char* const camera : {R"("perspective")", R"("orthographic")", R"("oblique","angle":35)"})
        for (const char* const grid : {"surface", "screen"}) {
            INFO(camera << ", grid " << grid);
            const std::vector<float> small = drawn(camera, grid, 0.125), large = drawn(camera, grid, 128);
            CHECK(small == large);
            CHECK(*std::ranges::max_element(small) > 0.1f);
        }
}
