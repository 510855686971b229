#include "render/picture/fragments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/picture/rough_light.h"
#include "render/picture/sample_colour.h"
#include "render/picture/spread_contribution.h"

namespace trilens {
namespace {

constexpr std::size_t kMostShaded = Segments::kMost;
constexpr std::size_t kCorners = SpreadContribution::kCorners;
// Of the light at the shaded point: how far that at the outermost samples may be off in the mean, where
// samples are not lit one by one, and, of whole pixels, not in blocks either.
constexpr double kWholeRoom = 0.25, kPartRoom = 0.05, kBlockRoom = 0.06;
// How far that at one of them may be off, as a share of the larger of both.
constexpr double kWholeStep = 0.5, kPartStep = 0.2, kBlockStep = 0.2;
// Shaded sample by sample: surfaces of less roughness, whose highlights are small, and those whose bumps
// inside a fragment make up for more of it, which one wider lobe shows in the wrong places.
constexpr double kPolished = 0.3, kWidened = 0.05;
// So many samples are lit at no more places than the shaded point and the outermost of them.
constexpr std::size_t kFewSamples = kCorners + 1;

/// Contributions of several fragments, shaded together.
class FragmentContributions {
  public:
    explicit FragmentContributions(const FragmentShading& shading) : shading_(shading) {
        waiting_.reserve(kMostShaded);
        at_corners_.resize(kMostShaded * kCorners);
    }

    void add(const SpreadContribution& contribution, ShadedFragment& shaded) {
        waiting_.push_back(contribution);
        shaded_[waiting_.size() - 1] = &shaded;
        if (waiting_.size() == kMostShaded) shade();
    }
    void shade();

  private:
    bool is_few(const SpreadContribution& one) const {
        return is_spread(one) && one.sample_count() <= kFewSamples && !shading_.world.shading.caustic;
    }
    void shade_few(std::span<Vec3> light) const;
    void shade_at_points(std::span<Vec3> light);
    bool is_spread(const SpreadContribution& one) const {
        const Hit& hit = *one.contribution().seen.hit;
        return hit.seen() && !one.corners().empty() && is_lit(shading_.world.shading, hit);
    }
    void find_light_at_corners(std::span<const std::size_t> points);
    /// What is known of a fragment's light, and what its pictures show.
    struct KnownLight {
        const ReachingLight& centre;
        std::span<const ReachingLight> at_corners;
        const MapTexels& texels;
    };
    void even_out_one(std::size_t i, const KnownLight& known, Vec3& light);
    Vec3 mean_of_parts(std::span<const SpreadContribution::Part> parts,
                       std::span<const ReachingLight> at_corners) const;

