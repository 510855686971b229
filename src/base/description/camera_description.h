// A camera as a scene gives it: plain data of every kind; the camera room makes rays of it.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"
#include "base/util/names.h"

namespace trilens {

enum class CameraType {
    kPerspective,
    kOrthographic,
    kOblique,
    kViewVolume,
    kCylindrical,
    kSpherical,
    kFisheye,
    kOpencv,
    kPushbroom,
    kCrossedSlits,
    kGeneralLinear,
    kDistortion,
    kMultiPerspective,
    kInwardSphere,
    kPlanarContext,
    kRayMesh
};

template <>
struct EnumNames<CameraType> {
    static constexpr std::array kTable{
        NamedValue<CameraType>{CameraType::kPerspective, "perspective"},
        NamedValue<CameraType>{CameraType::kOrthographic, "orthographic"},
        NamedValue<CameraType>{CameraType::kOblique, "oblique"},
        NamedValue<CameraType>{CameraType::kViewVolume, "viewVolume"},
        NamedValue<CameraType>{CameraType::kCylindrical, "cylindrical"},
        NamedValue<CameraType>{CameraType::kSpherical, "spherical"},
        NamedValue<CameraType>{CameraType::kFisheye, "fisheye"},
        NamedValue<CameraType>{CameraType::kOpencv, "opencv"},
        NamedValue<CameraType>{CameraType::kPushbroom, "pushbroom"},
        NamedValue<CameraType>{CameraType::kCrossedSlits, "crossedSlits"},
        NamedValue<CameraType>{CameraType::kGeneralLinear, "generalLinear"},
        NamedValue<CameraType>{CameraType::kDistortion, "distortion"},
        NamedValue<CameraType>{CameraType::kMultiPerspective, "multiPerspective"},
        NamedValue<CameraType>{CameraType::kInwardSphere, "inwardSphere"},
        NamedValue<CameraType>{CameraType::kPlanarContext, "planarContext"},
        NamedValue<CameraType>{CameraType::kRayMesh, "rayMesh"}};
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

/// The standard terms of a linear view (Foley et al., Computer Graphics, chapter 6), world frame but where
/// said. The axes u, v and n of viewing coordinates: n along vpn, v along the part of vup across it.
struct ViewVolume {
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

/// A calibrated camera in OpenCV's terms, but for the film's positions, which have a pixel's centre at .5.
struct OpencvLens {
    bool fisheye = false;                   // cv::fisheye's model, else the pinhole's
    double fx = 1, fy = 1, cx = 0, cy = 0;  // pixels of the film
    std::vector<double> distortion;         // pinhole: 0, 4, 5, 8, 12 or 14 numbers; fisheye: 0 or 4
};

/// A line in the world, or a ray with a place on the film.
struct WorldLine {
    Vec3 point{0}, direction{0, 0, 1};
};
struct PlacedRay {
    Vec3 point{0}, direction{0, 0, 1};
    Vec2 screen{0};  // 0..1 from the film's top left
};

struct WindowedCamera;

/// One camera. A type reads the fields that the interface gives it; the rest is ignored.
struct CameraDescription {
    using Type = CameraType;
    std::string name;
    Type type = Type::kPerspective;
    Vec3 eye{0, 0, 1}, at{0}, up{0, 1, 0};  // lookAt: of all but viewVolume and rayMesh

    double yfov = 40;  // degrees, the whole vertical angle
    Vec2 shift{0};     // the window moves by this share of the film's size, x right, y up
    double near_depth = 0, far_depth = std::numeric_limits<double>::infinity();  // along the view axis

    double ymag = 1;    // half the film's height in the world
    double angle = 45;  // degrees; of receding lines on the film, or of the turned up ground
    double scale = 1;   // length of receding lines on the film
    ViewVolume view_volume;

    double hfov = 360, vfov = 180;  // degrees
    FisheyeMapping mapping = FisheyeMapping::kEquidistant;
    double fov = 180;  // degrees across the film's smaller side
    OpencvLens lens;

    Vec3 travel{1, 0, 0};
    std::array<WorldLine, 2> slits;
    std::array<double, 4> window{-1, 1, -1, 1};  // umin, umax, vmin, vmax on the plane of lookAt
    std::array<PlacedRay, 3> placed_rays;

    std::array<double, 4> detail{0.25, 0.25, 0.75, 0.75};  // x0, y0, x1, y1: shares of the film
    double context_fov = 150;                              // degrees
    std::vector<WindowedCamera> views;
    double blend = 0;  // share of the film
    Vec3 center{0};
    double radius = 1;
    Vec3 ground_point{0}, ground_normal{0, 1, 0};
    double bend = 1;  // distance

    // How fine the RayMesh of a camera that is not linear is: N x N over the film, or as many as leave no
    // position further off than the tolerance in pixels; where both are 0: kDefaultCameraFacets.
    int facets = 0;
    double tolerance = 0;

    // kRayMesh: one entry per corner; screen in 0..1 from the film's top left.
    std::vector<Vec3> points, directions;
    std::vector<Vec2> screen;
    std::vector<IdTriple> triangles;
};

/// A camera that has a part of the film: x0, y0, x1, y1 in shares of it from the top left.
struct WindowedCamera {
    CameraDescription camera;
    std::array<double, 4> window{0, 0, 1, 1};
};

inline constexpr int kDefaultCameraFacets = 64;
inline constexpr int kMostCameraFacets = 1024;  // N at most

/// Whether a camera of this type has rays that are not linear over the film.
constexpr bool is_linear(CameraType type) {
    return type == CameraType::kPerspective || type == CameraType::kOrthographic ||
           type == CameraType::kOblique || type == CameraType::kViewVolume;
}

}  // namespace trilens
