// Optics are drawn where on the film they can be seen and nowhere else: nothing of them is lost.
#include "render/frame/frame.h"

#include <atomic>
#include <cstring>

#include "base/raymesh/rasterize.h"
#include "laws/worlds.h"
#include "projector/projector.h"
#include "render/engines/engine.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kWindowWidth = 96, kWindowHeight = 72, kFacets = 3;

std::vector<Hit> facets_seen(const FramedOptic& optic, const RayMesh& camera, const SampleGrid& grid) {
    std::vector<Hit> hits(grid.size());
    draw(optic.facets->prepared(), camera, rasterize_facets(camera, grid), grid, hits);
    return hits;
}

bool same_bits(const Hit& a, const Hit& b) {
    return a.triangle == b.triangle && std::memcmp(&a.t, &b.t, sizeof a.t) == 0 &&
           std::memcmp(&a.barycentric, &b.barycentric, sizeof a.barycentric) == 0;
}

Frame window_frame(const World& world) {
    return make_frame(world, FrameParams(), [](const std::string&) {});
}

/// A ball of that radius before a camera of the scene format.
std::unique_ptr<World> ball(const std::string& radius, const std::string& camera) {
    return world_from("ball",
                      R"({"version": 1, "film": {"width": 96, "height": 72},
        "cameras": [)" + camera +
                          R"(],
        "materials": [{"name": "chrome", "metallicFactor": 1}],
        "meshes": [{"name": "ball", "role": "optic", "material": "chrome", "resolution": 3,
                    "primitive": {"type": "sphere", "center": [0, 0, 0], "radius": )" +
                          radius + R"(}}]})",
                      kFacets);
}

const std::string kEyeAtFour =
    R"({"name": "eye", "type": "perspective", "yfov": 40, "lookAt": {"eye": [0.5, 0, 4], "at": [0.5, 0, 0]}})";

}  // namespace

TEST_CASE("an optic's window holds all samples that meet its facets, with the same hits", "[laws][law]") {
    for (const std::string& name : shipped_scenes()) {
        CAPTURE(name);
        const auto world = shipped_world(name, kFacets, kWindowWidth, kWindowHeight);
        if (!world) continue;
        const Frame frame = window_frame(*world);
        for (const int side : {1, 2}) {
            const SampleGrid whole{0, 0, kWindowWidth, kWindowHeight, side}, inner{7, 11, 71, 43, side};
            for (const FramedOptic& optic : frame.optics) {
                const SampleGrid window = optic_window(optic, frame.camera);
                const std::vector<Hit> all = facets_seen(optic, frame.camera.mesh, whole);
                std::vector<bool> in_window(all.size());
                for (const SampleGrid& grid : {whole, inner}) {
                    const SampleGrid part = part_in(grid, window);
                    if (part.size() == 0) continue;
                    const std::vector<Hit> hits = facets_seen(optic, frame.camera.mesh, part);
                    for (std::size_t s = 0; s < hits.size(); ++s) {
                        const std::size_t of_whole = part.sample_in(whole, s);
                        in_window[of_whole] = true;
                        REQUIRE(part.position(s) == whole.position(of_whole));
                        REQUIRE(same_bits(hits[s], all[of_whole]));
                    }
                }
                for (std::size_t s = 0; s < all.size(); ++s)
                    if (!in_window[s]) REQUIRE_FALSE(all[s].seen());
            }
        }
    }
}

TEST_CASE("a viewer that nobody wants any more stops, while it is made and while it shows", "[laws]") {
    const auto world = ball("1", kEyeAtFour);
    std::atomic<bool> cancel = true;
    const ViewerCallbacks callbacks{ignore, &cancel};
    CHECK_THROWS_AS(make_viewer(*world, {}, Engine::kExact, callbacks), Interrupted);
    cancel = false;
    const auto viewer = make_viewer(*world, {}, Engine::kExact, callbacks);
    const SampleGrid grid{0, 0, kWindowWidth, kWindowHeight, 1};
    SampleViews views;
    viewer->view(grid, views);
    CHECK(!views.samples.empty());
    cancel = true;
    CHECK_THROWS_AS(viewer->view(grid, views), Interrupted);
}

TEST_CASE("an optic's window is about as large as the optic looks, or all of the film", "[laws][law]") {
    const auto window_of = [](const World& world) {
        const Frame frame = window_frame(world);
        return optic_window(frame.optics.at(0), frame.camera);
    };
    // A pixel is 0.0404 wide at the ball, whose middle lies 12.4 pixels to the left of the film's.
    const SampleGrid small = window_of(*ball("0.2", kEyeAtFour));
    CHECK((small.x0 >= 28 && small.x1 <= 43 && small.y0 >= 29 && small.y1 <= 43));
    CHECK((small.x0 <= 31 && small.x1 >= 40 && small.y0 <= 32 && small.y1 >= 40));
    CHECK(small.side == 1);
    CHECK(window_of(*ball("9", kEyeAtFour)).pixels() == 96 * 72);  // the eye is inside
    const SampleGrid aside = window_of(*ball("0.2", R"({"name": "eye", "type": "perspective", "yfov": 40,
                   "lookAt": {"eye": [9, 0, 4], "at": [9, 0, 0]}})"));
    CHECK(aside.pixels() == 0);
    CHECK(part_in({0, 16, 96, 32, 2}, aside).size() == 0);
}
