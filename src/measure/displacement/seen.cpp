#include "measure/displacement/seen.h"

#include "measure/common/comparable.h"

namespace trilens {

std::optional<SeenMismatch> compare_seen(const Image& reference, const Image& test, const std::string& layer,
                                         std::optional<Id> mask_object) {
    require_comparable(reference, test);
    const auto channel = [&](const Image& image, const char* name) {
        return seen_channel(image, layer, name);
    };
    if (!reference.find(channel(reference, "object"))) return std::nullopt;
    const std::vector<std::uint8_t> mask = compared_pixels(reference, test, mask_object);
    const std::vector<Id>& object_reference = id_channel(reference, channel(reference, "object"));
    const std::vector<Id>& object_test = id_channel(test, channel(test, "object"));

    // Without a channel of primitives every object is one piece.
    const bool has_primitive = reference.find(channel(reference, "primitive")) != nullptr;
    const std::vector<Id>& primitive_reference =
        has_primitive ? id_channel(reference, channel(reference, "primitive")) : object_reference;
    const std::vector<Id>& primitive_test =
        has_primitive ? id_channel(test, channel(test, "primitive")) : object_test;

    SeenMismatch result;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const Id a = object_reference[i], b = object_test[i];
        if (!mask[i] || (a == kNone && b == kNone)) continue;
        ++result.pixels;
        if (a == kNone || b == kNone)
            ++result.coverage_mismatch;
        else if (a != b)
            ++result.object_mismatch;
        else if (primitive_reference[i] != primitive_test[i])
            ++result.primitive_mismatch;
    }
    return result;
}

}  // namespace trilens
