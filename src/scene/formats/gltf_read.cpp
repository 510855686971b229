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

namespace trilens {
namespace {

class Reader {
  public:
    Reader(const tinygltf::Model& model, const std::string& file) : in_(model), file_(file) {}

    GltfModel read() {
        check_extensions();
        find_buffer_files();
        read_images();
        for (std::size_t i = 0; i < in_.materials.size(); ++i) read_material(i);
        for (std::size_t i = 0; i < in_.meshes.size(); ++i) read_mesh(i);
        for (std::size_t i = 0; i < in_.nodes.size(); ++i) read_node(i);
        read_roots();
        if (!in_.animations.empty()) warn("animations are ignored");
        if (!in_.cameras.empty()) warn("cameras are ignored: the scene names its own");
        if (!in_.lights.empty()) warn("lights are ignored: the scene names its own");
        if (!in_.skins.empty()) warn("skins are ignored: meshes stand in their bind pose");
        out_.warnings.assign(warned_.begin(), warned_.end());
        out_.material_warnings.assign(material_warned_.begin(), material_warned_.end());
        return std::move(out_);
    }

  private:
    [[noreturn]] void fail(const std::string& place, const std::string& message) const {
        throw InputError(file_, place, message);
    }
    void warn(const std::string& message) { warned_.insert(message); }
    void warn_of_material(const std::string& message) { material_warned_.insert(message); }

    int checked(int index, std::size_t count, const std::string& place, const char* what) const {
        if (index < -1 || (index >= 0 && static_cast<std::size_t>(index) >= count))
            fail(place, std::string(what) + " " + std::to_string(index) + " is out of range: there are " +
                            std::to_string(count));
        return index;
    }

    void check_extensions() {
        static const std::set<std::string> known = {"KHR_materials_unlit", "KHR_mesh_quantization",
                                                    "KHR_texture_transform"};
        for (const std::string& name : in_.extensionsRequired)
            if (known.count(name) == 0)
                fail("/extensionsRequired", "the extension '" + name + "' is required but not supported");
        for (const std::string& name : in_.extensionsUsed)
            if (known.count(name) == 0) warn("the extension '" + name + "' is ignored");
    }

    /// A relative URI as a path from where the program runs; empty for a data URI and for none.
    std::string resolve(const std::string& uri) const {
        if (uri.empty() || uri.rfind("data:", 0) == 0) return "";
        return (std::filesystem::path(file_).parent_path() / decode_gltf_uri(uri)).string();
    }

    void find_buffer_files() {
        for (const tinygltf::Buffer& buffer : in_.buffers) {
            std::string path = resolve(buffer.uri);
            if (!path.empty()) out_.buffer_files.push_back(std::move(path));
        }
    }

    void read_images() {
        for (std::size_t i = 0; i < in_.images.size(); ++i) {
            const tinygltf::Image& image = in_.images[i];
            GltfImage result;
            result.name = file_ + ": /images/" + std::to_string(i);
            result.encoded = image.image;
            result.file = resolve(image.uri);
            out_.images.push_back(std::move(result));
        }
    }

    void read_material(std::size_t index) {
        const tinygltf::Material& material = in_.materials[index];
        const std::string place = "/materials/" + std::to_string(index);
        const tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
        GltfMaterial result;
        result.material.name = material.name.empty() ? "material" + std::to_string(index) : material.name;
        if (pbr.baseColorFactor.size() < 3) fail(place, "baseColorFactor must have 4 numbers");
        for (int k = 0; k < 3; ++k) {
            const double value = pbr.baseColorFactor[static_cast<std::size_t>(k)];
            if (!(value >= 0 && value <= kLargestCoordinate)) fail(place, "baseColorFactor is no colour");
            result.material.base_color_factor[k] = value;
        }
        result.material.unlit = material.extensions.count("KHR_materials_unlit") > 0;
        result.material.metallic_factor = factor(pbr.metallicFactor, place);
        result.material.roughness_factor = factor(pbr.roughnessFactor, place);
        if (material.alphaMode != "OPAQUE")
            warn("alphaMode " + material.alphaMode + " is ignored: all is opaque");
        warn_of_maps(material);
        const int texture = checked(pbr.baseColorTexture.index, in_.textures.size(), place, "texture");
        if (texture >= 0) {
            result.image = checked(in_.textures[static_cast<std::size_t>(texture)].source, in_.images.size(),
                                   "/textures/" + std::to_string(texture), "image");
            if (result.image < 0) warn("a base colour texture without a picture is ignored");
            result.uv_set = pbr.baseColorTexture.texCoord;
            read_sampler(in_.textures[static_cast<std::size_t>(texture)].sampler,
                         result.material.base_color_sampler);
            const auto transform = pbr.baseColorTexture.extensions.find("KHR_texture_transform");
            if (transform != pbr.baseColorTexture.extensions.end())
                read_transform(transform->second, place, result);
        }
        out_.materials.push_back(std::move(result));
    }

