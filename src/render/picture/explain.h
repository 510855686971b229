// One pixel explained: every ray, hit and weight behind it.
#pragma once

#include <optional>
#include <vector>

#include "camera/model/general_linear.h"
#include "paths/trace/path.h"
#include "render/frame/request.h"

namespace trilens {

struct World;

/// One end of the pixel's paths over an optic. Its weight is the share of the light from what it sees that
/// comes to the camera, as a ShotRay's: all along the path, unlike a PathEnd's.
struct PixelEnd : PathEnd {
    std::vector<Step> steps;  // the meetings with optics, the first among them
    std::optional<GeneralLinearKind>
        facet_kind;  // across the mean of its corner rays; none: no facet was used
    bool cut = false;  // it would meet another optic, but maxDepth ends it: what it sees lies straight on
};

/// What the centre of a pixel shows, and how. Facets are named after the general linear cameras (Yu and
/// McMillan 2004).
struct PixelExplanation {
    int x = 0, y = 0;
    Ray ray;                  // the camera's, world frame
    Hit hit;                  // of the scene's objects; unset where an optic is nearer, or nothing is met
    double depth = 1e30;      // t along `ray` of whatever is first; distance along the view axis
    Id camera_facet = kNone;  // of Camera::mesh; kNone: the limit truth's exact ray, or no ray
    std::optional<GeneralLinearKind> camera_kind;  // of that facet, across the camera's view axis

    Id optic = kNone;  // which of the scene's optics is first, in scene order; kNone: none, and then nothing
                       // follows but the colours
    Id facet = kNone;  // of its grid; limit truth: face of the surface
    Vec2 uv{0};        // in the facet's face
    double cos_incident = 1;  // between `ray` and the normal on its side
    bool front = true;        // the ray comes from the side that normals point to
    bool traced = false;      // its own paths were followed, those of no facet
    int level = 0;            // how often its facet was divided
    std::vector<PixelEnd> ends;

    Vec3 direct{0}, reflect{0}, refract{0};  // linear Rec.709; they add up to the beauty

    /// The principal end on this path, which layers show; null where it has none.
    const PixelEnd* find(Path path) const;
};

/// The pixel (x, y) of the film, whatever the request's window. Throws UsageError outside of the film, and as
/// make_viewer does.
PixelExplanation explain_pixel(const World& world, const PictureRequest& request, int x, int y);

}  // namespace trilens
