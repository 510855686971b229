#include "inverse/maps/sampled_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/util/error.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr double kMiddleShare = 0.5;     // of the tolerance: where the map bends most, others are off by more
constexpr std::size_t kBatch = 1 << 16;  // places evaluated between two looks at the progress
constexpr double kRounding = 1e-7;       // of a position that is known as floats

/// Coefficients of 1, t, t^2, t^3.
struct Cubic {
    std::array<Vec2, 4> of{};

    /// With these ends and slopes, at t = 0 and 1 (Hermite's).
    static Cubic through(const Vec2& p0, const Vec2& m0, const Vec2& p1, const Vec2& m1) {
        return {{p0, m0, 3.0 * (p1 - p0) - 2.0 * m0 - m1, 2.0 * (p0 - p1) + m0 + m1}};
    }
    Vec2 value(double t) const { return of[0] + t * (of[1] + t * (of[2] + t * of[3])); }
    Vec2 slope(double t) const { return of[1] + t * (2.0 * of[2] + 3 * t * of[3]); }
};

/// A patch along u, which is cubic.
struct PatchRow {
    Cubic position, by_v;  // and its derivative by v
    Vec3 weight{1}, weight_by_u{0};
    Vec2 size{1};  // of the patch, pixels
    std::uint64_t history = 0;

    /// u in 0..1.
    MapImage at(double u) const {
        return {position.value(u), Mat2(position.slope(u) / size.x, by_v.value(u) / size.y),
                weight + u * weight_by_u, history};
    }
};

/// Which image of `there` continues each of `here`, `step` away: the one whose tangent meets its own half way
/// best. None unless that pairs them off one to one.
bool pair_off(const MapImages& here, const MapImages& there, const Vec2& step, std::vector<Id>& paired) {
    const std::size_t count = here.size();
    if (there.size() != count) return false;
    paired.assign(count, 0);
    std::uint64_t taken = 0;
    for (std::size_t i = 0; i < count; ++i) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < count; ++k) {
            if (there[k].history != here[i].history) continue;
            const Vec2 gap = here[i].position + here[i].jacobian * (0.5 * step) - there[k].position +
                             there[k].jacobian * (0.5 * step);
            if (dot(gap, gap) < least) least = dot(gap, gap), paired[i] = static_cast<Id>(k);
        }
        if (!(least < std::numeric_limits<double>::infinity()) || (taken >> paired[i] & 1)) return false;
        taken |= std::uint64_t{1} << paired[i];
    }
    return true;
}

constexpr std::size_t kMostPaired = 32;  // images of one place that are interpolated at all

}  // namespace

/// The corners of one cell, paired off.
struct SampledMap::Patch {
    Vec2 size{1};
    std::array<const MapImages*, 4> corner{};
    std::array<std::vector<Id>, 4> pairs;

    static std::optional<Patch> of(const SampledMap& map, const Cell& cell) {
        Patch patch;
        patch.size = {std::max(1, cell.x1 - cell.x0), std::max(1, cell.y1 - cell.y0)};
        for (std::size_t c = 0; c < 4; ++c) patch.corner[c] = &map.images_[cell.sample[c]];
        if (patch.count() > kMostPaired) return std::nullopt;
        for (std::size_t c = 0; c < 4; ++c) {
            const Vec2 step((c & 1) ? cell.x1 - cell.x0 : 0, (c & 2) ? cell.y1 - cell.y0 : 0);
            if (!pair_off(*patch.corner[0], *patch.corner[c], step, patch.pairs[c])) return std::nullopt;
        }
        return patch;
    }

    std::size_t count() const { return corner[0]->size(); }

