// glTF and GLB files: THE door to tinygltf (with gltf_read.cpp and gltf_accessor.cpp).
#include "scene/formats/gltf_file.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/util/error.h"
#include "json/json.h"
#include "scene/data/polygons.h"
#include "scene/formats/gltf_parts.h"

namespace trilens {
namespace {

/// Keeps the encoded bytes: pictures are decoded by the caller's reader, and only where they are used.
bool keep_encoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
    image->as_is = true;
    // Those in buffer views come without a check of where the buffer ends: who needs them takes them there.
    if (image->bufferView < 0 && bytes && size > 0) image->image.assign(bytes, bytes + size);
    return true;
}

/// Without the name that the JSON library gives its complaint.
std::string without_tag(const std::string& reason) {
    const std::size_t end = reason.find("] ");
    return reason.rfind("[json.", 0) == 0 && end != std::string::npos ? reason.substr(end + 2) : reason;
}

/// The library quotes whole data URIs.
std::string shortened(const std::string& reason) {
    constexpr std::size_t kMost = 200;
    return reason.size() <= kMost ? reason : reason.substr(0, kMost) + "...";
}

/// The text of a glTF, and how long the bytes are that a GLB has beside it.
struct GltfText {
    std::string_view json;
    std::size_t beside = 0;
};

GltfText text_of(std::string_view bytes) {
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    if (bytes.rfind("glTF", 0) != 0) return {bytes};
    const auto length_at = [&](std::size_t at) {
        std::uint32_t length = 0;
        if (at + kChunkHeader <= bytes.size()) std::memcpy(&length, bytes.data() + at, sizeof length);
        return std::size_t{length};
    };
    const std::size_t start = std::min(kHeader + kChunkHeader, bytes.size());
    return {bytes.substr(start, length_at(kHeader)), length_at(start + length_at(kHeader))};
}

/// How many bytes a buffer has in truth; none: it is in a file that cannot be read.
std::optional<std::size_t> buffer_size(const Node& buffer, const std::string& uri, std::size_t beside) {
    if (uri.empty()) return beside;
    if (uri.rfind("data:", 0) == 0) {
        const std::size_t comma = uri.find(',');
        if (comma == std::string::npos || !uri.substr(0, comma).ends_with(";base64"))
            buffer["uri"].fail("a data URI without ';base64,' is not read");
        const std::size_t start = comma + 1, end = uri.find_last_not_of('=') + 1;
        return end > start ? (end - start) * 3 / 4 : 0;
    }
    std::error_code failure;
    const auto folder = std::filesystem::path(buffer.file).parent_path();
    const std::uintmax_t size = std::filesystem::file_size(folder / decode_gltf_uri(uri), failure);
    return failure ? std::nullopt : std::optional(static_cast<std::size_t>(size));
}

/// Buffers that hold more than is read of them, which the library refuses.
struct LongBuffers {
    Json json;                                             // that says how long they are in truth
    std::vector<std::pair<std::size_t, std::size_t>> cut;  // which, and how long they should be
};

/// Throws InputError where one is not there or is shorter than it says, of which the library says less, or
/// all that a data URI holds.
LongBuffers check_buffers(const std::string& file, std::string_view bytes) {
    const GltfText text = text_of(bytes);
    const Json json = Json::parse(text.json, nullptr, false);
    if (!json.is_object() || !json.contains("buffers") || !json["buffers"].is_array()) return {};
    LongBuffers longer{json, {}};
    const Node buffers = Node{json, "", file}["buffers"];
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        const Node buffer = buffers[i];
        if (!buffer.json.is_object() || !buffer.has("byteLength")) continue;
        const Json& says = buffer.json["byteLength"];
        if (!says.is_number_unsigned() || (buffer.has("uri") && !buffer.json["uri"].is_string())) continue;
        const std::string uri = buffer.has("uri") ? buffer.json["uri"].get<std::string>() : std::string();
        const std::optional<std::size_t> has = buffer_size(buffer, uri, text.beside);
        if (!has) buffer["uri"].fail("the buffer '" + uri + "' cannot be read");
        if (says > *has || says == 0)
            buffer["byteLength"].fail("is " + says.dump() + ", but the buffer holds " + std::to_string(*has) +
                                      " bytes");
        if (uri.empty() || says == *has) continue;
        longer.json["buffers"][i]["byteLength"] = *has;
        longer.cut.emplace_back(i, says.get<std::size_t>());
    }
    return longer;
}

