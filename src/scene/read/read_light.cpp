// Lights out of checked JSON: their fields, each once, with the kinds that have it.
#include <algorithm>

#include "scene/read/reading.h"

namespace trilens {
namespace {

constexpr std::size_t kKinds = std::variant_size_v<LightKind>;

template <std::size_t... I>
std::vector<std::string> kind_names(std::index_sequence<I...>) {
    return {std::variant_alternative_t<I, LightKind>::kName...};
}

template <std::size_t... I>
LightKind make_kind(const std::string& name, std::index_sequence<I...>) {
    LightKind kind;
    ((name == std::variant_alternative_t<I, LightKind>::kName ? static_cast<void>(kind.emplace<I>())
                                                              : static_cast<void>(0)),
     ...);
    return kind;
}

/// Calls use(kind) with each kind's defaults.
template <typename Use, std::size_t... I>
void for_each_kind(const Use& use, std::index_sequence<I...>) {
    (use(std::variant_alternative_t<I, LightKind>()), ...);
}

/// Whether every light of the kinds that have it needs it.
enum class Need { kNo, kYes };

/// A setting of the kinds that have such a member: `member` gives it of one that does. Its default is shown
/// where all agree.
template <typename Member>
Field<Light> of_kinds(const std::string& key, const Member& member, Json values, const std::string& help,
                      Need need = Need::kNo) {
    Field<Light> field;
    field.key = key;
    for_each_kind(
        [&](auto kind) {
            if constexpr (requires { member(kind); }) {
                const bool first = field.kinds.empty();
                field.kinds.push_back(kind.kName);
                if (need == Need::kYes) {
                    field.needed_by.push_back(kind.kName);
                } else if (const Json usual = to_json_value(member(kind)); first) {
                    values["default"] = usual;
                } else if (values.contains("default") && values["default"] != usual) {
                    values.erase("default");
                }
            }
        },
        std::make_index_sequence<kKinds>());
    field.schema = described(std::move(values), help);
    field.read = [member](const Json& json, Light& light) {
        std::visit(
            [&](auto& kind) {
                if constexpr (requires { member(kind); }) from_json_value(json, member(kind));
            },
            light.kind);
    };
    return field;
}

#define TRILENS_MEMBER(name) [](auto& kind) -> decltype((kind.name)) { return kind.name; }

Field<Light> type_field() {
    Field<Light> type = part<Light>("type", word_of(kind_names(std::make_index_sequence<kKinds>())));
    type.read = [](const Json& json, Light& light) {
        light.kind = make_kind(json.get<std::string>(), std::make_index_sequence<kKinds>());
    };
    return type;
}

}  // namespace

const std::vector<Field<Light>>& light_fields() {
    static const std::vector<Field<Light>> fields{
        setting("name", &Light::name, ref("name"), "What its object is called.").without_default(),
        type_field(),  // first of those that the kinds have
        setting("color", &Light::color, ref("color")),
        setting("intensity", &Light::intensity, ref("notNegative"),
                "directional: lux on a surface that faces it; point, spot: candela; rectangle, disk, sphere, "
                "ambient: radiance; environment: a factor of the background's radiance."),
        of_kinds("direction", TRILENS_MEMBER(direction), ref("vec3"),
                 "The way the light travels; rectangle, disk: the side that shines.", Need::kYes),
        of_kinds("position", TRILENS_MEMBER(position), ref("vec3"), "rectangle, disk, sphere: its middle.",
                 Need::kYes),
        of_kinds("angle", TRILENS_MEMBER(angle), number_in(0, 179),
                 "Degrees across the disk in the sky that shines: about 0.5 for the sun; 0: a point."),
        of_kinds("innerConeAngle", TRILENS_MEMBER(inner_cone_angle), number_in(0, 90),
                 "Degrees from the axis within which it is full; less than outerConeAngle."),
        of_kinds("outerConeAngle", TRILENS_MEMBER(outer_cone_angle), number_in(0, 90),
                 "Degrees from the axis beyond which there is none."),
        of_kinds("size", TRILENS_MEMBER(size), several(2, ref("positive")), "Width and height."),
        of_kinds("up", TRILENS_MEMBER(up), ref("vec3"),
                 "The height runs along its part across 'direction'; along -Z where there is none."),
        of_kinds("radius", TRILENS_MEMBER(radius), ref("positive"), ""),
        of_kinds("distance", TRILENS_MEMBER(distance), ref("notNegative"),
                 "With shadows: how near what takes light away must be; 0: however far."),
        of_kinds("samples", TRILENS_MEMBER(samples), whole_in(1, kMostLightSamples),
                 "Points or directions that stand for the light, the same everywhere: soft shadows are as "
                 "many hard ones. 16 by default, an environment's 64."),
        of_kinds("visible", TRILENS_MEMBER(visible), yes_or_no(),
                 "Whether it is an object, too, as bright as it shines and from both sides; it stands after "
                 "the meshes."),
        setting("shadows", &Light::shadows, yes_or_no(),
                "Whether objects and mirrors cast shadows in this light: objects by their triangles, mirrors "
                "by their exact surface, at any resolution. Glass casts none: it lets the light through, "
                "unbent and undimmed. ambient: it reaches a surface from where nothing stands (ambient "
                "occlusion)."),
        setting("caustics", &Light::caustics, yes_or_no(),
                "Whether its light is followed over mirrors and through glass to where it falls, as far as "
                "maxDepth; objects, mirrors and glass then stop what comes straight, whatever 'shadows' says.")
            .of({"directional", "point", "spot", "rectangle", "disk", "sphere", "environment"})};
    return fields;
}

#undef TRILENS_MEMBER

Json light_schema() {
    return object_schema({.title = "a light", .required = {"type"}, .kind_title = "a # light"},
                         light_fields());
}

namespace {

Light read_light(const Node& node) {
    Light light;
    read_fields(node, light_fields(), light);
    std::visit(
        [&](auto& kind) {
            if constexpr (requires { kind.direction; }) kind.direction = read_direction(node["direction"]);
        },
        light.kind);
    if (const auto* spot = std::get_if<SpotLight>(&light.kind))
        if (!(spot->inner_cone_angle < spot->outer_cone_angle))
            (node.has("outerConeAngle") ? node["outerConeAngle"] : node["innerConeAngle"])
                .fail("the inner cone must be within the outer one");
    return light;
}

}  // namespace

void read_lights(const Node& scene, Reading& reading) {
    if (!scene.has("lights")) return;
    for (std::size_t i = 0; i < scene["lights"].size(); ++i)
        reading.scene.lights.push_back(read_light(scene["lights"][i]));
}

}  // namespace trilens
