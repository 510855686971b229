// Items that go through stages side by side, in slots of their own.
#include <atomic>
#include <stdexcept>
#include <vector>

#include "base/util/parallel.h"
#include "support/test.h"

using namespace trilens;

TEST_CASE("a pipeline takes items in order, each in a slot that no other uses meanwhile", "[base]") {
    const std::size_t count = GENERATE(0u, 1u, 2u, 100u), slots = GENERATE(1u, 2u, 3u, 8u);
    const int threads = GENERATE(1, 4);
    set_thread_count(threads);
    std::vector<std::size_t> begun, ended, held(slots, count);
    std::atomic<std::size_t> worked = 0;
    std::atomic<int> wrong = 0;
    PipelineStages stages;
    stages.begin = [&](std::size_t item, std::size_t slot) {
        wrong += slot >= slots || held[slot] != count;
        held[slot] = item;
        begun.push_back(item);
    };
    stages.work = [&](std::size_t item, std::size_t slot) {
        wrong += held[slot] != item;
        // A stage may have loops of its own.
        parallel_for(100, 1, [&](std::size_t from, std::size_t to) { worked += to - from; });
    };
    stages.end = [&](std::size_t item, std::size_t slot) {
        wrong += held[slot] != item;
        held[slot] = count;
        ended.push_back(item);
    };
    run_pipeline(count, slots, stages);
    set_thread_count(0);
    std::vector<std::size_t> all(count);
    for (std::size_t i = 0; i < count; ++i) all[i] = i;
    CHECK(begun == all);
    CHECK(ended == all);
    CHECK(worked == 100 * count);
    CHECK(wrong == 0);
}

TEST_CASE("what a stage of a pipeline throws comes out, and later items do not end", "[base]") {
    const int stage = GENERATE(0, 1, 2);
    std::vector<std::size_t> ended;
    const auto fail_at = [&](int own) {
        return [own, stage, &ended](std::size_t item, std::size_t) {
            if (own == stage && item == 5) throw std::runtime_error("stage");
            if (own == 2) ended.push_back(item);
        };
    };
    CHECK_THROWS_AS(run_pipeline(50, 3, {fail_at(0), fail_at(1), fail_at(2)}), std::runtime_error);
    for (const std::size_t item : ended) CHECK(item < 5);
}
