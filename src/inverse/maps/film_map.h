// Maps between a film and a target, pixel by pixel, both ways: what warps a picture of one into one of the
// other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/math/vec.h"
#include "base/util/error.h"
#include "base/util/names.h"
#include "inverse/maps/target.h"
#include "paths/trace/path.h"
#include "render/frame/request.h"
#include "render/shoot/shoot.h"

namespace trilens {

struct World;

/// kUnwrap: a map of the target's size with places on the film: it warps photographs into the target. kView:
/// a map of the film's size with places on the target: it warps pictures of the target into what the camera
/// sees.
enum class MapWay { kUnwrap, kView };

template <>
struct EnumNames<MapWay> {
    static constexpr std::array kTable{NamedValue<MapWay>{MapWay::kUnwrap, "unwrap"},
                                       NamedValue<MapWay>{MapWay::kView, "view"}};
};

/// Which places of a target a film shows, over what, and how exactly they are found.
struct TargetRequest {
    TargetDescription target;
    ProxyDescription proxy;            // of targets of directions
    std::optional<Vec3> center;        // of these: where directions start; none: the middle of the optic
    std::optional<std::size_t> optic;  // index into World::optics; none: any
    std::optional<Path> path;          // not of views; none: reflected by mirrors, refracted by glass
    double tolerance = 0.01;           // pixels of the source that interpolated places may be off; of a
                                       // view, the lattice that its derivatives are read from
    FrameParams frame;
};

/// Throws UsageError for an optic that there is not, and a tolerance that is not positive.
void check_target_request(const World& world, const TargetRequest& request);

struct FilmMapRequest : TargetRequest {
    MapWay way = MapWay::kUnwrap;
    EventWord word = {};  // of views alone, instead of the path; asks for nothing: where most light goes
};

/// One map: per pixel of the warped picture, rows from the top, where it is taken from.
struct FilmMap {
    int width = 0, height = 0;                // of the warped picture
    int source_width = 0, source_height = 0;  // of the picture that is warped
    std::vector<float> x, y;  // pixels from the source's top left, a pixel's centre at .5; -1 where none
    std::vector<float> jacobian[4];  // dx/dx, dx/dy, dy/dx, dy/dy: source pixels per pixel
    std::vector<unsigned char> valid;
    std::size_t exact_places = 0;  // of a view, all
    double worst_accepted = 0;     // source pixels that the lattice was found to be off between exact places

