// Displacement along mean normals [Cook, Shade Trees, SIGGRAPH 1984], each triangle divided alike.
#include "scene/meshes/displacement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/image/texture_lookup.h"
#include "base/math/luminance.h"
#include "scene/meshes/vertex_normals.h"

namespace trilens {
namespace {

/// A triangle's corners in an order that its neighbours share, so that sums along a common edge have the same
/// bits.
std::array<std::size_t, 3> shared_order(const std::array<Vec3, 3>& points) {
    std::array<std::size_t, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const Vec3 &p = points[a], &q = points[b];
        return std::array{p.x, p.y, p.z} < std::array{q.x, q.y, q.z};
    });
    return order;
}

/// The faces of a mesh, all triangles, divided one by one.
class TriangleDivider {
  public:
    TriangleDivider(const PolygonMesh& from, int n) : from_(from), n_(n) {
        to_.cage.points = from.cage.points;
    }

    PolygonMesh run() {
        for (std::size_t face = 0; face < from_.cage.face_vertex_counts.size(); ++face) divide(face);
        return std::move(to_);
    }

  private:
    using Weights = std::array<int, 3>;  // of the corners; they sum to n

    void divide(std::size_t face) {
        first_ = 3 * face;
        for (std::size_t k = 0; k < 3; ++k) {
            corner_[k] = from_.cage.face_vertex_indices[first_ + k];
            points_[k] = from_.cage.points[static_cast<std::size_t>(corner_[k])];
        }
        order_ = shared_order(points_);
        inner_.clear();
        const auto at = [&](int i, int j) { return Weights{n_ - i - j, i, j}; };
        for (int j = 0; j < n_; ++j)
            for (int i = 0; i + j < n_; ++i) {
                add_face(face, {at(i, j), at(i + 1, j), at(i, j + 1)});
                if (i + j + 1 < n_) add_face(face, {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
            }
    }

    void add_face(std::size_t face, const std::array<Weights, 3>& corners) {
        to_.cage.face_vertex_counts.push_back(3);
        if (!from_.face_material.empty()) to_.face_material.push_back(from_.face_material[face]);
        for (const Weights& w : corners) {
            to_.cage.face_vertex_indices.push_back(point_at(w));
            if (!from_.uvs.empty()) to_.uvs.push_back(of_corners(from_.uvs, w));
            if (!from_.second_uvs.empty()) to_.second_uvs.push_back(of_corners(from_.second_uvs, w));
            if (!from_.colors.empty()) to_.colors.push_back(of_corners(from_.colors, w));
            if (!from_.normals.empty()) to_.normals.push_back(normal_at(w));
        }
    }

    template <class Value>
    Value mean(const std::array<Value, 3>& of, const Weights& w) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (w[k] == n_) return of[k];
        Value sum(0);
        for (const std::size_t k : order_) sum += double(w[k]) * of[k];
        return sum / double(n_);
    }

    template <class Value>
    Value of_corners(const std::vector<Value>& values, const Weights& w) const {
        return mean(std::array{values[first_], values[first_ + 1], values[first_ + 2]}, w);
    }

    /// Zero where a corner has none: a face is lit by its own there.
    Vec3 normal_at(const Weights& w) const {
        std::array<Vec3, 3> normals;
        for (std::size_t k = 0; k < 3; ++k) {
            normals[k] = from_.normals[first_ + k];
            if (w[k] == n_) return normals[k];
            normals[k] = normalize_or_zero(normals[k]);
            if (w[k] > 0 && normals[k] == Vec3(0)) return Vec3(0);
        }
        return normalize_or_zero(mean(normals, w));
    }

    int point_at(const Weights& w) {
        for (std::size_t k = 0; k < 3; ++k)
            if (w[k] == n_) return corner_[k];
        for (std::size_t k = 0; k < 3; ++k)
            if (w[k] == 0) return edge_point(w, (k + 1) % 3, (k + 2) % 3);
        return point_in(inner_, w[1] * (n_ + 1) + w[2], w);
    }

    int edge_point(const Weights& w, std::size_t a, std::size_t b) {
        if (corner_[a] > corner_[b]) std::swap(a, b);
        return point_in(edges_[{corner_[a], corner_[b]}], w[a], w);
    }

    int point_in(std::map<int, int>& known, int key, const Weights& w) {
        const auto [found, is_new] = known.try_emplace(key, static_cast<int>(to_.cage.points.size()));
        if (is_new) to_.cage.points.push_back(mean(points_, w));
        return found->second;
    }

    const PolygonMesh& from_;
    const int n_;
    PolygonMesh to_;
    // Of the face that is divided.
    std::size_t first_ = 0;
    std::array<int, 3> corner_{};
    std::array<Vec3, 3> points_{};
    std::array<std::size_t, 3> order_{};
    std::map<int, int> inner_;

    std::map<std::pair<int, int>, std::map<int, int>> edges_;  // points along an edge
};

/// The heights of one mesh.
class Heights {
  public:
    Heights(const PolygonMesh& mesh, const FaceHeights& by) : mesh_(mesh), by_(by) {}

