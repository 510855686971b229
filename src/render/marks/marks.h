// Points and labels on pictures: each image of a place as an ellipse (a splat), or a text, over the light
// that comes the same way. After: Zwicker and others, Surface Splatting, SIGGRAPH 2001 (the ellipse is what
// the projection's derivative makes of a ball).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/util/error.h"
#include "render/frame/request.h"
#include "render/frame/views.h"

namespace trilens {

struct World;

/// An ellipse about a pixel p0: the p with (p - p0)^T S^-1 (p - p0) <= 1, S = (xx, xy; xy, yy), square
/// pixels.
struct Spread {
    double xx = 0, xy = 0, yy = 0;

    double determinant() const { return xx * yy - xy * xy; }
    // Squares of its longer and its shorter half axis, and the angle from x to the longer one.
    double most() const { return middle() + radius(); }
    double least() const { return std::max(0.0, middle() - radius()); }
    double angle() const { return 0.5 * std::atan2(2 * xy, xx - yy); }

  private:
    double middle() const { return 0.5 * (xx + yy); }
    double radius() const { return std::hypot(0.5 * (xx - yy), xy); }
};

/// One image of a point, or of a label's place.
struct PlacedMark {
    bool is_label = false;
    std::size_t entry = 0;  // index into Scene::points or Scene::labels
    std::size_t point = 0;  // of a cloud: which
    Path path = Path::kDirect;
    Id optic = kNone;       // object id of the first optic; kNone: seen directly
    std::size_t steps = 0;  // meetings with optics
    Vec2 pixel{0};          // from the film's top left; a pixel's centre is at .5
    Spread spread;          // of its ellipse, or a label's dot; zero: it has none
    double opacity = 1;     // below 1 where the ellipse was widened to be as wide as a pixel
    double distance = 0;    // along the path from the first optic's event, or the eye, scene units
    Vec3 light{0};          // its colour times what the path lets through
    double replaces = 1;    // the share that it hides of the light that comes its way
};

/// What a frame shows of a scene's marks.
struct PlacedMarks {
    std::vector<PlacedMark>
        marks;                // those on the film, as they are painted: clouds from far to near, then labels
    std::size_t hidden = 0;   // images on the film that something stands before
    std::size_t places = 0;   // points and labels
    std::size_t unseen = 0;   // of these, without any image that is drawn
    std::size_t unsized = 0;  // splats with a radius whose derivative is not known: as wide as `size` says
    std::size_t crowded_out = 0;  // images of labels that would have covered others, and give way
    std::size_t cut = 0;          // splats that would be longer than kLongestSplat: at folds
};

/// Half of a splat's length, pixels: at folds, where the derivative is infinite, they end there.
inline constexpr double kLongestSplat = 64;

/// Finds the images of all points and labels on the exact surfaces, as project does (project.h), whatever the
/// frame's facets show. Throws as project_points does, and Interrupted.
PlacedMarks place_marks(const World& world, const FrameParams& frame, const Progress& progress = {});

/// A rectangle of the film, pixels.
struct FilmBox {
    Vec2 low{0}, high{0};

    bool is_empty() const { return !(low.x < high.x && low.y < high.y); }
    FilmBox common(const FilmBox& other) const {
        return {glm::max(low, other.low), glm::min(high, other.high)};
    }
    /// What is empty meets nothing.
    bool meets(const FilmBox& other) const { return !common(other).is_empty(); }
};

/// Where a mark's ellipse or dot lies, and a label's letters with the halo around them; what it lacks is an
/// empty box at its place.
std::array<FilmBox, 2> mark_boxes(const World& world, const PlacedMark& mark);

/// Leaves out images of labels that give way and whose letters or dot would cover another label's on the
/// film. Those that do not give way stand first, then those of higher priority, of these the nearer ones, and
/// else those that the scene has first.
void leave_out_crowded(const World& world, PlacedMarks& marks);

/// What a picture of the world leaves out of its marks.
void tell_marks(const World& world, const PlacedMarks& marks, const Warn& warn);

/// Black or white: what is farther from a label's colour stands around its letters.
Vec3 contrast_of(const Vec3& color);

/// Paints marks over pixels. The world and the marks must outlive it. Thread-safe to read.
class MarkPainter {
  public:
    /// `shown`: as LayerRequest::shown, of the pixels that are painted over.
    MarkPainter(const World& world, const PlacedMarks& marks,
                const std::function<Vec3(const Vec3& light)>& shown = {});

    /// Paints over the pixel x, y, whose centre shows the optic `shown` (an object id; kNone: none) first. A
    /// mark hides the light that comes its way in the part of the pixel that it covers: all light where it is
    /// seen directly, else that over its own first event.
    void paint(int x, int y, Id shown, SampleColour& colour) const;

    /// Where a label's text stands on the film: left, top.
    static Vec2 text_corner(const World& world, const PlacedMark& mark);

  private:
    /// What a share of a pixel shows instead: how much of the light there, and of which part of it.
    struct Paint {
        Vec3 light{0};
        double replaces = 1;
        Path path = Path::kDirect;
    };
    void paint_text(const PlacedMark& mark, const Vec2& pixel, SampleColour& colour) const;
    static void cover(const Paint& paint, double share, SampleColour& colour);

    const World& world_;
    const PlacedMarks& marks_;
    std::function<Vec3(const Vec3& light)> shown_;
    int columns_ = 0;                 // of tiles
    std::vector<std::size_t> first_;  // per tile and one more: where its marks begin in of_tile_
    std::vector<Id> of_tile_;
};

}  // namespace trilens
