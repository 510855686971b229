// Acceleration structures and grids of a world, built lazily.
#pragma once

#include <memory>

#include "base/raymesh/surface.h"
#include "base/util/parallel.h"
#include "intersect/limit_tracer.h"
#include "intersect/tracer.h"
#include "paths/trace/path_world.h"
#include "projector/projector.h"
#include "render/world/world.h"

namespace trilens {

struct CausticLights;

/// An optic's grid at one resolution. Its facets as a scene: triangle f is facet f, its object the optic's.
class OpticFacets {
  public:
    OpticFacets(SurfaceGrid grid, Id object) : grid_(std::move(grid)), object_(object) {}

    const SurfaceGrid& grid() const { return grid_; }
    TriangleScene scene() const;
    const PreparedScene& prepared() const;
    const Tracer& tracer() const;

  private:
    SurfaceGrid grid_;
    Id object_ = kNone;
    Lazy<PreparedScene> prepared_;
    Lazy<Tracer> tracer_;
};

/// Makes room for what is built later; called once, when the world has all its optics.
void prepare_geometry(World& world);

/// The same where a changed world keeps parts: `kept_optics` holds, per optic of now, the index it had before
/// or kNone; `keeps_objects`: all objects are as they were.
void keep_geometry(World& world, const std::vector<Id>& kept_optics, bool keeps_objects);

/// The objects for the projector, and for rays.
const PreparedScene& prepared_objects(const World& world);
const Tracer& object_tracer(const World& world);

/// The exact surface of an optic for rays.
const LimitTracer& limit_tracer(const World& world, std::size_t optic);

/// All optics as paths meet them, with their exact surfaces, and how far the scene has paths followed.
const PathWorld& path_world(const World& world);

/// Whether any light asks what lies between it and a point.
bool has_shadows(const World& world);

/// The segments that an object, or the exact surface of a mirror, meets. Glass lets the light through.
Segments::Bits casts_shadow(const World& world, const Segments& segments);

/// The segments that an object or an optic of any kind meets: where light that is followed over optics does not
/// come straight.
Segments::Bits meets_anything(const World& world, const Segments& segments);

/// The beams of lights with caustics, made when first asked for.
const CausticLights& caustic_lights(const World& world);

/// Builds what casts_shadow asks, where the scene has shadows: before many threads do.
void prepare_shadows(const World& world);

/// The optic's facets at resolution n. The last resolution of each optic is kept, so that a new camera finds
/// it.
std::shared_ptr<const OpticFacets> optic_facets(const World& world, std::size_t optic, int n);

}  // namespace trilens
