// Random optics and objects: primitives and cages that touch, hold each other, or are seen from inside.
#include "fuzz/random_meshes.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

constexpr const char* kCube =
    R"("faceVertexCounts": [4,4,4,4,4,4], "faceVertexIndices": [0,1,2,3, 1,5,6,2, 5,4,7,6, 4,0,3,7, 3,2,6,7, 4,5,1,0])";

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
    constexpr std::array<std::array<double, 3>, 6> kPlaces{
        {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, -1}, {0, 0.5, 0.5}, {-30, 2, -60}}};
    const auto& p = kPlaces[static_cast<std::size_t>((g.choose.below(6) + number) % 6)];
    const Vec3 at(p[0], p[1], p[2]);
    return g.choose.chance(128) ? at : at + g.choose.vector(0.4);
}

/// Moved, turned and, where no primitive is to stay one, stretched and mirrored; or nothing.
std::string transform(Grammar& g, const std::string& shape) {
    if (!g.choose.chance(64)) return "";
    switch (g.choose.below(shape.starts_with(R"("primitive)") ? 3 : 5)) {
        case 0:
            return Phrase{R"(, "transform": {{ "translate": {} }})", g.place(g.choose.vector(0.5))};
        case 1:
            return Phrase{R"(, "transform": {{ "rotate": {{ "axis": {}, "angle": {} }} }})",
                          text_of(g.choose.direction()), g.choose.between(-180, 180)};
        case 2: {
            const double factor = g.choose.log_between(0.1, 10);
            return Phrase{R"(, "transform": {{ "scale": [{}, {}, {}] }})", factor, factor, factor};
        }
        case 3:
            return Phrase{R"(, "transform": {{ "scale": [{}, {}, {}] }})", g.choose.log_between(0.1, 10),
                          g.choose.log_between(0.1, 10), g.choose.log_between(0.1, 10)};
        default:
            return Phrase{
                R"(, "transform": {{ "rotate": {{ "euler": {}, "order": "ZXY" }}, "scale": [-1, 1, 0.5] }})",
                text_of(g.choose.vector(90))};
    }
}

std::string optic_shape(Grammar& g, int number) {
    const Vec3 at = centre(g, number);
    const double radius = g.choose.of(std::array{1.0, 0.5, 0.999, 0.02, 0.1, 1.5, 8.0});
    const double size = g.scale * radius;
    switch (g.choose.below(9)) {
        case 0:
            return Phrase{R"("primitive": {{ "type": "sphere", "center": {}, "radius": {} }})", g.place(at),
                          size};
        case 1:
            return Phrase{
                R"("primitive": {{ "type": "plane", "center": {}, "normal": {}, "size": [{}, {}] }})",
                g.place(at), text_of(g.choose.direction()), 2 * size, size};
        case 2:
            return Phrase{
                R"("primitive": {{ "type": "cylinder", "center": {}, "axis": {}, "radius": {}, "height": {} }})",
                g.place(at), text_of(g.choose.direction()), 0.5 * size, g.size(0.01, 4)};
        case 3:
            return Phrase{
                R"("primitive": {{ "type": "paraboloid", "center": {}, "axis": {}, "radius": {}, "focalLength": {} }})",
                g.place(at), text_of(g.choose.direction()), size, g.size(0.05, 5)};
        case 4:
            return Phrase{R"("points": [{}], {})", cage_points(g, at, Vec3(radius)), kCube};
        case 5:
            return Phrase{
                R"("primitive": {{ "type": "cone", "center": {}, "axis": {}, "radius": {}, "height": {} }})",
                g.place(at), text_of(g.choose.direction()), 0.5 * size, g.size(0.01, 4)};
        case 6: {  // a patch that is open, bent more or less
            const double bend = g.choose.log_between(1e-4, 0.5);
            std::string points;
            for (int k = 0; k < 9; ++k) {
                const Vec3 flat(k % 3 - 1, bend * (k == 4 ? 1 : k % 2 ? 0.4 : 0), k / 3 - 1);
                points += (k ? ", " : "") + g.place(at + radius * flat + g.choose.vector(0.02 * radius));
            }
            return Phrase{
                R"("points": [{}], "faceVertexCounts": [4,4,4,4], "faceVertexIndices": [0,3,4,1, 1,4,5,2, 3,6,7,4, 4,7,8,5], "interpolateBoundary": "{}")",
                points, g.choose.chance(128) ? "edgeAndCorner" : "edgeOnly"};
        }
        case 7: {
            const char* const scheme = g.choose.chance(128) ? "loop" : "bilinear";
            std::string points = g.place(at + Vec3(0, radius, 0));
            for (int k = 0; k < 3; ++k) {
                const Vec3 corner(k == 0 ? 1 : -0.5, -0.4, k == 1 ? 0.9 : k == 2 ? -0.9 : 0);
                points += ", " + g.place(at + radius * corner + g.choose.vector(0.1 * radius));
            }
            return Phrase{
                R"("points": [{}], "faceVertexCounts": [3,3,3,3], "faceVertexIndices": [0,2,1, 0,1,3, 0,3,2, 1,2,3], "subdivisionScheme": "{}")",
                points, scheme};
        }
        default: {  // creased, flat or long
            const double flat = g.choose.log_between(0.003, 1), deep = g.choose.log_between(0.1, 3);
            return Phrase{
                R"("points": [{}], {}, "creaseIndices": [0,1,2,3,0], "creaseLengths": [5], "creaseSharpnesses": [{}])",
                cage_points(g, at, radius * Vec3(1, flat, deep)), kCube, g.choose.chance(128) ? 10.0 : 1.3};
        }
    }
}

}  // namespace

