// Caustics as data: the irradiance of a light over optics, on the texture coordinates of an object or a
// plane.
#pragma once

#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/error.h"
#include "inverse/maps/target.h"

namespace trilens {

struct World;

struct CausticMapRequest {
    std::size_t light = 0;     // index into Scene::lights; its own `caustics` is not asked
    TargetDescription target;  // a plane or an object
    bool back = false;         // the light that comes to the other side of the surface than its front
    // The truth, as traced pictures have it: beams divided by exact rays until they are flat at each pixel.
    bool exact = false;
    // How far light may fall from its place, as a share of the scene's size.
    double tolerance = 1e-3;
};

/// Light per colour, linear Rec.709: irradiance in lux, or W/m^2, and flux in lumen, or watt, as the light's
/// intensity is meant, with lengths in scene units.
struct CausticMap {
    int width = 0, height = 0;
    std::vector<Vec3> irradiance;  // per pixel, its mean over the pixel; rows from the top
    std::vector<char> covered;     // per pixel: the object is there
    Vec3 flux_in{0};               // from the light to the optics
    Vec3 flux_on_objects{0};       // from the optics to objects
    Vec3 flux_away{0};             // from the optics out of the scene
    Vec3 flux_received{0};         // in the map
    std::size_t beams = 0, histories = 0;
    std::size_t coarse = 0;             // parts of the light that the tolerance would have divided further
    std::vector<std::string> warnings;  // what the map leaves out, in words
};

/// Throws UsageError for a light that the scene does not have, or that has no rays of its own (ambient), a
/// target that is neither a plane nor an object, and what Target throws; Interrupted.
CausticMap make_caustic_map(const World& world, const CausticMapRequest& request,
                            const Progress& progress = {});

/// Channels R, G, B (irradiance) and A (covered).
Image image_of(const CausticMap& map);

}  // namespace trilens