    /// Part way from one corner of a face to another.
    double at(std::size_t face, const std::array<std::size_t, 2>& corners, double way) const {
        if (by_.of_face[face] == kNone) return 0;
        const HeightMap& map = by_.maps[by_.of_face[face]];
        const TextureSampler& sampler = map.texture.sampler;
        const std::vector<Vec2>& uvs = sampler.uv_set == 1 ? mesh_.second_uvs : mesh_.uvs;
        const Vec2 uv = (1 - way) * uvs[corners[0]] + way * uvs[corners[1]];
        return map.offset + map.scale * luminance(lookup(*map.texture.picture, sampler, sampler.place(uv)));
    }

    double at_corner(std::size_t face, std::size_t corner) const { return at(face, {corner, corner}, 0); }

  private:
    const PolygonMesh& mesh_;
    const FaceHeights& by_;
};

/// Calls each(face, its first corner, how many it has).
template <class Each>
void for_each_face(const Cage& cage, const Each& each) {
    std::size_t first = 0;
    for (std::size_t face = 0; face < cage.face_vertex_counts.size(); ++face) {
        const auto count = static_cast<std::size_t>(cage.face_vertex_counts[face]);
        each(face, first, count);
        first += count;
    }
}

/// The mean of some heights; their own bits where they are alike.
struct MeanHeight {
    double sum = 0, low = std::numeric_limits<double>::infinity(), high = -low;
    std::size_t count = 0;

    void add(double height) {
        sum += height;
        low = std::min(low, height);
        high = std::max(high, height);
        ++count;
    }
    double mean() const { return count == 0 ? 0 : low == high ? low : sum / double(count); }
};

/// What edges pass over.
void measure(const PolygonMesh& mesh, const Heights& heights, DisplacementLoss& loss) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for_each_face(mesh.cage, [&](std::size_t face, std::size_t first, std::size_t count) {
        for (std::size_t k = 0; k < count; ++k) {
            const std::array<std::size_t, 2> edge{first + k, first + (k + 1) % count};
            const double from = heights.at(face, edge, 0), to = heights.at(face, edge, 1);
            low = std::min(low, from), high = std::max(high, from);
            for (const double way : {0.25, 0.5, 0.75}) {
                const double there = heights.at(face, edge, way);
                low = std::min(low, there), high = std::max(high, there);
                loss.greatest = std::max(loss.greatest, std::fabs(there - ((1 - way) * from + way * to)));
            }
        }
    });
    loss.range = std::max(high - low, 0.0);
}

/// New normals for corners that had some, where a face around them has moved.
class NormalRenewal {
  public:
    /// `place`: see first_at_place; `before`: corner_normals before the points were moved.
    NormalRenewal(PolygonMesh& mesh, const std::vector<std::size_t>& place, const std::vector<Vec3>& before)
        : mesh_(mesh), place_(place), before_(before) {}

