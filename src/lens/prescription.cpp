#include "lens/prescription.h"

#include <algorithm>
#include <cmath>

#include "base/util/error.h"

namespace trilens {
namespace {

[[noreturn]] void fail(const LensPrescription& lens, const LensRow& row, const std::string& message) {
    throw InputError(lens.file, row.place, message);
}

}  // namespace

double index_at(const Glass& glass, SpectralLine line) {
    if (line == SpectralLine::kD || !(glass.abbe > 0)) return glass.index;
    const double half = (glass.index - 1) / (2 * glass.abbe);
    return glass.index + (line == SpectralLine::kF ? half : -half);
}

std::size_t stop_row(const LensPrescription& lens) {
    const auto found =
        std::find_if(lens.rows.begin(), lens.rows.end(), [](const auto& row) { return row.stop; });
    return found == lens.rows.end() ? 0 : static_cast<std::size_t>(found - lens.rows.begin());
}

void check_prescription(const LensPrescription& lens) {
    if (lens.rows.empty()) throw InputError(lens.file, "", "has no surfaces");
    bool has_stop = false, has_glass = false;
    for (std::size_t i = 0; i < lens.rows.size(); ++i) {
        const LensRow& row = lens.rows[i];
        const bool is_last = i + 1 == lens.rows.size();
        for (const double number : {row.side.curvature, row.side.conic, row.side.aperture, row.thickness,
                                    row.glass.index, row.glass.abbe})
            if (!std::isfinite(number)) fail(lens, row, "a number of the surface is not finite");
        if (row.stop && has_stop) fail(lens, row, "is a second stop");
        has_stop = has_stop || row.stop;
        has_glass = has_glass || !row.glass.is_air();
        if (row.thickness < 0 && !is_last)
            fail(lens, row, "its thickness is negative: surfaces follow each other along the axis");
        if (row.glass.is_air()) continue;
        if (is_last) fail(lens, row, "is the last surface, and has glass behind it: the lens does not end");
        if (!(row.thickness > 0)) fail(lens, row, "its glass has no thickness");
        if (!(row.glass.index >= 1)) fail(lens, row, "its index is below 1");
    }
    if (!has_glass)
        throw InputError(lens.file, "", "has no glass: between no two surfaces is anything but air");
}

double vertex_of(const LensPrescription& lens, std::size_t row) {
    double z = 0;
    for (std::size_t i = 0; i < std::min(row, lens.rows.size()); ++i) z += lens.rows[i].thickness;
    return z;
}

std::vector<LensElement> lens_elements(const LensPrescription& lens) {
    check_prescription(lens);
    std::vector<LensElement> elements;
    for (std::size_t i = 0; i + 1 < lens.rows.size(); ++i) {
        const LensRow &front = lens.rows[i], &back = lens.rows[i + 1];
        if (front.glass.is_air()) continue;
        for (const LensRow* row : {&front, &back})
            if (!(row->side.aperture > 0)) fail(lens, *row, "has no aperture, so no rim can be made");
        if (const char* fault = lens_fault(front.side, back.side, front.thickness))
            fail(lens, front, std::string("from here to the next surface is no lens: ") + fault);
        elements.push_back({i, vertex_of(lens, i), {front.thickness, front.side, back.side}, front.glass});
    }
    return elements;
}

}  // namespace trilens
