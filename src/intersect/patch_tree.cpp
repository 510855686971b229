// Patches by samples of the surface, the tree by halves along its longest side.
#include "intersect/patch_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::size_t kPatchesPerTask = 128, kItemsPerLeaf = 4;
/// How much farther than at the samples the surface may lie, and its normals turn: a quadratic patch strays
/// 4/3 as far inside a facet as at the middles of its edges, and its normals turn most at the corners.
constexpr double kStraySafety = 2, kNormalSafety = 1.25;
/// A piece that turns less than this over its length is flat.
constexpr double kFlat = 1e-4;
/// Of the coordinates: what rounding makes of a point.
constexpr double kRounding = 1e-13;

constexpr double kThird = 1.0 / 3;
constexpr std::array<Vec3, 7> kSamples{Vec3(1, 0, 0),     Vec3(0, 1, 0),     Vec3(0, 0, 1), Vec3(0, 0.5, 0.5),
                                       Vec3(0.5, 0, 0.5), Vec3(0.5, 0.5, 0), Vec3(kThird)};

double largest(const Vec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

/// The surface's own normal, whatever it answers for light: along du x dv, on the same side.
Vec3 own_normal(const SurfacePoint& at) {
    const Vec3 across = normalize_or_zero(cross(at.du, at.dv));
    if (across == Vec3(0)) return at.normal;
    return dot(across, at.normal) < 0 ? -across : across;
}

/// The largest and the least curvature along any direction, towards `normal`; no numbers where du and dv are
/// parallel.
Vec2 curvatures(const SurfacePoint& at, const Vec3& normal) {
    const double e = dot(at.du, at.du), f = dot(at.du, at.dv), g = dot(at.dv, at.dv);
    const double l = dot(at.duu, normal), m = dot(at.duv, normal), n = dot(at.dvv, normal);
    const double area = e * g - f * f;
    if (!(area > 0)) return Vec2(std::numeric_limits<double>::quiet_NaN());
    const double mean = 0.5 * (e * n - 2 * f * m + g * l) / area, gauss = (l * n - m * m) / area;
    const double root = std::sqrt(std::max(0.0, mean * mean - gauss));
    return {mean + root, mean - root};
}

SurfacePatch make_surface_patch(const Surface& surface, const SurfaceGrid& grid, std::size_t facet) {
    SurfacePatch patch;
    for (std::size_t k = 0; k < 3; ++k)
        patch.corner[k] = grid.points[grid.corner_point[grid.facets[facet][k]]];
    for (std::size_t k = 0; k < 3; ++k)
        patch.size = std::max(patch.size, length(patch.corner[k] - patch.corner[(k + 1) % 3]));

    std::array<Vec3, kSamples.size()> normal;
    Vec3 sum(0);
    patch.bends_back = patch.bends_front = true;
    for (std::size_t i = 0; i < kSamples.size(); ++i) {
        const Vec3& w = kSamples[i];
        Vec2 uv(0);
        Vec3 chord(0);
        for (std::size_t k = 0; k < 3; ++k) {
            uv += w[static_cast<int>(k)] * grid.facet_uv[facet][k];
            chord += w[static_cast<int>(k)] * patch.corner[k];
        }
        const SurfacePoint at = surface.eval(grid.facet_face[facet], uv);
        patch.stray = std::max(patch.stray, length(at.position - chord));
        normal[i] = own_normal(at);
        sum += normal[i];
        const Vec2 bends = curvatures(at, normal[i]);
        patch.bends_back = patch.bends_back && bends.x * patch.size <= kFlat;
        patch.bends_front = patch.bends_front && bends.y * patch.size >= -kFlat;
    }
    patch.stray = kStraySafety * patch.stray + kRounding * largest(patch.corner[0]);
    patch.normal = normalize_or_zero(sum);
    if (patch.normal == Vec3(0) || std::find(normal.begin(), normal.end(), Vec3(0)) != normal.end())
        return patch;
    patch.normal_radius = 0;
    for (const Vec3& one : normal)
        patch.normal_radius = std::max(patch.normal_radius, kNormalSafety * length(one - patch.normal));
    return patch;
}

using Edge = std::pair<Id, Id>;

Edge edge_of(const IdTriple& corners, std::size_t k) {
    return std::minmax(corners[k], corners[(k + 1) % 3]);
}

/// Whether the points are one loop that turns to one side only, and once around, seen along `up`.
bool is_convex_loop(const std::map<Id, Id>& next, const std::vector<Vec3>& points, const Vec3& up) {
    constexpr double kStraight = 1e-6;  // radians
    if (next.empty()) return false;
    const auto flat = [&](Id from, Id to) {
        const Vec3 along = points[to] - points[from];
        return normalize_or_zero(along - dot(along, up) * up);
    };
    double sum = 0, least = 0, most = 0;
    std::size_t count = 0;
    Id at = next.begin()->first;
    do {
        const auto one = next.find(at);
        if (one == next.end()) return false;
        const auto two = next.find(one->second);
        if (two == next.end() || ++count > next.size()) return false;
        const Vec3 in = flat(one->first, one->second), out = flat(two->first, two->second);
        const double turn = std::atan2(dot(cross(in, out), up), dot(in, out));
        sum += turn, least = std::min(least, turn), most = std::max(most, turn);
        at = one->second;
    } while (at != next.begin()->first);
    const bool is_once = std::fabs(std::fabs(sum) - 2 * std::numbers::pi) < 1;
    return count == next.size() && is_once && (least >= -kStraight || most <= kStraight);
}

}  // namespace

