// Triangles as they are, with normals interpolated between their corners [Phong, Illumination for Computer
// Generated Pictures, 1975]: what meshes of files are, where nothing is subdivided.
#include "surfaces/polygon_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "base/util/error.h"
#include "surfaces/polynomial/face_hulls.h"
#include "surfaces/texture_places.h"

namespace trilens {
namespace {

/// Corner ids and edges: those that one face alone has are none.
class TriangleBorders {
  public:
    explicit TriangleBorders(const std::vector<std::array<Id, 3>>& triangles) {
        for (const auto& triangle : triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                ++faces_of_corner_[triangle[k]];
                Edge& edge = edges_[ends(triangle[k], triangle[(k + 1) % 3])];
                if (edge.faces++ == 0) edge.id = static_cast<Id>(edges_.size() - 1);
            }
    }

    FaceBorder border(const std::array<Id, 3>& triangle) const {
        FaceBorder border;
        for (std::size_t k = 0; k < 3; ++k) {
            const Id from = triangle[k], to = triangle[(k + 1) % 3];
            if (faces_of_corner_.at(from) > 1) border.corners[k] = from;
            const Edge& edge = edges_.at(ends(from, to));
            if (edge.faces > 1) border.sides[k] = {edge.id, FaceSide::Part::kWhole, from > to};
        }
        return border;
    }

  private:
    struct Edge {
        Id id = kNone;
        int faces = 0;
    };
    static std::pair<Id, Id> ends(Id a, Id b) { return {std::min(a, b), std::max(a, b)}; }

    std::map<Id, int> faces_of_corner_;
    std::map<std::pair<Id, Id>, Edge> edges_;
};

class PolygonSurface final : public Surface, public HasHulls, public HasCageFaces {
  public:
    PolygonSurface(const Cage& cage, const std::string& name) {
        std::vector<std::array<Id, 3>> corners;
        if (!cage.normals.empty() && cage.normals.size() != cage.face_vertex_indices.size())
            throw InputError(name, "", "normals must be as many as faceVertexIndices");
        for (std::size_t face = 0; face < cage.face_vertex_counts.size(); ++face) {
            if (cage.face_vertex_counts[face] != 3 || cage.face_vertex_indices.size() < 3 * face + 3)
                throw InputError(name, "", "a surface that is not subdivided is made of triangles");
            corners.push_back(add(cage, 3 * face, name));
        }
        if (corners.empty()) throw InputError(name, "", "has no faces");
        const TriangleBorders borders(corners);
        for (std::size_t face = 0; face < faces_.size(); ++face)
            faces_[face].border = borders.border(corners[face]);
    }

    std::size_t face_count() const override { return faces_.size(); }
    FaceDomain domain(Id) const override { return FaceDomain::kTriangle; }
    FaceBorder border(Id face) const override { return faces_[face].border; }
    bool is_flat(Id) const override { return true; }
    std::size_t bytes_held() const override { return faces_.capacity() * sizeof(Face); }

    std::optional<CageFace> cage_face(Id face) const override { return CageFace{static_cast<int>(face), -1}; }

    std::optional<Box> hull(Id face) const override {
        const Face& here = faces_[face];
        Box box;
        for (const Vec3& corner : {here.a, here.a + here.du, here.a + here.dv}) box.include(corner);
        return box;
    }

    /// A mean of unit normals lies between them: in every cone, narrower than a half space, that holds them.
    std::optional<FaceBounds> face_bounds(Id face) const override {
        const std::array<Vec3, 3>& normals = faces_[face].normals;
        FaceBounds bounds{*hull(face), normalize_or_zero(normals[0] + normals[1] + normals[2])};
        for (const Vec3& normal : normals) {
            if (!(dot(normal, bounds.normal) > 0)) return std::nullopt;
            bounds.angle = std::max(bounds.angle, std::acos(std::min(1.0, dot(normal, bounds.normal))));
        }
        return bounds;
    }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        const Face& here = faces_[face];
        const auto clamp = [](double x) { return x > 0 ? std::fmin(x, 1.0) : 0.0; };
        Vec2 inside(clamp(uv.x), clamp(uv.y));
        const double sum = inside.x + inside.y;
        if (sum > 1) inside /= sum;
        SurfacePoint point;
        point.position = here.a + inside.x * here.du + inside.y * here.dv;
        point.du = here.du;
        point.dv = here.dv;
        point.normal = normalize_or_zero((1 - inside.x - inside.y) * here.normals[0] +
                                         inside.x * here.normals[1] + inside.y * here.normals[2]);
        return point;
    }

  private:
    struct Face {
        Vec3 a, du, dv;
        std::array<Vec3, 3> normals;
        FaceBorder border;
    };

    std::array<Id, 3> add(const Cage& cage, std::size_t first, const std::string& name) {
        std::array<Id, 3> corners;
        std::array<Vec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
            const int index = cage.face_vertex_indices[first + k];
            if (index < 0 || static_cast<std::size_t>(index) >= cage.points.size())
                throw InputError(name, "", "a face names a point that there is not");
            corners[k] = static_cast<Id>(index);
            p[k] = cage.points[static_cast<std::size_t>(index)];
            if (!std::isfinite(p[k].x + p[k].y + p[k].z)) throw InputError(name, "", "a point is not finite");
        }
        Face face{p[0], p[1] - p[0], p[2] - p[0], {}, {}};
        const Vec3 own = normalize_or_zero(cross(face.du, face.dv));
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 given = cage.normals.empty() ? Vec3(0) : normalize_or_zero(cage.normals[first + k]);
            // Front is where the corners run counter-clockwise, whatever the normals say.
            face.normals[k] = given == Vec3(0) ? own : dot(given, own) < 0 ? -given : given;
        }
        faces_.push_back(face);
        return corners;
    }

    std::vector<Face> faces_;
};

}  // namespace

std::unique_ptr<Surface> make_polygon_surface(const Cage& cage, const std::string& name) {
    return std::make_unique<PolygonSurface>(cage, name);
}

}  // namespace trilens
