// Transforms and primitives out of checked JSON.
#include <algorithm>
#include <array>
#include <cmath>

#include "scene/read/reading.h"

namespace trilens {
namespace {

constexpr double kParallelAxes = 1e-9;  // sine of an angle that counts as none

/// At right angles to `axis`: what is left of +X, or of +Z where the axis is nearer to X.
Vec3 default_tangent(const Vec3& axis) {
    const Vec3 start = std::abs(axis.x) <= 0.75 ? Vec3(1, 0, 0) : Vec3(0, 0, 1);
    return normalize(start - dot(start, axis) * axis);
}

Vec3 read_tangent(const Node& primitive, const Vec3& axis) {
    if (!primitive.has("tangent")) return default_tangent(axis);
    const Vec3 tangent = read_direction(primitive["tangent"]);
    const Vec3 across = tangent - dot(tangent, axis) * axis;
    if (!(length(across) > kParallelAxes)) primitive["tangent"].fail("is parallel to the axis or normal");
    return normalize(across);
}

}  // namespace

Transform read_transform(const Node& mesh) {
    if (!mesh.has("transform")) return {};
    const Node node = mesh["transform"];
    if (node.has("matrix")) {
        std::array<double, 16> columns{};
        for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = node["matrix"].json[i].get<double>();
        const std::optional<Transform> transform = make_transform(columns);
        if (!transform) node["matrix"].fail("its last row (entries 3, 7, 11, 15) must be 0 0 0 1");
        if (flattens(*transform)) node["matrix"].fail("is singular: it flattens the mesh");
        return *transform;
    }
    const Vec3 translate = vec3_or(node, "translate", Vec3(0)), scale = vec3_or(node, "scale", Vec3(1));
    for (int k = 0; k < 3; ++k)
        if (scale[k] == 0) node["scale"][static_cast<std::size_t>(k)].fail("a scale of 0 flattens the mesh");
    Vec4 rotate(0, 0, 0, 1);
    for (std::size_t k = 0; node.has("rotate") && k < 4; ++k)
        rotate[static_cast<int>(k)] = node["rotate"].json[k].get<double>();
    if (rotate == Vec4(0)) node["rotate"].fail("a quaternion must not be zero (0 0 0 1 turns nothing)");
    return make_transform(translate, rotate, scale);
}

Primitive read_primitive(const Node& node, const Transform& transform, const Node& mesh) {
    const std::optional<double> factor = similarity_factor(transform);
    if (!factor) mesh["transform"].fail("a primitive stays exact only under a uniform scale");

    Primitive primitive;
    const std::string type = node["type"].json.get<std::string>();
    primitive.type = type == "sphere"       ? Primitive::Type::kSphere
                     : type == "paraboloid" ? Primitive::Type::kParaboloid
                     : type == "cylinder"   ? Primitive::Type::kCylinder
                                            : Primitive::Type::kPlane;
    const char* axis_key = primitive.type == Primitive::Type::kPlane ? "normal" : "axis";
    const Vec3 axis = node.has(axis_key) ? read_direction(node[axis_key]) : Vec3(0, 1, 0);
    const Vec3 tangent = read_tangent(node, axis);

    primitive.center = map_point(transform, vec3_or(node, "center", Vec3(0)));
    primitive.axis = normalize_or_zero(transform.linear * axis);
    primitive.tangent = normalize_or_zero(transform.linear * tangent);
    primitive.radius = number_or(node, "radius", 1) * *factor;
    primitive.focal_length = number_or(node, "focalLength", 1) * *factor;
    primitive.height = number_or(node, "height", 2) * *factor;
    if (node.has("size")) primitive.size = to_vec2(node["size"].json);
    primitive.size *= *factor;
    const double extent = std::max({primitive.radius, primitive.focal_length, primitive.height,
                                    primitive.size.x, primitive.size.y, length(primitive.center)});
    if (!(extent <= kLargestCoordinate))
        mesh.fail("its transform carries the primitive beyond coordinates of 1e30");
    return primitive;
}

}  // namespace trilens
