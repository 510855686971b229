// Fills polygons row by row: every side notes where it crosses the rows of samples, and pairs of crossings
// are runs.
#include "projector/classic/classic_fill.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace trilens {
namespace {

/// The point at `depth` between a nearer and a farther vertex.
Vec3 at_depth(const Vec3& nearer, const Vec3& farther, double depth) {
    return farther + (farther.z - depth) / (farther.z - nearer.z) * (nearer - farther);
}

}  // namespace

SampleRows make_sample_rows(std::span<const Id> samples, const SampleGrid& grid) {
    std::vector<Vec2> position(samples.size());
    for (std::size_t s = 0; s < samples.size(); ++s) position[s] = grid.position(samples[s]);
    std::vector<std::size_t> order(samples.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (grid.side > 1) {
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return std::pair(position[a].y, position[a].x) < std::pair(position[b].y, position[b].x);
        });
    }
    SampleRows rows;
    for (const std::size_t s : order) {
        if (rows.row.empty() || rows.row.back().y != position[s].y)
            rows.row.push_back({position[s].y, rows.size(), rows.size()});
        rows.sample.push_back(samples[s]);
        rows.x.push_back(position[s].x);
        rows.row.back().end = rows.size();
    }
    return rows;
}

void PolygonFiller::add_side(const Vec2& a, const Vec2& b) {
    const bool down = std::pair(a.y, a.x) < std::pair(b.y, b.x);
    const Vec2 &top = down ? a : b, &bottom = down ? b : a;
    const auto before = [](const SampleRows::Row& row, double y) { return row.y < y; };
    auto row = std::lower_bound(rows_.row.begin(), rows_.row.end(), top.y, before);
    for (; row != rows_.row.end() && row->y < bottom.y; ++row) {
        const double share = (row->y - top.y) / (bottom.y - top.y);
        crossing_.push_back(
            {static_cast<std::size_t>(row - rows_.row.begin()), top.x + share * (bottom.x - top.x)});
    }
}

void PolygonFiller::add(const ScreenPolygon& polygon) {
    flat_.clear();
    const auto push = [&](const Vec3& v) { flat_.push_back({v.x / v.z, v.y / v.z}); };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &v = polygon[i], &next = polygon[(i + 1) % polygon.size()];
        const bool in = v.z >= least_depth_, next_in = next.z >= least_depth_;
        if (in) push(v);
        if (in != next_in) push(in ? at_depth(next, v, least_depth_) : at_depth(v, next, least_depth_));
    }
    for (std::size_t i = 0; i < flat_.size(); ++i) add_side(flat_[i], flat_[(i + 1) % flat_.size()]);
}

void PolygonFiller::fill(const std::function<void(std::size_t first, std::size_t end)>& body) {
    std::sort(crossing_.begin(), crossing_.end(), [](const Crossing& a, const Crossing& b) {
        return a.row != b.row ? a.row < b.row : a.x < b.x;
    });
    // Closed polygons cross every row an even number of times.
    for (std::size_t i = 0; i + 1 < crossing_.size(); i += 2) {
        const SampleRows::Row& row = rows_.row[crossing_[i].row];
        const auto place = [&](double x) {
            const auto begin = rows_.x.begin() + static_cast<std::ptrdiff_t>(row.first),
                       end = rows_.x.begin() + static_cast<std::ptrdiff_t>(row.end);
            return static_cast<std::size_t>(std::lower_bound(begin, end, x) - rows_.x.begin());
        };
        const std::size_t first = place(crossing_[i].x), end = place(crossing_[i + 1].x);
        if (first < end) body(first, end);
    }
    crossing_.clear();
}

}  // namespace trilens
