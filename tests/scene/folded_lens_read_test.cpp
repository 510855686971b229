// Lens files with mirrors, tilts and decentres, Q-type aspheres and dispersion formulas: what each program's
// words mean, and that all of them say the same.
#include <cmath>
#include <string>
#include <vector>

#include "lens/sequential_rays.h"
#include "scene/formats/lens_file.h"
#include "scene/read/read_lens.h"
#include "scene/scene_text.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string telescope_text(const std::string& name) {
    return read_required_file(source_dir() + "/scenes/lenses/" + name);
}

std::string lens_refusal(const std::string& text, const std::string& file) {
    try {
        parse_lens(text, file);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// Along which lines rays from all over leave two lenses, and how much that differs at most.
double ray_difference(const LensPrescription& one, const LensPrescription& other) {
    Draw draw(3);
    double worst = 0;
    for (int i = 0; i < 100; ++i) {
        const Vec3 at(draw.uniform(-5, 5), draw.uniform(-5, 5), -100);
        const Ray ray{at, normalize(Vec3(draw.uniform(-0.02, 0.02), draw.uniform(-0.02, 0.02), 1))};
        const auto a = trace_lens(one, ray, SpectralLine::kD, ApertureRule::kAll);
        const auto b = trace_lens(other, ray, SpectralLine::kD, ApertureRule::kAll);
        REQUIRE(a);
        REQUIRE(b);
        worst = std::max(
            {worst, length(cross(a->origin - b->origin, a->direction)), length(a->direction - b->direction)});
    }
    const LensPose a = lens_poses(one).back(), b = lens_poses(other).back();
    return std::max(
        {worst, length(a.shift - b.shift), length(a.turn[0] - b.turn[0]), length(a.turn[2] - b.turn[2])});
}

std::string zemax_break(const char* parameters, double thickness, int number) {
    return "SURF " + std::to_string(number) + "\n TYPE COORDBRK\n" + parameters + " DISZ " +
           std::to_string(thickness) + "\n";
}

const char* const kZemaxStart = "SURF 0\n DISZ INFINITY\n";

}  // namespace

TEST_CASE("a Newtonian's coordinate breaks, a bent axis of CODE V and rows of JSON are the same telescope",
          "[scene][lens]") {
    const LensPrescription zemax = parse_lens(telescope_text("newtonian.zmx"), "newtonian.zmx");
    REQUIRE(zemax.rows.size() == 2);
    CHECK(zemax.rows[0].mirror);
    CHECK(zemax.rows[1].thickness == 120);
    const LensPrescription code_v = parse_lens(
        "RDM\nSO 0 1E13\nS -1000 -380 REFL; STO; K -1; CIR 50\nS 0 120 REFL; ADE -45; BEN; CIR 19\nSI 0 0\n",
        "a.seq");
    const LensPrescription json = parse_lens(R"({"surfaces": [
        {"radius": -1000, "conic": -1, "aperture": 50, "thickness": -380, "mirror": true, "stop": true},
        {"aperture": 19, "thickness": 120, "mirror": true, "tilt": [45, 0, 0], "axisBehind": "bends"}]})",
                                             "a.json");
    CHECK(ray_difference(zemax, code_v) < 1e-10);
    CHECK(ray_difference(zemax, json) < 1e-10);
    CHECK(spot_of(zemax, {}).radius < 1e-10);
    // The image: to the side of the tube, upright to it.
    const LensPose image = lens_poses(zemax).back();
    CHECK(length(image.shift - Vec3(0, -120, -380)) < 1e-12);
    CHECK(length(image.turn[2] - Vec3(0, -1, 0)) < 1e-15);
}

