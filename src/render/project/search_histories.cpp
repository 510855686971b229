// The images of one point over one history after the other: each start is led to a path of light, and what
// the camera sees of these is listed once.
#include <algorithm>
#include <utility>

#include "render/project/image_light.h"
#include "render/project/path_images.h"

namespace trilens {
namespace {

/// The cosine of the angle at which a ray still passes near a point.
constexpr double kNearCosine = 0.9995;
/// The camera sees a first meeting if the optic lies nowhere within this share of the way's ends.
constexpr double kFirstShare = 1e-6;
/// So many of the lone rays suffice over one optic: there they stand for silhouettes alone.
constexpr std::size_t kLoneStartsOfOne = 4;

bool same_image(const SeveralOpticsImage& a, const SeveralOpticsImage& b) {
    return a.steps == b.steps && length(a.exact.pixel - b.exact.pixel) < kSamePixels;
}

}  // namespace

/// Those that pass the point at the smallest angles, forward, one of each facet; the first of equals first.
/// `off_film`: parts that lie off the film count, too.
Few<std::size_t, SeveralOpticsImages::kLoneStarts> SeveralOpticsImages::History::nearest_lone(
    const Vec3& point, bool off_film) const {
    Few<std::size_t, kLoneStarts> nearest;
    Few<double, kLoneStarts> squared_cosine;
    for (std::size_t i = 0; i < lone.size(); ++i) {
        if (!off_film && !lone[i].may_be_on_film) continue;
        const Vec3 way = point - lone[i].exit.origin;
        const double along = dot(way, lone[i].exit.direction), square = along * along / dot(way, way);
        const bool is_full = nearest.size() == kLoneStarts;
        if (!(along > 0) || (is_full && !(square > squared_cosine.back()))) continue;
        // One of a facet.
        std::size_t at = 0;
        while (at < nearest.size() && lone[nearest[at]].facet != lone[i].facet) ++at;
        if (at < nearest.size()) {
            if (!(square > squared_cosine[at])) continue;
        } else if (is_full) {
            --at;
        } else {
            nearest.push_back(i), squared_cosine.push_back(square);
        }
        for (; at > 0 && square > squared_cosine[at - 1]; --at) {
            nearest[at] = nearest[at - 1];
            squared_cosine[at] = squared_cosine[at - 1];
        }
        nearest[at] = i;
        squared_cosine[at] = square;
    }
    return nearest;
}

/// One point and one history.
class SeveralOpticsImages::Search {
  public:
    Search(const SeveralOpticsImages& images, const History& history, const Vec3& point)
        : images_(images), history_(history), point_(point) {}

    void from_coaxial(std::size_t run);
    void from_facet(const MeshPointImage& seed);
    void from_lone(std::size_t lone);
    bool has_found() const { return !found_.empty(); }
    std::vector<SeveralOpticsImage> take() { return std::move(found_); }

  private:
    /// Where Newton's method begins.
    struct Start {
        std::span<const PathEvent> events;
        Vec2 pixel{0};
        Id facet = kNone;  // of the grid
    };

    bool solve(const Start& start, const FacetPaths* around);
    void refine_on_film(const Start& start, const Ray& exit);
    std::optional<HistoryImage> proven_image(ChainImage& solved) const;
    const HistoryQuery& query();
    bool add(const Start& start, HistoryImage image);

