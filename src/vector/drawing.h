// A picture as lines: the outlines of what the camera and its optics show.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/frame/frame.h"
#include "vector/caustic.h"
#include "vector/fold_curves.h"
#include "vector/lines.h"
#include "vector/view.h"

namespace trilens {

/// The curves of one path of light.
struct DrawingLayer {
    std::string path;                      // "direct", "reflect", "refract"
    Id optic = kNone;                      // object id of the optic that shows them; kNone for "direct"
    const TriangleScene* scene = nullptr;  // of the curves' triangles
    std::vector<EdgeCurve> curves;
    std::vector<FoldCurve> folds;
    std::vector<CausticSheet> caustic;
};

struct Drawing {
    int width = 0, height = 0;
    LineChoice lines;
    TriangleScene visible;  // objects, then the optics' facets: what "direct" shows
    std::vector<std::unique_ptr<DrawingLayer>> layers;
    std::vector<FacetEdge> facet_edges;
};

/// Draws what the exact engine shows over each pixel's principal paths; one layer for each history. `warn` is
/// told of what is traced and so has no lines. The world must outlive the drawing. Throws as make_frame does.
std::unique_ptr<Drawing> make_drawing(const World& world, const FrameParams& frame, const LineChoice& lines,
                                      const Warn& warn);

/// How far, in pixels, the Bezier curves of the SVG may leave the exact conics.
inline constexpr double kSvgTolerance = 0.01;

/// The drawing as an SVG document: one path per curve, its cubic Bezier curves within kSvgTolerance of the
/// conics. The exact arcs stand in its attribute data-conic: "x0 y0 x1 y1 x2 y2 w" for each, a rational
/// quadratic Bezier curve with Bezier weights 1, w, 1.
std::string drawing_svg(const Drawing& drawing, const World& world);

/// The caustics as triangles, and the fold curves where they lie on objects as lines, in a Wavefront OBJ,
/// world frame: an object for each sheet and each curve, "OPTIC-PATH-first", "-second", with "-virtual"
/// behind the optic, "OPTIC-PATH-fold-on-OBJECT"; the camera's own begin with "camera".
std::string drawing_obj(const Drawing& drawing, const World& world);

}  // namespace trilens
