#include "render/picture/spread_contribution.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

constexpr double kMostBend = 0.05;  // of half a pixel: corners may be so far from where derivatives say
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

}  // namespace

SpreadContribution::SpreadContribution(const FragmentShading& shading, const ShownFragment& fragment,
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
        const double low = 0.5 / side, high = (side - 0.5) / side;
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
                                          const RayDifferential& by_pixel) const {
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
    MapTexels texels = texels_over(*there, spread_, map_.differential(centroid_));
    if (sample_count() > 1 && !is_parallelogram(*there)) set_means_of_samples(texels);
    return texels;
}

/// Whether what a whole pixel sees is the parallelogram that its middle's derivatives say: how far the means
/// of opposite corners are from the middle, along both of its sides. Of the background they are directions,
/// in a plane at right angles to the middle one.
bool SpreadContribution::is_parallelogram(const SeenThere& middle) const {
    if (!is_whole_pixel() || number_count_ < kCorners) return false;
    const Vec3 normal = middle.hit.seen() ? Vec3(0, 0, 1) : middle.ray.direction;
    const auto point = [&](const SeenThere& there) {
        if (middle.hit.seen()) return Vec3(there.hit.barycentric, 0);
        return there.ray.direction / dot(there.ray.direction, normal);
    };
    const auto at = [&](std::size_t corner) { return point(corners_[numbers_[corner]]); };
    const Vec3 across = (at(1) + at(3) - at(0) - at(2)) / 4.0, down = (at(2) + at(3) - at(0) - at(1)) / 4.0;
    const double area = std::fabs(dot(cross(across, down), normal));
    const auto is_near = [&](const Vec3& other) {
        const Vec3 off = other - point(middle);
        return std::fabs(dot(cross(off, down), normal)) <= kMostBend * area &&
               std::fabs(dot(cross(across, off), normal)) <= kMostBend * area;
    };
    return is_near((at(0) + at(3)) / 2.0) && is_near((at(1) + at(2)) / 2.0);
}

/// All that textures show as the mean of each sample's own; of normals the mean's direction and length.
void SpreadContribution::set_means_of_samples(MapTexels& texels) const {
    const RayDifferential by_pixel = map_.differential(centroid_);
    MapTexels sum{Vec3(0), Vec3(0), 0, 0, 0, Vec3(0), 0};
    std::size_t count = 0;
    for (std::size_t s = 0; s < sample_count(); ++s)
        if (const std::optional<SeenThere> there = at(place(s))) {
            const MapTexels own = texels_over(*there, square(1), by_pixel);
            sum.base += own.base;
            sum.emissive += own.emissive;
            sum.roughness += own.roughness;
            sum.metallic += own.metallic;
            sum.occlusion += own.occlusion;
            sum.normal += own.normal_length * own.normal;
            ++count;
        }
    if (count == 0) return;
    const double all = double(count), of_normals = length(sum.normal);
    // Normals that leave none in the mean turn nowhere else.
    if (of_normals > 0) texels.normal = sum.normal / of_normals;
    texels = {sum.base / all,      sum.emissive / all, sum.roughness / all, sum.metallic / all,
              sum.occlusion / all, texels.normal,      of_normals / all};
}

std::vector<SpreadContribution::Part> SpreadContribution::parts(int step, const MapTexels& plain) const {
    const bool has_pictures = has_texture(shading_.world.shading, *contribution_.seen.hit);
    std::vector<Part> parts;
    const auto add = [&](const Vec2& lit, const Vec2& middle) {
        const std::optional<SeenThere> there = at(lit), seen = lit == middle ? there : at(middle);
        if (!there || !seen) return;
        parts.push_back({*there, plain});
        const auto known = std::span(corner_places_).first(corner_count_);
        const auto corner = std::find(known.begin(), known.end(), middle);
        if (step == 1 && corner != known.end())
            parts.back().corner = static_cast<std::size_t>(corner - known.begin());
        if (has_pictures) parts.back().texels = texels_over(*seen, square(step), map_.differential(middle));
    };
    if (step == 1) {
        for (std::size_t s = 0; s < sample_count(); ++s) add(place(s), place(s));
        return parts;
    }
    // Of a block's four samples another in each row and column of blocks: in the mean they are the middle.
    const int side = shading_.side;
    for (int j = 0; j < side / 2; ++j)
        for (int i = 0; i < side / 2; ++i)
            add(place(static_cast<std::size_t>((2 * j + i % 2) * side + 2 * i + j % 2)),
                fragment_.pixel + Vec2(2 * i + 1, 2 * j + 1) / double(side));
    return parts;
}

}  // namespace trilens
