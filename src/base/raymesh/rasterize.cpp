// Gives each sample to the facet that covers it, by exact signs of homogeneous edge functions: asked for only
// where rounding could matter.
// Based on: Olano and Greer, Triangle Scan Conversion using 2D Homogeneous Coordinates, 1997.
#include "base/raymesh/rasterize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/math/side_of_edge.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

/// Lines of samples [x0, x1) x [y0, y1) that a facet can cover, counted in samples from the window's corner.
struct SampleWindow {
    std::size_t x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

/// The facet's bounding rectangle in samples, one sample wider on each side against rounding.
SampleWindow window_of(const std::array<Vec3, 3>& corner, const SampleGrid& grid) {
    const std::size_t columns = grid.columns(), rows = grid.rows();
    Vec2 lo(INFINITY), hi(-INFINITY);
    for (const Vec3& c : corner) {
        if (!(c.z > 0)) return {0, columns, 0, rows};
        lo = glm::min(lo, Vec2(c.x / c.z, c.y / c.z));
        hi = glm::max(hi, Vec2(c.x / c.z, c.y / c.z));
    }
    const auto line = [&](double at, int start, std::size_t end) {
        const double position = std::floor((at - start) * grid.side);
        return static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(end)));
    };
    return {line(lo.x - 1.0 / grid.side, grid.x0, columns), line(hi.x + 2.0 / grid.side, grid.x0, columns),
            line(lo.y - 1.0 / grid.side, grid.y0, rows), line(hi.y + 2.0 / grid.side, grid.y0, rows)};
}

struct ScreenFacet {
    Id facet = 0;
    std::array<Vec3, 3> corner{};
    SampleWindow window;
    int orientation = 0;  // sign of the determinant of the corners; 0: any, since all are in front
    FacetEdges edges;
};

/// Whether the facet covers the sample: the edge functions have one sign, and the surface is in front there.
bool covers(const ScreenFacet& facet, const Vec2& sample) {
    std::array<Vec3, 3> local;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& c = facet.corner[k];
        local[k] = {c.x - sample.x * c.z, c.y - sample.y * c.z, c.z};
    }
    const int first = side_of_edge(local[0], local[1]);
    if (first == 0 || (facet.orientation != 0 && first != facet.orientation)) return false;
    return side_of_edge(local[1], local[2]) == first && side_of_edge(local[2], local[0]) == first;
}

std::vector<ScreenFacet> facets_on_screen(const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<ScreenFacet> facets;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f) || facet_weights(mesh, f).edge_on) continue;
        std::array<Vec3, 3> corner;
        bool all_in_front = true;
        for (std::size_t k = 0; k < 3; ++k) {
            corner[k] = mesh.screen[mesh.facets[f][k]];
            all_in_front = all_in_front && corner[k].z > 0;
        }
        const SampleWindow window = window_of(corner, grid);
        if (window.x0 >= window.x1 || window.y0 >= window.y1) continue;
        // Where a corner lies behind the camera, the corners' determinant tells front from behind: it is the
        // sum of the edge functions times the corners' depths.
        const int orientation = all_in_front ? 0 : triple(corner[0], corner[1], corner[2]) > 0 ? 1 : -1;
        facets.push_back(
            {static_cast<Id>(f), corner, window, orientation, FacetEdges(corner, orientation, grid)});
    }
    return facets;
}

/// A row of samples: where each column's sample stands.
struct SampleRow {
    std::size_t side = 1, first = 0;

    SampleRow(const SampleGrid& grid, std::size_t row)
        : side(grid.in_rows() ? 1 : static_cast<std::size_t>(grid.side)), first(grid.sample_at(0, row)) {}
    std::size_t sample(std::size_t column) const {
        return side == 1 ? first + column : first + column / side * side * side + column % side;
    }
};

/// A row's samples where only some are chosen.
struct ChosenRow {
    std::span<const Id> chosen;
    std::size_t number = 0;  // of column 0

    ChosenRow(const SampleGrid& grid, std::size_t row) : chosen(grid.chosen), number(row * grid.columns()) {}
    /// The first of the grid's samples at that column or after it.
    std::size_t first_from(std::size_t column) const {
        return static_cast<std::size_t>(std::lower_bound(chosen.begin(), chosen.end(), number + column) -
                                        chosen.begin());
    }
};

