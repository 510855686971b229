#include "render/picture/sample_colour.h"

#include <array>

#include "render/picture/ray_differentials.h"

namespace trilens {
namespace {

/// The sides of what a ray stands for on the plane of the triangle that it sees.
std::array<Vec3, 2> footprint_of(const TriangleScene& scene, const SeenAlong& seen,
                                 const RayDifferential& differential) {
    const IdTriple& corner = scene.triangles[seen.hit->triangle];
    const Vec3& a = scene.points[corner[0]];
    const Vec3 normal = cross(scene.points[corner[1]] - a, scene.points[corner[2]] - a);
    const double along = dot(normal, seen.ray->direction);
    std::array<Vec3, 2> sides;
    for (std::size_t k = 0; k < 2; ++k) {
        const Vec3 moved = differential.origin[k] + seen.hit->t * differential.direction[k];
        sides[k] = moved - dot(normal, moved) / along * seen.ray->direction;
    }
    return sides;
}

/// Rays of several samples, shaded together: what each adds to its sample.
class Contributions {
  public:
    Contributions(const World& world, const SampleViews& views, std::size_t first,
                  std::span<SampleColour> colours, const RayDifferentials* differentials)
        : world_(world), views_(views), first_(first), colours_(colours), differentials_(differentials) {}

    void add_sample(std::size_t index);
    void shade();

  private:
    static constexpr std::size_t kMost = 2 * Segments::kMost;

    const World& world_;
    const SampleViews& views_;
    std::size_t first_;
    std::span<SampleColour> colours_;
    const RayDifferentials* differentials_;
    std::size_t count_ = 0;
    std::array<SeenAlong, kMost> seen_;
    std::array<Contribution, kMost> contributions_;
    std::array<RayDifferential, kMost> differential_;   // where textures are averaged
    std::array<std::array<Vec3, 2>, kMost> footprint_;  // where caustics are
    std::array<std::size_t, kMost> sample_;             // of colours_
};

void Contributions::add_sample(std::size_t index) {
    const SampleView& view = views_.samples[first_ + index];
    colours_[index] = unlit_colour(view);
    for_each_contribution(world_, views_, view, [&](const Contribution& contribution) {
        if (count_ == kMost) shade();
        seen_[count_] = contribution.seen;
        const Hit& hit = *contribution.seen.hit;
        const bool textured = has_texture(world_.shading, hit), lit = world_.shading.caustic && hit.seen();
        if (differentials_ && (textured || lit))
            if (const auto differential = differentials_->of(views_, first_ + index, contribution)) {
                differential_[count_] = *differential;
                if (textured) seen_[count_].differential = &differential_[count_];
                if (lit) {
                    footprint_[count_] = footprint_of(world_.objects, contribution.seen, *differential);
                    seen_[count_].footprint = &footprint_[count_];
                }
            }
        sample_[count_] = index;
        contributions_[count_++] = contribution;
    });
}

/// Adds what has come together to its samples, in the order in which it came.
void Contributions::shade() {
    std::array<Vec3, kMost> light;
    shade_rays(world_.shading, std::span(seen_).first(count_), std::span(light).first(count_));
    for (std::size_t i = 0; i < count_; ++i)
        add_light(world_, contributions_[i], light[i], colours_[sample_[i]]);
    count_ = 0;
}

}  // namespace

SampleColour unlit_colour(const SampleView& view) {
    SampleColour colour;
    if (view.ray.direction != Vec3(0)) colour.coverage = view.hit.seen() || view.optic != kNone ? 1 : 0;
    return colour;
}

void add_light(const World& world, const Contribution& from, Vec3 light, SampleColour& colour) {
    const PathEnd* end = from.end;
    if (!end) {
        colour.direct += from.weight * light;
        return;
    }
    if (end->medium != kNone && end->hit.seen())
        light *= volume_transmittance(world.scene.materials[world.optics[end->medium].material],
                                      from.mean_length.value_or(path_length(*end)));
    (end->path == Path::kReflect ? colour.reflect : colour.refract) += from.weight * light;
}

double path_length(const PathEnd& end) {
    return end.hit.t * length(end.ray.direction);
}

void sample_colours(const World& world, const SampleViews& views, std::size_t first,
                    std::span<SampleColour> colours, const RayDifferentials* differentials) {
    Contributions contributions(world, views, first, colours, differentials);
    for (std::size_t i = 0; i < colours.size(); ++i) contributions.add_sample(i);
    contributions.shade();
}

SampleColour sample_colour(const World& world, const SampleViews& views, const SampleView& view,
                           const RayDifferentials* differentials) {
    SampleColour colour;
    sample_colours(world, views, static_cast<std::size_t>(&view - views.samples.data()), {&colour, 1},
                   differentials);
    return colour;
}

}  // namespace trilens
