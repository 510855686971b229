// Cells at the mesh's border in a uniform grid of bins, asked at the middle of each border face.
#include "volume/cell_checks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>
#include <vector>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr double kInside = 1e-9;  // of a cell's size
constexpr int kMostBinsAlongAxis = 512;

/// Cells by the bins that their boxes reach into.
class CellBins {
  public:
    CellBins(const TetMesh& mesh, const std::vector<Id>& cells) {
        Vec3 sides(0);
        for (const Id cell : cells) {
            const Box box = cell_box(mesh, cell);
            all_.include(box);
            sides += box.size() / static_cast<double>(cells.size());
        }
        for (int k = 0; k < 3; ++k) {
            const double wanted = sides[k] > 0 ? all_.size()[k] / sides[k] : 1;
            bins_[k] = std::clamp(wanted, 1.0, static_cast<double>(kMostBinsAlongAxis));
        }
        for (const Id cell : cells) {
            const Box box = cell_box(mesh, cell);
            const Vec3 low = bin_at(box.low), high = bin_at(box.high);
            for (double z = low.z; z <= high.z; ++z)
                for (double y = low.y; y <= high.y; ++y)
                    for (double x = low.x; x <= high.x; ++x) entries_.push_back({number({x, y, z}), cell});
        }
        std::sort(entries_.begin(), entries_.end());
    }

    template <typename Body>
    bool any_at(const Vec3& point, const Body& body) const {
        const std::size_t bin = number(bin_at(point));
        for (auto at = std::lower_bound(entries_.begin(), entries_.end(), std::pair(bin, Id{0}));
             at != entries_.end() && at->first == bin; ++at)
            if (body(at->second)) return true;
        return false;
    }

  private:
    Vec3 bin_at(const Vec3& point) const {
        Vec3 bin(0);
        for (int k = 0; k < 3; ++k) {
            const double side = all_.size()[k];
            if (side > 0)
                bin[k] = std::clamp(std::floor((point[k] - all_.low[k]) / side * bins_[k]), 0.0,
                                    std::floor(bins_[k]));
        }
        return bin;
    }
    std::size_t number(const Vec3& bin) const {
        constexpr std::size_t kSide = kMostBinsAlongAxis + 1;
        return (static_cast<std::size_t>(bin.z) * kSide + static_cast<std::size_t>(bin.y)) * kSide +
               static_cast<std::size_t>(bin.x);
    }

    Box all_;
    Vec3 bins_{1};
    std::vector<std::pair<std::size_t, Id>> entries_;
};

bool holds(const TetMesh& mesh, Id cell, const Vec3& point) {
    const double size = length(cell_box(mesh, cell).size());
    for (std::size_t k = 0; k < 4; ++k) {
        const std::array<Id, 3> corner = face_corners(mesh.cells[cell], k);
        const Vec3& a = mesh.points[corner[0]];
        const Vec3 normal = normalize_or_zero(cross(mesh.points[corner[1]] - a, mesh.points[corner[2]] - a));
        if (dot(normal, point - a) > kInside * size) return false;
    }
    return true;
}

}  // namespace

std::size_t count_open_faces(const TetMesh& mesh, const CellFaces& faces) {
    std::vector<Id> border, cells;
    for (std::size_t f = 0; f < faces.cells.size(); ++f) {
        if (faces.cells[f][1] != kNone) continue;
        border.push_back(static_cast<Id>(f));
        if (cells.empty() || cells.back() != faces.cells[f][0]) cells.push_back(faces.cells[f][0]);
    }
    if (border.empty()) return 0;
    const CellBins bins(mesh, cells);
    std::atomic<std::size_t> count = 0;
    parallel_for(border.size(), 256, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const IdTriple& corner = faces.triangles.triangles[border[i]];
            const Vec3 middle =
                (mesh.points[corner[0]] + mesh.points[corner[1]] + mesh.points[corner[2]]) / 3.0;
            const Id own = faces.cells[border[i]][0];
            count += bins.any_at(middle, [&](Id cell) { return cell != own && holds(mesh, cell, middle); });
        }
    });
    return count;
}

}  // namespace trilens
