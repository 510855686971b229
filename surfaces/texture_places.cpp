#include "surfaces/texture_places.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace trilens {
namespace {

/// uv of a surface face's corners, in the order of FaceBorder.
using CornerUvs = std::array<Vec2, 4>;

/// What moves the point along u alone and along v alone, of parameters (a, b) with uv_a and uv_b their
/// derivatives.
TexturePlace by_parameters(const Vec2& uv, const Vec2& uv_a, const Vec2& uv_b, const SurfacePoint& at) {
    const double area = cross(uv_a, uv_b);
    if (!(area != 0)) return {uv, Vec3(0), Vec3(0)};
    return {uv, (uv_b.y * at.du - uv_a.y * at.dv) / area, (uv_a.x * at.dv - uv_b.x * at.du) / area};
}

TexturePlace on_square(const CornerUvs& c, const Vec2& p, const SurfacePoint& at) {
    const Vec2 low = (1 - p.x) * c[0] + p.x * c[1], high = (1 - p.x) * c[3] + p.x * c[2];
    const Vec2 across = (1 - p.y) * (c[1] - c[0]) + p.y * (c[2] - c[3]);
    return by_parameters((1 - p.y) * low + p.y * high, across, high - low, at);
}

TexturePlace on_triangle(const CornerUvs& c, const Vec2& p, const SurfacePoint& at) {
    return by_parameters(c[0] + p.x * (c[1] - c[0]) + p.y * (c[2] - c[0]), c[1] - c[0], c[2] - c[0], at);
}

/// Of a triangle; all three are none where one is zero.
using CornerTangents = std::array<Vec4, 3>;

void turn_by_tangents(const CornerTangents& c, const Vec2& p, const Vec3& normal, TexturePlace& place) {
    for (const Vec4& corner : c)
        if (Vec3(corner) == Vec3(0)) return;
    const Vec4 mean = (1 - p.x - p.y) * c[0] + p.x * c[1] + p.y * c[2];
    place.along_u = Vec3(mean);
    place.along_v = (mean.w < 0 ? -1.0 : 1.0) * cross(normal, place.along_u);
}

CornerUvs corners_of(const CageFace& of, std::span<const Vec2> polygon) {
    CornerUvs corners{};
    if (of.sub_face < 0) {
        std::copy_n(polygon.begin(), std::min<std::size_t>(polygon.size(), 4), corners.begin());
        return corners;
    }
    const std::size_t n = polygon.size(), k = static_cast<std::size_t>(of.sub_face);
    Vec2 centre(0);
    for (const Vec2& uv : polygon) centre += uv / static_cast<double>(n);
    return {polygon[k], 0.5 * (polygon[k] + polygon[(k + 1) % n]), centre,
            0.5 * (polygon[k] + polygon[(k + n - 1) % n])};
}

/// The primitive's own frame: z along the axis, x along the tangent.
struct LocalFrame {
    Vec3 x, y, z;
};

}  // namespace

TexturePlaces places_on_primitive(const Primitive& primitive) {
    const Vec3 axis = normalize_or_zero(primitive.axis);
    const Vec3 side = normalize_or_zero(cross(axis, primitive.tangent));
    const LocalFrame frame{cross(side, axis), primitive.is_mirrored ? -side : side, axis};
    return [primitive, frame](Id, const Vec2&, const SurfacePoint& at) {
        const Vec3 off = at.position - primitive.center;
        const Vec3 p(dot(off, frame.x), dot(off, frame.y), dot(off, frame.z));
        if (const auto* plane = std::get_if<PlanePrimitive>(&primitive.kind))
            return TexturePlace{{p.x / plane->size.x + 0.5, p.y / plane->size.y + 0.5}, frame.x, frame.y};
        const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi), r = std::hypot(p.x, p.y);
        TexturePlace place;
        place.uv.x = turn < 0 ? turn + 1 : turn;
        if (r > 0) place.along_u = (p.x * frame.y - p.y * frame.x) / r;
        // v grows along the axis, on a bowl outward: at right angles to u on the surface.
        const Vec3 across = cross(at.normal, place.along_u);
        const bool is_bowl = std::holds_alternative<ParaboloidPrimitive>(primitive.kind) ||
                             std::holds_alternative<LensPrimitive>(primitive.kind);
        const Vec3 growth = is_bowl ? p.x * frame.x + p.y * frame.y : frame.z;
        place.along_v = dot(across, growth) < 0 ? -across : across;
        if (const auto* sphere = std::get_if<SpherePrimitive>(&primitive.kind))
            place.uv.y = 0.5 + std::asin(std::clamp(p.z / sphere->radius, -1.0, 1.0)) / std::numbers::pi;
        if (const auto* cylinder = std::get_if<CylinderPrimitive>(&primitive.kind))
            place.uv.y = 0.5 + p.z / cylinder->height;
        if (const auto* cone = std::get_if<ConePrimitive>(&primitive.kind)) place.uv.y = p.z / cone->height;
        if (const auto* bowl = std::get_if<ParaboloidPrimitive>(&primitive.kind))
            place.uv.y = r / bowl->radius;
        if (const auto* lens = std::get_if<LensPrimitive>(&primitive.kind))
            place.uv.y = r / std::max(lens->front.aperture, lens->back.aperture);
        return place;
    };
}

std::optional<TexturePlaces> places_on_cage(const Surface& surface, const Cage& cage,
                                            std::span<const Vec2> uvs, std::span<const Vec4> tangents) {
    const auto* known = dynamic_cast<const HasCageFaces*>(&surface);
    if (!known || uvs.size() != cage.face_vertex_indices.size()) return std::nullopt;
    std::vector<std::size_t> first{0};
    for (const int count : cage.face_vertex_counts)
        first.push_back(first.back() + static_cast<std::size_t>(count));
    const bool has_tangents = tangents.size() == cage.face_vertex_indices.size();
    std::vector<CornerUvs> of_faces;
    std::vector<CornerTangents> turns;
    for (Id face = 0; face < surface.face_count(); ++face) {
        const std::optional<CageFace> of = known->cage_face(face);
        if (!of) return std::nullopt;
        const auto polygon = static_cast<std::size_t>(of->face);
        of_faces.push_back(corners_of(*of, uvs.subspan(first[polygon], first[polygon + 1] - first[polygon])));
        if (has_tangents && surface.domain(face) == FaceDomain::kTriangle)
            turns.push_back(
                {tangents[first[polygon]], tangents[first[polygon] + 1], tangents[first[polygon] + 2]});
    }
    if (turns.size() != of_faces.size()) turns.clear();
    std::vector<FaceDomain> domains;
    for (Id face = 0; face < surface.face_count(); ++face) domains.push_back(surface.domain(face));
    return [of_faces = std::move(of_faces), turns = std::move(turns), domains = std::move(domains)](
               Id face, const Vec2& parameters, const SurfacePoint& at) {
        TexturePlace place = domains[face] == FaceDomain::kSquare
                                 ? on_square(of_faces[face], parameters, at)
                                 : on_triangle(of_faces[face], parameters, at);
        if (!turns.empty()) turn_by_tangents(turns[face], parameters, at.normal, place);
        return place;
    };
}

}  // namespace trilens