    const FragmentShading& shading_;
    std::vector<SpreadContribution> waiting_;
    std::array<ShadedFragment*, kMostShaded> shaded_{};
    std::vector<ReachingLight> at_corners_;  // of the points at hand, one after the other
};

/// What a surface makes of light, that it does not emit itself: of a matt one without its colour.
Vec3 arriving(SurfaceLook look, const ArrivedLight& arrived) {
    if (look.is_matt()) return arrived.matt;
    look.emissive = Vec3(0);
    return outgoing_radiance(look, arrived);
}

SeenAlong along(const SpreadContribution::Part& part) {
    SeenAlong seen{&part.there.hit, &part.there.ray, &part.texels};
    seen.without_caustics = true;
    return seen;
}

/// The mean over a pixel's samples of a function that is quadratic, less its value at the centre, as a share
/// of the mean over the four samples at the corners less that.
double corner_share(int side) {
    return (side + 1.0) / (3.0 * (side - 1));
}

/// The light at all corners of those of `points` that are lit.
void FragmentContributions::find_light_at_corners(std::span<const std::size_t> points) {
    std::array<SeenAlong, kMostShaded * kCorners> corners;
    std::vector<MapTexels> texels;  // where pictures say how light comes; stay in place
    std::size_t count = 0;
    for (const std::size_t i : points) {
        const SpreadContribution& one = waiting_[i];
        if (!is_spread(one)) continue;
        const bool has_maps = has_light_maps(shading_.world.shading, *one.contribution().seen.hit);
        if (has_maps) texels.reserve(corners.size());
        for (std::size_t k = 0; k < one.corners().size(); ++k) {
            const SeenThere& corner = one.corners()[k];
            corners[count] = {&corner.hit, &corner.ray};
            if (has_maps)
                corners[count].texels = &texels.emplace_back(one.sample_texels(corner, one.corner_place(k)));
            corners[count++].without_caustics = true;
        }
    }
    find_reaching_light(shading_.world.shading, std::span(corners).first(count),
                        std::span(at_corners_).first(count));
}

/// Whether a surface's highlights are too small for one point of a fragment, or those of its bumps too many.
bool has_small_highlights(const ShadeScene& scene, const Hit& hit, const MapTexels& texels) {
    const SurfaceLook look = look_at(scene, hit, texels);
    if (look.is_matt()) return false;
    MapTexels even = texels;
    even.normal_length = 1;
    const double own = texels.normal_length < 1 ? look_at(scene, hit, even).roughness : look.roughness;
    return own < kPolished || look.roughness > own + kWidened;
}

/// Samples are lit one by one where other lights of one sample reach the outermost than the shaded point, or
/// light changes by more than a mean can tell; in blocks where it changes by less.
void FragmentContributions::even_out_one(std::size_t i, const KnownLight& known, Vec3& light) {
    const SpreadContribution& contribution = waiting_[i];
    const Hit& hit = *contribution.contribution().seen.hit;
    const SurfaceLook look = look_at(shading_.world.shading, hit, known.texels);
    const std::span<const std::uint8_t> numbers = contribution.corner_numbers();
    bool by_sample = has_small_highlights(shading_.world.shading, hit, known.texels);
    const Vec3 here = arriving(look, known.centre.arrived);
    Vec3 mean(0);
    double step = 0;
    for (const std::size_t number : numbers) {
        const ReachingLight& at = known.at_corners[number];
        by_sample = by_sample || at.lights != known.centre.lights;
        const Vec3 there = arriving(look, at.arrived), most = glm::max(here, there);
        mean += there / double(numbers.size());
        for (int k = 0; k < 3; ++k)
            if (most[k] > 0) step = std::max(step, std::fabs(there[k] - here[k]) / most[k]);
    }
    const bool whole = contribution.is_whole_pixel();
    const Vec3 off = mean - here;
    const auto is_beyond = [&](double room, double most_step) {
        return step > most_step || of_worst_colour(glm::abs(off) - room * here) > 0;
    };
    by_sample = by_sample || (whole ? is_beyond(kWholeRoom, kWholeStep) : is_beyond(kPartRoom, kPartStep));
    const bool has_blocks = whole && shading_.side > 2 && shading_.side % 2 == 0;
    if (by_sample || (has_blocks && is_beyond(kBlockRoom, kBlockStep))) {
        const std::vector<SpreadContribution::Part> parts =
            contribution.parts(by_sample ? 1 : 2, known.texels);
        if (!parts.empty()) light = mean_of_parts(parts, known.at_corners);
        shaded_[i]->rays_by_sample += by_sample;
    } else if (whole && numbers.size() == kCorners) {
        for (int k = 0; k < 3; ++k)
            if (here[k] > 0)
                light[k] = look.emissive[k] + (light[k] - look.emissive[k]) *
                                                  (1 + corner_share(shading_.side) * off[k] / here[k]);
    }
}

/// The mean of what its parts show, each lit by itself; where one is a corner, its light is known.
Vec3 FragmentContributions::mean_of_parts(std::span<const SpreadContribution::Part> parts,
                                          std::span<const ReachingLight> at_corners) const {
    const ShadeScene& scene = shading_.world.shading;
    std::vector<SeenAlong> seen;
    for (const SpreadContribution::Part& part : parts)
        if (part.corner == kCorners) seen.push_back(along(part));
    std::vector<ReachingLight> light(seen.size());
    find_reaching_light(scene, seen, light);
    Vec3 sum(0);
    std::size_t asked = 0;
    for (const SpreadContribution::Part& part : parts) {
        const ReachingLight& there = part.corner == kCorners ? light[asked++] : at_corners[part.corner];
        sum += outgoing_radiance(look_at(scene, part.there.hit, part.texels), there.arrived);
    }
    return sum / double(parts.size());
}

/// Those of few samples: each sample by itself, at once.
void FragmentContributions::shade_few(std::span<Vec3> light) const {
    std::vector<SpreadContribution::Part> parts;
    std::vector<std::size_t> of;  // part -> fragment
    std::array<double, kMostShaded> count{};
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
        if (!is_few(waiting_[i])) continue;
        const std::vector<SpreadContribution::Part> own =
            waiting_[i].parts(1, texels_at(shading_.world.shading, waiting_[i].contribution().seen));
        parts.insert(parts.end(), own.begin(), own.end());
        of.insert(of.end(), own.size(), i);
        count[i] = double(own.size());
        light[i] = Vec3(0);
    }
    std::vector<SeenAlong> seen;
    for (const SpreadContribution::Part& part : parts) seen.push_back(along(part));
    std::vector<Vec3> shown(parts.size());
    shade_rays(shading_.world.shading, seen, shown);
    for (std::size_t k = 0; k < parts.size(); ++k) light[of[k]] += shown[k] / count[of[k]];
}

/// The others: from the light at the shaded points to means over their samples.
void FragmentContributions::shade_at_points(std::span<Vec3> light) {
    std::array<SeenAlong, kMostShaded> seen;
    std::array<MapTexels, kMostShaded> texels;
    std::array<Vec3, kMostShaded> shown;
    std::array<ReachingLight, kMostShaded> centre{};
    std::vector<std::size_t> points;
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
        if (is_few(waiting_[i])) continue;
        const std::size_t k = points.size();
        points.push_back(i);
        seen[k] = waiting_[i].contribution().seen;
        const std::optional<MapTexels> mean = waiting_[i].mean_texels();
        texels[k] = mean ? *mean : texels_at(shading_.world.shading, seen[k]);
        seen[k].texels = &texels[k];
        seen[k].footprint = waiting_[i].footprint();
        seen[k].cancel = shading_.cancel;
    }
    shade_rays(shading_.world.shading, std::span(seen).first(points.size()),
               std::span(shown).first(points.size()), std::span(centre).first(points.size()));
    find_light_at_corners(points);
    std::size_t first = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const std::size_t i = points[k];
        light[i] = shown[k];
        if (!is_spread(waiting_[i])) continue;
        const Vec3 caustic = centre[k].caustic;  // a mean over all of them already
        if (caustic != Vec3(0)) light[i] -= caustic;
        even_out_one(i, {centre[k], std::span(at_corners_).subspan(first), texels[k]}, light[i]);
        if (caustic != Vec3(0)) light[i] += caustic;
        first += waiting_[i].corners().size();
    }
}

/// Adds what has come together to its fragments, in the order in which it came.
void FragmentContributions::shade() {
    std::array<Vec3, kMostShaded> light;
    shade_few(light);
    shade_at_points(light);
    for (std::size_t i = 0; i < waiting_.size(); ++i)
        add_light(shading_.world, waiting_[i].contribution(), light[i], shaded_[i]->colour);
    waiting_.clear();
}

}  // namespace

void shade_fragments(const FragmentShading& shading, std::span<const ShownFragment> fragments,
                     std::span<ShadedFragment> shaded) {
    FragmentContributions contributions(shading);
    const bool has_rough = has_rough_optics(shading.world);
    for (std::size_t f = 0; f < fragments.size(); ++f) {
        const SampleView& view = *fragments[f].view;
        if (has_rough && shade_rough(shading, fragments[f], shaded[f].colour)) continue;
        shaded[f].colour = unlit_colour(shading.world, shading.views, view);
        for_each_contribution(shading.world, shading.views, view, [&](const Contribution& contribution) {
            contributions.add({shading, fragments[f], contribution}, shaded[f]);
        });
    }
    contributions.shade();
}

}  // namespace trilens
