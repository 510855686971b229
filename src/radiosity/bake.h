// Radiosity of a world's matt objects, kept as light at the corners of their triangles.
//
// Sides of patches exchange light by form factors; the scene's lights bring theirs by the shading that
// pictures have, emissive surfaces by their form factors. Then the corners of elements, parts of patches that
// are halved where light changes, gather what patches send.
// Source: Cohen, Greenberg, Immel, Brock, An Efficient Radiosity Approach for Realistic Image Synthesis, IEEE
// CG&A 1986 (patches and elements); Lischinski, Tampieri, Greenberg, Combining Hierarchical Radiosity and
// Discontinuity Meshing, SIGGRAPH 1993 (gathering at the end).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/util/error.h"
#include "radiosity/settings.h"
#include "scene/data/scene.h"

namespace trilens {

struct World;

struct BakeRequest {
    RadiositySolver solver = RadiositySolver::kProgressive;
    FormFactorMethod form_factors = FormFactorMethod::kHemicube;
    int hemicube_resolution = 64;       // pixels along an edge, even, 2..1024
    int rays = 4096;                    // of form factors by rays: from each side, 1..1e7
    double tolerance = 1e-3;            // share of the power that may be left unshot, above 0, below 1
    double patch_size = 1.0 / 16;       // longest edge at most: share of the diagonal of the scene's box
    double smallest_size = 1.0 / 128;   // elements whose longest edge is at most this are not halved
    double contrast = 0.2;              // of light at an element's corners, in means over the scene
    std::size_t most_elements = 50000;  // halving stops before there are more
    std::size_t checked_vertices = 64;  // whose light is found both by hemicube and by rays
    bool keeps_lights = false;          // the scene's lights go on shining: only what comes after is baked
};

/// Power, per colour: radiance times area times pi, in scene units.
struct RadiosityBalance {
    Vec3 emitted{0};      // by materials
    Vec3 from_lights{0};  // that the scene's lights bring to the objects
    Vec3 absorbed{0};     // by the objects
    Vec3 blocked{0};      // what comes to mirrors and to unlit objects, and stays there
    Vec3 escaped{0};      // out of the scene
    Vec3 unshot{0};       // what is still on its way
};

/// How far the light that vertices gather by hemicubes is from that by rays: |a - b| / max(a, b).
struct GatherCheck {
    std::size_t vertices = 0;
    double mean = 0, most = 0;
};

struct BakeReport {
    std::size_t triangles = 0;  // of the lit objects, before
    std::size_t patches = 0;    // that send light
    std::size_t elements = 0;   // parts of patches, at whose corners light is kept
    std::size_t vertices = 0;   // places and sides where it was computed
    std::size_t flat = 0;       // patches without area: they have no part
    std::size_t passes = 0;     // of halving
    std::size_t coarse = 0;     // elements that the contrast would have halved further
    RadiosityBalance balance;   // of patches
    std::vector<RadiosityStep> convergence;
    GatherCheck check;
    std::vector<std::string> warnings;  // of what is left out
};

struct Bake {
    Scene scene;  // with baked light in its meshes, its lights marked as baked, and JSON that says so
    BakeReport report;
};

/// Throws UsageError for numbers out of their ranges; InputError where the scene has no lit object, nothing
/// that shines, light that is baked already, more patches than most_elements, or where rows
/// of form factors do not fit in memory; ComputationError for light that is not finite; Interrupted. The same
/// light for any number of threads.
Bake bake_light(const World& world, const BakeRequest& request, const Progress& progress = {});

/// The convergence as a plot: the share that is unshot over the rows that were shot or gathered. `file` ends
/// in .svg or .pdf: the document's bytes. Throws UsageError for other endings.
std::string convergence_plot(const BakeReport& report, const std::string& file);

}  // namespace trilens
