// Nothing vanishes: what the exact surfaces show of small optics, over any path, the projection shows.
#include <string>

#include "laws/hunt.h"
#include "support/test.h"

using namespace trilens_test;

TEST_CASE("Small optics behind, in and before mirrors and glass do not vanish", "[laws][law][hunt]") {
    constexpr std::uint64_t kScenes = 200;
    for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
        const Quarry quarry = make_quarry(seed);
        const Bag bag = hunt(quarry);
        INFO("seed " << seed << ": " << quarry.what << "\n" << quarry.json);
        std::string missing;
        for (const std::string& one : bag.missing) missing += one + " ";
        CHECK(missing == "");
    }
}
