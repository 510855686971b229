#include "paths/nested/mirror_chain.h"

#include <algorithm>

#include "base/raymesh/ray_mesh.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::size_t kPointsPerTask = 32;
constexpr std::size_t kMostRoots = 48;  // points that a search is begun from, spread over the grid
constexpr std::uint8_t kMostTries = 2;  // of one point, from different neighbours

using Images = std::vector<std::optional<ChainRay>>;

/// The ray that passes the point at the smallest angle; null where none goes its way.
const ChainRay* nearest_ray(std::span<const ChainRay> rays, const Vec3& point) {
    const ChainRay* best = nullptr;
    double most = 0;
    for (const ChainRay& one : rays) {
        const double along = dot(normalize_or_zero(point - one.ray.origin), one.ray.direction);
        if (along > most) most = along, best = &one;
    }
    return best;
}

/// Spreads from points that have an image to those around them.
class Spread {
  public:
    Spread(const MirrorChain& chain, const SurfaceGrid& grid) : chain_(chain), grid_(grid) {
        images.resize(grid.points.size());
        tries_.resize(grid.points.size(), 0);
        around_ = facets_around(grid.facets, grid.points.size(),
                                [&](Id corner) { return grid.corner_point[corner]; });
        orientation_ = body_orientation(grid);
    }
    void from(Id root);

    Images images;

  private:
    struct Wanted {
        Id point = kNone, start = kNone;
    };
    std::vector<Wanted> around(const std::vector<Id>& front);
    bool may_be_seen(Id point) const;

    const MirrorChain& chain_;
    const SurfaceGrid& grid_;
    FacetsAround around_;
    std::vector<std::uint8_t> tries_;
    int orientation_ = 0;  // see body_orientation()
};

/// Whether some facet at the point may be seen.
bool Spread::may_be_seen(Id point) const {
    const auto facets = around_.of(point);
    return std::any_of(facets.begin(), facets.end(), [&](Id f) {
        return may_face_outside(orientation_, grid_, f, images[point]->ray.direction);
    });
}

std::vector<Spread::Wanted> Spread::around(const std::vector<Id>& front) {
    std::vector<Wanted> wanted;
    for (const Id p : front)
        for (const Id f : around_.of(p))
            for (const Id corner : grid_.facets[f]) {
                const Id q = grid_.corner_point[corner];
                if (!images[q] && tries_[q] < kMostTries) wanted.push_back({q, p});
            }
    std::sort(wanted.begin(), wanted.end(), [](const Wanted& a, const Wanted& b) {
        return a.point != b.point ? a.point < b.point : a.start < b.start;
    });
    wanted.erase(std::unique(wanted.begin(), wanted.end(),
                             [](const Wanted& a, const Wanted& b) { return a.point == b.point; }),
                 wanted.end());
    return wanted;
}

void Spread::from(Id root) {
    std::vector<Id> front{root};
    while (!front.empty()) {
        const std::vector<Wanted> wanted = around(front);
        Images found(wanted.size());
        parallel_for(wanted.size(), kPointsPerTask, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                found[i] =
                    image_over(chain_, grid_.points[wanted[i].point], images[wanted[i].start]->eye_direction);
        });
        front.clear();
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            ++tries_[wanted[i].point];
            if (!found[i]) continue;
            images[wanted[i].point] = std::move(found[i]);
            if (may_be_seen(wanted[i].point)) front.push_back(wanted[i].point);
        }
    }
}

}  // namespace

std::vector<ChainRay> rays_over(const MirrorChain& chain, std::span<const Vec3> towards) {
    Images all(towards.size());
    parallel_for(all.size(), kPointsPerTask, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) all[i] = chain_ray(chain, towards[i]);
    });
    std::vector<ChainRay> rays;
    for (const std::optional<ChainRay>& one : all)
        if (one) rays.push_back(*one);
    return rays;
}

std::vector<std::optional<ChainRay>> grid_images(const MirrorChain& chain, std::span<const ChainRay> starts,
                                                 const SurfaceGrid& grid) {
    Spread spread(chain, grid);
    const std::size_t points = grid.points.size(), stride = std::max<std::size_t>(1, points / kMostRoots);
    for (std::size_t p = 0; p < points; p += stride) {
        if (spread.images[p]) continue;
        const ChainRay* start = nearest_ray(starts, grid.points[p]);
        if (!start) continue;
        spread.images[p] = image_over(chain, grid.points[p], start->eye_direction);
        if (spread.images[p]) spread.from(static_cast<Id>(p));
    }
    return spread.images;
}

}  // namespace trilens