TEST_CASE("the shipped Cassegrain has the focal length of its title, and a hole", "[scene][lens]") {
    const LensPrescription lens = parse_lens(telescope_text("cassegrain.seq"), "cassegrain.seq");
    REQUIRE(lens.rows.size() == 2);
    CHECK(lens.rows[0].hole == 13);
    CHECK(lens.rows[0].side.aperture == 50);
    CHECK(std::fabs(first_order(lens).focal_length - 900) < 1e-9);
    CHECK(std::fabs(first_order(lens).f_number - 9) < 1e-9);
    CHECK(spot_of(lens, {}).radius < 1e-9);
}

TEST_CASE("a plate that is decentred and returned is the one between two breaks, whatever their order",
          "[scene][lens]") {
    const std::string plate = " GLAS N-BK7\n DISZ 8\n DIAM 9\n", end = "SURF 6\n DISZ 0\n";
    const std::string zemax =
        std::string(kZemaxStart) +
        zemax_break(" PARM 1 1.5\n PARM 2 -0.5\n PARM 3 20\n PARM 4 -7\n PARM 5 30\n", 0, 1) + "SURF 2\n" +
        plate + "SURF 3\n DIAM 9\n DISZ 0\n" + zemax_break("", -8, 4) +
        zemax_break(" PARM 1 -1.5\n PARM 2 0.5\n PARM 3 -20\n PARM 4 7\n PARM 5 -30\n PARM 6 1\n", 50, 5) +
        end;
    const LensPrescription by_breaks = parse_lens(zemax, "a.zmx");
    REQUIRE(by_breaks.rows.size() == 2);
    CHECK(by_breaks.rows[1].thickness == 42);
    const LensPrescription by_reverse = parse_lens(
        "RDM\nSO 0 1E13\nS 0 8 NBK7\n XDE 1.5; YDE -0.5; ADE -20; BDE 7; CDE 30; CIR 9\nS 0 0; CIR 9\n"
        "S 0 -8\nS 0 50; XDE 1.5; YDE -0.5; ADE -20; BDE 7; CDE 30; REV\nSI 0 0\n",
        "a.seq");
    const LensPrescription json = parse_lens(R"({"surfaces": [
        {"glass": "N-BK7", "thickness": 8, "aperture": 9, "decentre": [1.5, -0.5, 0], "tilt": [20, -7, 30]},
        {"aperture": 9, "thickness": -8},
        {"thickness": 50, "decentre": [1.5, -0.5, 0], "tilt": [20, -7, 30], "axisBehind": "reverses"}]})",
                                             "a.json");
    CHECK(ray_difference(by_breaks, by_reverse) < 1e-10);
    CHECK(ray_difference(by_breaks, json) < 1e-10);
    // The breaks undo each other.
    const LensPose image = lens_poses(by_breaks).back();
    CHECK(length(image.shift - Vec3(0, 0, 50)) < 1e-13);
    CHECK(length(image.turn[0] - Vec3(1, 0, 0)) < 1e-15);
    CHECK(lens_elements(by_breaks).size() == 1);
}

TEST_CASE("a decentred mirror whose axis returns leaves the next surface where it was", "[scene][lens]") {
    const LensPrescription lens =
        parse_lens("RDM\nSO 0 1E13\nS 0 -30 REFL; YDE 2; ADE 10; DAR\nS -100 0 REFL\nSI 0 0\n", "a.seq");
    const auto poses = lens_poses(lens);
    CHECK(length(poses[0].shift - Vec3(0, 2, 0)) < 1e-15);
    // A left-handed turn about x: the normal leans to +y.
    CHECK(poses[0].turn[2].y > 0.17);
    CHECK(length(poses[1].shift - Vec3(0, 0, -30)) < 1e-14);
    CHECK(length(poses[1].turn[2] - Vec3(0, 0, 1)) < 1e-15);
}

