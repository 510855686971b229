// From a surface to facets without cracks: points of shared corners and edges exist once, by topology.
#include <array>
#include <cstddef>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "surfaces/face_hulls.h"
#include "surfaces/lattice.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

constexpr int kMostSteps = 1024;

/// An edge that faces share: the points along it, in its own direction.
struct GridEdge {
    bool split = false;  // some face sees only half of it, so it has 2n segments
    Id middle = kNone;   // of a split edge: the corner id of its middle
    std::vector<Id>
        points;  // 2n + 1 or n + 1; the ends and a split edge's middle stay kNone: they are corners
};

/// Numbers the points of a grid. Face by face; a point belongs to the face that asks for it first.
class PointNumbers {
  public:
    PointNumbers(const Surface& surface, int n) : surface_(surface), n_(n) {
        for (Id face = 0; face < surface.face_count(); ++face) note_halves(surface.border(face));
    }

    std::array<bool, 4> split_sides(const FaceBorder& border) const {
        std::array<bool, 4> split{};
        for (std::size_t k = 0; k < 4; ++k) {
            const FaceSide& side = border.sides[k];
            if (side.edge == kNone || side.part != FaceSide::Part::kWhole) continue;
            const auto edge = edges_.find(side.edge);
            split[k] = edge != edges_.end() && edge->second.split;
        }
        return split;
    }

    /// The point of each sample of the face.
    std::vector<Id> number(Id face, const Lattice& lattice) {
        const FaceBorder border = surface_.border(face);
        std::vector<Id> points(lattice.uv().size(), kNone);
        const int sides = lattice.side_count();
        for (int k = 0; k < sides; ++k) {
            const std::vector<int> samples = lattice.side(k);
            points[samples.front()] =
                corner(border.corners[static_cast<std::size_t>(k)], points[samples.front()]);
            const std::size_t next = static_cast<std::size_t>((k + 1) % sides);
            points[samples.back()] = corner(border.corners[next], points[samples.back()]);
            number_side(border.sides[static_cast<std::size_t>(k)], samples, points);
        }
        for (Id& point : points)
            if (point == kNone) point = count_++;
        return points;
    }

    Id count() const { return count_; }

  private:
    /// Halves tell that their edge is split and which corner is its middle.
    void note_halves(const FaceBorder& border) {
        const std::size_t sides = 4;  // only square faces have halves
        for (std::size_t k = 0; k < sides; ++k) {
            const FaceSide& side = border.sides[k];
            if (side.edge == kNone || side.part == FaceSide::Part::kWhole) continue;
            const bool ends_at_middle = (side.part == FaceSide::Part::kFirstHalf) != side.reversed;
            GridEdge& edge = edges_[side.edge];
            edge.split = true;
            edge.middle = border.corners[ends_at_middle ? (k + 1) % sides : k];
        }
    }

    Id corner(Id corner, Id already) {
        if (already != kNone) return already;
        if (corner == kNone) return count_++;
        const auto [place, is_new] = corners_.try_emplace(corner, count_);
        if (is_new) ++count_;
        return place->second;
    }

    /// The points strictly between the ends of a side.
    void number_side(const FaceSide& side, const std::vector<int>& samples, std::vector<Id>& points) {
        if (side.edge == kNone) return;
        GridEdge& edge = edges_[side.edge];
        const std::size_t segments = static_cast<std::size_t>(edge.split ? 2 * n_ : n_);
        edge.points.resize(segments + 1, kNone);
        const std::size_t begin = side.part == FaceSide::Part::kSecondHalf ? segments / 2 : 0;
        const std::size_t steps = samples.size() - 1;
        for (std::size_t i = 1; i < steps; ++i) {
            const std::size_t along = begin + (side.reversed ? steps - i : i);
            Id& point = edge.points[along];
            if (edge.split && 2 * along == segments) point = corner(edge.middle, point);
            if (point == kNone) point = count_++;
            points[samples[i]] = point;
        }
    }

    const Surface& surface_;
    int n_;
    Id count_ = 0;
    std::unordered_map<Id, Id> corners_;
    std::unordered_map<Id, GridEdge> edges_;
};

/// One face of the grid to be.
struct GridFace {
    const Lattice* lattice = nullptr;
    std::vector<Id> points;     // per sample
    std::vector<Vec3> normals;  // per sample
};

/// Gives each point a corner per direction that the normals there take.
class CornerNumbers {
  public:
    explicit CornerNumbers(std::size_t points) : first_(points, kNone) {}

    Id number(Id point, const Vec3& normal) {
        for (Id corner = first_[point]; corner != kNone; corner = next_[corner]) {
            if (!agree(normal, representative_[corner])) continue;
            sum_[corner] += normal;
            return corner;
        }
        const Id corner = static_cast<Id>(point_.size());
        point_.push_back(point);
        representative_.push_back(normal);
        sum_.push_back(normal);
        next_.push_back(std::exchange(first_[point], corner));
        return corner;
    }

