// Targets and proxies as people write them: "equirect:2048x1024", "plane:0,0,0,1,0,0,0,1,0,800x600".
#include <charconv>
#include <string_view>

#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/names.h"
#include "inverse/maps/number_list.h"
#include "inverse/maps/target.h"

namespace trilens {
namespace {

struct PixelSize {
    int width = 0, height = 0;
};

std::optional<PixelSize> size_of(std::string_view text) {
    const std::size_t x = text.find('x');
    if (x == std::string_view::npos) return std::nullopt;
    const auto width = whole_number(text.substr(0, x)), height = whole_number(text.substr(x + 1));
    if (!width || !height) return std::nullopt;
    return PixelSize{*width, *height};
}

TargetDescription plane_of(const std::string& text, const std::string& values) {
    const std::size_t comma = values.rfind(',');
    const auto numbers = comma == std::string::npos ? std::nullopt : number_list(values.substr(0, comma));
    const auto size = comma == std::string::npos ? std::nullopt : size_of(values.substr(comma + 1));
    if (!numbers || numbers->size() != 9 || !size)
        throw UsageError(
            "a plane is plane:ox,oy,oz,ux,uy,uz,vx,vy,vz,WxH (lower left corner, side to the "
            "right, side upward), not \"" +
            text + "\"");
    const auto vector = [&](std::size_t i) {
        return Vec3((*numbers)[i], (*numbers)[i + 1], (*numbers)[i + 2]);
    };
    return {TargetKind::kPlane, size->width, size->height, vector(0), vector(3), vector(6)};
}

TargetDescription object_of(const std::string& text, const Scene& scene) {
    const std::size_t colon = text.rfind(':');
    auto size = colon == std::string::npos ? std::nullopt : size_of(std::string_view(text).substr(colon + 1));
    const std::string name = size ? text.substr(0, colon) : text;
    std::vector<std::string> names;
    TargetDescription target;
    target.kind = TargetKind::kObject;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (scene.meshes[m].name == name) target.object = static_cast<Id>(m);
        if (scene.meshes[m].role == Role::kObject) names.push_back(scene.meshes[m].name);
    }
    if (target.object == kNone)
        throw UsageError("the target \"" + text +
                         "\" is neither equirect:WxH, cubemap:N, fisheye:N, plane:... nor an object" +
                         suggestion(name, names));
    if (!size) {
        const auto flat = flat_rectangle(scene.meshes[target.object].object);
        const double aspect = flat ? length(flat->u) / length(flat->v) : 1;
        size = aspect >= 1 ? PixelSize{1024, std::max(1, static_cast<int>(1024 / aspect + 0.5))}
                           : PixelSize{std::max(1, static_cast<int>(1024 * aspect + 0.5)), 1024};
    }
    target.width = size->width;
    target.height = size->height;
    return target;
}

}  // namespace

TargetDescription parse_target(const std::string& text, const Scene& scene) {
    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon),
                      values = colon == std::string::npos ? "" : text.substr(colon + 1);
    if (kind == "equirect" && colon != std::string::npos) {
        const auto size = size_of(values);
        if (!size) throw UsageError("an equirect target is equirect:WxH, not \"" + text + "\"");
        return {TargetKind::kEquirect, size->width, size->height};
    }
    if (kind == "cubemap" && colon != std::string::npos) {
        const auto side = whole_number(values);
        if (!side || *side > kMostFilmSide) throw UsageError("a cube map is cubemap:N, not \"" + text + "\"");
        return {TargetKind::kCubemap, 6 * *side, *side};
    }
    if (kind == "fisheye" && colon != std::string::npos) {
        const std::size_t second = values.find(':');
        const auto side = whole_number(values.substr(0, second));
        const auto fov = second == std::string::npos ? std::optional(std::vector<double>{180})
                                                     : number_list(values.substr(second + 1));
        if (!side || !fov || fov->size() != 1)
            throw UsageError("a fisheye target is fisheye:N or fisheye:N:DEGREES, not \"" + text + "\"");
        TargetDescription target{TargetKind::kFisheye, *side, *side};
        target.fov = fov->front();
        return target;
    }
    if (kind == "plane" && colon != std::string::npos) return plane_of(text, values);
    return object_of(text, scene);
}

}  // namespace trilens
