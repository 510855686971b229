#include "measure/seen.h"

#include "measure/comparable.h"

namespace trilens {

std::optional<SeenMismatch> compare_seen(const Image& reference, const Image& test, const std::string& layer,
                                         std::optional<Id> mask_object) {
    require_comparable(reference, test);
    if (!reference.find(channel_of(layer, "object"))) return std::nullopt;
    const std::vector<std::uint8_t> mask = compared_pixels(reference, test, mask_object);
    const std::vector<Id>& object_reference = id_channel(reference, channel_of(layer, "object"));
    const std::vector<Id>& object_test = id_channel(test, channel_of(layer, "object"));

    // Without a channel of primitives every object is one piece.
    const std::string primitive = channel_of(layer, "primitive");
    const bool has_primitive = reference.find(primitive) != nullptr;
    const std::vector<Id>& primitive_reference =
        has_primitive ? id_channel(reference, primitive) : object_reference;
    const std::vector<Id>& primitive_test = has_primitive ? id_channel(test, primitive) : object_test;

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
