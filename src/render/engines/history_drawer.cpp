#include "render/engines/path_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/util/parallel.h"
#include "render/engines/fragment_keys.h"

namespace trilens {
namespace {

constexpr double kOnPlane = 1e-6;  // of a facet's size: as far from a plane as rounding puts it

Vec3 share_of(const FacetWeights& weights, const Vec2& at) {
    const Vec3 e = weights.unnormalised(at.x, at.y);
    return e / (e.x + e.y + e.z);
}

/// By the derivatives of origin(w) + t direction(w) and of the film position with respect to the weights.
double magnification(const RayMesh& mesh, Id facet, const Vec3& weights, double t) {
    const IdTriple& corner = mesh.facets[facet];
    const Ray &a = mesh.rays[corner[0]], &b = mesh.rays[corner[1]], &c = mesh.rays[corner[2]];
    const Vec3 &sa = mesh.screen[corner[0]], &sb = mesh.screen[corner[1]], &sc = mesh.screen[corner[2]];
    const Vec3 along_b = b.origin - a.origin + t * (b.direction - a.direction);
    const Vec3 along_c = c.origin - a.origin + t * (c.direction - a.direction);
    const Vec3 ray = weights.x * a.direction + weights.y * b.direction + weights.z * c.direction;
    const double area = triple(normalize_or_zero(ray), along_b, along_c);

    const Vec3 screen = weights.x * sa + weights.y * sb + weights.z * sc;
    const Vec2 pixel = Vec2(screen) / screen.z;
    const Vec2 film_b = (Vec2(sb - sa) - pixel * (sb.z - sa.z)) / screen.z;
    const Vec2 film_c = (Vec2(sc - sa) - pixel * (sc.z - sa.z)) / screen.z;
    const double film = cross(film_b, film_c);
    return area != 0 && std::isfinite(film / area) ? film / area : 0;
}

/// Whether a place lies on the plane of the points from which a node's rays start over a leaf.
bool lies_where_rays_start(const PathNode& node, Id leaf, const Vec3& place) {
    const Id facet = node.facet_of(leaf);
    if (facet == kNone) return false;
    const IdTriple& corner = node.mesh.facets[facet];
    const Vec3& a = node.mesh.rays[corner[0]].origin;
    const Vec3 along_b = node.mesh.rays[corner[1]].origin - a, along_c = node.mesh.rays[corner[2]].origin - a;
    const Vec3 normal = normalize_or_zero(cross(along_b, along_c));
    return normal != Vec3(0) &&
           std::fabs(dot(place - a, normal)) <= kOnPlane * std::max(length(along_b), length(along_c));
}

/// Where the rays of a facet's corners come to the next optic.
std::array<Vec3, 3> places_at_next(const PathNode& node, Id facet) {
    std::array<Vec3, 3> at;
    for (std::size_t k = 0; k < 3; ++k) {
        const Id corner = node.mesh.facets[facet][k];
        at[k] = node.mesh.rays[corner].origin + node.next[corner] * node.mesh.rays[corner].direction;
    }
    return at;
}

/// How far a facet reaches there: the longest of its sides.
double size_at_next(const PathNode& node, Id facet) {
    const std::array<Vec3, 3> at = places_at_next(node, facet);
    return std::max({length(at[1] - at[0]), length(at[2] - at[1]), length(at[0] - at[2])});
}

/// Where the ends of each facet's samples begin in a list that has `before` already.
std::vector<std::size_t> first_ends(const FacetSamples& owned, const std::vector<char>& is_end,
                                    std::size_t before) {
    std::vector<std::size_t> first(owned.first.size(), before);
    for (std::size_t f = 0; f + 1 < first.size(); ++f) {
        first[f + 1] = first[f];
        for (std::size_t i = owned.first[f]; i < owned.first[f + 1]; ++i) first[f + 1] += is_end[i] != 0;
    }
    return first;
}

}  // namespace

/// Whether what a sample sees lies before the next optic or on it: the path ends there.
bool HistoryDrawer::ends_before_next(Id index, Id facet, const Hit& hit, const Vec3& share) const {
    const PathNode& node = paths_.nodes[index];
    const IdTriple& corner = node.mesh.facets[facet];
    double next = 0;
    for (int k = 0; k < 3; ++k) next += share[k] * node.next[corner[static_cast<std::size_t>(k)]];
    if (hit.t <= next * (1 + kTouch)) return true;
    if (!node.touches[facet]) return false;
    if (hit.t <= next * (1 + kNearTouch)) return true;
    const Ray ray = interpolated_ray(node.mesh, facet, share);
    // In a corner of objects on which the optic lies they are farther than the plane through three rays'
    // ends.
    if (node.rests[facet] && (hit.t - next) * length(ray.direction) <= size_at_next(node, facet)) return true;
    const Vec3 place = ray.origin + hit.t * ray.direction;
    return std::any_of(paths_.nodes.begin(), paths_.nodes.end(), [&](const PathNode& other) {
        return other.parent == index && lies_where_rays_start(other, node.leaves[facet], place);
    });
}

/// Which of the owned samples end here; those whose path goes on are marked.
std::vector<char> HistoryDrawer::find_ends(Id index, const FacetSamples& owned, std::span<const Hit> hits) {
    const PathNode& node = paths_.nodes[index];
    std::vector<char>& goes_on = goes_on_[index];
    goes_on.resize(grid_.size(), 0);
    std::vector<char> is_end(owned.sample.size(), 0);
    parallel_for(node.mesh.facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            if (owned.of(f).empty()) continue;
            const FacetWeights weights = facet_weights(node.mesh, f);
            if (weights.edge_on) continue;
            for (std::size_t i = owned.first[f]; i < owned.first[f + 1]; ++i) {
                const Id s = owned.sample[i];
                is_end[i] = node.ends[f] ||
                            (hits[s].seen() && ends_before_next(index, static_cast<Id>(f), hits[s],
                                                                share_of(weights, grid_.position(s))));
                goes_on[s] = !is_end[i];
            }
        }
    });
    return is_end;
}