/// The same file with another JSON in it.
std::string with_json(std::string_view bytes, const Json& json) {
    std::string text = json.dump();
    if (bytes.rfind("glTF", 0) != 0) return text;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t number) {
        const auto value = static_cast<std::uint32_t>(number);
        return std::string(reinterpret_cast<const char*>(&value), sizeof value);
    };
    const std::string_view old = text_of(bytes).json;
    const std::string_view rest = bytes.substr(static_cast<std::size_t>(old.end() - bytes.begin()));
    const std::string chunk = word(text.size()) + "JSON" + text + std::string(rest);
    return std::string(bytes.substr(0, 8)) + word(12 + chunk.size()) + chunk;
}

[[noreturn]] void fail(const std::string& file, std::string_view bytes, const std::string& reason) {
    // Compressed accessors have no buffer view, which is all that the library says of them.
    const bool draco = bytes.find("\"KHR_draco_mesh_compression\"") != std::string::npos;
    throw InputError(file, "",
                     "not a readable glTF file: " + shortened(one_line(without_tag(reason))) +
                         (draco ? " (it uses KHR_draco_mesh_compression, which is not supported)" : ""));
}

/// None: the library says why.
std::optional<tinygltf::Model> read_model(const std::string& file, std::string_view bytes,
                                          std::string& reason) {
    if (bytes.size() > std::numeric_limits<unsigned int>::max())
        throw InputError(file, "", "is larger than 4 GiB");
    const auto size = static_cast<unsigned int>(bytes.size());
    const std::string folder = std::filesystem::path(file).parent_path().string();
    const bool is_binary = bytes.rfind("glTF", 0) == 0;

    tinygltf::TinyGLTF reader;
    reader.SetImageLoader(keep_encoded, nullptr);
    tinygltf::Model model;
    std::string warnings;
    reason.clear();
    try {
        const auto* start = reinterpret_cast<const unsigned char*>(bytes.data());
        if (is_binary ? reader.LoadBinaryFromMemory(&model, &reason, &warnings, start, size, folder)
                      : reader.LoadASCIIFromString(&model, &reason, &warnings, bytes.data(), size, folder))
            return model;
    } catch (const std::exception& error) {
        reason = error.what();
    }
    return std::nullopt;
}

/// Throws InputError for another than 2.0, and for a file that asks for more.
void check_version(const Json& json, const std::string& file) {
    const auto says = [&](const char* key, const char* otherwise) {
        const Json::json_pointer place(key);
        if (!json.contains(place)) return std::string(otherwise);
        const Json& version = json.at(place);
        if (version.is_number()) return version.dump();
        return version.is_string() ? version.get<std::string>() : std::string(otherwise);
    };
    const std::string version = says("/asset/version", "2.0"), least = says("/asset/minVersion", "2.0");
    if (!version.starts_with("2."))
        fail_at(file, "/asset/version", "glTF '" + version + "' is not supported, 2.0 is");
    if (least != "2.0" && !least.starts_with("1."))
        fail_at(file, "/asset/minVersion", "glTF '" + least + "' is needed, which is not supported: 2.0 is");
}

/// What is no JSON is left to the library, which says where.
void check_json(const std::string& file, std::string_view bytes) {
    const Json json = Json::parse(text_of(bytes).json, nullptr, false);
    if (json.is_discarded()) return;
    check_version(json, file);
    check_gltf_keys(json, file);
}

}  // namespace

