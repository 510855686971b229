#include "trilens/unwrap.h"

#include <array>

#include "base/util/error.h"
#include "image/image_io.h"

namespace trilens {

UnwrapPhoto read_photo(const std::string& file) {
    UnwrapPhoto photo;
    photo.name = file;
    photo.picture = read_texture(file);
    return photo;
}

UnwrapPhoto photo_of(const Image& image, const std::string& name) {
    if (image.data_width != image.width || image.data_height != image.height)
        throw InputError(name, "", "is a part of a picture: a photograph has all of its film");
    auto texture = std::make_shared<Texture>();
    texture->width = image.width;
    texture->height = image.height;
    texture->rgb.resize(3 * image.pixels());
    for (std::size_t c = 0; c < 3; ++c) {
        const Channel* channel = image.find(std::string(1, "RGB"[c]));
        if (!channel || channel->is_id())
            throw InputError(name, std::string(1, "RGB"[c]), "a photograph needs R, G and B");
        for (std::size_t p = 0; p < image.pixels(); ++p) texture->rgb[3 * p + c] = channel->floats()[p];
    }
    UnwrapPhoto photo;
    photo.name = name;
    photo.picture = std::move(texture);
    return photo;
}

Unwrapped unwrap(const Renderer& renderer, const UnwrapRequest& request,
                 const std::vector<UnwrapPhoto>& photos, const Progress& progress) {
    Unwrapped made;
    renderer.use_world([&](const World& world) { made = unwrap(world, request, photos, progress); });
    return made;
}

}  // namespace trilens