/// As fill_rows() where samples are chosen.
void fill_chosen(const std::vector<ScreenFacet>& facets, const SampleGrid& grid, std::vector<Id>& owner) {
    const Id last_number = grid.chosen.back();
    const std::size_t begin = grid.chosen.front() / grid.columns(), end = last_number / grid.columns() + 1;
    for (const ScreenFacet& facet : facets) {
        const std::size_t last = std::min(end, facet.window.y1);
        for (std::size_t row = std::max(begin, facet.window.y0); row < last; ++row) {
            const ChosenRow samples(grid, row);
            const std::size_t first = samples.first_from(facet.window.x0),
                              finish = samples.first_from(facet.window.x1);
            if (first == finish) continue;
            const RowSpan cover = facet.edges.cover(row, facet.window.x0, facet.window.x1);
            for (std::size_t s = first; s < finish; ++s) {
                const std::size_t column = grid.chosen[s] - samples.number;
                if (owner[s] != kNone || column < cover.begin || column >= cover.end) continue;
                if ((column >= cover.sure_begin && column < cover.sure_end) ||
                    covers(facet, grid.position(s)))
                    owner[s] = facet.facet;
            }
        }
    }
}

/// Rasterises rows of samples; facets ascend, so the first to claim a sample has the smallest index.
void fill_rows(const std::vector<ScreenFacet>& facets, const SampleGrid& grid, std::vector<Id>& owner,
               std::size_t first, std::size_t last) {
    for (const ScreenFacet& facet : facets) {
        const std::size_t end = std::min(last, facet.window.y1);
        for (std::size_t row = std::max(first, facet.window.y0); row < end; ++row) {
            const SampleRow samples(grid, row);
            const RowSpan cover = facet.edges.cover(row, facet.window.x0, facet.window.x1);
            const auto ask = [&](std::size_t begin, std::size_t finish) {
                for (std::size_t column = begin; column < finish; ++column) {
                    const std::size_t sample = samples.sample(column);
                    if (owner[sample] == kNone && covers(facet, grid.position(sample)))
                        owner[sample] = facet.facet;
                }
            };
            ask(cover.begin, cover.sure_begin);
            for (std::size_t column = cover.sure_begin; column < cover.sure_end; ++column) {
                Id& own = owner[samples.sample(column)];
                if (own == kNone) own = facet.facet;
            }
            ask(cover.sure_end, cover.end);
        }
    }
}

}  // namespace

FacetSamples rasterize_facets(const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<Id> owner(grid.size(), kNone);
    const std::vector<ScreenFacet> facets = facets_on_screen(mesh, grid);
    constexpr std::size_t kRowsTogether = 16;
    if (!grid.chosen.empty())
        fill_chosen(facets, grid, owner);
    else
        parallel_for(grid.rows(), kRowsTogether, [&](std::size_t first, std::size_t last) {
            fill_rows(facets, grid, owner, first, last);
        });
    return group_by_facet(owner, mesh.facets.size());
}

FacetSamples pixels_in_facets(const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<Id> owner(grid.pixels(), kNone);
    const std::vector<ScreenFacet> facets = facets_on_screen(mesh, grid);
    const std::size_t side = static_cast<std::size_t>(grid.side),
                      width = static_cast<std::size_t>(grid.width());
    // What is covered of a row, but where nothing is sure.
    const auto covered = [&](const ScreenFacet& facet, std::size_t row) {
        RowSpan span = facet.edges.cover(row, facet.window.x0, facet.window.x1);
        const auto covers_at = [&](std::size_t column) {
            return covers(facet, grid.position(grid.sample_at(column, row)));
        };
        if (span.sure_begin == span.sure_end) return span;
        while (span.sure_begin > span.begin && covers_at(span.sure_begin - 1)) --span.sure_begin;
        while (span.sure_end < span.end && covers_at(span.sure_end)) ++span.sure_end;
        return span;
    };
    // Facets are convex: a pixel lies inside where its first and its last row of samples do.
    const auto fill_row = [&](const ScreenFacet& facet, std::size_t y) {
        const RowSpan first = covered(facet, y * side), last = covered(facet, y * side + side - 1);
        const std::size_t begin = std::max(first.sure_begin, last.sure_begin),
                          end = std::min(first.sure_end, last.sure_end);
        for (std::size_t x = (begin + side - 1) / side; x < end / side; ++x)
            if (owner[y * width + x] == kNone) owner[y * width + x] = facet.facet;
    };
    parallel_for(static_cast<std::size_t>(grid.height()), 4, [&](std::size_t from, std::size_t to) {
        for (const ScreenFacet& facet : facets)
            for (std::size_t y = std::max(from, facet.window.y0 / side);
                 y < std::min(to, (facet.window.y1 + side - 1) / side); ++y)
                fill_row(facet, y);
    });
    return group_by_facet(owner, mesh.facets.size());
}

