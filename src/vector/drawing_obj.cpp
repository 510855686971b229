// Caustics and fold curves of a drawing in the world, as a Wavefront OBJ.
#include <cctype>
#include <cstdio>

#include "vector/drawing.h"

namespace trilens {
namespace {

/// A name without blanks, as OBJ's readers want it.
std::string word(const std::string& name) {
    std::string out;
    for (const char c : name) out += std::isgraph(static_cast<unsigned char>(c)) || (c & 0x80) ? c : '_';
    return out;
}

void append_points(const std::vector<Vec3>& points, std::string& obj) {
    char line[100];
    for (const Vec3& p : points) {
        std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", p.x, p.y, p.z);
        obj += line;
    }
}

std::string layer_name(const DrawingLayer& layer, const World& world) {
    return layer.optic == kNone ? "camera" : word(world.names[layer.optic]) + "-" + layer.path;
}

}  // namespace

std::string drawing_obj(const Drawing& drawing, const World& world) {
    std::string obj =
        "# Caustics: where neighbouring rays that leave the camera or an optic meet (first and second "
        "sheet;\n"
        "# virtual: behind the optic), and as lines the fold curves: where caustics lie on what is seen.\n";
    std::size_t count = 0;  // of points so far
    const auto start = [&](const std::string& name, const std::vector<Vec3>& points) {
        obj += "o " + name + "\n";
        append_points(points, obj);
        count += points.size();
        return count - points.size() + 1;
    };
    for (const auto& layer : drawing.layers) {
        for (const CausticSheet& sheet : layer->caustic) {
            const std::size_t first =
                start(layer_name(*layer, world) + (sheet.sheet == 0 ? "-first" : "-second") +
                          (sheet.is_virtual ? "-virtual" : ""),
                      sheet.points);
            for (const IdTriple& t : sheet.triangles)
                obj += "f " + std::to_string(first + t[0]) + " " + std::to_string(first + t[1]) + " " +
                       std::to_string(first + t[2]) + "\n";
            for (const auto& s : sheet.segments)
                obj += "l " + std::to_string(first + s[0]) + " " + std::to_string(first + s[1]) + "\n";
        }
        for (const FoldCurve& fold : layer->folds) {
            if (fold.object == kNone) continue;  // in the environment, at no place
            std::size_t at =
                start(layer_name(*layer, world) + "-fold-on-" + word(world.names[fold.object]), fold.places);
            obj += "l";
            for (std::size_t i = 0; i < fold.places.size(); ++i) obj += " " + std::to_string(at++);
            obj += "\n";
        }
    }
    return obj;
}

}  // namespace trilens
