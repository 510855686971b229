#include "render/picture/fragments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/picture/rough_light.h"
#include "render/picture/sample_colour.h"

namespace trilens {
namespace {

constexpr std::size_t kMostShaded = Segments::kMost;
constexpr std::size_t kCorners = 4;
// Of the light at the shaded point: how far that at the outermost samples may be off in the mean.
constexpr double kWholeRoom = 0.25, kPartRoom = 0.05;
constexpr double kPolished =
    0.3;  // surfaces of less roughness are shaded sample by sample: highlights are small
constexpr double kWayToEdge = 0.9;  // of the way to a triangle's edge, at most: walls may stand there

/// Where a ray meets the plane of a triangle, outside of it, too; none: nowhere in front.
std::optional<Hit> meet_plane(const TriangleScene& scene, Id triangle, const Ray& ray) {
    const IdTriple& corner = scene.triangles[triangle];
    const Vec3& a = scene.points[corner[0]];
    const Vec3 b = scene.points[corner[1]] - a, c = scene.points[corner[2]] - a, o = ray.origin - a;
    const Vec3 normal = cross(b, c);
    const double along = dot(normal, ray.direction);
    const double t = -dot(normal, o) / along;
    if (!(t >= 0 && t < INFINITY)) return std::nullopt;
    const Vec3 p = o + t * ray.direction;
    const double area = dot(normal, normal);
    return Hit{triangle, t, {dot(cross(p, c), normal) / area, dot(cross(b, p), normal) / area}};
}

/// A point of a triangle's plane drawn towards one inside the triangle, until it lies inside, too.
void draw_inside(const Hit& inside, Hit& hit) {
    double way = 1;
    const auto keep_positive = [&](double from, double to) {
        if (to < 0 && from > 0) way = std::min(way, kWayToEdge * from / (from - to));
        if (to < 0 && from <= 0) way = 0;
    };
    const Vec2 from = inside.barycentric, to = hit.barycentric;
    keep_positive(from.x, to.x);
    keep_positive(from.y, to.y);
    keep_positive(1 - from.x - from.y, 1 - to.x - to.y);
    if (way == 1) return;
    hit.barycentric = from + way * (to - from);
    hit.t = inside.t + way * (hit.t - inside.t);
}

/// What is seen at one place of a fragment.
struct SeenThere {
    Hit hit;
    Ray ray;
};

/// One contribution to a fragment, with what its samples see.
class SpreadContribution {
  public:
    SpreadContribution(const FragmentShading& shading, const ShownFragment& fragment,
                       const Contribution& contribution)
        : shading_(shading), fragment_(fragment), contribution_(contribution) {
        const bool has_caustics = static_cast<bool>(shading.world.shading.caustic);
        if (sample_count() > 1 || has_caustics)
            map_ = facet_map(shading.viewer, *fragment.view, contribution.end);
        if (!map_.mesh) return;
        if (sample_count() > 1) find_corners();
        find_spread();
        if (has_caustics) find_footprint();
        if (contribution.end && contribution.end->medium != kNone) find_mean_length();
    }

    std::size_t sample_count() const {
        const std::size_t side = static_cast<std::size_t>(shading_.side);
        return fragment_.members.empty() ? side * side : fragment_.members.size();
    }
    /// Place of one of its samples on the film.
    Vec2 place(std::size_t sample) const {
        const int inside = fragment_.members.empty() ? static_cast<int>(sample) : fragment_.members[sample];
        return fragment_.pixel +
               Vec2(inside % shading_.side + 0.5, inside / shading_.side + 0.5) / double(shading_.side);
    }
    std::optional<SeenThere> at(const Vec2& place) const;
    const Contribution& contribution() const { return contribution_; }
    bool is_whole_pixel() const { return fragment_.members.empty(); }
    /// What its outermost samples see, each once: few samples are outermost in several ways.
    std::span<const SeenThere> corners() const { return {corners_.data(), corner_count_}; }
    /// The corners, as numbers in corners(); fewer than kCorners where some see nothing by its map, or it has
    /// one sample.
    std::span<const std::uint8_t> corner_numbers() const { return {numbers_.data(), number_count_}; }
    /// What pictures show in the mean over its samples; none: what they do at the shaded point.
    std::optional<MapTexels> mean_texels() const;
    /// The same over one sample's part of the pixel, of what at() there shows.
    MapTexels sample_texels(const SeenThere& there, const Vec2& place) const;
    /// The place of a corner.
    const Vec2& corner_place(std::size_t corner) const { return corner_places_[corner]; }
    /// Sides of the parallelogram on the surface that its samples stand for; null where it is not known.
    const std::array<Vec3, 2>* footprint() const { return footprint_ ? &*footprint_ : nullptr; }

