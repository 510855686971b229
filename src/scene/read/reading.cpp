// Which files a scene is made of.
#include "scene/read/reading.h"

#include <algorithm>

#include "base/util/hash.h"
#include "scene/json/files.h"

namespace trilens {

FileRead make_file_read(const std::string& path, std::string_view bytes) {
    return {std::filesystem::absolute(path).string(), hash_text(bytes)};
}

Reading::Reading(const std::string& named, const std::string& paths_start_here, const TextureReader& pictures)
    : file(named), folder(paths_start_here) {
    textures.from_memory = pictures.from_memory;
    if (!pictures.from_file) return;
    textures.from_file = [this, from_file = pictures.from_file](const std::string& path) {
        note_file(path);
        return from_file(path);
    };
}

std::string Reading::read_file(const std::string& path) {
    std::string bytes = read_required_file(path);
    FileRead read = make_file_read(path, bytes);
    const bool is_known = std::any_of(scene.files.begin(), scene.files.end(),
                                      [&](const FileRead& known) { return known.path == read.path; });
    if (!is_known) scene.files.push_back(std::move(read));
    return bytes;
}

}  // namespace trilens
