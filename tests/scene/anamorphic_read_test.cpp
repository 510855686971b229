// Biconic, toric, Q-type and obscured surfaces of lens files and of JSON.
#include <cmath>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "lens/q_asphere.h"
#include "lens/sequential_rays.h"
#include "scene/formats/lens_file.h"
#include "scene/read/read_lens.h"
#include "scene/scene_text.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

LensPrescription zemax(const std::string& type, const std::string& lines) {
    return parse_lens("MODE SEQ\nSURF 0\n  DISZ INFINITY\nSURF 1\n  TYPE " + type +
                          "\n  CURV 0.02\n  CONI -0.5\n" + lines +
                          "  DISZ 4\n  GLAS N-BK7\n  DIAM 8\nSURF 2\n  DISZ 0\n  DIAM 8\nSURF 3\n",
                      "a.zmx");
}

LensPrescription code_v(const std::string& words) {
    return parse_lens("RDM\nSO 0 1E13\nS 50 4 NBK7\n" + words + "\nS 0 9\nSI 0 0\n", "a.seq");
}

template <typename Read>
std::string refusal_of(const Read& read) {
    try {
        read();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("biconics and toroids of Zemax files have their radii and terms", "[scene][lens]") {
    const LensSide biconic = zemax("BICONICX", "  PARM 1 80\n  PARM 2 1.5\n").rows[0].side;
    CHECK(biconic.form == SideForm::kBiconic);
    CHECK(biconic.curvature == 0.02);
    CHECK(biconic.conic == -0.5);
    CHECK(biconic.across_curvature == 1.0 / 80);
    CHECK(biconic.across_conic == 1.5);
    // A radius of 0 is a flat section.
    CHECK(zemax("BICONICX", "  PARM 1 0\n").rows[0].side.across_curvature == 0);
    const LensSide toroid =
        zemax("TOROIDAL", "  PARM 1 -60\n  PARM 2 1e-3\n  PARM 3 2e-5\n  PARM 8 1e-18\n  XDAT 1 0 0 0\n")
            .rows[0]
            .side;
    CHECK(toroid.form == SideForm::kToricY);
    CHECK(toroid.across_curvature == -1.0 / 60);
    CHECK(toroid.coefficients == std::array{1e-3, 2e-5, 0.0, 0.0, 0.0, 0.0, 1e-18, 0.0});
    CHECK(refusal_of([] { zemax("BICONICX", "  PARM 3 1\n"); }) ==
          "a.zmx: line 8: PARM 3 is not read of surfaces of type BICONICX");
    CHECK(refusal_of([] { zemax("TOROIDAL", "  PARM 9 1\n"); }) ==
          "a.zmx: line 8: PARM 9 is not read of surfaces of type TOROIDAL");
    CHECK(refusal_of([] { zemax("TOROIDAL", "  PARM 1.5 33\n"); }) ==
          "a.zmx: line 8: PARM 1.5 is not read of surfaces of type TOROIDAL");
    CHECK(refusal_of([] { zemax("BICONICX", "  PARM 0 33\n"); }) ==
          "a.zmx: line 8: PARM 0 is not read of surfaces of type BICONICX");
    CHECK(refusal_of([] { zemax("TOROIDAL", "  PARM 2 1e-3\n  PARM 2 1e-3\n"); }) ==
          "a.zmx: line 9: PARM 2: the surface has it already, in line 8");
    CHECK(refusal_of([] { zemax("TOROIDAL", "  XDAT 1 4 0 0\n"); }) ==
          "a.zmx: line 8: XDAT 1 is not read of surfaces of type TOROIDAL");
}

TEST_CASE("Q-type aspheres of Zemax files are those of the polynomials", "[scene][lens]") {
    const std::string extra = "  XDAT 2 3 0 0\n  XDAT 3 9 0 0\n  XDAT 4 0.02 0 0\n  XDAT 6 -0.01 0 0\n";
    const std::vector<double> terms{0.02, 0, -0.01};
    const LensSide strong = zemax("QED_TYPE", "  XDAT 1 1 0 0\n" + extra).rows[0].side;
    CHECK(strong.coefficients == qcon_coefficients(terms, 9));
    CHECK(strong.conic == -0.5);
    const LensSide mild = zemax("QED_TYPE", "  XDAT 1 0 0 0\n" + extra + "  CONI 0\n").rows[0].side;
    CHECK(mild.normal_departures == qbfs_departures(terms, 9));
    CHECK(is_conicoid(zemax("QED_TYPE", "").rows[0].side));
    const auto refused = [&](const std::string& lines) {
        return refusal_of([&] { zemax("QED_TYPE", lines); });
    };
    CHECK(refused("  XDAT 1 0 0 0\n" + extra) ==
          "a.zmx: line 5: a Q-type asphere of the kind Qbfs departs from a sphere: CONI must be 0");
    CHECK(refused("  XDAT 1 2 0 0\n").find("neither 0, Qbfs, nor 1, Qcon") != std::string::npos);
    CHECK(refused("  XDAT 1 1 0 0\n  XDAT 2 1 0 0\n").find("without a normalization radius") !=
          std::string::npos);
    CHECK(refused("  XDAT 1 1 0 0\n  XDAT 2 1.5 0 0\n").find("no whole number") != std::string::npos);
    CHECK(refused("  XDAT 1 1 0 0\n  XDAT 2 9 0 0\n  XDAT 3 9 0 0\n  XDAT 11 1e-3 0 0\n") ==
          "a.zmx: line 11: XDAT 11 is beyond r^16");
    const std::string kind = "  XDAT 1 1 0 0\n";
    for (const std::string index : {"4.5", "0", "-1", "2.5"}) {
        CAPTURE(index);
        CHECK(refused(kind + extra + "  XDAT " + index + " 1e-3 0 0\n") ==
              "a.zmx: line 13: XDAT " + index + " is not read of surfaces of type QED_TYPE");
    }
    CHECK(refused(kind + extra + "  XDAT 7 1e-3 0 0\n") ==
          "a.zmx: line 13: XDAT 7 is beyond the number of terms (XDAT 2)");
    CHECK(refused(kind + extra + "  XDAT 7 0 0 0\n").empty());
    CHECK(refused(kind + extra + "  XDAT 6 1e-3 0 0\n") ==
          "a.zmx: line 13: XDAT 6: the surface has it already, in line 12");
    CHECK(refused(kind + extra + "  PARM 1 1e-3\n") ==
          "a.zmx: line 13: PARM 1 is not read of surfaces of type QED_TYPE");
}

TEST_CASE("toric and anamorphic surfaces of CODE V have their radii and terms", "[scene][lens]") {
    const LensSide along_y = code_v("YTO; RDX 80; K -0.5; A 1e-6").rows[0].side;
    CHECK(along_y.form == SideForm::kToricY);
    CHECK(along_y.curvature == 1.0 / 50);
    CHECK(along_y.across_curvature == 1.0 / 80);
    CHECK(along_y.conic == -0.5);
    CHECK(along_y.coefficients[1] == 1e-6);
    // Its profile lies along x: what is written of y is where it is turned.
    const LensSide along_x = code_v("XTO; CUX 0.0125; K -0.5").rows[0].side;
    CHECK(along_x.form == SideForm::kToricX);
    CHECK(along_x.curvature == 0.0125);
    CHECK(along_x.across_curvature == 1.0 / 50);
    const LensSide both = code_v("AAS; RDX 80; KX 1.5; KY -0.5; AR 0; AP 0").rows[0].side;
    CHECK(both.form == SideForm::kBiconic);
    CHECK(both.curvature == 1.0 / 50);
    CHECK(both.across_curvature == 1.0 / 80);
    CHECK(both.conic == -0.5);
    CHECK(both.across_conic == 1.5);
    const auto refused = [](const std::string& words) { return refusal_of([&] { code_v(words); }); };
    CHECK(
        refused("K 0\nRDX 80") ==
        "a.seq: line 5: RDX and CUX are read of cylinders, toric and biconic surfaces (CYL, YTO, XTO, AAS)");
    const std::string of_biconic = "KX and KY are read of biconic surfaces (AAS)";
    for (const std::string words : {"YTO\nKX 1", "\nKX 1", "\nKY 1", "XTO\nKY 1", "SPH\nKY 0"}) {
        CAPTURE(words);
        CHECK(refused(words) == "a.seq: line 5: " + of_biconic);
    }
    CHECK(refused("AAS; RDX 80\nA 1e-6") == "a.seq: line 5: A to G are not of an anamorphic asphere (AAS)");
    CHECK(refused("K 0\nAAS; KX 1") == "a.seq: line 5: AAS needs RDX or CUX");
    CHECK(refused("YTO; RDX 80\nXTO") == "a.seq: line 5: XTO: the surface has a form already, YTO in line 4");
    CHECK(refused("YTO; RDX 80\nSPH") == "a.seq: line 5: SPH: the surface has a form already, YTO in line 4");
    CHECK(refused("ASP; A 1e-6\nAAS; RDX 80").starts_with("a.seq: line 5: AAS: the surface has a form"));
    CHECK(refused("ASP; A 1e-6; ASP").empty());
    CHECK(refused("AAS; BR 1e-6") ==
          "a.seq: line 4: BR: of an anamorphic asphere (AAS) its conic sections are read");
    CHECK(refused("YTO S1") ==
          "a.seq: line 4: YTO S1: commands of a surface are read behind it, without its "
          "name");
}

TEST_CASE("cylinders of CODE V are bent along the axis whose radius they have", "[scene][lens]") {
    const LensSide along_y = code_v("CYL").rows[0].side;
    CHECK(along_y.form == SideForm::kToricY);
    CHECK(along_y.curvature == 1.0 / 50);
    CHECK(along_y.across_curvature == 0);
    const LensSide along_x = code_v("CYL; CUY 0; RDX 80").rows[0].side;
    CHECK(along_x.form == SideForm::kToricX);
    CHECK(along_x.curvature == 1.0 / 80);
    CHECK(along_x.across_curvature == 0);
    CHECK(code_v("CYL; K 0; A 0").rows[0].side.form == SideForm::kToricY);
    CHECK(code_v("CYL; A 1e-6; B 1e-9; A 0; B 0").rows[0].side.form == SideForm::kToricY);
    const auto refused = [](const std::string& words) { return refusal_of([&] { code_v(words); }); };
    CHECK(refused("CYL; RDX 80") ==
          "a.seq: line 4: a cylinder (CYL) is bent along y (RDY) or along x (RDX), not along both");
    CHECK(refused("CYL\nK -1") == "a.seq: line 5: K is not of a cylinder (CYL)");
    CHECK(refused("CYL\nA 0\nB 1e-6; A 0") == "a.seq: line 6: A to G are not of a cylinder (CYL)");
    CHECK(refused("CYL\nA 1e-6") == "a.seq: line 5: A to G are not of a cylinder (CYL)");
    CHECK(refused("CYL\nYTO") == "a.seq: line 5: YTO: the surface has a form already, CYL in line 4");
}

TEST_CASE("Q-type aspheres of CODE V are those of the polynomials", "[scene][lens]") {
    const std::vector<double> terms{0.02, 0, -0.01};
    const std::string numbered = "SCO C1 9; SCO C3 0.02; SCO C5 -0.01; SCO C4 0; SCC C3 0";
    const LensSide mild = code_v("SPS QBF; " + numbered).rows[0].side;
    CHECK(mild.normal_departures == qbfs_departures(terms, 9));
    CHECK(mild.curvature == 1.0 / 50);
    CHECK(code_v("SPS QBF; SCO NRADIUS 9; SCO QB4 0.02; SCO QB8 -0.01").rows[0].side.normal_departures ==
          mild.normal_departures);
    const LensSide strong = code_v("SPS QCN; K -0.5; " + numbered).rows[0].side;
    CHECK(strong.coefficients == qcon_coefficients(terms, 9));
    CHECK(strong.conic == -0.5);
    CHECK(is_conicoid(code_v("SPS QBF").rows[0].side));
    // The last number of each counts, by either name.
    CHECK(is_conicoid(code_v("SPS QBF; SCO C1 9; SCO C3 0.02; SCO C3 0").rows[0].side));
    CHECK(code_v("SPS QBF; SCO C3 0.4; SCO C1 9; SCO QB4 0.02; SCO C5 0.1; SCO C5 -0.01")
              .rows[0]
              .side.normal_departures == mild.normal_departures);
    const auto refused = [](const std::string& words) { return refusal_of([&] { code_v(words); }); };
    CHECK(refused("SPS QBF\nK -1") == "a.seq: line 5: SPS QBF departs from a sphere: K must be 0");
    CHECK(refused("SPS QBF\nSCO C3 0.02") ==
          "a.seq: line 4: SPS QBF without a normalization radius (SCO C1)");
    CHECK(refused("SPS QBF; SCO C1 -9; SCO C3 0.02").find("without a normalization radius") !=
          std::string::npos);
    CHECK(refused("SPS QCN\nSCO C2 -0.5") ==
          "a.seq: line 5: SCO C2 of a Q-type surface is not known: conic constants are read from K");
    CHECK(refused("SPS QBF\nSCO C10 0.02") == "a.seq: line 5: SCO C10 is beyond r^16");
    CHECK(refused("SPS QBF\nA 1e-6") == "a.seq: line 5: A to G are not of a Q-type surface (SPS QBF)");
    CHECK(refused("SCO C3 0.02\nSPS QBF").starts_with("a.seq: line 4: SCO C3 before its surface's form"));
    for (const std::string name : {"C0", "C-3", "CX", "QB5", "QC4", "QB2"}) {
        CAPTURE(name);
        CHECK(refused("SPS QBF\nSCO " + name + " 1") ==
              "a.seq: line 5: SCO " + name +
                  " is not read: C1 is the normalization radius, from C3 on are the terms");
    }
    CHECK(refused("SPS XYP") ==
          "a.seq: line 4: SPS XYP: of special surfaces Q-type ones (SPS QBF, SPS QCN) are read");
    CHECK(refused("SPS") ==
          "a.seq: line 4: SPS: of special surfaces Q-type ones (SPS QBF, SPS QCN) are read");
    CHECK(refused("SPS QBF\nSCO") == "a.seq: line 5: SCO needs a coefficient");
    CHECK(refused("SPS QBF\nSCO C3") == "a.seq: line 5: SCO needs a number");
}

TEST_CASE("sides that no number describes, and rims wider than the side, are refused with their place",
          "[scene][lens][bad-input]") {
    const auto refused = [](const std::string& words) { return refusal_of([&] { code_v(words); }); };
    const std::string infinite = "a.seq: line 3: a number of the surface is not finite",
                      turned = "a.seq: line 3: its aperture reaches to where the side turns back";
    CHECK(refused("SPS QBF; SCO C1 1e-200; SCO C3 0.02") == infinite);
    CHECK(refused("SPS QCN; SCO C1 1e-200; SCO C3 0.02") == infinite);
    CHECK(refused("CYL; CUX 1e308; CUY 0; CIR 8") == turned);
    CHECK(refused("CIR 50") == turned);
    CHECK(refused("CIR 49").empty());
    CHECK(refused("ASP; A 1e300; B 1e308; CIR 8") == "a.seq: line 3: its side is not finite");
    for (const std::string kind : {"0", "1"}) {
        CAPTURE(kind);
        CHECK(refusal_of([&] {
                  zemax("QED_TYPE",
                        "  CONI 0\n  XDAT 1 " + kind + "\n  XDAT 2 1\n  XDAT 3 1e-200\n  XDAT 4 0.02\n");
              }) == "a.zmx: line 4: a number of the surface is not finite");
    }
    // DIAM is the half diameter; between air and air nothing turns.
    CHECK(refusal_of([] { zemax("STANDARD", "  CURV 0.2\n  CONI 0\n"); }) ==
          "a.zmx: line 4: its aperture reaches to where the side turns back");
    CHECK(parse_lens("RDM\nSO 0 1E13\nS 5 1\nCIR 9\nS 50 4 NBK7\nS 0 9\nSI 0 0\n", "a.seq").rows.size() == 3);
}

TEST_CASE("a Zemax file that ends within its lens is refused with the line of the glass",
          "[scene][lens][bad-input]") {
    const std::string text =
        "SURF 0\n  DISZ INFINITY\nSURF 1\n  CURV 0.02\n  DISZ 4\n  GLAS N-BK7\nSURF 2\n  DISZ 9\n";
    const auto refused = [](const std::string& lines) {
        return refusal_of([&] { parse_lens(lines, "a.zmx"); });
    };
    const std::string early = "the last surface, the image, has glass: the file ends early";
    CHECK(refused(text + "SURF 3\n  CURV 0.01\n").empty());
    CHECK(refused(text + "SURF 3\n  CURV 0.01\n  GLAS F2\n") == "a.zmx: line 11: " + early);
    CHECK(refused(text + "SURF 3\n  GLAS MIRROR\n") == "a.zmx: line 10: " + early);
    CHECK(refused(text.substr(0, text.find("SURF 2"))) == "a.zmx: line 6: " + early);
}

TEST_CASE("a scene's anamorphic sides are those of its bodies, and keys that disagree are refused",
          "[scene][lens]") {
    const std::string scene =
        R"({"version": 1, "cameras": [{"lookAt": {"eye": [0, 0, -9], "at": [0, 0, 0]}}], "lenses": [{"name": "t",
            "transform": {"scale": [2, 2, 2]}, "surfaces": [
            {"radius": 9, "radiusX": -12, "conicX": 0.5, "aperture": 1, "thickness": 1, "glass": "N-BK7"},
            {"radius": -7, "rotationRadius": 0, "profileAlong": "x", "coefficients": [0, 0.01], "aperture": 1.2}]}]})";
    const Scene read = load_text(scene);
    REQUIRE(read.meshes.size() == 1);
    const auto& lens = std::get<LensPrimitive>(read.meshes[0].primitive->kind);
    CHECK(lens.front.form == SideForm::kBiconic);
    CHECK(lens.front.across_curvature == -1.0 / 24);
    CHECK(lens.front.across_conic == 0.5);
    CHECK(lens.back.form == SideForm::kToricX);
    CHECK(lens.back.across_curvature == 0);
    CHECK(std::fabs(lens.back.coefficients[1] - 0.01 / 8) < 1e-18);
    // What is written of the scene is the same.
    const Scene again = load_text(read.resolved);
    const auto& same = std::get<LensPrimitive>(again.meshes[0].primitive->kind);
    CHECK(same.front.across_curvature == lens.front.across_curvature);
    CHECK(same.back.form == SideForm::kToricX);

    const auto refused = [](const std::string& keys) {
        return refusal_of([&] { parse_lens_side(R"({"aperture": 1, )" + keys + "}", "side"); });
    };
    CHECK(refused(R"("conicX": 1)") == "side: /conicX: needs a radiusX beside it");
    CHECK(refused(R"("radiusX": 4, "rotationRadius": 5)").starts_with("side: /rotationRadius: "));
    CHECK(refused(R"("radiusX": 4, "coefficients": [0, 1])").starts_with("side: /coefficients: "));
    CHECK(refused(R"("rotationRadius": 4, "radius": 9, "qbfs": [1])").starts_with("side: /qbfs: "));
    CHECK(refused(R"("profileAlong": "x")") == "side: /profileAlong: needs a rotationRadius beside it");
    CHECK(refused(R"("rotationRadius": 4, "profileAlong": "z")").starts_with("side: /profileAlong: "));
}

