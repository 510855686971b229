// Skins and animations of a glTF, and its nodes' places at a moment: keys by glTF 2.0's appendix C.
#include <algorithm>
#include <cmath>

#include <tiny_gltf.h>

#include "scene/formats/gltf_file.h"
#include "scene/formats/gltf_parts.h"

namespace trilens {
namespace {

GltfSkin read_skin(const GltfSource& source, std::size_t index) {
    const tinygltf::Skin& in = source.model.skins[index];
    const std::string place = "/skins/" + std::to_string(index);
    GltfSkin skin;
    for (const int joint : in.joints) {
        if (joint < 0) source.fail(place + "/joints", "a joint has a negative index");
        skin.joints.push_back(source.checked(joint, source.model.nodes.size(), place + "/joints", "node"));
    }
    skin.joint_from_mesh.resize(skin.joints.size());
    if (in.inverseBindMatrices < 0) return skin;
    const std::vector<double> numbers =
        read_gltf_accessor(source.model, in.inverseBindMatrices, 16, source.file);
    if (numbers.size() < 16 * skin.joints.size())
        source.fail(place + "/inverseBindMatrices", "has fewer matrices than there are joints");
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
        // Floats that programs computed: the last row is 0 0 0 1 to their rounding.
        std::array<double, 16> columns;
        std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(16 * j), 16, columns.begin());
        for (std::size_t row = 3; row < 16; row += 4)
            if (std::abs(columns[row] - (row == 15)) < 1e-4) columns[row] = row == 15;
        const std::optional<Transform> transform = make_transform(std::span<const double, 16>(columns));
        if (!transform)
            source.fail(place + "/inverseBindMatrices",
                        "the last row of matrix " + std::to_string(j) + " must be 0 0 0 1");
        skin.joint_from_mesh[j] = *transform;
    }
    return skin;
}

std::size_t morph_targets(const GltfModel& model, int node) {
    const int mesh = model.nodes[static_cast<std::size_t>(node)].mesh;
    if (mesh < 0) return 0;
    std::size_t count = 0;
    for (const GltfPrimitive& primitive : model.meshes[static_cast<std::size_t>(mesh)].primitives)
        count = std::max(count, primitive.targets.size());
    return count;
}

/// None for what moves no node.
std::optional<GltfChannel> read_channel(GltfSource& source, const GltfModel& model, std::size_t animation,
                                        std::size_t index) {
    using Property = GltfChannel::Property;
    using Interpolation = GltfChannel::Interpolation;
    const tinygltf::Animation& whole = source.model.animations[animation];
    const tinygltf::AnimationChannel& in = whole.channels[index];
    const std::string of = "/animations/" + std::to_string(animation),
                      place = of + "/channels/" + std::to_string(index);
    GltfChannel channel;
    channel.node = source.checked(in.target_node, model.nodes.size(), place + "/target", "node");
    if (channel.node < 0) return std::nullopt;
    const std::string& path = in.target_path;
    if (path == "translation" || path == "scale") {
        channel.property = path == "scale" ? Property::kScale : Property::kTranslation;
    } else if (path == "rotation") {
        channel.property = Property::kRotation;
        channel.width = 4;
    } else if (path == "weights") {
        channel.property = Property::kWeights;
        channel.width = morph_targets(model, channel.node);
        if (channel.width == 0) return std::nullopt;
    } else {
        source.warn("an animation of '" + path + "' is ignored");
        return std::nullopt;
    }
    if (in.sampler < 0 || static_cast<std::size_t>(in.sampler) >= whole.samplers.size())
        source.fail(place + "/sampler", "sampler " + std::to_string(in.sampler) +
                                            " is out of range: there are " +
                                            std::to_string(whole.samplers.size()));
    const tinygltf::AnimationSampler& sampler = whole.samplers[static_cast<std::size_t>(in.sampler)];
    const std::string sampled = of + "/samplers/" + std::to_string(in.sampler);
    if (sampler.interpolation == "CUBICSPLINE")
        channel.interpolation = Interpolation::kCubicSpline;
    else if (sampler.interpolation == "STEP")
        channel.interpolation = Interpolation::kStep;
    else if (!sampler.interpolation.empty() && sampler.interpolation != "LINEAR")
        source.fail(sampled + "/interpolation", "is neither LINEAR, STEP nor CUBICSPLINE");
    channel.times = read_gltf_accessor(source.model, sampler.input, 1, source.file);
    if (channel.times.empty()) source.fail(sampled + "/input", "has no times");
    for (std::size_t k = 1; k < channel.times.size(); ++k)
        if (!(channel.times[k] > channel.times[k - 1]))
            source.fail(sampled + "/input", "time " + std::to_string(k) + " is not after the one before");
    const int components = channel.property == Property::kWeights ? 1 : static_cast<int>(channel.width);
    channel.values = read_gltf_accessor(source.model, sampler.output, components, source.file);
    const std::size_t needed =
        channel.times.size() * channel.width * (channel.interpolation == Interpolation::kCubicSpline ? 3 : 1);
    if (channel.values.size() != needed)
        source.fail(sampled + "/output", "has " + std::to_string(channel.values.size()) +
                                             " numbers, but its times need " + std::to_string(needed));
    return channel;
}

}  // namespace