  private:
    MapTexels texels_over(const SeenThere& there, const std::array<Vec2, 2>& sides, const Vec2& place) const;
    void find_footprint();
    void find_corners();
    void find_spread();
    /// Of the way through the last medium, to first order: that at the centroid of the samples.
    void find_mean_length();
    const FragmentShading& shading_;
    const ShownFragment& fragment_;
    Contribution contribution_;
    FacetMap map_;
    // The parallelogram that has the samples' mean and second moments: over a pixel, the pixel.
    Vec2 centroid_{0};
    std::array<Vec2, 2> spread_{Vec2(1, 0), Vec2(0, 1)};  // its sides
    std::array<SeenThere, kCorners> corners_;
    std::array<Vec2, kCorners> corner_places_;
    std::array<std::uint8_t, kCorners> numbers_;
    std::size_t corner_count_ = 0, number_count_ = 0;
    std::optional<std::array<Vec3, 2>> footprint_;
};

std::optional<SeenThere> SpreadContribution::at(const Vec2& place) const {
    const Ray ray = map_.at(place);
    if (!contribution_.seen.hit->seen()) return SeenThere{{}, ray};
    const std::optional<Hit> hit = meet_plane(shading_.world.objects, contribution_.seen.hit->triangle, ray);
    if (!hit) return std::nullopt;
    // Samples of neighbouring facets see the same triangle; this facet's map, continued, may miss it.
    SeenThere there{*hit, ray};
    draw_inside(*contribution_.seen.hit, there.hit);
    return there;
}

/// The outermost samples: those farthest along both diagonals, both ways.
void SpreadContribution::find_corners() {
    const int side = shading_.side;
    std::array<Vec2, kCorners> places;
    places.fill(Vec2(0));
    if (fragment_.members.empty()) {
        const double low = 0.5 / side, high = 1 - low;
        places = {Vec2(low, low), Vec2(high, low), Vec2(low, high), Vec2(high, high)};
    } else {
        std::array<int, kCorners> most;
        most.fill(-3 * side);
        for (const int inside : fragment_.members) {
            const int x = inside % side, y = inside / side;
            const std::array<int, kCorners> far{-x - y, x - y, y - x, x + y};
            for (std::size_t k = 0; k < kCorners; ++k) {
                if (far[k] <= most[k]) continue;
                most[k] = far[k];
                places[k] = Vec2(x + 0.5, y + 0.5) / double(side);
            }
        }
    }
    std::array<std::size_t, kCorners> known;  // by place: its number; kCorners: it sees nothing
    for (std::size_t k = 0; k < kCorners; ++k) {
        const auto same =
            static_cast<std::size_t>(std::find(places.begin(), places.end(), places[k]) - places.begin());
        known[k] = same < k ? known[same] : kCorners;
        if (same == k)
            if (const std::optional<SeenThere> there = at(fragment_.pixel + places[k])) {
                corner_places_[corner_count_] = fragment_.pixel + places[k];
                corners_[known[k] = corner_count_++] = *there;
            }
        if (known[k] < kCorners) numbers_[number_count_++] = static_cast<std::uint8_t>(known[k]);
    }
}

/// Each sample stands for its own cell of the lattice, a square with a twelfth of its area as variance.
void SpreadContribution::find_spread() {
    centroid_ = fragment_.pixel + Vec2(0.5);
    if (is_whole_pixel()) return;
    const double count = static_cast<double>(sample_count());
    Vec2 sum(0);
    for (std::size_t s = 0; s < sample_count(); ++s) sum += place(s);
    centroid_ = sum / count;
    double xx = 0, xy = 0, yy = 0;
    for (std::size_t s = 0; s < sample_count(); ++s) {
        const Vec2 off = place(s) - centroid_;
        xx += off.x * off.x;
        xy += off.x * off.y;
        yy += off.y * off.y;
    }
    const double cell = 1.0 / (shading_.side * shading_.side);
    xx = 12 * xx / count + cell;
    xy = 12 * xy / count;
    yy = 12 * yy / count + cell;
    // The square root of that matrix: its sides' outer products add up to it.
    const double area = std::sqrt(std::max(xx * yy - xy * xy, 0.0)), scale = std::sqrt(xx + yy + 2 * area);
    spread_ = {Vec2(xx + area, xy) / scale, Vec2(xy, yy + area) / scale};
}

void SpreadContribution::find_footprint() {
    const Hit& seen = *contribution_.seen.hit;
    if (!seen.seen()) return;
    std::array<Vec3, 2> sides;
    for (std::size_t k = 0; k < 2; ++k) {
        const Ray low = map_.at(centroid_ - 0.5 * spread_[k]), high = map_.at(centroid_ + 0.5 * spread_[k]);
        const auto from = meet_plane(shading_.world.objects, seen.triangle, low),
                   to = meet_plane(shading_.world.objects, seen.triangle, high);
        if (!from || !to) return;
        sides[k] = high.origin + to->t * high.direction - (low.origin + from->t * low.direction);
    }
    footprint_ = sides;
}

void SpreadContribution::find_mean_length() {
    if (is_whole_pixel() || !contribution_.seen.hit->seen()) return;
    if (const std::optional<SeenThere> there = at(centroid_))
        contribution_.mean_length = there->hit.t * length(there->ray.direction);
}

MapTexels SpreadContribution::texels_over(const SeenThere& there, const std::array<Vec2, 2>& sides,
                                          const Vec2& place) const {
    const RayDifferential by_pixel = map_.differential(place);
    RayDifferential differential;
    for (std::size_t k = 0; k < 2; ++k)
        for (int c = 0; c < 2; ++c) {
            const std::size_t of = static_cast<std::size_t>(c);
            differential.origin[k] += sides[k][c] * by_pixel.origin[of];
            differential.direction[k] += sides[k][c] * by_pixel.direction[of];
        }
    return texels_at(shading_.world.shading, {&there.hit, &there.ray, nullptr, &differential});
}

std::optional<MapTexels> SpreadContribution::mean_texels() const {
    if (!map_.mesh || !has_texture(shading_.world.shading, *contribution_.seen.hit)) return std::nullopt;
    const std::optional<SeenThere> there = at(centroid_);
    if (!there) return std::nullopt;
    return texels_over(*there, spread_, centroid_);
}

MapTexels SpreadContribution::sample_texels(const SeenThere& there, const Vec2& place) const {
    const double side = 1.0 / shading_.side;
    return texels_over(there, {Vec2(side, 0), Vec2(0, side)}, place);
}

/// Contributions of several fragments, shaded together.
class FragmentContributions {
  public:
    explicit FragmentContributions(const FragmentShading& shading) : shading_(shading) {
        waiting_.reserve(kMostShaded);
    }

