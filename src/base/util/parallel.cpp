#include "base/util/parallel.h"

#ifndef __EMSCRIPTEN__         // there parallel_serial.cpp takes its place
#ifndef TRILENS_PLAIN_THREADS  // there parallel_threads.cpp, but for run_on_threads
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#endif

#include <memory>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace trilens {

#ifndef TRILENS_PLAIN_THREADS

namespace {

struct ThreadLimit {
    std::mutex mutex;
    std::unique_ptr<tbb::global_control> control;
};

ThreadLimit& limit() {
    static ThreadLimit one;
    return one;
}

}  // namespace

void set_thread_count(int threads) {
    const std::scoped_lock lock(limit().mutex);
    limit().control.reset();
    if (threads > 0)
        limit().control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                                static_cast<std::size_t>(threads));
}

int thread_count() {
    return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t first, std::size_t last)>& body) {
    if (count == 0) return;
    // Bound to a loop around it that another item's exception ends, it would return before all is done.
    tbb::task_group_context own(tbb::task_group_context::isolated);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain > 0 ? grain : 1),
        [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); }, own);
}

void run_side_by_side(std::initializer_list<std::function<void()>> tasks) {
    parallel_for(tasks.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) tasks.begin()[i]();
    });
}

void run_pipeline(std::size_t count, std::size_t slots, const PipelineStages& stages) {
    // Items end in order, and at most `slots` are on the way: the one that had this slot before has ended.
    std::size_t next = 0;
    const auto begin = tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                                           [&](tbb::flow_control& flow) -> std::size_t {
                                                               if (next == count) {
                                                                   flow.stop();
                                                                   return 0;
                                                               }
                                                               stages.begin(next, next % slots);
                                                               return next++;
                                                           });
    const auto work =
        tbb::make_filter<std::size_t, std::size_t>(tbb::filter_mode::parallel, [&](std::size_t item) {
            stages.work(item, item % slots);
            return item;
        });
    const auto end = tbb::make_filter<std::size_t, void>(
        tbb::filter_mode::serial_in_order, [&](std::size_t item) { stages.end(item, item % slots); });
    tbb::task_group_context own(tbb::task_group_context::isolated);  // as in parallel_for
    tbb::parallel_pipeline(slots, begin & work & end, own);
}

void run_isolated(const std::function<void()>& work) {
    tbb::this_task_arena::isolate(work);
}

#endif

void run_on_threads(std::size_t count, const std::function<void()>& work) {
    std::vector<std::jthread> others;
    try {
        if (count > 1) others.reserve(count - 1);
        while (others.size() + 1 < count) others.emplace_back([&work] { work(); });
    } catch (const std::system_error&) {
        // The threads that there are do all of it.
    } catch (const std::bad_alloc&) {
    }
    work();
}

}  // namespace trilens

#endif
