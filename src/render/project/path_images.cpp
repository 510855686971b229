#include "render/project/path_images.h"

#include <algorithm>

#include "base/math/box.h"
#include "base/util/parallel.h"
#include "render/project/image_light.h"
#include "render/world/world.h"
#include "specular/specular_point.h"

namespace trilens {
namespace {

/// Rays of traced parts that one search starts from.
constexpr std::size_t kLoneStarts = 6;
/// A point is free if what its ray meets lies within this share of the way.
constexpr double kPathFreeShare = 1e-6;
constexpr std::size_t kPathFacetsPerTask = 256, kLonePerTask = 4;
/// The cosine of the angle at which a ray still passes near a point.
constexpr double kNearCosine = 0.9995;
/// Traced parts whose paths are held at once, until their rays are added to their histories.
constexpr std::size_t kLoneBatch = 1024;

/// Whether a facet may be seen on the film: some corner behind the eye, or its box on the film.
bool may_be_on_film(const RayMesh& outline, std::size_t facet, const Film& film) {
    Vec2 low(1e300), high(-1e300);
    for (const Id corner : outline.facets[facet]) {
        const Vec3& s = outline.screen[corner];
        if (!(s.z > 0)) return true;
        low = glm::min(low, Vec2(s) / s.z);
        high = glm::max(high, Vec2(s) / s.z);
    }
    return high.x >= 0 && high.y >= 0 && low.x <= film.width && low.y <= film.height;
}

Vec2 lone_pixel(const PathLeaf& leaf) {
    return Vec2(leaf.centre) / leaf.centre.z;
}

bool same_image(const SeveralOpticsImage& a, const SeveralOpticsImage& b) {
    return a.steps == b.steps && length(a.exact.pixel - b.exact.pixel) < kSamePixels;
}

/// Whether the optic itself hides a point of it from the camera. `size`: the optic's, for parallel rays.
bool is_hidden(const ProbeContext& context, const Vec3& screen, const Vec3& point, double size) {
    Ray ray = context.camera.ray(screen, point);
    if (context.camera.parallel) ray = {point - size * ray.direction, size * ray.direction};
    const std::optional<SurfaceHit> hit = context.world->optics[context.optic].tracer->first_hit(ray);
    return hit && hit->t < 1 - kPathFreeShare;
}

/// Which corners of some facets the optic itself hides from the camera.
std::vector<char> hidden_corners(const PathBuilder& paths, const SurfaceGrid& grid,
                                 std::span<const Id> facets, double size) {
    std::vector<char> wanted(grid.corner_point.size(), 0), hidden(grid.corner_point.size(), 0);
    for (const Id f : facets)
        for (const Id corner : grid.facets[f]) wanted[corner] = 1;
    parallel_for(hidden.size(), kPathFacetsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t c = from; c < to; ++c)
            hidden[c] = wanted[c] && is_hidden(paths.context(), paths.paths().outline.screen[c],
                                               grid.points[grid.corner_point[c]], size);
    });
    return hidden;
}

bool is_middle_hidden(const PathBuilder& paths, const SurfaceGrid& grid, Id facet, double size) {
    Vec3 screen(0), middle(0);
    for (const Id corner : grid.facets[facet]) {
        screen += paths.paths().outline.screen[corner] / 3.0;
        middle += grid.points[grid.corner_point[corner]] / 3.0;
    }
    return is_hidden(paths.context(), screen, middle, size);
}

/// The facets that may lie on the film and that the camera may see: it sees a corner or the middle.
std::vector<Id> facets_in_view(const PathBuilder& paths, const SurfaceGrid& grid, const Film& film) {
    std::vector<Id> facets;
    for (Id f = 0; f < paths.paths().outline.facets.size(); ++f)
        if (may_be_on_film(paths.paths().outline, f, film)) facets.push_back(f);
    if (paths.paths().is_on_film()) return facets;
    Box box;
    for (const Vec3& point : grid.points) box.include(point);
    const double size = 2 * length(box.size());
    const std::vector<char> hidden = hidden_corners(paths, grid, facets, size);
    std::vector<char> is_seen(facets.size());
    parallel_for(facets.size(), kPathFacetsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const IdTriple& corner = grid.facets[facets[i]];
            is_seen[i] = !hidden[corner[0]] || !hidden[corner[1]] || !hidden[corner[2]] ||
                         !is_middle_hidden(paths, grid, facets[i], size);
        }
    });
    std::vector<Id> seen;
    for (std::size_t i = 0; i < facets.size(); ++i)
        if (is_seen[i]) seen.push_back(facets[i]);
    return seen;
}

