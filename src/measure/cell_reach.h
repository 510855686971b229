// Which points the patches of a cell can show: tight bounds, each made when it is first asked for.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

#include "base/box.h"
#include "measure/field_index.h"

namespace trilens {

/// All points that patches from any corner of a cell show lie in the box, and between two planes across each
/// direction: those of the cell's own axes, for a cell that is long and oblique fills little of its box.
struct CellReach {
    struct Slab {
        float direction[3] = {0, 0, 0};
        float low, high;  // of dot(direction, point)
    };
    float low[3], high[3];  // low > high: it shows nothing
    Slab slabs[2];

    bool may_hold(const Vec3& point) const;
};

/// World frame, of the cell (column, row) .. (column + 1, row + 1) of pixel centres and the pieces that its
/// corners show, whole or triangle by triangle. `other`: as make_patch has it.
CellReach reach_of_cell(const FieldIndex& index, const SeenField& other, int column, int row);

/// Values that many threads may ask for. What is not asked for takes address space, but no memory.
template <typename Value>
class LazyValues {
  public:
    explicit LazyValues(std::size_t count)
        : values_(std::make_unique_for_overwrite<Value[]>(count)),
          state_(std::make_unique<std::atomic<State>[]>(count)) {}

    /// The value that make() returns, always the same; null while another thread makes it: nobody waits.
    template <typename Make>
    const Value* get(std::size_t index, Make&& make) {
        std::atomic<State>& state = state_[index];
        State found = state.load(std::memory_order_acquire);
        if (found == State::kMade) return &values_[index];
        if (found == State::kMaking || !state.compare_exchange_strong(found, State::kMaking)) return nullptr;
        values_[index] = make();
        state.store(State::kMade, std::memory_order_release);
        return &values_[index];
    }

  private:
    enum class State : char { kUnknown, kMaking, kMade };
    std::unique_ptr<Value[]> values_;
    std::unique_ptr<std::atomic<State>[]> state_;
};

}  // namespace trilens
