// Structure-aware generation (as in Csmith, or libFuzzer's custom mutators): bytes become the choices of a
// grammar of legal scenes, so that a change of a byte is a change of the scene.
#include "fuzz/random_scene.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/math/vec.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

class Choices {
  public:
    explicit Choices(std::string_view bytes) : bytes_(bytes) {}

    int below(int count) { return count < 2 ? 0 : byte() % count; }
    bool chance(int of_256) { return byte() < of_256; }
    double between(double low, double high) {
        const int number = 256 * byte() + byte();
        return low + (high - low) * number / 65535.0;
    }
    double log_between(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
    Vec3 vector(double size) {
        const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
        return {x, y, z};
    }
    Vec3 direction() {
        const Vec3 v = vector(1);
        return length(v) > 1e-3 ? normalize(v) : Vec3(0, 1, 0);
    }
    bool empty() const { return bytes_.empty(); }

  private:
    int byte() {
        if (bytes_.empty()) return 0;
        const int value = static_cast<unsigned char>(bytes_.front());
        bytes_.remove_prefix(1);
        return value;
    }
    std::string_view bytes_;
};

std::string text(const Vec3& v) {
    return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
}

/// The scene's size as a whole, of which all lengths are multiples.
struct Grammar {
    Choices choose;
    double scale = 1;

    std::string place(const Vec3& at) { return text(scale * at); }
    std::string size(double low, double high) {
        return fmt::format("{}", scale * choose.log_between(low, high));
    }
};

constexpr const char* kCube =
    R"("faceVertexCounts": [4,4,4,4,4,4], "faceVertexIndices": [0,1,2,3, 1,5,6,2, 5,4,7,6, 4,0,3,7, 3,2,6,7, 4,5,1,0])";

/// A view from before the scene, from its middle, or along its floor.
std::string look_at(Grammar& g) {
    const std::array<Vec3, 4> eyes{{{0.3, 0.8, 4}, {0.05, 0.1, 0.2}, {3.5, -0.99, 1}, {0, 3, 0.5}}};
    const Vec3 eye = eyes[static_cast<std::size_t>(g.choose.below(4))] + g.choose.vector(0.2);
    return fmt::format(R"("lookAt": {{ "eye": {}, "at": {} }})", g.place(eye), g.place(g.choose.vector(0.3)));
}

std::string camera(Grammar& g) {
    const double s = g.scale;
    const std::array<std::string, 16> kinds{
        R"("type": "perspective", "yfov": 45)",
        R"("type": "perspective", "yfov": 20, "shift": [0.2, -0.1])",
        fmt::format(R"("type": "orthographic", "ymag": {})", 1.5 * s),
        fmt::format(R"("type": "oblique", "ymag": {}, "angle": 35, "scale": 0.6)", 1.5 * s),
        R"("type": "fisheye", "mapping": "equidistant", "fov": 200)",
        R"("type": "fisheye", "mapping": "equisolid", "fov": 240)",
        R"("type": "fisheye", "mapping": "stereographic", "fov": 150)",
        R"("type": "cylindrical", "hfov": 120, "yfov": 50)",
        R"("type": "spherical", "hfov": 360, "vfov": 180)",
        R"("type": "opencv", "model": "pinhole", "fx": 30, "fy": 31, "cx": 12, "cy": 9, "distortion": [-0.2, 0.05, 0, 0])",
        R"("type": "opencv", "model": "fisheye", "fx": 16, "fy": 16, "cx": 12.5, "cy": 8.5, "distortion": [0.02, 0, 0, 0])",
        fmt::format(R"("type": "pushbroom", "yfov": 40, "travel": [{}, 0, {}])", 2 * s, 0.3 * s),
        fmt::format(R"("type": "inwardSphere", "center": {}, "radius": {})", text({0, 0, 0}), 3.0 * s),
        R"("type": "distortion", "yfov": 25, "detail": [0.3, 0.3, 0.7, 0.7], "contextFov": 150)",
        fmt::format(
            R"("type": "crossedSlits", "slits": [[{}, [0, 1, 0]], [{}, [1, 0, 0]]], "window": [{}, {}, {}, {}])",
            text({0, 0, 4 * s}), text({0, 0, 7 * s}), -2 * s, 2 * s, -1.5 * s, 1.5 * s),
        R"("type": "perspective", "yfov": 120)"};
    const std::size_t kind = static_cast<std::size_t>(g.choose.below(16));
    return fmt::format(R"({{ "name": "c", {}, {} }})", kinds[kind], look_at(g));
}

/// A number from a list in which the corner cases stand.
double share(Grammar& g) {
    const std::array<double, 5> kShares{1, 0, 0.5, 0.02, 0.98};
    return kShares[static_cast<std::size_t>(g.choose.below(5))];
}

std::string materials(Grammar& g, bool unlit) {
    const std::array<double, 6> kIndices{1.5, 1, 1.0001, 1.33, 2.4, 3.5};
    std::string all = fmt::format(
        R"({{ "name": "chrome", "metallicFactor": 1, "baseColorFactor": [{}, {}, 1] }},
    {{ "name": "glass", "transmissionFactor": 1, "ior": {}{} }},)",
        share(g), share(g), kIndices[static_cast<std::size_t>(g.choose.below(6))],
        g.choose.chance(80)
            ? fmt::format(
                  R"(, "volume": {{ "attenuationDistance": {}, "attenuationColor": [0.9, 0.5, 0.2] }})",
                  g.scale)
            : "");
    for (const char* name : {"a", "b", "c"})
        all += fmt::format(R"(
    {{ "name": "{}", {} "baseColorFactor": [{}, {}, {}] }},)",
                           name,
                           unlit ? R"("unlit": true,)"
                           : g.choose.chance(128)
                               ? fmt::format(R"("roughnessFactor": {},)", 0.05 + 0.95 * share(g))
                               : "",
                           share(g), share(g), share(g));
    all.pop_back();
    return all;
}

