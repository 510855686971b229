// Warp meshes: the film of a projector as a grid of quadrilaterals, each node with its place in the picture
// that is projected (P. Bourke, "Using a spherical mirror for projection into immersive environments",
// GRAPHITE 2005; his mesh format, read by SGCT, Celestia, Stellarium's and ffmpeg's spheremirror and others).
#pragma once

#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/util/progress.h"
#include "inverse/maps/film_map.h"

namespace trilens {

struct WarpNode {
    Vec2 film{0};           // place on the film, pixels
    Vec2 target{0};         // place on the target's picture, in its pixels
    double intensity = -1;  // 0..1; negative: nothing is drawn there
};

struct WarpMesh {
    int columns = 0, rows = 0;  // nodes
    int film_width = 0, film_height = 0, target_width = 0, target_height = 0;
    std::vector<WarpNode> nodes;  // rows from the film's top

    const WarpNode& at(int x, int y) const {
        return nodes[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(x)];
    }
    std::size_t drawn_count() const;  // nodes with intensity > 0

    /// How far, in target pixels, what is interpolated in the middle of cells lies from exact rays there.
    double error_mean = 0, error_p99 = 0, error_max = 0;
};

struct WarpMeshParams {
    int columns = 0,
        rows = 0;  // nodes; 0: as many as keep error_p99 at max_error, at most kMostWarpColumns wide
    double max_error = 0.5;  // target pixels
};

inline constexpr int kMostWarpColumns = 1025;

/// The mesh of a film whose rays end on a target of directions: request.way is not asked. Nodes lie on the
/// film's border and evenly between. Intensity is the solid angle that the film's pixel covers, over its 95th
/// percentile, at most 1, so that the projected picture is even. Nodes that show nothing beside ones that do
/// go on as their neighbours do, at intensity 0: cells at the optic's rim fade instead of being lost. Throws
/// as make_film_map.
WarpMesh make_warp_mesh(const World& world, const FilmMapRequest& request, const WarpMeshParams& params,
                        const Progress& progress = {});

/// Bourke's format: 2, the numbers of nodes, then x y u v i for each, from the bottom left: x within the
/// film's aspect, y in -1..1, u and v in 0..1 from the picture's lower left.
std::string bourke_mesh(const WarpMesh& mesh);

/// The same as Wavefront OBJ, for SGCT and others: faces where all four nodes are drawn.
std::string obj_mesh(const WarpMesh& mesh);

}  // namespace trilens
