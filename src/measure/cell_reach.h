// Which points the cells at the ends of pieces can show: tight boxes, each made when it is first asked for.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "base/box.h"
#include "measure/seen_field.h"

namespace trilens {

/// A box, world frame, about all points that patches from any corner of the cell (column, row) ..
/// (column + 1, row + 1) of pixel centres show, of the pieces that its corners show, whole or triangle by
/// triangle; empty where it has no patch. `other`: as make_patch has it.
Box reach_of_cell(const SeenField& field, const SeenField& other, int column, int row);

/// Boxes that many threads may ask for.
class LazyBoxes {
  public:
    explicit LazyBoxes(std::size_t count = 0)
        : boxes_(count), state_(std::make_unique<std::atomic<State>[]>(count)) {}

    /// The box that make() returns, always the same; null while another thread makes it: nobody waits.
    template <typename Make>
    const Box* get(std::size_t index, Make&& make) {
        std::atomic<State>& state = state_[index];
        State found = state.load(std::memory_order_acquire);
        if (found == State::kMade) return &boxes_[index];
        if (found == State::kMaking || !state.compare_exchange_strong(found, State::kMaking)) return nullptr;
        boxes_[index] = make();
        state.store(State::kMade, std::memory_order_release);
        return &boxes_[index];
    }

  private:
    enum class State : char { kUnknown, kMaking, kMade };
    std::vector<Box> boxes_;
    std::unique_ptr<std::atomic<State>[]> state_;
};

}  // namespace trilens
