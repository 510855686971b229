// Unwrapping, maps and anamorphoses for callers: renderers instead of worlds, and files by their endings.
#include <array>
#include <memory>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/names.h"
#include "image/image_io.h"
#include "trilens/anamorph.h"
#include "trilens/image.h"
#include "trilens/maps.h"

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

CausticMap make_caustic_map(const Renderer& renderer, const CausticMapRequest& request,
                            const Progress& progress) {
    CausticMap map;
    renderer.use_world([&](const World& world) { map = make_caustic_map(world, request, progress); });
    return map;
}

Bake bake_light(const Renderer& renderer, const BakeRequest& request, const Progress& progress) {
    Bake bake;
    renderer.use_world([&](const World& world) { bake = bake_light(world, request, progress); });
    return bake;
}

std::string map_format(const std::string& file) {
    for (const char* format : {"exr", "npz", "pgm", "data", "obj"})
        if (file_ending(file) == std::string(".") + format) return format;
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

Id find_mesh(const Scene& scene, const std::string& name) {
    std::vector<std::string> names;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (scene.meshes[m].name == name) return static_cast<Id>(m);
        names.push_back(scene.meshes[m].name);
    }
    throw UsageError("there is no object \"" + name + "\"" + suggestion(name, names));
}

Anamorph make_anamorph(const Renderer& renderer, const AnamorphRequest& request, const Progress& progress) {
    Anamorph made;
    renderer.use_world([&](const World& world) { made = make_anamorph(world, request, progress); });
    return made;
}

AnamorphCheck verify_anamorph(const Renderer& renderer, const AnamorphRequest& request, const Anamorph& made,
                              const Progress& progress) {
    AnamorphCheck check;
    renderer.use_world([&](const World& world) { check = verify_anamorph(world, request, made, progress); });
    return check;
}

void check_page_name(const std::string& file) {
    for (const char* end : {".pdf", ".svg", ".png"})
        if (file_ending(file) == end) return;
    throw UsageError("the page \"" + file + "\" must end in .pdf, .svg or .png");
}

void write_page(const std::string& file, const AnamorphPage& page) {
    check_page_name(file);
    const std::string ending = file_ending(file);
    if (ending == ".pdf") return replace_file(file, pdf_of(page));
    if (ending == ".svg") return replace_text_file(file, svg_of(page));
    replace_file(file, png_of(page));
}

}  // namespace trilens
