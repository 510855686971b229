// Structure-aware generation (as in Csmith, or libFuzzer's custom mutators): bytes become the choices of a
// grammar of legal scenes, so that a change of a byte is a change of the scene.
#include "fuzz/random_scene.h"

#include "fuzz/random_meshes.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

/// A view from before the scene, from its middle, along its floor, from above, or from inside of an optic.
std::string look_at(Grammar& g) {
    const std::array<Vec3, 5> eyes{
        {{0.3, 0.8, 4}, {0.05, 0.1, 0.2}, {3.5, -0.99, 1}, {0, 3, 0.5}, {0.2, 0.4, 9}}};
    Vec3 eye = g.choose.of(eyes);
    eye += g.choose.vector(0.2);
    return Phrase{R"("lookAt": {{ "eye": {}, "at": {} }})", g.place(eye), g.place(g.choose.vector(0.3))};
}

std::string camera_kind(Grammar& g) {
    const double s = g.scale;
    switch (g.choose.below(19)) {
        case 0:
            return R"("type": "perspective", "yfov": 45)";
        case 1:
            return R"("type": "perspective", "yfov": 20, "shift": [0.2, -0.1])";
        case 2:
            return Phrase{R"("type": "orthographic", "ymag": {})", 1.5 * s};
        case 3:
            return Phrase{R"("type": "oblique", "ymag": {}, "angle": 35, "scale": 0.6)", 1.5 * s};
        case 4:
            return R"("type": "fisheye", "mapping": "equidistant", "fov": 200)";
        case 5:
            return R"("type": "fisheye", "mapping": "equisolid", "fov": 240)";
        case 6:
            return R"("type": "fisheye", "mapping": "stereographic", "fov": 150)";
        case 7:
            return R"("type": "cylindrical", "hfov": 120, "yfov": 50)";
        case 8:
            return R"("type": "spherical", "hfov": 360, "vfov": 180)";
        case 9:
            return R"("type": "opencv", "model": "pinhole", "fx": 30, "fy": 31, "cx": 12, "cy": 9, "distortion": [-0.2, 0.05, 0, 0])";
        case 10:
            return R"("type": "opencv", "model": "fisheye", "fx": 16, "fy": 16, "cx": 12.5, "cy": 8.5, "distortion": [0.02, 0, 0, 0])";
        case 11:
            return Phrase{R"("type": "pushbroom", "yfov": 40, "travel": [{}, 0, {}])", 2 * s, 0.3 * s};
        case 12:
            return Phrase{R"("type": "inwardSphere", "center": {}, "radius": {})", text_of({0, 0, 0}), 3 * s};
        case 13:
            return R"("type": "distortion", "yfov": 25, "detail": [0.3, 0.3, 0.7, 0.7], "contextFov": 150)";
        case 14:
            return Phrase{
                R"("type": "crossedSlits", "slits": [[{}, [0, 1, 0]], [{}, [1, 0, 0]]], "window": [{}, {}, {}, {}])",
                text_of({0, 0, 4 * s}),
                text_of({0, 0, 7 * s}),
                -2 * s,
                2 * s,
                -1.5 * s,
                1.5 * s};
        case 15:
            return R"("type": "perspective", "yfov": 120)";
        case 16:
            return Phrase{
                R"("type": "generalLinear", "lookAt": {{ "eye": {}, "at": {} }}, "rays": [ {{ "point": {}, "direction": [-0.5, 0.35, -1], "screen": [0, 0] }}, {{ "point": {}, "direction": [0.5, 0.1, -1], "screen": [1, 0] }}, {{ "point": {}, "direction": [0.1, -0.3, -1], "screen": [0.5, 1] }} ])",
                g.place({0, 1.4, 4.4}),
                g.place({0, 1.2, 0}),
                g.place({-0.8, 2, 4.4}),
                g.place({0.8, 2, 4.4}),
                g.place({0, 0.6, 4.4})};
        case 17:
            return Phrase{
                R"("type": "viewVolume", "vrp": {}, "vpn": [0, 0, 1], "prp": {}, "window": [{}, {}, {}, {}], "projection": "{}", "front": {}, "back": {})",
                g.place({0, 0.5, 3}),
                g.place({0.5, 0.4, 2}),
                -2 * s,
                2 * s,
                -1.5 * s,
                1.5 * s,
                g.choose.chance(128) ? "perspective" : "parallel",
                0.5 * s,
                -70 * s};
        default:
            return Phrase{
                R"("type": "multiPerspective", "blend": {}, "views": [ {{ "yfov": 60, "window": [0, 0, 0.4, 1], "lookAt": {{ "eye": {}, "at": {} }} }}, {{ "yfov": 50, "window": [0.4, 0, 1, 1], "lookAt": {{ "eye": {}, "at": {} }} }} ])",
                g.choose.chance(128) ? 0.0 : 0.1,
                g.place({-2.7, 1.5, 2}),
                g.place({0, 0, 0}),
                g.place({0, 1.5, 4.4}),
                g.place({0, 0, 0})};
    }
}

std::string texture(Grammar& g) {
    if (!g.choose.chance(48)) return "";
    return Phrase{
        R"("baseColorTexture": {{ "pattern": "{}", "colors": [[0.1, 0.2, 0.9], [0.9, 0.8, 0.1]], "count": [{}, 3] }}, )",
        g.choose.of(std::array{"checker", "grid", "ramp"}), 1 + g.choose.below(7)};
}

