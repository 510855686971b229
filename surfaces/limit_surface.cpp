// The limit surface of a cage: its faces, how they hang together, and normals where derivatives vanish.
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "surfaces/checked_cage.h"
#include "surfaces/limit_patches.h"
#include "surfaces/polygon_surface.h"
#include "surfaces/polynomial/face_hulls.h"
#include "surfaces/polynomial/polynomial_bounds.h"
#include "surfaces/surfaces.h"
#include "surfaces/texture_places.h"

namespace trilens {
namespace {

/// A step this share of the way to the middle: far below the smallest patches, far above rounding.
constexpr double kStepForSign = 0x1p-16;

struct SurfaceFace {
    int cage_face;
    int sub_face;  // -1: the whole face
    FaceBorder border;
};

/// The half of an edge, given as a side of its face, that begins or ends at the side's first or second end.
FaceSide half_of(FaceSide side, bool first_half) {
    if (side.edge == kNone) return side;
    side.part = first_half != side.reversed ? FaceSide::Part::kFirstHalf : FaceSide::Part::kSecondHalf;
    return side;
}

/// Numbers corners and edges of all surface faces. Corners: cage vertices, then middles of cage edges, then
/// centres of cage faces. Edges: those of the cage, then those from the middle of an edge to the centre of a
/// face.
class FaceList {
  public:
    explicit FaceList(const CheckedCage& cage) : cage_(cage) {
        for (int f = 0; f < cage.face_count(); ++f)
            for (int k = 0; k < cage.face_size(f); ++k) side(f, k);
    }

    void add(int face, std::vector<SurfaceFace>& faces) {
        const int size = cage_.face_size(face);
        const bool whole = size == (cage_.scheme == SubdivisionScheme::kLoop ? 3 : 4);
        if (whole) {
            faces.push_back({face, -1, whole_border(face)});
        } else {
            for (int k = 0; k < size; ++k) faces.push_back({face, k, sub_face_border(face, k)});
        }
    }

  private:
    Id vertex(int face, int k) const {
        const int size = cage_.face_size(face);
        return static_cast<Id>(cage_.vertices[cage_.first[face] + (k + size) % size]);
    }
    FaceSide side(int face, int k) { return edges_.side(vertex(face, k), vertex(face, k + 1)); }
    Id middle(const FaceSide& side) const { return static_cast<Id>(cage_.points.size()) + side.edge; }
    Id centre(int face) const {
        return static_cast<Id>(cage_.points.size()) + edges_.size() + static_cast<Id>(face);
    }
    /// The edge from the middle of edge k to the centre; (face, corner) numbers it among all such edges.
    Id spoke(int face, int k) const {
        const int size = cage_.face_size(face);
        return edges_.size() + static_cast<Id>(cage_.first[face] + (k + size) % size);
    }

    FaceBorder whole_border(int face) {
        FaceBorder border;
        for (int k = 0; k < cage_.face_size(face); ++k) {
            border.corners[k] = vertex(face, k);
            border.sides[k] = side(face, k);
        }
        return border;
    }

    FaceBorder sub_face_border(int face, int k) {
        const FaceSide ahead = side(face, k), behind = side(face, k - 1);
        FaceBorder border;
        border.corners = {vertex(face, k), middle(ahead), centre(face), middle(behind)};
        border.sides = {half_of(ahead, true), FaceSide{spoke(face, k), FaceSide::Part::kWhole, false},
                        FaceSide{spoke(face, k - 1), FaceSide::Part::kWhole, true}, half_of(behind, false)};
        return border;
    }

