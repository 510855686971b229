// Maps between what a camera sees and panoramas, domes, planes or objects, in the formats of other programs.
//
//     #include <trilens/scene.h>
//     const trilens::Renderer renderer(trilens::load_scene({"ball.json"}));
//     trilens::FilmMapRequest request;
//     request.target = trilens::parse_target("equirect:4096x2048", renderer.scene());
//     trilens::write_map("unwrap.exr", trilens::make_map(renderer, request));
#pragma once

#include <string>

#include "inverse/maps/film_map.h"
#include "trilens/render.h"

namespace trilens {

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

}  // namespace trilens
