// Copies a scene into leaf order.
#include "projector/prepared_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/check.h"

namespace trilens {
namespace {

std::vector<Box> triangle_boxes(const TriangleScene& scene) {
    std::vector<Box> boxes(scene.size());
    for (std::size_t i = 0; i < scene.size(); ++i) {
        for (const Id corner : scene.triangles[i]) {
            TRILENS_CHECK(corner < scene.points.size(), "a triangle's corner must be a point of the scene");
            const Vec3& p = scene.points[corner];
            TRILENS_CHECK(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z),
                          "points must be finite");
            boxes[i].include(p);
        }
    }
    return boxes;
}

/// Each triangle's place in the order of (object, primitive, index): the order that breaks ties in depth.
std::vector<Id> tie_ranks(const TriangleScene& scene) {
    std::vector<Id> sorted(scene.size());
    std::iota(sorted.begin(), sorted.end(), Id{0});
    const auto key = [&](Id i) { return std::tuple(scene.object[i], scene.primitive[i], i); };
    std::sort(sorted.begin(), sorted.end(), [&](Id a, Id b) { return key(a) < key(b); });
    std::vector<Id> rank(scene.size());
    for (std::size_t place = 0; place < sorted.size(); ++place) rank[sorted[place]] = static_cast<Id>(place);
    return rank;
}

void append_triangle(PreparedScene::Data& data, const TriangleScene& scene, Id triangle) {
    const auto point = [&](std::uint8_t k) { return scene.points[scene.triangles[triangle][k]]; };
    std::array<std::uint8_t, 3> corner{0, 1, 2};
    std::sort(corner.begin(), corner.end(), [&](std::uint8_t a, std::uint8_t b) {
        const Vec3 p = point(a), q = point(b);
        return std::tuple(p.x, p.y, p.z, a) < std::tuple(q.x, q.y, q.z, b);
    });
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = point(corner[k]);
        data.x[k].push_back(p.x);
        data.y[k].push_back(p.y);
        data.z[k].push_back(p.z);
    }
    data.was_corner.push_back(corner);
    data.triangle.push_back(triangle);
}

}  // namespace

PreparedScene::PreparedScene(const TriangleScene& scene) : data_(std::make_unique<Data>()) {
    TRILENS_CHECK(scene.object.size() == scene.size() && scene.primitive.size() == scene.size(),
                  "every triangle needs an object and a primitive");
    data_->bvh = build_bvh(triangle_boxes(scene));
    const std::vector<Id> rank = tie_ranks(scene);
    for (std::size_t k = 0; k < 3; ++k) {
        data_->x[k].reserve(scene.size());
        data_->y[k].reserve(scene.size());
        data_->z[k].reserve(scene.size());
    }
    for (const Id triangle : data_->bvh.order) {
        append_triangle(*data_, scene, triangle);
        data_->rank.push_back(rank[triangle]);
    }
    data_->bvh.order = {};
    data_->leaves = build_leaf_tree(*data_);
}

PreparedScene::~PreparedScene() = default;
PreparedScene::PreparedScene(PreparedScene&&) noexcept = default;
PreparedScene& PreparedScene::operator=(PreparedScene&&) noexcept = default;

}  // namespace trilens
