#include "render/picture/fragment_shader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace trilens {
namespace {

constexpr std::size_t kMostShaded = Segments::kMost;
constexpr std::size_t kCorners = 4;
constexpr double kLookupsPerTexel = 4;
// Of the light at the shaded point: how far that at the outermost samples may be off in the mean.
constexpr double kWholeRoom = 0.25, kPartRoom = 0.05;
constexpr double kWayToEdge = 0.9;  // of the way to a triangle's edge, at most: walls may stand there
constexpr double kPi = 3.14159265358979323846;

/// The rays of a facet as a function of the film.
struct FacetMap {
    const RayMesh* mesh = nullptr;  // null: there is none
    Id facet = kNone;
    FacetWeights weights;

    Ray at(const Vec2& place) const { return sample_ray(*mesh, facet, weights, place); }
};

FacetMap map_of(const FragmentShading& shading, const SampleView& view, const PathEnd* end) {
    FacetMap map;
    if (!end) {
        map.mesh = shading.facets.camera;
        map.facet = view.camera_facet;
    } else if (end->node != kNone) {
        const PathNode& node = shading.facets.paths(view.optic).nodes()[end->node];
        map.mesh = &node.mesh;
        map.facet = node.facet_of(view.leaf);
    }
    if (!map.mesh || map.facet == kNone) return {};
    map.weights = facet_weights(*map.mesh, map.facet);
    return map.weights.edge_on ? FacetMap() : map;
}

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
        if (sample_count() > 1) map_ = map_of(shading, *fragment.view, contribution.end);
        if (!map_.mesh) return;
        find_corners();
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
    /// What its outermost samples see; fewer than kCorners where some see nothing by its map, or it has one.
    std::span<const SeenThere> corners() const { return {corners_.data(), corner_count_}; }
    /// Mean base colour over its samples, or of the background; none: that of the shaded point will do.
    std::optional<Vec3> mean_base() const;

  private:
    void find_corners();
    /// Of the way through the last medium, to first order: that at the centroid of the samples.
    void find_mean_length();
    /// How many look-ups along a pixel's edge its texture asks for.
    int lookups() const;
    Vec3 base_at(const SeenThere& there) const;

    const FragmentShading& shading_;
    const ShownFragment& fragment_;
    Contribution contribution_;
    FacetMap map_;
    std::array<SeenThere, kCorners> corners_;
    std::size_t corner_count_ = 0;
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
    for (const Vec2& place : places)
        if (const std::optional<SeenThere> there = at(fragment_.pixel + place))
            corners_[corner_count_++] = *there;
}

void SpreadContribution::find_mean_length() {
    if (is_whole_pixel() || !contribution_.seen.hit->seen()) return;
    Vec2 sum(0);
    for (std::size_t s = 0; s < sample_count(); ++s) sum += place(s);
    if (const std::optional<SeenThere> there = at(sum / double(sample_count())))
        contribution_.mean_length = there->hit.t * length(there->ray.direction);
}

int SpreadContribution::lookups() const {
    double texels = 0;
    const Hit& hit = *contribution_.seen.hit;
    const Background& background = shading_.world.shading.background;
    if (hit.seen()) {
        if (!base_colour_texel(shading_.world.shading, hit)) return 1;
        Vec2 low(INFINITY), high(-INFINITY);
        for (const SeenThere& corner : corners()) {
            const Vec2 texel = *base_colour_texel(shading_.world.shading, corner.hit);
            low = glm::min(low, texel);
            high = glm::max(high, texel);
        }
        texels = std::max(high.x - low.x, high.y - low.y);
    } else {
        if (!background.environment) return 1;
        const Vec3 middle = normalize_or_zero(contribution_.seen.ray->direction);
        double farthest = 0;
        for (const SeenThere& corner : corners())
            farthest = std::max(farthest, length(normalize_or_zero(corner.ray.direction) - middle));
        texels = 2 * farthest * background.environment->width / (2 * kPi);
    }
    return static_cast<int>(std::clamp(std::ceil(kLookupsPerTexel * texels), 1.0, double(shading_.side)));
}

Vec3 SpreadContribution::base_at(const SeenThere& there) const {
    return there.hit.seen() ? base_colour(shading_.world.shading, there.hit)
                            : shade_background(shading_.world.shading.background, there.ray.direction);
}

std::optional<Vec3> SpreadContribution::mean_base() const {
    if (corner_count_ == 0) return std::nullopt;
    const int n = lookups();
    if (n == 1) return std::nullopt;
    Vec3 sum(0);
    int count = 0;
    const auto add = [&](const Vec2& place) {
        const std::optional<SeenThere> there = at(place);
        if (!there) return;
        sum += base_at(*there);
        ++count;
    };
    if (fragment_.members.empty())
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) add(fragment_.pixel + Vec2(i + 0.5, j + 0.5) / double(n));
    else
        for (std::size_t s = 0; s < fragment_.members.size(); ++s) add(place(s));
    if (count == 0) return std::nullopt;
    return sum / double(count);
}

/// Contributions of several fragments, shaded together.
class FragmentContributions {
  public:
    explicit FragmentContributions(const FragmentShading& shading) : shading_(shading) {
        waiting_.reserve(kMostShaded);
    }

