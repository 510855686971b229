// When two images may be compared at all: which channels they share, and which of their pixels.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/image/image.h"
#include "base/util/ids.h"

namespace trilens {

/// The layer of proven bounds: it speaks of its own picture, and no other one need have it.
inline constexpr const char* kBoundChannel = "bound";

/// Throws InputError that names the first difference where the images differ in size, data window, channel
/// names or channel types (float, id). The order of channels is free, and an older name (see seen_channel) is
/// the same channel as the newer one, and kBoundChannel may stand in one alone. Also where a channel has not one value per pixel of the data window.
void require_comparable(const Image& reference, const Image& test);

/// Per pixel of the data window 1 where it takes part, else 0. Without `mask_object` all do; with it those
/// whose optic.object is that id in either image, so that a silhouette that moved is not masked away. Throws
/// InputError where there is no optic.object, or no such pixel: a comparison of nothing must not pass.
std::vector<std::uint8_t> compared_pixels(const Image& reference, const Image& test,
                                          std::optional<Id> mask_object);

/// The channel `name`, which must hold floats (ids). Throws InputError.
const std::vector<float>& float_channel(const Image& image, std::string_view name);
const std::vector<Id>& id_channel(const Image& image, std::string_view name);

/// "R" of layer "" is the beauty's R, of layer "reflect" it is "reflect.R".
std::string channel_of(const std::string& layer, const std::string& name);

/// What a layer's channel `name` of what is seen ("object", "primitive", "X", "Y", "Z", "length") is called
/// in `image`: ids and places stand in layers of their own, "reflectID.object" and "reflectP.X"; where the
/// image has no channel of that name, the older "reflect.object" and "reflect.X". Whether the image has the
/// channel is the caller's question.
std::string seen_channel(const Image& image, const std::string& layer, const std::string& name);

/// Two images with the same channels.
struct CommonChannels {
    Image reference, test;
    std::vector<std::string> only_reference, only_test;  // what was left out of each, by name
};

/// Leaves out the channels that the other image does not have, or has in another type (float, id). Older
/// names of what is seen are the newer ones ("reflect.object", "reflectID.object").
CommonChannels keep_common_channels(Image reference, Image test);

}  // namespace trilens
