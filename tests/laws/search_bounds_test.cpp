// A search has an end, however far the surface reaches: what it holds is bounded, and it says what it left.
#include <vector>

#include "image/image_io.h"
#include "laws/worlds.h"
#include "render/frame/camera_rays.h"
#include "render/project/path_images.h"
#include "render/project/project.h"
#include "scene/load.h"
#include "specular/batch_search.h"
#include "specular/cell_bvh.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE(
    "a cage with a vertex far away is searched with bounded memory, and the answer says that it may miss",
    "[laws][law]") {
    constexpr std::size_t kLargestTree = 1u << 16, kOfWalks = 2 * SearchLimits().most_cells;
    const std::vector<SceneOverride> far{{"/meshes/0/points/20/0", "-441.71"}};
    const auto world = make_world(
        load_scene(source_dir() + "/scenes/paths/plano-convex.json", far, {read_texture, decode_texture}),
        ignore);
    const Surface& lens = *world->optics[0].surface;
    const std::vector<Vec3> points{{0, -0.5, 0.1}, {0.2, -0.4, 0}, {-0.1, 0, 0.3}, {0.1, 0.1, -0.2}};

    SpecularQuery query = specular_query(*world, make_frame(*world, {0, 4}, {}), 0, Path::kRefract);
    const CellBvh cells(lens);
    for (const ViewedSide side : {ViewedSide::kFront, ViewedSide::kBack}) {
        query.viewed = side;
        BatchSearch batch(lens, cells, query, SearchLimits());
        batch.run(points);
        CHECK(batch.node_count() <= kLargestTree + kOfWalks);
    }
}
