#include "render/picture/fragments.h"

#include <algorithm>
#include <numeric>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::size_t kFragmentsPerTask = 256;
constexpr std::size_t kViewsAtOnce = 1u << 16;  // what bounds the memory of samples that stand for themselves

SampleGrid with_margin(const SampleGrid& window, const Film& film, int reach) {
    return {std::max(0, window.x0 - reach),
            std::max(0, window.y0 - reach),
            std::min(film.width, window.x1 + reach),
            std::min(film.height, window.y1 + reach),
            window.side,
            SampleOrder::kLattice};
}

}  // namespace

/// A row of pixels on its way.
struct FragmentColours::PixelRow {
    std::vector<Fragment> fragments;
    std::vector<std::uint16_t> members;
    std::vector<std::uint32_t> counts;  // fragments per pixel
    // Of the pixel at hand: the samples' keys; those met, and each sample's number among them.
    std::vector<FragmentKey> samples, keys;
    std::vector<std::uint16_t> key_of;
};

/// What the pixels' samples see: of pixels that surely are one fragment their key, of the others the keys of
/// all samples.
class FragmentColours::OpenPixels {
  public:
    OpenPixels(Viewer& viewer, const SampleGrid& grid) : grid_(grid), of_pixel_(grid.pixels()) {
        viewer.find_keys_of_pixels(grid, of_pixel_);
        // Where few pixels are known, none is: samples in whole rows are found faster.
        const auto known = static_cast<std::size_t>(
            std::count_if(of_pixel_.begin(), of_pixel_.end(), [](FragmentKey key) { return key != kAlone; }));
        if (2 * known < of_pixel_.size()) std::fill(of_pixel_.begin(), of_pixel_.end(), kAlone);
        const std::vector<Id> chosen = choose_samples();
        keys_.resize(chosen.size());
        if (chosen.empty()) return;
        SampleGrid samples = grid;
        if (chosen.size() < grid.size()) samples.chosen = chosen;
        viewer.find_keys(samples, keys_);
    }

    /// That of all samples; kAlone: it is not known to be one.
    FragmentKey of_pixel(std::size_t pixel) const { return of_pixel_[pixel]; }
    /// The keys of a pixel's samples, in rows.
    void get(std::size_t pixel, std::vector<FragmentKey>& keys) const {
        const std::size_t side = static_cast<std::size_t>(grid_.side);
        const RowOfPixels& row = rows_[pixel / static_cast<std::size_t>(grid_.width())];
        keys.clear();
        for (std::size_t j = 0; j < side; ++j) {
            const FragmentKey* const first = &keys_[row.first + (j * row.open + rank_[pixel]) * side];
            keys.insert(keys.end(), first, first + side);
        }
    }

  private:
    struct RowOfPixels {
        std::size_t first = 0, open = 0;  // of its samples in keys_; open pixels
    };

    /// The samples of open pixels, in rows of the lattice.
    std::vector<Id> choose_samples() {
        const std::size_t width = static_cast<std::size_t>(grid_.width()),
                          side = static_cast<std::size_t>(grid_.side);
        std::vector<Id> chosen;
        rank_.resize(grid_.pixels());
        rows_.resize(static_cast<std::size_t>(grid_.height()));
        for (std::size_t y = 0; y < rows_.size(); ++y) {
            rows_[y].first = chosen.size();
            for (std::size_t p = y * width; p < (y + 1) * width; ++p)
                if (of_pixel_[p] == kAlone) rank_[p] = static_cast<std::uint32_t>(rows_[y].open++);
            for (std::size_t row = y * side; rows_[y].open > 0 && row < (y + 1) * side; ++row)
                for (std::size_t x = 0; x < width; ++x)
                    for (std::size_t i = 0; of_pixel_[y * width + x] == kAlone && i < side; ++i)
                        chosen.push_back(static_cast<Id>(row * grid_.columns() + x * side + i));
        }
        return chosen;
    }

    SampleGrid grid_;
    std::vector<FragmentKey> of_pixel_, keys_;
    std::vector<std::uint32_t> rank_;  // of an open pixel among those of its row
    std::vector<RowOfPixels> rows_;
};

FragmentColours::FragmentColours(const PixelSource& source, const SampleGrid& window)
    : world_(source.world),
      viewer_(source.viewer),
      filter_(source.filter),
      progress_(source.progress),
      progress_shaded_(source.shaded),
      grid_(with_margin(window, source.world.scene.film, source.filter.reach)) {
    const OpenPixels open(viewer_, grid_);
    viewer_.view({grid_.x0, grid_.y0, grid_.x1, grid_.y1, 1}, centres_);
    find_fragments(open);
    shaded_.resize(fragments_.size());
    pixels_per_fragment_ = static_cast<double>(window.pixels()) / static_cast<double>(fragments_.size());
    shade_centres();
    shade_samples();
    count_rays_by_sample();
    for (ShadedFragment& one : shaded_) one.colour = filter_.averaged(one.colour);
}

