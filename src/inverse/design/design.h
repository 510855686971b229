// Uniform bicubic B-spline heights over a rectangle: a freeform surface as its designer has it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/description/optic_description.h"
#include "base/math/vec.h"
#include "base/util/error.h"
#include "base/util/names.h"

namespace trilens {

/// A height with its derivatives at one (x, y).
struct Height {
    double z = 0, x = 0, y = 0;     // z, dz/dx, dz/dy
    double xx = 0, xy = 0, yy = 0;  // second derivatives
};

/// The 16 control points that a place depends on: index, and how height and slopes move with each.
struct HeightBasis {
    std::array<std::size_t, 16> index{};
    std::array<double, 16> z{}, x{}, y{}, xx{}, xy{}, yy{};
};

/// Heights over |x| <= size.x / 2, |y| <= size.y / 2. Beside the rectangle lies one row of control points
/// more on each side, so that it is the limit surface of the control net with no boundary interpolated.
struct HeightField {
    Vec2 size{1};
    std::array<int, 2> controls{4, 4};  // along x and y, 4 or more
    std::vector<double> heights;        // row by row, x fastest

    HeightField() = default;
    HeightField(const Vec2& sides, const std::array<int, 2>& counts);

    Vec2 spacing() const;
    /// Where a control point stands.
    Vec2 control_place(int column, int row) const;
    HeightBasis basis(const Vec2& at) const;
    Height height(const Vec2& at) const;
};

/// Larger of the principal curvatures' sizes, 1 / length.
double largest_curvature(const Height& at);

// A wish: what an eye is to see in a mirror or through a lens, place by place.

/// kPlane: a rectangle in the world without distortion. kEquirectangular: directions of equal angles,
/// longitude over x and latitude over y. kMap: a grid of world points or directions.
enum class WishType { kPlane, kEquirectangular, kMap };

template <>
struct EnumNames<WishType> {
    static constexpr std::array kTable{NamedValue<WishType>{WishType::kPlane, "plane"},
                                       NamedValue<WishType>{WishType::kEquirectangular, "equirectangular"},
                                       NamedValue<WishType>{WishType::kMap, "map"}};
};

/// What is wanted at (s, t), 0..1 each over the mirror or lens as the eye sees it: its perspective onto the
/// plane through the rectangle's middle at right angles to the view, s along the tangent and t upward there,
/// each over the rectangle's foreshortened side.
struct WishMap {
    WishType type = WishType::kPlane;
    Vec3 origin{0}, u{1, 0, 0}, v{0, 1, 0};  // kPlane: the point origin + s u + t v, world
    /// kEquirectangular: longitudes and latitudes in degrees at s, t = 0 and 1: west, south, east, north. 0,
    /// 0 is the mirror's normal, of a lens its opposite; longitude turns towards the tangent, latitude
    /// towards normal x tangent.
    std::array<double, 4> window{-45, -45, 45, 45};
    std::string file;            // kMap: of an EXR with channels X, Y, Z, its top row at t = 1
    bool is_directions = false;  // kMap: else points
    int columns = 0, rows = 0;   // kMap: 4 or more each
    std::vector<Vec3> values;    // kMap: rows from t = 0 up, its first at s = 0, the last at s = 1
};

/// The rectangle under the surface that is designed.
struct MirrorPatch {
    Vec3 center{0};
    Vec3 normal{0, 0, 1};                 // any length but 0; towards the eye's side
    Vec3 tangent{1, 0, 0};                // along size.x; not along the normal
    Vec2 size{1};                         // > 0
    std::array<int, 2> controls{12, 12};  // control points along both, 4..200
};

/// A lens instead of a mirror: what is designed is its front, towards the eye; its back is a plane, parallel
/// to the rectangle.
struct DesignLens {
    double ior = 1.5;      // of its glass: above 1, at most 10
    double thickness = 1;  // > 0: from the rectangle to the back
};

struct DesignWish {
    Vec3 eye{0};  // world
    MirrorPatch patch;
    std::optional<DesignLens> lens;  // none: a mirror
    WishMap wish;
    Vec2 anchor{0};  // where on the rectangle, from its middle, the surface stays in it
    double fairness =
        1e-7;  // >= 0: of the mean squared change of slope over the rectangle, against squared angles
    std::array<int, 2> samples{40, 40};  // along both, 4..400
};

/// Reads a wish file (JSON, as wish_schema says) with the map that it names. Throws InputError with file and
/// place.
DesignWish read_wish(const std::string& file);
DesignWish parse_wish(const std::string& text, const std::string& name, const std::string& folder = "");

/// The JSON Schema of wish files, and an example: a driver's mirror.
std::string wish_schema();
std::string wish_example();

/// Throws InputError(name, place) for what no mirror or lens can have: numbers out of range, an eye behind
/// the rectangle, a wished ray that goes into the mirror or does not leave the lens' back.
void check_wish(const DesignWish& wish, const std::string& name = "wish");

/// "mirror" or "lens": what the wish is of.
inline const char* optic_word(const DesignWish& wish) {
    return wish.lens ? "lens" : "mirror";
}

/// World and rectangle: x along the tangent, z along the normal.
struct PatchFrame {
    Vec3 center{0};
    Mat3 world_from_patch{1};