    const CheckedCage& cage_;
    EdgeNumbers edges_;
};

/// Into the face's domain; not-a-number becomes 0.
Vec2 clamp_to_domain(FaceDomain domain, const Vec2& uv) {
    const auto clamp = [](double x) { return x > 0 ? std::fmin(x, 1.0) : 0.0; };
    Vec2 inside(clamp(uv.x), clamp(uv.y));
    const double sum = inside.x + inside.y;
    if (domain == FaceDomain::kTriangle && sum > 1) inside /= sum;
    return inside;
}

/// Per face of the cage whether its limit surface lies in a plane for sure: without smoothing where its
/// corners do.
std::vector<bool> flat_faces(const CheckedCage& cage) {
    constexpr double kOffPlane = 1e-14;  // of the face's size
    std::vector<bool> is_flat(static_cast<std::size_t>(cage.face_count()), false);
    if (cage.scheme != SubdivisionScheme::kBilinear) return is_flat;
    for (int face = 0; face < cage.face_count(); ++face) {
        const auto way_to = [&](int k) {
            const auto corner = [&](int i) {
                return cage.points[static_cast<std::size_t>(
                    cage.vertices[static_cast<std::size_t>(cage.first[static_cast<std::size_t>(face)] + i)])];
            };
            return corner(k) - corner(0);
        };
        const int size = cage.face_size(face);
        Vec3 normal(0);
        double reach = 0;
        for (int k = 1; k < size; ++k) reach = std::max(reach, length(way_to(k)));
        for (int k = 2; k < size; ++k) {
            const Vec3 other = cross(way_to(k - 1), way_to(k));
            if (length(other) > length(normal)) normal = other;
        }
        normal = normalize_or_zero(normal);
        is_flat[static_cast<std::size_t>(face)] = true;
        for (int k = 1; k < size; ++k)
            if (std::fabs(dot(way_to(k), normal)) > kOffPlane * reach)
                is_flat[static_cast<std::size_t>(face)] = false;
    }
    return is_flat;
}

struct NamedCage {
    const CheckedCage& cage;
    const std::string& name;
    bool is_as_given = true;  // no face or corner of it was left out
};

class LimitSurface final : public Surface, public HasHulls, public HasCageFaces, public HasStencils {
  public:
    LimitSurface(const NamedCage& named, const Warn& warn, double memory)
        : LimitSurface(named.cage, named.name, warn, memory) {
        is_as_given_ = named.is_as_given;
    }
    LimitSurface(const CheckedCage& cage, const std::string& name, const Warn& warn, double memory)
        : domain_(cage.scheme == SubdivisionScheme::kLoop ? FaceDomain::kTriangle : FaceDomain::kSquare),
          patches_(cage, name, memory),
          is_flat_(flat_faces(cage)) {
        std::vector<bool> is_hole(static_cast<std::size_t>(cage.face_count()), false);
        for (int hole : cage.holes) is_hole[static_cast<std::size_t>(hole)] = true;

        FaceList list(cage);
        int left_out = 0;
        for (int face = 0; face < cage.face_count(); ++face) {
            if (is_hole[static_cast<std::size_t>(face)]) continue;
            if (patches_.has_limit(face)) {
                list.add(face, faces_);
            } else {
                ++left_out;
            }
        }
        std::vector<LimitPatches::Face> faces;
        faces.reserve(faces_.size());
        for (const SurfaceFace& face : faces_) faces.push_back({face.cage_face, face.sub_face});
        hulls_ = patches_.hulls(faces);
        if (left_out > 0 && warn)
            warn(name + ": " + std::to_string(left_out) + " faces have no limit surface and are left out");
    }

    std::size_t face_count() const override { return faces_.size(); }
    FaceDomain domain(Id) const override { return domain_; }
    FaceBorder border(Id face) const override { return faces_[face].border; }
    std::size_t bytes_held() const override {
        return faces_.capacity() * sizeof(SurfaceFace) + hulls_.capacity() * sizeof(Box) + patches_.bytes();
    }
    bool is_flat(Id face) const override {
        return is_flat_[static_cast<std::size_t>(faces_[face].cage_face)];
    }
    std::optional<Box> hull(Id face) const override { return hulls_[face]; }
    std::optional<CageFace> cage_face(Id face) const override {
        if (!is_as_given_) return std::nullopt;
        return CageFace{faces_[face].cage_face, faces_[face].sub_face};
    }

