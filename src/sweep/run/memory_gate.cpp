#include "sweep/run/memory_gate.h"

#include <chrono>

#include "base/util/error.h"

namespace trilens {

MemoryGate::Visit MemoryGate::enter(double bytes, const Progress& progress) {
    std::unique_lock guard(mutex_);
    while (visitors_ > 0 && limit_ > 0 && inside_ + bytes > limit_) {
        left_.wait_for(guard, std::chrono::milliseconds(100));
        if (progress.cancelled()) throw Interrupted();
    }
    inside_ += bytes;
    ++visitors_;
    return {*this, bytes};
}

void MemoryGate::leave(double bytes) {
    const std::lock_guard guard(mutex_);
    inside_ -= bytes;
    --visitors_;
    left_.notify_all();
}

}  // namespace trilens
