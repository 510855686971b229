#include "terrain/film_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "base/util/error.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr int kFirstLevel = 4;
/// Answers within one cell that differ by no more are taken for equal.
constexpr double kMostRatio = 1.3;
/// Of the answers in the smallest cells, by which the greatest is raised.
constexpr double kMostRise = 2;
constexpr std::size_t kQueriesPerCell = 9;
constexpr std::size_t kFewestAtOnce = 64, kMostAtOnce = 4096;  // queries between two reports

std::size_t cell_index(int level, int i, int j) {
    return (static_cast<std::size_t>(j) << level) + static_cast<std::size_t>(i);
}

struct HeightRange {
    float low = std::numeric_limits<float>::infinity(), high = -std::numeric_limits<float>::infinity();

    void include(const HeightRange& other) {
        low = std::min(low, other.low);
        high = std::max(high, other.high);
    }
    bool is_empty() const { return low > high; }
};

/// Of the heights that are there, borders included; per level from the coarsest.
std::vector<std::vector<HeightRange>> height_ranges(const HeightSquare& heights, int levels, int samples) {
    std::vector<std::vector<HeightRange>> ranges(static_cast<std::size_t>(levels) + 1);
    for (int level = 0; level <= levels; ++level)
        ranges[static_cast<std::size_t>(level)].resize(std::size_t{1} << (2 * level));
    const int side = 1 << levels;
    parallel_for(static_cast<std::size_t>(side), 1, [&](std::size_t first, std::size_t last) {
        for (auto j = static_cast<int>(first); j < static_cast<int>(last); ++j)
            for (int i = 0; i < side; ++i)
                for (int y = j * samples; y <= std::min((j + 1) * samples, heights.last_row()); ++y)
                    for (int x = i * samples; x <= std::min((i + 1) * samples, heights.last_column()); ++x)
                        if (!heights.is_missing(x, y)) {
                            const auto value = static_cast<float>(heights.at(x, y));
                            ranges.back()[cell_index(levels, i, j)].include({value, value});
                        }
    });
    for (int level = levels; level > 0; --level)
        for (int j = 0; j < 1 << level; ++j)
            for (int i = 0; i < 1 << level; ++i)
                ranges[static_cast<std::size_t>(level) - 1][cell_index(level - 1, i / 2, j / 2)].include(
                    ranges[static_cast<std::size_t>(level)][cell_index(level, i, j)]);
    return ranges;
}

}  // namespace

/// One level of cells after the other.
class FilmScale::Refinement {
  public:
    Refinement(const HeightSquare& heights, const SampleSpacing& spacing, const FilmScale& scale,
               const Progress& progress)
        : heights_(heights),
          spacing_(spacing),
          progress_(progress),
          levels_(scale.levels_),
          samples_(scale.samples_),
          ranges_(height_ranges(heights, scale.levels_, scale.samples_)) {}

    /// The finest cells' values.
    std::vector<double> run(const FilmMoves& moves) {
        std::vector<double> finest(std::size_t{1} << (2 * levels_), 0);
        level_ = std::min(kFirstLevel, levels_);
        std::vector<Cell> cells;
        for (int j = 0; j < 1 << level_; ++j)
            for (int i = 0; i < 1 << level_; ++i) cells.push_back({i, j});
        while (!cells.empty()) {
            ask(cells, moves);
            std::vector<Cell> next;
            for (const Cell& cell : cells) {
                if (level_ < levels_ && is_divided(cell)) {
                    for (int k = 0; k < 4; ++k) next.push_back({2 * cell.i + k % 2, 2 * cell.j + k / 2});
                } else {
                    fill(cell, finest);
                }
            }
            cells = std::move(next);
            ++level_;
        }
        return finest;
    }

  private:
    struct Cell {
        int i = 0, j = 0;
    };
    struct Found {
        double least = std::numeric_limits<double>::infinity(), most = 0;
        int shown = 0, whole = 0, asked = 0;
    };

    const HeightRange& range(const Cell& cell) const {
        return ranges_[static_cast<std::size_t>(level_)][cell_index(level_, cell.i, cell.j)];
    }
    Vec3 place(double x, double y, double value) const {
        return {spacing_.first.x + std::min(x, double(heights_.last_column())) * spacing_.step.x,
                value * spacing_.height,
                spacing_.first.y + std::min(y, double(heights_.last_row())) * spacing_.step.y};
    }
    void add_queries(const Cell& cell, std::vector<FilmMoveQuery>& queries) const {
        const HeightRange heights = range(cell);
        const double side = double(samples_) * (1 << (levels_ - level_));
        const double low = double(heights.low), high = double(heights.high);
        const Vec3 first = place(cell.i * side, cell.j * side, low),
                   last = place((cell.i + 1) * side, (cell.j + 1) * side, high);
        const double reach = 0.5 * length(last - first);
        const Vec3 along(0, 1, 0);
        for (int k = 0; k < 8; ++k)
            queries.push_back({{(k & 1 ? last : first).x, (k & 2 ? last : first).y, (k & 4 ? last : first).z},
                               along,
                               reach});
        queries.push_back({0.5 * (first + last), along, reach});
    }

