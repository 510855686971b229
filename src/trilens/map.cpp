#include "trilens/map.h"

#include "base/files/files.h"
#include "base/util/error.h"
#include "trilens/image.h"

namespace trilens {

FilmMap make_map(const Renderer& renderer, const FilmMapRequest& request, const Progress& progress) {
    FilmMap map;
    renderer.use_world([&](const World& world) { map = make_film_map(world, request, progress); });
    return map;
}

WarpMesh make_mesh(const Renderer& renderer, const FilmMapRequest& request, const WarpMeshParams& params,
                   const Progress& progress) {
    WarpMesh mesh;
    renderer.use_world([&](const World& world) { mesh = make_warp_mesh(world, request, params, progress); });
    return mesh;
}

std::string map_format(const std::string& file) {
    for (const char* format : {"exr", "npz", "pgm", "data", "obj"})
        if (file.size() > std::string(format).size() + 1 && file.ends_with(std::string(".") + format))
            return format;
    throw UsageError(
        "the map \"" + file +
        "\" must end in .exr (STMap), .npz (OpenCV), .pgm (ffmpeg), .data (Bourke's mesh) or .obj");
}

void write_map(const std::string& file, const FilmMap& map, bool t_up) {
    const std::string format = map_format(file);
    if (format == "exr") return write_image(file, stmap_of(map, t_up));
    if (format == "npz") return replace_file(file, npz_of(map));
    if (format != "pgm") throw UsageError("a ." + format + " is a mesh, not a map of pixels");
    for (const MapAxis axis : {MapAxis::kX, MapAxis::kY})
        replace_file(pgm_name(file, axis), pgm_of(map, axis));
}

void write_mesh(const std::string& file, const WarpMesh& mesh) {
    const std::string format = map_format(file);
    if (format != "data" && format != "obj")
        throw UsageError("a ." + format + " is a map of pixels, not a mesh");
    replace_text_file(file, format == "data" ? bourke_mesh(mesh) : obj_mesh(mesh));
}

}  // namespace trilens