    const SeveralOpticsImages& images_;
    const History& history_;
    const Vec3& point_;
    std::optional<HistoryQuery> query_;  // made when first needed: most points need none
    std::vector<SeveralOpticsImage> found_;
};

const HistoryQuery& SeveralOpticsImages::Search::query() {
    if (query_) return *query_;
    query_ = history_query(images_.world_, images_.frame_, {}, point_);
    query_->history = history_.chain;
    return *query_;
}

/// False where it is known already.
bool SeveralOpticsImages::Search::add(const Start& start, HistoryImage image) {
    SeveralOpticsImage one{history_.path, history_.steps[0].optic, start.facet, history_.steps,
                           std::move(image)};
    const bool known = std::any_of(found_.begin(), found_.end(),
                                   [&](const SeveralOpticsImage& other) { return same_image(other, one); });
    if (!known) found_.push_back(std::move(one));
    return !known;
}

/// What a path of light is as an image, where the camera's ray is known to go along it.
std::optional<HistoryImage> SeveralOpticsImages::Search::proven_image(ChainImage& solved) const {
    const std::optional<Ray> view = exact_ray(images_.frame_.camera, solved.film.pixel);
    if (!view) return std::nullopt;
    const PathEvent &first = solved.events.front(), &last = solved.events.back();
    const Vec3 to_first = first.point - view->origin;
    if (limit_tracer(images_.world_, first.optic).meets({view->origin, to_first}, 0, 1 - kFirstShare))
        return std::nullopt;
    const CameraMedia& media = images_.frame_.camera_media;
    const std::optional<Vec3> weight = weight_over_several(
        images_.followed_,
        {media.none() ? Media() : media.of(*view), view->origin, solved.events, point_, history_.colours});
    if (!weight) return std::nullopt;
    HistoryImage image;
    image.pixel = solved.film.pixel;
    image.first_way = length(to_first);
    image.distance = length(point_ - last.point);
    image.weight = *weight;
    image.events = std::move(solved.events);
    return image;
}

/// By the chain of surfaces, where the camera has an eye; whether that came to an image.
bool SeveralOpticsImages::Search::solve(const Start& start, const FacetPaths* around) {
    auto solved = solve_image(images_.world_, images_.frame_, {start.events, start.pixel}, {point_});
    if (!solved || !solved->is_regular) return false;
    const Vec2 pixel = solved->film.pixel;
    if (std::any_of(found_.begin(), found_.end(), [&](const SeveralOpticsImage& one) {
            return length(one.exact.pixel - pixel) < kSamePixels;
        }))
        return true;
    std::optional<HistoryImage> image;
    if (around && around->have(pixel, solved->events)) image = proven_image(*solved);
    if (!image) image = history_image_at(query(), pixel);
    if (!image) return false;
    image->derivative = solved->derivative;
    add(start, std::move(*image));
    return true;
}

/// Where the chain comes to no image, or there is none, but the start's ray passes near the point.
void SeveralOpticsImages::Search::refine_on_film(const Start& start, const Ray& exit) {
    const double along = dot(exit.direction, normalize_or_zero(point_ - exit.origin));
    if (along < kNearCosine && chain_eye(images_.frame_.camera)) return;
    if (auto image = refine_history_image(query(), start.pixel)) add(start, std::move(*image));
}

void SeveralOpticsImages::Search::from_coaxial(std::size_t run) {
    std::optional<CoaxialImage> found = history_.coaxial->image(run, point_);
    if (!found) return;
    const Vec2 pixel = found->image.film.pixel;
    std::optional<HistoryImage> image;
    if (found->is_proven) image = proven_image(found->image);
    if (!image) image = history_image_at(query(), pixel);
    if (!image) return;
    image->derivative = found->image.derivative;
    add({{}, pixel, found->facet}, std::move(*image));
}

void SeveralOpticsImages::Search::from_facet(const MeshPointImage& seed) {
    const FacetPaths& paths = history_.facet_paths[seed.facet].get([&] {
        return std::make_unique<FacetPaths>(query(), history_.seeds->screen_corners(seed.facet),
                                            history_.proven[seed.facet] != 0, images_.surface_of_);
    });
    const Id facet = history_.grid_facet[seed.facet];
    if (paths.are_known()) {
        const PerEvent<PathEvent> events = paths.at(seed.screen);
        if (solve({events, seed.screen, facet}, &paths)) return;
    }
    const std::optional<HistoryPath> path = history_path(query(), seed.screen);
    if (!path) return;
    const Start start{path->events, seed.screen, facet};
    if (!solve(start, &paths)) refine_on_film(start, path->exit);
}

void SeveralOpticsImages::Search::from_lone(std::size_t lone) {
    const LoneRay& ray = history_.lone[lone];
    const LonePath& known = history_.lone_paths[lone].get([&] {
        return std::make_unique<LonePath>(lone_path(query(), ray.pixel, ray.reach, images_.surface_of_));
    });
    const KnownPath& path = known.path;
    const Vec3 way = point_ - ray.exit.origin;
    const double distance = length(way), sine = length(cross(way, ray.exit.direction)) / distance;
    if (!path.is_known() || !known.may_reach(sine, distance)) return;
    // Over the same planes there is no other path of light.
    if (path.is_flat && std::any_of(found_.begin(), found_.end(), [&](const SeveralOpticsImage& one) {
            return same_faces(one.exact.events, path.events);
        }))
        return;
    const Start start{path.events, ray.pixel, ray.facet};
    if (!solve(start, nullptr) && !chain_eye(images_.frame_.camera)) refine_on_film(start, ray.exit);
}

/// From the facets that image the point, and from the lone rays that pass it at the smallest angles; of parts
/// off the film only where no facet shows it.
std::vector<SeveralOpticsImage> SeveralOpticsImages::images_over(const History& history,
                                                                 const Vec3& point) const {
    Search search(*this, history, point);
    for (std::size_t run = 0; run < history.coaxial->run_count(); ++run) search.from_coaxial(run);
    if (history.seeds)
        for (const MeshPointImage& seed : history.seeds->images(point)) search.from_facet(seed);

    const Few<std::size_t, kLoneStarts> nearest = history.nearest_lone(point, !search.has_found());
    const std::size_t starts = history.steps.size() > 1 ? kLoneStarts : kLoneStartsOfOne;
    for (std::size_t k = 0; k < std::min(starts, nearest.size()); ++k) search.from_lone(nearest[k]);
    return search.take();
}

std::vector<SeveralOpticsImage> SeveralOpticsImages::images(const Vec3& point) const {
    std::vector<std::vector<SeveralOpticsImage>> over(histories_.size());
    const auto look = [&](std::size_t from, std::size_t to) {
        for (std::size_t h = from; h < to; ++h) over[h] = images_over(histories_[h], point);
    };
    if (over.size() > 1)
        parallel_for(over.size(), 1, look);
    else
        look(0, over.size());

    std::vector<SeveralOpticsImage> images;
    for (std::vector<SeveralOpticsImage>& of_one : over)
        for (SeveralOpticsImage& image : of_one)
            if (std::none_of(images.begin(), images.end(),
                             [&](const SeveralOpticsImage& one) { return same_image(one, image); }))
                images.push_back(std::move(image));
    return images;
}

}  // namespace trilens