    void add(const SpreadContribution& contribution, SampleColour& colour) {
        waiting_.push_back(contribution);
        colours_[waiting_.size() - 1] = &colour;
        if (waiting_.size() == kMostShaded) shade();
    }
    void shade();
    std::size_t by_sample() const { return by_sample_; }

  private:
    void even_out(std::span<const ReachingLight> centre, std::span<Vec3> light);
    Vec3 mean_light(const SpreadContribution& contribution) const;

    const FragmentShading& shading_;
    std::vector<SpreadContribution> waiting_;
    std::array<SampleColour*, kMostShaded> colours_{};
    std::size_t by_sample_ = 0;
};

/// The mean over a pixel's samples of a function that is quadratic, less its value at the centre, as a share
/// of the mean over the four samples at the corners less that.
double corner_share(int side) {
    return (side + 1.0) / (3.0 * (side - 1));
}

/// From the light at the shaded points to means over the samples. Samples are shaded one by one where other
/// lights reach the outermost than the shaded point, or light changes by more than a mean can tell.
void FragmentContributions::even_out(std::span<const ReachingLight> centre, std::span<Vec3> light) {
    std::array<SeenAlong, kMostShaded * kCorners> corners;
    std::size_t count = 0;
    const auto is_spread = [&](const SpreadContribution& one) {
        const Hit& hit = *one.contribution().seen.hit;
        return hit.seen() && !one.corners().empty() && is_lit(shading_.world.shading, hit);
    };
    for (const SpreadContribution& one : waiting_)
        if (is_spread(one))
            for (const SeenThere& corner : one.corners()) corners[count++] = {&corner.hit, &corner.ray};
    std::array<ReachingLight, kMostShaded * kCorners> there;
    find_reaching_light(shading_.world.shading, std::span(corners).first(count),
                        std::span(there).first(count));

    count = 0;
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
        if (!is_spread(waiting_[i])) continue;
        const std::size_t n = waiting_[i].corners().size();
        bool uneven = false;
        Vec3 mean(0);
        for (const ReachingLight& at : std::span(there).subspan(count, n)) {
            uneven = uneven || at.lights != centre[i].lights;
            mean += at.arriving / double(n);
        }
        count += n;
        const bool whole = waiting_[i].is_whole_pixel();
        const Vec3 off = mean - centre[i].arriving;
        if (uneven ||
            of_worst_colour(glm::abs(off) - (whole ? kWholeRoom : kPartRoom) * centre[i].arriving) > 0) {
            light[i] = mean_light(waiting_[i]);
            ++by_sample_;
        } else if (whole && n == kCorners) {
            for (int k = 0; k < 3; ++k)
                if (centre[i].arriving[k] > 0)
                    light[i][k] *= 1 + corner_share(shading_.side) * off[k] / centre[i].arriving[k];
        }
    }
}

/// Each sample shaded by itself.
Vec3 FragmentContributions::mean_light(const SpreadContribution& contribution) const {
    std::vector<SeenThere> there;
    for (std::size_t s = 0; s < contribution.sample_count(); ++s)
        if (const std::optional<SeenThere> seen = contribution.at(contribution.place(s)))
            there.push_back(*seen);
    std::vector<SeenAlong> seen;
    for (const SeenThere& one : there) seen.push_back({&one.hit, &one.ray});
    std::vector<Vec3> light(seen.size());
    shade_rays(shading_.world.shading, seen, light);
    Vec3 sum(0);
    for (const Vec3& one : light) sum += one;
    return sum / double(light.size());
}

/// Adds what has come together to its fragments, in the order in which it came.
void FragmentContributions::shade() {
    const std::size_t count = waiting_.size();
    std::array<SeenAlong, kMostShaded> seen;
    std::array<std::optional<Vec3>, kMostShaded> base;
    std::array<Vec3, kMostShaded> light;
    std::array<ReachingLight, kMostShaded> reaching{};
    for (std::size_t i = 0; i < count; ++i) {
        seen[i] = waiting_[i].contribution().seen;
        base[i] = waiting_[i].mean_base();
        if (base[i]) seen[i].base = &*base[i];
    }
    shade_rays(shading_.world.shading, std::span(seen).first(count), std::span(light).first(count),
               std::span(reaching).first(count));
    even_out(std::span(reaching).first(count), std::span(light).first(count));
    for (std::size_t i = 0; i < count; ++i)
        add_light(shading_.world, waiting_[i].contribution(), light[i], *colours_[i]);
    waiting_.clear();
}

}  // namespace

std::size_t shade_fragments(const FragmentShading& shading, std::span<const ShownFragment> fragments,
                            std::span<SampleColour> colours) {
    FragmentContributions contributions(shading);
    for (std::size_t f = 0; f < fragments.size(); ++f) {
        const SampleView& view = *fragments[f].view;
        colours[f] = unlit_colour(view);
        for_each_contribution(shading.world, shading.views, view, [&](const Contribution& contribution) {
            contributions.add({shading, fragments[f], contribution}, colours[f]);
        });
    }
    contributions.shade();
    return contributions.by_sample();
}

}  // namespace trilens
