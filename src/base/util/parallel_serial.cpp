// The same loops on the one thread that WebAssembly has in a page.
#ifdef __EMSCRIPTEN__

#include "base/util/parallel.h"

namespace trilens {

void set_thread_count(int) {}

int thread_count() {
    return 1;
}

void parallel_for(std::size_t count, std::size_t,
                  const std::function<void(std::size_t first, std::size_t last)>& body) {
    if (count > 0) body(0, count);
}

void run_side_by_side(std::initializer_list<std::function<void()>> tasks) {
    for (const auto& task : tasks) task();
}

void run_pipeline(std::size_t count, std::size_t slots, const PipelineStages& stages) {
    for (std::size_t item = 0; item < count; ++item) {
        stages.begin(item, item % slots);
        stages.work(item, item % slots);
        stages.end(item, item % slots);
    }
}

void run_isolated(const std::function<void()>& work) {
    work();
}

void run_on_threads(std::size_t, const std::function<void()>& work) {
    work();
}

}  // namespace trilens

#endif
