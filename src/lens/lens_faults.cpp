// What bodies a lens' rims cannot bound: sides that cross in glass, and in the air between two lenses.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/description/lens_sag.h"
#include "lens/prescription.h"

namespace trilens {
namespace {

/// The next row behind air that is a lens' front, and how far it is; none where that is tilted, or a mirror
/// comes before it.
struct NextLens {
    std::size_t row = 0;
    double distance = 0;  // against the axis: negative
};

std::optional<NextLens> next_lens(const LensPrescription& lens, const std::vector<LensMedium>& media,
                                  const std::vector<LensPose>& poses, std::size_t from) {
    for (std::size_t j = from + 1; j < lens.rows.size() && !lens.rows[j].mirror; ++j) {
        if (media[j + 1].glass.is_air()) continue;
        const LensPose between = inverse(poses[from]) * poses[j];
        const double distance = between.shift.z;
        if (!is_identity(along_axis(-distance) * between, std::fabs(distance))) return std::nullopt;
        return NextLens{j, distance};
    }
    return std::nullopt;
}

/// Whether the second side comes before the first one somewhere within the rims of both. Sides that touch do
/// not cross.
bool sides_cross(const LensSide& first, const LensSide& second, double distance, double sense) {
    constexpr int kPlaces = 128, kDirections = 32;
    constexpr double kTouch = 1e-9;
    const double rim = std::min(first.aperture, second.aperture);
    const int directions = is_round(first) && is_round(second) ? 0 : kDirections;
    for (int k = 0; k <= directions; ++k) {
        const double turn = std::numbers::pi / 2 * k / kDirections;
        for (int i = 0; i <= kPlaces; ++i) {
            const Vec2 p = rim * i / kPlaces * Vec2(std::cos(turn), std::sin(turn));
            const double air = sense * (distance + sag_over(second, p).z - sag_over(first, p).z);
            if (air < -kTouch * rim) return true;
        }
    }
    return false;
}

std::optional<std::string> fault_of_glass(const LensRow& row, const LensRow& next, double sense) {
    if (!(row.side.aperture > 0 && next.side.aperture > 0)) return std::nullopt;
    const LensSide &front = sense > 0 ? row.side : next.side, &back = sense > 0 ? next.side : row.side;
    const char* fault = lens_fault(front, back, std::fabs(row.thickness));
    if (!fault) return std::nullopt;
    return std::string("from here to the next surface is no lens: ") + fault;
}

}  // namespace

std::vector<LensFault> lens_faults(const LensPrescription& lens) {
    const std::vector<LensMedium> media = lens_media(lens);
    const std::vector<LensPose> poses = lens_poses(lens);
    std::vector<LensFault> faults;
    for (std::size_t i = 0; i + 1 < lens.rows.size(); ++i) {
        const LensRow& row = lens.rows[i];
        if (!media[i + 1].glass.is_air()) {
            const bool is_tilted = !is_identity(row.after) || !is_identity(lens.rows[i + 1].before);
            if (is_tilted) continue;
            if (auto fault = fault_of_glass(row, lens.rows[i + 1], media[i + 1].sense))
                faults.push_back({i, std::move(*fault)});
        } else if (!media[i].glass.is_air() && !row.mirror) {
            const std::optional<NextLens> next = next_lens(lens, media, poses, i);
            if (next && sides_cross(row.side, lens.rows[next->row].side, next->distance, media[i + 1].sense))
                faults.push_back(
                    {i, "the next lens stands in this one: within their rims their sides cross in the air"});
        }
    }
    return faults;
}

}  // namespace trilens
