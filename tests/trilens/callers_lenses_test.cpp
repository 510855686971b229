// Lenses that are none, handed to the public functions: errors come of it, and nothing else does.
#include "support/callers_data.h"
#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("lenses of numbers that are none are refused", "[trilens][bad-input]") {
    for (std::size_t term = 0; term < kAsphereTerms; ++term)
        for (const bool along_normal : {false, true}) {
            LensPrescription lens{"odd", "odd", {}};
            lens.rows = {{{0.02, 0, {}, 0}, 4, {"glass", 1.5, 60}}, {{-0.02, 0, {}, 0}, 0}};
            LensSide& side = lens.rows[0].side;
            (along_normal ? side.normal_departures : side.coefficients)[term] = kInfinity;
            CHECK_THROWS_AS(check_prescription(lens), InputError);
        }
    for (const std::string& text : kOddTexts) {
        only_errors("load_lens", [&] { load_lens(text); });
        only_errors("parse_lens_side", [&] { parse_lens_side(text, text); });
        only_errors("find_glass", [&] { find_glass(text, text, text); });
    }
    CHECK(!glass_names().empty());
    only_errors("stop_row", [] { stop_row({}); });
    only_errors("vertex_of", [] { vertex_of({}, 7); });
    only_errors("paraxial_ray", [] { paraxial_ray({}, {1, 1}); });
    only_errors("trace_lens", [] { trace_lens({}, {Vec3(0), Vec3(0)}); });
    for (const double x : kOddNumbers)
        for (int field = 0; field < 14; ++field) {
            LensPrescription lens{"odd", "odd", {}};
            lens.rows = {{{0.02, 0, {}, 10}, 4, {"glass", 1.5, 60}, true}, {{-0.02, 0, {}, 10}}};
            LensRow& row = lens.rows[0];
            const std::array<double*, 12> numbers{&row.side.curvature,
                                                  &row.side.conic,
                                                  &row.side.aperture,
                                                  &row.side.coefficients[1],
                                                  &row.thickness,
                                                  &row.glass.index,
                                                  &row.glass.abbe,
                                                  &row.side.normal_departures[0],
                                                  &row.hole,
                                                  &row.obscuration,
                                                  &row.side.across_curvature,
                                                  &row.side.across_conic};
            row.side.form = field == 11 ? SideForm::kBiconic : SideForm::kRound;
            if (field == 10) row.side.form = SideForm::kToricX;
            if (field == 13) lens.rows[1].mirror = true;
            if (field > 11) tilt_row(row, {Vec3(x), Vec3(x), AxisBehind::kBends});
            only_errors("lens_poses", [&] { lens_poses(lens); });
            only_errors("lens_media", [&] { lens_media(lens); });
            only_errors("is_centred", [&] { is_centred(lens); });
            if (field < 12) *numbers[static_cast<std::size_t>(field)] = x;
            only_errors("check_prescription", [&] { check_prescription(lens); });
            only_errors("is_round", [&] { is_round(lens); });
            only_errors("section_of", [&] { section_of(lens, LensSection::kX); });
            only_errors("imaging_section", [&] { imaging_section(lens); });
            only_errors("lens_obscurations", [&] { lens_obscurations(lens); });
            only_errors("index_at", [&] { index_at(row.glass, SpectralLine::kF); });
            only_errors("lens_faults", [&] { lens_faults(lens); });
            only_errors("lens_elements", [&] { lens_elements(lens); });
            only_errors("first_order", [&] { first_order(lens); });
            only_errors("paraxial_ray", [&] { paraxial_ray(lens, {x, x}); });
            only_errors("seidel_sums", [&] { seidel_sums(lens, {x, x}); });
            only_errors("trace_lens", [&] { trace_lens(lens, {Vec3(x), Vec3(x, 0, 1)}); });
            only_errors("spot_of", [&] { spot_of(lens, {x, x, SpectralLine::kC, 2, x}); });
        }
}