TEST_CASE("the image's tilts and decentres stand behind it in CODE V, before it in Zemax", "[scene][lens]") {
    const std::string lens = "RDM\nSO 0 1E13\nS 50 4 NBK7\nS 0 30\nSI 0 0; CIR 5\n";
    const LensPrescription code_v =
        parse_lens(lens + " XDE -1; YDE 2\n ADE 10; BDE -5; CDE 3\nGO\n", "a.seq");
    CHECK(code_v.image.shift == Vec3(-1, 2, 0));
    CHECK(code_v.image.turn[2].y > 0.17);
    const LensPrescription zemax = parse_lens(
        std::string(kZemaxStart) + "SURF 1\n CURV 0.02\n DISZ 4\n GLAS N-BK7\nSURF 2\n DISZ 30\n" +
            zemax_break(" PARM 1 -1\n PARM 2 2\n PARM 3 -10\n PARM 4 5\n PARM 5 3\n", 0, 3) + "SURF 4\n",
        "a.zmx");
    CHECK(ray_difference(code_v, zemax) < 1e-13);
    CHECK(is_centred(parse_lens(lens, "a.seq")));
    CHECK(lens_refusal(lens + "ADE 10; BEN\n", "a.seq") ==
          "a.seq: line 6: BEN of a surface that is no mirror");
    CHECK(lens_refusal(lens + "XOD 3\n", "a.seq").starts_with("a.seq: line 6: XOD: "));
}

TEST_CASE("one glass of a catalogue that has no index is refused where a lens asks for it", "[scene][lens]") {
    const std::vector<Glass> glasses = parse_agf(
        "NM GERMANIUM 2 0 0 0 0\nCD 8.28156 0 6.7288 0.44105 0.21307 3870.1\nNM Mine 13 0 1.5 60\n"
        "NM EMPTY 2 0 0 0 0\nNM X 9 0 0.5 1\n",
        "a.agf");
    REQUIRE(glasses.size() == 4);
    const auto with = [&](const std::string& name) {
        return "SURF 0\n DISZ INFINITY\nSURF 1\n CURV 0.02\n DISZ 4\n GLAS " + name +
               "\nSURF 2\n DISZ 9\nSURF 3\n DISZ 0\n";
    };
    const auto refused = [&](const std::string& text, const std::string& file) -> std::string {
        try {
            parse_lens(text, file, glasses);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(parse_lens(with("Mine"), "a.zmx", glasses).rows[0].glass.index == 1.5);
    CHECK(parse_lens(with("mine"), "a.zmx", glasses).rows[0].glass.abbe == 60);
    CHECK(parse_lens(R"({"surfaces": [{"radius": 50, "thickness": 4, "glass": "Mine"}, {}]})", "a.json",
                     glasses)
              .rows[0]
              .glass.index == 1.5);
    CHECK(refused(with("GERMANIUM"), "a.zmx") ==
          "a.zmx: line 6: a.agf: line 2: the glass GERMANIUM has no "
          "index from 1 to 10 at a visible line");
    CHECK(refused("RDM\nSO 0 1E13\nS 50 4 GERMANIUM\nS 0 9\nSI 0 0\n", "a.seq")
              .starts_with("a.seq: line 3: a.agf: line 2: the glass GERMANIUM"));
    CHECK(refused(with("EMPTY"), "a.zmx") ==
          "a.zmx: line 6: a.agf: line 4: the glass EMPTY has no coefficients (CD)");
    CHECK(refused(with("X"), "a.zmx") ==
          "a.zmx: line 6: a.agf: line 5: the glass X has no index at d above 1 and up to 10");

    // A placeholder instead of an index, and a formula that is asked beyond what was measured; N-BK7's own
    // coefficients.
    const auto with_range = [](const std::string& range) {
        return parse_agf(
            "NM GE 9 0 1.0 0.0\nNM BK7 2 0 1.5168 64.17\nCD 1.03961212 0.00600069867 0.231792344 "
            "0.0200179144 1.01046945 103.560653\nLD " +
                range + "\n",
            "a.agf");
    };
    CHECK(with_range("0.3 2.5")[0].fault ==
          "a.agf: line 1: the glass GE has no index at d above 1 and up to 10");
    CHECK(with_range("0.4861 0.6563")[1].fault.empty());
    CHECK(with_range("0 0")[1].fault.empty());
    CHECK(with_range("0.55 18")[1].fault ==
          "a.agf: line 4: the glass BK7 has an index from 0.55 to 18 micrometres, not at F, d and C");
    CHECK(with_range("0.3 0.6")[1].fault.ends_with("from 0.3 to 0.6 micrometres, not at F, d and C"));
}

TEST_CASE("glasses are read from catalogues and private tables, before those that are built in",
          "[scene][lens]") {
    const std::string agf =
        "CC a catalogue\nNM N-BK7 2 517642.251 1.5168 64.17 0 1\nED 7.1 8.3 2.51 0 0\n"
        "CD 1.03961212E+000 6.00069867E-003 2.31792344E-001 2.00179144E-002 1.01046945E+000 "
        "1.03560653E+002 0 0\nLD 0.3 2.5\nNM PLASTIC 13 492574 1.4918 57.4 0\nCD 1 2 3 4\n"
        "NM OLD 1 0 0 0 0\nCD 2.2718929 -1.0108077e-2 1.0592509e-2 2.0816965e-4 -7.6472538e-6 "
        "4.9240991e-7\n";
    const std::vector<Glass> glasses = parse_agf(agf, "a.agf");
    REQUIRE(glasses.size() == 3);
    CHECK(std::fabs(glasses[0].index_f - 1.52238) < 5e-6);
    CHECK(glasses[1].abbe == 57.4);
    CHECK(glasses[1].index_f == 0);
    CHECK(glasses[2].name == "OLD");
    const std::string text =
        "SURF 0\n DISZ INFINITY\nSURF 1\n CURV 0.02\n DISZ 4\n GLAS PLASTIC\nSURF 2\n DISZ 9\n"
        "SURF 3\n DISZ 0\n";
    CHECK(parse_lens(text, "a.zmx", glasses).rows[0].glass.index == 1.4918);
    CHECK(lens_refusal(text, "a.zmx").starts_with("a.zmx: line 6: unknown glass 'PLASTIC'"));

    const LensPrescription lens = parse_lens(
        "PRV\nPWL 656.3 587.6 486.1\n'MY_GLASS' 1.60 1.605 1.615\nEND\nRDM\nSO 0 1E13\nS 50 4 'MY_GLASS'\nS "
        "0 9\nSI 0 0\n",
        "a.seq");
    CHECK(index_at(lens.rows[0].glass, SpectralLine::kC) == 1.6);
    CHECK(std::fabs(lens.rows[0].glass.abbe - 0.605 / 0.015) < 1e-12);
    const LensPrescription json = parse_lens(R"({"surfaces": [{"radius": 50, "thickness": 4,
        "sellmeier": [1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653]}, {}]})",
                                             "a.json");
    CHECK(std::fabs(json.rows[0].glass.index - 1.5168) < 5e-6);
}