void read_gltf_motion(GltfSource& source, GltfModel& into) {
    for (std::size_t i = 0; i < source.model.skins.size(); ++i) into.skins.push_back(read_skin(source, i));
    for (std::size_t i = 0; i < into.nodes.size(); ++i) {
        const GltfNode& node = into.nodes[i];
        if (node.skin < 0 || node.mesh < 0) continue;
        const std::size_t joints = into.skins[static_cast<std::size_t>(node.skin)].joints.size();
        for (const GltfPrimitive& primitive : into.meshes[static_cast<std::size_t>(node.mesh)].primitives)
            for (std::size_t k = 0; k < primitive.joints.size(); ++k)
                if (primitive.joint_weights[k] != 0 &&
                    static_cast<std::size_t>(primitive.joints[k]) >= joints)
                    source.fail("/nodes/" + std::to_string(i) + "/skin",
                                "its mesh names joint " + std::to_string(primitive.joints[k]) +
                                    ", but the skin has " + std::to_string(joints));
    }
    for (std::size_t i = 0; i < source.model.animations.size(); ++i) {
        GltfAnimation animation;
        animation.name = source.model.animations[i].name;
        for (std::size_t k = 0; k < source.model.animations[i].channels.size(); ++k)
            if (auto channel = read_channel(source, into, i, k))
                animation.channels.push_back(std::move(*channel));
        into.animations.push_back(std::move(animation));
    }
}

// Poses.