/// Paths as deep as the word goes, those alone that may begin it.
PathWorld world_of_word(const World& world, const EventWord& word) {
    PathWorld paths = path_world(world);
    if (!word.asks()) return paths;
    paths.max_depth = static_cast<int>(word.size()) - 1;
    paths.reflect = paths.reflect && word.allows(0, Event::kReflect);
    paths.refract = paths.refract && word.allows(0, Event::kTransmit);
    return paths;
}

}  // namespace

SeveralOpticsImages::SeveralOpticsImages(const World& world, const Frame& frame, std::size_t optic,
                                         const SeveralOpticsChoice& choice)
    : world_(world),
      frame_(frame),
      choice_(choice),
      followed_(world_of_word(world, choice.word)),
      builder_(make_optic_paths(world, frame, optic, nullptr, &followed_)) {
    builder_.prepare(facets_in_view(builder_, frame.optics[optic].facets->grid(), world.scene.film));
    add_nodes();
    add_lone_rays();
    drop_histories();
}

/// Those that are not asked for.
void SeveralOpticsImages::drop_histories() {
    std::erase_if(histories_, [&](const History& history) {
        return !choice_.word.is(history.steps) || history.most_light < 0.5 * choice_.min_weight;
    });
    places_.clear();
    history_at_.clear();
}

/// By the chain of surfaces where the camera has an eye, from the start's own path; else, or where the chain
/// comes to no image but the start's ray passes near the point, on the film.
std::optional<HistoryImage> SeveralOpticsImages::refine(const HistoryQuery& query, const Vec2& start) const {
    const std::optional<HistoryPath> path = history_path(query, start);
    if (!path) return std::nullopt;
    if (const auto solved = solve_image(world_, frame_, {path->events, start}, {query.point})) {
        std::optional<HistoryImage> image = history_image_at(query, solved->film.pixel);
        if (image && solved->is_regular) {
            image->derivative = solved->derivative;
            return image;
        }
    }
    const double along = dot(path->exit.direction, normalize_or_zero(query.point - path->exit.origin));
    if (along < kNearCosine && chain_eye(frame_.camera)) return std::nullopt;
    return refine_history_image(query, start);
}

void SeveralOpticsImages::add_nodes() {
    const std::vector<PathNode>& nodes = builder_.paths().nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        // Where light parts into colours the middle one stands for all.
        if (nodes[n].step_count < 2 || (nodes[n].colours != kAllColours && nodes[n].colours != 1)) continue;
        std::vector<PathSegment> segments;
        for (Id at = static_cast<Id>(n); at != kNone; at = nodes[at].parent) {
            PathSegment segment;
            segment.step = nodes[at].step;
            segment.colours = nodes[at].colours;
            segment.path = nodes[at].path;
            segments.insert(segments.begin(), segment);
        }
        for (std::size_t i = 0; i < segments.size(); ++i)
            segments[i].parent = i == 0 ? kNone : static_cast<Id>(i - 1);
        History& history = history_of(segments, static_cast<Id>(segments.size() - 1));
        history.seeds = std::make_unique<MeshPointImages>(nodes[n].mesh);
        for (const Vec3& weight : nodes[n].weight)
            history.most_light = std::max(history.most_light, of_worst_colour(weight));
        for (const Id leaf : nodes[n].leaves)
            history.grid_facet.push_back(builder_.paths().leaves[leaf].facet);
    }
}

SeveralOpticsImages::History& SeveralOpticsImages::history_of(const std::vector<PathSegment>& segments,
                                                              Id last) {
    std::vector<Id> chain;
    for (Id s = last; s != kNone; s = segments[s].parent) chain.push_back(s);
    std::reverse(chain.begin(), chain.end());
    Id place = kNone;
    for (const Id s : chain) {
        const Step& step = segments[s].step;
        place = places_.try_emplace({place, step.optic, step.event}, static_cast<Id>(places_.size()))
                    .first->second;
    }
    const auto [known, is_new] = history_at_.try_emplace({place, segments[last].colours}, histories_.size());
    if (!is_new) return histories_[known->second];

    History& made = histories_.emplace_back();
    made.path = segments[last].path;
    for (std::size_t i = 0; i < chain.size(); ++i) {
        PathSegment& segment = made.chain.emplace_back();
        segment.parent = i == 0 ? kNone : static_cast<Id>(i - 1);
        segment.step = segments[chain[i]].step;
        segment.colours = segments[chain[i]].colours;
        segment.ends = chain[i] == last;
        made.steps.push_back(segment.step);
    }
    return made;
}

