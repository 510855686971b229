// A task run on threads of its own, for work that blocks or loops inside (no work stealing).
#pragma once

#include <cstddef>
#include <functional>

namespace trilens {

/// Calls work() on `count` threads at once, the caller's among them, and returns when all have ended. Where
/// the system gives fewer threads they are fewer, at least the caller's: so work takes what is left to do
/// until nothing is. It must not throw.
void run_on_threads(std::size_t count, const std::function<void()>& work);

}  // namespace trilens