    explicit PatchFrame(const MirrorPatch& patch);
    Vec3 to_world(const Vec3& local) const { return center + world_from_patch * local; }
    Vec3 to_patch(const Vec3& world) const { return glm::transpose(world_from_patch) * (world - center); }
};

/// The wish in the rectangle's frame, ready to be asked.
class WishedRays {
  public:
    explicit WishedRays(const DesignWish& wish);

    const Vec3& eye() const { return eye_; }
    /// None: it is of a mirror.
    const std::optional<DesignLens>& lens() const { return wish_.lens; }

    /// The unit direction in which light is to leave for what the eye is to see at a place of the surface,
    /// where it leaves `from` there (of a lens: its back); rectangle's frame.
    Vec3 wanted(const Vec3& place, const Vec3& from) const;
    /// The same of a mirror, which it leaves at that place.
    Vec3 wanted(const Vec3& place) const { return wanted(place, place); }
    /// The point that the eye is to see at that place, rectangle's frame; none: the wish has directions.
    std::optional<Vec3> wanted_point(const Vec3& place) const;

  private:
    Vec3 value(const Vec2& st) const;
    Vec3 value_at(const Vec3& place) const;

    DesignWish wish_;
    PatchFrame frame_;
    Vec3 eye_{0};
};

// Freeform mirrors and lenses for a wanted map: the surface whose rays come nearest to a wish.

/// How far reflected or refracted rays are from the wished ones, degrees, over places of the rectangle. A
/// design's are more than twice as many along each side as its samples and its control points.
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
    /// length. 0 where a mirror or a lens can do what is wished. Over the flat rectangle, and on the surface
    /// that was found.
    double curl_flat = 0, curl = 0;
    double sag = 0;              // highest minus lowest point over the rectangle
    double smallest_radius = 0;  // of curvature; infinite: flat
    int iterations = 0;
    bool converged = false;
    PatchMap error_map, curl_map;       // degrees; 1 / length
    std::optional<double> back;         // of a lens: the height of its back
    std::vector<std::string> warnings;  // of what no mirror or lens does
};

/// The mirror, or the lens. Throws InputError as check_wish does, ComputationError where no surface is found
/// (rays that leave the rectangle's front; a front that cuts the lens' back), Interrupted.
Design design_mirror(const DesignWish& wish, const DesignRequest& request = {},
                     const Progress& progress = {});

/// The best sphere as a design with the same control points, whose heights are within 1e-6 of its sag for a
/// dozen of them each way; `design` must have it.
Design design_of_sphere(const DesignWish& wish, const Design& design);

/// Its control net in the world, whose limit surface it is (no boundary interpolated; the faces of the rim,
/// which have none, are holes).
Cage design_cage(const DesignWish& wish, const Design& design);

/// A scene with the mirror or the lens (a closed body of six B-spline patches), the eye as its camera, and
/// the wished plane with squares on it: JSON.
std::string design_scene(const DesignWish& wish, const Design& design);

// The surface for makers, in the rectangle's frame and the wish's lengths, with `steps` x `steps` squares.

/// A closed body, binary STL: the mirror in front, a plane back `thickness` behind its lowest point; of a
/// lens its own back.
std::string design_stl(const Design& design, double thickness, int steps = 160);
/// The designed surface alone (the mirror, or the front of the lens), Wavefront OBJ, with normals.
std::string design_obj(const Design& design, int steps = 160);
/// A table "x,y,z,nx,ny,nz", normals unit.
std::string design_sag_table(const Design& design, int steps = 40);

}  // namespace trilens
