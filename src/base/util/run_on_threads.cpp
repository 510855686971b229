#include "base/util/run_on_threads.h"

#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace trilens {

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
