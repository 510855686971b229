// A tinygltf model, checked, as plain data.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <tiny_gltf.h>

#include "base/util/error.h"
#include "scene/formats/gltf.h"
#include "scene/formats/gltf_file.h"
#include "scene/formats/gltf_parts.h"

namespace trilens {
namespace {

const std::string kWebpUri = "data:image/webp;base64,", kBytesUri = "data:application/octet-stream;base64,";

class Reader {
  public:
    explicit Reader(GltfSource& source) : source_(source), in_(source.model) {}

    GltfModel read() {
        check_gltf_extensions(source_);
        find_buffer_files();
        read_images();
        read_gltf_materials(source_, out_);
        read_gltf_meshes(source_, out_);
        read_gltf_views(source_, out_);
        for (std::size_t i = 0; i < in_.nodes.size(); ++i) read_node(i);
        read_gltf_instances(source_, out_);
        find_parents();
        read_roots();
        read_gltf_motion(source_, out_);
        out_.warnings.assign(source_.warned.begin(), source_.warned.end());
        out_.material_warnings.assign(source_.material_warned.begin(), source_.material_warned.end());
        return std::move(out_);
    }

  private:
    [[noreturn]] void fail(const std::string& place, const std::string& message) const {
        source_.fail(place, message);
    }
    int checked(int index, std::size_t count, const std::string& place, const char* what) const {
        return source_.checked(index, count, place, what);
    }

    void find_buffer_files() {
        for (std::size_t i = 0; i < in_.buffers.size(); ++i) {
            std::string path = source_.resolve(in_.buffers[i].uri);
            if (path.empty()) continue;
            // The library takes one of that name from the working directory, too.
            std::error_code none;
            if (!std::filesystem::exists(path, none))
                fail("/buffers/" + std::to_string(i) + "/uri",
                     "the buffer '" + in_.buffers[i].uri + "' cannot be read");
            out_.buffer_files.push_back(std::move(path));
        }
    }

    void read_images() {
        for (std::size_t i = 0; i < in_.images.size(); ++i) {
            const tinygltf::Image& image = in_.images[i];
            GltfImage result;
            const std::string place = "/images/" + std::to_string(i);
            result.name = source_.file + ": " + place;
            result.encoded = image.bufferView >= 0 ? view_bytes(image.bufferView, place) : image.image;
            if (image.uri.rfind(kWebpUri, 0) == 0) {
                // A kind of data that the library does not know by its name.
                std::string kind;
                tinygltf::DecodeDataURI(&result.encoded, kind, kBytesUri + image.uri.substr(kWebpUri.size()),
                                        0, false);
            }
            result.file = source_.resolve(image.uri);
            if (!result.file.empty()) result.uri = decode_gltf_uri(image.uri);
            out_.images.push_back(std::move(result));
        }
    }

    /// The library hands pictures over without looking where their buffers end.
    std::vector<unsigned char> view_bytes(int index, const std::string& place) const {
        const auto& view = in_.bufferViews[static_cast<std::size_t>(
            checked(index, in_.bufferViews.size(), place, "buffer view"))];
        if (view.buffer < 0) fail(place, "its buffer view names no buffer");
        const auto& bytes =
            in_.buffers[static_cast<std::size_t>(checked(view.buffer, in_.buffers.size(), place, "buffer"))]
                .data;
        if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
            fail(place, "its buffer view reaches beyond its buffer");
        const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(view.byteOffset);
        return {first, first + static_cast<std::ptrdiff_t>(view.byteLength)};
    }

    void read_node(std::size_t index) {
        const tinygltf::Node& node = in_.nodes[index];
        const std::string place = "/nodes/" + std::to_string(index);
        GltfNode result;
        result.name = node.name;
        result.mesh = checked(node.mesh, in_.meshes.size(), place, "mesh");
        result.skin = checked(node.skin, in_.skins.size(), place, "skin");
        result.camera = checked(node.camera, in_.cameras.size(), place, "camera");
        result.weights = node.weights;
        source_.check_weights(node.weights, place);
        result.extras = json_of_gltf(node.extras);
        const auto light = node.extensions.find("KHR_lights_punctual");
        if (light != node.extensions.end()) {
            const Json number = json_of_gltf(light->second);
            if (!number.is_object() || !number.contains("light") || !number.at("light").is_number_integer())
                fail(place + "/extensions/KHR_lights_punctual", "names no light");
            result.light = checked(number.at("light").get<int>(), in_.lights.size(), place, "light");
        }
        for (const int child : node.children) {
            if (child < 0) fail(place, "a child has a negative index");
            result.children.push_back(checked(child, in_.nodes.size(), place, "child"));
        }
        read_transform(node, place, result);
        out_.nodes.push_back(std::move(result));
    }