namespace {

/// Where a x + d > least, in columns of samples, one column given away for the rounding of the quotient.
struct Columns {
    double begin = 0, end = 0;
};

/// A column's centre stands half a column behind its number.
double column_at(const SampleGrid& grid, double x) {
    return (x - grid.x0) * grid.side - 0.5;
}

/// `margin`: columns by which the range is made smaller at the end that the edge cuts; negative: larger.
Columns columns_above(const SampleGrid& grid, double slope, double rest, double margin) {
    if (slope > 0) return {std::ceil(column_at(grid, rest / slope)) + margin, INFINITY};
    if (slope < 0) return {-INFINITY, std::floor(column_at(grid, rest / slope)) + 1 - margin};
    return rest < 0 ? Columns{-INFINITY, INFINITY} : Columns{INFINITY, -INFINITY};
}

}  // namespace

FacetEdges::FacetEdges(const std::array<Vec3, 3>& corner, int orientation, const SampleGrid& grid)
    : grid_(grid) {
    // No coordinate of a corner relative to a sample is larger than `size`.
    const double reach_x = std::max(std::fabs(grid.x0), std::fabs(grid.x1));
    const double reach_y = std::max(std::fabs(grid.y0), std::fabs(grid.y1));
    double size = 0, depth = 0;
    for (const Vec3& c : corner) {
        depth = std::max(depth, std::fabs(c.z));
        size = std::max(
            {size, std::fabs(c.x) + reach_x * std::fabs(c.z), std::fabs(c.y) + reach_y * std::fabs(c.z)});
    }
    // With u = 2^-53: a corner relative to a sample, with the sample's own rounding, is off by 4 u size at
    // most, so that the edge function of those is off by 16 u size^2; the affine form, with products of at
    // most size^2 and seven roundings, by less than another 32 u size^2.
    bound_ = 0x1p-46 * size * size;
    for (std::size_t k = 0; k < 3; ++k) edge_[k] = cross(corner[k], corner[(k + 1) % 3]);

    // The determinant is the sum of the edge functions times the corners' depths. Where all corners are in
    // front and it is sure, its sign is the one that the edge functions have inside, and no sample sees the
    // three with the other.
    const double determinant = dot(corner[0], edge_[1]);
    const bool sure_sign = orientation != 0 || std::fabs(determinant) > 8 * bound_ * depth;
    const double sign = orientation != 0 ? orientation : determinant > 0 ? 1 : -1;
    for (Vec3& edge : edge_) edge = sign * edge;
    const bool ordinary = bound_ > 0x1p-900 && bound_ < 0x1p900;
    usable_ = sure_sign && ordinary;
}

RowSpan FacetEdges::cover(std::size_t row, std::size_t first, std::size_t last) const {
    RowSpan cover{first, first, first, last};
    if (!usable_) return cover;
    const double y = grid_.y0 + (static_cast<double>(row) + 0.5) / grid_.side;
    Columns sure{-INFINITY, INFINITY}, may = sure;
    const auto intersect = [](Columns& a, const Columns& b) {
        a = {std::max(a.begin, b.begin), std::min(a.end, b.end)};
    };
    for (const Vec3& edge : edge_) {
        const double rest = edge.y * y + edge.z;
        intersect(sure, columns_above(grid_, edge.x, bound_ - rest, 1));
        intersect(may, columns_above(grid_, edge.x, -bound_ - rest, -1));
    }
    const auto place = [&](double column) {
        return static_cast<std::size_t>(
            std::clamp(column, static_cast<double>(first), static_cast<double>(last)));
    };
    cover.begin = place(may.begin);
    cover.end = std::max(cover.begin, place(may.end));
    cover.sure_begin = std::clamp(place(sure.begin), cover.begin, cover.end);
    cover.sure_end = std::clamp(place(sure.end), cover.sure_begin, cover.end);
    return cover;
}

}  // namespace trilens
