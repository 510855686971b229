// A row that lies inside itself while it is short: the values of a std::vector, whatever is done to it.
#include "base/util/few.h"

#include <random>
#include <span>
#include <vector>

#include "support/test.h"

using namespace trilens;

TEST_CASE("a short row holds what a vector holds, beyond its room too", "[base][law]") {
    std::mt19937 random(11);
    std::uniform_int_distribution<int> act(0, 7), value(0, 99), size(0, 9);
    Few<int, 4> few;
    std::vector<int> expected;
    for (int step = 0; step < 4000; ++step) {
        switch (act(random)) {
            case 0:
                few.clear(), expected.clear();
                break;
            case 1: {
                const auto count = static_cast<std::size_t>(size(random));
                const int with = value(random);
                few.resize(count, with), expected.resize(count, with);
                break;
            }
            case 2: {
                const Few<int, 4> copy = few;
                few.clear();
                few = copy;
                break;
            }
            case 3: {
                Few<int, 4> moved = std::move(few);
                few = std::move(moved);
                break;
            }
            case 4:
                if (expected.empty()) break;
                few.push_back(few[0]), expected.push_back(int{expected[0]});  // one of its own
                break;
            case 5: {
                const std::vector<int> other(static_cast<std::size_t>(size(random)), value(random));
                few.assign(other.begin(), other.end()), expected = other;
                break;
            }
            default:
                few.push_back(step), expected.push_back(step);
        }
        const std::span<const int> seen = few;
        REQUIRE(std::vector<int>(seen.begin(), seen.end()) == expected);
        REQUIRE(few == Few<int, 4>(expected.begin(), expected.end()));
    }
}
