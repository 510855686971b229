// The hunt for what vanishes: random scenes with small, thin and far optics behind, in and before mirrors and
// glass, projected and held against the exact surfaces path by path.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/frame/request.h"
#include "render/world/world.h"

namespace trilens_test {

/// One scene of the hunt; the same number is the same scene on every machine.
struct Quarry {
    std::uint64_t seed = 0;
    std::string json;
    trilens::FrameParams frame;  // resolution 1 to 32, with and without an error
    std::string what;            // its camera, host and optics in a few words
};
Quarry make_quarry(std::uint64_t seed);

/// What the projection shows of it beside the truth.
struct Bag {
    std::size_t pixels = 0;            // of the film
    std::vector<std::string> missing;  // optics that the truth shows in kFew pixels or more, over any path,
                                       // and the projection in none
    std::size_t tiny = 0;              // optics that the truth shows in fewer, and the projection in none
    std::size_t other = 0;             // pixels of either whose path no pixel of the other within 1.5 has
    std::size_t traced = 0, divided = 0;
    double seconds = 0, truth_seconds = 0;
};
inline constexpr std::size_t kFew = 4;
Bag hunt(const Quarry& quarry);
/// The same of any world.
Bag beside_truth(const trilens::World& world, const trilens::FrameParams& frame);

}  // namespace trilens_test
