// The first surface that a ray meets: exact optics among objects.
#pragma once

#include "base/raymesh/triangle_scene.h"
#include "intersect/limit_tracer.h"
#include "intersect/tracer.h"
#include "paths/trace/follow.h"

namespace trilens {

/// What a camera's ray meets first: an optic, else an object, else nothing.
struct FirstSurface {
    Hit object;        // unset where an optic comes first
    Id optic = kNone;  // index into PathWorld::optics
    SurfaceHit at;     // where it is met; of an optic only
};

/// Along `ray` (world frame, any length) up to t = reach. Of optics that touch where it meets them the one
/// whose turn it is (coincident_order); an object on which a body of glass lies comes before the body's
/// surface, met from inside.
FirstSurface first_surface(const PathWorld& world, const Tracer& objects, const Ray& ray, double reach);

}  // namespace trilens
