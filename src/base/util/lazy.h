// Lazy initialisation: a value made at its first use, by one thread, then kept.
#pragma once

#include <memory>
#include <mutex>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {

/// Thread-safe: of several threads that ask at once one makes the value and the others wait. A maker that
/// throws leaves nothing; the next one to ask tries again. May be asked from inside a parallel loop.
template <typename T>
class Lazy {
  public:
    /// `make` returns a std::unique_ptr<T>.
    template <typename Make>
    const T& get(Make&& make) const {
        std::call_once(made_, [&] { run_isolated([&] { value_ = std::forward<Make>(make)(); }); });
        return *value_;
    }

  private:
    mutable std::once_flag made_;
    mutable std::unique_ptr<T> value_;
};

}  // namespace trilens
