// A bounded cache answers like a function, whatever it keeps, and keeps no more than it may.
#include "surfaces/memory_budget.h"

#include <atomic>
#include <random>

#include "base/util/parallel.h"
#include "support/test.h"

using namespace trilens;

namespace {

struct Square {
    std::size_t value = 0, size = 0;
    std::size_t bytes() const { return size; }
};

using Cache = BoundedCache<Square>;

std::size_t ask(Cache& cache, std::size_t key, std::size_t size, std::atomic<int>& made) {
    return cache.with(
        key,
        [&](std::size_t k) {
            ++made;
            return Square{k * k, size};
        },
        [](const Square& square) { return square.value; });
}

std::size_t table_bytes(std::size_t keys) {
    return keys * sizeof(void*);
}

}  // namespace

TEST_CASE("Values that fit are made once, and stay", "[surfaces][law]") {
    Cache cache(100, {1000, 0});
    std::atomic<int> made = 0;
    CHECK(cache.bytes() == table_bytes(100));
    for (int round = 0; round < 3; ++round)
        for (std::size_t key = 0; key < 100; ++key) REQUIRE(ask(cache, key, 10, made) == key * key);
    CHECK(made == 100);
    CHECK(cache.bytes() == 1000 + table_bytes(100));
}

TEST_CASE("Of the values that do not fit the latest ones stay", "[surfaces][law]") {
    constexpr std::size_t kKeys = 6400;
    Cache cache(kKeys, {100, 64 * 50});  // ten of size 10 for good; of each 64th part of the keys five
    std::atomic<int> made = 0;
    for (std::size_t key = 0; key < kKeys; ++key) REQUIRE(ask(cache, key, 10, made) == key * key);
    CHECK(made == kKeys);
    CHECK(cache.bytes() == 100 + 64 * 50 + table_bytes(kKeys));

    for (std::size_t key = 0; key < 10; ++key) ask(cache, key, 10, made);
    for (std::size_t key = kKeys - 64 * 5; key < kKeys; ++key) ask(cache, key, 10, made);
    CHECK(made == kKeys);
    ask(cache, 10, 10, made);
    CHECK(made == kKeys + 1);
}

TEST_CASE("A value above the budget is used all the same, one per shard at most", "[surfaces]") {
    Cache cache(128, {5, 5});
    std::atomic<int> made = 0;
    for (std::size_t key = 0; key < 128; ++key) REQUIRE(ask(cache, key, 1000, made) == key * key);
    CHECK(cache.bytes() == 64 * 1000 + table_bytes(128));
}

TEST_CASE("Many threads at once get the right values within the budgets", "[surfaces]") {
    constexpr std::size_t kKeys = 3000, kKept = 4000, kRecent = 64 * 40;
    Cache cache(kKeys, {kKept, kRecent});
    std::atomic<int> made = 0, wrong = 0;
    parallel_for(64, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t task = first; task < last; ++task) {
            std::mt19937 random(static_cast<unsigned>(task));
            for (int i = 0; i < 5000; ++i) {
                const std::size_t key = random() % kKeys;
                wrong += ask(cache, key, 1 + key % 20, made) != key * key;
            }
        }
    });
    CHECK(wrong == 0);
    CHECK(made >= static_cast<int>(kKeys));
    CHECK(cache.bytes() <= kKept + kRecent + table_bytes(kKeys));
}
