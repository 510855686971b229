#include "view/paths.h"

#include <trilens/camera.h>

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

std::string word_of(std::span<const Step> steps) {
    std::string word;
    for (const Step& step : steps)
        if (step.event != Event::kPass) word += step.event == Event::kReflect ? 'R' : 'T';
    return word;
}

/// The glass behind each event: bodies are entered at their fronts and left at their backs.
class Media {
  public:
    Id after(const PathEvent& event) {
        if (event.event == Event::kReflect) return current();
        if (event.front)
            inside_.push_back(event.optic);
        else
            std::erase(inside_, event.optic);
        return current();
    }
    Id current() const { return inside_.empty() ? kNone : inside_.back(); }

  private:
    std::vector<Id> inside_;
};

std::vector<PathCorner> event_corners(const Renderer& renderer, const Vec3& eye,
                                      std::span<const PathEvent> events) {
    const std::vector<OpticInfo> optics = renderer.optics();
    std::vector<PathCorner> corners{{eye, "eye", "", kNone}};
    Media media;
    for (const PathEvent& event : events) {
        const Id medium = media.after(event);
        corners.push_back({event.point, event_name(event.event),
                           event.optic < optics.size() ? optics[event.optic].name : "", medium});
    }
    return corners;
}

PathLine line_of(const Renderer& renderer, const ShotRays& shots, const Vec3& eye, double reach) {
    const ShotRay& ray = shots.rays.at(0);
    PathLine line;
    line.weight = ray.weight;
    line.corners = event_corners(renderer, eye, shots.events_of(ray));
    for (const PathEvent& event : shots.events_of(ray))
        if (event.event != Event::kPass) line.word += event.event == Event::kReflect ? 'R' : 'T';
    if (ray.state == ShotState::kSeen)
        line.corners.push_back({ray.position, "seen", renderer.scene().meshes.at(ray.object).name, kNone});
    else
        line.corners.push_back({ray.origin + reach * ray.direction, "escapes", "", kNone});
    return line;
}

}  // namespace

std::vector<PathLine> pixel_paths(const Renderer& renderer, const PictureRequest& request, const Vec2& pixel,
                                  double reach) {
    const PixelExplanation explained = renderer.explain(request, static_cast<int>(std::floor(pixel.x)),
                                                        static_cast<int>(std::floor(pixel.y)));
    // The explanation is of the pixel's centre.
    const Vec2 place{std::floor(pixel.x) + 0.5, std::floor(pixel.y) + 0.5};
    std::vector<std::string> words;
    if (explained.ends.empty()) words.emplace_back();
    for (const bool principal : {true, false})
        for (const PixelEnd& end : explained.ends)
            if (end.principal == principal) {
                const std::string word = word_of(end.steps);
                if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
            }
    std::vector<PathLine> lines;
    for (const std::string& word : words) {
        ShootRequest shoot{request.frame.camera, {}};
        if (!word.empty()) shoot.path = EventWord(word);
        const ShotRays shots = renderer.shoot(std::span(&place, 1), shoot);
        // Facets may show ways that the exact surfaces do not have there.
        if (shots.rays.at(0).followed())
            lines.push_back(line_of(renderer, shots, explained.ray.origin, reach));
    }
    return lines;
}

PlaceImages place_images(const Renderer& renderer, const FrameParams& frame, const Vec3& place) {
    ProjectRequest request;
    request.frame = frame;
    request.frame.facets = FacetUse::kAll;  // an image is in whatever facet it is
    const PointProjection found = renderer.project(std::span(&place, 1), request).at(0);
    const Scene& scene = renderer.scene();
    const Camera camera =
        make_camera(scene.cameras.at(frame.camera),
                    {static_cast<double>(scene.film.width), static_cast<double>(scene.film.height)});
    PlaceImages images{place, found.complete, {}};
    for (const WorldImage& one : found.images) {
        if (!one.inside) continue;
        PlaceImage image{one.pixel, one.visible, {}};
        image.line.weight = one.weight;
        image.line.word = word_of(one.steps);
        if (const auto ray = exact_ray(camera, one.pixel)) {
            image.line.corners = event_corners(renderer, ray->origin, one.events);
            image.line.corners.push_back({place, "seen", "", kNone});
        }
        images.images.push_back(std::move(image));
    }
    return images;
}

std::optional<Vec3> shown_place(const Renderer& renderer, std::size_t camera, const Vec2& pixel) {
    const ShotRays shots = renderer.shoot(std::span(&pixel, 1), {camera, {}});
    if (shots.rays.at(0).state != ShotState::kSeen) return std::nullopt;
    return shots.rays.at(0).position;
}

}  // namespace trilens
