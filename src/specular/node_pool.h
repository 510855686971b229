// Arena of values of one type: few allocations, addresses that stay.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace trilens {

/// Grows one by one; forgets all at once and then uses the same memory again.
template <typename T>
class NodePool {
  public:
    T& add(const T& value) {
        if (size_ == kChunk * chunks_.size()) chunks_.push_back(std::make_unique<T[]>(kChunk));
        T& place = chunks_[size_ / kChunk][size_ % kChunk];
        place = value;
        ++size_;
        return place;
    }
    void clear() { size_ = 0; }
    std::size_t size() const { return size_; }

  private:
    static constexpr std::size_t kChunk = 64;

    std::vector<std::unique_ptr<T[]>> chunks_;
    std::size_t size_ = 0;
};

}  // namespace trilens
