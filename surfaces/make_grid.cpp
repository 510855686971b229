// From a surface to facets without cracks: points of shared corners and edges exist once, by topology.
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "surfaces/grid_parts.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

/// Samples of a face: the lattice of n steps per side, and on each split side the middles between them.
///
/// A side is split where its edge meets two sub-faces of an n-gon on the other side: they bring 2n segments
/// to it.
class Lattice {
  public:
    Lattice(FaceDomain domain, int n, const std::array<bool, 4>& split);

    const std::vector<Vec2>& uv() const { return uv_; }
    int side_count() const { return domain_ == FaceDomain::kSquare ? 4 : 3; }
    /// The samples along side k from its first to its second corner: n + 1, or 2n + 1 where split.
    std::vector<int> side(int k) const;
    /// Two triangles per square, cut along its shorter diagonal in the world (a tie: from (0,0) to (1,1)); a
    /// square on a split side is a fan around the first middle on its border. `positions`: one per sample.
    std::vector<std::array<int, 3>> facets(const std::vector<Vec3>& positions) const;

  private:
    int at(int i, int j) const;
    int side_at(int k, int step) const;
    void add_square(int i, int j, const std::vector<Vec3>& positions,
                    std::vector<std::array<int, 3>>& facets) const;

    FaceDomain domain_;
    int n_;
    std::array<int, 4> first_middle_{-1, -1, -1, -1};  // per side: its middles' first sample; -1: not split
    std::vector<Vec2> uv_;
};

Lattice::Lattice(FaceDomain domain, int n, const std::array<bool, 4>& split) : domain_(domain), n_(n) {
    const double steps = n;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= (domain == FaceDomain::kSquare ? n : n - j); ++i)
            uv_.emplace_back(i / steps, j / steps);
    for (int k = 0; k < side_count(); ++k) {
        if (!split[static_cast<std::size_t>(k)]) continue;
        first_middle_[static_cast<std::size_t>(k)] = static_cast<int>(uv_.size());
        for (int step = 0; step < n; ++step)
            uv_.push_back(0.5 * (uv_[side_at(k, step)] + uv_[side_at(k, step + 1)]));
    }
}

int Lattice::at(int i, int j) const {
    return domain_ == FaceDomain::kSquare ? j * (n_ + 1) + i : j * (n_ + 1) - j * (j - 1) / 2 + i;
}

int Lattice::side_at(int k, int step) const {
    if (domain_ == FaceDomain::kTriangle)
        return k == 0 ? at(step, 0) : k == 1 ? at(n_ - step, step) : at(0, n_ - step);
    return k == 0 ? at(step, 0) : k == 1 ? at(n_, step) : k == 2 ? at(n_ - step, n_) : at(0, n_ - step);
}

std::vector<int> Lattice::side(int k) const {
    std::vector<int> samples;
    for (int step = 0; step <= n_; ++step) {
        samples.push_back(side_at(k, step));
        const int middles = first_middle_[static_cast<std::size_t>(k)];
        if (middles >= 0 && step < n_) samples.push_back(middles + step);
    }
    return samples;
}

void Lattice::add_square(int i, int j, const std::vector<Vec3>& positions,
                         std::vector<std::array<int, 3>>& facets) const {
    const std::array<int, 4> corner = {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
    // Per side of the square: the middle on it, if it lies on a split side of the face.
    const auto middle = [this](int k, bool on_border, int step) {
        const int first = first_middle_[static_cast<std::size_t>(k)];
        return on_border && first >= 0 ? first + step : -1;
    };
    const std::array<int, 4> middles = {middle(0, j == 0, i), middle(1, i == n_ - 1, j),
                                        middle(2, j == n_ - 1, n_ - 1 - i), middle(3, i == 0, n_ - 1 - j)};

    // The border of the square, begun at the point that all facets share.
    std::vector<int> border;
    std::size_t begin = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        border.push_back(corner[k]);
        if (middles[k] < 0) continue;
        if (begin == 0) begin = border.size();
        border.push_back(middles[k]);
    }
    if (begin == 0 && second_diagonal_is_shorter({positions[corner[0]], positions[corner[1]],
                                                  positions[corner[2]], positions[corner[3]]}))
        begin = 1;
    std::rotate(border.begin(), border.begin() + static_cast<std::ptrdiff_t>(begin), border.end());
    for (std::size_t k = 1; k + 1 < border.size(); ++k)
        facets.push_back({border[0], border[k], border[k + 1]});
}

std::vector<std::array<int, 3>> Lattice::facets(const std::vector<Vec3>& positions) const {
    std::vector<std::array<int, 3>> facets;
    for (int j = 0; j < n_; ++j) {
        if (domain_ == FaceDomain::kSquare) {
            for (int i = 0; i < n_; ++i) add_square(i, j, positions, facets);
            continue;
        }
        for (int i = 0; i < n_ - j; ++i) {
            facets.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            if (i + 1 < n_ - j) facets.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return facets;
}

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

// How many facets a grid has, without making it.

std::size_t count_facets(const Surface& surface, int n) {
    const std::size_t side_squares = static_cast<std::size_t>(n);
    const Id faces = static_cast<Id>(surface.face_count());
    std::unordered_set<Id> split;  // edges that one of their faces sees as halves
    for (Id face = 0; face < faces; ++face)
        for (const FaceSide& side : surface.border(face).sides)
            if (side.edge != kNone && side.part != FaceSide::Part::kWhole) split.insert(side.edge);

    std::size_t count = 0;
    for (Id face = 0; face < faces; ++face) {
        if (surface.domain(face) == FaceDomain::kTriangle) {
            count += side_squares * side_squares;
            continue;
        }
        count += 2 * side_squares * side_squares;
        // Each square along a whole side of a split edge has one corner more, hence one facet more.
        for (const FaceSide& side : surface.border(face).sides)
            if (side.part == FaceSide::Part::kWhole && split.contains(side.edge)) count += side_squares;
    }
    return count;
}

int resolution_within(const Surface& surface, int n, std::size_t most_facets) {
    while (n > 1 && count_facets(surface, n) > most_facets) --n;
    return n;
}

}  // namespace trilens
