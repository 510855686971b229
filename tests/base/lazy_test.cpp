// A value that is made once, also when many ask for it at once from inside a parallel loop.
#include "base/util/parallel.h"

#include <atomic>
#include <stdexcept>

#include "support/test.h"

using namespace trilens;

TEST_CASE("a value that many threads ask for in a loop is made once, by loops of its own", "[base]") {
    for (int round = 0; round < 50; ++round) {
        const Lazy<int> lazy;
        std::atomic<int> made = 0, wrong = 0;
        parallel_for(200, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const int value = lazy.get([&] {
                    ++made;
                    std::atomic<int> sum = 0;
                    parallel_for(1000, 1, [&](std::size_t from, std::size_t to) {
                        sum += static_cast<int>(to - from);
                    });
                    return std::make_unique<int>(sum);
                });
                wrong += value != 1000;
            }
        });
        CHECK(made == 1);
        CHECK(wrong == 0);
    }
}

TEST_CASE("a maker that throws leaves nothing, and the next one makes it", "[base]") {
    const Lazy<int> lazy;
    CHECK_THROWS_AS(lazy.get([]() -> std::unique_ptr<int> { throw std::runtime_error("not now"); }),
                    std::runtime_error);
    CHECK(lazy.get([] { return std::make_unique<int>(7); }) == 7);
}
