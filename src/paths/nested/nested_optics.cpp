#include "paths/nested/nested_optics.h"

#include <algorithm>
#include <cmath>

#include "paths/nested/mirror_chain.h"

namespace trilens {

namespace {

constexpr double kOnBorder = 1e-9;         // of the sum of weights
constexpr double kSquaresPerFacet = 1.5;   // a square's side over the mean facet's
constexpr std::size_t kMostSquares = 512;  // along a side

struct Bounds {
    Vec2 low{0}, high{0};
};

Vec2 pixel_of(const Vec3& screen) {
    return Vec2(screen.x, screen.y) / screen.z;
}

Bounds bounds_of(const RayMesh& mesh, const IdTriple& corners) {
    Bounds bounds{pixel_of(mesh.screen[corners[0]]), pixel_of(mesh.screen[corners[0]])};
    for (const Id corner : corners) {
        bounds.low = glm::min(bounds.low, pixel_of(mesh.screen[corner]));
        bounds.high = glm::max(bounds.high, pixel_of(mesh.screen[corner]));
    }
    return bounds;
}

}  // namespace

NestedCover::NestedCover(const RayMesh& outline, std::vector<char> covers) : outline_(&outline) {
    const std::size_t facets = outline.facets.size();
    weights_.resize(facets);
    std::vector<Bounds> bounds(facets);
    double area = 0;
    std::size_t count = 0;
    for (std::size_t f = 0; f < facets; ++f) {
        for (const Id corner : outline.facets[f]) covers[f] = covers[f] && outline.screen[corner].z > 0;
        if (!covers[f]) continue;
        weights_[f] = facet_weights(outline, f);
        covers[f] = !weights_[f].edge_on;
        if (!covers[f]) continue;
        bounds[f] = bounds_of(outline, outline.facets[f]);
        low_ = count == 0 ? bounds[f].low : glm::min(low_, bounds[f].low);
        high_ = count == 0 ? bounds[f].high : glm::max(high_, bounds[f].high);
        const Vec2 size = bounds[f].high - bounds[f].low;
        area += 0.5 * size.x * size.y;
        ++count;
    }
    if (count == 0) return;
    facet_size_ = std::sqrt(area / static_cast<double>(count));
    const Vec2 size = high_ - low_;
    square_ = std::max({kSquaresPerFacet * facet_size_, size.x / kMostSquares, size.y / kMostSquares, 1e-9});
    across_ = static_cast<std::size_t>(size.x / square_) + 1;
    down_ = static_cast<std::size_t>(size.y / square_) + 1;

    // Counted, then put: a facet stands in every square that its bounds touch.
    first_.assign(across_ * down_ + 1, 0);
    const auto each_square = [&](const auto& act) {
        for (std::size_t f = 0; f < facets; ++f) {
            if (!covers[f]) continue;
            const Vec2 from = (bounds[f].low - low_) / square_, to = (bounds[f].high - low_) / square_;
            for (std::size_t j = static_cast<std::size_t>(from.y); j <= static_cast<std::size_t>(to.y); ++j)
                for (std::size_t i = static_cast<std::size_t>(from.x); i <= static_cast<std::size_t>(to.x);
                     ++i)
                    act(std::min(j, down_ - 1) * across_ + std::min(i, across_ - 1), static_cast<Id>(f));
        }
    };
    each_square([&](std::size_t square, Id) { ++first_[square + 1]; });
    for (std::size_t s = 0; s < across_ * down_; ++s) first_[s + 1] += first_[s];
    facet_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    each_square([&](std::size_t square, Id f) { facet_[next[square]++] = f; });
}

bool NestedCover::may_cover(const Vec2& low, const Vec2& high) const {
    if (facet_.empty() || !(low.x <= high_.x && low.y <= high_.y && high.x >= low_.x && high.y >= low_.y))
        return false;
    const auto square = [&](double at, std::size_t count) {
        return std::min(static_cast<std::size_t>(std::max(at, 0.0) / square_), count - 1);
    };
    const std::size_t left = square(low.x - low_.x, across_), right = square(high.x - low_.x, across_);
    const std::size_t top = square(low.y - low_.y, down_), bottom = square(high.y - low_.y, down_);
    for (std::size_t j = top; j <= bottom; ++j)
        if (first_[j * across_ + left] < first_[j * across_ + right + 1]) return true;
    return false;
}

double NestedCover::area() const {
    return (high_.x - low_.x) * (high_.y - low_.y);
}

std::optional<CoveringFacet> NestedCover::at(const Vec2& pixel) const {
    if (facet_.empty() ||
        !(pixel.x >= low_.x && pixel.y >= low_.y && pixel.x <= high_.x && pixel.y <= high_.y))
        return std::nullopt;
    const Vec2 at = (pixel - low_) / square_;
    const std::size_t square = std::min(static_cast<std::size_t>(at.y), down_ - 1) * across_ +
                               std::min(static_cast<std::size_t>(at.x), across_ - 1);
    std::optional<CoveringFacet> best;
    for (std::size_t i = first_[square]; i < first_[square + 1]; ++i) {
        const Id f = facet_[i];
        const Vec3 e = weights_[f].unnormalised(pixel.x, pixel.y);
        const double sum = e.x + e.y + e.z;
        if (!(sum > 0) || std::min({e.x, e.y, e.z}) < -kOnBorder * sum) continue;
        CoveringFacet here{f, e / sum, 0};
        for (int k = 0; k < 3; ++k)
            here.depth +=
                here.weights[k] * outline_->screen[outline_->facets[f][static_cast<std::size_t>(k)]].z;
        if (!best || here.depth < best->depth) best = here;
    }
    return best;
}

namespace {

constexpr double kLeastFacet = 0.25;  // pixels: images of smaller facets are left to tracing
constexpr double kLeastArea = 64;     // square pixels of an image's bounds
constexpr double kPlainArea = 2;      // square pixels: see DivideParams
/// How far, in parts of a facet's size, an outline of chords may lie from the exact one.
constexpr double kOutlineShare = 1.0 / 8;
constexpr double kLeastOutline = 0.02;  // pixels

Vec2 film_pixel(const Vec3& screen) {
    return Vec2(screen.x, screen.y) / screen.z;
}

}  // namespace

MirrorChain mirror_chain(const NestedStage& stage, std::span<const Id> chain) {
    MirrorChain mirrors{stage.eye, {}};
    for (const Id optic : chain)
        mirrors.mirrors.push_back(
            {stage.world.optics[optic].tracer, stage.optics[optic].surface, stage.optics[optic].own_normals});
    return mirrors;
}

NestedOptics::NestedOptics(const NestedStage& stage, std::vector<Id> chain, std::vector<Vec3> towards)
    : stage_(stage), chain_(std::move(chain)), towards_(std::move(towards)) {}

NestedOptics::~NestedOptics() = default;

void NestedOptics::build() {
    if (built_) return;
    built_ = true;
    const MirrorChain mirrors = mirror_chain(stage_, chain_);
    if (std::none_of(stage_.optics.begin(), stage_.optics.end(), [&](const NestedSurface& one) {
            return static_cast<double>(one.grid->points.size()) <= room_;
        }))
        return;
    const std::vector<ChainRay> starts = rays_over(mirrors, towards_);
    for (Id optic = 0; optic < stage_.optics.size(); ++optic) {
        const SurfaceGrid& grid = *stage_.optics[optic].grid;
        if (optic == chain_.back() || static_cast<double>(grid.points.size()) > room_) continue;
        auto images = grid_images(mirrors, starts, grid);
        if (std::none_of(images.begin(), images.end(), [](const auto& one) { return one.has_value(); }))
            continue;
        auto one = std::make_unique<NestedOptic>(stage_, chain_, optic, std::move(images));
        if (one->cover().area() < kLeastArea || one->cover().facet_size() < kLeastFacet) continue;
        nested_.push_back(std::move(one));
    }
}

std::optional<NestedPlace> NestedOptics::at(const Vec2& pixel) const {
    std::optional<NestedPlace> best;
    for (std::size_t l = 0; l < nested_.size(); ++l) {
        const std::optional<CoveringFacet> facet = nested_[l]->cover().at(pixel);
        if (facet && (!best || facet->depth < best->facet.depth)) best = {l, *facet};
    }
    return best;
}

bool NestedOptics::agree(const Vec2& pixel, Id next) const {
    const auto shown = [&](const Vec2& at_pixel) {
        const std::optional<NestedPlace> there = at(at_pixel);
        return there ? nested_[there->optic]->optic() : kNone;
    };
    const Id here = shown(pixel);
    if (here == next) return true;
    double reach = kLeastOutline;
    for (const std::unique_ptr<NestedOptic>& one : nested_)
        if (one->optic() == here || one->optic() == next)
            reach = std::max(reach, kOutlineShare * one->cover().facet_size());
    const double aslant = reach * 0.70710678;
    for (const Vec2& by :
         {Vec2(reach, 0), Vec2(-reach, 0), Vec2(0, reach), Vec2(0, -reach), Vec2(aslant, aslant),
          Vec2(-aslant, aslant), Vec2(aslant, -aslant), Vec2(-aslant, -aslant)})
        if (shown(pixel + by) == next) return true;
    return false;
}

bool NestedOptics::may_cover(Id optic, const Vec2& low, const Vec2& high) const {
    return std::any_of(nested_.begin(), nested_.end(), [&](const std::unique_ptr<NestedOptic>& one) {
        return one->optic() == optic && one->cover().may_cover(low, high);
    });
}

NestedOptic::NestedOptic(const NestedStage& stage, std::vector<Id> chain, Id optic,
                         std::vector<std::optional<ChainRay>> images)
    : stage_(stage),
      chain_(std::move(chain)),
      optic_(optic),
      mirrors_(mirror_chain(stage, chain_)),
      world_(stage.world),
      images_(std::move(images)) {
    world_.max_depth -= static_cast<int>(chain_.size());
    world_.reflect = world_.refract = true;
    const SurfaceGrid& own = grid();
    for (const Id p : own.corner_point)
        views_.push_back(images_[p] ? view_of(*images_[p], own.points[p]) : CornerView{Vec3(0), Vec3(0)});

    DivideParams divide = stage.divide;
    divide.fit = stage.optics[optic].fit;
    divide.plain_area = divide.fit ? 0 : kPlainArea;  // a fit looks inside all facets
    divide.fit_all = true;
    if (world_.optics[optic].mirror && world_.max_depth > 0) {
        std::vector<Id> longer = chain_;
        longer.push_back(optic);
        std::vector<Vec3> towards;
        for (const std::optional<ChainRay>& image : images_)
            if (image) towards.push_back(image->eye_direction);
        deeper_ = std::make_unique<NestedOptics>(stage, std::move(longer), std::move(towards));
        divide.nested_agree = [nested = deeper_.get()](const Vec2& pixel, Id next) {
            return nested->agree(pixel, next);
        };
        divide.nested_covers = [nested = deeper_.get()](Id seen, const Vec2& low, const Vec2& high) {
            return nested->may_cover(seen, low, high);
        };
    }
    builder_ = paths_over_views(ProbeContext{&world_, optic, stage.optics[optic].surface, make_camera()}, own,
                                views_, divide);
    cover_ = NestedCover(builder_->paths().outline, seen_facets());
    if (deeper_) deeper_->set_room(cover_.area());
}

NestedOptic::~NestedOptic() = default;

/// As long as the unfolded way times the ray scale; the depth that of the point seen in flat mirrors.
CornerView NestedOptic::view_of(const ChainRay& ray, const Vec3& point) const {
    const double whole = ray.way + dot(point - ray.ray.origin, ray.ray.direction);
    return {(whole / ray.first_way) * stage_.camera.screen(ray.first),
            whole * ray.ray_scale() * ray.ray.direction};
}

/// Facets that may be seen from outside of the body, if they bound one: behind a hole in the images of its near
/// side the far side's inside is none. And whose image is turned as an odd or even number of mirrors turns it:
/// no fold lies between.
std::vector<char> NestedOptic::seen_facets() const {
    const Vec3 origin = stage_.camera.screen(stage_.eye);
    const double turned = triple(stage_.camera.screen(stage_.eye + Vec3(1, 0, 0)) - origin,
                                 stage_.camera.screen(stage_.eye + Vec3(0, 1, 0)) - origin,
                                 stage_.camera.screen(stage_.eye + Vec3(0, 0, 1)) - origin);
    const SurfaceGrid& own = grid();
    const int orientation = body_orientation(own);
    std::vector<char> seen(own.facets.size(), 0);
    for (std::size_t f = 0; f < seen.size(); ++f) {
        const IdTriple& corner = own.facets[f];
        Vec3 incident(0);
        for (const Id c : corner) incident += normalize_or_zero(views_[c].incident);
        const double mirrored = chain_.size() % 2 == 1 ? -1 : 1;
        const double facing = faces_front(own, corner, incident) ? -1 : 1;
        seen[f] =
            may_face_outside(orientation, own, static_cast<Id>(f), incident) &&
            mirrored * facing * turned *
                triple(views_[corner[0]].screen, views_[corner[1]].screen, views_[corner[2]].screen) >
            0;
    }
    return seen;
}

const ChainRay* NestedOptic::nearest_image(const Vec3& point) const {
    const ChainRay* nearest = nullptr;
    double least = 0;
    for (std::size_t p = 0; p < images_.size(); ++p) {
        if (!images_[p]) continue;
        const Vec3 off = grid().points[p] - point;
        if (nearest && dot(off, off) >= least) continue;
        nearest = &*images_[p];
        least = dot(off, off);
    }
    return nearest;
}

PathCamera NestedOptic::make_camera() const {
    PathCamera camera;
    camera.film = stage_.camera.film;
    camera.screen = [this](const Vec3& point) {
        const ChainRay* near = nearest_image(point);
        const auto image = near ? image_over(mirrors_, point, near->eye_direction) : std::nullopt;
        return image ? view_of(*image, point).screen : Vec3(0);
    };
    camera.ray = [this](const Vec3& screen, const Vec3& chord) {
        if (!(screen.z > 0)) return Ray{};
        const Vec3 at = stage_.camera.point(Vec3(film_pixel(screen), 1));
        const std::optional<ChainRay> over = chain_ray(mirrors_, at - stage_.eye);
        if (!over) return Ray{};
        const double far = dot(chord - over->ray.origin, over->ray.direction);
        const double size = (over->way + far) * over->ray_scale();
        return Ray{over->ray.origin + (far - size) * over->ray.direction, size * over->ray.direction};
    };
    return camera;
}

Incidence NestedOptic::arrival(const CoveringFacet& at) const {
    const IdTriple& corner = grid().facets[at.facet];
    Vec3 incident(0), normal(0);
    for (int k = 0; k < 3; ++k) {
        const Id c = corner[static_cast<std::size_t>(k)];
        incident += at.weights[k] * views_[c].incident;
        normal += at.weights[k] * grid().corner_normal[c];
    }
    const bool front = faces_front(grid(), corner, incident);
    const Vec3 unit = normalize_or_zero(normal) * (front ? 1.0 : -1.0);
    return {std::clamp(-dot(normalize_or_zero(incident), unit), 0.0, 1.0), front};
}

Vec3 NestedOptic::point(const CoveringFacet& at) const {
    Vec3 sum(0);
    for (int k = 0; k < 3; ++k)
        sum += at.weights[k] *
               grid().points[grid().corner_point[grid().facets[at.facet][static_cast<std::size_t>(k)]]];
    return sum;
}

}  // namespace trilens
