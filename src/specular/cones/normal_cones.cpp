#include "specular/cones/normal_cones.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace trilens {
namespace {

constexpr std::uint32_t kFacesInLeaf = 4;

double angle_between(const Vec3& a, const Vec3& b) {
    return std::acos(std::clamp(dot(a, b), -1.0, 1.0));
}

/// Around all of them: the mean normal's cone.
FaceBounds bounds_around(const std::vector<FaceBounds>& faces, std::span<const std::size_t> some) {
    FaceBounds around;
    Vec3 sum(0);
    for (const std::size_t face : some) {
        around.box.include(faces[face].box);
        sum += faces[face].normal;
    }
    around.normal = normalize_or_zero(sum);
    around.angle = around.normal == Vec3(0) ? std::numbers::pi : 0;
    for (const std::size_t face : some)
        around.angle =
            std::max(around.angle, angle_between(around.normal, faces[face].normal) + faces[face].angle);
    return around;
}

}  // namespace

NormalCones::NormalCones(const Surface& surface) {
    std::vector<FaceBounds> faces(surface.face_count());
    std::vector<Vec3> centres(faces.size());
    for (Id face = 0; face < faces.size(); ++face) {
        const std::optional<FaceBounds> known = surface.face_bounds(face);
        if (known) {
            faces[face] = *known;
            centres[face] = 0.5 * (known->box.low + known->box.high);
            order_.push_back(face);
        } else {
            unbounded_.push_back(face);
        }
    }
    if (!order_.empty()) build(faces, centres, 0, static_cast<std::uint32_t>(order_.size()));
    for (const std::size_t face : order_) bounds_.push_back(faces[face]);
}

void NormalCones::build(const std::vector<FaceBounds>& faces, std::span<const Vec3> centres,
                        std::uint32_t first, std::uint32_t end) {
    const std::size_t at = nodes_.size();
    nodes_.emplace_back();
    nodes_[at].bounds = bounds_around(faces, std::span(order_).subspan(first, end - first));
    if (end - first <= kFacesInLeaf) {
        nodes_[at].first = first, nodes_[at].end = end;
    } else {
        const std::uint32_t middle = first + static_cast<std::uint32_t>(spatial_split(
                                                 centres, std::span(order_).subspan(first, end - first)));
        build(faces, centres, first, middle);
        build(faces, centres, middle, end);
    }
    nodes_[at].skip = static_cast<std::uint32_t>(nodes_.size());
}

}  // namespace trilens
