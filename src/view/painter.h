// Progressive drawing of a session's state: a coarse picture, all pixels, then more samples, one stage at a
// time.
#pragma once

#include <trilens/animation.h>
#include <trilens/render.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "view/paths.h"
#include "view/pixels.h"
#include "view/session.h"

namespace trilens {

/// What is drawn of a state, in this order. kCoarse: fewer pixels, where all would take long; of the exact
/// engine they are traced. kPixels: one sample in each. kLines: paths, images of places, edges, folds, the
/// bird's-eye view. kComparison: the truth and what is measured against it. kFine, kFinest: 4 x 4 and 8 x 8
/// samples.
enum class DrawStage { kCoarse, kPixels, kLines, kComparison, kFine, kFinest, kDone };

template <>
struct EnumNames<DrawStage> {
    static constexpr std::array kTable{NamedValue<DrawStage>{DrawStage::kCoarse, "coarse"},
                                       NamedValue<DrawStage>{DrawStage::kPixels, "pixels"},
                                       NamedValue<DrawStage>{DrawStage::kLines, "lines"},
                                       NamedValue<DrawStage>{DrawStage::kComparison, "comparison"},
                                       NamedValue<DrawStage>{DrawStage::kFine, "4 x 4"},
                                       NamedValue<DrawStage>{DrawStage::kFinest, "8 x 8"},
                                       NamedValue<DrawStage>{DrawStage::kDone, "done"}};
};

/// A path in the bird's-eye picture: polylines of its pixels, since what lies behind that camera is left out.
struct DrawnLine {
    std::vector<Vec2> points;
    bool in_glass = false;
    double weight = 1;  // the mean over the colours
    enum class Kind { kCamera, kPixelPath, kPlacePath } kind = Kind::kPixelPath;
};

struct ShownBirdsEye {
    Pixels picture;
    std::vector<DrawnLine> lines;
    std::optional<Vec2> place;  // where it shows the picked place
};

/// What is known of the comparison with the truth.
struct ShownComparison {
    Metrics metrics;
    std::optional<Summary> displacement;        // pixels; none where nothing was measured
    std::size_t lost = 0;                       // pixels whose point the truth does not show near
    double displacement_end = 1, flip_end = 1;  // of the heat maps' scales
};

/// All that a window shows, whole. Parts that a state does not ask for are empty; parts that are not drawn
/// yet are those of the state before.
struct Drawn {
    std::uint64_t order = 0;               // of the state that `left` shows
    DrawStage stage = DrawStage::kCoarse;  // the last that is in
    int film_width = 0, film_height = 0;
    std::shared_ptr<const Pixels> left, right, overlay;
    std::shared_ptr<const ShownBirdsEye> birds_eye;
    std::shared_ptr<const std::vector<EdgeLine>> edges;
    std::shared_ptr<const std::vector<FoldCurve>> folds;
    std::shared_ptr<const std::vector<PathLine>> pixel_paths;
    std::shared_ptr<const PlaceImages> place_images;
    std::shared_ptr<const ShownComparison> comparison;
    std::vector<OpticInfo> optics;
    std::optional<AnimationInfo> animation;
    LayerStatistics statistics;
    double draw_seconds = 0;            // of the projected picture's last stage
    std::string error;                  // of the newest state; empty: none
    std::vector<std::string> warnings;  // of its scene and its pictures
};

/// A state that is to be drawn.
struct DrawOrder {
    std::uint64_t number = 0;  // grows
    std::string file, folder;
    SessionState state;
};

/// What a stage has drawn, for those who show it elsewhere.
struct StagePictures {
    const Drawn& drawn;
    const Image& projected;                     // of as many pixels as the stage has
    const Image& truth;                         // empty where it is not drawn
    const std::vector<FacetEdge>& facet_edges;  // where facets are an overlay
};

/// Is told of each stage; may add to the warnings that the window shows.
using WatchStage = std::function<void(const StagePictures&, std::vector<std::string>& warnings)>;

/// Draws for one thread. Keeps the scene's surfaces and trees from state to state.
class Painter {
  public:
    Painter();
    ~Painter();

    /// Turns to a new state: loads the scene where it differs. What goes wrong, here and in draw_next, stands
    /// in drawn().error; pictures stay those of the state before.
    void begin(const DrawOrder& order);

    /// Draws the next stage; false where nothing is left to draw, or the state cannot be drawn. Throws
    /// Interrupted once `progress` says so: then nothing of that stage is in drawn().
    bool draw_next(const Progress& progress = {});

    /// From now on `watch` is told of each stage that is in; empty: nobody.
    void watch(WatchStage watch);

    DrawStage next() const;
    const Drawn& drawn() const;

    /// The picture of the state as the projector draws it with the film's own samples, and its scene, to be
    /// saved.
    Image picture();
    /// The state's outlines as an SVG document.
    std::string svg();

  private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace trilens