    void read_sampler(int index, TextureSampler& sampler) {
        if (checked(index, in_.samplers.size(), "/textures", "sampler") < 0) return;
        const tinygltf::Sampler& given = in_.samplers[static_cast<std::size_t>(index)];
        const auto wrap = [](int code) {
            return code == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::kClampToEdge
                   : code == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::kMirroredRepeat
                                                                   : Wrap::kRepeat;
        };
        sampler.wrap_s = wrap(given.wrapS);
        sampler.wrap_t = wrap(given.wrapT);
    }

    /// KHR_texture_transform.
    void read_transform(const tinygltf::Value& given, const std::string& place, GltfMaterial& into) {
        const auto number = [&](const tinygltf::Value& value) {
            const double got = value.IsNumber() ? value.GetNumberAsDouble() : NAN;
            if (!(std::fabs(got) <= kLargestCoordinate)) fail(place, "KHR_texture_transform is malformed");
            return got;
        };
        const auto pair = [&](const char* key, Vec2& values) {
            if (!given.Has(key)) return;
            const tinygltf::Value& list = given.Get(key);
            if (!list.IsArray() || list.ArrayLen() != 2) fail(place, "KHR_texture_transform is malformed");
            values = {number(list.Get(0)), number(list.Get(1))};
        };
        TextureTransform transform;
        pair("offset", transform.offset);
        pair("scale", transform.scale);
        if (given.Has("rotation")) transform.rotation = number(given.Get("rotation"));
        if (given.Has("texCoord")) into.uv_set = static_cast<int>(number(given.Get("texCoord")));
        set_transform(transform, into.material.base_color_sampler);
    }

    /// What a material has beside its base colour.
    void warn_of_maps(const tinygltf::Material& material) {
        const std::pair<const char*, int> maps[] = {
            {"normal", material.normalTexture.index},
            {"metallic-roughness", material.pbrMetallicRoughness.metallicRoughnessTexture.index},
            {"occlusion", material.occlusionTexture.index},
            {"emissive", material.emissiveTexture.index}};
        for (const auto& [name, texture] : maps)
            if (texture >= 0) warn_of_material(std::string(name) + " maps are ignored");
        if (material.emissiveTexture.index < 0 &&
            std::any_of(material.emissiveFactor.begin(), material.emissiveFactor.end(),
                        [](double value) { return value != 0; }))
            warn_of_material("light that materials emit is ignored");
    }

    double factor(double value, const std::string& place) const {
        if (!(value >= 0 && value <= 1)) fail(place, "metallicFactor and roughnessFactor must lie in 0..1");
        return value;
    }

    void read_mesh(std::size_t index) {
        out_.meshes.emplace_back();
        for (std::size_t i = 0; i < in_.meshes[index].primitives.size(); ++i)
            read_primitive(in_.meshes[index].primitives[i],
                           "/meshes/" + std::to_string(index) + "/primitives/" + std::to_string(i),
                           out_.meshes.back());
    }

    void read_primitive(const tinygltf::Primitive& in, const std::string& place,
                        std::vector<GltfPrimitive>& mesh) {
        const int mode = in.mode == -1 ? TINYGLTF_MODE_TRIANGLES : in.mode;
        if (mode < TINYGLTF_MODE_POINTS || mode > TINYGLTF_MODE_TRIANGLE_FAN)
            fail(place, "unknown mode " + std::to_string(mode));
        if (mode < TINYGLTF_MODE_TRIANGLES)
            return warn("points and lines are skipped: only triangles are drawn");
        if (in.extensions.count("KHR_draco_mesh_compression") > 0)
            fail(place, "KHR_draco_mesh_compression is not supported");
        if (!in.targets.empty()) warn("morph targets are ignored");
        if (in.attributes.count("COLOR_0") > 0) warn("vertex colours are ignored");
        if (in.attributes.count("POSITION") == 0) return warn("a primitive without POSITION is skipped");

        GltfPrimitive result;
        result.material = checked(in.material, in_.materials.size(), place, "material");
        result.positions = vec3s(in.attributes.at("POSITION"));
        if (in.attributes.count("NORMAL") > 0) result.normals = vec3s(in.attributes.at("NORMAL"));
        const int set =
            result.material < 0 ? 0 : out_.materials[static_cast<std::size_t>(result.material)].uv_set;
        const auto uvs = in.attributes.find("TEXCOORD_" + std::to_string(set));
        if (uvs != in.attributes.end()) result.uvs = vec2s(uvs->second);
        if ((!result.normals.empty() && result.normals.size() != result.positions.size()) ||
            (!result.uvs.empty() && result.uvs.size() != result.positions.size()))
            fail(place, "its attributes differ in length");
        result.triangles = triangles(in, mode, result.positions.size(), place);
        mesh.push_back(std::move(result));
    }

