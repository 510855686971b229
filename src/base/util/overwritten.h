// Room whose values are written before they are read: memory that nobody clears, so that pages never written
// are never touched.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace trilens {

/// Elements hold anything until they are set. For types that may be overwritten without being made.
template <typename T>
class Overwritten {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    static_assert(alignof(T) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);

  public:
    Overwritten() = default;
    explicit Overwritten(std::size_t size) { resize(size); }

    /// What was there is lost where this is more than there was ever room for; where there is no memory for
    /// it, nothing is left.
    void resize(std::size_t size) {
        if (size > room_) {
            size_ = room_ = 0;
            bytes_ = nullptr;
            bytes_ = std::make_unique_for_overwrite<std::byte[]>(size * sizeof(T));
            room_ = size;
        }
        size_ = size;
    }

    std::size_t size() const { return size_; }
    T* data() { return reinterpret_cast<T*>(bytes_.get()); }
    const T* data() const { return reinterpret_cast<const T*>(bytes_.get()); }
    T& operator[](std::size_t i) { return data()[i]; }
    const T& operator[](std::size_t i) const { return data()[i]; }
    T* begin() { return data(); }
    T* end() { return data() + size_; }

  private:
    std::unique_ptr<std::byte[]> bytes_;
    std::size_t size_ = 0, room_ = 0;
};

}  // namespace trilens
