// Lights out of checked JSON: their fields, each once, with the kinds that have it.
#include "json/kinds.h"
#include "scene/read/reading.h"

namespace trilens {
const std::vector<Field<Light>>& light_fields() {
    static const std::vector<Field<Light>> fields{
        setting("name", &Light::name, ref("name"), "What its object is called.").without_default(),
        type_field<Light>(),  // first of those that the kinds have
        setting("color", &Light::color, ref("color")),
        setting("intensity", &Light::intensity, ref("notNegative"),
                "directional: lux on a surface that faces it; point, spot: candela; rectangle, disk, sphere, "
                "ambient: radiance; environment: a factor of the background's radiance."),
        of_kinds<Light>("direction", TRILENS_MEMBER(direction), ref("vec3"),
                        "The way the light travels; rectangle, disk: the side that shines.", Need::kYes),
        of_kinds<Light>("position", TRILENS_MEMBER(position), ref("vec3"),
                        "rectangle, disk, sphere: its middle.", Need::kYes),
        of_kinds<Light>("angle", TRILENS_MEMBER(angle), number_in(0, 179),
                        "Degrees across the disk in the sky that shines: about 0.5 for the sun; 0: a point."),
        of_kinds<Light>("innerConeAngle", TRILENS_MEMBER(inner_cone_angle), number_in(0, 90),
                        "Degrees from the axis within which it is full; less than outerConeAngle."),
        of_kinds<Light>("outerConeAngle", TRILENS_MEMBER(outer_cone_angle), number_in(0, 90),
                        "Degrees from the axis beyond which there is none."),
        of_kinds<Light>("size", TRILENS_MEMBER(size), several(2, ref("positive")), "Width and height."),
        of_kinds<Light>("up", TRILENS_MEMBER(up), ref("vec3"),
                        "The height runs along its part across 'direction'; along -Z where there is none."),
        of_kinds<Light>("radius", TRILENS_MEMBER(radius), ref("positive"), ""),
        of_kinds<Light>("distance", TRILENS_MEMBER(distance), ref("notNegative"),
                        "With shadows: how near what takes light away must be; 0: however far."),
        of_kinds<Light>(
            "samples", TRILENS_MEMBER(samples), whole_in(1, kMostLightSamples),
            "Points or directions that stand for the light, the same everywhere: soft shadows are as "
            "many hard ones. 16 by default, an environment's 64."),
        of_kinds<Light>(
            "visible", TRILENS_MEMBER(visible), yes_or_no(),
            "Whether it is an object, too, as bright as it shines and from both sides; it stands after "
            "the meshes."),
        setting("shadows", &Light::shadows, yes_or_no(),
                "Whether objects and mirrors cast shadows in this light: objects by their triangles, mirrors "
                "by their exact surface, at any resolution. Glass casts none: it lets the light through, "
                "unbent and undimmed. ambient: it reaches a surface from where nothing stands (ambient "
                "occlusion)."),
        setting(
            "caustics", &Light::caustics, yes_or_no(),
            "Whether its light is followed over mirrors and through glass to where it falls, as far as "
            "maxDepth; objects, mirrors and glass then stop what comes straight, whatever 'shadows' says.")
            .of({"directional", "point", "spot", "rectangle", "disk", "sphere", "environment"}),
        setting("baked", &Light::baked, yes_or_no(),
                "Whether its light is in the meshes' bakedLight: it shows as it does, but shines no more.")};
    return fields;
}

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
    if (const auto* rectangle = std::get_if<RectangleLight>(&light.kind))
        if (!(rectangle->size.x * rectangle->size.y > 0)) node["size"].fail("has no area");
    if (const auto* disk = std::get_if<DiskLight>(&light.kind))
        if (!(disk->radius * disk->radius > 0)) node["radius"].fail("has no area");
    if (const auto* sphere = std::get_if<SphereLight>(&light.kind))
        if (!(sphere->radius * sphere->radius > 0)) node["radius"].fail("has no area");
    return light;
}

}  // namespace

void read_lights(const Node& scene, Reading& reading) {
    if (!scene.has("lights")) return;
    for (std::size_t i = 0; i < scene["lights"].size(); ++i)
        reading.scene.lights.push_back(read_light(scene["lights"][i]));
}

}  // namespace trilens
