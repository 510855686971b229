// The same loops on threads that are started for each and end with it: what orders them is all in this file,
// so that the thread sanitizer sees it. TBB's half of that is in a library that it does not see into. Slow;
// only that build has it.
#ifdef TRILENS_PLAIN_THREADS

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <thread>
#include <vector>

#include "base/util/parallel.h"

namespace trilens {
namespace {

std::atomic<int> limit = 0;
std::atomic<int> helpers = 0;  // threads that were started and have not ended

/// The first exception of several threads.
class FirstError {
  public:
    bool any() const { return any_; }
    void keep() {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
        any_ = true;
    }
    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }

  private:
    std::mutex mutex_;
    std::exception_ptr error_;
    std::atomic<bool> any_ = false;
};

/// Threads that may be started now beside the caller's, until it ends.
class Helpers {
  public:
    explicit Helpers(std::size_t wanted) {
        const int most = std::min(static_cast<int>(std::min<std::size_t>(wanted, 64)), thread_count() - 1);
        // Loops inside of loops go on alone once there are enough.
        constexpr int kMost = 24;
        while (count_ < most) {
            if (helpers.fetch_add(1) >= kMost) {
                --helpers;
                break;
            }
            ++count_;
        }
    }
    ~Helpers() { helpers -= count_; }
    Helpers(const Helpers&) = delete;
    Helpers& operator=(const Helpers&) = delete;
    std::size_t count() const { return static_cast<std::size_t>(count_); }

  private:
    int count_ = 0;
};

}  // namespace

void set_thread_count(int threads) {
    limit = threads;
}

int thread_count() {
    const int asked = limit;
    return asked > 0 ? asked : std::max(2, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t first, std::size_t last)>& body) {
    if (count == 0) return;
    const std::size_t least = std::max<std::size_t>(1, grain);
    const Helpers team(count / least);
    const std::size_t step = std::max(least, count / (4 * (team.count() + 1)));
    std::atomic<std::size_t> next = 0;
    FirstError error;
    run_on_threads(team.count() + 1, [&] {
        try {
            for (std::size_t first; !error.any() && (first = next.fetch_add(step)) < count;)
                body(first, std::min(count, first + step));
        } catch (...) {
            error.keep();
        }
    });
    error.rethrow();
}

void run_side_by_side(std::initializer_list<std::function<void()>> tasks) {
    parallel_for(tasks.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) tasks.begin()[i]();
    });
}

void run_pipeline(std::size_t count, std::size_t slots, const PipelineStages& stages) {
    if (count == 0) return;
    std::mutex beginning, ending;
    std::condition_variable one_ended;
    std::size_t next = 0, ended = 0;
    FirstError error;
    const auto stop = [&] {
        error.keep();
        const std::lock_guard lock(ending);
        one_ended.notify_all();
    };
    const Helpers team(slots > 0 ? slots - 1 : 0);
    run_on_threads(team.count() + 1, [&] {
        try {
            while (!error.any()) {
                std::size_t item;
                {
                    const std::lock_guard begin(beginning);
                    if (next == count) return;
                    item = next++;
                    std::unique_lock free(ending);
                    one_ended.wait(free, [&] { return error.any() || item < ended + slots; });
                    free.unlock();
                    if (error.any()) return;
                    stages.begin(item, item % slots);
                }
                stages.work(item, item % slots);
                std::unique_lock turn(ending);
                one_ended.wait(turn, [&] { return error.any() || item == ended; });
                if (error.any()) return;
                stages.end(item, item % slots);
                ++ended;
                one_ended.notify_all();
            }
        } catch (...) {
            stop();
        }
    });
    error.rethrow();
}

void run_isolated(const std::function<void()>& work) {
    work();
}

}  // namespace trilens

#endif