TEST_CASE("Q-type aspheres of JSON are normalised by their own radius, or by the aperture", "[scene][lens]") {
    const auto side = [](const std::string& keys) {
        return parse_lens(R"({"surfaces": [{"ior": 1.5, "thickness": 3, )" + keys + "}, {}]}", "a.json")
            .rows[0]
            .side;
    };
    const LensSide by_aperture = side(R"("aperture": 5, "qcon": [0.1, 0.02])");
    CHECK(std::fabs(sag_at(by_aperture, 25).z - 0.12) < 1e-14);
    CHECK(std::fabs(sag_at(side(R"("aperture": 4, "normalizationRadius": 5, "qcon": [0.1])"), 16).z -
                    0.1 * 0.4096) < 1e-15);
    const LensSide mild = side(R"("radius": 20, "aperture": 5, "qbfs": [0.1])");
    CHECK(std::fabs(sag_at(mild, 25).z - sag_at(side(R"("radius": 20, "aperture": 5)"), 25).z) < 1e-15);
    CHECK(departs_along_normal(mild));
    const LensSide alone = parse_lens_side(R"({"radius": 20, "aperture": 5, "qbfs": [0.1]})");
    CHECK(alone.normal_departures == mild.normal_departures);
    CHECK_THROWS_WITH(parse_lens_side(R"({"aperture": 5, "conic": -1, "qbfs": [1]})", "front"),
                      "front: /qbfs: departs from a sphere: the side's conic must be 0");
    CHECK_THROWS_WITH(
        load_text(R"({"version": 1, "film": {"width": 8, "height": 8},
        "cameras": [{"yfov": 40, "lookAt": {"eye": [0, 0, 4], "at": [0, 0, 0]}}],
        "materials": [{"name": "glass", "transmissionFactor": 1}],
        "meshes": [{"name": "lens", "role": "optic", "material": "glass", "primitive": {"type": "lens", "thickness": 0.5,
            "front": {"radius": 3, "conic": -1, "aperture": 1, "qbfs": [0.01]}, "back": {"aperture": 1}}}]})"),
        ContainsSubstring(
            ": /meshes/0/primitive/front/qbfs: departs from a sphere: the side's conic must be 0"));
}

