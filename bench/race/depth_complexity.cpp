// From hit to hit along a share of the rays.
#include "bench/race/depth_complexity.h"

#include <atomic>
#include <cmath>

#include "base/util/parallel.h"
#include "intersect/tracer.h"

namespace trilens_bench {

using namespace trilens;
namespace {

constexpr std::size_t kEvery = 64;

std::size_t depths_along(const Tracer& tracer, const Ray& ray) {
    std::size_t depths = 0;
    double from = 0;
    for (Hit hit = tracer.first_hit(ray, from); hit.seen(); hit = tracer.first_hit(ray, from)) {
        ++depths;
        from = std::nextafter(hit.t * (1 + 2 * kDepthTie), INFINITY);
    }
    return depths;
}

}  // namespace

double depth_complexity(const RaceCourse& course) {
    const Tracer tracer(course.scene);
    std::atomic<std::size_t> depths = 0, rays = 0;
    for (const RaceView& view : course.views) {
        parallel_for(view.mesh->facets.size(), 64, [&](std::size_t first, std::size_t last) {
            for (std::size_t f = first; f < last; ++f) {
                const std::span<const Id> own = view.owned->of(f);
                if (own.empty() || !view.mesh->has_rays(f)) continue;
                const FacetWeights weights = facet_weights(*view.mesh, f);
                for (std::size_t i = 0; i < own.size(); i += kEvery) {
                    const Vec2 position = course.grid.position(own[i]);
                    depths += depths_along(tracer, sample_ray(*view.mesh, f, weights, position));
                    ++rays;
                }
            }
        });
    }
    return rays == 0 ? 0 : static_cast<double>(depths) / static_cast<double>(rays);
}

}  // namespace trilens_bench