namespace {

/// Between two unit quaternions by the shorter great arc at even speed.
Vec4 great_arc(const Vec4& a, Vec4 b, double share) {
    double cosine = dot(a, b);
    if (cosine < 0) {
        b = -b;
        cosine = -cosine;
    }
    if (cosine > 1 - 1e-12) return a + share * (b - a);
    const double angle = std::acos(cosine);
    return (std::sin((1 - share) * angle) * a + std::sin(share * angle) * b) / std::sin(angle);
}

Vec4 unit_rotation(const Vec4& q) {
    const double size = std::sqrt(dot(q, q));
    return size > 0 ? q / size : Vec4(0, 0, 0, 1);
}

/// The channel's numbers at a time.
std::vector<double> sample(const GltfChannel& channel, double time) {
    using Interpolation = GltfChannel::Interpolation;
    const std::size_t width = channel.width;
    const bool cubic = channel.interpolation == Interpolation::kCubicSpline;
    // Of a cubic spline per key: tangent on the way in, value, tangent on the way out.
    const auto at = [&](std::size_t key, std::size_t which) {
        return channel.values.data() + (cubic ? (3 * key + which) * width : key * width);
    };
    const auto held = [&](std::size_t key) { return std::vector<double>(at(key, 1), at(key, 1) + width); };
    const auto after = std::upper_bound(channel.times.begin(), channel.times.end(), time);
    if (after == channel.times.begin()) return held(0);
    if (after == channel.times.end()) return held(channel.times.size() - 1);
    const auto next = static_cast<std::size_t>(after - channel.times.begin()), key = next - 1;
    if (channel.interpolation == Interpolation::kStep) return held(key);
    const double span = channel.times[next] - channel.times[key], s = (time - channel.times[key]) / span;
    const double *a = at(key, 1), *b = at(next, 1);
    if (!cubic && channel.property == GltfChannel::Property::kRotation) {
        const Vec4 turned =
            great_arc(unit_rotation({a[0], a[1], a[2], a[3]}), unit_rotation({b[0], b[1], b[2], b[3]}), s);
        return {turned.x, turned.y, turned.z, turned.w};
    }
    std::vector<double> result(width);
    for (std::size_t k = 0; k < width; ++k) {
        if (!cubic) {
            result[k] = a[k] + s * (b[k] - a[k]);
            continue;
        }
        const double out = span * at(key, 2)[k], in = span * at(next, 0)[k], s2 = s * s, s3 = s2 * s;
        result[k] = (2 * s3 - 3 * s2 + 1) * a[k] + (s3 - 2 * s2 + s) * out + (3 * s2 - 2 * s3) * b[k] +
                    (s3 - s2) * in;
    }
    return result;
}

void apply(const GltfChannel& channel, double time, std::vector<GltfNode>& nodes) {
    using Property = GltfChannel::Property;
    GltfNode& node = nodes[static_cast<std::size_t>(channel.node)];
    std::vector<double> now = sample(channel, time);
    if (channel.property == Property::kWeights) {
        node.weights = std::move(now);
        return;
    }
    node.matrix.reset();  // glTF: an animated node has none
    if (channel.property == Property::kRotation)
        node.rotation = unit_rotation({now[0], now[1], now[2], now[3]});
    else
        (channel.property == Property::kScale ? node.scale : node.translation) = Vec3(now[0], now[1], now[2]);
}

}  // namespace

GltfPose pose_gltf(const GltfModel& model, const GltfMoment& moment) {
    std::vector<GltfNode> nodes = model.nodes;
    if (moment.animation >= 0)
        for (const GltfChannel& channel :
             model.animations[static_cast<std::size_t>(moment.animation)].channels)
            apply(channel, moment.time, nodes);
    GltfPose pose;
    pose.world_from_node.resize(nodes.size());
    pose.weights.resize(nodes.size());
    // Parents before children, from those without a parent.
    std::vector<int> stack;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (nodes[i].parent < 0) stack.push_back(static_cast<int>(i));
    while (!stack.empty()) {
        const auto i = static_cast<std::size_t>(stack.back());
        stack.pop_back();
        const GltfNode& node = nodes[i];
        const Transform local =
            node.matrix ? *node.matrix : make_transform(node.translation, node.rotation, node.scale);
        pose.world_from_node[i] =
            node.parent < 0 ? local
                            : compose(pose.world_from_node[static_cast<std::size_t>(node.parent)], local);
        pose.weights[i] = !node.weights.empty() || node.mesh < 0
                              ? node.weights
                              : model.meshes[static_cast<std::size_t>(node.mesh)].weights;
        stack.insert(stack.end(), node.children.begin(), node.children.end());
    }
    return pose;
}

bool is_animated(const GltfModel& model, int animation, int node) {
    if (animation < 0) return false;
    std::vector<char> moved(model.nodes.size(), 0);
    for (const GltfChannel& channel : model.animations[static_cast<std::size_t>(animation)].channels)
        moved[static_cast<std::size_t>(channel.node)] = 1;
    const auto moves = [&](int from) {
        for (int at = from; at >= 0; at = model.nodes[static_cast<std::size_t>(at)].parent)
            if (moved[static_cast<std::size_t>(at)]) return true;
        return false;
    };
    if (moves(node)) return true;
    const int skin = model.nodes[static_cast<std::size_t>(node)].skin;
    if (skin < 0) return false;
    const std::vector<int>& joints = model.skins[static_cast<std::size_t>(skin)].joints;
    return std::any_of(joints.begin(), joints.end(), moves);
}

}  // namespace trilens
