// A camera as a scene gives it: plain data of every kind; the camera room makes rays of it.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"
#include "base/util/names.h"

namespace trilens {

// The kinds of cameras, each with its parameters. World frame, scene units, degrees; the exact rays of each
// are made in src/camera/kinds.

struct PerspectiveCamera {
    static constexpr const char* kName = "perspective";
    static constexpr bool kLinear = true;
    double yfov = 40;  // the whole vertical angle
    Vec2 shift{0};     // the window moves by this share of the film's size, x right, y up
    double near_depth = 0, far_depth = std::numeric_limits<double>::infinity();  // along the view axis
};

struct OrthographicCamera {
    static constexpr const char* kName = "orthographic";
    static constexpr bool kLinear = true;
    double ymag = 1;  // half the film's height in the world
};

struct ObliqueCamera {
    static constexpr const char* kName = "oblique";
    static constexpr bool kLinear = true;
    double ymag = 1;    // half the film's height in the world
    double angle = 45;  // of receding lines on the film
    double scale = 1;   // their length there
};

/// The standard terms of a linear view (Foley et al., Computer Graphics, chapter 6), world frame but where
/// said. The axes u, v and n of viewing coordinates: n along vpn, v along the part of vup across it.
struct ViewVolume {
    static constexpr const char* kName = "viewVolume";
    static constexpr bool kLinear = true;
    Vec3 vrp{0};        // the view plane goes through it
    Vec3 vpn{0, 0, 1};  // normal of the view plane, towards the viewer; any length but 0
    Vec3 vup{0, 1, 0};  // not along vpn
    Vec3 prp{0, 0, 1};  // in (u, v, n): the eye, or for parallel rays: from it to the
                        // window's middle is their direction
    std::array<double, 4> window{-1, 1, -1, 1};  // umin, umax, vmin, vmax on the view plane; the whole film
    bool parallel = false;
    double front = std::numeric_limits<double>::infinity();  // n of the clipping planes; infinite: none
    double back = -std::numeric_limits<double>::infinity();
};

struct CylindricalCamera {
    static constexpr const char* kName = "cylindrical";
    double yfov = 40;   // the whole vertical angle
    double hfov = 360;  // longitudes across the film
};

struct SphericalCamera {
    static constexpr const char* kName = "spherical";
    double hfov = 360, vfov = 180;  // longitudes across the film, latitudes over it
};

/// How far from the film's middle a fisheye shows what lies at an angle theta from its axis: proportional to
/// theta, 2 sin(theta / 2), 2 tan(theta / 2), sin(theta).
enum class FisheyeMapping { kEquidistant, kEquisolid, kStereographic, kOrthographic };

template <>
struct EnumNames<FisheyeMapping> {
    static constexpr std::array kTable{
        NamedValue<FisheyeMapping>{FisheyeMapping::kEquidistant, "equidistant"},
        NamedValue<FisheyeMapping>{FisheyeMapping::kEquisolid, "equisolid"},
        NamedValue<FisheyeMapping>{FisheyeMapping::kStereographic, "stereographic"},
        NamedValue<FisheyeMapping>{FisheyeMapping::kOrthographic, "orthographic"}};
};

struct FisheyeCamera {
    static constexpr const char* kName = "fisheye";
    FisheyeMapping mapping = FisheyeMapping::kEquidistant;
    double fov = 180;  // across the film's smaller side
};

/// A calibrated camera in OpenCV's terms, but for the film's positions, which have a pixel's centre at .5.
struct OpencvLens {
    static constexpr const char* kName = "opencv";
    bool fisheye = false;                   // cv::fisheye's model, else the pinhole's
    double fx = 1, fy = 1, cx = 0, cy = 0;  // pixels of the film
    std::vector<double> distortion = {};    // pinhole: 0, 4, 5, 8, 12 or 14 numbers; fisheye: 0 or 4
};

struct PushbroomCamera {
    static constexpr const char* kName = "pushbroom";
    double yfov = 40;  // the whole vertical angle
    Vec3 travel{1, 0, 0};
};

/// A line in the world.
struct WorldLine {
    Vec3 point{0}, direction{0, 0, 1};
};

struct CrossedSlitsCamera {
    static constexpr const char* kName = "crossedSlits";
    std::array<WorldLine, 2> slits = {};
    std::array<double, 4> window{-1, 1, -1, 1};  // umin, umax, vmin, vmax on the plane of lookAt
};

/// A ray with a place on the film.
struct PlacedRay {
    Vec3 point{0}, direction{0, 0, 1};
    Vec2 screen{0};  // 0..1 from the film's top left
};

/// A general linear camera (Yu and McMillan), by three of its rays. With w the unit view direction each
/// counts as d / (d . w) from p - ((p - eye) . w) d / (d . w): the ray of a film place is the affine
/// combination of these three that the place is of their places.
struct ThreeRayCamera {
    static constexpr const char* kName = "generalLinear";
    std::array<PlacedRay, 3> placed_rays = {};
};

/// Detail and context.
struct DistortionCamera {
    static constexpr const char* kName = "distortion";
    double yfov = 40;                                      // the whole vertical angle of the detail
    std::array<double, 4> detail{0.25, 0.25, 0.75, 0.75};  // x0, y0, x1, y1: shares of the film
    double context_fov = 150;
};

struct WindowedCamera;

/// Several cameras, each in its window.
struct MultiPerspectiveCamera {
    static constexpr const char* kName = "multiPerspective";
    std::vector<WindowedCamera> views;
    double blend = 0;  // share of the film

