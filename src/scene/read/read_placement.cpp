// Transforms and primitives out of checked JSON.
#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "base/description/lens_sag.h"
#include "json/kinds.h"
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

namespace {

/// What a kind's frame turns about: nothing that anybody sees, its axis, or its normal.
enum class Turns { kNone, kAxis, kNormal };
Turns turns_of(const SpherePrimitive&) {
    return Turns::kNone;
}
Turns turns_of(const PlanePrimitive&) {
    return Turns::kNormal;
}
Turns turns_of(const DiskPrimitive&) {
    return Turns::kNormal;
}
template <typename Kind>
Turns turns_of(const Kind&) {
    return Turns::kAxis;
}

Field<ObjectPrimitive> direction_of(const char* key, Turns turns) {
    Field<ObjectPrimitive> field = part<ObjectPrimitive>(key, ref("vec3"));
    field.schema["default"] = to_json_value(ObjectPrimitive().axis);
    field.kinds = kinds_with<ObjectPrimitiveKind>([&](const auto& kind) { return turns_of(kind) == turns; });
    return field;
}

}  // namespace

const std::vector<Field<ObjectPrimitive>>& primitive_fields() {
    using P = ObjectPrimitive;
    static const std::vector<Field<P>> fields = [&] {
        Field<P> tangent = part<P>("tangent", ref("vec3"),
                                   "Default: a direction at right angles to axis or normal, +X for +Y.");
        tangent.kinds =
            kinds_with<ObjectPrimitiveKind>([](const auto& kind) { return turns_of(kind) != Turns::kNone; });
        Field<P> size =
            of_kinds<P>("size", TRILENS_MEMBER(size),
                        {{"type", "array"}, {"minItems", 2}, {"maxItems", 3}, {"items", ref("positive")}},
                        "plane: along tangent and normal x tangent, 2 by 2 by default; box: along "
                        "tangent, axis and tangent x axis.");
        size.needed_by = {BoxPrimitive::kName};
        Field<P> segments = setting("segments", &P::segments, whole_in(3, 1024),
                                    "object: pieces of a full circle; an optic is exact.");
        segments.kinds = kinds_with<ObjectPrimitiveKind>([](const auto& kind) {
            return requires {
                kind.radius;
            }
            || requires {
                kind.front;
            };
        });
        return std::vector<Field<P>>{
            type_field<P>(),
            setting("center", &P::center, ref("vec3"),
                    "paraboloid: its apex; cone: of its base; lens: its front's vertex."),
            of_kinds<P>("radius", TRILENS_MEMBER(radius), ref("positive"),
                        "paraboloid: of its rim; cone: of its base."),
            direction_of("axis", Turns::kAxis),
            direction_of("normal", Turns::kNormal),
            std::move(tangent),
            of_kinds<P>("focalLength", TRILENS_MEMBER(focal_length), ref("positive"), ""),
            of_kinds<P>("height", TRILENS_MEMBER(height), ref("positive"), ""),
            of_kinds<P>("thickness", TRILENS_MEMBER(thickness), ref("positive"), "From vertex to vertex."),
            of_kinds<P>("front", TRILENS_MEMBER(front), ref("lensSide"), "", Need::kYes),
            of_kinds<P>("back", TRILENS_MEMBER(back), ref("lensSide"), "", Need::kYes),
            of_kinds<P>("hole", TRILENS_MEMBER(hole), ref("notNegative"),
                        "Radius of a hole in its middle, along the axis, below its own; 0: none."),
            std::move(size),
            std::move(segments),
        };
    }();
    return fields;
}

Json primitive_schema() {
    return object_schema(
        {.title = "a primitive",
         .description =
             "A mesh given by a formula: of an optic exact (sphere, paraboloid, cylinder without lids, "
             "cone without its base, plane, lens), of an object cut into polygons (spheres, boxes, "
             "cylinders, "
             "cones and lenses closed). axis: paraboloid from apex to focus, cylinder along it, cone from "
             "its base to its apex, lens from its front to its back; tangent: where u begins.",
         .required = {"type"},
         .kind_title = "a #"},
        primitive_fields());
}

