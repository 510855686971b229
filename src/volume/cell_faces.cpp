#include "volume/cell_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kAlongPlane = 1e-9;  // sine of the angle between a ray and a plane that it runs along
constexpr double kTouching = 1e-9;    // of t: as far apart as rounding puts one plane of two cells

/// A cell's side of a face, sorted by the face.
struct FaceSide {
    std::array<Id, 3> corners{};  // ascending
    Id cell = kNone;
    std::uint8_t k = 0;  // of the cell's faces

    bool operator<(const FaceSide& o) const {
        return corners != o.corners ? corners < o.corners : cell < o.cell;
    }
};

/// Where the ray's line meets the plane of a cell's face, and whether it leaves the cell there.
struct PlaneCrossing {
    double ahead = 0;  // distance to the plane, times the speed's unit
    double speed = 0;  // towards the outside
    double most = 0;   // that the speed could be

    /// Whether the ray does not run along the plane, to rounding.
    bool is_crossed() const { return std::fabs(speed) > kAlongPlane * most; }
};

/// In the order of the corners' numbers: the cells on both sides of a face get the same bits but for the
/// signs, so that no rounding parts them.
PlaneCrossing cross_plane(const TetMesh& mesh, const Tetrahedron& cell, std::size_t k, const Ray& ray) {
    std::array<Id, 3> corner = face_corners(cell, k);
    double sign = 1;
    const auto order = [&](std::size_t i, std::size_t j) {
        if (corner[i] < corner[j]) return;
        std::swap(corner[i], corner[j]);
        sign = -sign;
    };
    order(0, 1), order(1, 2), order(0, 1);
    const Vec3& a = mesh.points[corner[0]];
    const Vec3 normal = sign * cross(mesh.points[corner[1]] - a, mesh.points[corner[2]] - a);
    return {dot(normal, a - ray.origin), dot(normal, ray.direction), length(normal) * length(ray.direction)};
}

/// Where the ray leaves a cell that it came into at `entry`: the nearest plane that it goes out by. No
/// farther than the entry where it only touches the cell there, at an edge or a corner.
double exit_behind(const TetMesh& mesh, Id cell, const Ray& ray, double entry) {
    double exit = kNever;
    for (std::size_t k = 0; k < 4; ++k) {
        const PlaneCrossing at = cross_plane(mesh, mesh.cells[cell], k, ray);
        if (at.is_crossed() && at.speed > 0) exit = std::min(exit, at.ahead / at.speed);
    }
    return std::max(exit, entry);
}

/// Where it came into a cell that holds its start: the farthest plane before, or the start.
double entry_before(const TetMesh& mesh, Id cell, const Ray& ray) {
    double entry = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const PlaneCrossing at = cross_plane(mesh, mesh.cells[cell], k, ray);
        if (at.is_crossed() && at.speed < 0) entry = std::max(entry, at.ahead / at.speed);
    }
    return entry;
}

}  // namespace

std::array<Id, 3> face_corners(const Tetrahedron& cell, std::size_t k) {
    constexpr std::array<std::array<std::uint8_t, 3>, 4> kFaces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
    return {cell[kFaces[k][0]], cell[kFaces[k][1]], cell[kFaces[k][2]]};
}

CellFaces find_faces(const TetMesh& mesh, std::size_t& crowded) {
    std::vector<FaceSide> sides(4 * mesh.cells.size());
    parallel_for(mesh.cells.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t c = from; c < to; ++c)
            for (std::size_t k = 0; k < 4; ++k) {
                FaceSide& side = sides[4 * c + k];
                side.corners = face_corners(mesh.cells[c], k);
                std::sort(side.corners.begin(), side.corners.end());
                side.cell = static_cast<Id>(c);
                side.k = static_cast<std::uint8_t>(k);
            }
    });
    std::sort(sides.begin(), sides.end());
    struct Pair {
        FaceSide first;
        Id other = kNone;
    };
    std::vector<Pair> pairs;
    pairs.reserve(sides.size() / 2 + 1);
    crowded = 0;
    for (std::size_t i = 0; i < sides.size();) {
        std::size_t end = i + 1;
        while (end < sides.size() && sides[end].corners == sides[i].corners) ++end;
        crowded += end - i > 2;
        for (; i < end; i += 2) pairs.push_back({sides[i], i + 1 < end ? sides[i + 1].cell : kNone});
        i = end;
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
        return a.first.cell != b.first.cell ? a.first.cell < b.first.cell : a.first.k < b.first.k;
    });
    CellFaces faces;
    faces.triangles.points = mesh.points;
    faces.triangles.object.assign(pairs.size(), 0);
    for (const Pair& pair : pairs) {
        faces.triangles.primitive.push_back(static_cast<Id>(faces.triangles.triangles.size()));
        faces.triangles.triangles.push_back(face_corners(mesh.cells[pair.first.cell], pair.first.k));
        faces.cells.push_back({pair.first.cell, pair.other});
    }
    return faces;
}

Vec3 scalar_gradient(const TetMesh& mesh, Id id) {
    const Tetrahedron& cell = mesh.cells[id];
    const Vec3& a = mesh.points[cell[0]];
    const Vec3 b = mesh.points[cell[1]] - a, c = mesh.points[cell[2]] - a, d = mesh.points[cell[3]] - a;
    const double s = mesh.scalars[cell[0]];
    // Cramer's rule of b . g = s_b - s, c . g = s_c - s, d . g = s_d - s.
    return ((mesh.scalars[cell[1]] - s) * cross(c, d) + (mesh.scalars[cell[2]] - s) * cross(d, b) +
            (mesh.scalars[cell[3]] - s) * cross(b, c)) /
           dot(b, cross(c, d));
}