    void read_transform(const tinygltf::Node& node, const std::string& place, GltfNode& into) const {
        const auto check = [&](const std::vector<double>& numbers, std::size_t count, const char* what) {
            if (!numbers.empty() && numbers.size() != count)
                fail(place, std::string(what) + " must have " + std::to_string(count) + " numbers");
            for (const double number : numbers)
                if (!(std::abs(number) <= kLargestCoordinate))
                    fail(place, std::string(what) + " holds a number beyond 1e30");
        };
        check(node.matrix, 16, "matrix");
        check(node.translation, 3, "translation");
        check(node.rotation, 4, "rotation");
        check(node.scale, 3, "scale");
        if (!node.matrix.empty()) {
            into.matrix = make_transform(std::span<const double, 16>(node.matrix.data(), 16));
            if (!into.matrix) fail(place, "the last row of matrix must be 0 0 0 1");
            return;
        }
        const auto& t = node.translation;
        const auto& r = node.rotation;
        const auto& s = node.scale;
        if (!t.empty()) into.translation = {t[0], t[1], t[2]};
        if (!r.empty()) into.rotation = {r[0], r[1], r[2], r[3]};
        if (!s.empty()) into.scale = {s[0], s[1], s[2]};
        if (into.rotation == Vec4(0)) fail(place, "rotation must not be zero");
    }

    /// Nodes must form trees: one parent at most, and from each node up an end.
    void find_parents() {
        for (std::size_t i = 0; i < out_.nodes.size(); ++i)
            for (const int child : out_.nodes[i].children) {
                int& parent = out_.nodes[static_cast<std::size_t>(child)].parent;
                if (parent >= 0)
                    fail("/nodes/" + std::to_string(child), "is a child of node " + std::to_string(parent) +
                                                                " and of node " + std::to_string(i) +
                                                                ": nodes must form a tree");
                parent = static_cast<int>(i);
            }
        // 0: not looked at, 1: on the way up from here, 2: has an end.
        std::vector<char> state(out_.nodes.size(), 0);
        std::vector<std::size_t> way;
        for (std::size_t i = 0; i < out_.nodes.size(); ++i) {
            way.clear();
            int at = static_cast<int>(i);
            for (; at >= 0 && state[static_cast<std::size_t>(at)] == 0;
                 at = out_.nodes[static_cast<std::size_t>(at)].parent) {
                state[static_cast<std::size_t>(at)] = 1;
                way.push_back(static_cast<std::size_t>(at));
            }
            if (at >= 0 && state[static_cast<std::size_t>(at)] == 1)
                fail("/nodes/" + std::to_string(at), "is its own ancestor: nodes must form a tree");
            for (const std::size_t passed : way) state[passed] = 2;
        }
    }

    /// The default scene; else the first; else the nodes that are no node's children.
    void read_roots() {
        const int scene = checked(in_.defaultScene, in_.scenes.size(), "/scene", "scene");
        if (!in_.scenes.empty()) {
            const std::string place = "/scenes/" + std::to_string(std::max(scene, 0));
            std::set<int> seen;
            for (const int node : in_.scenes[static_cast<std::size_t>(std::max(scene, 0))].nodes) {
                if (node < 0) fail(place, "a node has a negative index");
                out_.roots.push_back(checked(node, in_.nodes.size(), place, "node"));
                if (out_.nodes[static_cast<std::size_t>(node)].parent >= 0 || !seen.insert(node).second)
                    fail(place, "node " + std::to_string(node) + " is reached twice: nodes must form a tree");
            }
            return;
        }
        for (std::size_t i = 0; i < out_.nodes.size(); ++i)
            if (out_.nodes[i].parent < 0) out_.roots.push_back(static_cast<int>(i));
    }

    GltfSource& source_;
    const tinygltf::Model& in_;
    GltfModel out_;
};

}  // namespace

void GltfSource::fail(const std::string& place, const std::string& message) const {
    throw InputError(file, place, message);
}

int GltfSource::checked(int index, std::size_t count, const std::string& place, const char* what) const {
    if (index < -1 || (index >= 0 && static_cast<std::size_t>(index) >= count))
        fail(place, std::string(what) + " " + std::to_string(index) + " is out of range: there are " +
                        std::to_string(count));
    return index;
}

void GltfSource::check_weights(const std::vector<double>& weights, const std::string& place) const {
    for (const double weight : weights)
        if (!(std::abs(weight) <= kLargestCoordinate)) fail(place + "/weights", "a weight is beyond 1e30");
}

std::string GltfSource::resolve(const std::string& uri) const {
    if (uri.empty() || uri.rfind("data:", 0) == 0) return "";
    return (std::filesystem::path(file).parent_path() / decode_gltf_uri(uri)).string();
}

GltfModel read_gltf(const std::string& file) {
    const tinygltf::Model model = load_gltf_model(file);
    GltfSource source{model, file};
    return Reader(source).read();
}

}  // namespace trilens