    void add(const SpreadContribution& contribution, ShadedFragment& shaded) {
        waiting_.push_back(contribution);
        shaded_[waiting_.size() - 1] = &shaded;
        if (waiting_.size() == kMostShaded) shade();
    }
    void shade();

  private:
    void even_out(std::span<const ReachingLight> centre, std::span<const MapTexels> texels,
                  std::span<Vec3> light);
    ArrivedLight mean_arrived(const SpreadContribution& contribution) const;

    const FragmentShading& shading_;
    std::vector<SpreadContribution> waiting_;
    std::array<ShadedFragment*, kMostShaded> shaded_{};
};

/// What a surface makes of light, that it does not emit itself: of a matt one without its colour.
Vec3 arriving(SurfaceLook look, const ArrivedLight& arrived) {
    if (look.is_matt()) return arrived.matt;
    look.emissive = Vec3(0);
    return outgoing_radiance(look, arrived);
}

/// The mean over a pixel's samples of a function that is quadratic, less its value at the centre, as a share
/// of the mean over the four samples at the corners less that.
double corner_share(int side) {
    return (side + 1.0) / (3.0 * (side - 1));
}

/// From the light at the shaded points to means over the samples. Samples are lit one by one where other
/// lights reach the outermost than the shaded point, or light changes by more than a mean can tell.
void FragmentContributions::even_out(std::span<const ReachingLight> centre, std::span<const MapTexels> texels,
                                     std::span<Vec3> light) {
    std::array<SeenAlong, kMostShaded * kCorners> corners;
    std::vector<MapTexels> corner_texels;  // where pictures say how light comes; stay in place
    std::size_t count = 0;
    const auto is_spread = [&](const SpreadContribution& one) {
        const Hit& hit = *one.contribution().seen.hit;
        return hit.seen() && !one.corners().empty() && is_lit(shading_.world.shading, hit);
    };
    for (const SpreadContribution& one : waiting_) {
        if (!is_spread(one)) continue;
        const bool has_maps = has_light_maps(shading_.world.shading, *one.contribution().seen.hit);
        if (has_maps) corner_texels.reserve(corners.size());
        for (std::size_t k = 0; k < one.corners().size(); ++k) {
            const SeenThere& corner = one.corners()[k];
            corners[count] = {&corner.hit, &corner.ray};
            if (has_maps)
                corners[count].texels =
                    &corner_texels.emplace_back(one.sample_texels(corner, one.corner_place(k)));
            corners[count++].without_caustics = true;
        }
    }
    std::array<ReachingLight, kMostShaded * kCorners> there;
    find_reaching_light(shading_.world.shading, std::span(corners).first(count),
                        std::span(there).first(count));

    count = 0;
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
        if (!is_spread(waiting_[i])) continue;
        const SurfaceLook look =
            look_at(shading_.world.shading, *waiting_[i].contribution().seen.hit, texels[i]);
        const std::span<const std::uint8_t> numbers = waiting_[i].corner_numbers();
        const std::size_t n = numbers.size();
        bool uneven = !look.is_matt() && look.roughness < kPolished;
        ArrivedLight mean;
        for (const std::size_t number : numbers) {
            ReachingLight at = there[count + number];
            uneven = uneven || at.lights != centre[i].lights;
            mean += at.arrived /= double(n);
        }
        count += waiting_[i].corners().size();
        const bool whole = waiting_[i].is_whole_pixel();
        const Vec3 caustic = centre[i].caustic;  // a mean over all of them already
        if (caustic != Vec3(0)) light[i] -= caustic;
        const Vec3 here = arriving(look, centre[i].arrived), off = arriving(look, mean) - here;
        if (uneven || of_worst_colour(glm::abs(off) - (whole ? kWholeRoom : kPartRoom) * here) > 0) {
            light[i] = outgoing_radiance(look, mean_arrived(waiting_[i]));
            ++shaded_[i]->rays_by_sample;
        } else if (whole && n == kCorners) {
            for (int k = 0; k < 3; ++k)
                if (here[k] > 0)
                    light[i][k] = look.emissive[k] + (light[i][k] - look.emissive[k]) *
                                                         (1 + corner_share(shading_.side) * off[k] / here[k]);
        }
        if (caustic != Vec3(0)) light[i] += caustic;
    }
}

/// The light at each sample by itself.
ArrivedLight FragmentContributions::mean_arrived(const SpreadContribution& contribution) const {
    const bool has_maps = has_light_maps(shading_.world.shading, *contribution.contribution().seen.hit);
    std::vector<SeenThere> there;
    std::vector<MapTexels> texels;  // of as many, where pictures say how light comes
    for (std::size_t s = 0; s < contribution.sample_count(); ++s)
        if (const std::optional<SeenThere> seen = contribution.at(contribution.place(s))) {
            there.push_back(*seen);
            if (has_maps) texels.push_back(contribution.sample_texels(*seen, contribution.place(s)));
        }
    std::vector<SeenAlong> seen;
    for (std::size_t i = 0; i < there.size(); ++i) {
        seen.push_back({&there[i].hit, &there[i].ray});
        if (has_maps) seen.back().texels = &texels[i];
        seen.back().without_caustics = true;
    }
    std::vector<ReachingLight> light(seen.size());
    find_reaching_light(shading_.world.shading, seen, light);
    ArrivedLight sum;
    for (const ReachingLight& one : light) sum += one.arrived;
    return sum /= double(light.size());
}

/// Adds what has come together to its fragments, in the order in which it came.
void FragmentContributions::shade() {
    const std::size_t count = waiting_.size();
    std::array<SeenAlong, kMostShaded> seen;
    std::array<MapTexels, kMostShaded> texels;
    std::array<Vec3, kMostShaded> light;
    std::array<ReachingLight, kMostShaded> reaching{};
    for (std::size_t i = 0; i < count; ++i) {
        seen[i] = waiting_[i].contribution().seen;
        const std::optional<MapTexels> mean = waiting_[i].mean_texels();
        texels[i] = mean ? *mean : texels_at(shading_.world.shading, seen[i]);
        seen[i].texels = &texels[i];
        seen[i].footprint = waiting_[i].footprint();
    }
    shade_rays(shading_.world.shading, std::span(seen).first(count), std::span(light).first(count),
               std::span(reaching).first(count));
    even_out(std::span(reaching).first(count), std::span(texels).first(count), std::span(light).first(count));
    for (std::size_t i = 0; i < count; ++i)
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
