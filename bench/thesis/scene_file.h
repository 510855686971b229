// Writes a thesis scene: an explicit RayMesh camera and the triangles that it looks at; two facets that share
// an edge, and a triangle across it whose straight edges do not meet there (Vallance 2005, figure 5.1).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "thesis/search.h"

namespace trilens {

// Two facets that share an edge, and a scene triangle across it whose straight edges do not meet there
// (Vallance 2005, figure 5.1).

/// Corners 0, 1, 2, 3 of a square on the screen, clockwise from its top left; facets (0, 1, 2) and (0, 2, 3).
struct TwoFacets {
    std::array<Ray, 4> corner;
    SceneTriangle triangle;
    double gap =
        0;  // how far the straight edges miss one another on the shared edge, as a share of its length
};

/// Seeks a clear discontinuity; the same for the same seed.
TwoFacets search_discontinuity(std::uint64_t seed);

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
