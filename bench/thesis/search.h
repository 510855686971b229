// Finds facets and scene triangles of a wanted configuration (random draws, then hill climbing), and says how
// well a picture shows it.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "trilinear/outline.h"

namespace trilens {

// A facet and a scene triangle whose shapes form a wanted configuration, and how well a picture shows them.

/// The shapes' vertex counts, ascending: (2,2,2,3), (3,3,3), ...
using Configuration = std::vector<std::size_t>;

struct FacetScene {
    TrilinearFacet facet;
    SceneTriangle triangle;
};

/// Where the facet's corners lie on the film, 0..1 from its top left: the facet holds the whole film.
inline constexpr std::array<Vec2, 3> kFacetOnFilm{Vec2(-0.5, 1), Vec2(1.5, 1), Vec2(0.5, -1)};

/// A facet scene recut so that a film inside its facet shows all shapes, with t > 0; world scaled to the
/// triangle.
struct FramedScene {
    FacetScene scene;
    double score = 0;  // see score_of
};

/// The configuration over the whole plane of weights and all t.
Configuration configuration_of(const FacetScene& scene);

/// What counts beside the shapes' widths and the gaps between them; 0: does not count.
struct ScoreWeights {
    double spacing = 0.4;  // of the distances of a shape's neighbouring vertices
    double neck = 1;       // of the distances of border points far apart along the border
};

/// How well the best frame shows the shapes: the least of their widths, twice the gaps between them, and what
/// the weights add, in film sides; 0: not at all. The frame is free, because the parametric triangle's
/// corners may be any three of its plane and t may start anywhere.
double score_of(const FacetScene& scene, const ScoreWeights& weights);

/// The scene recut to its best frame.
FramedScene framed(const FacetScene& scene, const ScoreWeights& weights);

/// The facet with its rays begun at `t`: what lay before is behind the viewing plane.
TrilinearFacet begun_at(const TrilinearFacet& facet, double t);

/// The area of each shape inside the facet (weights >= 0, t >= 0), as shares of the facet's area, largest
/// first.
std::vector<double> visible_areas(const FacetScene& scene);

// Finds facets and scene triangles of a wanted configuration: random draws, then hill climbing.

/// The same numbers from the same seed with every library.
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : bits_(seed) {}
    double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }  // in [0, 1)
    Vec3 normal();  // standard normal, each component

  private:
    double one_normal();
    std::mt19937_64 bits_;
};

struct SearchParams {
    ScoreWeights weights;
    int starts = 12;  // random scenes of the configuration, the best of which are improved
    int improved = 4;
    int steps = 8000;            // of the hill climbing, each
    long most_draws = 20000000;  // random scenes that are looked at before the search gives up
};

struct Found {
    FramedScene framed;
    long draws = 0;  // random scenes that were looked at; 0 score: too few had the configuration
};

/// The best scene found; the same for the same seed.
Found search(const Configuration& wanted, std::uint64_t seed, const SearchParams& params = {});

}  // namespace trilens
