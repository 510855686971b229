// Writes a thesis scene: an explicit RayMesh camera and the triangles that it looks at.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "thesis/configuration.h"
#include "thesis/two_facets.h"

namespace trilens {

/// What a file says of its origin.
struct Origin {
    std::string figure;  // the thesis figure's number
    std::uint64_t seed = 0;
    Configuration configuration;  // empty: not one of chapter 4's
};

/// One facet that fills the film, and its triangle. Coordinates are rounded to kDecimals. Throws
/// std::runtime_error where the file cannot be written.
void write_facet_scene(const std::string& file, const Origin& origin, const FacetScene& scene);

/// Two facets on a square film, and the triangle across them.
void write_two_facets(const std::string& file, const Origin& origin, const TwoFacets& two);

/// The same seen from beside: the surface that the shared edge sweeps, cutting the triangle (figure 5.2).
void write_swept_edge(const std::string& file, const Origin& origin, const TwoFacets& two);

inline constexpr int kDecimals = 5;

/// The scene as its file will hold it.
FacetScene rounded(const FacetScene& scene);

}  // namespace trilens
