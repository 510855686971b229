// Linear cameras: from what a user says about them, as the view volumes of Foley et al., with their clipping
// planes; and the two facets that make any of them a RayMesh.
#pragma once

#include <limits>
#include <span>

#include "base/description/camera_description.h"
#include "base/raymesh/ray_mesh.h"
#include "camera/model/camera_model.h"

namespace trilens {

// Linear cameras from what a user says about them, and the two facets that make any linear camera a RayMesh.

struct PerspectiveParams {
    Placement look_at;
    double yfov_degrees = 40;          // the whole vertical angle, inside (0, 180)
    double width = 640, height = 480;  // the film, in pixels
    Vec2 shift{0};                     // the window moves by this share of the film's size, x right, y up
};

struct OrthographicParams {
    Placement look_at;
    double world_height = 2;           // what the film's height covers, scene units
    double width = 640, height = 480;  // the film, in pixels
};

/// Parallel rays that meet the film askew: lines along the view axis show on it.
struct ObliqueParams {
    Placement look_at;
    double world_height = 2;           // what the film's height covers, scene units
    double angle_degrees = 45;         // of receding lines on the film, from the right towards the top
    double scale = 1;                  // their length there: 1 cavalier, 0.5 cabinet, 0 orthographic
    double width = 640, height = 480;  // the film, in pixels
};

/// A pinhole at look_at.eye with square pixels. Throws InputError (place "lookAt", "yfov" or "film") where
/// the parameters leave no camera: eye and at coincide, up is parallel to the view axis, an angle or size out
/// of range.
LinearCamera make_perspective(const PerspectiveParams& params);

/// A camera of parallel rays with square pixels; the film's middle lies at look_at.eye. Throws as above
/// (place "worldHeight" for a height that is not positive).
LinearCamera make_orthographic(const OrthographicParams& params);

/// The same with receding lines: a point at depth z behind the plane through look_at.eye is moved on the
/// film by scale * z along `angle` (Carlbom and Paciorek, Planar Geometric Projections and Viewing
/// Transformations, 1978). Throws as make_orthographic (places "angle", "scale" likewise).
LinearCamera make_oblique(const ObliqueParams& params);

/// The ray of a film place, pixels from the top left, with a direction of unit depth. Throws InputError
/// (place "camera") where the camera's map has no inverse, as that of a default LinearCamera.
Ray film_ray(const LinearCamera& camera, const Vec2& at);

/// The film [0, width] x [0, height] in pixels as two facets with affine screens (w = 1). Each ray's
/// direction has unit depth along the view axis, so t is the planar depth (the Z layer): from the eye for
/// perspective, from the plane through `eye` for parallel cameras. Rays begin at the depth `from` there.
/// Throws InputError: place "film" for a film without pixels, "from" for a depth that is not finite, "camera"
/// for a camera without finite rays (film_ray).
RayMesh make_camera_mesh(const LinearCamera& camera, double width, double height, double from = 0);

/// A camera given corner by corner (the thesis' projections are such). One entry per corner, `triangles`
/// index them.
struct ExplicitRays {
    std::span<const Vec3> points;      // origins, world frame
    std::span<const Vec3> directions;  // not zero, any length: the unit of t
    std::span<const Vec2> screen;      // 0..1 from the film's top left, affine
    std::span<const IdTriple> triangles;
};

/// The RayMesh of explicit rays on a film of width x height pixels. Throws InputError whose place is the
/// field at fault ("directions/3") for lengths that differ, indices out of range, zero or non-finite entries.
RayMesh make_ray_mesh(const ExplicitRays& rays, double width, double height);

// Linear views in the standard terms of Foley et al.: a view volume as a camera.

/// Throws InputError where the volume is none: a zero vpn, vup along it, a window without area, a prp in the
/// view plane, planes out of order, or for perspective a front plane at or behind the prp.
void check_view_volume(const ViewVolume& volume, const CameraSite& site = {});

/// The volume as a camera whose window fills the film (its pixels need not be square).
/// Perspective: the eye is the prp. Parallel: rays start at the depth of the prp.
LinearCamera make_view_volume(const ViewVolume& volume, const FilmSize& film, const CameraSite& site = {});

/// Depths of the clipping planes along the view axis from the prp, as t along the film's rays; near is 0 and
/// far infinite where the volume has none. A parallel front plane may lie before the prp's depth: negative.
struct DepthRange {
    double near_depth = 0, far_depth = std::numeric_limits<double>::infinity();
};
DepthRange depth_range(const ViewVolume& volume);

// The linear cameras of a scene with their clipping planes.

/// What lies nearer than `near_depth` along the view axis (from the eye; parallel cameras: from where their
/// rays start) or farther than `far_depth` is not seen.
struct LinearView {
    LinearCamera camera;
    double near_depth = 0, far_depth = std::numeric_limits<double>::infinity();
};

/// A description that is_linear(). Throws InputError with the field at fault.
LinearView make_linear_view(const CameraDescription& from, const FilmSize& film, const CameraSite& site);

}  // namespace trilens
