#include "render/engines/path_ends.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {

std::vector<Id> seen_facets(const FacetSamples& owned) {
    std::vector<Id> seen;
    for (std::size_t f = 0; f + 1 < owned.first.size(); ++f)
        if (!owned.of(f).empty()) seen.push_back(static_cast<Id>(f));
    return seen;
}

std::vector<Id> leaves_of_samples(const OpticPaths& paths, const FacetSamples& owned,
                                  const SampleGrid& grid) {
    std::vector<Id> leaf(grid.size(), kNone);
    parallel_for(paths.outline.facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            if (owned.of(f).empty()) continue;
            const Id facet = static_cast<Id>(f);
            const FacetWeights weights = facet_weights(paths.outline, f);
            for (const Id s : owned.of(f)) {
                Vec3 e(1);
                if (!paths.is_whole(facet) && !weights.edge_on) {
                    const Vec2 at = grid.position(s);
                    e = weights.unnormalised(at.x, at.y);
                }
                leaf[s] = leaf_at(paths, facet, e / (e.x + e.y + e.z));
            }
        }
    });
    return leaf;
}

namespace {

constexpr std::size_t kEndsPerTask = 256;

/// Calls body(sample of the part, sample of the whole) for all of a part.
template <typename Body>
void for_each_sample(const SampleGrid& part, const SampleGrid& whole, const Body& body) {
    const std::size_t row = part.size() / part.runs();
    for (std::size_t y = 0; y < part.runs(); ++y) {
        const std::size_t first = part.sample_in(whole, y * row);
        for (std::size_t x = 0; x < row; ++x) body(y * row + x, first + x);
    }
}

/// The part's samples that see the optic by one of its facets, by facet of its paths.
FacetSamples samples_by_facet(const PathEndsParams& params, const OpticPaths& paths, const SampleGrid& grid,
                              const SampleViews& views) {
    std::vector<Id> owner(params.part.size(), kNone);
    for_each_sample(params.part, grid, [&](std::size_t s, std::size_t of_grid) {
        const SampleView& view = views.samples[of_grid];
        if (view.optic != params.optic || view.traced) return;
        const Vec2 at = params.part.position(s);
        owner[s] =
            paths.is_on_film() ? film_facet(paths.window, at) : params.framed.mesh_facet(view.facet, at);
    });
    return group_by_facet(owner, paths.outline.facets.size());
}

/// What is drawn: an optic that the camera sees itself, or a nested optic.
struct Shown {
    PathBuilder& builder;
    NestedOptics* nested = nullptr;  // what is seen in it; null: none is a nested optic
    FacetSamples owned;              // by facet of its paths
    std::uint8_t depth = 0;          // nested optics that it lies over
};

/// How the samples of a nested optic came to it.
struct NestedSamples {
    std::vector<Id> owner;           // per sample its facet; kNone: it does not see the nested optic
    std::vector<Id> entry;           // per sample, where it has a facet: of the next two
    std::vector<PathEnd> before;     // the ends that the nested optic takes the place of
    std::vector<Incidence> arrival;  // at the nested optic
};

/// Draws an optic, and what is seen in it, and so on. Samples are those of the part.
class ShownDrawer {
  public:
    ShownDrawer(const PathEndsParams& params, const SampleGrid& whole, SampleViews& views)
        : params_(params), grid_(params.part), whole_(whole), views_(views) {}

    /// Appends the ends of all its samples, but for those to be traced.
    void draw(const Shown& shown, PathEnds& out);

    const std::vector<Id>& traced() const { return traced_; }  // samples of the whole

  private:
    void note(const Shown& shown, const std::vector<Id>& leaf);
    std::vector<NestedSamples> take_covered(const Shown& shown, const std::vector<Id>& leaf,
                                            PathEnds& own) const;
    bool covers(const NestedOptic& one, const CoveringFacet& at, const PathEnd& end) const;
    void put_behind(const NestedOptic& one, const NestedSamples& samples, PathEnds& ends) const;

