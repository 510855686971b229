// All reflections in a whole sphere (Alhazen's problem) without a tree: both zeros of the law, where there
// are two.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "specular/specular_search.h"
#include "specular/sphere_images.h"

namespace trilens {

/// Thread-safe to read; the surface must live longer.
class SphereSearch {
  public:
    /// For queries that differ from this in the point alone. `hides`: images that the sphere hides from the
    /// eye are left out.
    SphereSearch(const Surface& surface, const SpecularQuery& query, const SearchLimits& limits, bool hides);

    /// Whether the surface is a whole sphere, and the query one that find_zeros speaks of.
    bool applies() const { return applies_; }

    /// The complete list of a point's images; none where the law has other than two zeros clear of each
    /// other, or that is not known: a search through the surface's cells then says. Only where it applies.
    std::vector<std::optional<SpecularSearch>> find(std::span<const Vec3> points) const;
    /// What is asked of the others: an eye outside sees a sphere's back nowhere.
    const SpecularQuery& query() const { return query_; }

  private:
    struct Zero {
        SpecularPoint point;
        double along = 0;  // h . normal
        bool is_image = false;
    };
    std::optional<Zero> settle(const Vec3& rough, const Vec3& point) const;
    std::optional<SpecularSearch> settle_front(const FrontZeros& zeros, std::size_t lane,
                                               const Vec3& point) const;
    std::optional<SpecularSearch> settle_both(const SphereZeros& zeros, std::size_t lane,
                                              const Vec3& point) const;

    const Surface& surface_;
    SpecularQuery query_;
    bool applies_ = false, asks_front_ = false;
    SphereShape sphere_;
};

}  // namespace trilens
