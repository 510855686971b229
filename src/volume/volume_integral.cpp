#include "volume/volume_integral.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace trilens {
namespace {

constexpr double kDeepest = 40;                // optical depth behind which nothing is seen
constexpr double kLeastTransmittance = 4e-18;  // e^-40

// Abscissas and weights of Gauss and Legendre's rule of 8 points over 0..1.
// Source: Abramowitz and Stegun, Handbook of Mathematical Functions, table 25.4.
constexpr std::array<double, 4> kAbscissa{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                          0.9602898564975363};
constexpr std::array<double, 4> kWeight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                        0.1012285362903763};

/// The sum of media on a stretch.
struct MediaSum {
    std::span<const LinearMedium> media;
    double start = 0, rise = 0;  // of the extinction, per unit of the length: start + rise * u, u in 0..1

    explicit MediaSum(std::span<const LinearMedium> all) : media(all) {
        for (const LinearMedium& one : media) {
            start += one.extinction_start;
            rise += one.extinction_end - one.extinction_start;
        }
    }
    double depth(double u) const { return u * (start + 0.5 * rise * u); }
    /// The u at which depth() has this value, which it reaches.
    double at_depth(double depth) const {
        const double root = std::sqrt(std::max(0.0, start * start + 2 * rise * depth));
        return std::min(1.0, 2 * depth / (start + root));
    }
    Vec3 source(double u) const {
        Vec3 sum(0);
        for (const LinearMedium& one : media)
            sum += (one.extinction_start + u * (one.extinction_end - one.extinction_start)) *
                   (one.color_start + u * (one.color_end - one.color_start));
        return sum;
    }
};

/// Emission of the part from u0 to u1, as seen from u = 0.
Vec3 emission_of_part(const MediaSum& sum, double u0, double u1, double length) {
    const double half = 0.5 * (u1 - u0), middle = 0.5 * (u0 + u1);
    Vec3 total(0);
    for (std::size_t k = 0; k < kAbscissa.size(); ++k)
        for (const double side : {-1.0, 1.0}) {
            const double u = middle + side * half * kAbscissa[k];
            total += kWeight[k] * std::exp(-length * sum.depth(u)) * sum.source(u);
        }
    return half * length * total;
}

/// A linear medium that fills the ray from `from` to `to`.
struct MediumStretch {
    double from = 0, to = 0;
    LinearMedium medium;
};

/// Cuts a stretch where the scalar passes points of the transfer function, and appends the pieces that there
/// is anything of.
void cut_at_points(const ScalarStretch& stretch, const TransferFunction& transfer,
                   std::vector<MediumStretch>& pieces) {
    const double low = std::min(stretch.scalar_from, stretch.scalar_to),
                 high = std::max(stretch.scalar_from, stretch.scalar_to);
    const bool rises = stretch.scalar_to >= stretch.scalar_from;
    const auto by_value = [](const TransferPoint& p, double v) { return p.value < v; };
    const auto first = std::upper_bound(transfer.points.begin(), transfer.points.end(), low,
                                        [](double v, const TransferPoint& p) { return v < p.value; });
    const auto last = std::lower_bound(first, transfer.points.end(), high, by_value);
    const std::ptrdiff_t knots = std::max<std::ptrdiff_t>(0, last - first);
    double from = stretch.from;
    TransferPoint at_from = transfer.at(stretch.scalar_from);
    for (std::ptrdiff_t k = 0; k <= knots; ++k) {
        double to = stretch.to;
        TransferPoint at_to = transfer.at(stretch.scalar_to);
        if (k < knots) {
            at_to = rises ? first[k] : first[knots - 1 - k];
            const double share =
                (at_to.value - stretch.scalar_from) / (stretch.scalar_to - stretch.scalar_from);
            to = std::clamp(stretch.from + share * (stretch.to - stretch.from), from, stretch.to);
        }
        if (to > from && (at_from.extinction > 0 || at_to.extinction > 0))
            pieces.push_back({from, to, {at_from.color, at_to.color, at_from.extinction, at_to.extinction}});
        from = to;
        at_from = at_to;
    }
}

/// The part of a piece from `from` to `to`, which lie in it.
LinearMedium part_of(const MediumStretch& piece, double from, double to) {
    const LinearMedium& m = piece.medium;
    const double size = piece.to - piece.from, u0 = (from - piece.from) / size, u1 = (to - piece.from) / size;
    return {m.color_start + u0 * (m.color_end - m.color_start),
            m.color_start + u1 * (m.color_end - m.color_start),
            m.extinction_start + u0 * (m.extinction_end - m.extinction_start),
            m.extinction_start + u1 * (m.extinction_end - m.extinction_start)};
}

/// Pieces that may overlap, swept from near to far.
VolumeLight sweep(const std::vector<MediumStretch>& pieces) {
    std::vector<double> cuts;
    for (const MediumStretch& piece : pieces) cuts.insert(cuts.end(), {piece.from, piece.to});
    std::sort(cuts.begin(), cuts.end());
    cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
    VolumeLight light;
    std::vector<std::size_t> active;
    std::vector<LinearMedium> media;
    std::size_t next = 0;
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
        const double from = cuts[c], to = cuts[c + 1];
        std::erase_if(active, [&](std::size_t i) { return pieces[i].to <= from; });
        while (next < pieces.size() && pieces[next].from <= from) active.push_back(next++);
        if (active.empty()) continue;
        media.clear();
        for (const std::size_t i : active) media.push_back(part_of(pieces[i], from, to));
        light.put_behind(integrate(media, to - from));
    }
    return light;
}

}  // namespace

VolumeLight integrate(std::span<const LinearMedium> media, double length) {
    const MediaSum sum(media);
    const double depth = length * sum.depth(1);
    VolumeLight light;
    if (!(depth > 0)) return light;
    light.transmittance = std::exp(-depth);
    const double reached = std::min(depth, kDeepest);
    const int parts = static_cast<int>(std::ceil(reached));
    double from = 0;
    for (int k = 1; k <= parts; ++k) {
        const double to = k == parts && reached == depth ? 1.0 : sum.at_depth(reached * k / parts / length);
        light.emission += emission_of_part(sum, from, to, length);
        from = to;
    }
    return light;
}

VolumeLight integrate(std::span<const RayThroughVolume> volumes) {
    std::vector<MediumStretch> pieces;
    for (const RayThroughVolume& volume : volumes)
        for (const ScalarStretch& stretch : volume.stretches)
            cut_at_points(stretch, *volume.transfer, pieces);
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const MediumStretch& a, const MediumStretch& b) { return a.from < b.from; });
    bool overlaps = false;
    for (std::size_t i = 1; i < pieces.size(); ++i) overlaps = overlaps || pieces[i].from < pieces[i - 1].to;
    if (overlaps) return sweep(pieces);
    VolumeLight light;
    for (const MediumStretch& piece : pieces) {
        light.put_behind(integrate({&piece.medium, 1}, piece.to - piece.from));
        if (light.transmittance < kLeastTransmittance) break;
    }
    return light;
}

}  // namespace trilens