    /// A level counts as if all of its cells were asked for: what a film shows little of is done sooner.
    void report(double share_of_level) const {
        const double below = std::pow(4, level_ - std::min(kFirstLevel, levels_)),
                     all = std::pow(4, levels_ + 1 - std::min(kFirstLevel, levels_)) - 1;
        progress_(((below - 1) + 3 * below * share_of_level) / all);
    }

    std::vector<FilmMove> answers_to(std::span<const FilmMoveQuery> queries, const FilmMoves& moves) const {
        std::vector<FilmMove> answers;
        Portions portions(kFewestAtOnce, kMostAtOnce);
        while (answers.size() < queries.size()) {
            progress_.stop_if_cancelled();
            const std::vector<FilmMove> some =
                moves(queries.subspan(answers.size(), portions.next(queries.size() - answers.size())));
            answers.insert(answers.end(), some.begin(), some.end());
            report(static_cast<double>(answers.size()) / static_cast<double>(queries.size()));
        }
        return answers;
    }

    void ask(const std::vector<Cell>& cells, const FilmMoves& moves) {
        std::vector<FilmMoveQuery> queries;
        std::vector<Cell> asked;
        for (const Cell& cell : cells) {
            if (range(cell).is_empty()) continue;  // beyond the grid, or a hole
            asked.push_back(cell);
            add_queries(cell, queries);
        }
        const std::vector<FilmMove> answers = answers_to(queries, moves);
        found_.assign(std::size_t{1} << (2 * level_), {});
        for (std::size_t c = 0; c < asked.size(); ++c) {
            Found& found = found_[cell_index(level_, asked[c].i, asked[c].j)];
            for (std::size_t k = 0; k < kQueriesPerCell; ++k) {
                const FilmMove& move = answers[c * kQueriesPerCell + k];
                ++found.asked;
                found.most = std::max(found.most, move.pixels);
                if (move.is_shown) found.least = std::min(found.least, move.pixels);
                found.shown += move.is_shown ? 1 : 0;
                found.whole += move.is_whole ? 1 : 0;
            }
        }
    }

    const Found& found(const Cell& cell) const { return found_[cell_index(level_, cell.i, cell.j)]; }

    bool is_divided(const Cell& cell) const {
        const Found& here = found(cell);
        if (here.asked == 0) return false;
        if (here.shown > 0) return here.whole < here.asked || !(here.most <= kMostRatio * here.least);
        for (int j = std::max(0, cell.j - 1); j <= std::min(cell.j + 1, (1 << level_) - 1); ++j)
            for (int i = std::max(0, cell.i - 1); i <= std::min(cell.i + 1, (1 << level_) - 1); ++i)
                if (found({i, j}).shown > 0) return true;
        return false;
    }

    void fill(const Cell& cell, std::vector<double>& finest) const {
        const Found& here = found(cell);
        if (here.shown == 0) return;
        const double rise = here.least > 0 ? std::min(here.most / here.least, kMostRise) : kMostRise;
        const double value = std::isinf(here.most) ? here.most : here.most * rise;
        const int side = 1 << (levels_ - level_);
        for (int j = cell.j * side; j < (cell.j + 1) * side; ++j)
            for (int i = cell.i * side; i < (cell.i + 1) * side; ++i)
                finest[cell_index(levels_, i, j)] = value;
    }

    const HeightSquare& heights_;
    const SampleSpacing& spacing_;
    const Progress& progress_;
    int levels_, samples_, level_ = 0;
    std::vector<std::vector<HeightRange>> ranges_;
    std::vector<Found> found_;  // of the level's cells; those that are not asked for are not shown
};

FilmScale::FilmScale(const HeightSquare& heights, const SampleSpacing& spacing, const FilmMoves& moves,
                     const Progress& progress) {
    levels_ = std::min(kMostLevels, heights.levels());
    samples_ = 1 << (heights.levels() - levels_);
    most_.resize(static_cast<std::size_t>(levels_) + 1);
    most_.back() = Refinement(heights, spacing, *this, progress).run(moves);
    for (int level = levels_ - 1; level >= 0; --level) {
        std::vector<double>& coarse = most_[static_cast<std::size_t>(level)];
        coarse.resize(std::size_t{1} << (2 * level));
        for (int j = 0; j < 1 << level; ++j)
            for (int i = 0; i < 1 << level; ++i)
                coarse[cell_index(level, i, j)] =
                    std::max({cell(level + 1, 2 * i, 2 * j), cell(level + 1, 2 * i + 1, 2 * j),
                              cell(level + 1, 2 * i, 2 * j + 1), cell(level + 1, 2 * i + 1, 2 * j + 1)});
    }
}

double FilmScale::cell(int level, int i, int j) const {
    const int side = 1 << level;
    if (i < 0 || j < 0 || i >= side || j >= side) return 0;
    return most_[static_cast<std::size_t>(level)][cell_index(level, i, j)];
}

double FilmScale::most_around(int x, int y, int half) const {
    int level = levels_, samples = samples_;
    while (samples < half) {
        --level;
        samples *= 2;
    }
    // The cells on both sides of x and of y: one alone where both are within it.
    const auto before = [&](int at) { return (at - half) >= 0 ? (at - half) / samples : -1; };
    const auto after = [&](int at) { return (at + half - 1) / samples; };
    double most = 0;
    for (int j = before(y); j <= after(y); ++j)
        for (int i = before(x); i <= after(x); ++i) most = std::max(most, cell(level, i, j));
    return most;
}

}  // namespace trilens