    /// Not of triangles, whose second derivatives need their sign looked up.
    std::optional<std::uint64_t> kind(Id face) const override {
        if (domain_ == FaceDomain::kTriangle) return std::nullopt;
        return patches_.kind(faces_[face].cage_face, faces_[face].sub_face);
    }
    FaceControls controls(Id face) const override {
        return patches_.controls(faces_[face].cage_face, faces_[face].sub_face);
    }
    FaceStencils stencils(Id face, const Vec2& uv) const override {
        return patches_.stencils(faces_[face].cage_face, faces_[face].sub_face, uv);
    }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        const Vec2 inside = clamp_to_domain(domain_, uv);
        LimitPatches::Point here = patches_.eval(faces_[face].cage_face, faces_[face].sub_face, inside);
        if (domain_ == FaceDomain::kTriangle) turn_second_derivatives(face, inside, here.point);
        return with_normal(face, inside, here);
    }

    SurfacePoint eval_first_order(Id face, const Vec2& uv) const override {
        const Vec2 inside = clamp_to_domain(domain_, uv);
        return with_normal(face, inside, eval_patch(face, inside));
    }

    std::unique_ptr<const SurfaceBounder> make_bounder() const override { return bounder_.get(*this); }

  private:
    /// Without second derivatives.
    LimitPatches::Point eval_patch(Id face, const Vec2& uv) const {
        return patches_.eval_first_order(faces_[face].cage_face, faces_[face].sub_face, uv);
    }

    SurfacePoint with_normal(Id face, const Vec2& inside, LimitPatches::Point here) const {
        here.point.normal = normal_of(here);
        if (here.point.normal == Vec3(0)) here.point.normal = normal_near(face, inside);
        return here.point;
    }

    /// OpenSubdiv 3.5 gives the second derivatives with the wrong sign where a triangle's patch is
    /// turned by half a turn, which it does not tell: the first ones a little nearer to the middle do.
    void turn_second_derivatives(Id face, const Vec2& uv, SurfacePoint& point) const {
        const Vec2 step = kStepForSign * (Vec2(1.0 / 3) - uv + Vec2(0x1p-8, 0x1p-9));
        const SurfacePoint ahead = eval_patch(face, uv + step).point;
        const Vec3 by_u = step.x * point.duu + step.y * point.duv;
        const Vec3 by_v = step.x * point.duv + step.y * point.dvv;
        if (dot(ahead.du - point.du, by_u) + dot(ahead.dv - point.dv, by_v) >= 0) return;
        for (Vec3* second : {&point.duu, &point.duv, &point.dvv}) *second = -*second;
    }

    static Vec3 normal_of(const LimitPatches::Point& at) { return normal_of_tangents(at.point, at.extent); }

    Vec3 normal_near(Id face, const Vec2& uv) const {
        const Vec2 middle = domain_ == FaceDomain::kSquare ? Vec2(0.5) : Vec2(1.0 / 3);
        for (double step : kStepsInward) {
            const Vec3 normal = normal_of(eval_patch(face, uv + step * (middle - uv)));
            if (normal != Vec3(0)) return normal;
        }
        return Vec3(0);
    }

    FaceDomain domain_;
    bool is_as_given_ = true;
    LimitPatches patches_;
    SharedPolynomialBounder bounder_;
    std::vector<bool> is_flat_;  // per face of the cage
    std::vector<SurfaceFace> faces_;
    std::vector<Box> hulls_;  // of these
};

}  // namespace

std::unique_ptr<Surface> make_limit_surface(const Cage& cage, const std::string& name, const Warn& warn,
                                            double memory) {
    if (cage.scheme == SubdivisionScheme::kUnsubdivided) return make_polygon_surface(cage, name);
    const CheckedCage checked = check_cage(cage, name, warn);
    const bool is_as_given = checked.vertices.size() == cage.face_vertex_indices.size();
    return std::make_unique<LimitSurface>(NamedCage{checked, name, is_as_given}, warn, memory);
}

}  // namespace trilens