PatchTree::PatchTree(const Surface& surface, const SurfaceGrid& grid) : patches_(grid.facets.size()) {
    parallel_for(patches_.size(), kPatchesPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) patches_[f] = make_surface_patch(surface, grid, f);
    });
    add_rims(grid);
    set_shape(grid);
    build();
}

/// Edges that only one facet has. A corner has one normal, so facets on both sides of a crease share none.
void PatchTree::add_rims(const SurfaceGrid& grid) {
    struct Side {
        Id facet = kNone;
        std::size_t edge = 0;
        int count = 0;
    };
    std::map<Edge, Side> sides;
    for (std::size_t f = 0; f < patches_.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            Side& side = sides[edge_of(grid.facets[f], k)];
            if (side.count++ == 0) side.facet = static_cast<Id>(f), side.edge = k;
        }
    for (const auto& [edge, side] : sides) {
        const SurfacePatch& patch = patches_[side.facet];
        const Vec3 &a = patch.corner[side.edge], &b = patch.corner[(side.edge + 1) % 3];
        if (side.count == 1 && a != b) rims_.push_back({{a, b}, patch.stray});
    }
}

void PatchTree::set_shape(const SurfaceGrid& grid) {
    std::map<Edge, int> facets_at;  // by the edge from its first point to its second
    Vec3 sum(0);
    for (std::size_t f = 0; f < patches_.size(); ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Id from = grid.corner_point[grid.facets[f][k]],
                     to = grid.corner_point[grid.facets[f][(k + 1) % 3]];
            if (from != to) ++facets_at[{from, to}];
        }
        sum += patches_[f].normal;
    }
    std::map<Id, Id> border;  // from point to point along it
    bool is_manifold = !facets_at.empty();
    for (const auto& [edge, count] : facets_at) {
        is_manifold = is_manifold && count == 1;
        if (facets_at.count({edge.second, edge.first}) > 0) continue;
        is_manifold = border.insert({edge.first, edge.second}).second && is_manifold;
    }
    is_closed_ = is_manifold && border.empty();
    const Vec3 up = normalize_or_zero(sum);
    is_height_field_ =
        is_manifold &&
        std::all_of(patches_.begin(), patches_.end(),
                    [&](const SurfacePatch& patch) { return dot(patch.normal, up) > patch.normal_radius; }) &&
        is_convex_loop(border, grid.points, up);
}

void PatchTree::build() {
    for (std::size_t f = 0; f < patches_.size(); ++f) {
        const SurfacePatch& patch = patches_[f];
        Item item{{}, static_cast<Id>(f), kNone};
        for (const Vec3& corner : patch.corner) item.box.include(corner);
        item.box = {item.box.low - patch.stray, item.box.high + patch.stray};
        items_.push_back(item);
    }
    for (std::size_t r = 0; r < rims_.size(); ++r) {
        Item item{{}, kNone, static_cast<Id>(r)};
        for (const Vec3& end : rims_[r].end) item.box.include(end);
        item.box = {item.box.low - rims_[r].stray, item.box.high + rims_[r].stray};
        items_.push_back(item);
    }
    if (items_.empty()) return;
    add_node(0, items_.size(), 0);
    size_ = 0.5 * length(nodes_[0].box.size());
}

std::size_t PatchTree::add_node(std::size_t first, std::size_t last, int depth) {
    const std::size_t at = nodes_.size();
    nodes_.emplace_back();
    Box box;
    for (std::size_t i = first; i < last; ++i) box.include(items_[i].box);
    nodes_[at].box = box;
    if (last - first <= kItemsPerLeaf || depth > 48) {
        nodes_[at].first = first;
        nodes_[at].count = last - first;
        return at;
    }
    const Vec3 side = box.size();
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const std::size_t middle = first + (last - first) / 2;
    const auto place = [axis](const Item& item) { return item.box.low[axis] + item.box.high[axis]; };
    const auto begin = items_.begin();
    std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
                     begin + static_cast<std::ptrdiff_t>(last), [&](const Item& a, const Item& b) {
                         if (place(a) != place(b)) return place(a) < place(b);
                         return a.patch != b.patch ? a.patch < b.patch : a.rim < b.rim;
                     });
    add_node(first, middle, depth + 1);
    const std::size_t right = add_node(middle, last, depth + 1);
    nodes_[at].right = right;
    return at;
}

}  // namespace trilens