std::string random_optic(Grammar& g, int number) {
    const std::string shape = optic_shape(g, number);
    std::string extras = Phrase{R"(, "resolution": {})", g.choose.of(std::array{4, 1, 2, 3, 8, 16, 5, 32})};
    if (g.choose.chance(64)) extras += R"(, "grid": "screen")";
    if (g.choose.chance(64)) extras += R"(, "rays": "interpolated")";
    if (g.choose.chance(64)) extras += R"(, "seenOptics": "layers")";
    if (g.choose.chance(64)) extras += Phrase{R"(, "priority": {})", g.choose.below(3) - 1}.text;
    if (g.choose.chance(6))
        extras += Phrase{R"(, "normals": {{ "type": "noise", "amplitude": {}, "scale": {} }})",
                         g.choose.log_between(0.001, 0.2), g.choose.log_between(0.5, 10) / g.scale}
                      .text;
    extras += transform(g, shape);
    const char* const material =
        g.choose.of(std::array{"chrome", "glass", "chrome", "glass", "thick", "flint"});
    return Phrase{R"({{ "name": "optic {}", "role": "optic", "material": "{}", {}{} }})", number, material,
                  shape, extras};
}

std::string random_object(Grammar& g, int number) {
    const char* const material = std::array{"a", "b", "c"}[static_cast<std::size_t>(number % 3)];
    std::string shape;
    switch (g.choose.below(5)) {
        case 0:
            shape = Phrase{
                R"("points": [{}, {}, {}, {}], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0], "uvs": [[0,0],[4,0],[4,4],[0,4]], "uvIndices": [3,2,1,0])",
                g.place({-5, -1, -5}), g.place({5, -1, -5}), g.place({5, -1, 5}), g.place({-5, -1, 5})};
            break;
        case 1:  // two triangles that cross
            shape = Phrase{
                R"("points": [{}, {}, {}, {}, {}, {}], "faceVertexCounts": [3,3], "faceVertexIndices": [0,1,2,3,4,5])",
                g.place(g.choose.vector(3)),
                g.place(g.choose.vector(3)),
                g.place(g.choose.vector(3)),
                g.place(g.choose.vector(3)),
                g.place(g.choose.vector(3)),
                g.place(g.choose.vector(3))};
            break;
        case 2:
            shape = Phrase{R"("primitive": {{ "type": "box", "center": {}, "size": [{}, {}, {}] }})",
                           g.place(centre(g, number) + Vec3(0, 0, -2)), g.size(0.01, 2), g.size(0.01, 2),
                           g.size(0.01, 2)};
            break;
        case 3:  // a wall behind all
            shape = Phrase{
                R"("primitive": {{ "type": "plane", "center": {}, "normal": [0, 0, 1], "size": [{}, {}] }})",
                g.place({0, 0, -6}), 20 * g.scale, 20 * g.scale};
            break;
        default:
            shape =
                Phrase{R"("primitive": {{ "type": "sphere", "center": {}, "radius": {}, "segments": 8 }})",
                       g.place(centre(g, number) + Vec3(-1.5, 0, 1)), g.size(0.01, 1)};
    }
    return Phrase{R"({{ "name": "object {}", "role": "object", "material": "{}", {}{} }})", number, material,
                  shape, transform(g, shape)};
}

std::string random_volume(Grammar& g) {
    std::string scalars;
    for (int k = 0; k < 12; ++k) scalars += (k ? ", " : "") + fmt::format("{}", g.choose.below(16));
    return Phrase{
        R"({{ "grid": {{ "size": [2, 3, 2], "origin": {}, "spacing": [{}, {}, {}], "scalars": [{}] }},
    "transferFunction": {{ "map": "viridis", "range": [0, 15], "extinction": {} }} }})",
        g.place(g.choose.vector(1)),
        g.size(0.05, 2),
        g.size(0.05, 2),
        g.size(0.05, 2),
        scalars,
        g.choose.log_between(0.05, 5) / g.scale};
}

}  // namespace trilens_fuzz
