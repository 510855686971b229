// The gate for cages: what cannot be used is an error, what can be read sensibly is repaired and said.
#include "surfaces/checked_cage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <unordered_set>

#include "base/util/error.h"

namespace trilens {
namespace {

struct Gate {
    const Cage& cage;
    const std::string& name;
    const Warn& warn;

    [[noreturn]] void refuse(const std::string& field, const std::string& why) const {
        throw InputError(name, field, why);
    }
    void say(const std::string& message) const {
        if (warn) warn(name + ": " + message);
    }
    void check_indices(const std::string& field, const std::vector<int>& indices, std::size_t count) const {
        for (std::size_t i = 0; i < indices.size(); ++i) {
            if (indices[i] >= 0 && static_cast<std::size_t>(indices[i]) < count) continue;
            refuse(field, "entry " + std::to_string(i) + " is " + std::to_string(indices[i]) +
                              ", but there are " + std::to_string(count));
        }
    }
    float sharpness(const std::string& field, double value) const {
        if (!(value >= 0)) refuse(field, "a sharpness is not a number >= 0");
        return static_cast<float>(std::min(value, double{kInfiniteSharpness}));
    }
};

void check_points(const Gate& gate) {
    for (std::size_t i = 0; i < gate.cage.points.size(); ++i) {
        const Vec3& p = gate.cage.points[i];
        if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
        gate.refuse("points", "point " + std::to_string(i) + " is not finite");
    }
}

void check_counts(const Gate& gate) {
    const Cage& cage = gate.cage;
    if (cage.face_vertex_counts.empty()) gate.refuse("faceVertexCounts", "the cage has no faces");
    std::size_t total = 0;
    for (std::size_t f = 0; f < cage.face_vertex_counts.size(); ++f) {
        const int count = cage.face_vertex_counts[f];
        const std::string face = "face " + std::to_string(f) + " has " + std::to_string(count) + " corners";
        if (count < 3 || count > kMostCorners)
            gate.refuse("faceVertexCounts", face + ", not 3 to " + std::to_string(kMostCorners));
        if (cage.scheme == SubdivisionScheme::kLoop && count != 3)
            gate.refuse("faceVertexCounts", face + ", but Loop subdivision is for triangles");
        total += static_cast<std::size_t>(count);
    }
    if (total != cage.face_vertex_indices.size())
        gate.refuse("faceVertexIndices", "has " + std::to_string(cage.face_vertex_indices.size()) +
                                             " entries, but the faces have " + std::to_string(total) +
                                             " corners");
    gate.check_indices("faceVertexIndices", cage.face_vertex_indices, cage.points.size());
}

std::vector<int> sorted(std::vector<int> numbers) {
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

/// The polygon without corners repeated in a row; empty where it is no simple polygon.
std::vector<int> simple_polygon(const int* first, int count) {
    std::vector<int> polygon(first, first + count);
    polygon.erase(std::unique(polygon.begin(), polygon.end()), polygon.end());
    while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();

    const std::vector<int> in_order = sorted(polygon);
    const bool repeats = std::adjacent_find(in_order.begin(), in_order.end()) != in_order.end();
    if (repeats || polygon.size() < 3) polygon.clear();
    return polygon;
}

void add_faces(const Gate& gate, CheckedCage& checked) {
    const Cage& cage = gate.cage;
    std::vector<bool> is_hole(cage.face_vertex_counts.size(), false);
    for (int hole : cage.hole_indices) is_hole[static_cast<std::size_t>(hole)] = true;

    std::set<std::vector<int>> triangles;
    std::size_t repaired = 0, left_out = 0, doubled = 0;
    const int* next = cage.face_vertex_indices.data();
    for (std::size_t f = 0; f < cage.face_vertex_counts.size(); ++f) {
        const int count = cage.face_vertex_counts[f];
        const std::vector<int> polygon = simple_polygon(next, count);
        next += count;
        if (polygon.empty()) {
            ++left_out;
            continue;
        }
        if (cage.scheme == SubdivisionScheme::kLoop && !triangles.insert(sorted(polygon)).second) {
            ++doubled;
            continue;
        }
        if (static_cast<int>(polygon.size()) < count) ++repaired;
        if (is_hole[f]) checked.holes.push_back(checked.face_count());
        checked.vertices.insert(checked.vertices.end(), polygon.begin(), polygon.end());
        checked.first.push_back(static_cast<int>(checked.vertices.size()));
    }
    if (repaired > 0) gate.say(std::to_string(repaired) + " faces repeat a corner; one of each is kept");
    if (left_out > 0) gate.say(std::to_string(left_out) + " faces are no simple polygons and are left out");
    if (doubled > 0)
        gate.say(std::to_string(doubled) + " triangles lie on others' vertices and are left out");
}

std::uint64_t edge_key(int a, int b) {
    const auto [low, high] = std::minmax(a, b);
    return (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint64_t>(high);
}

std::unordered_set<std::uint64_t> edges_of(const CheckedCage& cage) {
    std::unordered_set<std::uint64_t> edges;
    for (int f = 0; f < cage.face_count(); ++f) {
        int previous = cage.vertices[cage.first[f + 1] - 1];
        for (int i = cage.first[f]; i < cage.first[f + 1]; ++i) {
            edges.insert(edge_key(previous, cage.vertices[i]));
            previous = cage.vertices[i];
        }
    }
    return edges;
}

/// UsdGeomMesh: chain c has creaseLengths[c] vertices; a sharpness belongs to a chain or, where there are as
/// many as edges, to an edge.
void add_creases(const Gate& gate, CheckedCage& checked) {
    const Cage& cage = gate.cage;
    std::size_t vertices = 0;
    for (int chain_length : cage.crease_lengths) {
        if (chain_length < 2) gate.refuse("creaseLengths", "a crease needs at least two vertices");
        vertices += static_cast<std::size_t>(chain_length);
    }
    const std::size_t chains = cage.crease_lengths.size(), edge_count = vertices - chains;
    if (vertices != cage.crease_indices.size())
        gate.refuse("creaseIndices", "does not have as many entries as creaseLengths says");
    const bool per_chain = cage.crease_sharpnesses.size() == chains;
    if (!per_chain && cage.crease_sharpnesses.size() != edge_count)
        gate.refuse("creaseSharpnesses", "needs one entry per crease, or one per edge of all creases");
    if (chains == 0) return;

    const std::unordered_set<std::uint64_t> edges = edges_of(checked);
    std::size_t vertex = 0, edge = 0, missing = 0;
    for (std::size_t chain = 0; chain < chains; ++chain, ++vertex) {
        for (int i = 1; i < cage.crease_lengths[chain]; ++i, ++vertex, ++edge) {
            const int a = cage.crease_indices[vertex], b = cage.crease_indices[vertex + 1];
            if (edges.count(edge_key(a, b)) == 0) {
                ++missing;
                continue;
            }
            checked.crease_vertices.insert(checked.crease_vertices.end(), {a, b});
            checked.crease_sharpness.push_back(
                gate.sharpness("creaseSharpnesses", cage.crease_sharpnesses[per_chain ? chain : edge]));
        }
    }
    if (missing > 0)
        gate.say(std::to_string(missing) + " crease edges are no edges of the cage and are left out");
}

void add_corners(const Gate& gate, CheckedCage& checked) {
    const Cage& cage = gate.cage;
    if (cage.corner_indices.size() != cage.corner_sharpnesses.size())
        gate.refuse("cornerSharpnesses", "needs one entry per corner");
    checked.corner_vertices = cage.corner_indices;
    for (double sharpness : cage.corner_sharpnesses)
        checked.corner_sharpness.push_back(gate.sharpness("cornerSharpnesses", sharpness));
}

}  // namespace

CheckedCage check_cage(const Cage& cage, const std::string& name, const Warn& warn) {
    const Gate gate{cage, name, warn};
    check_points(gate);
    check_counts(gate);
    gate.check_indices("creaseIndices", cage.crease_indices, cage.points.size());
    gate.check_indices("cornerIndices", cage.corner_indices, cage.points.size());
    gate.check_indices("holeIndices", cage.hole_indices, cage.face_vertex_counts.size());

    CheckedCage checked;
    checked.points = cage.points;
    checked.scheme = cage.scheme;
    checked.interpolate_boundary = cage.interpolate_boundary;
    add_faces(gate, checked);
    add_creases(gate, checked);
    add_corners(gate, checked);
    return checked;
}

}  // namespace trilens
