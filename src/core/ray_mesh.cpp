#include "core/ray_mesh.h"

#include <unistd.h>

#include <cmath>

#include "base/raymesh/rasterize.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "projector/projector.h"
#include "reflect/reflection.h"
#include "refract/refraction.h"

namespace trilens {
namespace {

void require(bool holds, const char* list, std::size_t i, const char* message) {
    if (!holds) throw InputError("", fmt::format("{}/{}", list, i), message);
}

void check_grid(const SurfaceGrid& grid) {
    if (grid.corner_normal.size() != grid.corner_point.size())
        throw InputError("", "corner_normal", "needs one entry per corner");
    for (std::size_t i = 0; i < grid.points.size(); ++i)
        require(is_coordinate(grid.points[i]), "points", i, "is not finite, or too large");
    for (std::size_t i = 0; i < grid.corner_point.size(); ++i) {
        require(grid.corner_point[i] < grid.points.size(), "corner_point", i, "is no point");
        require(is_coordinate(grid.corner_normal[i]), "corner_normal", i, "is not finite, or too large");
    }
    for (std::size_t f = 0; f < grid.facets.size(); ++f)
        for (const Id corner : grid.facets[f])
            require(corner < grid.corner_point.size(), "facets", f, "has a corner that is none of the grid");
}

void check_camera(const LinearCamera& camera) {
    bool finite = is_coordinate(camera.eye) && is_coordinate(camera.view_direction);
    for (const Vec4& row : {camera.screen_x, camera.screen_y, camera.screen_w})
        finite = finite && is_coordinate(Vec3(row)) && std::fabs(row.w) <= kLargestNumber;
    if (!finite) throw InputError("", "camera", "is not finite, or too large");
}

/// Refuses what would fill the machine's memory: the system would end the program without a word.
void check_answers_fit(const SampleGrid& grid, std::size_t bytes_per_answer) {
    constexpr std::size_t kBytesPerSample = 4 * sizeof(Id);  // owners, their lists, vectors of them
    const double needed = static_cast<double>(bytes_per_answer + kBytesPerSample) *
                          static_cast<double>(grid.size()),
                 memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                          static_cast<double>(sysconf(_SC_PAGESIZE));
    if (needed >= memory)
        throw InputError("", "grid",
                         fmt::format("{} samples need about {:.0f} GiB; this machine has {:.0f}", grid.size(),
                                     needed / (1 << 30), memory / (1 << 30)));
}

void check_drawing(const RayMesh& mesh, const TriangleScene& scene, const SampleGrid& grid) {
    check_ray_mesh(mesh);
    check_triangle_scene(scene);
    check_sample_grid(grid);
}

}  // namespace

RayMesh make_mirror_mesh(const SurfaceGrid& grid, const LinearCamera& camera) {
    check_grid(grid);
    check_camera(camera);
    return make_reflection(grid, camera);
}

RayMesh make_lens_mesh(const SurfaceGrid& grid, const LinearCamera& camera, double ior) {
    check_grid(grid);
    check_camera(camera);
    if (!(ior > 0) || !std::isfinite(ior)) throw InputError("", "ior", "is not positive");
    return make_refraction(grid, camera, ior);
}

std::vector<Hit> draw_through(const RayMesh& mesh, const TriangleScene& scene, const SampleGrid& grid) {
    check_drawing(mesh, scene, grid);
    check_answers_fit(grid, sizeof(Hit));
    std::vector<Hit> hits(grid.size());
    draw(PreparedScene(scene), mesh, rasterize_facets(mesh, grid), grid, hits);
    return hits;
}

std::vector<Visible> visible_through(const RayMesh& mesh, const TriangleScene& scene,
                                     const SampleGrid& grid) {
    check_drawing(mesh, scene, grid);
    check_answers_fit(grid, sizeof(Visible));
    std::vector<Visible> visible(grid.size());
    find_visible(PreparedScene(scene), mesh, rasterize_facets(mesh, grid), grid, visible);
    return visible;
}

}  // namespace trilens