    /// Coons' patch of the four cubic edges where v is held, of image i.
    PatchRow row(std::size_t i, double v) const {
        std::array<const MapImage*, 4> c;
        for (std::size_t k = 0; k < 4; ++k) c[k] = &(*corner[k])[pairs[k][i]];
        const auto edge = [&](std::size_t a, std::size_t b, int axis) {
            return Cubic::through(c[a]->position, size[axis] * c[a]->jacobian[axis], c[b]->position,
                                  size[axis] * c[b]->jacobian[axis]);
        };
        const Cubic top = edge(0, 1, 0), bottom = edge(2, 3, 0), left = edge(0, 2, 1), right = edge(1, 3, 1);
        const Vec2 left_at = left.value(v), right_at = right.value(v), left_slope = left.slope(v),
                   right_slope = right.slope(v);
        const Vec2 &p00 = c[0]->position, &p10 = c[1]->position, &p01 = c[2]->position, &p11 = c[3]->position;
        PatchRow row;
        row.size = size;
        for (std::size_t k = 0; k < 4; ++k) {
            row.position.of[k] = (1 - v) * top.of[k] + v * bottom.of[k];
            row.by_v.of[k] = bottom.of[k] - top.of[k];
        }
        row.position.of[0] += left_at - (1 - v) * p00 - v * p01;
        row.position.of[1] += right_at - left_at - (1 - v) * (p10 - p00) - v * (p11 - p01);
        row.by_v.of[0] += left_slope + p00 - p01;
        row.by_v.of[1] += right_slope - left_slope + p10 - p00 + p01 - p11;
        row.weight = (1 - v) * c[0]->weight + v * c[2]->weight;
        row.weight_by_u = (1 - v) * c[1]->weight + v * c[3]->weight - row.weight;
        row.history = c[0]->history;
        return row;
    }

    /// How far the images at u and v, in 0..1, are off these; infinity where they are not the same.
    double error_at(const Vec2& uv, const MapImages& exact) const {
        double worst = 0;
        if (exact.size() != count()) return std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < count(); ++i) {
            const MapImage predicted = row(i, uv.y).at(uv.x);
            double nearest = std::numeric_limits<double>::infinity();
            for (const MapImage& one : exact)
                if (one.history == predicted.history)
                    nearest = std::min(nearest, length(one.position - predicted.position));
            worst = std::max(worst, nearest);
        }
        return worst;
    }
};

SampledMap::SampledMap(const MapLattice& lattice, const EvaluateMap& evaluate, const Progress& progress,
                       const MapChecks& checks)
    : lattice_(lattice) {
    const int width = lattice.width, height = lattice.height, step = std::max(1, lattice.cell);
    at_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kNone);
    std::vector<Cell> cells;
    for (int y = 0; y == 0 || y < height - 1; y += step)
        for (int x = 0; x == 0 || x < width - 1; x += step)
            cells.push_back({x, y, std::min(x + step, width - 1), std::min(y + step, height - 1)});

    fresh_.assign(block_count(), 0);
    while (!cells.empty()) {
        settle(std::move(cells), evaluate, checks, progress);
        cells = checks.known.empty() ? take_contradicted() : std::vector<Cell>();
    }
    at_ = {};
    fresh_ = {};
}

/// Level by level: all corners and middles of a level are evaluated together.
void SampledMap::settle(std::vector<Cell> cells, const EvaluateMap& evaluate, const MapChecks& checks,
                        const Progress& progress) {
    while (!cells.empty()) {
        std::vector<Cell> finer;
        for (std::size_t from = 0; from < cells.size(); from += kBatch) {
            std::vector<Cell> some(
                cells.begin() + static_cast<std::ptrdiff_t>(from),
                cells.begin() + static_cast<std::ptrdiff_t>(std::min(from + kBatch, cells.size())));
            evaluate_level(some, evaluate, checks.known.empty());
            std::vector<double> error(some.size());
            parallel_for(some.size(), 256, [&](std::size_t first, std::size_t last) {
                for (std::size_t i = first; i < last; ++i) error[i] = error_of(some[i], checks);
            });
            for (std::size_t i = 0; i < some.size(); ++i) {
                const Cell& cell = some[i];
                if (error[i] <= kMiddleShare * lattice_.tolerance) {
                    worst_ = std::max(worst_, error[i]);
                    settled_.push_back(cell);
                    settled_pixels_ += double(cell.x1 - cell.x0) * (cell.y1 - cell.y0);
                } else {
                    divide(cell, finer);
                }
            }
            progress.stop_if_cancelled();
            progress(std::min(1.0, settled_pixels_ / (double(lattice_.width) * lattice_.height)));
        }
        cells = std::move(finer);
    }
}

