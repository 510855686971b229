// One pixel explained: every ray, hit and weight behind it.
#pragma once

#include <optional>
#include <vector>

#include "camera/model/general_linear.h"
#include "render/frame/request.h"
#include "render/frame/views.h"

namespace trilens {

struct World;

/// What the centre of a pixel shows, and how. Facets are named after the general linear cameras (Yu and
/// McMillan 2004): the camera's across its view axis, those of the ends across the mean of their corner rays.
struct PixelExplanation {
    int x = 0, y = 0;
    SampleViews views;  // of the one sample
    SampleColour colour;
    Id camera_facet = kNone;  // of Camera::mesh; kNone: the limit truth's exact ray, or no ray
    std::optional<GeneralLinearKind> camera_kind;
    std::vector<std::optional<GeneralLinearKind>> end_kinds;  // as views.ends; none where no facet was used

    const SampleView& view() const { return views.samples.front(); }
};

/// The pixel (x, y) of the film, whatever the request's window. Throws UsageError outside of the film, and as
/// make_viewer does.
PixelExplanation explain_pixel(const World& world, const PictureRequest& request, int x, int y);

}  // namespace trilens