TEST_CASE("a scene has a telescope's mirrors as bodies of chrome, and says which holes it leaves out",
          "[scene][lens]") {
    const Scene scene =
        load_text(R"({"version": 1, "cameras": [{"lookAt": {"eye": [0, 0, -9], "at": [0, 0, 0]}}],
        "lenses": [{"name": "t", "surfaces": [
            {"radius": -60, "conic": -1, "aperture": 5, "thickness": -20, "mirror": true, "hole": 1, "stop": true},
            {"aperture": 2, "thickness": 10, "mirror": true, "tilt": [45, 0, 0], "axisBehind": "bends"},
            {"radius": 9, "aperture": 1, "hole": 0.5, "thickness": 1, "glass": "N-BK7"}, {"aperture": 1}]}]})");
    REQUIRE(scene.meshes.size() == 3);
    CHECK(scene.materials[scene.meshes[0].material].name == "t/mirror");
    const auto& primary = std::get<LensPrimitive>(scene.meshes[0].primitive->kind);
    CHECK(primary.hole == 1);
    CHECK(primary.thickness == 1.25);
    const Primitive& flat = *scene.meshes[1].primitive;
    CHECK(length(flat.axis - normalize(Vec3(0, -1, 1))) < 1e-15);
    // Light comes against its axis: what reflects is its back, and lies at the vertex.
    CHECK(length(flat.center + std::get<LensPrimitive>(flat.kind).thickness * flat.axis - Vec3(0, 0, -20)) <
          1e-14);
    CHECK(length(scene.meshes[2].primitive->center - Vec3(0, -10, -20)) < 1e-13);
    REQUIRE(scene.warnings.size() == 1);
    CHECK(scene.warnings[0] ==
          "room.json: /lenses/0/surfaces/2: its hole is not drawn: only mirrors have holes");
}

