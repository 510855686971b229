// A row of values that needs no memory of its own while it holds few: they lie inside it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <type_traits>
#include <utility>

namespace trilens {

/// Up to kRoom values inside, more on the heap. Grows as std::vector does; spans take it as they take one.
template <typename T, std::size_t kRoom>
class Few {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

  public:
    using value_type = T;

    Few() = default;
    explicit Few(std::size_t count, const T& value = T()) { resize(count, value); }
    Few(std::initializer_list<T> values) { assign(values.begin(), values.end()); }
    template <typename Iterator>
    requires(!std::is_integral_v<Iterator>) Few(Iterator begin, Iterator end) { assign(begin, end); }
    Few(const Few& other) { assign(other.begin(), other.end()); }
    Few(Few&& other) noexcept { take(other); }
    Few& operator=(const Few& other) {
        if (this != &other) assign(other.begin(), other.end());
        return *this;
    }
    Few& operator=(Few&& other) noexcept {
        if (this != &other) take(other);
        return *this;
    }
    ~Few() = default;

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    T* data() { return many_ ? many_.get() : inside_.values; }
    const T* data() const { return many_ ? many_.get() : inside_.values; }
    T* begin() { return data(); }
    T* end() { return data() + size_; }
    const T* begin() const { return data(); }
    const T* end() const { return data() + size_; }
    std::reverse_iterator<const T*> rbegin() const { return std::reverse_iterator(end()); }
    std::reverse_iterator<const T*> rend() const { return std::reverse_iterator(begin()); }
    T& operator[](std::size_t i) { return data()[i]; }
    const T& operator[](std::size_t i) const { return data()[i]; }
    T& front() { return *data(); }
    const T& front() const { return *data(); }
    T& back() { return data()[size_ - 1]; }
    const T& back() const { return data()[size_ - 1]; }

    void clear() { size_ = 0; }
    /// Of those that are not empty.
    void pop_back() { --size_; }
    void push_back(const T& value) {
        const T kept = value;  // it may lie in here
        make_room(size_ + 1);
        std::construct_at(data() + size_++, kept);
    }
    void resize(std::size_t count, const T& value = T()) {
        const T kept = value;  // as well
        make_room(count);
        if (count > size_) std::uninitialized_fill(data() + size_, data() + count, kept);
        size_ = count;
    }
    /// Not of its own.
    template <typename Iterator>
    void assign(Iterator begin, Iterator end) {
        size_ = 0;
        const auto count = static_cast<std::size_t>(std::distance(begin, end));
        make_room(count);
        std::uninitialized_copy(begin, end, data());
        size_ = count;
    }

    friend bool operator==(const Few& a, const Few& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
    }

  private:
    void make_room(std::size_t count) {
        if (count <= room_) return;
        const std::size_t room = std::max(count, 2 * room_);
        auto more = std::make_unique_for_overwrite<T[]>(room);
        std::copy(begin(), end(), more.get());
        many_ = std::move(more);
        room_ = room;
    }
    void take(Few& other) noexcept {
        size_ = std::exchange(other.size_, 0);
        room_ = std::exchange(other.room_, kRoom);
        many_ = std::move(other.many_);
        if (!many_) std::uninitialized_copy_n(other.inside_.values, size_, inside_.values);
    }

    /// Not made before they are put there.
    union Inside {
        Inside() {}
        T values[kRoom];
    };

    std::size_t size_ = 0, room_ = kRoom;
    std::unique_ptr<T[]> many_;
    Inside inside_;
};

}  // namespace trilens
