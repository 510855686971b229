// Which proxy geometry stands for what a photograph of a mirror does not say: how far away things are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/math/box.h"
#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"
#include "base/util/names.h"
#include "scene/data/scene.h"

namespace trilens {

/// kScene: the scene's objects, and infinity where there are none. kInfinity: light from afar. kSphere: of
/// this radius about the centre. kBox: the walls of a room, seen from inside. kMesh: the triangles of an OBJ
/// file, and infinity between them.
enum class ProxyKind { kScene, kInfinity, kSphere, kBox, kMesh };

struct ProxyDescription {
    ProxyKind kind = ProxyKind::kScene;
    double radius = 1;
    Box box;
    std::string file;  // kMesh
};

/// Reads "scene", "infinity", "sphere:R", "box:x0,y0,z0,x1,y1,z1", or the name of an OBJ file ("room.obj").
/// Throws UsageError that says what is wrong.
ProxyDescription parse_proxy(const std::string& text);

// The rectangles that pictures are unwrapped to: latitude-longitude, cube map, plane, object; each as a map
// from its pixels to directions or points, and back.

/// kEquirect: latitude and longitude as the scene's background has them: the middle column is -Z, the right
/// half +X, the top row +Y. kCubemap: six square faces side by side, +X -X +Y -Y +Z -Z, each turned as OpenGL
/// has it. kFisheye: a dome's master picture: angles from +Y (the middle) in proportion to the distance from
/// the middle, `fov` degrees across, -Z at the bottom and +X at the right. kPlane: a parallelogram in the
/// world. kObject: a flat object's bounding rectangle in its plane, or another object's texture coordinates,
/// which must lie in 0..1.
enum class TargetKind { kEquirect, kCubemap, kFisheye, kPlane, kObject };

template <>
struct EnumNames<TargetKind> {
    static constexpr std::array kTable{NamedValue<TargetKind>{TargetKind::kEquirect, "equirect"},
                                       NamedValue<TargetKind>{TargetKind::kCubemap, "cubemap"},
                                       NamedValue<TargetKind>{TargetKind::kFisheye, "fisheye"},
                                       NamedValue<TargetKind>{TargetKind::kPlane, "plane"},
                                       NamedValue<TargetKind>{TargetKind::kObject, "object"}};
};

struct TargetDescription {
    TargetKind kind = TargetKind::kEquirect;
    int width = 2048, height = 1024;         // pixels
    Vec3 origin{0}, u{1, 0, 0}, v{0, 1, 0};  // kPlane: the picture's lower left corner, its lower side to the
                                             // right, its left side upward; world
    double fov = 180;                        // kFisheye: degrees
    Id object = kNone;                       // kObject: index into Scene::meshes
};

/// A rectangle in the world: the lower left corner, and its sides, at right angles to each other.
struct FlatRectangle {
    Vec3 origin{0}, u{1, 0, 0}, v{0, 1, 0};
    Vec3 normal() const { return normalize_or_zero(cross(u, v)); }
};

/// The rectangle around a flat object in its plane, seen from its front, u along its first side; none where
/// the object is not flat (to 1e-6 of its size) or has no area.
std::optional<FlatRectangle> flat_rectangle(const ObjectMesh& object);

/// Where a target's pixel looks: a unit direction, or a point; and how it moves with x and y in pixels.
struct TargetPlace {
    bool is_direction = false;
    Vec3 at{0}, dx{0}, dy{0};
};

/// A flat part of what a pixel shows of a target's plane or object.
struct TargetPiece {
    TargetPlace at_middle;      // where the pixel's middle would lie in the part's plane
    Vec3 normal{0};             // of its front, around which its corners lie counterclockwise; unit length
    std::vector<Vec2> outline;  // convex, in pixels from the middle, counterclockwise as x is to y
    double share = 1;           // of the pixel's area
};

/// Whether a target's pixels are directions, or else points.
constexpr bool has_directions(TargetKind kind) {
    return kind != TargetKind::kPlane && kind != TargetKind::kObject;
}

/// Reads "equirect:2048x1024", "cubemap:512", "fisheye:1024" or "fisheye:1024:220" (degrees),
/// "plane:ox,oy,oz,ux,uy,uz,vx,vy,vz,WxH", "NAME" or "NAME:WxH" (an object; without WxH the longer side has
/// 1024 pixels). Throws UsageError that says what is wrong.
TargetDescription parse_target(const std::string& text, const Scene& scene);

/// One target ready to ask. Thread-safe to read; the scene must live longer.
class Target {
  public:
    /// Throws UsageError for sizes below 1 or above kMostPixels, InputError for an object that has neither a
    /// plane nor usable texture coordinates.
    Target(const TargetDescription& description, const Scene& scene);

    const TargetDescription& description() const { return description_; }
    bool has_directions() const { return trilens::has_directions(description_.kind); }
    /// None where no triangle of the object has these texture coordinates, or outside the circle of a
    /// fisheye.
    std::optional<TargetPlace> place(const Vec2& pixel) const;

    /// The parts of the pixel with this middle that triangles of the object have, whole where the target is a
    /// rectangle; of triangles that lie on each other's texture coordinates the first one's. Not of
    /// directions.
    std::vector<TargetPiece> pieces(const Vec2& pixel) const;

    /// Back: where a direction (any length) lies; none for planes and objects, and outside the circle of a
    /// fisheye.
    std::optional<Vec2> pixel_of_direction(const Vec3& direction) const;
    /// Where a point of the target's own plane or object lies. `triangle`: of the object, asked for where
    /// that is not flat.
    std::optional<Vec2> pixel_of_point(const Vec3& point, Id triangle) const;
    /// Whether two triangles of an object that is not flat lie on the same texture coordinates, at some of
    /// 100 x 100 places: of these place() knows one.
    bool shares_coordinates() const;
    /// The rectangle, of a plane or a flat object.
    const std::optional<FlatRectangle>& rectangle() const { return rectangle_; }

    /// Share of the target's solid angle, or area, that a pixel there has (up to a constant).
    double measure(const TargetPlace& place) const;

  private:
    std::optional<TargetPlace> object_place(const Vec2& pixel) const;
    std::optional<TargetPlace> place_on(Id triangle, const Vec2& pixel, bool inside) const;
    std::vector<Id> triangles_around(const Vec2& pixel) const;
    const std::vector<Id>& triangles_near(const Vec2& uv) const;

    TargetDescription description_;
    std::optional<FlatRectangle> rectangle_;
    const ObjectMesh* object_ = nullptr;
    std::vector<std::vector<Id>> bins_;  // kSide x kSide over the texture coordinates: triangles
};

}  // namespace trilens
