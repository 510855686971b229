#include "trilens/render.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "image/exr_file.h"
#include "image/png_strips.h"
#include "render/frame/frame.h"
#include "render/picture/picture.h"
#include "render/project/point_projector.h"
#include "render/world/world.h"
#include "scene/data/check_scene.h"
#include "scene/data/scene_digest.h"
#include "study/checked_world.h"
#include "vector/drawing.h"

namespace trilens {
namespace {

bool is_finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_points(std::span<const Vec3> points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& p = points[i];
        if (!is_finite(p)) throw InputError("", fmt::format("points/{}", i), "is not finite");
        if (std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) > kLargestCoordinate)
            throw InputError("", fmt::format("points/{}", i),
                             "is farther away than 1e30: project its direction instead");
    }
}

}  // namespace

/// The projector of the last request: its facets and search trees serve the next call.
class Renderer::KeptProjector {
  public:
    std::shared_ptr<const PointProjector> of(const World& world, const ProjectRequest& request) {
        {
            const std::scoped_lock lock(mutex_);
            if (projector_ && request == request_) return projector_;
        }
        auto made = std::make_shared<const PointProjector>(world, request);
        const std::scoped_lock lock(mutex_);
        projector_ = made;
        request_ = request;
        return made;
    }
    void drop() {
        const std::scoped_lock lock(mutex_);
        projector_.reset();
    }

  private:
    std::mutex mutex_;
    ProjectRequest request_;
    std::shared_ptr<const PointProjector> projector_;
};

/// Who uses the world: many that draw, or one that changes it.
class Renderer::Users {
  public:
    class Use {
      public:
        Use(Users& users, bool changes) : users_(users), changes_(changes) {
            const std::scoped_lock lock(users_.mutex_);
            if (users_.changing_)
                throw UsageError(
                    "another thread changes this renderer's scene: one renderer per thread, or wait");
            if (changes_ && users_.drawing_ > 0)
                throw UsageError(
                    "another thread draws with this renderer: its scene cannot change until it is done");
            (changes_ ? users_.changing_ : users_.drawing_) += 1;
        }
        ~Use() {
            const std::scoped_lock lock(users_.mutex_);
            (changes_ ? users_.changing_ : users_.drawing_) -= 1;
        }
        Use(const Use&) = delete;
        Use& operator=(const Use&) = delete;

      private:
        Users& users_;
        bool changes_;
    };
    Use draw() { return {*this, false}; }
    Use change() { return {*this, true}; }

  private:
    std::mutex mutex_;
    int drawing_ = 0, changing_ = 0;
};

Renderer::Renderer(Scene scene, const Warn& warn)
    : world_(make_checked_world(std::move(scene), warn)),
      users_(std::make_unique<Users>()),
      projector_(std::make_unique<KeptProjector>()) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

SceneReuse Renderer::change(Scene scene, const Warn& warn) {
    check_scene(scene);
    const auto use = users_->change();
    projector_->drop();
    return change_scene(*world_, std::move(scene), warn);
}

const Scene& Renderer::scene() const {
    return world_->scene;
}

std::vector<OpticInfo> Renderer::optics() const {
    std::vector<OpticInfo> optics;
    for (const Optic& optic : world_->optics)
        optics.push_back({optic.mesh, world_->names[optic.mesh], optic.mirror, optic.resolution,
                          optic.surface->face_count()});
    return optics;
}

std::size_t Renderer::triangle_count() const {
    return world_->objects.size();
}

std::size_t Renderer::facet_count(int resolution) const {
    check_frame(*world_, {0, resolution});
    return trilens::facet_count(*world_, resolution);
}

void Renderer::check(const FrameParams& frame) const {
    check_frame(*world_, frame);
    make_camera_rays(world_->scene, frame.camera);
    check_facet_count(*world_, frame.resolution);
}

Picture Renderer::draw(const PictureRequest& request, const Progress& progress, const Warn& warn) const {
    const auto use = users_->draw();
    check_request(*world_, request);
    return draw_picture(*world_, request, progress, warn);
}

EncodedPicture Renderer::draw_exr(const PictureRequest& request, const Progress& progress,
                                  const Warn& warn) const {
    const auto use = users_->draw();
    check_request(*world_, request);
    std::optional<ExrStrips> strips;
    const StripSink sink{
        [&](const Image& layout) { strips.emplace("image", layout); },
        [&](const std::vector<Channel>& channels, int rows) { strips->add(channels, 0, rows); }};
    EncodedPicture encoded;
    encoded.picture = draw_picture(*world_, request, progress, warn, &sink);
    encoded.bytes = strips->finish();
    return encoded;
}

EncodedPicture Renderer::draw_png(const PictureRequest& request, const ToneMapping& tone,
                                  const Progress& progress, const Warn& warn) const {
    const auto use = users_->draw();
    check_request(*world_, request);
    check_tone_mapping(tone);
    std::optional<PngStrips> strips;
    const StripSink sink{
        [&](const Image& layout) { strips.emplace("PNG", layout, tone); },
        [&](const std::vector<Channel>& channels, int rows) { strips->add(channels, rows); }};
    EncodedPicture encoded;
    encoded.picture = draw_picture(*world_, request, progress, warn, &sink);
    encoded.bytes = strips->finish();
    return encoded;
}

