#include "scene/read/named_files.h"

#include <filesystem>
#include <map>
#include <sstream>

namespace trilens {
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