Vec2 FragmentColours::pixel_corner(std::size_t pixel) const {
    const std::size_t width = static_cast<std::size_t>(grid_.width());
    return {grid_.x0 + static_cast<int>(pixel % width), grid_.y0 + static_cast<int>(pixel / width)};
}

std::size_t FragmentColours::lattice_sample(std::size_t pixel, int inside) const {
    const std::size_t width = static_cast<std::size_t>(grid_.width()),
                      side = static_cast<std::size_t>(grid_.side);
    const std::size_t i = static_cast<std::size_t>(inside) % side,
                      j = static_cast<std::size_t>(inside) / side;
    return (pixel / width * side + j) * grid_.columns() + pixel % width * side + i;
}

/// One fragment per key, in the order in which they are met; a sample that stands alone is one by itself.
/// `row` has their keys.
void FragmentColours::split_pixel(std::size_t pixel, PixelRow& row) const {
    const int side = grid_.side;
    row.keys.clear();
    row.key_of.clear();
    std::size_t last = 0;
    for (int inside = 0; inside < side * side; ++inside) {
        const FragmentKey key = row.samples[static_cast<std::size_t>(inside)];
        if (key == kAlone || row.keys.empty() || key != row.keys[last]) {
            const auto found =
                key == kAlone ? row.keys.end() : std::find(row.keys.begin(), row.keys.end(), key);
            last = static_cast<std::size_t>(found - row.keys.begin());
            if (found == row.keys.end()) row.keys.push_back(key);
        }
        row.key_of.push_back(static_cast<std::uint16_t>(last));
    }
    for (std::size_t k = 0; k < row.keys.size(); ++k) {
        const std::size_t first = row.members.size();
        Vec2 sum(0);
        for (int inside = 0; inside < side * side; ++inside) {
            if (row.key_of[static_cast<std::size_t>(inside)] != k) continue;
            row.members.push_back(static_cast<std::uint16_t>(inside));
            sum += Vec2(inside % side, inside / side);
        }
        const std::span<const std::uint16_t> members = std::span(row.members).subspan(first);
        const Vec2 centroid = sum / static_cast<double>(members.size());
        const auto distance = [&](std::uint16_t inside) {
            const Vec2 off = Vec2(inside % side, inside / side) - centroid;
            return dot(off, off);
        };
        const std::uint16_t nearest =
            *std::min_element(members.begin(), members.end(),
                              [&](std::uint16_t a, std::uint16_t b) { return distance(a) < distance(b); });
        row.fragments.push_back({static_cast<Id>(lattice_sample(pixel, nearest)),
                                 static_cast<std::uint32_t>(first),
                                 static_cast<std::uint32_t>(members.size())});
        if (members.size() == static_cast<std::size_t>(side * side)) {
            row.fragments.back().members = 0;
            row.members.resize(first);
        }
    }
}

void FragmentColours::find_fragments(const OpenPixels& open) {
    const std::size_t width = static_cast<std::size_t>(grid_.width()),
                      height = static_cast<std::size_t>(grid_.height());
    const std::size_t per_pixel = static_cast<std::size_t>(grid_.side * grid_.side);
    std::vector<PixelRow> rows(height);
    parallel_for(height, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t y = from; y < to; ++y) {
            PixelRow& row = rows[y];
            for (std::size_t x = 0; x < width; ++x) {
                const std::size_t before = row.fragments.size(), pixel = y * width + x;
                FragmentKey all = open.of_pixel(pixel);
                if (all == kAlone) {
                    open.get(pixel, row.samples);
                    const bool one = std::all_of(row.samples.begin(), row.samples.end(),
                                                 [&](FragmentKey key) { return key == row.samples[0]; });
                    if (one) all = row.samples[0];
                }
                if (all != kAlone && viewer_.key_of(centres_, centres_.samples[pixel]) == all) {
                    row.fragments.push_back({});
                } else {
                    if (open.of_pixel(pixel) != kAlone) row.samples.assign(per_pixel, all);
                    split_pixel(pixel, row);
                }
                row.counts.push_back(static_cast<std::uint32_t>(row.fragments.size() - before));
            }
        }
    });
    first_.reserve(grid_.pixels() + 1);
    first_.push_back(0);
    for (const PixelRow& row : rows) {
        const auto shift = static_cast<std::uint32_t>(members_.size());
        for (Fragment fragment : row.fragments) {
            fragment.first_member += shift;
            fragments_.push_back(fragment);
        }
        members_.insert(members_.end(), row.members.begin(), row.members.end());
        for (const std::uint32_t count : row.counts) first_.push_back(first_.back() + count);
    }
    counts_.pixels = grid_.pixels();
    counts_.fragments = fragments_.size();
}

