#include "render/project/image_light.h"

#include <algorithm>
#include <cmath>

#include "base/math/box.h"
#include "base/util/parallel.h"
#include "render/frame/camera_rays.h"
#include "scene/data/scene_digest.h"

namespace trilens {
namespace {

/// Steps to either side, relative: about the cube root of rounding, where truncation and rounding of a
/// central difference meet.
constexpr double kParameterStep = 1e-5;
/// Directions are as far away as this, in sizes of the scene, where a camera shows them directly.
constexpr double kFarInSizes = 1e6;

/// Whether a number is a length, whose steps go by the scene's size.
bool is_length(const std::string& pointer) {
    for (const char* key : {"translate", "center", "radius", "height", "size", "focalLength", "points", "eye",
                            "at", "ymag", "fit"})
        if (pointer.find(std::string("/") + key) != std::string::npos) return true;
    return false;
}

double size_of(const World& world, const Frame& frame) {
    Box box;
    for (const FramedOptic& optic : frame.optics)
        for (const Vec3& point : optic.facets->grid().points) box.include(point);
    if (frame.optics.empty())  // a frame without facets, of warm starts
        for (const Optic& optic : world.optics)
            for (Id face = 0; face < optic.surface->face_count(); ++face)
                for (const Vec2& uv : {Vec2(0), Vec2(1, 0), Vec2(0, 1)})
                    box.include(optic.surface->eval(face, uv).position);
    const double size = length(box.size());
    return size > 0 && std::isfinite(size) ? size : 1;
}

/// F of a chain at fixed places, and where the camera shows the first of them.
struct ChainState {
    PerEvent<Vec2> law;
    Vec2 pixel{0};
};

}  // namespace

/// A scene as chains depend on it.
struct ParameterDerivatives::Model {
    Scene scene;
    Camera camera;
    std::vector<std::shared_ptr<const Surface>> surfaces;
    std::vector<const Surface*> pointers;
    std::vector<Id> materials;
    std::vector<char> is_moved;  // per optic: its surface is another one than the world's

    ChainModel chain() const { return {&scene, &camera, pointers, materials}; }

    /// At the places of `events`, whose points on surfaces that are the world's are `known`.
    std::optional<ChainState> state(std::span<const PathEvent> events, std::span<const EventMedia> media,
                                    const ProjectedPoint& point, std::span<const SurfacePoint> known,
                                    const Vec2& near) const {
        const std::optional<PathChain> chain = make_chain(this->chain(), events, media, point);
        if (!chain) return std::nullopt;
        std::vector<SurfacePoint> points(known.begin(), known.end());
        for (std::size_t i = 0; i < events.size(); ++i)
            if (is_moved[events[i].optic])
                points[i] = pointers[events[i].optic]->eval_first_order(events[i].face, events[i].uv);
        const std::optional<Vec2> pixel = film_pixel(camera, points.front().position, near);
        if (!pixel) return std::nullopt;
        return ChainState{chain_law(chain_bend(*chain, points), points), *pixel};
    }
};

ParameterDerivatives::ParameterDerivatives(const World& world, const Frame& frame, std::size_t camera,
                                           std::span<const std::string> pointers)
    : world_(world),
      camera_media_(frame.camera_media),
      numbers_(find_numbers(world.scene, pointers)),
      now_(std::make_unique<Model>()),
      size_(size_of(world, frame)) {
    std::vector<std::string> digests;
    now_->camera = frame.camera;
    now_->scene = world.scene;
    for (const Optic& optic : world.optics) {
        digests.push_back(mesh_digest(world.scene.meshes[optic.mesh]));
        now_->surfaces.push_back(optic.surface);
        now_->pointers.push_back(optic.surface.get());
        now_->materials.push_back(optic.material);
        now_->is_moved.push_back(false);
    }
    const auto model_at = [&](SceneNumber number, double value) {
        number.value = value;
        auto model = std::make_unique<Model>();
        model->scene = scene_with(world.scene, number);
        model->camera = make_camera_rays(model->scene, camera);
        model->materials = now_->materials;
        for (std::size_t i = 0; i < world.optics.size(); ++i) {
            const Id mesh = world.optics[i].mesh;
            model->is_moved.push_back(mesh_digest(model->scene.meshes[mesh]) != digests[i]);
            model->surfaces.push_back(model->is_moved[i] ? make_optic_surface(model->scene, mesh, {})
                                                         : world.optics[i].surface);
            model->pointers.push_back(model->surfaces[i].get());
        }
        return model;
    };
    steps_.resize(numbers_.size());
    parallel_for(numbers_.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n) {
            const SceneNumber& number = numbers_[n];
            const double usual = is_length(number.pointer) ? size_ : 1;
            const double step = kParameterStep * std::max(std::fabs(number.value), usual);
            const double after = number.value + step, before = number.value - step;
            steps_[n] = {model_at(number, before), model_at(number, after), after - before};
        }
    });
}

ParameterDerivatives::~ParameterDerivatives() = default;

std::vector<Vec2> ParameterDerivatives::of(const WorldImage& image, const ProjectedPoint& point) const {
    if (image.path == Path::kDirect) return of_direct(image.pixel, point);
    return image.events.empty() ? std::vector<Vec2>() : of_chain(image, point);
}

std::vector<Vec2> ParameterDerivatives::of_direct(const Vec2& pixel, const ProjectedPoint& point) const {
    const auto shown = [&](const Model& model) -> std::optional<Vec2> {
        if (!point.is_direction) return film_pixel(model.camera, point.place, pixel);
        const std::optional<ChainEnd> eye = chain_eye(model.camera);
        if (!eye || eye->is_direction) return std::nullopt;
        return film_pixel(model.camera, eye->place + kFarInSizes * size_ * point.place, pixel);
    };
    std::vector<Vec2> moved;
    for (const Step& step : steps_) {
        const auto before = shown(*step.before), after = shown(*step.after);
        if (!before || !after) return {};
        moved.push_back((*after - *before) / step.size);
    }
    return moved;
}

std::vector<Vec2> ParameterDerivatives::of_chain(const WorldImage& image, const ProjectedPoint& point) const {
    const std::span<const PathEvent> events = image.events;
    Media around;
    if (!camera_media_.none()) {
        const std::optional<Ray> view = exact_ray(now_->camera, image.pixel);
        if (!view) return {};
        around = camera_media_.of(*view);
    }
    const auto media = event_media(world_, around, events);
    const auto chain = media ? make_chain(now_->chain(), events, *media, point) : std::nullopt;
    if (!chain) return {};
    std::vector<SurfacePoint> points;
    for (const PathEvent& event : events)
        points.push_back(now_->pointers[event.optic]->eval(event.face, event.uv));
    const std::optional<FilmPlace> film = film_place(now_->camera, points.front().position, image.pixel);
    if (!film) return {};
    const PathSensitivity sensitivity(*chain, points, film->slope);
    if (!sensitivity.is_regular()) return {};

    std::vector<Vec2> moved;
    for (const Step& step : steps_) {
        const auto before = step.before->state(events, *media, point, points, image.pixel),
                   after = step.after->state(events, *media, point, points, image.pixel);
        if (!before || !after) return {};
        PerEvent<Vec2> law = after->law;
        for (std::size_t i = 0; i < events.size(); ++i) law[i] -= before->law[i];
        moved.push_back(sensitivity.moved(after->pixel - before->pixel, law) / step.size);
    }
    return moved;
}

}  // namespace trilens
