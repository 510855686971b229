// Which files a scene is made of.
#include "scene/read/reading.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include "base/description/digest.h"
#include "json/json.h"

namespace trilens {

FileRead make_file_read(const std::string& path, std::string_view bytes) {
    return {std::filesystem::absolute(path).string(), hash_text(bytes)};
}

Reading::Reading(const std::string& named, const std::string& paths_start_here, const TextureReader& pictures)
    : file(named), folder(paths_start_here) {
    textures.from_memory = pictures.from_memory;
    textures.letters = pictures.letters;
    textures.film_moves = pictures.film_moves;
    textures.progress = pictures.progress;
    textures.inflate =
        pictures.inflate ? pictures.inflate : [](std::string_view, std::span<char>) { return false; };
    if (pictures.heights_from_file)
        textures.heights_from_file = [this, heights_from_file =
                                                pictures.heights_from_file](const std::string& path) {
            note_file(path);
            return heights_from_file(path);
        };
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

namespace {

/// Path from the scene's folder -> hash.
std::map<std::string, std::string> named_files(const Scene& scene) {
    namespace fs = std::filesystem;
    const fs::path own = scene.file.empty() ? fs::path() : fs::absolute(scene.file).lexically_normal();
    std::map<std::string, std::string> named;
    for (const FileRead& file : scene.files) {
        const fs::path path = fs::path(file.path).lexically_normal();
        if (path != own) named[path.lexically_proximate(scene.folder).string()] = file.hash;
    }
    return named;
}

}  // namespace

std::string named_files_text(const Scene& scene) {
    std::string text;
    for (const auto& [path, hash] : named_files(scene)) text += hash + " " + path + "\n";
    return text;
}

std::vector<std::string> changed_files(const Scene& scene, const std::string& text) {
    const std::map<std::string, std::string> now = named_files(scene);
    std::vector<std::string> changed;
    std::istringstream lines(text);
    for (std::string hash, path; lines >> hash && lines.get() && std::getline(lines, path);) {
        const auto found = now.find(path);
        if (found != now.end() && found->second != hash) changed.push_back(path);
    }
    return changed;
}

}  // namespace trilens
