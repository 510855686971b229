#include "render/node_drawer.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace trilens {
namespace {

constexpr double kNear = 0.05;     // the same where it is known that it lies there: `next` is interpolated
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
    const double film = film_b.x * film_c.y - film_b.y * film_c.x;
    return area != 0 && std::isfinite(film / area) ? film / area : 0;
}

/// Whether a place lies on the plane of the points from which a node's rays start over a facet.
bool lies_where_rays_start(const PathNode& node, Id facet, const Vec3& place) {
    if (facet >= node.mesh.facets.size() || !node.mesh.has_rays(facet)) return false;
    const IdTriple& corner = node.mesh.facets[facet];
    const Vec3& a = node.mesh.rays[corner[0]].origin;
    const Vec3 along_b = node.mesh.rays[corner[1]].origin - a, along_c = node.mesh.rays[corner[2]].origin - a;
    const Vec3 normal = normalize_or_zero(cross(along_b, along_c));
    return normal != Vec3(0) &&
           std::fabs(dot(place - a, normal)) <= kOnPlane * std::max(length(along_b), length(along_c));
}

}  // namespace

/// Whether what a sample sees lies before the next optic or on it: the path ends there.
bool NodeDrawer::ends_before_next(Id index, Id leaf, const Hit& hit, const Vec3& share) const {
    const PathNode& node = paths_.nodes()[index];
    const IdTriple& corner = node.mesh.facets[leaf];
    double next = 0;
    for (int k = 0; k < 3; ++k) next += share[k] * node.next[corner[static_cast<std::size_t>(k)]];
    if (hit.t <= next * (1 + kTouch)) return true;
    if (!node.touches[leaf]) return false;
    if (hit.t <= next * (1 + kNear)) return true;
    const Ray ray = interpolated_ray(node.mesh, leaf, share);
    const Vec3 place = ray.origin + hit.t * ray.direction;
    return std::any_of(paths_.nodes().begin(), paths_.nodes().end(), [&](const PathNode& other) {
        return other.parent == index && lies_where_rays_start(other, leaf, place);
    });
}

/// Samples whose path came as far as this node, with their leaves.
std::vector<Id> NodeDrawer::owners(const PathNode& node) const {
    std::vector<Id> owner(grid_.size(), kNone);
    const std::vector<char>* parent = node.parent == kNone ? nullptr : &goes_on_[node.parent];
    if (parent && parent->empty()) return owner;  // no sample came as far as the node before
    for (std::size_t s = 0; s < owner.size(); ++s) {
        const Id leaf = leaf_[s];
        if (leaf == kNone || leaf >= node.mesh.facets.size() || !node.mesh.has_rays(leaf)) continue;
        if (!parent || (*parent)[s]) owner[s] = leaf;
    }
    return owner;
}

void NodeDrawer::finish(const PathNode& node, Id sample, const FacetWeights& weights, PathEnd& end) const {
    const Id leaf = leaf_[sample];
    const Vec3 share = share_of(weights, grid_.position(sample));
    const IdTriple& corner = node.mesh.facets[leaf];
    end.path = node.path;
    end.principal = node.principal[leaf];
    end.colours = node.colours;
    end.medium = node.medium;
    end.ray = interpolated_ray(node.mesh, leaf, share);
    end.weight = Vec3(0);
    for (int k = 0; k < 3; ++k) end.weight += share[k] * node.weight[corner[static_cast<std::size_t>(k)]];
    end.weight = glm::max(end.weight, Vec3(0));
}

void NodeDrawer::draw(Id index, OpticEnds& out) {
    const PathNode& node = paths_.nodes()[index];
    const FacetSamples owned = group_by_facet(owners(node), node.mesh.facets.size());
    if (owned.sample.empty()) return;
    std::vector<Hit> hits(grid_.size());
    draw_mesh_(node.mesh, owned, grid_, hits);

    // The history, once for all its ends.
    const std::size_t first_step = out.steps.size();
    for (Id n = index; n != kNone; n = paths_.nodes()[n].parent) out.steps.push_back(paths_.nodes()[n].step);
    std::reverse(out.steps.begin() + static_cast<std::ptrdiff_t>(first_step), out.steps.end());

    std::vector<char>& goes_on = goes_on_[index];
    goes_on.resize(grid_.size(), 0);
    std::vector<PathEnd> ends(owned.sample.size());
    std::vector<char> is_end(owned.sample.size(), 0);
    parallel_for(node.mesh.facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t l = from; l < to; ++l) {
            if (owned.of(l).empty()) continue;
            const FacetWeights weights = facet_weights(node.mesh, l);
            if (weights.edge_on) continue;
            for (std::size_t i = owned.first[l]; i < owned.first[l + 1]; ++i) {
                const Id s = owned.sample[i];
                if (!node.ends[l]) {
                    goes_on[s] = !(hits[s].seen() && ends_before_next(index, static_cast<Id>(l), hits[s],
                                                                      share_of(weights, grid_.position(s))));
                    if (goes_on[s]) continue;
                }
                finish(node, s, weights, ends[i]);
                ends[i].node = index;
                ends[i].first_step = first_step;
                ends[i].step_count = node.step_count;
                ends[i].hit = hits[s];
                if (hits[s].seen())
                    ends[i].magnification = magnification(node.mesh, static_cast<Id>(l),
                                                          share_of(weights, grid_.position(s)), hits[s].t);
                is_end[i] = 1;
            }
        }
    });
    for (std::size_t i = 0; i < ends.size(); ++i) {
        if (!is_end[i]) continue;
        out.ends.push_back(ends[i]);
        out.sample.push_back(owned.sample[i]);
    }
}

}  // namespace trilens
