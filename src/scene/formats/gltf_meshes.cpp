// Meshes of a glTF: their primitives' attributes, morph targets and triangles.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <tiny_gltf.h>

#include "scene/formats/gltf_file.h"
#include "scene/formats/gltf_parts.h"

namespace trilens {
namespace {

class MeshReader {
  public:
    MeshReader(GltfSource& source, GltfModel& into) : source_(source), in_(source.model), out_(into) {}

    void read() {
        for (std::size_t i = 0; i < in_.meshes.size(); ++i) read_mesh(i);
    }

  private:
    [[noreturn]] void fail(const std::string& place, const std::string& message) const {
        source_.fail(place, message);
    }
    void warn(const std::string& message) { source_.warn(message); }
    int checked(int index, std::size_t count, const std::string& place, const char* what) const {
        return source_.checked(index, count, place, what);
    }

    void read_mesh(std::size_t index) {
        const tinygltf::Mesh& in = in_.meshes[index];
        const std::string place = "/meshes/" + std::to_string(index);
        GltfMesh mesh;
        mesh.name = in.name;
        mesh.weights = in.weights;
        mesh.extras = json_of_gltf(in.extras);
        source_.check_weights(mesh.weights, place);
        for (std::size_t i = 0; i < in.primitives.size(); ++i) {
            read_primitive(in.primitives[i], place + "/primitives/" + std::to_string(i), mesh.primitives);
            if (mesh.primitives.size() > mesh.primitive_of.size())
                mesh.primitive_of.push_back(static_cast<int>(i));
        }
        out_.meshes.push_back(std::move(mesh));
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
        if (in.attributes.count("POSITION") == 0) return warn("a primitive without POSITION is skipped");

        GltfPrimitive result;
        result.material = checked(in.material, in_.materials.size(), place, "material");
        result.positions = vectors<Vec3>(in.attributes.at("POSITION"));
        if (in.attributes.count("NORMAL") > 0) result.normals = vectors<Vec3>(in.attributes.at("NORMAL"));
        read_tangents(in, place, result);
        const auto uv_set = [&](const char* name) {
            const auto uvs = in.attributes.find(name);
            return uvs == in.attributes.end() ? std::vector<Vec2>() : vectors<Vec2>(uvs->second);
        };
        result.uvs = uv_set("TEXCOORD_0");
        result.second_uvs = uv_set("TEXCOORD_1");
        const auto fits = [&](const auto& list) {
            return list.empty() || list.size() == result.positions.size();
        };
        if (!fits(result.normals) || !fits(result.uvs) || !fits(result.second_uvs))
            fail(place, "its attributes differ in length");
        read_colors(in, place, result);
        read_influences(in, place, result);
        for (std::size_t k = 0; k < in.targets.size(); ++k)
            result.targets.push_back(
                read_target(in.targets[k], result, place + "/targets/" + std::to_string(k)));
        result.triangles = triangles(in, mode, result.positions.size(), place);
        mesh.push_back(std::move(result));
    }

    /// Of a primitive without normals they are ignored (glTF 2.0, section 3.7.2.1).
    void read_tangents(const tinygltf::Primitive& in, const std::string& place, GltfPrimitive& into) {
        const auto found = in.attributes.find("TANGENT");
        if (found == in.attributes.end() || into.normals.empty()) return;
        into.tangents = vectors<Vec4>(found->second);
        if (into.tangents.size() != into.positions.size()) fail(place, "its attributes differ in length");
        if (std::all_of(into.tangents.begin(), into.tangents.end(),
                        [](const Vec4& tangent) { return std::abs(tangent.w) == 1; }))
            return;
        warn("tangents whose handedness is neither 1 nor -1 are ignored");
        into.tangents.clear();
    }

    /// Three or four wide; what has no alpha takes `alpha` for it.
    std::vector<Vec4> colors_of(int accessor, double alpha, const std::string& place) const {
        const int index = std::max(0, checked(accessor, in_.accessors.size(), place, "accessor"));
        const bool has_alpha = in_.accessors[static_cast<std::size_t>(index)].type == TINYGLTF_TYPE_VEC4;
        const std::size_t width = has_alpha ? 4 : 3;
        const std::vector<double> numbers =
            read_gltf_accessor(in_, accessor, static_cast<int>(width), source_.file);
        std::vector<Vec4> colors;
        for (std::size_t i = 0; i + width <= numbers.size(); i += width)
            colors.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2],
                                has_alpha ? numbers[i + 3] : alpha);
        return colors;
    }

