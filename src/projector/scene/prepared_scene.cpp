// Copies a scene into leaf order.
#include "projector/scene/bvh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/util/check.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::size_t kPreparedTogether = 4096;  // triangles that are worth a thread

void check_triangles(const TriangleScene& scene) {
    TRILENS_CHECK(scene.object.size() == scene.size() && scene.primitive.size() == scene.size(),
                  "every triangle needs an object and a primitive");
    parallel_for(scene.size(), kPreparedTogether, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            for (const Id corner : scene.triangles[i]) {
                TRILENS_CHECK(corner < scene.points.size(),
                              "a triangle's corner must be a point of the scene");
                const Vec3& p = scene.points[corner];
                TRILENS_CHECK(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z),
                              "points must be finite");
            }
        }
    });
}

/// Each triangle's place in the order of (object, primitive, index): the order that breaks ties in depth.
/// Empty where that is its index.
std::vector<Id> tie_ranks(const TriangleScene& scene) {
    std::vector<Id> sorted(scene.size());
    std::iota(sorted.begin(), sorted.end(), Id{0});
    const auto key = [&](Id i) { return std::tuple(scene.object[i], scene.primitive[i], i); };
    const auto before = [&](Id a, Id b) { return key(a) < key(b); };
    // Scenes come mesh by mesh, triangle by triangle: then the order is the ranks.
    if (std::is_sorted(sorted.begin(), sorted.end(), before)) return {};
    std::sort(sorted.begin(), sorted.end(), before);
    std::vector<Id> rank(scene.size());
    for (std::size_t place = 0; place < sorted.size(); ++place) rank[sorted[place]] = static_cast<Id>(place);
    return rank;
}

PreparedTriangle prepared_triangle(const TriangleScene& scene, Id triangle) {
    std::array<Vec3, 3> point;
    for (std::size_t k = 0; k < 3; ++k) point[k] = scene.points[scene.triangles[triangle][k]];
    std::array<std::uint8_t, 3> corner{0, 1, 2};
    std::sort(corner.begin(), corner.end(), [&](std::uint8_t a, std::uint8_t b) {
        const Vec3 &p = point[a], &q = point[b];
        return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
    });
    PreparedTriangle prepared;
    prepared.name = triangle;
    for (std::size_t k = 0; k < 3; ++k) {
        prepared.corner[k] = point[corner[k]];
        if (corner[k] == 1) prepared.name |= std::uint64_t{k} << PreparedTriangle::kSecondBit;
        if (corner[k] == 2) prepared.name |= std::uint64_t{k} << PreparedTriangle::kThirdBit;
    }
    return prepared;
}

Box box_of_corners(const Vec3& a, const Vec3& b, const Vec3& c) {
    return {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)};
}

}  // namespace

PreparedScene::PreparedScene(const TriangleScene& scene) : data_(std::make_unique<Data>()) {
    check_triangles(scene);
    Data& data = *data_;
    const std::size_t count = scene.size();
    std::vector<Id> order;
    data.leaves = cut_leaf_tree(
        count,
        [&](Id i) {
            const IdTriple& corner = scene.triangles[i];
            return box_of_corners(scene.points[corner[0]], scene.points[corner[1]], scene.points[corner[2]]);
        },
        order);
    const std::vector<Id> rank = tie_ranks(scene);
    data.triangles.resize(count);
    data.named.resize(count + 1, kNone);
    data.ranks.resize(rank.size());
    parallel_for(count, kPreparedTogether, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            data.triangles[i] = prepared_triangle(scene, order[i]);
            data.named[i + 1] = order[i];
            if (!rank.empty()) data.ranks[i] = rank[order[i]];
        }
    });
    fill_leaves(data, data.leaves);
}

const Bvh& PreparedScene::Data::bvh() const {
    return bvh_.get([this] {
        const auto box_of = [this](Id i) {
            const std::array<Vec3, 3>& corner = triangles[i].corner;
            return box_of_corners(corner[0], corner[1], corner[2]);
        };
        auto bvh = std::make_unique<Bvh>(build_bvh(size(), box_of));
        fit_boxes(*bvh, [&](Id place) { return box_of(bvh->order[place]); });
        return bvh;
    });
}

PreparedScene::~PreparedScene() = default;
PreparedScene::PreparedScene(PreparedScene&&) noexcept = default;
PreparedScene& PreparedScene::operator=(PreparedScene&&) noexcept = default;

}  // namespace trilens
