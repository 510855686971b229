// Photographs of mirrors and lenses made into panoramas, cube maps, planes and textures.
//
//     #include <trilens/scene.h>
//     const trilens::Renderer renderer(trilens::load_scene({"ball.json"}));
//     trilens::UnwrapRequest request;
//     request.to = trilens::parse_target("equirect:2048x1024", renderer.scene());
//     const trilens::Unwrapped made = trilens::unwrap(renderer, request, {trilens::read_photo("ball.exr")});
//     trilens::write_image("panorama.exr", made.image);
#pragma once

#include <string>
#include <vector>

#include "inverse/unwrap/unwrap.h"
#include "trilens/image.h"
#include "trilens/render.h"

namespace trilens {

/// A photograph from any picture's file: integer formats are taken as sRGB, others as linear. Throws
/// InputError.
UnwrapPhoto read_photo(const std::string& file);

/// A photograph that is an image already; its R, G and B are taken. Throws InputError where it lacks one, or
/// its data window is not the whole film.
UnwrapPhoto photo_of(const Image& image, const std::string& name);

/// See unwrap in the room `inverse`: throws as that does.
Unwrapped unwrap(const Renderer& renderer, const UnwrapRequest& request,
                 const std::vector<UnwrapPhoto>& photos, const Progress& progress = {});

}  // namespace trilens
