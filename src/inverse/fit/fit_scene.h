// The part of a scene that images of points depend on, made anew where a fit's parameters move it.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/raymesh/surface.h"
#include "camera/camera.h"
#include "intersect/limit_tracer.h"
#include "inverse/fit/parameters.h"
#include "scene/data/polygons.h"
#include "scene/data/scene.h"

namespace trilens {

/// An optic: a surface as it was built, moved since by an affine map, under which limit surfaces stay limit
/// surfaces, so that nothing is built again.
struct FitOptic {
    Id mesh = kNone;
    bool mirror = true;  // else glass
    int priority = 0;
    double ior = 1;
    std::shared_ptr<const Surface> surface;     // as built
    std::shared_ptr<const LimitTracer> tracer;  // of it; null where only its parameters are asked for
    Transform built;                            // the mesh's transform when it was built
    Transform moved, unmoved;                   // from there to where it is now, and back
    bool is_moved = false;
};

/// Cameras of the scene, and its optics.
struct FitScene {
    std::vector<Camera> cameras;
    std::vector<FitOptic> optics;
};

/// Position and derivatives as the moved surface has them, of those as built.
SurfacePoint moved_point(const FitOptic& optic, const SurfacePoint& as_built);

/// Makes the scene's parts of its JSON. Keeps a reference to the scene.
class FitSceneMaker {
  public:
    /// Throws InputError where an optic has overridden normals, whose images are no stationary paths.
    explicit FitSceneMaker(const Scene& scene);

    /// Whole, with tracers. `parameters`: those that will move: meshes whose transform alone moves are built
    /// once.
    FitScene make(const Json& document, const std::vector<FitParameter>& parameters);

    /// Puts the part that the parameter stands in, as `part` has it, into a scene made before. Throws
    /// InputError where it is none. `with_tracer`: for rays; else for derivatives.
    void set_part(FitScene& scene, const FitParameter& parameter, const Json& part, bool with_tracer) const;

  private:
    Camera camera_of(const Json& json, std::size_t index) const;
    void set_mesh(FitScene& scene, std::size_t index, const Json& json, bool with_tracer) const;
    void build(FitOptic& optic, const Mesh& mesh, bool with_tracer) const;
    std::string file() const { return scene_title(scene_); }

    const Scene& scene_;
    std::set<std::size_t> moves_only_;  // meshes of which only the transform changes
    std::set<std::size_t> moved_materials_;
};

}  // namespace trilens