    // Defined where a WindowedCamera is.
    MultiPerspectiveCamera();
    MultiPerspectiveCamera(const MultiPerspectiveCamera&);
    MultiPerspectiveCamera(MultiPerspectiveCamera&&) noexcept;
    MultiPerspectiveCamera& operator=(const MultiPerspectiveCamera&);
    MultiPerspectiveCamera& operator=(MultiPerspectiveCamera&&) noexcept;
    ~MultiPerspectiveCamera();
};

struct InwardSphereCamera {
    static constexpr const char* kName = "inwardSphere";
    double hfov = 360, vfov = 180;  // longitudes across the film, latitudes over it
    Vec3 center{0};
    double radius = 1;
};

struct PlanarContextCamera {
    static constexpr const char* kName = "planarContext";
    double yfov = 40;   // the whole vertical angle
    double angle = 45;  // of the turned up ground
    Vec3 ground_point{0}, ground_normal{0, 1, 0};
    double bend = 1;  // distance
};

/// A RayMesh as it is: one entry per corner; screen in 0..1 from the film's top left.
struct RayMeshCamera {
    static constexpr const char* kName = "rayMesh";
    std::vector<Vec3> points = {}, directions = {};
    std::vector<Vec2> screen = {};
    std::vector<IdTriple> triangles = {};
};

using CameraKind =
    std::variant<PerspectiveCamera, OrthographicCamera, ObliqueCamera, ViewVolume, CylindricalCamera,
                 SphericalCamera, FisheyeCamera, OpencvLens, PushbroomCamera, CrossedSlitsCamera,
                 ThreeRayCamera, DistortionCamera, MultiPerspectiveCamera, InwardSphereCamera,
                 PlanarContextCamera, RayMeshCamera>;

/// A camera of some kind.
struct CameraDescription {
    std::string name = {};
    Vec3 eye{0, 0, 1}, at{0}, up{0, 1, 0};  // lookAt, where has_look_at()

    // How fine the RayMesh of a camera is that chooses_facets(): N x N over the film, or as many as leave no
    // position further off than the tolerance in pixels; where both are 0: kDefaultCameraFacets.
    int facets = 0;
    double tolerance = 0;

    CameraKind kind = {};
};

/// A camera that has a part of the film: x0, y0, x1, y1 in shares of it from the top left.
struct WindowedCamera {
    CameraDescription camera = {};
    std::array<double, 4> window{0, 0, 1, 1};
};

inline MultiPerspectiveCamera::MultiPerspectiveCamera() = default;
inline MultiPerspectiveCamera::MultiPerspectiveCamera(const MultiPerspectiveCamera&) = default;
inline MultiPerspectiveCamera::MultiPerspectiveCamera(MultiPerspectiveCamera&&) noexcept = default;
inline MultiPerspectiveCamera& MultiPerspectiveCamera::operator=(const MultiPerspectiveCamera&) = default;
inline MultiPerspectiveCamera& MultiPerspectiveCamera::operator=(MultiPerspectiveCamera&&) noexcept = default;
inline MultiPerspectiveCamera::~MultiPerspectiveCamera() = default;

inline constexpr int kDefaultCameraFacets = 64;
inline constexpr int kMostCameraFacets = 1024;  // N at most

inline const char* kind_name(const CameraDescription& camera) {
    return std::visit([](const auto& kind) { return kind.kName; }, camera.kind);
}

template <typename Kind>
inline constexpr bool kIsLinear = requires {
    Kind::kLinear;
};

/// Whether lookAt places it.
template <typename Kind>
inline constexpr bool kHasLookAt = !std::is_same_v<Kind, ViewVolume> && !std::is_same_v<Kind, RayMeshCamera>;

/// Whether its RayMesh is made of exact rays that are not linear over the film.
template <typename Kind>
inline constexpr bool kChoosesFacets = !kIsLinear<Kind> && !std::is_same_v<Kind, RayMeshCamera>;

inline bool is_linear(const CameraDescription& camera) {
    return std::visit([]<typename Kind>(const Kind&) { return kIsLinear<Kind>; }, camera.kind);
}
inline bool has_look_at(const CameraDescription& camera) {
    return std::visit([]<typename Kind>(const Kind&) { return kHasLookAt<Kind>; }, camera.kind);
}
inline bool chooses_facets(const CameraDescription& camera) {
    return std::visit([]<typename Kind>(const Kind&) { return kChoosesFacets<Kind>; }, camera.kind);
}

}  // namespace trilens
