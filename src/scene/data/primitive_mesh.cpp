#include "scene/data/primitive_mesh.h"

#include <cmath>
#include <functional>
#include <numbers>

#include "base/description/lens_sag.h"

namespace trilens {
namespace {

/// A point of a surface given by two parameters.
struct SurfaceCorner {
    Vec3 point{0}, normal{0};
};
using Patch = std::function<SurfaceCorner(double u, double v)>;

/// Where the patch's lower or upper row is one point: its quads are triangles there.
struct Poles {
    bool low = false, high = false;
};

/// columns x rows quads over the unit square of (u, v).
void add_patch(const Patch& patch, int columns, int rows, const Poles& poles, PolygonMesh& mesh) {
    const auto first = static_cast<int>(mesh.cage.points.size());
    std::vector<Vec3> normals;
    std::vector<Vec2> uvs;
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            const Vec2 uv(static_cast<double>(i) / columns, static_cast<double>(j) / rows);
            const SurfaceCorner corner = patch(uv.x, uv.y);
            mesh.cage.points.push_back(corner.point);
            normals.push_back(corner.normal);
            uvs.push_back(uv);
        }
    }
    const auto add_face = [&](std::initializer_list<int> corners) {
        mesh.cage.face_vertex_counts.push_back(static_cast<int>(corners.size()));
        for (const int corner : corners) {
            mesh.cage.face_vertex_indices.push_back(first + corner);
            mesh.normals.push_back(normals[static_cast<std::size_t>(corner)]);
            mesh.uvs.push_back(uvs[static_cast<std::size_t>(corner)]);
        }
    };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const int a = j * (columns + 1) + i, b = a + 1, c = b + columns + 1, d = c - 1;
            if (poles.low && j == 0)
                add_face({a, c, d});
            else if (poles.high && j == rows - 1)
                add_face({a, b, c});
            else
                add_face({a, b, c, d});
        }
    }
}

/// A frame about the axis: around(u) turns from the tangent, counterclockwise as the axis looks at one.
struct AxisFrame {
    explicit AxisFrame(const ObjectPrimitive& p)
        : axis(p.axis), tangent(p.tangent), side(cross(p.axis, p.tangent)) {}
    /// From the tangent towards the side, of length 1.
    static Vec2 turned(double u) {
        // Where the circle closes it is the same point to the last bit.
        const double angle = 2 * std::numbers::pi * (u < 1 ? u : u - 1);
        return {std::cos(angle), std::sin(angle)};
    }
    Vec3 around(double u) const { return turned(u).x * tangent + turned(u).y * side; }
    Vec3 axis, tangent, side;
};

/// A flat square: normal u x v.
Patch square(const Vec3& middle, const Vec3& along_u, const Vec3& along_v) {
    const Vec3 normal = normalize_or_zero(cross(along_u, along_v));
    return [=](double u, double v) {
        return SurfaceCorner{middle + (u - 0.5) * along_u + (v - 0.5) * along_v, normal};
    };
}

/// A disk whose normal is the frame's axis, or against it; with a hole in its middle, a ring.
struct Disk {
    Vec3 middle;
    double radius;
    bool along;
    double hole = 0;
};
void add_disk(const Disk& disk, const AxisFrame& frame, int segments, PolygonMesh& mesh) {
    const double turn = disk.along ? 1 : -1;
    const Patch patch = [=](double u, double v) {
        const double radius = (1 - v) * disk.radius + v * disk.hole;
        return SurfaceCorner{disk.middle + radius * frame.around(turn * u), turn * frame.axis};
    };
    add_patch(patch, segments, 1, {false, disk.hole == 0}, mesh);
}

// Each kind's patches; p has its place and segments.

void add_shape(const SpherePrimitive& sphere, const ObjectPrimitive& p, PolygonMesh& mesh) {
    const AxisFrame frame(p);
    const Patch patch = [&](double u, double v) {
        const double latitude = (v - 0.5) * std::numbers::pi;
        const double out = v > 0 && v < 1 ? std::cos(latitude) : 0;  // a pole is one point to the last bit
        const Vec3 normal = out * frame.around(u) + std::sin(latitude) * frame.axis;
        return SurfaceCorner{p.center + sphere.radius * normal, normal};
    };
    add_patch(patch, p.segments, (p.segments + 1) / 2, {true, true}, mesh);
}

/// r^2 = 4 f z; the front looks away from the focus, as outside a bowl.
void add_shape(const ParaboloidPrimitive& paraboloid, const ObjectPrimitive& p, PolygonMesh& mesh) {
    const AxisFrame frame(p);
    const double focal_length = paraboloid.focal_length;
    const Patch patch = [&](double u, double v) {
        const double r = v * paraboloid.radius;
        const Vec3 out = frame.around(u);
        const Vec3 point = p.center + r * out + r * r / (4 * focal_length) * frame.axis;
        return SurfaceCorner{point, normalize_or_zero(r / (2 * focal_length) * out - frame.axis)};
    };
    add_patch(patch, p.segments, (p.segments + 3) / 4, {true, false}, mesh);
}

