// From many starts to all images of a point, each once.
#include <algorithm>
#include <utility>

#include "base/util/check.h"
#include "specular/specular_point.h"

namespace trilens {

std::vector<SpecularPoint> specular_points(const Surface& surface, std::span<const SurfaceParameter> starts,
                                           const SpecularQuery& query) {
    std::vector<SpecularPoint> images;
    for (const SurfaceParameter& start : starts) {
        if (const auto image = refine_specular_point(surface, start, query)) images.push_back(*image);
    }
    return distinct_images(std::move(images));
}

std::vector<SurfaceParameter> regular_starts(const Surface& surface, int n) {
    TRILENS_CHECK(n > 0, "a domain is divided into one cell at least");
    std::vector<SurfaceParameter> starts;
    for (Id face = 0; face < surface.face_count(); ++face) {
        const bool triangle = surface.domain(face) == FaceDomain::kTriangle;
        const double middle = triangle ? 1.0 / 3 : 0.5;
        for (int row = 0; row < n; ++row) {
            for (int column = 0; column < (triangle ? n - row : n); ++column) {
                starts.push_back({face, (Vec2(column, row) + middle) / static_cast<double>(n)});
            }
        }
    }
    return starts;
}

std::vector<SpecularPoint> distinct_images(std::vector<SpecularPoint> images) {
    std::stable_sort(images.begin(), images.end(),
                     [](const SpecularPoint& a, const SpecularPoint& b) { return a.residual < b.residual; });
    auto same = [](const SpecularPoint& a, const SpecularPoint& b) {
        return a.front == b.front && length(a.pixel - b.pixel) < kSamePixels &&
               length(a.position - b.position) <= kSameCrossing * a.distance;
    };
    std::vector<SpecularPoint> distinct;
    for (const SpecularPoint& image : images) {
        const bool known = std::any_of(distinct.begin(), distinct.end(),
                                       [&](const SpecularPoint& other) { return same(other, image); });
        if (!known) distinct.push_back(image);
    }
    std::stable_sort(distinct.begin(), distinct.end(),
                     [](const SpecularPoint& a, const SpecularPoint& b) { return a.t < b.t; });
    return distinct;
}

}  // namespace trilens
