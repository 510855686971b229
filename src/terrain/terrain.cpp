#include "terrain/terrain.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "terrain/quadtree_triangles.h"

namespace trilens {
namespace {

/// From samples to the terrain's own frame.
class Frame {
  public:
    Frame(const HeightGrid& heights, const Vec3& size)
        : size_(size), columns_(heights.columns - 1), rows_(heights.rows - 1) {}

    SampleSpacing spacing() const {
        return {{-0.5 * size_.x, -0.5 * size_.z}, {size_.x / columns_, size_.z / rows_}, size_.y};
    }
    Vec3 point(const GridPlace& place) const {
        return {(place.column / columns_ - 0.5) * size_.x, place.height * size_.y,
                (place.row / rows_ - 0.5) * size_.z};
    }
    Vec2 uv(const GridPlace& place) const { return {place.column / columns_, 1 - place.row / rows_}; }

    /// By the heights at most one sample away on either side that are there.
    Vec3 normal(const HeightSquare& heights, const GridPlace& place) const {
        const int x = static_cast<int>(std::lround(place.column)),
                  y = static_cast<int>(std::lround(place.row));
        const auto slope = [&](int dx, int dy) {
            const auto known = [&](int i, int j) {
                return i >= 0 && j >= 0 && heights.is_inside(i, j) && !heights.is_missing(i, j);
            };
            const int before = known(x - dx, y - dy) ? 1 : 0, after = known(x + dx, y + dy) ? 1 : 0;
            if (before + after == 0) return 0.0;
            return (heights.at(x + after * dx, y + after * dy) -
                    heights.at(x - before * dx, y - before * dy)) *
                   size_.y / (before + after);
        };
        return normalize(Vec3(-slope(1, 0) * columns_ / size_.x, 1, -slope(0, 1) * rows_ / size_.z));
    }

  private:
    Vec3 size_;
    double columns_, rows_;
};

/// How far the triangles of the kept samples are from all samples: hats of those that are gone, summed from
/// the coarsest on. What is seen of a triangulation between samples is nowhere farther off, for all its sides
/// are sides of the whole grid's triangles.
class Deviations {
  public:
    Deviations(const HeightSquare& heights, const KeptSample& is_kept)
        : heights_(heights), is_kept_(is_kept) {
        off_.assign(static_cast<std::size_t>(heights.side()) * static_cast<std::size_t>(heights.side()), 0);
        for (int m = heights.levels() - 1; m >= 0; --m) {
            const int half = 1 << m;
            for (int y = half; y < heights.side(); y += 2 * half)
                for (int x = half; x < heights.side(); x += 2 * half) settle(x, y, half);
            for (int y = 0; y < heights.side(); y += half)
                for (int x = (y / half) % 2 == 0 ? half : 0; x < heights.side(); x += 2 * half)
                    settle(x, y, half);
        }
    }

    void sum_up(TerrainMesh& mesh, double scale) const {
        double squares = 0;
        std::size_t count = 0;
        for (int y = 0; y <= heights_.last_row(); ++y)
            for (int x = 0; x <= heights_.last_column(); ++x) {
                if (heights_.is_missing(x, y)) continue;
                const double off = std::fabs(static_cast<double>(off_[heights_.index(x, y)])) * scale;
                mesh.greatest_error = std::max(mesh.greatest_error, off);
                squares += off * off;
                ++count;
            }
        if (count > 0) mesh.rms_error = std::sqrt(squares / static_cast<double>(count));
    }

  private:
    void settle(int x, int y, int half) {
        if (is_kept_(x, y)) return;
        const auto [dx, dy] = halved_side(x, y, half);
        const auto off = [&](int i, int j) { return static_cast<double>(off_[heights_.index(i, j)]); };
        off_[heights_.index(x, y)] = static_cast<float>(bisection_detail(heights_, x, y, half) +
                                                        0.5 * (off(x - dx, y - dy) + off(x + dx, y + dy)));
    }

    const HeightSquare& heights_;
    const KeptSample& is_kept_;
    std::vector<float> off_;
};

void require_few(std::size_t count) {
    if (count > kMostTerrainTriangles)
        throw std::length_error(std::to_string(count) + " triangles, more than " +
                                std::to_string(kMostTerrainTriangles));
}

}  // namespace

TerrainMesh make_terrain(const HeightGrid& heights, const TerrainShape& shape,
                         const std::optional<Thinning>& thinning, const Progress& progress) {
    TerrainMesh mesh;
    mesh.whole_triangles =
        2 * static_cast<std::size_t>(heights.columns - 1) * static_cast<std::size_t>(heights.rows - 1);
    if (!thinning) require_few(mesh.whole_triangles);
    const HeightSquare square(heights, shape.no_data.value_or(std::numeric_limits<double>::quiet_NaN()));
    mesh.missing_heights = square.missing();
    const Frame frame(heights, shape.size);

    std::optional<SampleWorth> worth;
    KeptSample is_kept = [](int, int) { return true; };
    if (thinning) {
        std::optional<FilmScale> scale;
        if (thinning->moves) scale.emplace(square, frame.spacing(), thinning->moves, progress);
        worth.emplace(square, thinning->rule, frame.spacing(),
                      DetailWeights{thinning->region, scale ? &*scale : nullptr});
        is_kept = [&, threshold = thinning->threshold / shape.size.y](int x, int y) {
            return static_cast<double>(worth->at(x, y)) > threshold;
        };
        require_few(count_triangles(square, is_kept));
    }
    GridTriangles cut = cut_triangles(square, is_kept);
    for (const GridPlace& place : cut.places) {
        mesh.points.push_back(frame.point(place));
        mesh.normals.push_back(frame.normal(square, place));
        mesh.uvs.push_back(frame.uv(place));
    }
    mesh.triangles = std::move(cut.triangles);
    if (thinning) Deviations(square, is_kept).sum_up(mesh, shape.size.y);
    return mesh;
}

}  // namespace trilens