void add_shape(const CylinderPrimitive& cylinder, const ObjectPrimitive& p, PolygonMesh& mesh) {
    const AxisFrame frame(p);
    const Vec3 up = 0.5 * cylinder.height * frame.axis;
    const Patch patch = [&](double u, double v) {
        const Vec3 out = frame.around(u);
        return SurfaceCorner{p.center + cylinder.radius * out + (2 * v - 1) * up, out};
    };
    add_patch(patch, p.segments, 1, {}, mesh);
    add_disk({p.center + up, cylinder.radius, true}, frame, p.segments, mesh);
    add_disk({p.center - up, cylinder.radius, false}, frame, p.segments, mesh);
}

void add_shape(const ConePrimitive& cone, const ObjectPrimitive& p, PolygonMesh& mesh) {
    const AxisFrame frame(p);
    const Patch patch = [&](double u, double v) {
        const Vec3 out = frame.around(u);
        return SurfaceCorner{p.center + (1 - v) * cone.radius * out + v * cone.height * frame.axis,
                             normalize(cone.height * out + cone.radius * frame.axis)};
    };
    add_patch(patch, p.segments, 1, {false, true}, mesh);
    add_disk({p.center, cone.radius, false}, frame, p.segments, mesh);
}

void add_shape(const PlanePrimitive& plane, const ObjectPrimitive& p, PolygonMesh& mesh) {
    const AxisFrame frame(p);
    add_patch(square(p.center, plane.size.x * frame.tangent, plane.size.y * frame.side), 1, 1, {}, mesh);
}

void add_shape(const LensPrimitive& lens, const ObjectPrimitive& p, PolygonMesh& mesh) {
    const AxisFrame frame(p);
    const auto across = [&](const Vec2& q) { return q.x * frame.tangent + q.y * frame.side; };
    const auto on = [&](const LensSide& side, const Vec2& q) {
        const double vertex = &side == &lens.front ? 0 : lens.thickness;
        return p.center + across(q) + (vertex + sag_over(side, q).z) * frame.axis;
    };
    // Fronts look out of the glass: the front side's against the axis, so it is turned the other way.
    for (const bool is_front : {true, false}) {
        const LensSide& side = is_front ? lens.front : lens.back;
        const double turn = is_front ? -1 : 1;
        const Patch patch = [&](double u, double v) {
            const double r = (1 - v) * side.aperture + v * lens.hole;
            const Vec2 q = r * AxisFrame::turned(is_front ? 1 - u : u);
            return SurfaceCorner{on(side, q), turn * normalize(frame.axis - across(sag_over(side, q).slope))};
        };
        add_patch(patch, p.segments, (p.segments + 3) / 4, {false, lens.hole == 0}, mesh);
    }
    const Patch edge = [&](double u, double v) {
        const Vec2 out = AxisFrame::turned(u), around(-out.y, out.x);
        const Vec2 low = lens.front.aperture * out, high = lens.back.aperture * out;
        const Vec3 up = on(lens.back, high) - on(lens.front, low);
        // Along the rims, a share v of the way from one to the other.
        const double rise = (1 - v) * dot(sag_over(lens.front, low).slope, lens.front.aperture * around) +
                            v * dot(sag_over(lens.back, high).slope, lens.back.aperture * around);
        const double radius = (1 - v) * lens.front.aperture + v * lens.back.aperture;
        const Vec3 along = radius * across(around) + rise * frame.axis;
        return SurfaceCorner{(1 - v) * on(lens.front, low) + v * on(lens.back, high),
                             normalize(cross(along, up))};
    };
    add_patch(edge, p.segments, 1, {}, mesh);
    if (lens.hole == 0) return;
    const Patch wall = [&](double u, double v) {
        const Vec2 out = AxisFrame::turned(1 - u), q = lens.hole * out;
        return SurfaceCorner{(1 - v) * on(lens.front, q) + v * on(lens.back, q), -across(out)};
    };
    add_patch(wall, p.segments, 1, {}, mesh);
}

void add_shape(const BoxPrimitive& box, const ObjectPrimitive& p, PolygonMesh& mesh) {
    const AxisFrame frame(p);
    const Vec3 half[3] = {0.5 * box.size.x * frame.tangent, 0.5 * box.size.y * frame.axis,
                          -0.5 * box.size.z * frame.side};
    for (int k = 0; k < 3; ++k) {
        const Vec3 &out = half[k], &u = half[(k + 1) % 3], &v = half[(k + 2) % 3];
        add_patch(square(p.center + out, 2.0 * u, 2.0 * v), 1, 1, {}, mesh);
        add_patch(square(p.center - out, 2.0 * v, 2.0 * u), 1, 1, {}, mesh);
    }
}

void add_shape(const DiskPrimitive& disk, const ObjectPrimitive& p, PolygonMesh& mesh) {
    add_disk({p.center, disk.radius, true, disk.hole}, AxisFrame(p), p.segments, mesh);
}

}  // namespace

PolygonMesh tessellate(const ObjectPrimitive& primitive) {
    PolygonMesh mesh;
    std::visit([&](const auto& kind) { add_shape(kind, primitive, mesh); }, primitive.kind);
    return mesh;
}

}  // namespace trilens
