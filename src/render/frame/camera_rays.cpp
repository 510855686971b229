#include "render/frame/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/util/parallel.h"
#include "trilinear/points/point_images.h"

namespace trilens {
namespace {

bool has_optics(const Scene& scene) {
    return std::any_of(scene.meshes.begin(), scene.meshes.end(),
                       [](const Mesh& mesh) { return mesh.role == Role::kOptic; });
}

}  // namespace

CameraRays make_camera_rays(const Scene& scene, std::size_t index) {
    const CameraDescription& from = scene.cameras[index];
    const FilmSize film{static_cast<double>(scene.film.width), static_cast<double>(scene.film.height)};
    CameraRays camera = make_camera(from, film, {scene.file, "/cameras/" + std::to_string(index)});
    if (std::holds_alternative<RayMeshCamera>(from.kind) && has_optics(scene))
        camera.model = make_ray_mesh_model(camera.mesh, film);
    return camera;
}

FacetSamples set_exact_rays(const CameraModel& model, const SampleGrid& grid, std::span<SampleView> views) {
    std::vector<Id> owner(grid.size(), kNone);
    parallel_for(owner.size(), 256, [&](std::size_t from, std::size_t to) {
        for (std::size_t s = from; s < to; ++s) {
            const std::optional<Ray> ray = model.ray(grid.position(s));
            if (!ray) continue;
            views[s].ray = *ray;
            owner[s] = 0;
        }
    });
    return group_by_facet(owner, 1);
}

void count_from_eye(const CameraRays& camera, std::span<SampleView> views) {
    if (camera.near_depth == 0) return;
    for (SampleView& view : views)
        if (view.hit.seen() || view.optic != kNone) view.depth += camera.near_depth;
}

namespace {

constexpr int kCells = 64;  // buckets along each side of the film

class RayMeshModel final : public CameraModel {
  public:
    RayMeshModel(const RayMesh& mesh, const FilmSize& film) : mesh_(mesh), film_(film), images_(mesh) {
        cells_.resize(kCells * kCells);
        for (std::size_t f = 0; f < mesh_.facets.size(); ++f) {
            weights_.push_back(mesh_.has_rays(f) ? facet_weights(mesh_, f) : FacetWeights());
            if (weights_.back().edge_on) continue;
            Vec2 low(1e300), high(-1e300);
            for (const Id corner : mesh_.facets[f]) {
                const Vec2 at = Vec2(mesh_.screen[corner]) / mesh_.screen[corner].z;
                low = glm::min(low, at);
                high = glm::max(high, at);
            }
            for (std::size_t row = cell(low.y, film_.height); row <= cell(high.y, film_.height); ++row)
                for (std::size_t column = cell(low.x, film_.width); column <= cell(high.x, film_.width);
                     ++column)
                    cells_[row * kCells + column].push_back(static_cast<Id>(f));
        }
    }

    std::optional<Ray> ray(const Vec2& at) const override {
        for (const Id f : cells_[cell(at.y, film_.height) * kCells + cell(at.x, film_.width)]) {
            const Vec3 e = weights_[f].unnormalised(at.x, at.y);
            if (std::min({e.x, e.y, e.z}) >= 0) return sample_ray(mesh_, f, weights_[f], at);
        }
        return std::nullopt;
    }

    std::optional<FilmImage> place(const Vec3&, std::size_t) const override { return std::nullopt; }

    std::vector<FilmImage> places(const Vec3& point, std::size_t) const override {
        std::vector<FilmImage> places;
        for (const MeshPointImage& image : images_.images(point))
            places.push_back(
                {image.screen, image.t, interpolated_ray(mesh_, image.facet, image.weights).origin});
        return places;
    }

    double focus() const override { return 1; }

  private:
    /// Places beyond the film belong to the bucket at its border.
    static std::size_t cell(double at, double size) {
        const double share = std::floor(at / size * kCells);
        return static_cast<std::size_t>(std::clamp(share, 0.0, kCells - 1.0));
    }

    RayMesh mesh_;
    FilmSize film_;
    MeshPointImages images_;
    std::vector<FacetWeights> weights_;
    std::vector<std::vector<Id>> cells_;  // facets whose box meets the bucket, ascending
};

}  // namespace

std::shared_ptr<const CameraModel> make_ray_mesh_model(const RayMesh& mesh, const FilmSize& film) {
    return std::make_shared<RayMeshModel>(mesh, film);
}

bool is_ray_mesh_model(const CameraModel& model) {
    return dynamic_cast<const RayMeshModel*>(&model) != nullptr;
}

}  // namespace trilens
