// The distance to an optic in a pixel whose path is traced: the truth's.
#include <cmath>
#include <string>
#include <vector>

#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;
using trilens_test::source_dir;

TEST_CASE("a pixel that is traced tells the truth's distance to the optic", "[laws][render][law]") {
    const std::vector<CameraKind> cameras{PerspectiveCamera{.yfov = 25, .near_depth = 0.5},
                                          OrthographicCamera{.ymag = 1.5}, FisheyeCamera{.fov = 60},
                                          SphericalCamera{}};
    for (std::size_t k = 0; k < cameras.size(); ++k) {
        Scene scene = load_scene(SceneRequest{source_dir() + "/scenes/paths/meniscus.json", {}, 6});
        scene.film = {80, 60, 1};
        scene.cameras.front().kind = cameras[k];
        const Renderer renderer(scene);
        PictureRequest request;
        request.layers.layers = {"Z", "stat", "optic"};
        const Image picture = renderer.draw(request).image;
        request.engine = Engine::kLimitTruth;
        const Image truth = renderer.draw(request).image;
        const std::vector<Id>& method = picture.find("stat.method")->ids();
        std::size_t traced = 0, off = 0;
        double farthest = 0;
        for (std::size_t p = 0; p < method.size(); ++p) {
            if (method[p] != 2) continue;
            const double here = picture.find("Z")->floats()[p], there = truth.find("Z")->floats()[p];
            ++traced, off += !(std::fabs(here - there) <= 1e-6 * there);
            farthest = std::max(farthest, std::fabs(here - there) / there);
        }
        INFO("camera " << k << ": " << off << " of " << traced << " off, by up to " << farthest);
        REQUIRE(traced > 5);
        CHECK(off == 0);
    }
}