tinygltf::Model load_gltf_model(const std::string& file) {
    const std::string whole = read_required_file(file);
    const std::string_view bytes = utf8_text(whole, file);
    check_json(file, bytes);
    std::string reason;
    std::optional<tinygltf::Model> model = read_model(file, bytes, reason);
    if (!model) {
        const LongBuffers longer = check_buffers(file, bytes);
        if (!longer.cut.empty()) model = read_model(file, with_json(bytes, longer.json), reason);
        if (!model) fail(file, bytes, reason);
        for (const auto& [buffer, size] : longer.cut) model->buffers[buffer].data.resize(size);
    }
    return std::move(*model);
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

// Accessor, buffer view, buffer: glTF 2.0 specification, section 3.6.2.

namespace {

constexpr std::size_t kMostEntries = std::size_t{1} << 28;

struct Place {
    const std::string& file;
    int accessor;

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(file, "/accessors/" + std::to_string(accessor), message);
    }
};

/// Where entries of one type lie: count of them, stride bytes apart.
struct Entries {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;
};

/// Bytes [offset, ...) of a buffer view that must hold `count` entries of `entry_size` bytes.
Entries find_entries(const tinygltf::Model& model, int view_index, std::size_t offset, std::size_t count,
                     std::size_t entry_size, const Place& place) {
    if (view_index < 0 || static_cast<std::size_t>(view_index) >= model.bufferViews.size())
        place.fail("buffer view " + std::to_string(view_index) + " is out of range");
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(view_index)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
        place.fail("buffer " + std::to_string(view.buffer) + " is out of range");
    const std::vector<unsigned char>& bytes = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
        place.fail("its buffer view reaches beyond its buffer");

    const std::size_t stride = view.byteStride == 0 ? entry_size : view.byteStride;
    if (stride < entry_size || stride > 252 + entry_size)
        place.fail("its buffer view has an impossible stride");
    if (offset > view.byteLength ||
        (count > 0 && (count - 1) * stride + entry_size > view.byteLength - offset))
        place.fail("reaches beyond its buffer view");
    return {bytes.data() + view.byteOffset + offset, stride};
}

template <class T>
double component(const unsigned char* bytes, bool normalized) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    if (!normalized || !std::numeric_limits<T>::is_integer) return static_cast<double>(value);
    return std::max(static_cast<double>(value) / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
}

double read_component(const unsigned char* bytes, int type, bool normalized, const Place& place) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return component<std::int8_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return component<std::uint8_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return component<std::int16_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return component<std::uint16_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return component<std::uint32_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return component<float>(bytes, false);
        default:
            place.fail("unknown component type " + std::to_string(type));
    }
}

std::size_t component_size(int type, const Place& place) {
    const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type));
    if (size <= 0 || type == TINYGLTF_COMPONENT_TYPE_DOUBLE || type == TINYGLTF_COMPONENT_TYPE_INT)
        place.fail("unknown component type " + std::to_string(type));
    return static_cast<std::size_t>(size);
}

std::size_t non_negative(int value, const Place& place) {
    if (value < 0) place.fail("has a negative offset or count");
    return static_cast<std::size_t>(value);
}

void fill_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, std::size_t components,
                 const Place& place, std::vector<double>& numbers) {
    const auto& sparse = accessor.sparse;
    const std::size_t count = non_negative(sparse.count, place);
    if (count > accessor.count) place.fail("has more sparse entries than entries");
    const std::size_t size = component_size(accessor.componentType, place);
    const std::size_t index_size = component_size(sparse.indices.componentType, place);
    const Entries indices =
        find_entries(model, sparse.indices.bufferView, non_negative(sparse.indices.byteOffset, place), count,
                     index_size, place);
    const Entries values =
        find_entries(model, sparse.values.bufferView, non_negative(sparse.values.byteOffset, place), count,
                     size * components, place);
    for (std::size_t i = 0; i < count; ++i) {
        const double index =
            read_component(indices.first + i * indices.stride, sparse.indices.componentType, false, place);
        if (!(index >= 0 && index < static_cast<double>(accessor.count)))
            place.fail("a sparse index is out of range");
        for (std::size_t c = 0; c < components; ++c)
            numbers[static_cast<std::size_t>(index) * components + c] =
                read_component(values.first + i * values.stride + c * size, accessor.componentType,
                               accessor.normalized, place);
    }
}

}  // namespace

std::vector<double> read_gltf_accessor(const tinygltf::Model& model, int index, int components,
                                       const std::string& file) {
    const Place place{file, index};
    if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
        place.fail("is out of range: there are " + std::to_string(model.accessors.size()) + " accessors");
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    if (tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)) != components)
        place.fail("must have entries of " + std::to_string(components) + " components");
    if (accessor.count > kMostEntries) place.fail("has too many entries");

    const auto width = static_cast<std::size_t>(components);
    const std::size_t size = component_size(accessor.componentType, place);
    std::vector<double> numbers;
    if (accessor.bufferView < 0) {
        if (!accessor.sparse.isSparse) place.fail("has no buffer view (its data may be compressed)");
        numbers.assign(accessor.count * width, 0);
    } else {
        const Entries entries = find_entries(model, accessor.bufferView, accessor.byteOffset, accessor.count,
                                             size * width, place);
        numbers.reserve(accessor.count * width);
        for (std::size_t i = 0; i < accessor.count; ++i)
            for (std::size_t c = 0; c < width; ++c)
                numbers.push_back(read_component(entries.first + i * entries.stride + c * size,
                                                 accessor.componentType, accessor.normalized, place));
    }
    if (accessor.sparse.isSparse) fill_sparse(model, accessor, width, place, numbers);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        if (!(std::abs(numbers[i]) <= kLargestCoordinate))
            place.fail("entry " + std::to_string(i / width) +
                       " holds a number that is not finite or beyond 1e30");
    return numbers;
}

}  // namespace trilens
