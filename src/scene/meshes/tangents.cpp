#include "scene/meshes/tangents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

namespace trilens {
namespace {

constexpr std::size_t kNoNumber = static_cast<std::size_t>(-1);

bool has_map(const ObjectMesh& mesh, std::size_t triangle, const std::vector<Material>& materials) {
    return materials[mesh.material[triangle]].normal_texture.picture != nullptr;
}

/// How a triangle's points move as u grows; side: 1 where its uv turn as its corners do, -1 where they are
/// mirrored, 0 where they have no area.
struct GrowingU {
    Vec3 direction{0};
    int side = 0;
};

GrowingU growing_u(const std::array<Vec3, 3>& p, const std::array<Vec2, 3>& uv) {
    const Vec2 b = uv[1] - uv[0], c = uv[2] - uv[0];
    const double area = cross(b, c);
    if (!(area != 0)) return {};
    const int side = area > 0 ? 1 : -1;
    return {normalize_or_zero(double(side) * (c.y * (p[1] - p[0]) - b.y * (p[2] - p[0]))), side};
}

Vec3 in_plane(const Vec3& v, const Vec3& normal) {
    return normalize_or_zero(v - dot(normal, v) * normal);
}

/// The corners of some triangles of a mesh, numbered triangle by triangle, in groups that share a tangent.
class CornerGroups {
  public:
    /// `triangles`: those that want tangents.
    CornerGroups(const ObjectMesh& mesh, const std::vector<Material>& materials,
                 const std::vector<std::size_t>& triangles)
        : mesh_(mesh), triangles_(triangles), group_(3 * triangles.size(), kNoNumber) {
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const std::size_t t = triangles[i];
            const std::array<Vec3, 3> p{point(3 * i), point(3 * i + 1), point(3 * i + 2)};
            const Vec3 own = normalize_or_zero(cross(p[1] - p[0], p[2] - p[0]));
            const bool is_second = materials[mesh.material[t]].normal_texture.sampler.uv_set == 1;
            const auto& uvs = is_second ? mesh.second_uvs : mesh.uvs;
            uv_.push_back(uvs.empty() ? std::array<Vec2, 3>{} : uvs[t]);
            growing_.push_back(growing_u(p, uv_.back()));
            for (std::size_t k = 0; k < 3; ++k) {
                const bool is_given = !mesh.normals.empty() && mesh.normals[t][k] != Vec3(0);
                normal_.push_back(is_given ? mesh.normals[t][k] : own);
            }
        }
        name_vertices();
        find_neighbours();
        for (std::size_t k = 0; k < group_.size(); ++k)
            if (group_[k] == kNoNumber && growing_[k / 3].side != 0) spread(k);
    }

    /// By triangle of those that were asked for.
    std::vector<std::array<Vec4, 3>> tangents() const {
        std::vector<Vec3> sum(side_.size(), Vec3(0));
        for (std::size_t k = 0; k < group_.size(); ++k)
            if (group_[k] != kNoNumber)
                sum[group_[k]] += angle(k) * in_plane(growing_[k / 3].direction, normal_[k]);
        std::vector<std::array<Vec4, 3>> result(triangles_.size());
        for (std::size_t k = 0; k < group_.size(); ++k) {
            const bool has_group = group_[k] != kNoNumber;
            Vec3 tangent = has_group ? in_plane(sum[group_[k]], normal_[k]) : Vec3(0);
            if (tangent == Vec3(0)) tangent = unit_across(normal_[k]);
            result[k / 3][k % 3] = Vec4(tangent, has_group ? side_[group_[k]] : 1);
        }
        return result;
    }

  private:
    static std::size_t next(std::size_t k) { return k % 3 == 2 ? k - 2 : k + 1; }
    static std::size_t before(std::size_t k) { return next(next(k)); }

    const Vec3& point(std::size_t k) const { return mesh_.points[mesh_.triangles[triangles_[k / 3]][k % 3]]; }

    /// Between the edges of a corner, seen along its normal.
    double angle(std::size_t k) const {
        const Vec3 a = in_plane(point(next(k)) - point(k), normal_[k]),
                   b = in_plane(point(before(k)) - point(k), normal_[k]);
        return std::atan2(length(cross(a, b)), dot(a, b));
    }