void SeveralOpticsImages::add_lone_rays() {
    std::vector<const PathLeaf*> traced;
    for (const PathLeaf& leaf : builder_.paths().leaves)
        if (leaf.method == LeafMethod::kTraced && leaf.centre.z > 0) traced.push_back(&leaf);
    std::vector<std::vector<PathSegment>> followed;
    for (std::size_t first = 0; first < traced.size(); first += kLoneBatch) {
        const auto batch = std::span(traced).subspan(first, std::min(kLoneBatch, traced.size() - first));
        followed.assign(batch.size(), {});
        parallel_for(batch.size(), kLonePerTask, [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i) followed[i] = followed_from(lone_pixel(*batch[i]));
        });
        for (std::size_t i = 0; i < batch.size(); ++i) add_lone_rays(*batch[i], followed[i]);
    }
}

std::vector<PathSegment> SeveralOpticsImages::followed_from(const Vec2& pixel) const {
    const PathWorld& world = followed_;
    const Id optic = builder_.context().optic;
    const Ray ray = history_query(world_, frame_, {}, {}).camera_ray(pixel);
    const std::optional<SurfaceHit> hit = world.optics[optic].tracer->first_hit(ray);
    if (!hit) return {};
    const Vec3 incoming = normalize_or_zero(ray.direction);
    return follow_paths(world, {{optic, incoming, hit->point.position, hit->point.normal,
                                 dot(incoming, hit->point.normal) <= 0},
                                hit->t * length(ray.direction),
                                frame_.camera_media.of(ray)})
        .segments;
}

void SeveralOpticsImages::add_lone_rays(const PathLeaf& leaf, const std::vector<PathSegment>& followed) {
    for (std::size_t i = 0; i < followed.size(); ++i) {
        const PathSegment& segment = followed[i];
        if (segment.parent == kNone || (segment.colours != kAllColours && segment.colours != 1)) continue;
        History& history = history_of(followed, static_cast<Id>(i));
        history.lone.push_back({lone_pixel(leaf), leaf.facet, segment.ray});
        history.most_light = std::max(history.most_light, of_worst_colour(segment.weight));
    }
}

/// Film positions to search from, with their facets.
std::vector<std::pair<Vec2, Id>> SeveralOpticsImages::starts(const History& history,
                                                             const Vec3& point) const {
    std::vector<std::pair<Vec2, Id>> starts;
    if (history.seeds)
        for (const MeshPointImage& seed : history.seeds->images(point))
            starts.emplace_back(seed.screen, history.grid_facet[seed.facet]);

    // The lone rays that pass the point at the smallest angles.
    std::vector<std::pair<double, const LoneRay*>> nearest;
    for (const LoneRay& lone : history.lone) {
        const double along = dot(normalize_or_zero(point - lone.exit.origin), lone.exit.direction);
        if (along > 0) nearest.emplace_back(-along, &lone);
    }
    const std::size_t count = std::min(kLoneStarts, nearest.size());
    std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count), nearest.end());
    for (std::size_t i = 0; i < count; ++i)
        starts.emplace_back(nearest[i].second->pixel, nearest[i].second->facet);
    return starts;
}

std::vector<SeveralOpticsImage> SeveralOpticsImages::images(const Vec3& point) const {
    std::vector<Search> searches;
    for (const History& history : histories_)
        for (const auto& [pixel, facet] : starts(history, point))
            searches.push_back({&history, pixel, facet, {}});
    parallel_for(searches.size(), 1, [&](std::size_t from, std::size_t to) {
        HistoryQuery query = history_query(world_, frame_, {}, point);
        const History* asked = nullptr;
        for (std::size_t i = from; i < to; ++i) {
            Search& search = searches[i];
            if (search.history != asked) query.history = search.history->chain;
            asked = search.history;
            search.exact = refine(query, search.start);
        }
    });

    std::vector<SeveralOpticsImage> images;
    for (const Search& search : searches) {
        if (!search.exact) continue;
        const History& history = *search.history;
        SeveralOpticsImage image{history.path, history.steps[0].optic, search.facet, history.steps,
                                 *search.exact};
        const bool known = std::any_of(images.begin(), images.end(),
                                       [&](const SeveralOpticsImage& one) { return same_image(one, image); });
        if (!known) images.push_back(std::move(image));
    }
    return images;
}

}  // namespace trilens
