// Light's paths as lines in the world: that of a pixel, branch by branch, and those by which a place is seen.
#pragma once

#include <trilens/project.h>
#include <trilens/render.h>

#include <optional>
#include <string>
#include <vector>

namespace trilens {

/// A corner of a path, from the eye on.
struct PathCorner {
    Vec3 point{0};      // world
    std::string event;  // "eye", "reflect", "transmit", "pass", or "seen" or "escapes" at the end
    std::string name;   // of the optic or object that is met; empty in the environment
    Id medium = kNone;  // the optic, as Renderer::optics lists them, in whose glass light runs behind it
};

struct PathLine {
    std::string word;  // of its events: R reflected, T transmitted; empty: direct
    Vec3 weight{1};    // the share of each colour of the light that comes this way
    std::vector<PathCorner> corners;
};

/// What a pixel shows, and by which ways: the ends that its explanation lists, each followed on the exact
/// surfaces. The first is the principal one. `reach`: how long a ray that escapes is drawn, scene units.
/// Throws as Renderer::explain does.
std::vector<PathLine> pixel_paths(const Renderer& renderer, const PictureRequest& request, const Vec2& pixel,
                                  double reach);

/// One image of a place.
struct PlaceImage {
    Vec2 pixel{0};
    bool visible = false;
    PathLine line;
};

struct PlaceImages {
    Vec3 place{0};
    bool complete = false;  // proven: there are no others
    std::vector<PlaceImage> images;
};

/// All images of a world point on the film. Throws as Renderer::project does.
PlaceImages place_images(const Renderer& renderer, const FrameParams& frame, const Vec3& place);

/// The world point that a film place of a camera shows, over mirrors and through glass; none in the
/// environment.
std::optional<Vec3> shown_place(const Renderer& renderer, std::size_t camera, const Vec2& pixel);

}  // namespace trilens
