// Per-pixel agreement of object ids, triangle ids and coverage between two images.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "base/image/image.h"
#include "base/util/ids.h"

namespace trilens {

/// Counts of pixels. Each mismatching pixel is in exactly one of the three.
struct SeenMismatch {
    std::size_t pixels = 0;              // at least one of the images sees something
    std::size_t coverage_mismatch = 0;   // one sees something, the other nothing (4294967295)
    std::size_t object_mismatch = 0;     // both see something, but different objects
    std::size_t primitive_mismatch = 0;  // both see the same object, but different triangles of it
};

/// Compares the objects and triangles that `layer` shows ("reflect", "refract"; for "optic", which has no
/// triangles, only objects). `mask_object` as in CompareOptions. Nothing where the images have no such layer.
/// Throws InputError where they cannot be compared.
std::optional<SeenMismatch> compare_seen(const Image& reference, const Image& test, const std::string& layer,
                                         std::optional<Id> mask_object = std::nullopt);

}  // namespace trilens
