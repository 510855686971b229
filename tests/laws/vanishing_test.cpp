// Nothing vanishes: what the exact surfaces show of small optics, over any path, the projection shows.
#include <string>

#include "laws/hunt.h"
#include "support/test.h"

using namespace trilens_test;

namespace {

void check_seeds(std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t seed = from; seed < to; ++seed) {
        const Quarry quarry = make_quarry(seed);
        const Bag bag = hunt(quarry);
        INFO("seed " << seed << ": " << quarry.what << "\n" << quarry.json);
        std::string missing;
        for (const std::string& one : bag.missing) missing += one + " ";
        CHECK(missing == "");
    }
}

}  // namespace

TEST_CASE("Small optics behind, in and before mirrors and glass do not vanish", "[laws][law][hunt]") {
    check_seeds(0, 25);
}

TEST_CASE("Small optics behind, in and before mirrors and glass do not vanish in many scenes",
          "[.long][laws][law][hunt]") {
    check_seeds(25, 400);
}