TEST_CASE("a side that goes on beyond the radius of its Q-type terms is warned of, with its place",
          "[scene][lens]") {
    const auto lens = [](const std::string& terms) {
        return load_text(R"({"version": 1, "cameras": [{"lookAt": {"eye": [0, 0, -90], "at": [0, 0, 0]}}],
        "lenses": [{"name": "t", "surfaces": [{"radius": 60, "aperture": 5, "thickness": 3, "glass": "N-BK7", )" +
                         terms + R"(}, {"aperture": 5}]}]})")
            .warnings;
    };
    const std::string what =
        ": its aperture is larger than the normalization radius of its Q-type terms, which say nothing there";
    for (const std::string kind : {"qbfs", "qcon"}) {
        const std::string terms = "\"" + kind + "\": [0.01], \"normalizationRadius\": ";
        CHECK(lens(terms + "4.9") == std::vector{"room.json: /lenses/0/surfaces/0" + what});
        CHECK(lens(terms + "5").empty());
        // In another unit.
        const auto primitive = [&](const std::string& radius) {
            return load_text(R"({"version": 1, "cameras": [{"lookAt": {"eye": [0, 0, -90], "at": [0, 0, 0]}}],
            "materials": [{"name": "glass", "transmissionFactor": 1, "ior": 1.5}],
            "meshes": [{"name": "lens", "role": "optic", "material": "glass", "transform": {"scale": [3, 3, 3]},
            "primitive": {"type": "lens", "thickness": 3, "front": {"aperture": 5},
                          "back": {"aperture": 5, )" +
                             terms + radius + "}}}]}")
                .warnings;
        };
        CHECK(primitive("4.9") == std::vector{"room.json: /meshes/0/primitive/back" + what});
        CHECK(primitive("5").empty());
    }
    CHECK(lens("\"qbfs\": [0.01]").empty());
    const auto reaches = [](const std::string& text, const std::string& file) {
        return outreaches_terms(parse_lens(text, file).rows[0].side);
    };
    for (const std::string kind : {"QBF", "QCN"}) {
        const std::string words = "RDM\nSO 0 1E13\nS 60 3 NBK7\nCIR 5\nSPS " + kind + "; SCO C1 ";
        CHECK(reaches(words + "4.9; SCO C3 0.01\nS 0 9\nSI 0 0\n", "a.seq"));
        CHECK_FALSE(reaches(words + "5; SCO C3 0.01\nS 0 9\nSI 0 0\n", "a.seq"));
    }
    for (const std::string kind : {"0", "1"}) {
        const auto zemax = [&](const std::string& radius) {
            return kZemaxStart + std::string("SURF 1\n TYPE QED_TYPE\n CURV 0.02\n XDAT 1 ") + kind +
                   "\n XDAT 2 1\n XDAT 3 " + radius +
                   "\n XDAT 4 0.01\n GLAS N-BK7\n DISZ 3\n DIAM 5\nSURF 2\n DIAM 5\nSURF 3\n";
        };
        CHECK(reaches(zemax("4.9"), "a.zmx"));
        CHECK_FALSE(reaches(zemax("5"), "a.zmx"));
    }
}

TEST_CASE("words of lens files that cannot be followed are refused with their line",
          "[scene][lens][bad-input]") {
    const auto code_v = [](const std::string& words) {
        return lens_refusal("RDM\nSO 0 1E13\nS -100 -50 REFL\n" + words + "\nSI 0 0\n", "a.seq");
    };
    CHECK(code_v("ADE 10; BEN").empty());
    CHECK(code_v("ADE 10\nBDE 3\nBEN") == "a.seq: line 6: BEN is read with one of ADE and BDE alone");
    CHECK(code_v("S 0 1\nADE 10; BEN") == "a.seq: line 5: BEN of a surface that is no mirror");
    CHECK(code_v("XDE 1..2") == "a.seq: line 4: XDE needs a number, not \"1..2\"");
    CHECK(
        code_v("GRT") ==
        "a.seq: line 4: GRT: conicoids, even aspheres, cylinders (CYL), toric (YTO, XTO), biconic (AAS) and "
        "Q-type (SPS QBF, SPS QCN) surfaces are read");
    CHECK(code_v("CIR ROT 2") ==
          "a.seq: line 4: CIR ROT: rims (CIR, CLR, EDG), holes (HOL) and obscurations (OBS) are read");
    CHECK(code_v("CIR 9; CIR OBS 9") == "a.seq: line 3: its obscuration is as large as its aperture");
    CHECK(code_v("CIR Z2 5").starts_with("a.seq: line 4: CIR Z2: "));
    CHECK(code_v("CIR -5") == "a.seq: line 4: CIR is negative");
    CHECK(code_v("CIR EDG 9; CIR CLR 8; CIR HOL 2").empty());
    for (const std::string word :
         {"CIR S1 5", "CIR S1 HOL 5", "ADE S1 10", "STO S1", "GLA S1 NBK7", "K S1 -1", "THI S1..2 3",
          "RDY SI 9", "DAR S1", "CYL S1", "SPS S1 QBF", "SCO S1 C3 1", "CUY S'MAIN' 0.1", "RMD SA REFL"}) {
        CAPTURE(word);
        const std::string message = ": " + word.substr(0, word.find(' ', word.find(' ') + 1)) +
                                    ": commands of a surface are read behind it, without its name";
        CHECK(code_v(word) == "a.seq: line 4" + message);
        CHECK(code_v("SI 0 0\n" + word) == "a.seq: line 5" + message);
    }
    CHECK(code_v("SI 0 0\nGRT S1").starts_with("a.seq: line 5: GRT: "));
    CHECK(code_v("THC S1 0; COM S1 main").empty());
    CHECK(lens_refusal("RDM\nSO 0 1E13\nADE 0; YDE 2\nS -100 -50 REFL\nSI 0 0\n", "a.seq") ==
          "a.seq: line 3: the object (SO) is tilted or decentred: that is not read");
    CHECK(code_v("CIR HOL") == "a.seq: line 4: CIR needs a number, not \"HOL\"");
    const auto prv = [](const std::string& table) {
        return lens_refusal("PRV\n" + table + "\nEND\nRDM\nSO 0 1E13\nS 50 4 'G'\nS 0 9\nSI 0 0\n", "a.seq");
    };
    CHECK(prv("PWL 656.3 587.6 486.1\n'G' 1.5 1.51") == "a.seq: line 3: has 2 indices for 3 wavelengths");
    CHECK(prv("'G' 1.5") == "a.seq: line 2: a private glass before its wavelengths (PWL)");
    CHECK(prv("PWL 1064 1550\n'G' 1.5 1.49") ==
          "a.seq: line 3: the line d is not among the wavelengths (PWL)");
    CHECK(prv("PWL 656.3 587.6 486.1\n'G' 1.52 1.51 1.5") ==
          "a.seq: line 3: the index of the glass G does not fall from blue to red");
    const auto agf = [](const std::string& text) {
        try {
            parse_agf(text, "a.agf");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(agf("CC\n") == "a.agf: has no line NM: it is no catalogue of glasses");
    CHECK(parse_agf("\xef\xbb\xbfNM X 9 0 1.5 60\n", "a.agf").front().name == "X");
    CHECK(agf("NM\n") == "a.agf: line 1: NM needs a name");
    CHECK(agf("NM X 2\nCD 1 2 3\n") == "a.agf: line 2: CD needs a number");
    CHECK(agf("NM X 9 0 0.5 1\n").empty());
    CHECK(agf("CD 1 2 3\n") == "a.agf: line 1: coefficients before a glass (NM)");
    const auto json = [](const std::string& row) {
        return lens_refusal(R"({"surfaces": [{"radius": -9, "thickness": 1, "ior": 1.5}, )" + row + "]}",
                            "a.json");
    };
    CHECK(json(R"({"axisBehind": "bends"})") == "a.json: /surfaces/1/axisBehind: bends behind mirrors alone");
    CHECK(json(R"({"mirror": true, "ior": 1.5})").find("'ior' is no key of a mirror") != std::string::npos);
    CHECK(json(R"({"qbfs": [1]})") == "a.json: /surfaces/1/qbfs: needs an aperture or a normalizationRadius");
    CHECK(json(R"({"aperture": 1, "conic": -1, "qbfs": [1]})") ==
          "a.json: /surfaces/1/qbfs: departs from a sphere: the side's conic must be 0");
    CHECK(json(R"({"sellmeier": [1, 2, 3]})").starts_with("a.json: /surfaces/1/sellmeier: "));
    CHECK(json(R"({"qcon": [1, 2, 3, 4, 5, 6, 7, 8], "aperture": 1})")
              .starts_with("a.json: /surfaces/1/qcon: "));
}
