#include "bench/race/view_collector.h"

#include <algorithm>

namespace trilens_bench {

using namespace trilens;
namespace {

bool same(const Ray& a, const Ray& b) {
    return a.origin == b.origin && a.direction == b.direction;
}

bool same(const RayMesh& a, const RayMesh& b) {
    return a.rays.size() == b.rays.size() && a.facets == b.facets && a.screen == b.screen &&
           std::equal(a.rays.begin(), a.rays.end(), b.rays.begin(),
                      [](const Ray& p, const Ray& q) { return same(p, q); });
}

FacetSamples grouped(const std::vector<std::pair<Id, Id>>& owned, std::size_t facets) {
    FacetSamples samples;
    samples.first.assign(facets + 1, 0);
    for (const auto& [facet, sample] : owned) ++samples.first[facet + 1];
    for (std::size_t f = 0; f < facets; ++f) samples.first[f + 1] += samples.first[f];
    samples.sample.resize(owned.size());
    std::vector<std::size_t> next(samples.first.begin(), samples.first.end() - 1);
    for (const auto& [facet, sample] : owned) samples.sample[next[facet]++] = sample;
    return samples;
}

}  // namespace

void ViewCollector::add(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& part) {
    if (owned.sample.empty()) return;
    auto own = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return same(p.mesh, mesh); });
    if (own == parts_.end()) own = parts_.insert(own, Part{mesh, {}});
    for (std::size_t f = 0; f + 1 < owned.first.size(); ++f)
        for (const Id sample : owned.of(f))
            own->owned.emplace_back(static_cast<Id>(f), static_cast<Id>(part.sample_in(film_, sample)));
}

CollectedViews ViewCollector::take() {
    CollectedViews views;
    for (; !parts_.empty(); parts_.pop_front()) {
        Part& part = parts_.front();
        FacetSamples owned = grouped(part.owned, part.mesh.facets.size());
        views.add(std::move(part.mesh), std::move(owned));
    }
    return views;
}

}  // namespace trilens_bench
