#include "radiosity/vertex_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/util/parallel.h"
#include "intersect/tracer.h"
#include "shade/lights/light_sample.h"

namespace trilens {
namespace {

/// How far towards the middles of its elements a vertex's light is looked at.
constexpr double kInward = 1e-3;
constexpr std::size_t kVerticesAtOnce = 256;

/// A corner of a side of an element, as others find it by its place.
struct SideCorner {
    Id side = 0;
    std::size_t corner = 0;
    double angle = 0;
    Vec3 normal{0};
    Vec3 inward{0};  // from the corner to the element's middle
};

/// Those that have one light.
struct CornerGroup {
    std::vector<SideCorner> members;
    Id parent_side = kNone;  // the least
};

double angle_between(const Vec3& a, const Vec3& b) {
    return std::acos(std::clamp(dot(normalize_or_zero(a), normalize_or_zero(b)), -1.0, 1.0));
}

/// By place.
std::vector<std::vector<SideCorner>> corners_by_place(const ElementMesh& mesh) {
    std::vector<std::vector<SideCorner>> around;
    for (Id e = 0; e < mesh.elements().size(); ++e) {
        const std::array<Vec3, 3> corner = mesh.corners(e);
        if (has_no_area(corner)) continue;
        const Vec3 up = normalize_or_zero(cross(corner[1] - corner[0], corner[2] - corner[0]));
        const Vec3 middle = (corner[0] + corner[1] + corner[2]) / 3.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Id place = mesh.places()[e][k];
            if (around.size() <= place) around.resize(place + std::size_t{1});
            const double angle =
                angle_between(corner[(k + 1) % 3] - corner[k], corner[(k + 2) % 3] - corner[k]);
            for (const bool is_back : {false, true})
                around[place].push_back(
                    {side_of(e, is_back), k, angle, is_back ? -up : up, middle - corner[k]});
        }
    }
    return around;
}

std::vector<CornerGroup> grouped(const std::vector<SideCorner>& corners, const ElementMesh& mesh) {
    static const double kLeast = std::cos(kSmoothAngle * std::numbers::pi / 180);
    std::vector<CornerGroup> groups;
    for (const SideCorner& corner : corners) {
        const auto fits = [&](const CornerGroup& group) {
            return dot(group.members.front().normal, corner.normal) >= kLeast;
        };
        auto group = std::find_if(groups.begin(), groups.end(), fits);
        if (group == groups.end()) group = groups.insert(groups.end(), CornerGroup{});
        group->members.push_back(corner);
        const Id parent = side_of(mesh.elements()[corner.side / 2].parent, corner.side % 2 == 1);
        group->parent_side = std::min(group->parent_side, parent);
    }
    return groups;
}

RadiosityVertex vertex_of_group(const CornerGroup& group, const ElementMesh& mesh) {
    const SideCorner& first = group.members.front();
    const RadiosityElement& element = mesh.elements()[first.side / 2];
    RadiosityVertex vertex;
    Vec3 normal(0), inward(0);
    for (const SideCorner& member : group.members) {
        normal += member.angle * member.normal;
        inward += member.inward / static_cast<double>(group.members.size());
    }
    vertex.place.normal = normalize_or_zero(normal);
    vertex.place.origin = mesh.corners(first.side / 2)[first.corner] + kInward * inward;
    vertex.place.tangent = tangent_basis(vertex.place.normal).first;
    const Vec2 middle = (element.barycentrics[0] + element.barycentrics[1] + element.barycentrics[2]) / 3.0;
    const Vec2& at = element.barycentrics[first.corner];
    vertex.point = {element.parent, at + kInward * (middle - at), first.side % 2 == 1};
    return vertex;
}

}  // namespace

std::size_t VertexLight::count(const ElementMesh& mesh) {
    std::size_t count = 0;
    for (const std::vector<SideCorner>& corners : corners_by_place(mesh))
        count += grouped(corners, mesh).size();
    return count;
}

void VertexLight::update(const Progress& progress) {
    const std::size_t before = vertices_.size();
    vertex_of_.assign(2 * mesh_.elements().size(), IdTriple{kNone, kNone, kNone});
    const std::vector<std::vector<SideCorner>> around = corners_by_place(mesh_);
    for (Id place = 0; place < around.size(); ++place)
        for (const CornerGroup& group : grouped(around[place], mesh_)) {
            const auto [at, is_new] =
                known_.emplace(Key{place, group.parent_side}, static_cast<Id>(vertices_.size()));
            if (is_new) vertices_.push_back(vertex_of_group(group, mesh_));
            for (const SideCorner& member : group.members)
                vertex_of_[member.side][member.corner] = at->second;
        }
    light_.resize(vertices_.size());
    for (std::size_t first = before; first < vertices_.size(); first += kVerticesAtOnce) {
        progress.stop_if_cancelled();
        progress(static_cast<double>(first - before) / static_cast<double>(vertices_.size() - before));
        const std::size_t count = std::min(kVerticesAtOnce, vertices_.size() - first);
        parallel_for(count, 1, [&](std::size_t from, std::size_t to) {
            std::vector<ShadedPoint> points;
            for (std::size_t v = first + from; v < first + to; ++v) points.push_back(vertices_[v].point);
            const std::vector<Vec3> direct = direct_.at(points);
            for (std::size_t i = 0; i < direct.size(); ++i) {
                const std::size_t v = first + from + i;
                light_[v] = {direct[i],
                             patches_.factors.irradiance_at(vertices_[v].place, patches_.radiosity) /
                                 std::numbers::pi};
            }
        });
    }
    progress(1);
}

LightAtVertex VertexLight::at(Id side, std::size_t corner) const {
    const Id vertex = vertex_of_[side][corner];
    return vertex == kNone ? LightAtVertex{} : light_[vertex];
}

}  // namespace trilens
