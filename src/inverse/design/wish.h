// A wish: what an eye is to see in a mirror, place by place.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/util/names.h"

namespace trilens {

/// kPlane: a rectangle in the world without distortion. kEquirectangular: directions of equal angles,
/// longitude over x and latitude over y. kMap: a grid of world points or directions.
enum class WishType { kPlane, kEquirectangular, kMap };

template <>
struct EnumNames<WishType> {
    static constexpr std::array kTable{NamedValue<WishType>{WishType::kPlane, "plane"},
                                       NamedValue<WishType>{WishType::kEquirectangular, "equirectangular"},
                                       NamedValue<WishType>{WishType::kMap, "map"}};
};

/// What is wanted at (s, t), 0..1 each over the mirror as the eye sees it: its perspective onto the plane
/// through the rectangle's middle at right angles to the view, s along the tangent and t upward there, each
/// over the rectangle's foreshortened side.
struct WishMap {
    WishType type = WishType::kPlane;
    Vec3 origin{0}, u{1, 0, 0}, v{0, 1, 0};  // kPlane: the point origin + s u + t v, world
    /// kEquirectangular: longitudes and latitudes in degrees at s, t = 0 and 1: west, south, east, north. 0,
    /// 0 is the mirror's normal; longitude turns towards the tangent, latitude towards normal x tangent.
    std::array<double, 4> window{-45, -45, 45, 45};
    std::string file;            // kMap: of an EXR with channels X, Y, Z, its top row at t = 1
    bool is_directions = false;  // kMap: else points
    int columns = 0, rows = 0;   // kMap: 4 or more each
    std::vector<Vec3> values;    // kMap: rows from t = 0 up, its first at s = 0, the last at s = 1
};

/// The rectangle under a mirror.
struct MirrorPatch {
    Vec3 center{0};
    Vec3 normal{0, 0, 1};                 // any length but 0; towards the eye's side
    Vec3 tangent{1, 0, 0};                // along size.x; not along the normal
    Vec2 size{1};                         // > 0
    std::array<int, 2> controls{12, 12};  // control points along both, 4..200
};

struct DesignWish {
    Vec3 eye{0};  // world
    MirrorPatch patch;
    WishMap wish;
    Vec2 anchor{0};  // where on the rectangle, from its middle, the mirror stays in it
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

/// Throws InputError(name, place) for what no mirror can have: numbers out of range, an eye behind the
/// rectangle, a wished ray that goes into the mirror.
void check_wish(const DesignWish& wish, const std::string& name = "wish");

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
    /// The unit direction in which light is to leave for what the eye is to see, at a place of the mirror
    /// (rectangle's frame).
    Vec3 wanted(const Vec3& place) const;

  private:
    Vec3 value(const Vec2& st) const;

    DesignWish wish_;
    PatchFrame frame_;
    Vec3 eye_{0};
};

}  // namespace trilens
