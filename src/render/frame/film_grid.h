// An optic's grid on the film of a camera that is not linear: where its facets appear, perhaps several times.
#pragma once

#include <vector>

#include "base/raymesh/linear_camera.h"
#include "base/raymesh/surface.h"
#include "camera/model/camera_model.h"

namespace trilens {

/// The grid's facets once for each place at which a branch of the camera shows them (twice where they lie
/// across a panorama's seam), with affine screens. Facets that no film place can show are left out.
struct FilmGrid {
    SurfaceGrid grid;               // facets in their places; points are those of the original
    std::vector<CornerView> views;  // per corner of `grid`
    std::vector<Id> original;       // per facet of `grid`: the facet it is
    std::vector<std::size_t> first,
        placed;                       // original facet f is at placed[first[f]] .. placed[first[f+1]-1]
    std::vector<std::size_t> branch;  // per facet of `grid`
    std::vector<Vec2> middle;         // likewise, pixels
    std::vector<double> reach;        // how far from its middle the film may show it, pixels
    std::size_t lost = 0;  // facets with a corner on the film and none to be placed: across a pole, or partly
                           // where the camera has no image

    /// The facet of `grid` by which the film shows original facet f at that place: the nearest of the branch
    /// that the film shows there; where that has none, the nearest of another that reaches so far (branches
    /// go on smoothly). kNone where none does.
    Id facet_at(Id f, const Vec2& at, const CameraModel& model) const;
};

FilmGrid make_film_grid(const SurfaceGrid& grid, const CameraModel& model, const FilmSize& film);

}  // namespace trilens
