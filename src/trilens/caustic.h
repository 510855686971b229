// Caustics as data: the light that comes over mirrors and through glass, on the pixels of an object or a
// plane.
//
//     #include <trilens/caustic.h>
//     const trilens::Renderer renderer(trilens::load_scene({"ball.json"}));
//     trilens::CausticMapRequest request;
//     request.target = trilens::parse_target("tiles:256x256", renderer.scene());
//     const trilens::CausticMap map = trilens::make_caustic_map(renderer, request);
//     trilens::write_image("caustic.exr", trilens::image_of(map));
#pragma once

#include "inverse/maps/caustic_map.h"
#include "trilens/image.h"
#include "trilens/map.h"
#include "trilens/render.h"

namespace trilens {

/// See make_caustic_map in the room `inverse`: throws as that does.
CausticMap make_caustic_map(const Renderer& renderer, const CausticMapRequest& request,
                            const Progress& progress = {});

}  // namespace trilens