    void read_colors(const tinygltf::Primitive& in, const std::string& place, GltfPrimitive& into) {
        const auto found = in.attributes.find("COLOR_0");
        if (found == in.attributes.end()) return;
        into.colors = colors_of(found->second, 1, place);
        if (into.colors.size() != into.positions.size()) fail(place, "its attributes differ in length");
        for (Vec4& color : into.colors)
            color = glm::clamp(color, Vec4(0), Vec4(1));  // glTF 2.0, section 3.7.2.1
    }

    void read_influences(const tinygltf::Primitive& in, const std::string& place, GltfPrimitive& into) {
        std::vector<std::vector<double>> joints, weights;
        for (int set = 0;; ++set) {
            const auto joint = in.attributes.find("JOINTS_" + std::to_string(set)),
                       weight = in.attributes.find("WEIGHTS_" + std::to_string(set));
            if (joint == in.attributes.end() || weight == in.attributes.end()) break;
            joints.push_back(read_gltf_accessor(in_, joint->second, 4, source_.file));
            weights.push_back(read_gltf_accessor(in_, weight->second, 4, source_.file));
            if (joints.back().size() != 4 * into.positions.size() ||
                weights.back().size() != joints.back().size())
                fail(place, "its attributes differ in length");
        }
        into.influences = 4 * joints.size();
        for (std::size_t i = 0; i < into.positions.size(); ++i)
            for (std::size_t set = 0; set < joints.size(); ++set)
                for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
                    if (!(joints[set][k] >= 0 && joints[set][k] <= 65535))
                        fail(place + "/attributes", "a joint is out of range");
                    into.joints.push_back(static_cast<int>(joints[set][k]));
                    into.joint_weights.push_back(weights[set][k]);
                }
    }

    GltfMorphTarget read_target(const std::map<std::string, int>& in, const GltfPrimitive& of,
                                const std::string& place) {
        GltfMorphTarget target;
        const auto read = [&](const char* name, bool has_base, auto& into, const auto& values_of) {
            const auto found = in.find(name);
            if (found == in.end()) return;
            if (!has_base)
                return warn(std::string("a morph target's ") + name + " is ignored: its primitive has none");
            into = values_of(found->second);
            if (into.size() != of.positions.size()) fail(place, "its attributes differ in length");
        };
        const auto threes = [&](int accessor) { return vectors<Vec3>(accessor); };
        const auto twos = [&](int accessor) { return vectors<Vec2>(accessor); };
        read("POSITION", true, target.positions, threes);
        read("NORMAL", true, target.normals, threes);
        read("TANGENT", true, target.tangents, threes);
        read("TEXCOORD_0", !of.uvs.empty(), target.uvs, twos);
        read("TEXCOORD_1", !of.second_uvs.empty(), target.second_uvs, twos);
        read("COLOR_0", !of.colors.empty(), target.colors,
             [&](int accessor) { return colors_of(accessor, 0, place); });
        return target;
    }

    template <typename Vector>
    std::vector<Vector> vectors(int accessor) const {
        return read_gltf_vectors<Vector>(in_, accessor, source_.file);
    }

    /// Lists, strips and fans as triples of vertices; strips turn every second triangle (glTF 2.0,
    /// section 3.7.2.1).
    std::vector<IdTriple> triangles(const tinygltf::Primitive& in, int mode, std::size_t vertices,
                                    const std::string& place) {
        std::vector<Id> order;
        if (in.indices < 0) {
            for (std::size_t i = 0; i < vertices; ++i) order.push_back(static_cast<Id>(i));
        } else {
            for (const double index : read_gltf_accessor(in_, in.indices, 1, source_.file)) {
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

    GltfSource& source_;
    const tinygltf::Model& in_;
    GltfModel& out_;
};

}  // namespace

void read_gltf_meshes(GltfSource& source, GltfModel& into) {
    MeshReader(source, into).read();
}

}  // namespace trilens
