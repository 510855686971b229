// Bounds of the points that a cell's patches can show, computed lazily.
#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>

#include "base/math/box.h"
#include "measure/field/field_pyramid.h"

namespace trilens {

/// All points that patches from any corner of a cell show lie in the box, and between two planes across each
/// direction: those of the cell's own axes, for a cell that is long and oblique fills little of its box.
struct FieldCellBounds {
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
FieldCellBounds reach_of_cell(const FieldPyramid& index, const PositionField& other, int column, int row);

/// Values that many threads may ask for. What is not asked for takes the room of a pointer.
template <typename Value>
class LazyValues {
  public:
    explicit LazyValues(std::size_t count) : known_(std::make_unique<std::atomic<Value*>[]>(count)) {}

    /// The value that make() returns, always the same.
    template <typename Make>
    const Value& get(std::size_t index, Make&& make) {
        if (const Value* const found = known_[index].load(std::memory_order_acquire)) return *found;
        const Value made = make();
        const std::lock_guard guard(mutex_);
        // Another thread may have made it meanwhile.
        if (const Value* const found = known_[index].load(std::memory_order_relaxed)) return *found;
        values_.push_back(made);
        known_[index].store(&values_.back(), std::memory_order_release);
        return values_.back();
    }

  private:
    std::unique_ptr<std::atomic<Value*>[]> known_;
    std::mutex mutex_;          // of what follows
    std::deque<Value> values_;  // stay where they are
};

}  // namespace trilens
