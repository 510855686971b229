// How long work says how far it is, and learns that it should stop.
#pragma once

#include <atomic>
#include <functional>
#include <string>

namespace trilens {

/// Handed down into long work; default: silent and never cancelled.
struct Progress {
    std::function<void(double done)> report;    // share done, 0..1, never called from two threads at once
    const std::atomic<bool>* cancel = nullptr;  // set by a signal handler

    void operator()(double done) const {
        if (report) report(done);
    }
    bool cancelled() const { return cancel && cancel->load(std::memory_order_relaxed); }
};

/// Where rooms put what the user would want to know but what is no error.
using Warn = std::function<void(const std::string& message)>;

}  // namespace trilens
