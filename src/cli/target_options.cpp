#include "cli/target_options.h"

#include <trilens/error.h>
#include <trilens/text.h>

namespace trilens {

std::vector<Option> direction_options(DirectionOptions& options) {
    return {{.names = "--center",
             .target = &options.center,
             .help = "where directions start: optic (the middle of the optics) or a point",
             .value = "X,Y,Z"},
            {.names = "--proxy",
             .target = &options.proxy,
             .help = "how far what a direction shows is: scene (its objects), infinity, sphere:R, "
                     "box:x0,y0,z0,x1,y1,z1, or a mesh.obj",
             .value = "PROXY"},
            {.names = "--optic", .target = &options.optic, .help = "only over this optic", .value = "NAME"},
            {.names = "--path",
             .target = &options.path,
             .help = "how light comes from the optic; default: reflect by mirrors, refract by glass",
             .choices = {"reflect", "refract", "direct"}}};
}

std::optional<std::size_t> optic_named(const Renderer& renderer, const std::string& name) {
    if (name.empty()) return std::nullopt;
    const std::vector<OpticInfo> optics = renderer.optics();
    std::vector<std::string> names;
    for (std::size_t o = 0; o < optics.size(); ++o) {
        if (optics[o].name == name) return o;
        names.push_back(optics[o].name);
    }
    throw UsageError("there is no optic \"" + name + "\"" + suggestion(name, names));
}

std::optional<Vec3> center_given(const std::string& text) {
    if (text == "optic") return std::nullopt;
    const std::optional<Vec3> point = parse_point(text);
    if (!point) throw UsageError("--center is \"optic\" or X,Y,Z, not \"" + text + "\"");
    return point;
}

std::optional<Path> path_given(const std::string& text) {
    if (text.empty()) return std::nullopt;
    return text == "direct" ? Path::kDirect : text == "refract" ? Path::kRefract : Path::kReflect;
}

}  // namespace trilens