std::string cage_points(Grammar& g, const Vec3& at, const Vec3& half) {
    std::string points;
    for (int k = 0; k < 8; ++k) {
        const Vec3 corner((k & 1) != ((k >> 1) & 1) ? 1 : -1, (k & 2) ? 1 : -1, k < 4 ? 1 : -1);
        const Vec3 moved = corner * half + g.choose.vector(0.1) * half;
        points += (k ? ", " : "") + g.place(at + moved);
    }
    return points;
}

/// Where the optics before it are, beside them, touching them, in them, or far away.
Vec3 centre(Grammar& g, int number) {
    const std::array<Vec3, 6> kPlaces{
        {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, -1}, {0, 0.5, 0.5}, {-30, 2, -60}}};
    const Vec3 at = kPlaces[static_cast<std::size_t>((g.choose.below(6) + number) % 6)];
    return g.choose.chance(128) ? at : at + g.choose.vector(0.4);
}

std::string optic(Grammar& g, int number) {
    const Vec3 at = centre(g, number);
    const std::array<double, 7> kRadii{1, 0.5, 0.999, 0.02, 0.1, 1.5, 8};
    const double radius = kRadii[static_cast<std::size_t>(g.choose.below(7))];
    const std::array<int, 8> kResolutions{4, 1, 2, 3, 8, 16, 5, 32};
    const int n = kResolutions[static_cast<std::size_t>(g.choose.below(8))];
    std::string shape;
    switch (g.choose.below(6)) {
        case 0:
            shape = fmt::format(R"("primitive": {{ "type": "sphere", "center": {}, "radius": {} }})",
                                g.place(at), g.scale * radius);
            break;
        case 1:
            shape = fmt::format(
                R"("primitive": {{ "type": "plane", "center": {}, "normal": {}, "size": [{}, {}] }})",
                g.place(at), text(g.choose.direction()), 2 * g.scale * radius, g.scale * radius);
            break;
        case 2:
            shape = fmt::format(
                R"("primitive": {{ "type": "{}", "center": {}, "axis": {}, "radius": {}, "height": {} }})",
                n == 3 || n == 5 ? "cone" : "cylinder", g.place(at), text(g.choose.direction()),
                0.5 * g.scale * radius, g.size(0.01, 4));
            break;
        case 3:
            shape = fmt::format(
                R"("primitive": {{ "type": "paraboloid", "center": {}, "axis": {}, "radius": {}, "focalLength": {} }})",
                g.place(at), text(g.choose.direction()), g.scale * radius, g.size(0.05, 5));
            break;
        case 4:
            shape = fmt::format(R"("points": [{}], {})", cage_points(g, at, Vec3(radius)), kCube);
            break;
        default: {  // creased, flat or long
            const Vec3 half = radius * Vec3(1, g.choose.log_between(0.003, 1), g.choose.log_between(0.1, 3));
            shape = fmt::format(
                R"("points": [{}], {}, "creaseIndices": [0,1,2,3,0], "creaseLengths": [5], "creaseSharpnesses": [{}])",
                cage_points(g, at, half), kCube, g.choose.chance(128) ? 10.0 : 1.3);
        }
    }
    std::string extras = fmt::format(R"(, "resolution": {})", n);
    if (g.choose.chance(64)) extras += R"(, "grid": "screen")";
    if (g.choose.chance(64)) extras += R"(, "rays": "fitted")";
    return fmt::format(R"({{ "name": "optic {}", "role": "optic", "material": "{}", {}{} }})", number,
                       g.choose.chance(128) ? "chrome" : "glass", shape, extras);
}