    /// `moved`: per point.
    void run(const std::vector<char>& moved) {
        const std::vector<Vec3> now = corner_normals(mesh_.cage);
        std::map<std::array<double, 4>, Group> groups;
        for_each_face(mesh_.cage, [&](std::size_t, std::size_t first, std::size_t count) {
            bool any = false;
            for (std::size_t k = first; k < first + count; ++k) any = any || moved[point(k)];
            for (std::size_t k = first; k < first + count; ++k) {
                if (mesh_.normals[k] == Vec3(0)) continue;
                Group& group = groups[key(k)];
                group.is_moved = group.is_moved || any;
                // Files whose faces are seen clockwise have normals on the other side.
                group.sum += dot(mesh_.normals[k], before_[k]) < 0 ? -now[k] : now[k];
            }
        });
        for (std::size_t k = 0; k < mesh_.normals.size(); ++k) {
            if (mesh_.normals[k] == Vec3(0)) continue;
            const Group& group = groups[key(k)];
            if (group.is_moved) new_.emplace_back(k, normalize_or_zero(group.sum));
        }
        for (const auto& [corner, normal] : new_) mesh_.normals[corner] = normal;
    }

  private:
    struct Group {
        Vec3 sum{0};
        bool is_moved = false;
    };

    std::size_t point(std::size_t corner) const {
        return static_cast<std::size_t>(mesh_.cage.face_vertex_indices[corner]);
    }
    /// Corners at one place with one normal.
    std::array<double, 4> key(std::size_t corner) const {
        const Vec3& normal = mesh_.normals[corner];
        return {double(place_[point(corner)]), normal.x, normal.y, normal.z};
    }

    PolygonMesh& mesh_;
    const std::vector<std::size_t>& place_;
    const std::vector<Vec3>& before_;
    std::vector<std::pair<std::size_t, Vec3>> new_;
};

}  // namespace

void divide_triangles(PolygonMesh& mesh, int n) {
    if (n < 2) return;
    PolygonMesh divided = TriangleDivider(mesh, n).run();
    divided.cage.scheme = mesh.cage.scheme;
    divided.cage.interpolate_boundary = mesh.cage.interpolate_boundary;
    divided.materials = std::move(mesh.materials);
    divided.heights = std::move(mesh.heights);
    divided.is_triangle_soup = mesh.is_triangle_soup;
    mesh = std::move(divided);
}

DisplacementLoss displace(PolygonMesh& mesh, const FaceHeights& by) {
    DisplacementLoss loss;
    const Heights heights(mesh, by);
    measure(mesh, heights, loss);

    const std::vector<std::size_t> place = first_at_place(mesh.cage.points);
    const std::vector<Vec3> of_faces = corner_normals(mesh.cage);
    std::vector<MeanHeight> height(mesh.cage.points.size());
    std::vector<Vec3> normal(mesh.cage.points.size(), Vec3(0));
    for_each_face(mesh.cage, [&](std::size_t face, std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k) {
            const std::size_t at = place[static_cast<std::size_t>(mesh.cage.face_vertex_indices[k])];
            const bool is_given = !mesh.normals.empty() && mesh.normals[k] != Vec3(0);
            height[at].add(heights.at_corner(face, k));
            normal[at] += is_given ? length(of_faces[k]) * normalize_or_zero(mesh.normals[k]) : of_faces[k];
        }
    });

    std::vector<char> moved(mesh.cage.points.size(), 0);
    for (std::size_t p = 0; p < mesh.cage.points.size(); ++p) {
        const double by_height = height[place[p]].mean();
        if (by_height == 0) continue;
        const Vec3& sum = normal[place[p]];
        moved[p] = length(sum) > kCancelled;
        if (moved[p])
            mesh.cage.points[p] += by_height * normalize_or_zero(sum);
        else
            ++loss.without_normal;
    }
    mesh.tangents.clear();  // they lay in the surface that was
    if (!mesh.normals.empty()) NormalRenewal(mesh, place, of_faces).run(moved);
    return loss;
}

}  // namespace trilens
