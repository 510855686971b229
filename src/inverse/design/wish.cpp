#include "inverse/design/design.h"

#include <algorithm>
#include <cmath>

#include "base/math/catmull_rom.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "inverse/design/mirror_fit.h"

namespace trilens {
namespace {

constexpr double kRadians = 0.017453292519943295;

bool is_all_finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Catmull and Rom's cubic over the whole grid, by Lagrange in the outermost pieces, whose neighbours are
/// missing.
std::array<double, 4> grid_weights(double in, int count, int& first) {
    const int cell = std::clamp(static_cast<int>(std::floor(in)), 0, count - 2);
    first = std::clamp(cell - 1, 0, count - 4);
    const double t = in - first;
    if (cell - 1 == first) return catmull_rom(t - 1);
    return {-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2, -t * (t - 1) * (t - 3) / 2,
            t * (t - 1) * (t - 2) / 6};
}

Vec3 map_value(const WishMap& map, const Vec2& st) {
    int column = 0, row = 0;
    const std::array<double, 4> across = grid_weights(st.x * (map.columns - 1), map.columns, column),
                                up = grid_weights(st.y * (map.rows - 1), map.rows, row);
    Vec3 sum(0);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
            sum += across[static_cast<std::size_t>(i)] * up[static_cast<std::size_t>(j)] *
                   map.values[static_cast<std::size_t>(row + j) * static_cast<std::size_t>(map.columns) +
                              static_cast<std::size_t>(column + i)];
    return sum;
}

[[noreturn]] void refuse_wish(const std::string& name, const std::string& place, const std::string& message) {
    throw InputError(name, place, message);
}

void check_patch(const MirrorPatch& patch, const std::string& name) {
    for (const Vec3& v : {patch.center, patch.normal, patch.tangent})
        if (!is_all_finite(v)) refuse_wish(name, "/patch", "is not finite");
    if (!(length(cross(patch.normal, patch.tangent)) > 1e-9 * length(patch.normal) * length(patch.tangent)))
        refuse_wish(name, "/patch/tangent", "is parallel to the normal, or one of them is zero");
    if (!(patch.size.x > 0 && patch.size.y > 0 && std::isfinite(patch.size.x + patch.size.y)))
        refuse_wish(name, "/patch/size", "needs two lengths above 0");
    for (const int count : patch.controls)
        if (count < 4 || count > 200)
            refuse_wish(name, "/patch/controls", "needs 4 to 200 control points each way");
}

void check_map(const WishMap& wish, const std::string& name) {
    if (wish.type == WishType::kPlane &&
        !(length(cross(wish.u, wish.v)) > 1e-9 * length(wish.u) * length(wish.v)))
        refuse_wish(name, "/wish/u", "and v span no plane");
    for (const std::size_t k : {1u, 3u})
        if (wish.type == WishType::kEquirectangular && !(std::fabs(wish.window[k]) <= 90))
            refuse_wish(name, fmt::format("/wish/window/{}", k), "is a latitude beyond 90 degrees");
    if (wish.type == WishType::kMap &&
        (wish.columns < 4 || wish.rows < 4 ||
         wish.values.size() != static_cast<std::size_t>(wish.columns) * static_cast<std::size_t>(wish.rows)))
        refuse_wish(name, "/wish", "a map needs 4 x 4 places or more");
    for (const Vec3& value : wish.values)
        if (!is_all_finite(value)) refuse_wish(name, "/wish", "the map holds a value that is not finite");
}

}  // namespace

PatchFrame::PatchFrame(const MirrorPatch& patch) : center(patch.center) {
    const Vec3 z = normalize(patch.normal), x = normalize(patch.tangent - dot(patch.tangent, z) * z);
    world_from_patch = Mat3(x, cross(z, x), z);
}

WishedRays::WishedRays(const DesignWish& wish)
    : wish_(wish), frame_(wish.patch), eye_(frame_.to_patch(wish.eye)) {}

/// World point, or direction in the rectangle's frame where the wish has directions.
Vec3 WishedRays::value(const Vec2& st) const {
    const WishMap& map = wish_.wish;
    switch (map.type) {
        case WishType::kPlane:
            return map.origin + st.x * map.u + st.y * map.v;
        case WishType::kEquirectangular: {
            const double longitude = kRadians * (map.window[0] + st.x * (map.window[2] - map.window[0])),
                         latitude = kRadians * (map.window[1] + st.y * (map.window[3] - map.window[1]));
            return {std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                    (wish_.lens ? -1 : 1) * std::cos(longitude) * std::cos(latitude)};
        }
        case WishType::kMap:
            return map_value(map, st);
    }
    return Vec3(0);
}

Vec3 WishedRays::value_at(const Vec3& place) const {
    // Where the eye's ray to the place crosses the plane through the middle at right angles to the view.
    const Vec3 ray = place - eye_, look = -normalize(eye_);
    const Vec3 right = normalize(Vec3(1, 0, 0) - look.x * look), up = cross(right, look);
    const Vec3 on = eye_ + length(eye_) / dot(ray, look) * ray;
    return value(Vec2(dot(on, right) / (wish_.patch.size.x * right.x),
                      dot(on, up) / (wish_.patch.size.y * std::abs(up.y))) +
                 Vec2(0.5));
}

std::optional<Vec3> WishedRays::wanted_point(const Vec3& place) const {
    const WishMap& map = wish_.wish;
    if (map.type == WishType::kEquirectangular || (map.type == WishType::kMap && map.is_directions))
        return std::nullopt;
    return frame_.to_patch(value_at(place));
}

Vec3 WishedRays::wanted(const Vec3& place, const Vec3& from) const {
    if (const std::optional<Vec3> point = wanted_point(place)) return normalize(*point - from);
    const Vec3 direction = value_at(place);
    if (wish_.wish.type == WishType::kEquirectangular) return direction;
    return normalize(glm::transpose(frame_.world_from_patch) * direction);
}

void check_wish(const DesignWish& wish, const std::string& name) {
    check_patch(wish.patch, name);
    check_map(wish.wish, name);
    if (!is_all_finite(wish.eye)) refuse_wish(name, "/eye", "is not finite");
    if (!(wish.fairness >= 0) || !std::isfinite(wish.fairness)) refuse_wish(name, "/fairness", "is below 0");
    for (const int count : wish.samples)
        if (count < 4 || count > 400) refuse_wish(name, "/samples", "needs 4 to 400 each way");
    if (std::abs(wish.anchor.x) > wish.patch.size.x / 2 || std::abs(wish.anchor.y) > wish.patch.size.y / 2)
        refuse_wish(name, "/anchor", "lies beside the rectangle");
    const WishedRays rays(wish);
    if (!(rays.eye().z > 0))
        refuse_wish(name, "/eye",
                    std::string("lies behind the ") + optic_word(wish) + "'s rectangle, or in its plane");
    if (wish.lens && !(wish.lens->ior > 1 && wish.lens->ior <= 10))
        refuse_wish(name, "/lens/ior", "is not above 1 and at most 10");
    if (wish.lens && !(wish.lens->thickness > 0 && std::isfinite(wish.lens->thickness)))
        refuse_wish(name, "/lens/thickness", "is not above 0");
    for (const double s : {0.0, 0.5, 1.0})
        for (const double t : {0.0, 0.5, 1.0}) {
            const Vec3 place((s - 0.5) * wish.patch.size.x, (t - 0.5) * wish.patch.size.y, 0);
            const char* why = needed_slopes(rays, place).refusal;
            if (why)
                refuse_wish(name, "/wish",
                            fmt::format("at ({}, {}) of the {} {}", s, t, optic_word(wish), why));
        }
}

}  // namespace trilens
