#include "lens/prescription.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/description/lens_sag.h"
#include "base/util/error.h"

namespace trilens {
namespace {

[[noreturn]] void fail(const LensPrescription& lens, const LensRow& row, const std::string& message) {
    throw InputError(lens.file, row.place, message);
}

}  // namespace

double index_at(const Glass& glass, SpectralLine line) {
    if (line == SpectralLine::kD) return glass.index;
    if (glass.index_c > 0 && glass.index_f > 0)
        return line == SpectralLine::kF ? glass.index_f : glass.index_c;
    if (!(glass.abbe > 0)) return glass.index;
    // The share (n_F - n_d) / (n_F - n_C) on the line through K7 and F2 by Abbe numbers.
    constexpr double kAbbeK7 = 60.41, kShareK7 = 0.6951, kAbbeF2 = 36.37, kShareF2 = 0.7062;
    const double share = kShareK7 + (glass.abbe - kAbbeK7) * (kShareF2 - kShareK7) / (kAbbeF2 - kAbbeK7);
    const double whole = (glass.index - 1) / glass.abbe;
    return glass.index + (line == SpectralLine::kF ? share : share - 1) * whole;
}

namespace {

/// Turns the axis twice as far as to the normal, about what is at right angles to both.
Mat3 bend_towards(const Vec3& normal) {
    const Vec3 axis(0, 0, 1), across = cross(axis, normal);
    const Vec3 about = normalize_or_zero(across);
    if (about == Vec3(0)) return Mat3(1);
    const double once_cos = normal.z, once_sin = length(across);
    const double c = once_cos * once_cos - once_sin * once_sin, s = 2 * once_cos * once_sin;
    Mat3 turn;
    for (int k = 0; k < 3; ++k) {
        const Vec3 e = Mat3(1)[k];
        turn[k] = c * e + s * cross(about, e) + (1 - c) * dot(about, e) * about;
    }
    return turn;
}

}  // namespace

void tilt_row(LensRow& row, const LensTilt& tilt) {
    const LensPose turn = tilted(tilt.degrees), whole = shifted(tilt.decentre) * turn;
    row.before = tilt.behind == AxisBehind::kReverses ? LensPose() : whole;
    row.after = {};
    if (tilt.behind == AxisBehind::kReturns || tilt.behind == AxisBehind::kReverses)
        row.after = inverse(whole);
    if (tilt.behind == AxisBehind::kBends) row.after = inverse(turn) * LensPose{bend_towards(turn.turn[2])};
}

std::vector<LensPose> lens_poses(const LensPrescription& lens) {
    std::vector<LensPose> poses;
    LensPose frame;
    for (const LensRow& row : lens.rows) {
        poses.push_back(frame * row.before);
        frame = poses.back() * row.after * along_axis(row.thickness);
    }
    poses.push_back(frame * lens.image);
    return poses;
}

bool is_centred(const LensPrescription& lens) {
    return is_identity(lens.image) && std::all_of(lens.rows.begin(), lens.rows.end(), [](const LensRow& row) {
               return is_identity(row.before) && is_identity(row.after);
           });
}

bool is_round(const LensPrescription& lens) {
    return std::all_of(lens.rows.begin(), lens.rows.end(),
                       [](const LensRow& row) { return is_round(row.side); });
}

LensPrescription section_of(const LensPrescription& lens, LensSection section) {
    LensPrescription cut = lens;
    for (LensRow& row : cut.rows) row.side = section_of(row.side, section);
    return cut;
}

std::vector<LensMedium> lens_media(const LensPrescription& lens) {
    std::vector<LensMedium> media{LensMedium()};
    for (const LensRow& row : lens.rows) {
        LensMedium behind = media.back();
        if (row.mirror)
            behind.sense = -behind.sense;
        else
            behind.glass = row.glass;
        media.push_back(std::move(behind));
    }
    return media;
}

std::size_t stop_row(const LensPrescription& lens) {
    const auto found =
        std::find_if(lens.rows.begin(), lens.rows.end(), [](const auto& row) { return row.stop; });
    return found == lens.rows.end() ? 0 : static_cast<std::size_t>(found - lens.rows.begin());
}

namespace {

/// Whether its numbers are finite.
bool is_finite(const LensRow& row) {
    bool finite = true;
    for (const double number :
         {row.side.curvature, row.side.conic, row.side.aperture, row.side.across_curvature,
          row.side.across_conic, row.thickness, row.glass.index, row.glass.abbe, row.hole, row.obscuration})
        finite = finite && std::isfinite(number);
    for (const auto* terms : {&row.side.coefficients, &row.side.normal_departures})
        for (const double term : *terms) finite = finite && std::isfinite(term);
    for (const LensPose* pose : {&row.before, &row.after})
        finite = finite && std::isfinite(dot(pose->shift, pose->shift)) &&
                 std::isfinite(glm::determinant(pose->turn));
    return finite;
}

/// What is wrong with a side up to its rim; null: nothing, or it has none.
const char* rim_fault(const LensSide& side) {
    const double r = side.aperture;
    if (!(r > 0)) return nullptr;
    if (!(side_room(side) >= kLeastRimRoom)) return "its aperture reaches to where the side turns back";
    for (const Vec2& p : {Vec2(r, 0), Vec2(0, r)}) {
        const SideSag rim = sag_over(side, p);
        if (!std::isfinite(rim.z) || !std::isfinite(dot(rim.slope, rim.slope)))
            return "its side is not finite";
    }
    return nullptr;
}

/// What is wrong with a row's thickness, in such a medium; empty: nothing.
std::string thickness_fault(const LensRow& row, const LensMedium& behind, bool is_last, bool centred) {
    const bool in_glass = !behind.glass.is_air();
    if (in_glass && is_last) return "is the last surface, and has glass behind it: the lens does not end";
    if (in_glass && row.thickness == 0) return "its glass has no thickness";
    if (in_glass && !(behind.glass.index >= 1)) return "its index is below 1";
    if (!(row.thickness * behind.sense < 0) || is_last || (!in_glass && !centred)) return "";
    return behind.sense > 0 ? "its thickness is negative: surfaces follow each other along the axis"
                            : "its thickness is positive: behind a mirror light runs against the axis";
}

}  // namespace

void check_prescription(const LensPrescription& lens) {
    if (lens.rows.empty()) throw InputError(lens.file, "", "has no surfaces");
    for (const LensRow& row : lens.rows)
        if (!is_finite(row)) fail(lens, row, "a number of the surface is not finite");
    const std::vector<LensMedium> media = lens_media(lens);
    const bool centred = is_centred(lens);
    bool has_stop = false, does_anything = false;
    for (std::size_t i = 0; i < lens.rows.size(); ++i) {
        const LensRow& row = lens.rows[i];
        if (row.stop && has_stop) fail(lens, row, "is a second stop");
        has_stop = has_stop || row.stop;
        does_anything = does_anything || row.mirror || !row.glass.is_air();
        if (!(row.hole >= 0)) fail(lens, row, "the radius of its hole is negative");
        if (row.hole > 0 && row.side.aperture > 0 && row.hole >= row.side.aperture)
            fail(lens, row, "its hole is as large as its aperture");
        if (!(row.obscuration >= 0)) fail(lens, row, "the radius of its obscuration is negative");
        if (row.obscuration > 0 && row.side.aperture > 0 && row.obscuration >= row.side.aperture)
            fail(lens, row, "its obscuration is as large as its aperture");
        if (row.mirror && !row.glass.is_air()) fail(lens, row, "is a mirror, and has a glass of its own");
        const bool is_used = row.mirror || !media[i].glass.is_air() || !media[i + 1].glass.is_air();
        const char* const of_rim = is_used ? rim_fault(row.side) : nullptr;
        if (of_rim) fail(lens, row, of_rim);
        const std::string fault = thickness_fault(row, media[i + 1], i + 1 == lens.rows.size(), centred);
        if (!fault.empty()) fail(lens, row, fault);
    }
    if (!does_anything)
        throw InputError(lens.file, "",
                         "has no glass and no mirror: between its surfaces is nothing but air");
    for (const LensObscuration& shell : lens_obscurations(lens))
        if (const char* fault = lens_fault(shell.shape.front, shell.shape.back, shell.shape.thickness))
            fail(lens, lens.rows[shell.row], std::string("no obscuration can be made of it: ") + fault);
}

namespace {

/// How far a shell stands off the surface: at least a thousandth of its radius, and what its triangles,
/// between kShellSegments / 4 rings of kShellSegments corners, are off it.
double shell_gap(const LensSide& side) {
    constexpr double kLeast = 1e-3;
    if (!(side_room(side) > 0)) return kLeast * side.aperture;  // no shell can be made of it
    const SagBounds most = sag_bounds(side);
    const double ring = side.aperture * 4 / kShellSegments,
                 chord = side.aperture * (1 - std::cos(std::numbers::pi / kShellSegments));
    return std::max(kLeast * side.aperture, most.second * ring * ring / 8 + most.first * chord);
}

}  // namespace

std::vector<LensObscuration> lens_obscurations(const LensPrescription& lens) {
    const std::vector<LensPose> poses = lens_poses(lens);
    const std::vector<LensMedium> media = lens_media(lens);
    std::vector<LensObscuration> shells;
    for (std::size_t i = 0; i < lens.rows.size(); ++i) {
        const LensRow& row = lens.rows[i];
        const bool is_before = media[i].glass.is_air();
        if (!(row.obscuration > 0) || (!is_before && (row.mirror || !media[i + 1].glass.is_air()))) continue;
        const bool below = is_before ? media[i].sense > 0 : media[i + 1].sense < 0;
        LensSide side = row.side;
        side.aperture = row.obscuration;
        const double gap = shell_gap(side);
        shells.push_back({i, poses[i] * along_axis(below ? -2 * gap : gap), {gap, side, side}});
    }
    return shells;
}

double vertex_of(const LensPrescription& lens, std::size_t row) {
    double z = 0;
    for (std::size_t i = 0; i < std::min(row, lens.rows.size()); ++i) z += lens.rows[i].thickness;
    return z;
}

namespace {

/// How thick a mirror is behind what it reflects with, in radii.
constexpr double kMirrorBlank = 0.25;

/// How far it reaches along the axis, or against it (sense -1), from its vertex.
double reach_along(const LensSide& side, double sense) {
    constexpr int kPlaces = 128, kDirections = 32;
    double reach = 0;
    for (int k = 0; k <= (is_round(side) ? 0 : kDirections); ++k) {
        const double turn = std::numbers::pi / 2 * k / kDirections;
        for (int i = 0; i <= kPlaces; ++i) {
            const double r = side.aperture * i / kPlaces;
            reach = std::max(reach, sense * sag_over(side, r * Vec2(std::cos(turn), std::sin(turn))).z);
        }
    }
    return reach;
}

/// A body whose side of that row reflects; light comes along the row's axis, or against it.
LensElement mirror_body(const LensPrescription& lens, std::size_t index, const LensMedium& before) {
    const LensRow& row = lens.rows[index];
    const double reach = reach_along(row.side, before.sense);
    LensSide flat;
    flat.aperture = row.side.aperture;
    LensElement body{
        index, {}, {reach + kMirrorBlank * row.side.aperture, row.side, flat, row.hole}, {}, true};
    if (before.sense > 0) return body;
    std::swap(body.shape.front, body.shape.back);
    body.pose = along_axis(-body.shape.thickness);
    return body;
}

/// The body between a row and the next one. Light may run against the axis.
LensElement glass_body(const LensPrescription& lens, std::size_t index, const LensMedium& medium) {
    const LensRow *front = &lens.rows[index], *back = front + 1;
    const LensPose between = front->after * along_axis(front->thickness) * back->before;
    const LensPose off = along_axis(-front->thickness) * between;
    if (!is_identity(off, std::fabs(front->thickness)))
        fail(lens, *front, "the sides of its glass are tilted against each other: no body is made of it");
    LensElement body{index, {}, {std::fabs(front->thickness), front->side, back->side}, medium};
    if (medium.sense > 0) return body;
    std::swap(body.shape.front, body.shape.back);
    body.pose = between;
    return body;
}

bool have_one_shape(const LensSide& a, const LensSide& b) {
    return a.curvature == b.curvature && a.conic == b.conic && a.coefficients == b.coefficients &&
           a.normal_departures == b.normal_departures && a.form == b.form &&
           a.across_curvature == b.across_curvature && a.across_conic == b.across_conic;
}

/// Fails unless light leaves the glass before a mirror by the side that it came in by: that body is made.
void check_way_back(const LensPrescription& lens, std::size_t mirror) {
    const std::vector<LensPose> poses = lens_poses(lens);
    const LensRow &row = lens.rows[mirror], &behind = lens.rows[mirror + 1];
    const bool is_first = mirror > 0 && !lens.rows[mirror - 1].mirror;
    const double size = std::fabs(row.thickness);
    if (!is_first || behind.mirror || !have_one_shape(behind.side, lens.rows[mirror - 1].side) ||
        !is_identity(inverse(poses[mirror - 1]) * poses[mirror + 1], size))
        fail(lens, row, "light leaves its glass by another side than it came in by: no body is made of it");
}

/// Whether light comes a second time, against the axis, through the glass from row i to the next.
bool is_way_back(const LensPrescription& lens, std::size_t i, const std::vector<LensElement>& bodies) {
    const std::vector<LensPose> poses = lens_poses(lens);
    const double size = std::fabs(lens.rows[i].thickness);
    const auto is_same = [&](std::size_t a, std::size_t b) {
        return have_one_shape(lens.rows[a].side, lens.rows[b].side) &&
               is_identity(inverse(poses[a]) * poses[b], size);
    };
    return std::any_of(bodies.begin(), bodies.end(), [&](const LensElement& body) {
        return !body.is_mirror && is_same(body.first, i + 1) && is_same(body.first + 1, i);
    });
}

}  // namespace

std::vector<LensElement> lens_elements(const LensPrescription& lens) {
    check_prescription(lens);
    const std::vector<LensPose> poses = lens_poses(lens);
    const std::vector<LensMedium> media = lens_media(lens);
    std::vector<LensElement> elements;
    for (std::size_t i = 0; i < lens.rows.size(); ++i) {
        const bool is_mirror = lens.rows[i].mirror, is_glass = !media[i + 1].glass.is_air();
        if (!is_mirror && (!is_glass || is_way_back(lens, i, elements))) continue;
        for (std::size_t k = i; k <= (is_glass ? i + 1 : i); ++k)
            if (!(lens.rows[k].side.aperture > 0))
                fail(lens, lens.rows[k], "has no aperture, so no rim can be made");
        if (is_mirror && is_glass) check_way_back(lens, i);
        LensElement body = is_mirror ? mirror_body(lens, i, media[i]) : glass_body(lens, i, media[i + 1]);
        const LensPrimitive& shape = body.shape;
        if (const char* fault = lens_fault(shape.front, shape.back, shape.thickness, shape.hole))
            fail(
                lens, lens.rows[i],
                (is_mirror ? "no mirror can be made of it: " : "from here to the next surface is no lens: ") +
                    std::string(fault));
        body.pose = poses[i] * body.pose;
        elements.push_back(std::move(body));
    }
    for (const LensFault& fault : lens_faults(lens)) fail(lens, lens.rows[fault.row], fault.what);
    return elements;
}

}  // namespace trilens
