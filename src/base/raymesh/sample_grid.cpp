#include "base/raymesh/sample_grid.h"

#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/format.h"

namespace trilens {

namespace {

/// Calls body(facet, begin, end) for each run of samples side by side that have one owner.
template <typename Body>
void for_each_run(std::span<const Id> owner, const Body& body) {
    for (std::size_t begin = 0; begin < owner.size();) {
        std::size_t end = begin + 1;
        while (end < owner.size() && owner[end] == owner[begin]) ++end;
        if (owner[begin] != kNone) body(owner[begin], begin, end);
        begin = end;
    }
}

}  // namespace

FacetSamples group_by_facet(std::span<const Id> owner, std::size_t facet_count) {
    FacetSamples result;
    result.first.assign(facet_count + 1, 0);
    for_each_run(owner, [&](Id facet, std::size_t begin, std::size_t end) {
        TRILENS_CHECK(facet < facet_count, "an owner must be a facet of the mesh");
        result.first[facet + 1] += end - begin;
    });
    for (std::size_t f = 0; f < facet_count; ++f) result.first[f + 1] += result.first[f];

    result.sample.resize(result.first.back());
    std::vector<std::size_t> next(result.first.begin(), result.first.end() - 1);
    for_each_run(owner, [&](Id facet, std::size_t begin, std::size_t end) {
        Id* to = result.sample.data() + next[facet];
        for (std::size_t s = begin; s < end; ++s) *to++ = static_cast<Id>(s);
        next[facet] += end - begin;
    });
    return result;
}

namespace {

constexpr const char* kNoNumber = "is not finite, or too large";

void require(bool holds, const char* list, std::size_t i, const char* message) {
    if (!holds) throw InputError("", fmt::format("{}/{}", list, i), message);
}

}  // namespace

void check_sample_grid(const SampleGrid& grid) {
    if (grid.x0 >= grid.x1 || grid.y0 >= grid.y1 || grid.side < 1)
        throw InputError("", "grid", "has no samples");
    for (const int at : {grid.x0, grid.y0, grid.x1, grid.y1})
        if (at < -kFarthestPixel || at > kFarthestPixel)
            throw InputError("", "grid", fmt::format("pixel {} is not within {}", at, kFarthestPixel));
    std::size_t left = kMostSamples;
    const auto width = static_cast<std::size_t>(static_cast<long long>(grid.x1) - grid.x0);
    const auto height = static_cast<std::size_t>(static_cast<long long>(grid.y1) - grid.y0);
    const auto side = static_cast<std::size_t>(grid.side);
    for (const std::size_t factor : {width, height, side, side}) left /= factor;
    if (left == 0)
        throw InputError("", "grid",
                         fmt::format("{} x {} pixels of {} x {} samples are more than {} samples", width,
                                     height, side, side, kMostSamples));
}

void check_facet_corners(const RayMesh& mesh) {
    if (mesh.screen.size() != mesh.rays.size()) throw InputError("", "screen", "needs one entry per ray");
    if (mesh.facets.size() >= kNone) throw InputError("", "facets", "are numbered with 32 bits");
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f)) continue;
        for (const Id corner : mesh.facets[f])
            require(corner < mesh.rays.size(), "facets", f, "has a corner that is none of the mesh");
    }
}

void check_ray_mesh(const RayMesh& mesh) {
    check_facet_corners(mesh);
    for (std::size_t i = 0; i < mesh.rays.size(); ++i) {
        require(is_coordinate(mesh.rays[i].origin) && is_coordinate(mesh.rays[i].direction), "rays", i,
                kNoNumber);
        require(is_coordinate(mesh.screen[i]), "screen", i, kNoNumber);
        const Vec3 size = glm::abs(mesh.screen[i]);
        const double largest = glm::max(glm::max(size.x, size.y), size.z);
        require(largest == 0 || largest >= 1 / kLargestNumber, "screen", i, "is too small");
    }
}

void check_triangle_scene(const TriangleScene& scene) {
    if (scene.object.size() != scene.size()) throw InputError("", "object", "needs one entry per triangle");
    if (scene.primitive.size() != scene.size())
        throw InputError("", "primitive", "needs one entry per triangle");
    if (scene.size() >= kNone) throw InputError("", "triangles", "are numbered with 32 bits");
    for (std::size_t i = 0; i < scene.points.size(); ++i)
        require(is_coordinate(scene.points[i]), "points", i, kNoNumber);
    for (std::size_t t = 0; t < scene.size(); ++t)
        for (const Id corner : scene.triangles[t])
            require(corner < scene.points.size(), "triangles", t, "has a corner that is no point");
}

}  // namespace trilens
