// FLIP: how strongly one sees two pictures alternate on a screen (Andersson, Nilsson, Akenine-Moeller,
// Oskarsson, Astroem, Fairchild, FLIP: A Difference Evaluator for Alternating Images, High Performance
// Graphics 2020).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace trilens {

/// A screen 0.7 m wide with 3840 pixels, seen from 0.7 m: 3840 pi / 180.
inline constexpr double kFlipPixelsPerDegree = 67.02064327658226;

/// Linear Rec.709, one value of each per pixel, rows from the top.
struct ColourPicture {
    int width = 0, height = 0;
    std::span<const float> r, g, b;
};

/// What FLIP makes of a window of one picture.
struct FlipWindow;

/// Of one reference that many tests are held against: what was made of it last. Thread-safe.
class FlipReference {
  public:
    /// What `make` returns, or what it returned last where that was for the same window.
    std::shared_ptr<const FlipWindow> get(const std::array<int, 4>& window,
                                          const std::function<FlipWindow()>& make);

  private:
    std::mutex mutex_;  // of what follows
    std::array<int, 4> window_{};
    std::shared_ptr<const FlipWindow> kept_;
};

/// The error of each pixel, from 0 (no difference to be seen) to 1, of the low dynamic range metric: colours
/// are shown at exposure 1, that is clamped to 0..1 as a screen does (what is brighter than white differs in
/// nothing; HDR-FLIP's exposures are not searched). Not a number where a picture is not finite; there both
/// count as black for their neighbours. `pixels_per_degree` (> 0) of visual angle. `kept`: of the same
/// reference and pixels per degree always.
std::vector<float> flip_map(const ColourPicture& reference, const ColourPicture& test,
                            double pixels_per_degree = kFlipPixelsPerDegree, FlipReference* kept = nullptr);

}  // namespace trilens
