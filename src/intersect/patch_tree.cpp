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

// Newton's method with a bounded step that must bring the surface nearer to the ray.

namespace {

constexpr int kMaxSteps = 24;  // quadratic convergence takes 4 or 5; a silhouette halves the error per step
constexpr int kMaxHalvings = 4;

Vec2 clamp_to_domain(FaceDomain domain, Vec2 uv) {
    if (domain == FaceDomain::kSquare) return glm::clamp(uv, 0.0, 1.0);
    const double over = uv.x + uv.y - 1;
    if (over > 0) uv -= 0.5 * over;
    if (uv.x < 0) return {0, std::clamp(uv.y, 0.0, 1.0)};
    if (uv.y < 0) return {std::clamp(uv.x, 0.0, 1.0), 0};
    return uv;
}

/// A point of the face, how far off the ray it is, and where to go from it.
struct Trial {
    Vec2 uv{0};
    SurfacePoint point;
    double z = 0;              // along the ray
    double miss = 0;           // distance from the ray's line
    std::optional<Vec2> step;  // in (u, v); none where the tangent plane gives none
};

// The step that brings the tangent plane's point onto the ray; none where the ray lies in that plane, or
// there is none.
std::optional<Vec2> newton_step(const RayFrame& ray, const SurfacePoint& point, const Vec3& local) {
    const Vec2 du(dot(ray.x, point.du), dot(ray.y, point.du)), dv(dot(ray.x, point.dv), dot(ray.y, point.dv));
    const double determinant = du.x * dv.y - dv.x * du.y;
    const Vec2 step = Vec2(dv.x * local.y - dv.y * local.x, du.y * local.x - du.x * local.y) / determinant;
    if (!std::isfinite(step.x) || !std::isfinite(step.y)) return std::nullopt;
    return step;
}

Trial eval_trial(const Surface& surface, const RayFrame& ray, const SurfaceGuess& guess, const Vec2& uv) {
    Trial trial;
    trial.uv = clamp_to_domain(surface.domain(guess.face), uv);
    trial.point = surface.eval_first_order(guess.face, trial.uv);
    const Vec3 local = ray.from_world(trial.point.position);
    trial.z = local.z;
    trial.miss = std::hypot(local.x, local.y);
    trial.step = newton_step(ray, trial.point, local);
    if (!trial.step) return trial;
    const double size = std::max(std::fabs(trial.step->x), std::fabs(trial.step->y));
    if (size > guess.reach) *trial.step *= guess.reach / size;
    return trial;
}

}  // namespace

std::optional<RayFrame> make_ray_frame(const Ray& ray) {
    RayFrame frame{ray.origin, {}, {}, normalize_or_zero(ray.direction), 0};
    frame.speed = dot(frame.z, ray.direction);
    if (!(frame.speed > 0) || !std::isfinite(frame.speed) || !std::isfinite(dot(ray.origin, Vec3(1)))) {
        return std::nullopt;
    }
    const Vec3 size = glm::abs(frame.z);
    const Vec3 least = size.x <= size.y && size.x <= size.z ? Vec3(1, 0, 0)
                       : size.y <= size.z                   ? Vec3(0, 1, 0)
                                                            : Vec3(0, 0, 1);
    frame.x = normalize(cross(least, frame.z));
    frame.y = cross(frame.z, frame.x);
    return frame;
}

std::optional<SurfaceHit> solve_surface_hit(const Surface& surface, const RayFrame& ray,
                                            const SurfaceGuess& guess) {
    Trial best = eval_trial(surface, ray, guess, guess.uv);
    const double scale = length(best.point.position) + length(ray.origin);
    const double good_enough = kSurfaceResidual * scale, best_possible = 1e-3 * good_enough;
    const auto improves = [&](const Trial& next) {
        return next.miss < best.miss && (next.step || next.miss <= good_enough);
    };
    for (int i = 0; i < kMaxSteps && best.miss > best_possible && best.step; ++i) {
        // Take the longest of 1, 1/2, 1/4 .. of the step that brings the point nearer to the ray, and not
        // into a dead end. Steps end at the face's border: behind it derivatives say nothing where the
        // surface is pinched.
        Trial next = eval_trial(surface, ray, guess, best.uv + *best.step);
        const int halvings = best.miss <= good_enough ? 0 : kMaxHalvings;
        for (int k = 1; k <= halvings && !improves(next); ++k) {
            next = eval_trial(surface, ray, guess, best.uv + std::ldexp(1.0, -k) * *best.step);
        }
        if (!improves(next)) break;
        best = next;
    }
    if (!(best.miss <= good_enough)) return std::nullopt;
    return SurfaceHit{guess.face, best.uv, best.z / ray.speed, best.point};
}

std::optional<SecondHit> predict_second_hit(const SurfaceHit& hit, const Vec3& direction) {
    // The direction in the tangent plane, as a rate of (u, v) per unit of t.
    const SurfacePoint& p = hit.point;
    const double uu = dot(p.du, p.du), uv = dot(p.du, p.dv), vv = dot(p.dv, p.dv);
    const double along_u = dot(direction, p.du), along_v = dot(direction, p.dv);
    const double determinant = uu * vv - uv * uv;
    const Vec2 rate = Vec2(vv * along_u - uv * along_v, uu * along_v - uv * along_u) / determinant;

    // Height over the tangent plane: t (n . d) of the ray, t^2 K / 2 of the surface.
    const Vec3 bend = rate.x * rate.x * p.duu + 2 * rate.x * rate.y * p.duv + rate.y * rate.y * p.dvv;
    const double t_step = 2 * dot(p.normal, direction) / dot(p.normal, bend);
    if (!std::isfinite(t_step) || t_step == 0) return std::nullopt;
    return SecondHit{hit.uv + t_step * rate, t_step};
}

}  // namespace trilens
