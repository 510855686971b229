// Panoramas, domes, planes and objects: photographs made into them, maps for other programs, light on them;
// the light that matt objects send to one another.
//
//     #include <trilens/scene.h>
//     const trilens::Renderer renderer(trilens::load_scene({"ball.json"}));
//     trilens::UnwrapRequest request;
//     request.target = trilens::parse_target("equirect:1024x512", renderer.scene());
//     const trilens::Unwrapped made = trilens::unwrap(renderer, request, {trilens::read_photo("ball.exr")});
//     trilens::write_image("panorama.exr", made.image);
//
//     trilens::FilmMapRequest same;
//     same.target = trilens::parse_target("equirect:1024x512", renderer.scene());
//     trilens::write_map("unwrap.exr", trilens::make_map(renderer, same));
//
//     trilens::CausticMapRequest light;
//     light.target = trilens::parse_target("tiles:256x256", renderer.scene());
//     trilens::write_image("caustic.exr", trilens::image_of(trilens::make_caustic_map(renderer, light)));
//
//     trilens::BakeRequest coarse;
//     coarse.patch_size = 0.2;
//     coarse.contrast = 2;
//     const trilens::Renderer lit(trilens::bake_light(renderer, coarse).scene);
//     trilens::write_image("lit.exr", lit.draw({}).image);
#pragma once

#include <string>
#include <vector>

#include "inverse/maps/caustic_map.h"
#include "inverse/maps/film_map.h"
#include "inverse/unwrap/unwrap.h"
#include "radiosity/bake.h"
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

/// See make_film_map in the room `inverse`: throws as that does.
FilmMap make_map(const Renderer& renderer, const FilmMapRequest& request, const Progress& progress = {});

/// See make_warp_mesh in the room `inverse`: throws as that does.
WarpMesh make_mesh(const Renderer& renderer, const FilmMapRequest& request, const WarpMeshParams& params,
                   const Progress& progress = {});

/// What a map's file is by its ending: "exr" (STMap), "npz" (OpenCV), "pgm" (ffmpeg; two files), "data"
/// (Bourke's mesh) or "obj" (the mesh). Throws UsageError for other endings.
std::string map_format(const std::string& file);

/// Writes .exr, .npz or .pgm (as NAME_x.pgm and NAME_y.pgm). `t_up`: of STMaps, see stmap_of. Throws
/// UsageError for other endings, OutputError.
void write_map(const std::string& file, const FilmMap& map, bool t_up = false);

/// Writes .data or .obj. Throws likewise.
void write_mesh(const std::string& file, const WarpMesh& mesh);

/// See make_caustic_map in the room `inverse`: throws as that does.
CausticMap make_caustic_map(const Renderer& renderer, const CausticMapRequest& request,
                            const Progress& progress = {});

/// See bake_light in the room `radiosity`: throws as that does.
Bake bake_light(const Renderer& renderer, const BakeRequest& request, const Progress& progress = {});

}  // namespace trilens
