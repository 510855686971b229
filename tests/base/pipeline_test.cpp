// Items that go through stages side by side, in slots of their own.
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
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

TEST_CASE("a stage's own loop does all that it is to do, also where another item ends the pipeline meanwhile",
          "[base]") {
    constexpr std::size_t kCount = 400;
    set_thread_count(4);
    int met = 0;
    for (int round = 0; round < 20; ++round) {
        std::atomic<bool> has_begun = false, has_thrown = false;
        std::atomic<std::size_t> done = 0, done_after = kCount;
        PipelineStages stages;
        stages.begin = [](std::size_t, std::size_t) {};
        stages.work = [&](std::size_t item, std::size_t) {
            const auto wait_for = [](const std::atomic<bool>& flag) {
                const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(1);
                while (!flag && std::chrono::steady_clock::now() < until) std::this_thread::yield();
            };
            if (item == 0) {
                wait_for(has_begun);
                has_thrown = true;
                throw std::runtime_error("stage");
            }
            parallel_for(kCount, 1, [&](std::size_t from, std::size_t to) {
                has_begun = true;
                wait_for(has_thrown);
                if (from % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                done += to - from;
            });
            done_after = done.load();
        };
        stages.end = [](std::size_t, std::size_t) {};
        CHECK_THROWS_AS(run_pipeline(2, 2, stages), std::runtime_error);
        met += done > 0;
        CHECK(done_after == kCount);
    }
    set_thread_count(0);
    CHECK(met > 0);
}
