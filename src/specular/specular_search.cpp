// Chooses how a surface is searched: by its bounds, or from regular starts.
#include "specular/specular_search.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "specular/batch_search.h"
#include "specular/branch_and_bound.h"
#include "specular/cell_bvh.h"
#include "specular/cones/normal_cones.h"
#include "specular/sphere_search.h"

namespace trilens {

/// Batches that wait for more points: two queries of each of many threads.
constexpr std::size_t kMostIdle = 64;

struct SpecularSearcher::Impl {
    const Surface& surface;
    CellBvh cells;
    std::mutex guard;
    std::vector<std::unique_ptr<BatchSearch>> idle;  // batches of earlier calls
    Lazy<NormalCones> made_cones;

    /// Of a surface whose normals are not along du x dv.
    const NormalCones& cones() {
        return made_cones.get([&] { return std::make_unique<NormalCones>(surface); });
    }

    std::vector<SpecularSearch> find_in_cells(const SpecularQuery& query, std::span<const Vec3> points,
                                              const SearchLimits& limits);
    std::vector<SpecularSearch> find_on_sphere(const SphereSearch& sphere, std::span<const Vec3> points,
                                               const SearchLimits& limits);
    SphereSearch sphere_search(const SpecularQuery& query, const SearchLimits& limits) const {
        return {surface, query, limits, static_cast<bool>(cells.occluder())};
    }
    std::unique_ptr<BatchSearch> take(const SpecularQuery& query, const SearchLimits& limits);
    void give_back(std::unique_ptr<BatchSearch> batch);
};

std::unique_ptr<BatchSearch> SpecularSearcher::Impl::take(const SpecularQuery& query,
                                                          const SearchLimits& limits) {
    {
        const std::lock_guard lock(guard);
        const auto found = std::find_if(idle.begin(), idle.end(),
                                        [&](const auto& batch) { return batch->serves(query, limits); });
        if (found != idle.end()) {
            std::unique_ptr<BatchSearch> batch = std::move(*found);
            idle.erase(found);
            return batch;
        }
    }
    return std::make_unique<BatchSearch>(surface, cells, query, limits);
}

void SpecularSearcher::Impl::give_back(std::unique_ptr<BatchSearch> batch) {
    const std::lock_guard lock(guard);
    if (idle.size() == kMostIdle) idle.erase(idle.begin());
    idle.push_back(std::move(batch));
}

std::vector<SpecularSearch> SpecularSearcher::Impl::find_in_cells(const SpecularQuery& query,
                                                                  std::span<const Vec3> points,
                                                                  const SearchLimits& limits) {
    std::unique_ptr<BatchSearch> batch = take(query, limits);
    std::vector<SpecularSearch> found = batch->run(points);
    give_back(std::move(batch));
    return found;
}

/// Of points that the sphere's own search says nothing of through the cells.
std::vector<SpecularSearch> SpecularSearcher::Impl::find_on_sphere(const SphereSearch& sphere,
                                                                   std::span<const Vec3> points,
                                                                   const SearchLimits& limits) {
    std::vector<std::optional<SpecularSearch>> known = sphere.find(points);
    std::vector<Vec3> open;
    for (std::size_t p = 0; p < points.size(); ++p)
        if (!known[p]) open.push_back(points[p]);
    std::vector<SpecularSearch> rest;
    if (!open.empty()) rest = find_in_cells(sphere.query(), open, limits);
    std::vector<SpecularSearch> found;
    found.reserve(points.size());
    for (std::size_t p = 0, next = 0; p < points.size(); ++p)
        found.push_back(known[p] ? std::move(*known[p]) : std::move(rest[next++]));
    return found;
}

SpecularSearcher::SpecularSearcher(const Surface& surface, Occluder first_hit)
    : impl_(new Impl{surface, CellBvh(surface, std::move(first_hit)), {}, {}, {}}) {}

SpecularSearcher::~SpecularSearcher() = default;

namespace {

void check(const SpecularQuery& query, const SearchLimits& limits) {
    TRILENS_CHECK(query.eye_index > 0 && query.point_index > 0, "a refractive index is positive");
    TRILENS_CHECK(limits.smallest_cell > 0 && limits.starts > 0, "a search has an end and a start");
}

/// The query as it sees the surface's front, and its back.
std::pair<SpecularQuery, SpecularQuery> both_sides(const SpecularQuery& query) {
    SpecularQuery outside = query, inside = query;
    outside.viewed = ViewedSide::kFront;
    inside.viewed = ViewedSide::kBack;
    std::swap(inside.eye_index, inside.point_index);
    return {outside, inside};
}

SpecularSearch together(SpecularSearch search, const SpecularSearch& other) {
    search.images.insert(search.images.end(), other.images.begin(), other.images.end());
    search.images = distinct_images(std::move(search.images));
    search.complete = search.complete && other.complete;
    search.cells += other.cells;
    search.undecided += other.undecided;
    return search;
}

}  // namespace

namespace {

/// The law's own tolerance, and what an image on a face's border strays.
constexpr double kRoundingAngle = 1e-6;

/// How far a unit direction to a ball's points strays from the one to its centre; 2 inside of the ball.
double stray_of(double radius, double distance) {
    return radius < distance ? 2 * std::sin(0.5 * std::asin(radius / distance)) : 2;
}

/// Whether a normal within the bounds may be along h = n1 e + n2 x of a point within them: h lies in a ball
/// about that of the box's centre, and so, where the ball does not hold the origin, in a cone.
bool may_hold_law(const FaceBounds& bounds, const SpecularQuery& query) {
    const Vec3 centre = 0.5 * (bounds.box.low + bounds.box.high);
    const double radius = 0.5 * length(bounds.box.size());
    const SpecularPath path = specular_path(query, centre);
    const PathIndices n = path_indices(query);
    const double stray =
        n.eye * stray_of(radius, path.eye_distance) + n.point * stray_of(radius, path.point_distance);
    const double bend = length(path.bend);
    if (!(stray < bend)) return true;
    const double off = std::acos(std::min(1.0, std::fabs(dot(bounds.normal, path.bend)) / bend));
    return off <= bounds.angle + std::asin(stray / bend) + kRoundingAngle;
}

}  // namespace

SpecularSearch SpecularSearcher::find(const SpecularQuery& asked, const SearchLimits& limits) const {
    check(asked, limits);
    SpecularQuery query = asked;
    if (const SphereSearch sphere = impl_->sphere_search(asked, limits);
        impl_->cells.bounder() && sphere.applies()) {
        if (auto found = std::move(sphere.find({&asked.point, 1}).front())) return std::move(*found);
        query = sphere.query();
    }
    if (impl_->cells.bounder() && query.own_normals) {
        ViewTree tree(impl_->surface, impl_->cells, query, limits.asks_rays);
        return BranchAndBound(impl_->surface, *impl_->cells.bounder(), tree, limits).run(query);
    }
    SpecularSearch search;
    std::vector<SurfaceParameter> starts;
    if (query.own_normals) {
        starts = regular_starts(impl_->surface, limits.starts);
    } else {
        const auto may = [&](const FaceBounds& bounds) { return may_hold_law(bounds, query); };
        for (const Id face : impl_->cones().faces_where(may))
            append_regular_starts(impl_->surface, face, limits.starts, starts);
    }
    search.cells = starts.size();
    search.images = specular_points(impl_->surface, starts, query);
    return search;
}

SpecularSearch SpecularSearcher::find_in_body(const SpecularQuery& query, const SearchLimits& limits) const {
    const auto [outside, inside] = both_sides(query);
    return together(find(outside, limits), find(inside, limits));
}

std::vector<SpecularSearch> SpecularSearcher::find_each(const SpecularQuery& query,
                                                        std::span<const Vec3> points,
                                                        const SearchLimits& limits) const {
    check(query, limits);
    if (const SphereSearch sphere = impl_->sphere_search(query, limits);
        impl_->cells.bounder() && sphere.applies())
        return impl_->find_on_sphere(sphere, points, limits);
    if (impl_->cells.bounder() && query.own_normals) return impl_->find_in_cells(query, points, limits);
    std::vector<SpecularSearch> found;
    SpecularQuery one = query;
    for (const Vec3& point : points) {
        one.point = point;
        found.push_back(find(one, limits));
    }
    return found;
}

std::vector<SpecularSearch> SpecularSearcher::find_each_in_body(const SpecularQuery& query,
                                                                std::span<const Vec3> points,
                                                                const SearchLimits& limits) const {
    const auto [outside, inside] = both_sides(query);
    std::vector<SpecularSearch> found = find_each(outside, points, limits);
    const std::vector<SpecularSearch> other = find_each(inside, points, limits);
    for (std::size_t p = 0; p < found.size(); ++p) found[p] = together(std::move(found[p]), other[p]);
    return found;
}

}  // namespace trilens