void SampledMap::divide(const Cell& cell, std::vector<Cell>& into) {
    const int mx = (cell.x0 + cell.x1) / 2, my = (cell.y0 + cell.y1) / 2;
    const bool wide = mx > cell.x0, high = my > cell.y0;
    into.push_back({cell.x0, cell.y0, wide ? mx : cell.x1, high ? my : cell.y1});
    if (wide) into.push_back({mx, cell.y0, cell.x1, high ? my : cell.y1});
    if (high) into.push_back({cell.x0, my, wide ? mx : cell.x1, cell.y1});
    if (wide && high) into.push_back({mx, my, cell.x1, cell.y1});
}

/// Settled cells whose sides have places, evaluated for a finer neighbour, that the patch is off: divided.
std::vector<SampledMap::Cell> SampledMap::take_contradicted() {
    const std::vector<unsigned char> fresh =
        std::exchange(fresh_, std::vector<unsigned char>(fresh_.size(), 0));
    std::vector<unsigned char> off(settled_.size(), 0);
    parallel_for(settled_.size(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            off[i] = fresh[block_at(settled_[i].x0, settled_[i].y0)] && is_contradicted(settled_[i]);
    });
    std::vector<Cell> kept, finer;
    for (std::size_t i = 0; i < off.size(); ++i) {
        const Cell& cell = settled_[i];
        if (!off[i]) {
            kept.push_back(cell);
            continue;
        }
        settled_pixels_ -= double(cell.x1 - cell.x0) * (cell.y1 - cell.y0);
        divide(cell, finer);
    }
    settled_ = std::move(kept);
    return finer;
}

bool SampledMap::is_contradicted(const Cell& cell) const {
    if (is_exact(cell)) return false;
    std::optional<Patch> patch;
    for (int y = cell.y0; y <= cell.y1; ++y) {
        const int step = y == cell.y0 || y == cell.y1 ? 1 : std::max(1, cell.x1 - cell.x0);
        for (int x = cell.x0; x <= cell.x1; x += step) {
            const Id sample = at_[pixel_at(x, y)];
            if (sample == kNone) continue;
            if (!patch && !(patch = Patch::of(*this, cell))) return true;
            if (patch->error_at({(x - cell.x0) / patch->size.x, (y - cell.y0) / patch->size.y},
                                images_[sample]) > lattice_.tolerance)
                return true;
        }
    }
    return false;
}

void SampledMap::evaluate_level(std::vector<Cell>& cells, const EvaluateMap& evaluate, bool with_middles) {
    std::vector<Vec2> places;
    const auto ask = [&](int x, int y) {
        Id& sample = at_[pixel_at(x, y)];
        if (sample != kNone) return sample;
        sample = static_cast<Id>(images_.size() + places.size());
        places.emplace_back(x + 0.5, y + 0.5);
        for (const int left : {x - 1, x})
            for (const int above : {y - 1, y})
                if (left >= 0 && above >= 0) fresh_[block_at(left, above)] = 1;
        return sample;
    };
    for (Cell& cell : cells) {
        cell.sample = {ask(cell.x0, cell.y0), ask(cell.x1, cell.y0), ask(cell.x0, cell.y1),
                       ask(cell.x1, cell.y1)};
        if (with_middles && !is_exact(cell)) ask((cell.x0 + cell.x1) / 2, (cell.y0 + cell.y1) / 2);
    }
    const std::size_t before = images_.size();
    images_.resize(before + places.size());
    evaluate(places, std::span(images_).subspan(before));
}

double SampledMap::error_of(const Cell& cell, const MapChecks& checks) const {
    if (is_exact(cell)) return 0;
    const double error = checks.known.empty() ? error_at_middle(cell) : error_of_pixels(cell, checks.known);
    if (!checks.judge || error > kMiddleShare * lattice_.tolerance) return error;
    const std::optional<Patch> patch = Patch::of(*this, cell);
    const auto at = [&](const Vec2& place, MapImages& images) {
        images.clear();
        for (std::size_t i = 0; i < patch->count(); ++i)
            images.push_back(patch->row(i, (place.y - 0.5 - cell.y0) / patch->size.y)
                                 .at((place.x - 0.5 - cell.x0) / patch->size.x));
    };
    const bool stands = patch && checks.judge({cell.x0, cell.y0, cell.x1, cell.y1, at});
    return stands ? error : std::numeric_limits<double>::infinity();
}

