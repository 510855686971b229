#include "caustics/receiver_faces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/box.h"

namespace trilens {
namespace {

/// How far corners may lie beside a plane, as a share of the distances on it.
constexpr double kFlat = 1e-9;

/// A face is a rectangle that has this share of the one around it.
constexpr double kFilled = 1 - 1e-9;

using Corners = std::array<Vec3, 3>;

bool lies_in(const ReceiverFace& face, const Corners& points) {
    return std::all_of(points.begin(), points.end(), [&](const Vec3& point) {
        const Vec3 way = point - face.point;
        return std::fabs(dot(way, face.normal)) <= kFlat * (length(way) + face.radius);
    });
}

/// Neither the longest nor the shortest: of half a rectangle, which the longest would cut askew, the longer
/// leg.
Vec3 middle_side(const Corners& points) {
    Corners sides{points[1] - points[0], points[2] - points[1], points[0] - points[2]};
    std::sort(sides.begin(), sides.end(), [](const Vec3& a, const Vec3& b) { return dot(a, a) < dot(b, b); });
    return sides[1];
}

}  // namespace

ReceiverFaces::ReceiverFaces(const TriangleScene& scene) : face_of_(scene.size(), kNone) {
    Box box;          // of the face at hand
    Id last = kNone;  // its last triangle
    for (Id t = 0; t < scene.size(); ++t) {
        const IdTriple& corner = scene.triangles[t];
        const Corners points{scene.points[corner[0]], scene.points[corner[1]], scene.points[corner[2]]};
        const Vec3 normal = normalize_or_zero(cross(points[1] - points[0], points[2] - points[0]));
        if (normal == Vec3(0)) continue;
        if (last == kNone || scene.object[t] != scene.object[last] || !lies_in(faces_.back(), points)) {
            faces_.push_back({points[0], normal, {}, 0, normalize(middle_side(points)), {}});
            box = {};
        }
        for (const Vec3& point : points) box.include(point);
        ReceiverFace& face = faces_.back();
        face.center = 0.5 * (box.low + box.high);
        face.center -= dot(face.center - face.point, face.normal) * face.normal;
        face.radius = 0.5 * length(box.size());
        face.area += 0.5 * length(cross(points[1] - points[0], points[2] - points[0]));
        face_of_[t] = static_cast<Id>(faces_.size() - 1);
        last = t;
    }
    for (Id t = 0; t < scene.size(); ++t) {
        if (face_of_[t] == kNone) continue;
        ReceiverFace& face = faces_[face_of_[t]];
        for (const Id corner : scene.triangles[t]) {
            const Vec3 way = scene.points[corner] - face.center;
            face.half = glm::max(
                face.half, glm::abs(Vec2(dot(way, face.along), dot(way, cross(face.normal, face.along)))));
        }
    }
}

bool ReceiverFaces::holds(Id face, const Vec3& place) const {
    const ReceiverFace& one = faces_[face];
    const Vec3 way = place - one.center;
    const Vec2 at = glm::abs(Vec2(dot(way, one.along), dot(way, cross(one.normal, one.along))));
    return one.area >= kFilled * 4 * one.half.x * one.half.y && at.x <= one.half.x && at.y <= one.half.y;
}

}  // namespace trilens
