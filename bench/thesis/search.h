// Finds facets and scene triangles of a wanted configuration: random draws, then hill climbing.
#pragma once

#include <cstdint>
#include <random>

#include "thesis/configuration.h"

namespace trilens {

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