std::string object(Grammar& g, int number) {
    const char* const material = std::array{"a", "b", "c"}[static_cast<std::size_t>(number % 3)];
    std::string shape;
    switch (g.choose.below(4)) {
        case 0:
            shape = fmt::format(
                R"("points": [{}, {}, {}, {}], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0])",
                g.place({-5, -1, -5}), g.place({5, -1, -5}), g.place({5, -1, 5}), g.place({-5, -1, 5}));
            break;
        case 1: {  // two triangles that cross
            shape = fmt::format(
                R"("points": [{}, {}, {}, {}, {}, {}], "faceVertexCounts": [3,3], "faceVertexIndices": [0,1,2,3,4,5])",
                g.place(g.choose.vector(3)), g.place(g.choose.vector(3)), g.place(g.choose.vector(3)),
                g.place(g.choose.vector(3)), g.place(g.choose.vector(3)), g.place(g.choose.vector(3)));
            break;
        }
        case 2:
            shape = fmt::format(R"("primitive": {{ "type": "box", "center": {}, "size": [{}, {}, {}] }})",
                                g.place(centre(g, number) + Vec3(0, 0, -2)), g.size(0.01, 2), g.size(0.01, 2),
                                g.size(0.01, 2));
            break;
        default:
            shape = fmt::format(
                R"("primitive": {{ "type": "sphere", "center": {}, "radius": {}, "segments": 8 }})",
                g.place(centre(g, number) + Vec3(-1.5, 0, 1)), g.size(0.01, 1));
    }
    return fmt::format(R"({{ "name": "object {}", "role": "object", "material": "{}", {} }})", number,
                       material, shape);
}

std::string light(Grammar& g) {
    const std::string at = g.place(g.choose.vector(3)), way = text(g.choose.direction());
    const std::string shadows = g.choose.chance(128) ? R"(, "shadows": true)" : "";
    const double far = g.scale * g.scale;
    switch (g.choose.below(7)) {
        case 0:
            return fmt::format(R"({{ "type": "directional", "direction": {}{} }})", way, shadows);
        case 1:
            return fmt::format(R"({{ "type": "point", "position": {}, "intensity": {}{} }})", at, far,
                               shadows);
        case 2:
            return fmt::format(
                R"({{ "type": "spot", "position": {}, "direction": {}, "outerConeAngle": 30, "intensity": {}{} }})",
                at, way, far, shadows);
        case 3:
            return fmt::format(
                R"({{ "type": "rectangle", "position": {}, "direction": {}, "size": [{}, {}], "samples": 4{} }})",
                at, way, g.scale, 0.5 * g.scale, shadows);
        case 4:
            return fmt::format(R"({{ "type": "sphere", "position": {}, "radius": {}, "samples": 4{} }})", at,
                               g.size(0.01, 1), shadows);
        case 5:
            return fmt::format(R"({{ "type": "directional", "direction": {}, "angle": 5, "samples": 4{} }})",
                               way, shadows);
        default:
            return fmt::format(R"({{ "type": "ambient", "samples": 4{} }})", shadows);
    }
}

}  // namespace

RandomScene make_random_scene(std::string_view bytes) {
    Grammar g{Choices(bytes)};
    RandomScene scene;
    const std::array<double, 5> kScales{1, 1e-5, 1e5, 0.03, 40};
    g.scale = kScales[static_cast<std::size_t>(g.choose.below(5))];
    scene.is_unlit = !g.choose.chance(96);
    scene.other_resolution = 1 + g.choose.below(9);
    const std::string view = camera(g), surfaces = materials(g, scene.is_unlit);
    std::string meshes, lights;
    const int optics = 1 + g.choose.below(3), objects = 1 + g.choose.below(4);
    for (int i = 0; i < optics; ++i) meshes += optic(g, i) + ",\n    ";
    for (int i = 0; i < objects; ++i) meshes += object(g, i) + (i + 1 < objects ? ",\n    " : "");
    if (!scene.is_unlit)
        for (int i = 1 + g.choose.below(2); i > 0; --i) lights += light(g) + (i > 1 ? ", " : "");
    const std::array<int, 5> kDepths{4, 0, 1, 2, 8};
    scene.json = fmt::format(R"({{ "version": 1, "film": {{ "width": 24, "height": 18, "spp": {} }},
  "cameras": [ {} ],
  "background": {{ "color": [{}, 0.3, 0.5] }},
  "render": {{ "maxDepth": {}{} }},
  "materials": [ {} ],
  "lights": [ {} ],
  "meshes": [ {} ] }})",
                             1 + g.choose.below(2), view, share(g),
                             kDepths[static_cast<std::size_t>(g.choose.below(5))],
                             g.choose.chance(64) ? R"(, "fresnel": false)" : "", surfaces, lights, meshes);
    return scene;
}

}  // namespace trilens_fuzz
