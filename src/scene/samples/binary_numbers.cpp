#include "scene/samples/binary_numbers.h"

#include <array>
#include <bit>
#include <cstring>

namespace trilens {
namespace {

template <typename T>
double value_at(const char* bytes, bool swap) {
    std::array<char, sizeof(T)> own;
    for (std::size_t k = 0; k < own.size(); ++k) own[k] = bytes[swap ? own.size() - 1 - k : k];
    T value;
    std::memcpy(&value, own.data(), own.size());
    return static_cast<double>(value);
}

}  // namespace

std::size_t bytes_of(SampleType type) {
    switch (type) {
        case SampleType::kUint16:
        case SampleType::kInt16:
            return 2;
        case SampleType::kUint32:
        case SampleType::kInt32:
        case SampleType::kFloat:
            return 4;
        case SampleType::kDouble:
        case SampleType::kUint64:
        case SampleType::kInt64:
            return 8;
        default:
            return 1;
    }
}

double number_at(const char* bytes, SampleType type, bool is_big_endian) {
    const bool swap = is_big_endian != (std::endian::native == std::endian::big);
    switch (type) {
        case SampleType::kUint8:
            return value_at<std::uint8_t>(bytes, swap);
        case SampleType::kInt8:
            return value_at<std::int8_t>(bytes, swap);
        case SampleType::kUint16:
            return value_at<std::uint16_t>(bytes, swap);
        case SampleType::kInt16:
            return value_at<std::int16_t>(bytes, swap);
        case SampleType::kUint32:
            return value_at<std::uint32_t>(bytes, swap);
        case SampleType::kInt32:
            return value_at<std::int32_t>(bytes, swap);
        case SampleType::kFloat:
            return value_at<float>(bytes, swap);
        case SampleType::kDouble:
            return value_at<double>(bytes, swap);
        case SampleType::kUint64:
            return value_at<std::uint64_t>(bytes, swap);
        case SampleType::kInt64:
            return value_at<std::int64_t>(bytes, swap);
    }
    return 0;
}

}  // namespace trilens
