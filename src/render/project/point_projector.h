// The images of points, one after the other: direct, over one optic, over several.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "render/frame/frame.h"
#include "render/project/image_light.h"
#include "render/project/path_images.h"
#include "render/project/project.h"
#include "specular/specular_search.h"

namespace trilens {

/// One path over one optic, ready to image points.
struct OpticPath {
    Path path = Path::kReflect;
    Id optic = kNone;
    std::unique_ptr<FacetImages> facets;
};

/// Projects points of one world into one camera. Thread-safe to read; the world must live longer.
class PointProjector {
  public:
    PointProjector(const World& world, const ProjectRequest& request);

    const CameraRays& camera() const { return camera_; }

    /// Adds to result[p] the images of points[p], for each p of `some`; points that lie close together take
    /// less time.
    void project(std::span<const ProjectedPoint> points, std::span<const std::size_t> some,
                 std::span<PointProjection> result) const;

  private:
    Occluder what_hides(std::size_t index) const;
    void add_optic(std::size_t index);
    void add_direct(const ProjectedPoint& point, PointProjection& result) const;
    void add_camera_mesh(const Vec3& point, PointProjection& result) const;
    void add_optic_path(const OpticPath& path, const Vec3& point, const SpecularSearch& searched,
                        PointProjection& result) const;
    bool leads_towards(const Ray& view, const OpticPath& path, const Vec3& point) const;
    void add_several(const SeveralOpticsImages& several, const Vec3& point, PointProjection& result) const;
    void differentiate(WorldImage& image, const ProjectedPoint& point) const;
    void solve_derivative(WorldImage& image, const ProjectedPoint& point) const;
    Vec3 within_reach(const ProjectedPoint& point) const;
    std::optional<ChainImage> moved_image(const WorldImage& image, const ProjectedPoint& point) const;
    void move_to(const ProjectedPoint& point, PointProjection& result) const;
    bool may_have_several() const;
    void keep_strongest(PointProjection& result) const;
    std::vector<SpecularSearch> search(const OpticPath& path, std::span<const Vec3> points,
                                       const SearchLimits& limits) const;
    std::vector<OpticImage> optic_images(const OpticPath& path, const Vec3& point,
                                         const SpecularSearch& searched, PointProjection& result) const;
    void refine_on_film(const OpticPath& path, const Vec3& point, std::vector<OpticImage>& images) const;
    std::vector<OpticImage> images_on_film(const OpticPath& path, const SpecularSearch& searched) const;
    bool is_between_planes(double t) const { return t >= camera_.near_depth && t <= camera_.far_depth; }
    bool on_film(const Vec2& pixel) const;
    bool asks_what_hides(const WorldImage& image) const {
        return request_.visibility && (image.inside || request_.visible_at_optics);
    }
    /// Whether objects leave the way free from the last optic, or the eye, to the point.
    bool is_free_beyond(const Vec3& from, const Vec3& point) const {
        return request_.visible_at_optics || sight_.is_free_of_objects(from, point);
    }
    /// Whether images are looked for on the exact surfaces: where the camera's law is that of one eye, or of
    /// parallel rays.
    bool searches_surfaces() const {
        return request_.search == ImageSearch::kComplete &&
               (camera_.linear || (camera_.model && camera_.model->eye()));
    }

    /// Whether images over one optic are looked for on the film, as those over several are: through a camera
    /// without one eye, whose facets on the optic's own grid may mix several of its branches.
    bool searches_film() const {
        return camera_.model && !camera_.model->eye() &&
               (request_.refine || is_ray_mesh_model(*camera_.model));
    }

    const World& world_;
    ProjectRequest request_;
    Frame frame_;
    const CameraRays& camera_ = frame_.camera;
    const OcclusionQueries sight_;
    std::unique_ptr<MeshPointImages> camera_mesh_;             // of a camera that is not linear
    std::vector<std::unique_ptr<SpecularSearcher>> searcher_;  // per optic; kComplete
    std::vector<FacetLookup> facets_at_;                       // per optic; kComplete
    std::vector<OpticPath> paths_;
    std::vector<std::unique_ptr<SeveralOpticsImages>> several_;  // per optic, where paths go on
    std::unique_ptr<ParameterDerivatives> parameters_;           // where some are asked for
    bool may_have_several_ = false;
    Vec3 middle_{0};    // of the optics and the eye
    double reach_ = 0;  // points farther from the middle are searched for there
};

/// The images of all points by one projector, on all threads. Throws Interrupted once `progress` says so.
std::vector<PointProjection> project_each(const PointProjector& projector,
                                          std::span<const ProjectedPoint> points,
                                          const Progress& progress = {});

}  // namespace trilens