std::string materials(Grammar& g, bool unlit) {
    const std::array<double, 6> kIndices{1.5, 1, 1.0001, 1.33, 2.4, 3.5};
    std::string all = Phrase{
        R"({{ "name": "chrome", "metallicFactor": 1, "baseColorFactor": [{}, {}, 1] }},
    {{ "name": "glass", "transmissionFactor": 1, "ior": {}{} }},
    {{ "name": "thick", "transmissionFactor": 1, "ior": {}, "volume": {{ "attenuationDistance": {}, "attenuationColor": [0.9, 0.5, 0.2] }} }},
    {{ "name": "flint", "transmissionFactor": 1, "ior": 1.6, "dispersion": {} }},)",
        g.share(),
        g.share(),
        g.choose.of(kIndices),
        g.choose.chance(40) ? R"(, "baseColorFactor": [0.5, 1, 0])" : "",
        g.choose.of(kIndices),
        g.scale,
        g.share()};
    for (const char* name : {"a", "b", "c"}) {
        std::string more = texture(g);
        if (unlit)
            more += R"("unlit": true, )";
        else if (g.choose.chance(128))
            more += Phrase{R"("roughnessFactor": {}, )", 0.05 + 0.95 * g.share()}.text;
        if (g.choose.chance(24)) more += R"("alphaMode": "mask", "alphaFactor": 0.4, )";
        all += Phrase{R"(
    {{ "name": "{}", {}"baseColorFactor": [{}, {}, {}] }},)", name, more, g.share(), g.share(), g.share()}
                   .text;
    }
    all.pop_back();
    return all;
}

/// Without caustics, for which a picture takes seconds: tests of their own hold them against laws.
std::string light(Grammar& g) {
    const std::string at = g.place(g.choose.vector(3)), way = text_of(g.choose.direction());
    std::string extras = g.choose.chance(128) ? R"(, "shadows": true)" : "";
    const double far = g.scale * g.scale;
    switch (g.choose.below(8)) {
        case 0:
            return Phrase{R"({{ "type": "directional", "direction": {}{} }})", way, extras};
        case 1:
            return Phrase{R"({{ "type": "point", "position": {}, "intensity": {}{} }})", at, far, extras};
        case 2:
            return Phrase{
                R"({{ "type": "spot", "position": {}, "direction": {}, "outerConeAngle": 30, "intensity": {}{} }})",
                at, way, far, extras};
        case 3:
            return Phrase{
                R"({{ "type": "rectangle", "position": {}, "direction": {}, "size": [{}, {}], "samples": 4{} }})",
                at,
                way,
                g.scale,
                0.5 * g.scale,
                extras};
        case 4:
            return Phrase{R"({{ "type": "sphere", "position": {}, "radius": {}, "samples": 4{} }})", at,
                          g.size(0.01, 1), extras};
        case 5:
            return Phrase{R"({{ "type": "directional", "direction": {}, "angle": 5, "samples": 4{} }})", way,
                          extras};
        case 6:
            return Phrase{
                R"({{ "type": "disk", "position": {}, "direction": {}, "radius": {}, "samples": 4{} }})", at,
                way, g.size(0.05, 1), extras};
        default:
            return Phrase{R"({{ "type": "ambient", "samples": 4{} }})", extras};
    }
}

}  // namespace

RandomScene make_random_scene(std::string_view bytes, double enlarged) {
    Grammar g{Choices(bytes)};
    RandomScene scene;
    g.scale = enlarged * g.choose.of(std::array{1.0, 1e-5, 1e5, 0.03, 40.0});
    scene.is_unlit = !g.choose.chance(96);
    scene.other_resolution = 1 + g.choose.below(9);
    const std::string kind = camera_kind(g), view = look_at(g), surfaces = materials(g, scene.is_unlit);
    // These have a place of their own.
    const bool looks =
        kind.find("viewVolume") == std::string::npos && kind.find("generalLinear") == std::string::npos;
    scene.has_exact_scales = kind.find("generalLinear") == std::string::npos;
    std::string meshes, lights, volumes;
    const int optics = 1 + g.choose.below(3), objects = 1 + g.choose.below(4);
    for (int i = 0; i < optics; ++i) meshes += random_optic(g, i) + ",\n    ";
    for (int i = 0; i < objects; ++i) meshes += random_object(g, i) + (i + 1 < objects ? ",\n    " : "");
    if (!scene.is_unlit)
        for (int i = 1 + g.choose.below(2); i > 0; --i) lights += light(g) + (i > 1 ? ", " : "");
    if (g.choose.chance(24)) volumes = random_volume(g);
    scene.json =
        Phrase{R"({{ "version": 1, "film": {{ "width": 24, "height": 18, "spp": {}, "filter": "{}" }},
  "cameras": [ {{ "name": "c", {}{}{} }} ],
  "background": {{ "color": [{}, 0.3, 0.5] }},
  "render": {{ "maxDepth": {}{}{} }},
  "materials": [ {} ],
  "lights": [ {} ],
  "volumes": [ {} ],
  "meshes": [ {} ] }})",
               1 + g.choose.below(2),
               g.choose.of(std::array{"box", "box", "box", "gaussian"}),
               kind,
               looks ? ", " : "",
               looks ? view : "",
               g.share(),
               g.choose.of(std::array{4, 0, 1, 2, 8}),
               g.choose.chance(64) ? R"(, "fresnel": false)" : "",
               g.choose.chance(48) ? R"(, "maxError": 0.5)" : "",
               surfaces,
               lights,
               volumes,
               meshes};
    return scene;
}

}  // namespace trilens_fuzz