Picture Renderer::write_exr(const std::string& file, const PictureRequest& request, const Progress& progress,
                            const Warn& warn) const {
    const auto use = users_->draw();
    check_request(*world_, request);
    std::optional<NewFile> made;
    std::optional<ExrStrips> strips;
    const StripSink sink{
        [&](const Image& layout) {
            made.emplace(file);
            strips.emplace(file, layout, [&](std::uint64_t at, std::span<const unsigned char> bytes) {
                made->write(at, bytes);
            });
        },
        [&](const std::vector<Channel>& channels, int rows) { strips->add(channels, 0, rows); }};
    Picture picture = draw_picture(*world_, request, progress, warn, &sink);
    strips->finish();
    made->commit();
    return picture;
}

PixelExplanation Renderer::explain(const PictureRequest& request, int x, int y) const {
    const auto use = users_->draw();
    check_request(*world_, request);
    return explain_pixel(*world_, request, x, y);
}

SeenTriangle Renderer::seen_triangle(const Hit& hit) const {
    const TriangleScene& objects = world_->objects;
    if (hit.triangle >= objects.size()) throw UsageError("the hit is none of this scene's");
    return {objects.object[hit.triangle], objects.primitive[hit.triangle], position(objects, hit)};
}

std::vector<PointProjection> Renderer::project(std::span<const Vec3> points, const ProjectRequest& request,
                                               const Progress& progress) const {
    const auto use = users_->draw();
    check_frame(*world_, request.frame);
    check_points(points);
    std::vector<ProjectedPoint> asked;
    for (const Vec3& point : points) asked.push_back({point});
    return project_each(*projector_->of(*world_, request), asked, progress);
}

std::vector<PointProjection> Renderer::project_directions(std::span<const Vec3> directions,
                                                          const ProjectRequest& request,
                                                          const Progress& progress) const {
    const auto use = users_->draw();
    check_frame(*world_, request.frame);
    std::vector<ProjectedPoint> asked;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        asked.push_back({normalize_or_zero(directions[i]), true});
        if (!is_finite(directions[i]) || asked.back().place == Vec3(0))
            throw InputError("", fmt::format("directions/{}", i), "is no direction");
    }
    return project_each(*projector_->of(*world_, request), asked, progress);
}

std::vector<std::optional<WorldImage>> Renderer::refine(std::span<const Vec3> points,
                                                        std::span<const ImageStart> starts,
                                                        const ProjectRequest& request) const {
    const auto use = users_->draw();
    check_frame(*world_, request.frame);
    check_points(points);
    for (std::size_t i = 0; i < starts.size(); ++i) {
        if (starts[i].point >= points.size())
            throw UsageError(
                fmt::format("start {} is of point {}, but there are {}", i, starts[i].point, points.size()));
        for (const PathEvent& event : starts[i].events)
            if (event.optic >= world_->optics.size() ||
                (event.face != kNone && event.face >= world_->optics[event.optic].surface->face_count()) ||
                !std::isfinite(event.uv.x) || !std::isfinite(event.uv.y))
                throw UsageError(fmt::format("start {} is none of this scene's optics and faces", i));
    }
    return refine_images(*world_, request, points, starts);
}

ShotRays Renderer::shoot(std::span<const Vec2> places, const ShootRequest& request) const {
    const auto use = users_->draw();
    check_frame(*world_, {request.camera});
    for (std::size_t i = 0; i < places.size(); ++i)
        if (!std::isfinite(places[i].x) || !std::isfinite(places[i].y))
            throw InputError("", fmt::format("pixels/{}", i), "is not finite");
    return shoot_places(*world_, request, places);
}

ShotRays Renderer::shoot(std::span<const Ray> rays, const ShootRequest& request) const {
    const auto use = users_->draw();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!is_finite(rays[i].origin)) throw InputError("", fmt::format("origins/{}", i), "is not finite");
        if (!is_finite(rays[i].direction) || rays[i].direction == Vec3(0))
            throw InputError("", fmt::format("directions/{}", i), "is no direction");
    }
    return shoot_rays(*world_, request, rays);
}

LineDrawing Renderer::draw_lines(const FrameParams& frame, const LineChoice& choice, const Warn& warn) const {
    const auto use = users_->draw();
    check_frame(*world_, frame);
    const std::unique_ptr<Drawing> drawing = make_drawing(*world_, frame, choice, warn);
    LineDrawing lines;
    lines.svg = drawing_svg(*drawing, *world_);
    for (const auto& layer : drawing->layers) {
        lines.curves += layer->curves.size();
        lines.folds += layer->folds.size();
        for (const EdgeCurve& curve : layer->curves) {
            lines.arcs += curve.arcs.size();
            lines.edge_lines.push_back({layer->path, layer->optic, layer->scene->object[curve.triangle],
                                        polyline_of(curve, kEdgeTolerance)});
        }
        for (const CausticSheet& sheet : layer->caustic)
            lines.caustics.push_back({layer->path, layer->optic, sheet});
        lines.fold_curves.insert(lines.fold_curves.end(), layer->folds.begin(), layer->folds.end());
    }
    lines.facet_edges = drawing->facet_edges;
    lines.marks = drawing->marks.marks.size();
    if (choice.caustics) lines.obj = drawing_obj(*drawing, *world_);
    return lines;
}

void Renderer::use_world(const std::function<void(const World&)>& work) const {
    const auto use = users_->draw();
    work(*world_);
}

std::string Renderer::digest() const {
    const auto use = users_->draw();
    return scene_digest(world_->scene);
}

}  // namespace trilens
