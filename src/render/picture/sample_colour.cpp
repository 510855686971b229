#include "render/picture/sample_colour.h"

#include <array>

#include "render/frame/camera_media.h"

namespace trilens {
namespace {

/// Rays of several samples, shaded together: what each adds to its sample.
class Contributions {
  public:
    Contributions(const World& world, const SampleViews& views, std::size_t first,
                  std::span<SampleColour> colours)
        : world_(world), views_(views), first_(first), colours_(colours) {}

    void add_sample(std::size_t index);
    void shade();

  private:
    static constexpr std::size_t kMost = 2 * Segments::kMost;

    struct Contribution {
        std::size_t index = 0;         // of colours_
        Vec3 weight{0};                // of its light
        const PathEnd* end = nullptr;  // null: what the camera sees itself
    };

    void add(const SeenAlong& seen, const Contribution& contribution) {
        if (count_ == kMost) shade();
        seen_[count_] = seen;
        contributions_[count_++] = contribution;
    }

    const World& world_;
    const SampleViews& views_;
    std::size_t first_;
    std::span<SampleColour> colours_;
    std::size_t count_ = 0;
    std::array<SeenAlong, kMost> seen_;
    std::array<Contribution, kMost> contributions_;
};

void Contributions::add_sample(std::size_t index) {
    const SampleView& view = views_.samples[first_ + index];
    SampleColour& colour = colours_[index];
    colour = {};
    if (view.ray.direction == Vec3(0)) return;  // the camera has no ray there
    colour.coverage = view.hit.seen() || view.optic != kNone ? 1 : 0;
    if (view.optic == kNone) {
        if (world_.scene.render.direct)
            add({&view.hit, &view.ray}, {index, light_of_view(world_, views_, view), nullptr});
        return;
    }
    const OpticWeights weights = first_weights(world_, views_, view);
    for (const PathEnd& end : views_.ends_of(view)) {
        const Vec3 weight = (end.path == Path::kReflect ? weights.reflect : weights.refract) * end.weight;
        if (weight != Vec3(0)) add({&end.hit, &end.ray}, {index, weight, &end});
    }
}

/// Adds what has come together to its samples, in the order in which it came.
void Contributions::shade() {
    std::array<Vec3, kMost> light;
    shade_rays(world_.shading, std::span(seen_).first(count_), std::span(light).first(count_));
    for (std::size_t i = 0; i < count_; ++i) {
        const auto& [index, weight, end] = contributions_[i];
        SampleColour& colour = colours_[index];
        if (!end) {
            colour.direct += weight * light[i];
            continue;
        }
        if (end->medium != kNone && end->hit.seen())
            light[i] *= volume_transmittance(world_.scene.materials[world_.optics[end->medium].material],
                                             path_length(*end));
        (end->path == Path::kReflect ? colour.reflect : colour.refract) += weight * light[i];
    }
    count_ = 0;
}

}  // namespace

double path_length(const PathEnd& end) {
    return end.hit.t * length(end.ray.direction);
}

void sample_colours(const World& world, const SampleViews& views, std::size_t first,
                    std::span<SampleColour> colours) {
    Contributions contributions(world, views, first, colours);
    for (std::size_t i = 0; i < colours.size(); ++i) contributions.add_sample(i);
    contributions.shade();
}

SampleColour sample_colour(const World& world, const SampleViews& views, const SampleView& view) {
    SampleColour colour;
    sample_colours(world, views, static_cast<std::size_t>(&view - views.samples.data()), {&colour, 1});
    return colour;
}

}  // namespace trilens
