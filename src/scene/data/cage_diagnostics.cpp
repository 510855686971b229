#include "scene/data/cage_diagnostics.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "scene/data/polygons.h"

namespace trilens {

// Counts what is legal in a cage but seldom meant: open, non-manifold, repeated, flat.

namespace {

/// An edge of one face: its points in ascending order, and whether the face runs along it that way.
struct FaceEdge {
    int low, high;
    bool ascending;

    bool joins_as(const FaceEdge& other) const { return low == other.low && high == other.high; }
    bool operator<(const FaceEdge& other) const {
        return std::pair(low, high) < std::pair(other.low, other.high);
    }
};

std::vector<FaceEdge> sorted_edges(const Cage& cage) {
    std::vector<FaceEdge> edges;
    edges.reserve(cage.face_vertex_indices.size());
    std::size_t first = 0;
    for (const int count : cage.face_vertex_counts) {
        const auto corners = static_cast<std::size_t>(count);
        for (std::size_t k = 0; k < corners; ++k) {
            const int a = cage.face_vertex_indices[first + k],
                      b = cage.face_vertex_indices[first + (k + 1) % corners];
            edges.push_back({std::min(a, b), std::max(a, b), a < b});
        }
        first += corners;
    }
    std::stable_sort(edges.begin(), edges.end());
    return edges;
}

void count_edges(const std::vector<FaceEdge>& edges, CageDiagnostics& doubts) {
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i;
        while (end < edges.size() && edges[end].joins_as(edges[i])) ++end;
        if (end - i == 1) ++doubts.boundary_edges;
        if (end - i > 2 || (end - i == 2 && edges[i].ascending == edges[i + 1].ascending))
            ++doubts.non_manifold_edges;
        i = end;
    }
}

void count_creases(const Cage& cage, const std::vector<FaceEdge>& edges, CageDiagnostics& doubts) {
    std::size_t first = 0;
    for (const int chain : cage.crease_lengths) {
        for (std::size_t k = first; k + 1 < first + static_cast<std::size_t>(chain); ++k) {
            const int a = cage.crease_indices[k], b = cage.crease_indices[k + 1];
            if (!std::binary_search(edges.begin(), edges.end(),
                                    FaceEdge{std::min(a, b), std::max(a, b), true}))
                ++doubts.unknown_creases;
        }
        first += static_cast<std::size_t>(chain);
    }
}

/// Newell's normal: twice the area of the polygon's projections, for any polygon.
bool is_flat(const Cage& cage, std::size_t first, std::size_t corners) {
    Vec3 twice_area(0);
    double longest = 0;
    const Vec3& origin = cage.points[static_cast<std::size_t>(cage.face_vertex_indices[first])];
    for (std::size_t k = 0; k < corners; ++k) {
        const Vec3 a = cage.points[static_cast<std::size_t>(cage.face_vertex_indices[first + k])] - origin;
        const Vec3 b =
            cage.points[static_cast<std::size_t>(cage.face_vertex_indices[first + (k + 1) % corners])] -
            origin;
        twice_area += cross(a, b);
        longest = std::max(longest, length(b - a));
    }
    return !(length(twice_area) > kNoArea * longest * longest);
}

void count_faces(const Cage& cage, CageDiagnostics& doubts) {
    std::size_t first = 0;
    for (const int count : cage.face_vertex_counts) {
        const auto corners = static_cast<std::size_t>(count);
        const auto begin = cage.face_vertex_indices.begin() + static_cast<std::ptrdiff_t>(first);
        if (std::set<int>(begin, begin + count).size() < corners) ++doubts.repeated_corners;
        if (is_flat(cage, first, corners)) ++doubts.flat_faces;
        first += corners;
    }
}

}  // namespace

double signed_volume(const Cage& cage) {
    double volume = 0;
    std::size_t first = 0;
    for (const int count : cage.face_vertex_counts) {
        const auto corner = [&](std::size_t k) {
            return cage.points[static_cast<std::size_t>(cage.face_vertex_indices[first + k])] -
                   cage.points[0];
        };
        for (std::size_t k = 2; k < static_cast<std::size_t>(count); ++k)
            volume += dot(corner(0), cross(corner(k - 1), corner(k))) / 6;
        first += static_cast<std::size_t>(count);
    }
    return volume;
}

CageDiagnostics diagnose_cage(const Cage& cage) {
    CageDiagnostics doubts;
    const std::vector<FaceEdge> edges = sorted_edges(cage);
    count_edges(edges, doubts);
    count_creases(cage, edges, doubts);
    count_faces(cage, doubts);
    doubts.is_inside_out =
        doubts.boundary_edges == 0 && doubts.non_manifold_edges == 0 && signed_volume(cage) < 0;
    return doubts;
}

// Medians, which a few far points do not move.

namespace {

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

std::optional<std::size_t> find_far_point(const Cage& cage) {
    std::vector<std::size_t> used(cage.face_vertex_indices.begin(), cage.face_vertex_indices.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    if (used.empty()) return std::nullopt;

    Vec3 middle;
    for (int k = 0; k < 3; ++k) {
        std::vector<double> values;
        for (const std::size_t i : used) values.push_back(cage.points[i][k]);
        middle[k] = median(std::move(values));
    }
    std::vector<double> distances;
    std::size_t farthest = 0;
    double largest = 0;
    for (const std::size_t i : used) {
        const Vec3 from_middle = glm::abs(cage.points[i] - middle);
        const double distance = std::max({from_middle.x, from_middle.y, from_middle.z});
        if (distance > 0) distances.push_back(distance);
        if (distance > largest) largest = distance, farthest = i;
    }
    if (distances.empty()) return std::nullopt;
    if (largest / median(std::move(distances)) > kFarthestPoint) return farthest;
    return std::nullopt;
}

}  // namespace trilens
