#include "render/optic_ends.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/follow_sample.h"
#include "render/geometry.h"

namespace trilens {
namespace {

constexpr std::size_t kSamplesPerTask = 256;
constexpr double kTouch = 1e-9;  // of t: an object on which the next optic lies is seen in it

/// The samples that see the optic, by facet of its paths.
FacetSamples samples_by_facet(const OpticEndsParams& params, const OpticPaths& paths, const SampleGrid& grid,
                              const SampleViews& views) {
    std::vector<Id> owner(views.samples.size());
    for (std::size_t s = 0; s < owner.size(); ++s) {
        const SampleView& view = views.samples[s];
        if (view.optic != params.optic)
            owner[s] = kNone;
        else if (paths.is_on_film())
            owner[s] = paths.film_facet(grid.position(s));
        else
            owner[s] = params.framed.mesh_facet(view.facet, grid.position(s));
    }
    return group_by_facet(owner, paths.outline().facets.size());
}

std::vector<Id> seen_facets(const FacetSamples& owned) {
    std::vector<Id> seen;
    for (std::size_t f = 0; f + 1 < owned.first.size(); ++f)
        if (!owned.of(f).empty()) seen.push_back(static_cast<Id>(f));
    return seen;
}

/// The leaf of each sample; kNone: it sees another optic, or none.
std::vector<Id> leaves_of_samples(const OpticPaths& paths, const FacetSamples& owned,
                                  const SampleGrid& grid) {
    std::vector<Id> leaf(grid.size(), kNone);
    parallel_for(paths.outline().facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            if (owned.of(f).empty()) continue;
            const Id facet = static_cast<Id>(f);
            const FacetWeights weights = facet_weights(paths.outline(), f);
            for (const Id s : owned.of(f)) {
                Vec3 e(1);
                if (!paths.is_whole(facet) && !weights.edge_on) {
                    const Vec2 at = grid.position(s);
                    e = weights.unnormalised(at.x, at.y);
                }
                leaf[s] = paths.leaf_at(facet, e / (e.x + e.y + e.z));
            }
        }
    });
    return leaf;
}

Vec3 share_of(const FacetWeights& weights, const Vec2& at) {
    const Vec3 e = weights.unnormalised(at.x, at.y);
    return e / (e.x + e.y + e.z);
}

/// One history drawn: for each sample of it what it sees, and whether its path goes on.
class NodeDrawer {
  public:
    NodeDrawer(const OpticEndsParams& params, const OpticPaths& paths, const SampleGrid& grid,
               const std::vector<Id>& leaf)
        : params_(params), paths_(paths), grid_(grid), leaf_(leaf), goes_on_(paths.nodes().size()) {}

    /// Parents first.
    void draw(Id node, OpticEnds& out);

  private:
    std::vector<Id> owners(const PathNode& node) const;
    void finish(const PathNode& node, Id sample, const FacetWeights& weights, PathEnd& end) const;

    const OpticEndsParams& params_;
    const OpticPaths& paths_;
    const SampleGrid& grid_;
    const std::vector<Id>& leaf_;
    std::vector<std::vector<char>> goes_on_;  // per node and sample
};

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