Box cell_box(const TetMesh& mesh, Id cell) {
    Box box;
    for (const Id corner : mesh.cells[cell]) box.include(mesh.points[corner]);
    return box;
}

std::optional<CellStretch> clip_line(const TetMesh& mesh, Id cell, const Ray& ray) {
    CellStretch stretch{cell, -kNever, kNever};
    for (std::size_t k = 0; k < 4; ++k) {
        const PlaneCrossing at = cross_plane(mesh, mesh.cells[cell], k, ray);
        if (at.speed > 0)
            stretch.t_out = std::min(stretch.t_out, at.ahead / at.speed);
        else if (at.speed < 0)
            stretch.t_in = std::max(stretch.t_in, at.ahead / at.speed);
        else if (at.ahead < 0)
            return std::nullopt;
    }
    if (!(stretch.t_in < stretch.t_out)) return std::nullopt;
    return stretch;
}

std::vector<CellStretch> CrossedCells::find(const Ray& ray, double until,
                                            std::span<const FaceCrossing> crossings) const {
    struct Side {
        Id cell;
        bool leaves;
        double t;
    };
    std::vector<Side> sides;
    sides.reserve(2 * crossings.size());
    for (const FaceCrossing& crossing : crossings) {
        const IdTriple& corner = faces_.triangles.triangles[crossing.face];
        const Vec3& a = mesh_.points[corner[0]];
        const Vec3 normal = cross(mesh_.points[corner[1]] - a, mesh_.points[corner[2]] - a);
        const auto [behind, before] = faces_.cells[crossing.face];
        const bool along = dot(normal, ray.direction) > 0;
        const Id left = along ? behind : before, entered = along ? before : behind;
        if (left != kNone) sides.push_back({left, true, crossing.t});
        if (entered != kNone) sides.push_back({entered, false, crossing.t});
    }
    // A line meets a cell once: of faces that it meets in a common edge the first one counts.
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        if (a.cell != b.cell) return a.cell < b.cell;
        if (a.leaves != b.leaves) return b.leaves;
        return a.t < b.t;
    });
    std::vector<CellStretch> cells;
    for (std::size_t i = 0; i < sides.size();) {
        const Id cell = sides[i].cell;
        CellStretch stretch{cell, sides[i].t, sides[i].t};
        if (sides[i].leaves) stretch.t_in = entry_before(mesh_, cell, ray);
        while (i < sides.size() && sides[i].cell == cell && !sides[i].leaves) ++i;
        const bool leaves = i < sides.size() && sides[i].cell == cell;
        stretch.t_out = leaves ? sides[i].t : exit_behind(mesh_, cell, ray, stretch.t_in);
        while (i < sides.size() && sides[i].cell == cell) ++i;
        cells.push_back(stretch);
    }
    order_cells(until, cells);
    return cells;
}

void order_cells(double until, std::vector<CellStretch>& cells) {
    const auto is_passed = [](const CellStretch& one) {
        return one.t_out - one.t_in > kTouching * one.t_out;
    };
    for (CellStretch& one : cells) {
        one.t_in = std::max(one.t_in, 0.0);
        one.t_out = std::min(one.t_out, until);
    }
    std::erase_if(cells, [&](const CellStretch& one) { return !is_passed(one); });
    std::sort(cells.begin(), cells.end(), [](const CellStretch& a, const CellStretch& b) {
        return a.t_in != b.t_in ? a.t_in < b.t_in : a.cell < b.cell;
    });
    // Along a face or an edge a ray comes into several cells at once: rounding is not to choose among them.
    for (auto first = cells.begin(); first != cells.end();) {
        const double same = first->t_in + kTouching * first->t_out;
        auto last = first;
        while (last != cells.end() && last->t_in <= same) ++last;
        std::sort(first, last, [](const CellStretch& a, const CellStretch& b) { return a.cell < b.cell; });
        first = last;
    }
    std::size_t kept = 0;
    double reached = 0;
    for (CellStretch one : cells) {
        if (kept > 0 && one.t_in - reached <= kTouching * one.t_in) one.t_in = reached;
        if (!is_passed(one)) continue;
        cells[kept++] = one;
        reached = one.t_out;
    }
    cells.resize(kept);
}

std::vector<ScalarStretch> scalars_along(const TetMesh& mesh, std::span<const Vec3> gradients, const Ray& ray,
                                         std::span<const CellStretch> cells) {
    const double unit = length(ray.direction);
    std::vector<ScalarStretch> stretches;
    stretches.reserve(cells.size());
    for (const CellStretch& one : cells) {
        const Tetrahedron& cell = mesh.cells[one.cell];
        const double at_origin =
                         mesh.scalars[cell[0]] + dot(gradients[one.cell], ray.origin - mesh.points[cell[0]]),
                     along = dot(gradients[one.cell], ray.direction);
        stretches.push_back(
            {unit * one.t_in, unit * one.t_out, at_origin + one.t_in * along, at_origin + one.t_out * along});
    }
    return stretches;
}

}  // namespace trilens