/// By the sample's place between the camera's own corners, which is the same in every node: so the weights
/// of all ends add up to no more than they do at the corners.
Vec3 HistoryDrawer::weight_at(Id index, Id facet, const Vec3& share) const {
    const PathNode& node = paths_.nodes[index];
    const IdTriple& corner = node.mesh.facets[facet];
    Vec3 place = share;
    if (!node.farther.empty())
        for (int k = 0; k < 3; ++k) place[k] *= node.farther[corner[static_cast<std::size_t>(k)]];
    place /= place.x + place.y + place.z;
    Vec3 weight(0);
    for (int k = 0; k < 3; ++k) weight += place[k] * node.weight[corner[static_cast<std::size_t>(k)]];
    return glm::max(weight, Vec3(0));
}

/// Of t: where a leg meets the next optic. What blends may lie on that, so there it is the plane through the
/// places where the corners' rays meet it, which is where the next legs start.
double HistoryDrawer::up_to_next(Id index, Id facet, const Vec3& share) const {
    const PathNode& node = paths_.nodes[index];
    const IdTriple& corner = node.mesh.facets[facet];
    double next = 0;
    for (int k = 0; k < 3; ++k) next += share[k] * node.next[corner[static_cast<std::size_t>(k)]];
    if (!engine_.world.blended || !std::isfinite(next)) return next;
    const std::array<Vec3, 3> at = places_at_next(node, facet);
    const Vec3 normal = cross(at[1] - at[0], at[2] - at[0]);
    const Ray ray = interpolated_ray(node.mesh, facet, share);
    const double t = dot(normal, at[0] - ray.origin) / dot(normal, ray.direction);
    return std::fabs(t - next) < kNearTouch * next ? t : next;
}

