// Parallel loops over independent items: the door to TBB; a task on threads of its own; lazy initialisation.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <utility>

#include "base/util/error.h"

namespace trilens {

/// Limits every later parallel_for to `threads` threads; 0 means all that the machine has.
void set_thread_count(int threads);

/// The number of threads that parallel_for may use now, at least 1.
int thread_count();

/// Calls body(first, last) over disjoint ranges that cover [0, count), in any order and on any thread.
/// Results must not depend on how the ranges fall. `grain`: smallest range worth a thread of its own.
/// An exception thrown by body is rethrown here; without one all is done, also where a loop around this one
/// ends by an exception meanwhile.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t first, std::size_t last)>& body);

/// How much of a loop is done on all threads: reported by one call at a time.
class LoopProgress {
  public:
    /// `progress` must live longer.
    LoopProgress(const Progress& progress, double count) : progress_(progress), count_(count) {}

    /// Throws Interrupted once the progress is cancelled.
    void stop_if_cancelled() const { progress_.stop_if_cancelled(); }
    void add(double done) {
        if (!progress_.report) return;
        const std::scoped_lock lock(mutex_);
        done_ += done;
        progress_(done_ / count_);
    }

  private:
    const Progress& progress_;
    double count_, done_ = 0;
    std::mutex mutex_;
};

/// Calls every one of them, in any order and on any threads; returns when all have ended. An exception thrown
/// by one is rethrown here.
void run_side_by_side(std::initializer_list<std::function<void()>> tasks);

/// A row of items that go through three stages, each in a slot that is its own on the way.
struct PipelineStages {
    std::function<void(std::size_t item, std::size_t slot)> begin;  // one item after the other
    std::function<void(std::size_t item, std::size_t slot)> work;   // of several items at once
    std::function<void(std::size_t item, std::size_t slot)> end;    // one item after the other
};

/// Takes the items 0 .. count-1 through all stages, at most `slots` of them at the same time, each with a
/// slot below `slots` that no other uses meanwhile. The first and the last stage see them in order; stages
/// of different items run side by side. An exception of a stage is rethrown here, after the stages that run
/// have ended.
void run_pipeline(std::size_t count, std::size_t slots, const PipelineStages& stages);

/// Calls work() so that its own loops, while they wait, take up no part of the loops around them: for work
/// that others wait for, such as a value made once.
void run_isolated(const std::function<void()>& work);

// A task run on threads of its own, for work that blocks or loops inside (no work stealing).

/// Calls work() on `count` threads at once, the caller's among them, and returns when all have ended. Where
/// the system gives fewer threads they are fewer, at least the caller's: so work takes what is left to do
/// until nothing is. It must not throw.
void run_on_threads(std::size_t count, const std::function<void()>& work);

// Lazy initialisation: a value made at its first use, by one thread, then kept.

/// Thread-safe: of several threads that ask at once one makes the value and the others wait. A maker that
/// throws leaves nothing; the next one to ask tries again. May be asked from inside a parallel loop.
template <typename T>
class Lazy {
  public:
    /// `make` returns a std::unique_ptr<T>.
    template <typename Make>
    const T& get(Make&& make) const {
        if (const T* ready = find()) return *ready;
        const std::lock_guard<std::mutex> lock(making_);
        if (!value_) {
            run_isolated([&] { value_ = std::forward<Make>(make)(); });
            ready_.store(value_.get(), std::memory_order_release);
        }
        return *value_;
    }
    /// What was made; null where nothing is yet.
    const T* find() const { return ready_.load(std::memory_order_acquire); }

  private:
    mutable std::mutex making_;
    mutable std::unique_ptr<T> value_;
    mutable std::atomic<const T*> ready_ = nullptr;
};

}  // namespace trilens