    void finish(SurfaceGrid& grid) const {
        grid.corner_point = point_;
        for (std::size_t corner = 0; corner < sum_.size(); ++corner) {
            const bool is_one = sum_[corner] == representative_[corner];
            grid.corner_normal.push_back(is_one ? sum_[corner] : normalize_or_zero(sum_[corner]));
        }
    }

  private:
    static bool agree(const Vec3& a, const Vec3& b) {
        if (a == Vec3(0) || b == Vec3(0)) return a == b;
        return length(a - b) <= kSameNormal;
    }

    std::vector<Id> first_;  // per point: its latest corner
    std::vector<Id> next_;   // per corner: an earlier corner of the same point
    std::vector<Id> point_;
    std::vector<Vec3> representative_, sum_;
};

/// Evaluates the samples; the face that comes first decides the position of a point that faces share.
void evaluate(const Surface& surface, std::vector<GridFace>& faces, std::vector<Vec3>& points) {
    std::vector<Id> owner(points.size(), kNone);
    for (Id f = 0; f < faces.size(); ++f)
        for (Id point : faces[f].points)
            if (owner[point] == kNone) owner[point] = f;

    parallel_for(faces.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            GridFace& face = faces[f];
            face.normals.resize(face.points.size());
            for (std::size_t i = 0; i < face.points.size(); ++i) {
                const SurfacePoint point =
                    surface.eval_first_order(static_cast<Id>(f), face.lattice->uv()[i]);
                face.normals[i] = point.normal;
                if (owner[face.points[i]] == f) points[face.points[i]] = point.position;
            }
        }
    });
}

void add_facets(const GridFace& face, Id number, CornerNumbers& corners, SurfaceGrid& grid) {
    std::vector<Id> corner(face.points.size());
    std::vector<Vec3> positions(face.points.size());
    for (std::size_t i = 0; i < face.points.size(); ++i) {
        corner[i] = corners.number(face.points[i], face.normals[i]);
        positions[i] = grid.points[face.points[i]];
    }
    const std::vector<Vec2>& uv = face.lattice->uv();
    for (const auto& [a, b, c] : face.lattice->facets(positions)) {
        grid.facets.push_back({corner[a], corner[b], corner[c]});
        grid.facet_face.push_back(number);
        grid.facet_uv.push_back({uv[a], uv[b], uv[c]});
    }
}

}  // namespace

std::vector<Box> face_hulls(const Surface& surface) {
    std::vector<Box> hulls;
    const auto* known = dynamic_cast<const HasHulls*>(&surface);
    for (Id face = 0; known && face < surface.face_count(); ++face) {
        const std::optional<Box> hull = known->hull(face);
        if (!hull) return {};
        hulls.push_back(*hull);
    }
    return hulls;
}

SurfaceGrid make_face_grid(const Surface& surface, Id face, int n) {
    TRILENS_CHECK(n >= 1 && n <= kMostSteps, "a grid has 1 to 1024 steps");
    const Lattice lattice(surface.domain(face), n, {});
    SurfaceGrid grid;
    for (const Vec2& uv : lattice.uv()) {
        const SurfacePoint point = surface.eval_first_order(face, uv);
        grid.corner_point.push_back(static_cast<Id>(grid.points.size()));
        grid.points.push_back(point.position);
        grid.corner_normal.push_back(point.normal);
    }
    for (const auto& [a, b, c] : lattice.facets(grid.points)) {
        grid.facets.push_back({static_cast<Id>(a), static_cast<Id>(b), static_cast<Id>(c)});
        grid.facet_face.push_back(face);
        grid.facet_uv.push_back({lattice.uv()[a], lattice.uv()[b], lattice.uv()[c]});
    }
    return grid;
}

SurfaceGrid make_grid(const Surface& surface, int n) {
    TRILENS_CHECK(n >= 1 && n <= kMostSteps, "a grid has 1 to 1024 steps");
    PointNumbers numbers(surface, n);
    std::map<std::pair<FaceDomain, std::array<bool, 4>>, Lattice> lattices;
    std::vector<GridFace> faces(surface.face_count());
    for (Id f = 0; f < faces.size(); ++f) {
        const auto kind = std::pair(surface.domain(f), numbers.split_sides(surface.border(f)));
        const Lattice& lattice = lattices.try_emplace(kind, kind.first, n, kind.second).first->second;
        faces[f].lattice = &lattice;
        faces[f].points = numbers.number(f, lattice);
    }

    SurfaceGrid grid;
    grid.points.resize(numbers.count());
    evaluate(surface, faces, grid.points);
    const std::size_t count = count_facets(surface, n);
    grid.facets.reserve(count);
    grid.facet_face.reserve(count);
    grid.facet_uv.reserve(count);
    CornerNumbers corners(grid.points.size());
    for (Id f = 0; f < faces.size(); ++f) add_facets(faces[f], f, corners, grid);
    corners.finish(grid);
    return grid;
}

}  // namespace trilens
