// Which facets, and which parts of them, are worth probing: optimal stopping over their quadtree by
// dynamic programming (Bellman), in samples of the film.
#pragma once

#include <array>
#include <cstddef>

namespace trilens {

/// What probing facets costs and saves. The unit is following the paths of one sample: that takes as much
/// of a scene's own time as probing one point of a facet does, whatever the scene, so these are constants.
/// Measured, as docs/speed.md tells.
struct ProbeCosts {
    double corner = 1;   // a facet's share of the probes at the grid's corners
    double middle = 2;   // probes at the middles of a part's edges, its principal paths alone
    double inside = 10;  // all paths there and at the centre, the proof, the corner rays, the prediction
    double saved = 0.7;  // by each sample that is projected instead

    /// `per_pixel`: samples of a pixel; from two on what they see is shaded by fragments. `closed_form`: the
    /// optic is met in closed form, for less than proofs take.
    static ProbeCosts of(double per_pixel, bool closed_form);
};

/// Of the parts of facets on each level that were probed.
struct ProbeTally {
    static constexpr int kLevels = 8;  // deeper ones count with the last
    struct Level {
        std::size_t parts = 0;      // that are on the film
        std::size_t agree = 0;      // of them: may be projected, by their corners' principal paths
        std::size_t probed = 0;     // of these: were probed
        std::size_t projected = 0;  // of these: are projected
    };
    std::array<Level, kLevels> level{};

    Level& at(int depth) { return level[static_cast<std::size_t>(depth < kLevels ? depth : kLevels - 1)]; }
    void add(const ProbeTally& other);
};

/// Decides for one optic, by what was found at some of its facets.
class ProbePlan {
  public:
    /// All parts are probed.
    ProbePlan() = default;
    /// `per_pixel`: samples in a square pixel, > 0.
    ProbePlan(double per_pixel, const ProbeCosts& costs, const ProbeTally& survey);

    bool decides() const { return per_pixel_ > 0; }
    /// Samples in that many square pixels.
    double samples_in(double area) const;

    /// Whether a whole facet with so many samples is worth the probes at its corners.
    bool is_worth_corners(double samples) const;
    /// Whether a part whose corners agree is worth the probes inside.
    bool is_worth_inside(int level, double samples) const;
    /// Whether a part that is not projected is worth dividing. `probed`: it was.
    bool is_worth_dividing(int level, double samples, bool probed) const;

    /// The fewest samples of a facet whose corners are probed; infinite where none is worth it.
    double least_samples() const;

    const ProbeCosts& costs() const { return costs_; }

  private:
    struct Share {
        double agree = 1, projected = 1;
    };
    const Share& share(int level) const;
    double parts(int level, double samples) const;
    double inside(int level, double samples, double of_parts) const;
    double part(int level, double samples) const;

    double per_pixel_ = 0;  // 0: all parts are probed
    ProbeCosts costs_;
    std::array<Share, ProbeTally::kLevels> share_{};
};

}  // namespace trilens