TEST_CASE("obscurations of lens files are black shells in the scene, and stop a spot's rays",
          "[scene][lens]") {
    CHECK(zemax("STANDARD", "  OBSC 0 2.5 0\n").rows[0].obscuration == 2.5);
    const LensPrescription lens = code_v("CIR 8; CIR OBS 3");
    CHECK(lens.rows[0].obscuration == 3);
    const Spot open = spot_of(code_v("CIR 8"), {}), spot = spot_of(lens, {});
    CHECK(spot.points.size() < open.points.size() - 20);
    CHECK(spot.radius == Approx(open.radius).epsilon(0.05));
    const Scene scene = load_text(
        R"({"version": 1, "cameras": [{"lookAt": {"eye": [0, 0, -9], "at": [0, 0, 0]}}], "lenses": [{"name": "t", "surfaces": [
            {"radius": 9, "aperture": 1, "thickness": 1, "glass": "N-BK7", "obscuration": 0.4},
            {"radius": -9, "aperture": 1, "thickness": 0.5, "glass": "N-SF6", "obscuration": 0.3},
            {"radius": -30, "aperture": 1, "obscuration": 0.2}]}]})");
    REQUIRE(scene.meshes.size() == 4);
    CHECK(scene.meshes[2].name == "t/obscuration 1");
    CHECK(scene.meshes[3].name == "t/obscuration 3");
    CHECK(scene.meshes[2].role == Role::kObject);
    for (const Vec3& p : scene.meshes[2].object.points) CHECK(p.z < p.x * p.x / 18 + p.y * p.y / 18);
    REQUIRE(scene.warnings.size() == 1);
    CHECK(scene.warnings[0] ==
          "room.json: /lenses/0/surfaces/1: its obscuration is not drawn: it has glass on both sides");
}

