// Which samples of a terrain its triangles keep: wavelets' detail signals, weighted by a region of interest.
// After Gross, Staadt, Gatti, Efficient Triangular Surface Approximations Using Wavelets and Quadtree Data
// Structures (1996).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/math/vec.h"
#include "base/util/names.h"
#include "terrain/film_scale.h"
#include "terrain/height_square.h"

namespace trilens {

/// What decides whether a sample may go.
enum class ThinningRule {
    kBound,   // linear wavelets on the bisected triangles: the sum of what is left out is a bound
    kLinear,  // the energy of the linear wavelet's detail signal there and at four neighbours
    kHaar,    // the same of Haar's
};

template <>
struct EnumNames<ThinningRule> {
    static constexpr std::array kTable{NamedValue<ThinningRule>{ThinningRule::kBound, "bound"},
                                       NamedValue<ThinningRule>{ThinningRule::kLinear, "linear"},
                                       NamedValue<ThinningRule>{ThinningRule::kHaar, "haar"}};
};

/// Details count by exp(-d^2), d their distance from the centre where the radii are 1: 1 there, next to
/// nothing three radii away.
struct InterestRegion {
    Vec2 center{0};   // x and z, in the terrain's own frame
    Vec2 radii{1};    // along its two axes
    double turn = 0;  // degrees from x towards z of the first axis
};

/// What details count by: the product of both, 1 where there are none.
struct DetailWeights {
    std::optional<InterestRegion> region;
    const FilmScale* scale = nullptr;  // must outlive it
};

/// How much each sample of the square matters, in heights: a triangulation keeps those that matter more than
/// its threshold, and with every sample it keeps those that its triangles' corners rest on, for none matters
/// less than what rests on it. Of kBound it is, where weights are 1, a bound of how far the surface moves, at
/// any point, where the sample and all that rests on it go; weighted by a scale it is one in pixels. What
/// touches a missing sample matters without end.
class SampleWorth {
  public:
    SampleWorth(const HeightSquare& heights, ThinningRule rule, const SampleSpacing& spacing,
                const DetailWeights& weights);

    float at(int x, int y) const { return worth_[heights_.index(x, y)]; }

  private:
    class Signals;
    template <typename Own>
    void gather(const Own& own);

    const HeightSquare& heights_;
    std::vector<float> worth_;
};

}  // namespace trilens
