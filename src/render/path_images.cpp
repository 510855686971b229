#include "render/path_images.h"

#include <algorithm>

#include "base/box.h"
#include "camera/specular_point.h"
#include "render/geometry.h"

namespace trilens {
namespace {

/// Rays of traced parts that one search starts from.
constexpr std::size_t kLoneStarts = 6;
/// A point is free if what its ray meets lies within this share of the way.
constexpr double kFreeShare = 1e-6;

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

bool same_image(const SeveralOpticsImage& a, const SeveralOpticsImage& b) {
    return a.steps == b.steps && length(a.exact.pixel - b.exact.pixel) < kSamePixels;
}

/// Whether the optic itself hides a point of it from the camera. `size`: the optic's, for parallel rays.
bool is_hidden(const Looking& looking, const Vec3& screen, const Vec3& point, double size) {
    Ray ray = looking.camera.ray(screen, point);
    if (looking.camera.parallel) ray = {point - size * ray.direction, size * ray.direction};
    const std::optional<SurfaceHit> hit = looking.world->optics[looking.optic].tracer->first_hit(ray);
    return hit && hit->t < 1 - kFreeShare;
}

/// Whether the camera may see a facet of a grid: it sees a corner or the middle.
bool may_be_seen(const OpticPaths& paths, const SurfaceGrid& grid, std::size_t facet, double size) {
    if (paths.is_on_film()) return true;
    Vec3 screen(0), middle(0);
    for (const Id corner : grid.facets[facet]) {
        const Vec3& point = grid.points[grid.corner_point[corner]];
        if (!is_hidden(paths.looking(), paths.outline().screen[corner], point, size)) return true;
        screen += paths.outline().screen[corner] / 3.0;
        middle += point / 3.0;
    }
    return !is_hidden(paths.looking(), screen, middle, size);
}

}  // namespace

HistoryQuery history_query(const World& world, const Frame& frame, const std::vector<Step>& steps,
                           const Vec3& point) {
    HistoryQuery query;
    query.world = &path_world(world);
    query.camera_ray = [&camera = frame.camera](const Vec2& pixel) {
        return exact_ray(camera, pixel).value_or(Ray{});
    };
    if (!frame.surroundings.none())
        query.around = [&frame](const Ray& ray) { return frame.surroundings.of(ray); };
    for (std::size_t i = 0; i < steps.size(); ++i) {
        PathSegment segment;
        segment.parent = i == 0 ? kNone : static_cast<Id>(i - 1);
        segment.step = steps[i];
        segment.ends = i + 1 == steps.size();
        query.history.push_back(segment);
    }
    query.point = point;
    return query;
}

SeveralOpticsImages::SeveralOpticsImages(const World& world, const Frame& frame, std::size_t optic)
    : world_(world), frame_(frame), paths_(make_optic_paths(world, frame, optic)) {
    const SurfaceGrid& grid = frame.optics[optic].facets->grid();
    Box box;
    for (const Vec3& point : grid.points) box.include(point);
    const double size = 2 * length(box.size());
    std::vector<Id> facets;
    for (std::size_t f = 0; f < paths_->outline().facets.size(); ++f)
        if (may_be_on_film(paths_->outline(), f, world.scene.film) && may_be_seen(*paths_, grid, f, size))
            facets.push_back(static_cast<Id>(f));
    paths_->prepare(facets);
    std::vector<Id> facet_of_leaf;
    for (const PathLeaf& leaf : paths_->leaves()) facet_of_leaf.push_back(leaf.facet);
    const std::vector<PathNode>& nodes = paths_->nodes();
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
        history.facet_of_leaf = facet_of_leaf;
    }
    for (const PathLeaf& leaf : paths_->leaves())
        if (leaf.method == LeafMethod::kTraced) add_lone_rays(leaf);
    may_miss_ = !histories_.empty();
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

void SeveralOpticsImages::add_lone_rays(const PathLeaf& leaf) {
    if (!(leaf.centre.z > 0)) return;
    const PathWorld& world = path_world(world_);
    const Id optic = paths_->looking().optic;
    const Vec2 pixel = Vec2(leaf.centre) / leaf.centre.z;
    const Ray ray = history_query(world_, frame_, {}, {}).camera_ray(pixel);
    const std::optional<SurfaceHit> hit = world.optics[optic].tracer->first_hit(ray);
    if (!hit) return;
    const Vec3 incoming = normalize_or_zero(ray.direction);
    const FollowedPaths followed = follow_paths(
        world,
        {{optic, incoming, hit->point.position, hit->point.normal, dot(incoming, hit->point.normal) <= 0},
         hit->t * length(ray.direction),
         frame_.surroundings.of(ray)});
    for (std::size_t i = 0; i < followed.segments.size(); ++i) {
        const PathSegment& segment = followed.segments[i];
        if (segment.parent == kNone || (segment.colours != kAllColours && segment.colours != 1)) continue;
        history_of(followed.segments, static_cast<Id>(i)).lone.push_back({pixel, leaf.facet, segment.ray});
    }
}

/// Film positions to search from, with their facets.
std::vector<std::pair<Vec2, Id>> SeveralOpticsImages::starts(const History& history,
                                                             const Vec3& point) const {
    std::vector<std::pair<Vec2, Id>> starts;
    if (history.seeds)
        for (const MeshPointImage& seed : history.seeds->images(point))
            starts.emplace_back(seed.screen, history.facet_of_leaf[seed.facet]);

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
    std::vector<SeveralOpticsImage> images;
    for (const History& history : histories_) {
        HistoryQuery query = history_query(world_, frame_, {}, point);
        query.history = history.chain;
        for (const auto& [pixel, facet] : starts(history, point)) {
            const std::optional<HistoryImage> exact = refine_history_image(query, pixel);
            if (!exact) continue;
            SeveralOpticsImage image{history.path, history.steps[0].optic, facet, history.steps, *exact};
            const bool known = std::any_of(images.begin(), images.end(), [&](const SeveralOpticsImage& one) {
                return same_image(one, image);
            });
            if (!known) images.push_back(std::move(image));
        }
    }
    return images;
}

}  // namespace trilens
