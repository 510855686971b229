// Numbers as files hold their bytes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace trilens {

enum class SampleType : std::uint8_t {
    kUint8,
    kInt8,
    kUint16,
    kInt16,
    kUint32,
    kInt32,
    kFloat,
    kDouble,
    kUint64,
    kInt64
};

std::size_t bytes_of(SampleType type);

/// The number whose bytes_of(type) bytes begin at `bytes`, which need not be aligned; of 64 bits the nearest
/// double.
double number_at(const char* bytes, SampleType type, bool is_big_endian);

}  // namespace trilens