    const PathEndsParams& params_;
    const SampleGrid &grid_, &whole_;
    SampleViews& views_;
    std::vector<Id> traced_;
};

void ShownDrawer::note(const Shown& shown, const std::vector<Id>& leaf) {
    for_each_sample(grid_, whole_, [&](std::size_t s, std::size_t of_whole) {
        if (leaf[s] == kNone) return;
        const PathLeaf& of_sample = shown.builder.paths().leaves[leaf[s]];
        SampleView& view = views_.samples[of_whole];
        OpticView& on_optic = views_.on_optic(view);
        if (shown.depth == 0) view.leaf = leaf[s];
        view.nested = shown.depth;
        view.level = of_sample.level;
        on_optic.predicted = of_sample.predicted;
        on_optic.cut = most_cut(on_optic.cut, shown.builder.paths().cut);
        on_optic.cut.faint = glm::max(on_optic.cut.faint, of_sample.faint);
        on_optic.deep = glm::max(on_optic.deep, of_sample.too_deep);
        if (of_sample.method == LeafMethod::kTraced) traced_.push_back(static_cast<Id>(of_whole));
    });
    views_.projected_facets += shown.builder.paths().projected_count;
    views_.crowded_out += shown.builder.paths().crowded_out;
}

/// Whether what the ray meets lies no nearer than the nested optic's point there.
bool ShownDrawer::covers(const NestedOptic& one, const CoveringFacet& at, const PathEnd& end) const {
    const Vec3& d = end.ray.direction;
    const double t = dot(one.point(at) - end.ray.origin, d) / dot(d, d);
    return !(end.hit.seen() && end.hit.t <= t * (1 + kTouch));
}

/// Takes the ends out that nested optics cover.
std::vector<NestedSamples> ShownDrawer::take_covered(const Shown& shown, const std::vector<Id>& leaf,
                                                     PathEnds& own) const {
    const auto& nested = shown.nested->all();
    std::vector<NestedSamples> taken(nested.size());
    for (NestedSamples& one : taken) {
        one.owner.assign(grid_.size(), kNone);
        one.entry.resize(grid_.size());
    }
    std::vector<std::optional<NestedPlace>> covered(own.ends.size());
    parallel_for(own.ends.size(), kEndsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const Id s = own.sample[i];
            if (!shown.builder.paths().leaves[leaf[s]].layered) continue;
            const std::optional<NestedPlace> there = shown.nested->at(grid_.position(s));
            if (there && covers(*nested[there->optic], there->facet, own.ends[i])) covered[i] = there;
        }
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < own.ends.size(); ++i) {
        if (!covered[i]) {
            own.ends[kept] = own.ends[i];
            own.sample[kept++] = own.sample[i];
            continue;
        }
        const CoveringFacet& at = covered[i]->facet;
        NestedSamples& samples = taken[covered[i]->optic];
        samples.owner[own.sample[i]] = at.facet;
        samples.entry[own.sample[i]] = static_cast<Id>(samples.before.size());
        samples.before.push_back(own.ends[i]);
        samples.arrival.push_back(nested[covered[i]->optic]->arrival(at));
    }
    own.ends.resize(kept);
    own.sample.resize(kept);
    return taken;
}

/// Makes ends over a nested optic ends over the mirror that it is seen in.
void ShownDrawer::put_behind(const NestedOptic& one, const NestedSamples& samples, PathEnds& ends) const {
    const Id optic = one.optic();
    const Material& material = params_.world.scene.materials[params_.world.optics[optic].material];
    std::vector<Step> steps;
    std::map<std::size_t, std::size_t> moved;  // first step before and now
    for (std::size_t i = 0; i < ends.ends.size(); ++i) {
        PathEnd& end = ends.ends[i];
        const Id entry = samples.entry[ends.sample[i]];
        const auto [found, added] = moved.insert({end.first_step, steps.size()});
        if (added) {
            steps.push_back({one.chain().back(), Event::kReflect});
            const auto own = ends.steps.begin() + static_cast<std::ptrdiff_t>(end.first_step);
            steps.insert(steps.end(), own, own + end.step_count);
        }
        end.first_step = found->second;
        end.step_count = static_cast<std::uint16_t>(end.step_count + 1);
        const Incidence& arrival = samples.arrival[entry];
        const PathEnd& came = samples.before[entry];
        const OpticWeights weights = optic_weights(material, arrival, params_.world.scene.render.fresnel);
        const bool reflected = end.path == Path::kReflect;
        end.weight *= came.weight * (reflected ? weights.reflect : weights.refract);
        // Through glass light goes on where it can.
        if (reflected && !one.is_mirror())
            end.principal = end.principal && reflects_totally(material, arrival);
        end.principal = end.principal && came.principal;
        end.path = came.path;
        end.node = kNone;
    }
    ends.steps = std::move(steps);
}

