// glTF and GLB files: THE door to tinygltf (with gltf_read.cpp and gltf_accessor.cpp).
#include "scene/formats/gltf_file.h"

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <limits>
#include <string_view>

#include <tiny_gltf.h>

#include "base/util/error.h"
#include "scene/json/files.h"

namespace trilens {
namespace {

/// Keeps the encoded bytes: pictures are decoded by the caller's reader, and only where they are used.
bool keep_encoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
    image->as_is = true;
    if (bytes && size > 0) image->image.assign(bytes, bytes + size);
    return true;
}

/// Without the name that the JSON library gives its complaint.
std::string without_tag(const std::string& reason) {
    const std::size_t end = reason.find("] ");
    return reason.rfind("[json.", 0) == 0 && end != std::string::npos ? reason.substr(end + 2) : reason;
}

[[noreturn]] void fail(const std::string& file, std::string_view bytes, const std::string& reason) {
    // Compressed accessors have no buffer view, which is all that the library says of them.
    const bool draco = bytes.find("\"KHR_draco_mesh_compression\"") != std::string::npos;
    throw InputError(file, "",
                     "not a readable glTF file: " + one_line(without_tag(reason)) +
                         (draco ? " (it uses KHR_draco_mesh_compression, which is not supported)" : ""));
}

}  // namespace

tinygltf::Model load_gltf_model(const std::string& file) {
    const std::string whole = read_required_file(file);
    const std::string_view bytes = utf8_text(whole, file);
    if (bytes.size() > std::numeric_limits<unsigned int>::max())
        throw InputError(file, "", "is larger than 4 GiB");
    const auto size = static_cast<unsigned int>(bytes.size());
    const std::string folder = std::filesystem::path(file).parent_path().string();
    const bool is_binary = bytes.rfind("glTF", 0) == 0;

    tinygltf::TinyGLTF reader;
    reader.SetImageLoader(keep_encoded, nullptr);
    tinygltf::Model model;
    std::string errors, warnings;
    bool done = false;
    try {
        const auto* start = reinterpret_cast<const unsigned char*>(bytes.data());
        done = is_binary ? reader.LoadBinaryFromMemory(&model, &errors, &warnings, start, size, folder)
                         : reader.LoadASCIIFromString(&model, &errors, &warnings, bytes.data(), size, folder);
    } catch (const std::exception& error) {
        fail(file, bytes, error.what());
    }
    if (!done) fail(file, bytes, errors);
    if (model.asset.version.rfind("2.", 0) != 0)
        throw InputError(file, "/asset/version",
                         "glTF '" + one_line(model.asset.version) + "' is not supported, 2.0 is");
    return model;
}

std::string decode_gltf_uri(const std::string& uri) {
    const auto is_hex = [&](std::size_t i) {
        return i < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[i]));
    };
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const bool escaped = uri[i] == '%' && is_hex(i + 1) && is_hex(i + 2);
        text += escaped ? static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16)) : uri[i];
        if (escaped) i += 2;
    }
    return text;
}

}  // namespace trilens