    std::vector<Vec3> vec3s(int accessor) const {
        const std::vector<double> numbers = read_gltf_accessor(in_, accessor, 3, file_);
        std::vector<Vec3> result;
        for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
            result.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
        return result;
    }
    std::vector<Vec2> vec2s(int accessor) const {
        const std::vector<double> numbers = read_gltf_accessor(in_, accessor, 2, file_);
        std::vector<Vec2> result;
        for (std::size_t i = 0; i + 1 < numbers.size(); i += 2)
            result.emplace_back(numbers[i], numbers[i + 1]);
        return result;
    }

    /// Lists, strips and fans as triples of vertices; strips turn every second triangle (glTF 2.0,
    /// section 3.7.2.1).
    std::vector<IdTriple> triangles(const tinygltf::Primitive& in, int mode, std::size_t vertices,
                                    const std::string& place) {
        std::vector<Id> order;
        if (in.indices < 0) {
            for (std::size_t i = 0; i < vertices; ++i) order.push_back(static_cast<Id>(i));
        } else {
            for (const double index : read_gltf_accessor(in_, in.indices, 1, file_)) {
                if (!(index >= 0 && index < static_cast<double>(vertices)))
                    fail(place + "/indices", "index " + std::to_string(static_cast<long long>(index)) +
                                                 " is out of range: there are " + std::to_string(vertices) +
                                                 " vertices");
                order.push_back(static_cast<Id>(index));
            }
        }
        std::vector<IdTriple> result;
        if (mode == TINYGLTF_MODE_TRIANGLES) {
            if (order.size() % 3 != 0) warn("a list of triangles ends with an incomplete one");
            for (std::size_t i = 0; i + 2 < order.size(); i += 3)
                result.push_back({order[i], order[i + 1], order[i + 2]});
        } else {
            for (std::size_t i = 0; i + 2 < order.size(); ++i) {
                const std::size_t odd = i % 2;
                result.push_back(mode == TINYGLTF_MODE_TRIANGLE_STRIP
                                     ? IdTriple{order[i], order[i + 1 + odd], order[i + 2 - odd]}
                                     : IdTriple{order[0], order[i + 1], order[i + 2]});
            }
        }
        return result;
    }

    void read_node(std::size_t index) {
        const tinygltf::Node& node = in_.nodes[index];
        const std::string place = "/nodes/" + std::to_string(index);
        GltfNode result;
        result.mesh = checked(node.mesh, in_.meshes.size(), place, "mesh");
        for (const int child : node.children) {
            if (child < 0) fail(place, "a child has a negative index");
            result.children.push_back(checked(child, in_.nodes.size(), place, "child"));
        }
        result.parent_from_node = node_transform(node, place);
        out_.nodes.push_back(std::move(result));
    }

    Transform node_transform(const tinygltf::Node& node, const std::string& place) const {
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
            const std::optional<Transform> t =
                make_transform(std::span<const double, 16>(node.matrix.data(), 16));
            if (!t) fail(place, "the last row of matrix must be 0 0 0 1");
            return *t;
        }
        const auto& t = node.translation;
        const auto& r = node.rotation;
        const auto& s = node.scale;
        const Vec4 rotate = r.empty() ? Vec4(0, 0, 0, 1) : Vec4(r[0], r[1], r[2], r[3]);
        if (rotate == Vec4(0)) fail(place, "rotation must not be zero");
        return make_transform(t.empty() ? Vec3(0) : Vec3(t[0], t[1], t[2]), rotate,
                              s.empty() ? Vec3(1) : Vec3(s[0], s[1], s[2]));
    }

    /// The default scene; else the first; else the nodes that are no node's children.
    void read_roots() {
        const int scene = checked(in_.defaultScene, in_.scenes.size(), "/scene", "scene");
        if (!in_.scenes.empty()) {
            for (const int node : in_.scenes[static_cast<std::size_t>(std::max(scene, 0))].nodes) {
                if (node < 0) fail("/scenes", "a node has a negative index");
                out_.roots.push_back(checked(node, in_.nodes.size(), "/scenes", "node"));
            }
            return;
        }
        std::set<int> children;
        for (const GltfNode& node : out_.nodes) children.insert(node.children.begin(), node.children.end());
        for (std::size_t i = 0; i < out_.nodes.size(); ++i)
            if (children.count(static_cast<int>(i)) == 0) out_.roots.push_back(static_cast<int>(i));
    }

    const tinygltf::Model& in_;
    const std::string& file_;
    GltfModel out_;
    std::set<std::string> warned_, material_warned_;
};

}  // namespace

GltfModel read_gltf(const std::string& file) {
    const tinygltf::Model model = load_gltf_model(file);
    return Reader(model, file).read();
}

}  // namespace trilens