void append(PathEnds from, PathEnds& to) {
    if (to.ends.empty()) {
        to = std::move(from);
        return;
    }
    for (PathEnd end : from.ends) {
        end.first_step += to.steps.size();
        to.ends.push_back(end);
    }
    to.sample.insert(to.sample.end(), from.sample.begin(), from.sample.end());
    to.steps.insert(to.steps.end(), from.steps.begin(), from.steps.end());
}

void ShownDrawer::draw(const Shown& shown, PathEnds& out) {
    const std::vector<Id> seen = seen_facets(shown.owned);
    if (seen.empty()) return;
    if (shown.nested) shown.nested->build();
    shown.builder.prepare(seen);
    const OpticPaths& paths = shown.builder.paths();
    const std::vector<Id> leaf = leaves_of_samples(paths, shown.owned, grid_);
    PathEnds own;
    std::vector<SampleVolumes> volumes(params_.volumes ? grid_.size() : 0);
    HistoryDrawer drawer({params_.world, params_.draw, params_.volumes, &volumes}, paths, grid_, leaf);
    for (const Id node : nodes_in_order(paths)) drawer.draw(node, own);
    note(shown, leaf);
    if (params_.volumes)
        for_each_sample(grid_, whole_, [&](std::size_t s, std::size_t of_whole) {
            views_.volumes[of_whole].reflect += volumes[s].reflect;
            views_.volumes[of_whole].refract += volumes[s].refract;
        });
    if (shown.nested && !shown.nested->all().empty()) {
        const std::vector<NestedSamples> taken = take_covered(shown, leaf, own);
        for (std::size_t l = 0; l < taken.size(); ++l) {
            NestedOptic& one = *shown.nested->all()[l];
            PathEnds behind;
            draw({one.builder(), one.deeper(),
                  group_by_facet(taken[l].owner, one.builder().paths().outline.facets.size()),
                  static_cast<std::uint8_t>(shown.depth + 1)},
                 behind);
            put_behind(one, taken[l], behind);
            append(std::move(behind), own);
        }
    }
    append(std::move(own), out);
}

}  // namespace

PathEnds draw_optic_paths(const PathEndsParams& params, PathBuilder& paths, SampleViews& views,
                          std::vector<Id>& traced) {
    const SampleGrid& grid = params.grid;
    PathEnds out;
    if (params.part.size() == 0) return out;
    ShownDrawer drawer(params, grid, views);
    drawer.draw({paths, params.nested, samples_by_facet(params, paths.paths(), grid, views)}, out);
    for (Id& s : out.sample) s = static_cast<Id>(params.part.sample_in(grid, s));
    traced.insert(traced.end(), drawer.traced().begin(), drawer.traced().end());
    // Those at the outline were given to the optic without one of its facets.
    for_each_sample(params.part, grid, [&](std::size_t, std::size_t s) {
        if (views.samples[s].optic == params.optic && views.samples[s].traced)
            traced.push_back(static_cast<Id>(s));
    });
    return out;
}

void collect_ends(std::vector<PathEnds> optics, SampleViews& views) {
    constexpr std::size_t kUnplaced = ~std::size_t{0};
    std::size_t total = 0;
    bool alone = true;  // each end is its sample's only one
    for (const PathEnds& one : optics) {
        total += one.ends.size();
        for (const Id s : one.sample) {
            OpticView& view = views.of_optics[s];
            alone = alone && view.end_count == 0;
            ++view.end_count;
            view.first_end = kUnplaced;
        }
    }
    if (alone && optics.size() == 1) {
        views.ends = std::move(optics.front().ends);
        views.steps = std::move(optics.front().steps);
        for (std::size_t i = 0; i < total; ++i) views.of_optics[optics.front().sample[i]].first_end = i;
        return;
    }
    views.ends.resize(total);
    std::size_t placed = 0;
    for (const PathEnds& one : optics) {
        const std::size_t steps = views.steps.size();
        views.steps.insert(views.steps.end(), one.steps.begin(), one.steps.end());
        for (std::size_t i = 0; i < one.ends.size(); ++i) {
            OpticView& view = views.of_optics[one.sample[i]];
            if (view.first_end == kUnplaced) {
                view.first_end = placed;
                placed += std::exchange(view.end_count, 0);
            }
            PathEnd& end = views.ends[view.first_end + view.end_count++];
            end = one.ends[i];
            end.first_step += steps;
        }
    }
}

}  // namespace trilens
