#include "render/project/path_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/math/box.h"
#include "base/util/parallel.h"
#include "paths/facets/divide_facet.h"
#include "render/project/image_light.h"
#include "render/world/world.h"
#include "specular/specular_point.h"

namespace trilens {
namespace {

/// A point is free if what its ray meets lies within this share of the way.
constexpr double kPathFreeShare = 1e-6;
constexpr std::size_t kPathFacetsPerTask = 256;
/// Traced parts whose paths are held at once, until their rays are added to their histories.
constexpr std::size_t kTracedBatch = 1024;
constexpr std::size_t kManySteps = 256;
/// Rays that turn by more than this chord from corner to corner are no seed's.
constexpr double kMostSeedTurn = 1.0;
/// The surface lies no farther from the middle of its facet, in multiples of the way to the facet's corners.
constexpr double kFacetReach = 4;

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

std::array<Vec3, 3> corners_of(const RayMesh& outline, Id facet) {
    const IdTriple& c = outline.facets[facet];
    return {outline.screen[c[0]], outline.screen[c[1]], outline.screen[c[2]]};
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

/// Facets without rays stay such.
void append(RayMesh& mesh, const RayMesh& more) {
    const Id first = static_cast<Id>(mesh.rays.size());
    mesh.rays.insert(mesh.rays.end(), more.rays.begin(), more.rays.end());
    mesh.screen.insert(mesh.screen.end(), more.screen.begin(), more.screen.end());
    for (IdTriple facet : more.facets) {
        for (Id& corner : facet)
            if (corner != kNone) corner += first;
        mesh.facets.push_back(facet);
    }
}

/// The largest chord between the directions of three rays.
double turn_of(const std::array<const PathSegment*, 3>& ends) {
    const auto chord = [&](std::size_t a, std::size_t b) {
        return length(ends[a]->ray.direction - ends[b]->ray.direction);
    };
    return std::max({chord(0, 1), chord(1, 2), chord(2, 0)});
}

/// Whether all rays of a facet of a node are known to have its history: they are but for paths so faint that
/// nobody asked, and behind places that rest on an object (one_history.cpp).
bool is_proven(const OpticPaths& paths, Id node, std::size_t facet) {
    const Id leaf = paths.nodes[node].leaves[facet];
    for (Id at = node; at != kNone; at = paths.nodes[at].parent) {
        const PathNode& one = paths.nodes[at];
        const Id own = one.facet_of(leaf);
        if (own == kNone) return false;
        bool is_bright = one.principal[own];
        for (const Id corner : one.mesh.facets[own])
            is_bright = is_bright || of_worst_colour(one.weight[corner]) > kMuchLight * kLeastWeight;
        if (!is_bright || (at != node && one.rests[own])) return false;
    }
    return true;
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
      builder_(make_optic_paths(world, frame, optic, nullptr, &followed_)),
      surface_of_([&world](Id other) -> const Surface& { return *world.optics[other].surface; }) {
    builder_.prepare(facets_in_view(builder_, frame.optics[optic].facets->grid(), world.scene.film));
    add_nodes();
    add_film_parts();
    drop_histories();
    get_ready();
}

/// Those that are not asked for.
void SeveralOpticsImages::drop_histories() {
    std::erase_if(histories_, [&](const History& history) {
        return !choice_.word.is(history.steps) || history.most_light < 0.5 * choice_.min_weight;
    });
    places_.clear();
    history_at_.clear();
}

/// Rows of what is made later; of optics whose normals are not their own, exact rays alone tell.
void SeveralOpticsImages::get_ready() {
    for (History& history : histories_) {
        find_coaxial(history);
        if (!history.mesh.facets.empty()) history.seeds = std::make_unique<MeshPointImages>(history.mesh);
        history.mesh = {};
        for (const PathSegment& segment : history.chain) history.colours.push_back(segment.colours);
        if (!std::all_of(history.steps.begin(), history.steps.end(), [&](const Step& step) {
                return has_own_normals(world_.scene.meshes[world_.optics[step.optic].mesh]);
            }))
            history.proven.assign(history.proven.size(), 0);
        history.facet_paths = std::make_unique<Lazy<FacetPaths>[]>(history.grid_facet.size());
        history.lone_paths = std::make_unique<Lazy<LonePath>[]>(history.lone.size());
    }
}

/// Facets and lone rays whose images are found over coaxial interfaces are no seeds.
void SeveralOpticsImages::find_coaxial(History& history) const {
    history.coaxial = std::make_unique<CoaxialImages>(
        world_, frame_, HistoryFacets{history.chain, history.mesh, history.grid_facet, history.proven});
    if (history.coaxial->hold_all()) {
        history.mesh = {};
        history.lone.clear();
    }
    std::erase_if(history.lone,
                  [&](const LoneRay& ray) { return history.coaxial->hold(ray.pixel, ray.exit); });
    for (std::size_t f = 0; f < history.mesh.facets.size(); ++f)
        if (history.coaxial->hold(f)) history.mesh.facets[f] = {kNone, kNone, kNone};
}

void SeveralOpticsImages::add_nodes() {
    const std::vector<PathNode>& nodes = builder_.paths().nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        // Where light parts into colours the middle one stands for all.
        if (nodes[n].step_count < choice_.least_steps ||
            (nodes[n].colours != kAllColours && nodes[n].colours != 1))
            continue;
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
        append(history.mesh, nodes[n].mesh);
        for (const Vec3& weight : nodes[n].weight)
            history.most_light = std::max(history.most_light, of_worst_colour(weight));
        for (std::size_t f = 0; f < nodes[n].leaves.size(); ++f) {
            history.grid_facet.push_back(builder_.paths().leaves[nodes[n].leaves[f]].facet);
            history.proven.push_back(is_proven(builder_.paths(), static_cast<Id>(n), f));
        }
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

/// The triangles that are traced: their places on the film by the tree of parts.
std::vector<FilmTriangle> SeveralOpticsImages::traced_triangles() const {
    const OpticPaths& paths = builder_.paths();
    std::vector<FilmTriangle> traced;
    const std::function<void(const PathCell&, const FilmTriangle&)> visit = [&](const PathCell& cell,
                                                                                const FilmTriangle& at) {
        if (cell.children == kNone) {
            if (cell.leaf == kNone) return;
            const PathLeaf& leaf = paths.leaves[cell.leaf];
            if (leaf.method == LeafMethod::kTraced && leaf.centre.z > 0) traced.push_back(at);
            return;
        }
        const auto& [a, b, c] = at.screen;
        const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
        const std::array<std::array<Vec3, 3>, 4> parts{{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {bc, ca, ab}}};
        for (std::size_t k = 0; k < 4; ++k)
            visit(paths.cells[cell.children + static_cast<Id>(k)], {at.facet, parts[k]});
    };
    for (Id facet = 0; facet < paths.outline.facets.size(); ++facet)
        visit(paths.cells[facet], {facet, corners_of(paths.outline, facet)});
    return traced;
}

/// Where facets are traced, finer ones by exact rays, and the rays at borders of histories.
void SeveralOpticsImages::add_film_parts() {
    FilmPartsQuestion question;
    question.film = Vec2(world_.scene.film.width, world_.scene.film.height);
    question.follow = [this](Id facet, const Vec2& pixel) { return followed_from(facet, pixel); };
    question.asks = [this](std::span<const Step> steps) { return choice_.word.is(steps); };
    question.least_steps = choice_.least_steps;
    // Passing through without an interface is a step, and no letter.
    if (choice_.word.asks()) question.most_steps = kManySteps;
    const std::vector<FilmTriangle> traced = traced_triangles();
    for (std::size_t first = 0; first < traced.size(); first += kTracedBatch) {
        const auto batch = std::span(traced).subspan(first, std::min(kTracedBatch, traced.size() - first));
        for (const FilmParts& parts : divide_film(question, batch)) {
            std::vector<char> begun;
            for (const FilmPart& part : parts.parts) add_film_part(parts, part, begun);
        }
    }
}

/// Whether a place of the surface may be the facet's, not one of another sheet before or behind it.
bool SeveralOpticsImages::is_near_facet(Id facet, const Vec3& place) const {
    if (builder_.paths().is_on_film()) return true;
    const SurfaceGrid& grid = frame_.optics[builder_.context().optic].facets->grid();
    std::array<Vec3, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = grid.points[grid.corner_point[grid.facets[facet][k]]];
    const Vec3 middle = (corner[0] + corner[1] + corner[2]) / 3.0;
    double size = 0;
    for (const Vec3& one : corner) size = std::max(size, length(one - middle));
    return length(place - middle) <= kFacetReach * size;
}

std::vector<PathSegment> SeveralOpticsImages::followed_from(Id facet, const Vec2& pixel) const {
    const PathWorld& world = followed_;
    const Id optic = builder_.context().optic;
    const Ray ray = history_query(world_, frame_, {}, {}).camera_ray(pixel);
    const std::optional<SurfaceHit> hit = world.optics[optic].tracer->first_hit(ray);
    if (!hit || !is_near_facet(facet, hit->point.position)) return {};
    const Vec3 incoming = normalize_or_zero(ray.direction);
    return follow_paths(world, {{optic, incoming, hit->point.position, hit->point.normal,
                                 dot(incoming, hit->point.normal) <= 0},
                                hit->t * length(ray.direction),
                                frame_.camera_media.of(ray)})
        .segments;
}

/// `begun`: which histories have a lone ray of these parts. Each gets one, for the surface may reach beyond
/// its facets' rim.
void SeveralOpticsImages::add_film_part(const FilmParts& parts, const FilmPart& part,
                                        std::vector<char>& begun) {
    std::array<Vec3, 3> screen;
    for (std::size_t k = 0; k < 3; ++k) screen[k] = parts.places[part.corner[k]].screen;
    const double reach = longest_side(screen);
    const bool is_on_film = may_reach_film(screen, Vec2(world_.scene.film.width, world_.scene.film.height));
    for (std::size_t k = 0; k < 3; ++k) {
        const FollowedPlace& place = parts.places[part.corner[k]];
        for (const HistoryThere& there : place.histories) {
            std::array<const PathSegment*, 3> segment{};
            for (std::size_t j = 0; j < 3; ++j) segment[j] = parts.places[part.corner[j]].segment_of(there);
            if (std::any_of(segment.begin(), segment.begin() + static_cast<std::ptrdiff_t>(k),
                            [](const PathSegment* one) { return one != nullptr; }))
                continue;  // told from that corner
            History& history = history_of(place.segments, there.last);
            history.most_light = std::max(history.most_light, of_worst_colour(segment[k]->weight));
            const bool is_all = k == 0 && segment[1] && segment[2] && turn_of(segment) <= kMostSeedTurn;
            if (is_all) add_fine_facet(history, parts.facet, screen, segment);
            const auto number = static_cast<std::size_t>(&history - histories_.data());
            begun.resize(std::max(begun.size(), number + 1), 0);
            if (!is_all || part.is_open || !std::exchange(begun[number], 1))
                history.lone.push_back(
                    {Vec2(place.screen) / place.screen.z, parts.facet, segment[k]->ray, reach, is_on_film});
        }
    }
}

void SeveralOpticsImages::add_fine_facet(History& history, Id facet, const std::array<Vec3, 3>& screen,
                                         const std::array<const PathSegment*, 3>& ends) {
    std::vector<Ray> rays;
    for (const PathSegment* end : ends) rays.push_back({end->ray.origin, end->way * end->ray.direction});
    append(history.mesh, {std::move(rays), {screen.begin(), screen.end()}, {{0, 1, 2}}});
    history.grid_facet.push_back(facet);
    history.proven.push_back(0);
}

}  // namespace trilens
