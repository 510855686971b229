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

/// As a quaternion.
Vec4 read_rotation(const Node& node) {
    if (node.json.is_array()) {
        Vec4 rotate;
        for (std::size_t k = 0; k < 4; ++k) rotate[static_cast<int>(k)] = node.json[k].get<double>();
        if (rotate == Vec4(0)) node.fail("a quaternion must not be zero (0 0 0 1 turns nothing)");
        return rotate;
    }
    if (node.has("euler") == node.has("axis")) node.fail("needs either 'euler' or 'axis' with 'angle'");
    if (node.has("euler"))
        return quaternion_of_euler(to_vec3(node["euler"].json), string_or(node, "order", "XYZ"));
    return quaternion_about(read_direction(node["axis"]), node["angle"].json.get<double>());
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
    const Vec4 rotate = node.has("rotate") ? read_rotation(node["rotate"]) : Vec4(0, 0, 0, 1);
    return make_transform(translate, rotate, scale);
}

const std::vector<Field<ObjectPrimitive>>& primitive_fields() {
    using P = ObjectPrimitive;
    const auto along = [](const char* key) {
        Field<P> field = part<P>(key, ref("vec3"));
        field.schema["default"] = to_json_value(P().axis);
        return field;
    };
    static const std::vector<Field<P>> fields = [&] {
        Field<P> size =
            part<P>("size", {{"type", "array"}, {"minItems", 2}, {"maxItems", 3}, {"items", ref("positive")}},
                    "plane: along tangent and normal x tangent, 2 by 2 by default; box: along "
                    "tangent, axis and tangent x axis.");
        size.read = [](const Json& json, P& into) {
            for (std::size_t k = 0; k < json.size(); ++k)
                into.size[static_cast<int>(k)] = json[k].get<double>();
        };
        return std::vector<Field<P>>{
            choice("type", &P::shape).without_default(),
            setting("center", &P::center, ref("vec3"), "paraboloid: its apex."),
            setting("radius", &P::radius, ref("positive"), "paraboloid: of its rim.")
                .of({"sphere", "paraboloid", "cylinder", "disk"}),
            along("axis").of({"paraboloid", "cylinder", "box"}),
            along("normal").of({"plane", "disk"}),
            part<P>("tangent", ref("vec3"),
                    "Default: a direction at right angles to axis or normal, +X for +Y.")
                .of({"paraboloid", "cylinder", "plane", "box", "disk"}),
            setting("focalLength", &P::focal_length, ref("positive")).of({"paraboloid"}),
            setting("height", &P::height, ref("positive")).of({"cylinder"}),
            std::move(size).of({"plane", "box!"}),
            setting("segments", &P::segments, whole_in(3, 1024),
                    "object: pieces of a full circle; an optic is exact.")
                .of({"sphere", "paraboloid", "cylinder", "disk"}),
        };
    }();
    return fields;
}

Json primitive_schema() {
    return object_schema(
        {.title = "a primitive",
         .description =
             "A mesh given by a formula: of an optic exact (sphere, paraboloid, cylinder without lids, "
             "plane), of an object cut into polygons (spheres, boxes and cylinders closed). axis: "
             "paraboloid from apex to focus, cylinder along it; tangent: where u begins.",
         .required = {"type"},
         .kind_title = "a #"},
        primitive_fields());
}

namespace {

/// In its own frame.
ObjectPrimitive read_shape(const Node& node) {
    ObjectPrimitive shape;
    read_fields(node, primitive_fields(), shape);
    const std::size_t sides = shape.shape == ObjectShape::kBox ? 3 : 2;
    if (node.has("size") && node["size"].size() != sides)
        node["size"].fail("has " + std::to_string(node["size"].size()) + " entries, must have " +
                          std::to_string(sides) + " for a " + name_of(shape.shape));
    const char* const axis = node.has("normal") ? "normal" : "axis";
    if (node.has(axis)) shape.axis = read_direction(node[axis]);
    shape.tangent = read_tangent(node, shape.axis);
    return shape;
}

}  // namespace

PolygonMesh read_object_primitive(const Node& node) {
    return tessellate(read_shape(node));
}

Primitive read_primitive(const Node& node, const Transform& transform, const Node& mesh) {
    const ObjectPrimitive shape = read_shape(node);
    const std::optional<Primitive::Type> type = find_named<Primitive::Type>(name_of(shape.shape));
    if (!type)
        node["type"].fail(std::string("a ") + name_of(shape.shape) + " is an object's: an optic is " +
                          "a sphere, a paraboloid, a cylinder, a plane, or a cage");
    if (node.has("segments")) node["segments"].fail("are an object's: an optic is exact");
    const std::optional<double> factor = similarity_factor(transform);
    if (!factor) mesh["transform"].fail("a primitive stays exact only under a uniform scale");

    Primitive primitive;
    primitive.type = *type;
    primitive.center = map_point(transform, shape.center);
    primitive.axis = normalize_or_zero(transform.linear * shape.axis);
    primitive.tangent = normalize_or_zero(transform.linear * shape.tangent);
    primitive.radius = shape.radius * *factor;
    primitive.focal_length = shape.focal_length * *factor;
    primitive.height = shape.height * *factor;
    primitive.size = *factor * Vec2(shape.size.x, shape.size.y);
    const double extent = std::max({primitive.radius, primitive.focal_length, primitive.height,
                                    primitive.size.x, primitive.size.y, length(primitive.center)});
    if (!(extent <= kLargestCoordinate))
        mesh.fail("its transform carries the primitive beyond coordinates of 1e30");
    return primitive;
}

}  // namespace trilens