/// Fragments that are a whole pixel: where its centre is known to see the same.
void FragmentColours::shade_centres() {
    parallel_for(grid_.pixels(), kFragmentsPerTask, [&](std::size_t from, std::size_t to) {
        std::vector<ShownFragment> shown;
        std::vector<std::size_t> of;
        for (std::size_t p = from; p < to; ++p) {
            if (fragments_[first_[p]].sample != kNone) continue;
            shown.push_back({&centres_.samples[p], pixel_corner(p), {}});
            of.push_back(first_[p]);
        }
        progress_.stop_if_cancelled();
        std::vector<ShadedFragment> shaded(shown.size());
        shade_fragments({world_, viewer_, centres_, grid_.side, progress_.cancel}, shown, shaded);
        for (std::size_t k = 0; k < of.size(); ++k) shaded_[of[k]] = shaded[k];
        progress_shaded_.add(pixels_per_fragment_ * static_cast<double>(of.size()));
    });
}

/// All others: at the samples that stand for them.
void FragmentColours::shade_samples() {
    struct Wanted {
        Id sample;
        std::uint32_t fragment, pixel;
    };
    std::vector<Wanted> wanted;
    for (std::size_t p = 0; p < grid_.pixels(); ++p)
        for (std::size_t f = first_[p]; f < first_[p + 1]; ++f)
            if (fragments_[f].sample != kNone)
                wanted.push_back(
                    {fragments_[f].sample, static_cast<std::uint32_t>(f), static_cast<std::uint32_t>(p)});
    std::sort(wanted.begin(), wanted.end(),
              [](const Wanted& a, const Wanted& b) { return a.sample < b.sample; });

    std::vector<Id> chosen;
    SampleViews views;
    for (std::size_t start = 0; start < wanted.size(); start += kViewsAtOnce) {
        const std::span<const Wanted> now =
            std::span(wanted).subspan(start, std::min(kViewsAtOnce, wanted.size() - start));
        chosen.clear();
        for (const Wanted& one : now) chosen.push_back(one.sample);
        SampleGrid grid = grid_;
        grid.chosen = chosen;
        viewer_.view(grid, views);
        parallel_for(now.size(), kFragmentsPerTask, [&](std::size_t from, std::size_t to) {
            std::vector<ShownFragment> shown;
            for (std::size_t k = from; k < to; ++k)
                shown.push_back(
                    {&views.samples[k], pixel_corner(now[k].pixel), members_of(fragments_[now[k].fragment])});
            progress_.stop_if_cancelled();
            std::vector<ShadedFragment> shaded(shown.size());
            shade_fragments({world_, viewer_, views, grid_.side, progress_.cancel}, shown, shaded);
            for (std::size_t k = from; k < to; ++k) shaded_[now[k].fragment] = shaded[k - from];
            progress_shaded_.add(pixels_per_fragment_ * static_cast<double>(to - from));
        });
    }
}

void FragmentColours::count_rays_by_sample() {
    for (std::size_t p = 0; p < grid_.pixels(); ++p) {
        std::size_t rays = 0;
        for (std::size_t f = first_[p]; f < first_[p + 1]; ++f) rays += shaded_[f].rays_by_sample;
        counts_.by_sample += rays;
        counts_.pixels_by_sample += rays > 0;
    }
}

SampleColour FragmentColours::colour(int x, int y) const {
    const auto weight_at = [&](int pixel, int sample) {
        return filter_.weights[static_cast<std::size_t>((pixel + filter_.reach) * grid_.side + sample)];
    };
    const auto weight_of_pixel = [&](int pixel) {
        double sum = 0;
        for (int i = 0; i < grid_.side; ++i) sum += weight_at(pixel, i);
        return sum;
    };
    SampleColour sum, mean;
    double total = 0;
    for (int py = std::max(grid_.y0, y - filter_.reach); py <= std::min(grid_.y1 - 1, y + filter_.reach);
         ++py)
        for (int px = std::max(grid_.x0, x - filter_.reach); px <= std::min(grid_.x1 - 1, x + filter_.reach);
             ++px) {
            const std::size_t pixel = pixel_at(px, py);
            for (std::size_t f = first_[pixel]; f < first_[pixel + 1]; ++f) {
                double weight = 0;
                if (fragments_[f].members == 0)
                    weight = weight_of_pixel(px - x) * weight_of_pixel(py - y);
                else
                    for (const int inside : members_of(fragments_[f]))
                        weight +=
                            weight_at(px - x, inside % grid_.side) * weight_at(py - y, inside / grid_.side);
                add(sum, weight, shaded_[f].colour);
                total += weight;
            }
        }
    add(mean, 1 / total, sum);
    mean.coverage = std::clamp(mean.coverage, 0.0, 1.0);
    return mean;
}

}  // namespace trilens
