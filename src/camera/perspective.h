// Linear cameras from what a user says about them, and the two facets that make any linear camera a RayMesh.
#pragma once

#include <span>

#include "base/linear_camera.h"
#include "base/ray_mesh.h"

namespace trilens {

/// Where a camera stands, world frame. `up` need not be unit nor at right angles to the view axis.
struct Placement {
    Vec3 eye{0, 0, 1}, at{0}, up{0, 1, 0};
};

struct PerspectiveParams {
    Placement look_at;
    double yfov_degrees = 40;       // the whole vertical angle, inside (0, 180)
    int width = 640, height = 480;  // the film, in pixels
};

struct OrthographicParams {
    Placement look_at;
    double world_height = 2;        // what the film's height covers, scene units
    int width = 640, height = 480;  // the film, in pixels
};

/// A pinhole at look_at.eye with square pixels. Throws InputError (place "lookAt", "yfov" or "film") where
/// the parameters leave no camera: eye and at coincide, up is parallel to the view axis, an angle or size out
/// of range.
LinearCamera make_perspective(const PerspectiveParams& params);

/// A camera of parallel rays with square pixels; the film's middle lies at look_at.eye. Throws as above
/// (place "worldHeight" for a height that is not positive).
LinearCamera make_orthographic(const OrthographicParams& params);

/// The film [0, width] x [0, height] in pixels as two facets with affine screens (w = 1). Each ray's
/// direction has unit depth along the view axis, so t is the planar depth (the Z layer): from the eye for
/// perspective, from the plane through `eye` for parallel cameras.
RayMesh make_camera_mesh(const LinearCamera& camera, int width, int height);

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
RayMesh make_ray_mesh(const ExplicitRays& rays, int width, int height);

}  // namespace trilens
