#include "render/frame/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/math/box.h"
#include "base/util/parallel.h"
#include "paths/trace/path_world.h"
#include "render/world/world.h"
#include "surfaces/surfaces.h"
#include "trilinear/points/point_images.h"

namespace trilens {

namespace {

/// Boxes come from grids of about so many facets, widened by this share of their sides for what lies between.
constexpr double kBoxFacets = 20'000, kWider = 0.25;
constexpr int kFinestForBox = 8;

bool holds(const Box& box, const Vec3& p) {
    for (int k = 0; k < 3; ++k)
        if (!(box.low[k] <= p[k] && p[k] <= box.high[k])) return false;
    return true;
}

}  // namespace

std::vector<Vec3> outline_of(const Surface& surface) {
    const double per_face =
        kBoxFacets / (2.0 * static_cast<double>(std::max<std::size_t>(1, surface.face_count())));
    const int n = std::clamp(static_cast<int>(std::sqrt(per_face)), 1, kFinestForBox);
    return make_grid(surface, n).points;
}

Box box_around(std::span<const Vec3> outline) {
    Box box;
    for (const Vec3& point : outline) box.include(point);
    const Vec3 margin = kWider * box.size();
    return {box.low - margin, box.high + margin};
}

std::optional<Vec3> eye_of(const CameraRays& camera) {
    if (camera.linear) {
        if (camera.linear->parallel || camera.near_depth > 0) return std::nullopt;
        return camera.linear->eye;
    }
    const std::optional<Vec3> eye = camera.model ? camera.model->eye() : std::nullopt;
    const std::optional<Ray> middle =
        eye ? camera.model->ray(0.5 * Vec2(camera.film.width, camera.film.height)) : std::nullopt;
    return middle && middle->origin == *eye ? eye : std::nullopt;
}

namespace {

Id active(const World& world, const Media& media) {
    return media.active([&](Id optic) { return world.scene.meshes[world.optics[optic].mesh].priority; });
}

}  // namespace

Media CameraMedia::of(const Ray& ray) const {
    if (!by_ray) return fixed;
    std::vector<Id> asked;
    for (std::size_t i = 0; i < near.size(); ++i)
        if (holds(boxes[i], ray.origin)) asked.push_back(near[i]);
    if (asked.empty()) return {};
    return bodies_along(leaves, asked, {ray.origin, normalize_or_zero(ray.direction)});
}

namespace {

std::vector<GlassBody> glass_bodies(const World& world) {
    std::vector<GlassBody> bodies;
    for (std::size_t i = 0; i < world.optics.size(); ++i)
        if (!world.optics[i].mirror)
            bodies.push_back({static_cast<Id>(i), box_around(outline_of(*world.optics[i].surface))});
    return bodies;
}

LeavesBody leaving_optics(const World& world) {
    return [&world](Id optic, const Ray& ray) {
        return leaves_at(limit_tracer(world, optic).first_hit(ray), ray);
    };
}

}  // namespace

CameraMedia camera_media_of(std::span<const GlassBody> bodies, const LeavesBody& leaves,
                            const CameraRays& camera) {
    CameraMedia around;
    const std::optional<Vec3> eye = eye_of(camera);
    for (const GlassBody& body : bodies) {
        if (eye && !holds(body.box, *eye)) continue;
        around.near.push_back(body.optic);
        around.boxes.push_back(body.box);
    }
    if (around.near.empty()) return around;
    if (!eye) {
        around.leaves = leaves;
        around.by_ray = true;
        return around;
    }
    EnclosingBodies found = enclosing_bodies(leaves, around.near, *eye);
    around.fixed = found.media;
    if (bodies.size() > 1) around.unsure = std::move(found.unsure);
    return around;
}

CameraMedia camera_media_of(const World& world, const CameraRays& camera) {
    return camera_media_of(glass_bodies(world), leaving_optics(world), camera);
}

CameraMedia media_by_ray(const World& world) {
    CameraMedia around;
    around.leaves = leaving_optics(world);
    around.by_ray = true;
    for (const GlassBody& body : glass_bodies(world)) {
        around.near.push_back(body.optic);
        around.boxes.push_back(body.box);
    }
    return around;
}

void warn_of_unsure_media(const CameraMedia& around, const std::function<std::string(Id optic)>& name,
                          const Warn& warn) {
    if (!warn) return;
    for (const Id optic : around.unsure)
        warn("the camera is inside of " + name(optic) +
             " in some directions only, for that is no closed surface or is inside out; it is taken to be " +
             (around.fixed.holds(optic) ? "inside" : "outside"));
}

void warn_of_unsure_media(const World& world, const CameraMedia& around, const Warn& warn) {
    warn_of_unsure_media(
        around, [&world](Id optic) { return world.names[world.optics[optic].mesh]; }, warn);
}

void set_initial_media(const CameraMedia& around, SampleViews& views) {
    if (around.none()) return;
    if (!around.by_ray) {
        views.around = {around.fixed};
        for (SampleView& view : views.samples) view.around = 0;
        return;
    }
    std::vector<Media> found(views.samples.size());
    parallel_for(found.size(), 256, [&](std::size_t from, std::size_t to) {
        for (std::size_t s = from; s < to; ++s)
            if (views.samples[s].ray.direction != Vec3(0)) found[s] = around.of(views.samples[s].ray);
    });
    for (std::size_t s = 0; s < found.size(); ++s) {
        if (found[s].count == 0) continue;
        views.samples[s].around = static_cast<Id>(views.around.size());
        views.around.push_back(found[s]);
    }
}

Vec3 light_of_view(const World& world, const SampleViews& views, const SampleView& view) {
    if (view.around == kNone) return Vec3(1);
    const Material* glass = glass_around(world, views.around_of(view));
    if (view.optic != kNone) return volume_transmittance(*glass, views.on_optic(view).way);
    return view.hit.seen() ? volume_transmittance(*glass, view.hit.t * length(view.ray.direction)) : Vec3(1);
}

const Material* glass_around(const World& world, const Media& around) {
    return glass_of(world, active(world, around));
}

GlassInterface interface_of(const World& world, Id optic, const Media& around, bool front) {
    const Material* own = glass_of(world, optic);
    const Vec3& tint = own->base_color_factor;
    if (around.count == 0) return {front ? nullptr : own, front ? own : nullptr, tint};
    const std::optional<MediaSides> sides = sides_of(around, optic, front);
    if (!sides) return {own, own, tint};  // light lost: nothing is drawn there
    return {glass_of(world, active(world, sides->before)), glass_of(world, active(world, sides->after)),
            tint};
}

OpticWeights first_weights(const World& world, const SampleViews& views, const SampleView& view) {
    const bool fresnel = world.scene.render.fresnel;
    const Material& material = *glass_of(world, view.optic);
    const Incidence& incidence = views.on_optic(view).incidence;
    if (view.around == kNone) return optic_weights(material, incidence, fresnel);
    OpticWeights weights =
        world.optics[view.optic].mirror
            ? optic_weights(material, incidence, fresnel)
            : interface_weights(interface_of(world, view.optic, views.around_of(view), incidence.front),
                                incidence.cosine, fresnel);
    const Vec3 light = light_of_view(world, views, view);
    weights.reflect *= light;
    weights.refract *= light;
    return weights;
}

double relative_ior(const World& world, std::size_t optic, const Media& around) {
    const Id own = static_cast<Id>(optic);
    const bool front = !around.holds(own);
    const double eta = eta_of(interface_of(world, own, around, front), -1);
    return front ? 1 / eta : eta;
}

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

void count_from_eye(const CameraRays& camera, SampleViews& views) {
    views.depth_by_length = camera.axis == Vec3(0);
    if (camera.near_depth == 0) return;
    for (SampleView& view : views.samples)
        if (view.hit.seen() || view.optic != kNone) view.depth += camera.near_depth;
}

void count_traced_from_eye(const CameraRays& camera, const SampleGrid& grid, std::span<const Id> samples,
                           std::span<SampleView> views) {
    for (const Id s : samples) {
        SampleView& view = views[s];
        if (!view.hit.seen() && view.optic == kNone) continue;
        if (const auto own = camera.linear ? std::nullopt : exact_ray(camera, grid.position(s)))
            view.depth *= length(view.ray.direction) / length(own->direction);
        view.depth += camera.near_depth;
    }
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