TEST_CASE("obscurations too large for their side are refused with their row's place",
          "[scene][lens][bad-input]") {
    // A radius of 50, without a DIAM on that side.
    const std::string shell =
        "no obscuration can be made of it: its aperture reaches to where the side turns back";
    CHECK(refusal_of([] { code_v("CIR OBS 60"); }) == "a.seq: line 3: " + shell);
    CHECK(refusal_of([] {
              parse_lens(
                  "MODE SEQ\nSURF 0\n  DISZ INFINITY\nSURF 1\n  CURV 0.02\n  OBSC 0 60 0\n"
                  "  DISZ 4\n  GLAS N-BK7\nSURF 2\n  DISZ 0\nSURF 3\n",
                  "a.zmx");
          }) == "a.zmx: line 4: " + shell);
    const std::string surfaces =
        R"({"surfaces": [{"radius": 9, "thickness": 1, "aperture": 1, "glass": "N-BK7"},
            {"radius": -3, "obscuration": 4}]})";
    CHECK(refusal_of([&] { parse_lens(surfaces, "a.json"); }) == "a.json: /surfaces/1: " + shell);
    CHECK(
        refusal_of([&] {
            load_text(
                R"({"version": 1, "cameras": [{"lookAt": {"eye": [0, 0, -9], "at": [0, 0, 0]}}], "lenses": [)" +
                std::string(surfaces).insert(1, R"("name": "t", )") + "]}");
        }) == "room.json: /lenses/0/surfaces/1: " + shell);
}