void NodeDrawer::draw(Id index, OpticEnds& out) {
    const PathNode& node = paths_.nodes()[index];
    const FacetSamples owned = group_by_facet(owners(node), node.mesh.facets.size());
    if (owned.sample.empty()) return;
    std::vector<Hit> hits(grid_.size());
    params_.draw(node.mesh, owned, grid_, hits);

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
            const IdTriple& corner = node.mesh.facets[l];
            for (std::size_t i = owned.first[l]; i < owned.first[l + 1]; ++i) {
                const Id s = owned.sample[i];
                if (!node.ends[l]) {
                    const Vec3 share = share_of(weights, grid_.position(s));
                    double next = 0;
                    for (int k = 0; k < 3; ++k)
                        next += share[k] * node.next[corner[static_cast<std::size_t>(k)]];
                    goes_on[s] = !(hits[s].seen() && hits[s].t <= next * (1 + kTouch));
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

/// The camera's ray where it passes the exact surface by, at the rim of a facet: it goes straight on.
void pass_by(const World& world, SampleView& view, OpticEnds& out) {
    PathEnd end;
    end.path = Path::kReflect;
    end.first_step = out.steps.size();
    end.step_count = 1;
    out.steps.push_back({view.optic, Event::kReflect});
    end.ray = {view.ray.origin + view.depth * view.ray.direction, view.depth * view.ray.direction};
    end.hit = object_tracer(world).first_hit(end.ray);
    view.incidence.cosine = 0;
    out.ends.push_back(end);
}

/// Samples that no facet speaks for.
void follow_samples(const OpticEndsParams& params, const std::vector<Id>& samples, SampleViews& views,
                    OpticEnds& out) {
    const PathWorld& world = path_world(params.world);
    std::vector<OpticEnds> found((samples.size() + kSamplesPerTask - 1) / kSamplesPerTask);
    parallel_for(found.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t task = from; task < to; ++task) {
            OpticEnds& own = found[task];
            const std::size_t last = std::min(samples.size(), (task + 1) * kSamplesPerTask);
            for (std::size_t i = task * kSamplesPerTask; i < last; ++i) {
                SampleView& view = views.samples[samples[i]];
                view.traced = true;
                const auto hit = world.optics[params.optic].tracer->first_hit(view.ray);
                if (hit)
                    follow_sample(params.world, *hit, view, own.ends, own.steps);
                else
                    pass_by(params.world, view, own);
                own.sample.resize(own.ends.size(), samples[i]);
            }
        }
    });
    for (OpticEnds& own : found) {
        for (PathEnd& end : own.ends) end.first_step += out.steps.size();
        out.ends.insert(out.ends.end(), own.ends.begin(), own.ends.end());
        out.sample.insert(out.sample.end(), own.sample.begin(), own.sample.end());
        out.steps.insert(out.steps.end(), own.steps.begin(), own.steps.end());
    }
}

}  // namespace

OpticEnds draw_optic_paths(const OpticEndsParams& params, OpticPaths& paths, const SampleGrid& grid,
                           SampleViews& views) {
    OpticEnds out;
    const FacetSamples owned = samples_by_facet(params, paths, grid, views);
    const std::vector<Id> seen = seen_facets(owned);
    if (seen.empty()) return out;
    paths.prepare(seen);
    const std::vector<Id> leaf = leaves_of_samples(paths, owned, grid);

    NodeDrawer drawer(params, paths, grid, leaf);
    for (const Id node : paths.nodes_in_order()) drawer.draw(node, out);

    std::vector<Id> traced;
    for (std::size_t s = 0; s < leaf.size(); ++s) {
        if (leaf[s] == kNone) continue;
        const PathLeaf& of_sample = paths.leaves()[leaf[s]];
        views.samples[s].leaf = leaf[s];
        views.samples[s].level = of_sample.level;
        views.samples[s].predicted = of_sample.predicted;
        views.samples[s].cut = paths.cut();
        if (of_sample.method == LeafMethod::kTraced) traced.push_back(static_cast<Id>(s));
    }
    follow_samples(params, traced, views, out);
    views.projected_facets += paths.projected_count();
    return out;
}

void collect_ends(const std::vector<OpticEnds>& optics, SampleViews& views) {
    for (const OpticEnds& one : optics)
        for (const Id s : one.sample) ++views.samples[s].end_count;
    std::size_t total = 0;
    for (SampleView& view : views.samples) {
        view.first_end = total;
        total += view.end_count;
        view.end_count = 0;
    }
    views.ends.resize(total);
    for (const OpticEnds& one : optics) {
        const std::size_t steps = views.steps.size();
        views.steps.insert(views.steps.end(), one.steps.begin(), one.steps.end());
        for (std::size_t i = 0; i < one.ends.size(); ++i) {
            SampleView& view = views.samples[one.sample[i]];
            PathEnd& end = views.ends[view.first_end + view.end_count++];
            end = one.ends[i];
            end.first_step += steps;
        }
    }
}

}  // namespace trilens