/// The leg of each owned sample through the volumes: up to what it sees where its path ends, else up to the
/// next optic. In glass there is what blends.
void HistoryDrawer::draw_volumes(Id index, const FacetSamples& owned, std::span<const Hit> hits,
                                 const std::vector<char>& is_end) {
    const PathNode& node = paths_.nodes[index];
    std::vector<double>& through = through_[index];
    through = node.parent == kNone ? std::vector<double>(grid_.size(), 1.0) : through_[node.parent];
    const Material* glass = glass_of(engine_.world, node.medium);
    if (glass && !engine_.world.blended) return;
    std::vector<double> until(grid_.size(), 0.0);
    std::vector<char> has_start(grid_.size(), 1);
    std::vector<VolumeLight> light(grid_.size());
    const auto for_each_owned = [&](const auto& body) {
        parallel_for(node.mesh.facets.size(), 64, [&](std::size_t from, std::size_t to) {
            for (std::size_t f = from; f < to; ++f) {
                if (owned.of(f).empty()) continue;
                const FacetWeights weights = facet_weights(node.mesh, f);
                if (weights.edge_on) continue;
                for (std::size_t i = owned.first[f]; i < owned.first[f + 1]; ++i)
                    body(static_cast<Id>(f), i, share_of(weights, grid_.position(owned.sample[i])));
            }
        });
    };
    for_each_owned([&](Id f, std::size_t i, const Vec3& share) {
        const Id s = owned.sample[i];
        const double seen = hits[s].seen() ? hits[s].t : std::numeric_limits<double>::infinity();
        const double next = up_to_next(index, f, share);
        const bool has_end = !glass || node.to_mirror[f];
        until[s] = is_end[i]
                       ? seen
                       : std::min(up_to_optic(interpolated_ray(node.mesh, f, share), next, has_end), seen);
        has_start[s] = node.has_start[f];
    });
    (*engine_.volumes)({node.mesh, owned, grid_, until, glass, has_start}, light);
    for_each_owned([&](Id f, std::size_t i, const Vec3& share) {
        const Id s = owned.sample[i];
        SampleVolumes& found = (*engine_.found)[s];
        (node.path == Path::kReflect ? found.reflect : found.refract) +=
            through[s] * weight_at(index, f, share) * light[s].emission;
        through[s] *= light[s].transmittance;
    });
}

/// Sets the end of a sample over a facet of the node, all but its steps.
void HistoryDrawer::set_end(Id index, Id facet, const Vec3& share, PathEnd& end) const {
    const PathNode& node = paths_.nodes[index];
    end.path = node.path;
    end.principal = node.principal[facet];
    end.colours = node.colours;
    end.node = index;
    end.medium = node.medium;
    end.ray = interpolated_ray(node.mesh, facet, share);
    end.weight = weight_at(index, facet, share);
    if (end.hit.seen()) end.magnification = magnification(node.mesh, facet, share, end.hit.t);
}

void HistoryDrawer::draw(Id index, PathEnds& out) {
    const PathNode& node = paths_.nodes[index];
    const std::span<const char> came =
        node.parent == kNone ? std::span<const char>() : std::span<const char>(goes_on_[node.parent]);
    const FacetSamples owned = group_by_facet(owners_of_node(node, leaf_, came), node.mesh.facets.size());
    if (owned.sample.empty()) return;
    std::vector<Hit> hits(grid_.size());
    engine_.mesh(node.mesh, owned, grid_, hits);
    const std::vector<char> is_end = find_ends(index, owned, hits);
    if (engine_.volumes) draw_volumes(index, owned, hits, is_end);

    // The history, once for all its ends.
    const std::size_t first_step = out.steps.size();
    for (Id n = index; n != kNone; n = paths_.nodes[n].parent) out.steps.push_back(paths_.nodes[n].step);
    std::reverse(out.steps.begin() + static_cast<std::ptrdiff_t>(first_step), out.steps.end());

    const std::vector<std::size_t> first_end = first_ends(owned, is_end, out.ends.size());
    out.ends.resize(first_end.back(), PathEnd());  // copied: made one by one they take longer (measured)
    out.sample.resize(first_end.back());
    parallel_for(node.mesh.facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            if (first_end[f] == first_end[f + 1]) continue;
            const FacetWeights weights = facet_weights(node.mesh, f);
            std::size_t next = first_end[f];
            for (std::size_t i = owned.first[f]; i < owned.first[f + 1]; ++i) {
                if (!is_end[i]) continue;
                const Id s = out.sample[next] = owned.sample[i];
                PathEnd& end = out.ends[next++];
                end.hit = hits[s];
                end.first_step = first_step;
                end.step_count = node.step_count;
                set_end(index, static_cast<Id>(f), share_of(weights, grid_.position(s)), end);
                if (engine_.volumes) end.weight *= through_[index][s];
            }
        }
    });
}

}  // namespace trilens