double SampledMap::error_at_middle(const Cell& cell) const {
    constexpr double kNot = std::numeric_limits<double>::infinity();
    const std::optional<Patch> patch = Patch::of(*this, cell);
    if (!patch) return kNot;
    const int mx = (cell.x0 + cell.x1) / 2, my = (cell.y0 + cell.y1) / 2;
    const MapImages& middle = images_[at_[pixel_at(mx, my)]];
    return patch->error_at({(mx - cell.x0) / patch->size.x, (my - cell.y0) / patch->size.y}, middle);
}

/// Of a cell all of whose pixels have the same history, at the worst of them.
double SampledMap::error_of_pixels(const Cell& cell, const KnownPixels& known) const {
    constexpr double kNot = std::numeric_limits<double>::infinity();
    const std::uint64_t history = known.history[pixel_at(cell.x0, cell.y0)];
    for (int y = cell.y0; y <= cell.y1; ++y)
        for (int x = cell.x0; x <= cell.x1; ++x)
            if (known.history[pixel_at(x, y)] != history) return kNot;
    if (history == 0) return 0;
    const std::optional<Patch> patch = Patch::of(*this, cell);
    if (!patch) return kNot;
    double worst = 0;
    for (int y = cell.y0; y <= cell.y1; ++y) {
        const PatchRow row = patch->row(0, (y - cell.y0) / patch->size.y);
        for (int x = cell.x0; x <= cell.x1; ++x) {
            const Vec2 exact(known.x[pixel_at(x, y)], known.y[pixel_at(x, y)]);
            const Vec2 predicted = row.at((x - cell.x0) / patch->size.x).position;
            worst = std::max(worst, length(predicted - exact) - kRounding * length(exact));
        }
    }
    return worst;
}

void SampledMap::for_each_pixel(
    const std::function<void(int x, int y, std::span<const MapImage> images)>& use) const {
    parallel_for(settled_.size(), 64, [&](std::size_t first, std::size_t last) {
        std::vector<PatchRow> rows;
        std::vector<MapImage> images;
        for (std::size_t i = first; i < last; ++i) {
            const Cell& cell = settled_[i];
            // A pixel on an edge belongs to the cell to its right and below, where there is one.
            const int end_x = cell.x1 == lattice_.width - 1 ? cell.x1 + 1 : cell.x1;
            const int end_y = cell.y1 == lattice_.height - 1 ? cell.y1 + 1 : cell.y1;
            const std::optional<Patch> patch = is_exact(cell) ? std::nullopt : Patch::of(*this, cell);
            for (int y = cell.y0; y < end_y; ++y) {
                const bool at_y0 = y == cell.y0, has_corners = at_y0 || y == cell.y1;
                rows.clear();
                for (std::size_t k = 0; patch && k < patch->count(); ++k)
                    rows.push_back(patch->row(k, (y - cell.y0) / patch->size.y));
                for (int x = cell.x0; x < end_x; ++x) {
                    const bool at_x0 = x == cell.x0;
                    if (!patch || (has_corners && (at_x0 || x == cell.x1))) {
                        use(x, y, images_[cell.sample[(at_x0 ? 0u : 1u) + (at_y0 ? 0u : 2u)]]);
                        continue;
                    }
                    images.clear();
                    for (const PatchRow& row : rows) images.push_back(row.at((x - cell.x0) / patch->size.x));
                    use(x, y, images);
                }
            }
        }
    });
}

std::vector<SampledMap::Pixel> SampledMap::pixels() const {
    const auto width = static_cast<std::size_t>(lattice_.width);
    std::vector<Pixel> pixels(width * static_cast<std::size_t>(lattice_.height));
    for_each_pixel([&](int x, int y, std::span<const MapImage> images) {
        if (!images.empty())
            pixels[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] = {true, images[0]};
    });
    return pixels;
}

}  // namespace trilens