    /// Corners of one place, normal, uv and material are one vertex.
    void name_vertices() {
        const auto key = [&](std::size_t k) {
            const Vec3 &p = point(k), &n = normal_[k];
            const Vec2& uv = uv_[k / 3][k % 3];
            return std::tuple(mesh_.material[triangles_[k / 3]], p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y);
        };
        std::vector<std::size_t> order(group_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::sort(order.begin(), order.end(),
                  [&](std::size_t a, std::size_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
        vertex_.resize(order.size());
        for (std::size_t i = 0; i < order.size(); ++i)
            vertex_[order[i]] =
                i > 0 && key(order[i - 1]) == key(order[i]) ? vertex_[order[i - 1]] : order[i];
    }

    /// Pairs of edges that two triangles run along in opposite directions, each edge in one pair at most.
    void find_neighbours() {
        over_.assign(group_.size(), kNoNumber);
        std::multimap<std::pair<std::size_t, std::size_t>, std::size_t> free_edges;  // by their vertices
        for (std::size_t k = 0; k < over_.size(); ++k) {
            const auto [first, last] = free_edges.equal_range({vertex_[next(k)], vertex_[k]});
            const auto found =
                std::find_if(first, last, [&](const auto& edge) { return edge.second / 3 != k / 3; });
            if (found == last) {
                free_edges.emplace(std::pair(vertex_[k], vertex_[next(k)]), k);
                continue;
            }
            over_[k] = found->second;
            over_[found->second] = k;
            free_edges.erase(found);
        }
    }

    /// A new group, from one of its corners over all that it reaches around the vertex.
    void spread(std::size_t from) {
        const int side = growing_[from / 3].side;
        const std::size_t group = side_.size();
        side_.push_back(side);
        std::vector<std::size_t> waiting{from};
        while (!waiting.empty()) {
            const std::size_t k = waiting.back(), first = k - k % 3;
            waiting.pop_back();
            if (group_[k] != kNoNumber) continue;
            int& own = growing_[k / 3].side;
            if (own == 0) own = side;  // the first that reaches it says so for all its corners
            if (own != side) continue;
            group_[k] = group;
            // The edges that meet at the vertex: the one that starts here, and the one that ends here.
            for (const std::size_t edge : {first + (k % 3 + 2) % 3, k}) {
                if (over_[edge] == kNoNumber) continue;
                waiting.push_back(edge == k ? next(over_[edge]) : over_[edge]);
            }
        }
    }

    const ObjectMesh& mesh_;
    const std::vector<std::size_t>& triangles_;
    std::vector<std::array<Vec2, 3>> uv_;  // per triangle
    std::vector<GrowingU> growing_;        // per triangle
    std::vector<Vec3> normal_;             // per corner
    std::vector<std::size_t> vertex_;      // per corner: the first one that is the same
    std::vector<std::size_t> over_;        // per edge, by the corner that it starts at: the one beside it
    std::vector<std::size_t> group_;       // per corner
    std::vector<int> side_;                // per group
};

}  // namespace

void add_tangents(ObjectMesh& mesh, const std::vector<Material>& materials) {
    mesh.tangents.resize(mesh.triangles.size());
    std::vector<std::size_t> wanted;
    bool any = false;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        std::array<Vec4, 3>& tangents = mesh.tangents[t];
        const bool is_mapped = has_map(mesh, t, materials);
        any = any || is_mapped;
        const bool lacks = std::any_of(tangents.begin(), tangents.end(),
                                       [](const Vec4& tangent) { return Vec3(tangent) == Vec3(0); });
        if (!is_mapped)
            tangents = {};
        else if (lacks)
            wanted.push_back(t);
    }
    if (!any) mesh.tangents.clear();
    if (wanted.empty()) return;
    const std::vector<std::array<Vec4, 3>> made = CornerGroups(mesh, materials, wanted).tangents();
    for (std::size_t i = 0; i < wanted.size(); ++i) mesh.tangents[wanted[i]] = made[i];
}

}  // namespace trilens