namespace {

/// A plane's size has two sides, a box's three.
void check_sides(const Node& node) {
    if (!node.has("size")) return;
    const std::string kind = node["type"].json.get<std::string>();
    const std::size_t sides = kind == BoxPrimitive::kName ? 3 : 2;
    if (node["size"].size() != sides)
        node["size"].fail("has " + std::to_string(node["size"].size()) + " entries, must have " +
                          std::to_string(sides) + " for a " + kind);
}

/// In its own frame.
ObjectPrimitive read_shape(const Node& node) {
    check_sides(node);
    for (const char* side : {"front", "back"})
        if (node.has(side)) check_lens_side(node[side]);
    ObjectPrimitive shape;
    read_fields(node, primitive_fields(), shape);
    if (const auto* lens = std::get_if<LensPrimitive>(&shape.kind))
        if (const char* fault = lens_fault(lens->front, lens->back, lens->thickness, lens->hole))
            node.fail(std::string("is no lens: ") + fault);
    if (const auto* disk = std::get_if<DiskPrimitive>(&shape.kind); disk && !(disk->hole < disk->radius))
        node["hole"].fail("is not smaller than the disk");
    const char* const axis = node.has("normal") ? "normal" : "axis";
    if (node.has(axis)) shape.axis = read_direction(node[axis]);
    shape.tangent = read_tangent(node, shape.axis);
    return shape;
}

/// None where an object alone has that kind.
std::optional<PrimitiveKind> optic_kind(const ObjectPrimitiveKind& of_object) {
    return std::visit(
        []<typename Kind>(const Kind& kind) -> std::optional<PrimitiveKind> {
            if constexpr (std::is_constructible_v<PrimitiveKind, Kind>) return kind;
            return std::nullopt;
        },
        of_object);
}

}  // namespace

PolygonMesh read_object_primitive(const Node& node) {
    return tessellate(read_shape(node));
}

Primitive read_primitive(const Node& node, const Transform& transform, const Node& mesh) {
    const ObjectPrimitive shape = read_shape(node);
    std::optional<PrimitiveKind> kind = optic_kind(shape.kind);
    if (!kind)
        node["type"].fail(std::string("a ") + kind_name(shape) + " is an object's: an optic is " +
                          "a sphere, a paraboloid, a cylinder, a cone, a plane, a lens, or a cage");
    if (node.has("segments")) node["segments"].fail("are an object's: an optic is exact");
    const std::optional<double> factor = similarity_factor(transform);
    if (!factor) mesh["transform"].fail("a primitive stays exact only under a uniform scale");

    Primitive primitive;
    primitive.center = map_point(transform, shape.center);
    primitive.axis = normalize_or_zero(transform.linear * shape.axis);
    primitive.tangent = normalize_or_zero(transform.linear * shape.tangent);
    double extent = length(primitive.center);
    const auto scale = [&](double& side, const char*) {
        side *= *factor;
        extent = std::max(extent, side);
    };
    if (auto* lens = std::get_if<LensPrimitive>(&*kind)) {
        for (LensSide* side : {&lens->front, &lens->back}) *side = with_scaled_shape(*side, *factor);
        lens->hole *= *factor;
    }
    std::visit([&](auto& one) { for_each_length(one, scale); }, *kind);
    primitive.kind = *kind;
    primitive.is_mirrored = glm::determinant(transform.linear) < 0;
    if (!(extent <= kLargestCoordinate))
        mesh.fail("its transform carries the primitive beyond coordinates of 1e30");
    return primitive;
}

namespace {

/// Into the cube that the mesh asks for.
Transform fitting_transform(const Node& fit, const PolygonMesh& polygons) {
    Box bounds;
    for (const Vec3& point : polygons.cage.points) bounds.include(point);
    const Vec3 sides = bounds.empty() ? Vec3(0) : bounds.high - bounds.low;
    const double longest = std::max({sides.x, sides.y, sides.z});
    if (!(longest > 0)) fit.fail("the mesh has no size that could be fitted");
    const double factor = fit["size"].json.get<double>() / longest;
    Transform transform;
    transform.linear = Mat3(factor);
    transform.translation = vec3_or(fit, "center", Vec3(0)) - factor * (0.5 * (bounds.low + bounds.high));
    return transform;
}

}  // namespace

void place_mesh(PolygonMesh& polygons, const Node& node) {
    if (!place(polygons, read_transform(node)))
        node.fail("its transform carries points beyond coordinates of 1e30");
    if (node.has("fit") && !place(polygons, fitting_transform(node["fit"], polygons)))
        node["fit"].fail("carries points beyond coordinates of 1e30");
}

}  // namespace trilens
