// What every sample shows, found by projection or by ray tracing: one record for all engines.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "base/ray_mesh.h"
#include "base/sample_grid.h"
#include "base/triangle_scene.h"
#include "cli/world.h"
#include "projector/classic.h"

namespace trilens {

/// What a sample shows by way of an optic.
struct SecondaryView {
    bool has_ray = false;  // false: no optic, no such path, or no ray (total internal reflection)
    Ray ray;               // world; leaves the optic
    Hit hit;               // of World::objects
};

/// What one sample shows.
struct SampleView {
    Ray ray;              // the camera's
    Hit hit;              // of World::objects; unset where an optic is nearer
    double depth = 1e30;  // t along `ray` of whatever is first; distance along the view axis

    Id optic = kNone;         // index into World::optics
    Id facet = kNone;         // of the optic's grid; limit truth: face of the surface
    Vec2 uv{0};               // in the facet's face
    double cos_incident = 1;  // between the ray and the optic's normal, 0..1
    bool front = true;        // the ray comes from the side the normal points to
    SecondaryView reflect, refract;
};

/// Fills views[s] for every sample s of the grid; views.size() == grid.size().
using Viewer = std::function<void(const SampleGrid& grid, std::span<SampleView> views)>;

enum class Engine { kExact, kClassic, kFacetsTruth, kLimitTruth };

/// An engine with its settings.
struct EngineChoice {
    Engine engine = Engine::kExact;
    ClassicParams classic;  // of kClassic

    EngineChoice() = default;
    EngineChoice(Engine chosen) : engine(chosen) {}
    EngineChoice(const ClassicParams& params) : engine(Engine::kClassic), classic(params) {}
};

/// A viewer of `world` from one of its cameras. The world must outlive it. Throws InputError where the camera
/// cannot show what the scene has.
Viewer make_viewer(const World& world, std::size_t camera, const EngineChoice& engine, const Warn& warn);

/// "exact", "classic", "facets", "limit".
std::string engine_name(Engine engine);

/// How the classic engine draws: "arcs", "slices 4, clip screen".
std::string classic_name(const ClassicParams& params);

}  // namespace trilens
