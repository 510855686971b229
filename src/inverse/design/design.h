// Freeform mirrors for a wanted map: the surface whose reflections come nearest to a wish.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/util/progress.h"
#include "inverse/design/height_field.h"
#include "inverse/design/wish.h"

namespace trilens {

/// How far reflected rays are from the wished ones, degrees, over samples of the rectangle.
struct DesignErrors {
    double mean = 0, p95 = 0, max = 0;
};

/// Values over the rectangle, row by row from y = -size.y / 2 up.
struct PatchMap {
    int columns = 0, rows = 0;
    std::vector<double> values;
};

/// kPicard: linear least squares for the slopes that the present surface needs, again and again.
/// kGaussNewton: of the reflected rays themselves, from there.
enum class DesignMethod { kGaussNewton, kPicard };

struct DesignRequest {
    DesignMethod method = DesignMethod::kGaussNewton;
    bool compare_sphere = false;
    int most_iterations = 20;
};

/// The sphere (or plane) through the anchor that comes nearest to the wish.
struct BestSphere {
    double radius = 0;  // positive: convex towards the eye; infinite: a plane
    Vec2 tilt{0};       // its slopes at the anchor
    DesignErrors errors;
};

struct Design {
    HeightField surface;  // over the rectangle, in its frame
    DesignErrors errors;
    std::optional<BestSphere> sphere;
    /// Rms of (p_y + p_z q) - (q_x + q_z p), with p, q the slopes that the wish needs at (x, y, z): 1 /
    /// length. 0 where a mirror can do what is wished. Over the flat rectangle, and on the mirror that was
    /// found.
    double curl_flat = 0, curl = 0;
    double sag = 0;              // highest minus lowest point over the rectangle
    double smallest_radius = 0;  // of curvature; infinite: flat
    int iterations = 0;
    bool converged = false;
    PatchMap error_map, curl_map;       // degrees; 1 / length
    std::vector<std::string> warnings;  // of what no mirror does
};

/// The mirror. Throws InputError as check_wish does, ComputationError where no surface is found (rays that
/// leave the rectangle's front), Interrupted.
Design design_mirror(const DesignWish& wish, const DesignRequest& request = {},
                     const Progress& progress = {});

/// The best sphere as a design with the same control points, whose heights are within 1e-6 of its sag for a
/// dozen of them each way; `design` must have it.
Design design_of_sphere(const DesignWish& wish, const Design& design);

/// Its control net in the world, whose limit surface it is (no boundary interpolated).
Cage design_cage(const DesignWish& wish, const Design& design);

/// A scene with the mirror, the eye as its camera, and the wished plane with squares on it: JSON.
std::string design_scene(const DesignWish& wish, const Design& design);

// The surface for makers, in the rectangle's frame and the wish's lengths, with `steps` x `steps` squares.

/// A closed body, binary STL: the mirror in front, a plane back `thickness` behind its lowest point.
std::string design_stl(const Design& design, double thickness, int steps = 160);
/// The mirror alone, Wavefront OBJ, with normals.
std::string design_obj(const Design& design, int steps = 160);
/// A table "x,y,z,nx,ny,nz", normals unit.
std::string design_sag_table(const Design& design, int steps = 40);

}  // namespace trilens