    std::size_t valid_count() const;
};

/// A view has exactly the pixels whose rays, as shoot_places follows them through their middles, show the
/// target, and the places that these end at. Of an unwrap, where a place is seen several times, the best
/// resolved image is taken. Throws UsageError for what the
/// scene does not have, a path of a view and a word of an unwrap, InputError where nothing is mapped;
/// Interrupted.
FilmMap make_film_map(const World& world, const FilmMapRequest& request, const Progress& progress = {});

/// Pixels between the first exact places: fewer where objects may hide what is seen, of any shape.
int first_cell(bool visibility);

/// The centre of directions: as asked, or the middle of the optics (of one, where that is asked for).
Vec3 center_of_directions(const World& world, const std::optional<Vec3>& asked,
                          const std::optional<std::size_t>& optic);

// Maps as other programs take them: STMap images, OpenCV's remap arrays, ffmpeg's pairs of 16-bit PGM.

/// An STMap: R and G are where to look, 0..1 over the source's width and height from its top left (`t_up`: G
/// from its bottom, as Nuke has it), -1 where nothing is; B is 0; A is 1 where something is; jacobian.XX,
/// .XY, .YX, .YY are source pixels per pixel (dx/dx, dx/dy, dy/dx, dy/dy). `oiiotool
/// photo.exr --crop WxH+0+0 map.exr --st_warp` warps by it, WxH the map's size.
Image stmap_of(const FilmMap& map, bool t_up = false);

/// A numpy archive (.npz, stored): map_x and map_y, float32, for cv2.remap (a pixel's centre at whole
/// numbers; -1 where nothing is), and valid, uint8.
std::vector<unsigned char> npz_of(const FilmMap& map);

/// One of the two PGM files (16 bit) of ffmpeg's filter remap: the source's column (or row) for each pixel;
/// 65535 where nothing is. Throws InputError for sources beyond 65535 pixels.
enum class MapAxis { kX, kY };
std::vector<unsigned char> pgm_of(const FilmMap& map, MapAxis axis);

/// "map.pgm" -> "map_x.pgm" or "map_y.pgm".
std::string pgm_name(const std::string& file, MapAxis axis);

// Warp meshes: the film of a projector as a grid of quadrilaterals, each node with its place in the picture
// that is projected (P. Bourke, "Using a spherical mirror for projection into immersive environments",
// GRAPHITE 2005; his mesh format, read by SGCT, Celestia, Stellarium's and ffmpeg's spheremirror and others).

/// Where the nodes of a mesh are regular. kFilm: on the film, in columns and rows. kTarget: on the picture:
/// of a fisheye in rays and rings about its middle (the first and the last ray are one), else in columns and
/// rows; there cells are small where the optic crowds the picture together, and end where it does.
enum class WarpGrid { kFilm, kTarget };

template <>
struct EnumNames<WarpGrid> {
    static constexpr std::array kTable{NamedValue<WarpGrid>{WarpGrid::kFilm, "film"},
                                       NamedValue<WarpGrid>{WarpGrid::kTarget, "target"}};
};

struct WarpNode {
    Vec2 film{0};           // place on the film, pixels; kTarget: beyond its edges too
    Vec2 target{0};         // place on the target's picture, in its pixels
    double intensity = -1;  // 0..1; negative: nothing is drawn there
};

/// How far what programs draw in a mesh's cells lies from exact rays, pixels.
struct WarpError {
    double mean = 0, p99 = 0, max = 0;
};

struct WarpMesh {
    WarpGrid grid = WarpGrid::kFilm;
    int columns = 0, rows = 0;  // nodes
    int film_width = 0, film_height = 0, target_width = 0, target_height = 0;
    // Row by row: from the film's or the picture's top, or from the middle outward.
    std::vector<WarpNode> nodes;

    const WarpNode& at(int x, int y) const {
        return nodes[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(x)];
    }
    std::size_t drawn_count() const;  // nodes with intensity > 0

    /// Of the worst way to interpolate, bilinearly or on two triangles, along either diagonal: over cells
    /// whose nodes are all drawn, or some 50,000 of them, evenly spread. In pixels of the target; of a mesh
    /// that is regular there (kTarget) in pixels of the film. None: no such cell, nothing was measured.
    std::optional<WarpError> error;
};

struct WarpMeshParams {
    int columns = 0,
        rows = 0;  // nodes; 0: as many as keep error->p99 at max_error, at most kMostWarpColumns wide
    double max_error = 0.5;  // pixels, as WarpError::p99
    WarpGrid grid = WarpGrid::kFilm;
};

inline constexpr int kMostWarpColumns = 2049;

/// The mesh of a film whose rays end on a target of directions; request.way is not asked. Nodes lie on the
/// border and evenly between. Intensity is the solid angle that the film's pixel covers, over its 95th
/// percentile, at most 1, so that the projected picture is even. Nodes that show nothing beside ones that do
/// go on as their neighbours do, at intensity 0: cells at the optic's rim fade instead of being lost. Throws
/// as make_film_map, and UsageError for request.path with a mesh that is regular on the film, whose rays go
/// as request.word says, and for that word with one that is regular on the target.
WarpMesh make_warp_mesh(const World& world, const FilmMapRequest& request, const WarpMeshParams& params,
                        const Progress& progress = {});

/// Bourke's format: 2, the numbers of nodes, then x y u v i for each, from the bottom left: x within the
/// film's aspect, y in -1..1, u and v in 0..1 from the picture's lower left.
std::string bourke_mesh(const WarpMesh& mesh);

/// The same as Wavefront OBJ, for SGCT and others: faces where all four nodes are drawn.
std::string obj_mesh(const WarpMesh& mesh);

}  // namespace trilens
