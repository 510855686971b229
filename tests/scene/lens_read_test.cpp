// Lens files and lenses of scenes: Zemax, CODE V and JSON say the same, and what is no lens is told by its
// line.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scene/formats/lens_file.h"
#include "scene/info.h"
#include "scene/read/read_lens.h"
#include "scene/scene_text.h"
#include "support/published_lenses.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string shipped(const std::string& name) {
    return read_required_file(source_dir() + "/scenes/lenses/" + name);
}

/// A Zemax file of one element, a line of which is replaced.
std::string zemax_text(const std::string& line = "", const std::string& by = "") {
    std::string text =
        "MODE SEQ\r\nNAME one\r\nSURF 0\r\n  DISZ INFINITY\r\nSURF 1\r\n  STOP\r\n  TYPE STANDARD\r\n  CURV "
        "0.02 0 0\r\n"
        "  DISZ 4\r\n  GLAS N-BK7 0 0 1.5 40\r\n  DIAM 10 1\r\nSURF 2\r\n  TYPE EVENASPH\r\n  CURV -0.01\r\n "
        " CONI -1.5\r\n"
        "  PARM 1 0.001\r\n  PARM 2 -2e-6\r\n  DISZ 90\r\n  DIAM 9.5 1\r\nSURF 3\r\n  DISZ 0\r\n";
    if (!line.empty()) text.replace(text.find(line), line.size(), by);
    return text;
}

std::string refusal(const std::string& text, const std::string& file = "a.zmx") {
    try {
        parse_lens(text, file);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string lens_scene(const std::string& lenses) {
    return R"({"version": 1, "cameras": [{"yfov": 40, "lookAt": {"eye": [0, 1, 4], "at": [0, 0, 0]}}],
        "meshes": [{"name": "wall", "role": "object", "primitive": {"type": "plane"}}],
        "lights": [{"type": "ambient"}], "lenses": )" +
           lenses + "}";
}

constexpr const char* kSinglet =
    R"([{"name": "one", "resolution": 3, "transform": {"translate": [0, 0, 1], "scale": [2, 2, 2]},
    "surfaces": [{"radius": 5, "thickness": 0.6, "glass": "N-BK7", "aperture": 1}, {"radius": -5, "aperture": 0.9, "thickness": 1},
                 {"stop": true, "aperture": 0.5}]}])";

std::string scene_refusal(const std::string& lenses) {
    try {
        load_text(lens_scene(lenses));
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

void check_same(const LensPrescription& lens, const LensPrescription& like, double slack) {
    REQUIRE(lens.rows.size() == like.rows.size());
    for (std::size_t i = 0; i < lens.rows.size(); ++i) {
        CAPTURE(i);
        const LensRow &one = lens.rows[i], &other = like.rows[i];
        CHECK(std::fabs(one.side.curvature - other.side.curvature) < 1e-15);
        CHECK(one.side.aperture == other.side.aperture);
        CHECK(one.thickness == other.thickness);
        CHECK(one.stop == other.stop);
        CHECK(std::fabs(one.glass.index - other.glass.index) < slack);
        CHECK(std::fabs(one.glass.abbe - other.glass.abbe) < slack);
    }
}

}  // namespace

TEST_CASE("the shipped lens files are the published prescriptions", "[scene][lens]") {
    const LensPrescription triplet = parse_lens(shipped("cooke-triplet.zmx"), "cooke-triplet.zmx");
    CHECK(triplet.name == "Cooke triplet, f/3.5");
    check_same(triplet, cooke_triplet(), 1e-12);
    const LensPrescription gauss = parse_lens(shipped("double-gauss.seq"), "double-gauss.seq");
    CHECK(gauss.name == "Double Gauss, f/1.25");
    check_same(gauss, double_gauss(), 1e-12);
}

TEST_CASE("a Zemax file's surfaces are read, as UTF-8 and as UTF-16", "[scene][lens]") {
    const LensPrescription lens = parse_zemax(zemax_text(), "a.zmx");
    REQUIRE(lens.rows.size() == 2);
    CHECK(lens.name == "one");
    CHECK(lens.rows[0].stop);
    CHECK(lens.rows[0].glass.index == 1.5168);
    CHECK(lens.rows[0].side.curvature == 0.02);
    CHECK(lens.rows[1].side.conic == -1.5);
    CHECK(lens.rows[1].side.coefficients[0] == 0.001);
    CHECK(lens.rows[1].side.coefficients[1] == -2e-6);
    CHECK(lens.rows[1].thickness == 90);
    for (const bool little : {true, false}) {
        std::string wide = little ? "\xff\xfe" : "\xfe\xff";
        for (const char letter : zemax_text()) {
            if (!little) wide += '\0';
            wide += letter;
            if (little) wide += '\0';
        }
        CHECK(parse_zemax(wide, "a.zmx").rows.size() == 2);
    }
    CHECK(parse_zemax(zemax_text("N-BK7 0 0 1.5 40", "___BLANK 1 0 1.6 50.5"), "a.zmx").rows[0].glass.abbe ==
          50.5);
}

TEST_CASE("a circular aperture of Zemax is its inner radius and its outer one, within the surface's own",
          "[scene][lens]") {
    const auto side = [](const std::string& lines) {
        const LensRow row = parse_zemax(zemax_text("DIAM 10 1", lines), "a.zmx").rows.at(0);
        return Vec2(row.hole, row.side.aperture);
    };
    CHECK(side("CLAP 0 8 0") == Vec2(0, 8));
    CHECK(side("DIAM 10 1\r\n  CLAP 0 8 0") == Vec2(0, 8));
    CHECK(side("CLAP 0 8 0\r\n  DIAM 10 1") == Vec2(0, 8));
    CHECK(side("DIAM 10 1\r\n  CLAP 2 12 0\r\n  OBDC 0 0.0") == Vec2(2, 10));
    CHECK(side("DIAM 0 0\r\n  CLAP 2 12 0\r\n  FLAP 0 11 0") == Vec2(2, 12));
    for (const std::string line : {"OBDC 0 1", "OBSC 1 2 0", "OBSC 0 -2 0", "SQAP 5 5 0", "ELAP 5 4 0",
                                   "SQOB 1 1 0", "ELOB 1 2 0", "SPID 0.5 3 0"}) {
        CAPTURE(line);
        const std::string place = "a.zmx: line 12: " + line.substr(0, 4) + ": ";
        CHECK(refusal(zemax_text("DIAM 10 1", "DIAM 10 1\r\n  " + line)).starts_with(place));
    }
    // The detector's shape is not the lens'.
    CHECK(refusal(zemax_text("SURF 3", "SURF 3\r\n  SQAP 4 3 0")).empty());
}

TEST_CASE("a CODE V sequence is read in radii and in curvatures, over lines and semicolons",
          "[scene][lens]") {
    const std::string text =
        "RDM;LEN\nTITLE 'one' ! a comment\nSO 0 1e11\nS 50 4 &\n NBK7_SCHOTT\n  CIR 10; STO\nS1 -100.0 90\n "
        "K -1.5\n ASP\n "
        "A -2D-6; B 1e-9\n  CIR EDG 9.5\nSI 0 0\nGO\n";
    const LensPrescription lens = parse_code_v(text, "a.seq");
    REQUIRE(lens.rows.size() == 2);
    CHECK(parse_code_v(replaced(text, "'one'", "\"one\""), "a.seq").name == lens.name);
    CHECK(lens.rows[0].glass.name == "N-BK7");
    CHECK(lens.rows[0].side.curvature == 0.02);
    CHECK(lens.rows[0].stop);
    CHECK(lens.rows[1].side.aperture == 9.5);
    CHECK(lens.rows[1].side.coefficients[1] == -2e-6);
    CHECK(lens.rows[1].side.coefficients[2] == 1e-9);
    std::string known = text, unknown = text;
    unknown.replace(unknown.find("NBK7"), 4, "NBK6");
    CHECK(refusal(unknown, "a.seq").starts_with("a.seq: line 5: unknown glass 'NBK6'; did you mean"));
    known.replace(known.find("RDM"), 3, "CUM");
    known.replace(known.find("S 50"), 4, "S 0.02");
    known.replace(known.find("S1 -100.0"), 9, "S1 -0.01");
    CHECK(parse_code_v(known, "a.seq").rows[1].side.curvature == -0.01);
    for (const std::string word : {"REFL", "SPS XYP", "H 1e-9", "GRT", "GLB S1", "REX 4", "DEL S2",
                                   "SCA SA 2", "FLY SA", "PIK CUY S2 S1", "K 0.3 A 1e-5", "ADE 5 BDE 3",
                                   "CIR 5 CIR HOL 2", "THI 3 GLA SF6", "RMD TIR", "YDE three"}) {
        std::string bent = known;
        bent.insert(bent.find("ASP"), word + "\n");
        CHECK(refusal(bent, "a.seq").starts_with("a.seq: line 9: "));
    }
    CHECK(refusal("LEN\nGO\n", "a.seq") == "a.seq: has no surfaces from SO to SI: it is no CODE V sequence");
}

TEST_CASE("lens files of what is no lens are refused with their line", "[scene][lens][bad-input]") {
    CHECK(refusal(zemax_text("EVENASPH", "ZERNSAG")) ==
          "a.zmx: line 13: a surface of type ZERNSAG: STANDARD, EVENASPH, BICONICX, TOROIDAL, QED_TYPE and "
          "COORDBRK are read");
    CHECK(refusal(zemax_text("N-BK7", "MIRROR")) ==
          "a.zmx: line 5: its thickness is positive: behind a mirror light runs against the axis");
    CHECK(refusal(zemax_text("DIAM 10 1", "DIAM 10 1\r\n  CLAP 11 20")) ==
          "a.zmx: line 5: its hole is as large as its aperture");
    CHECK(refusal(zemax_text("DIAM 10 1", "CLAP 10")) == "a.zmx: line 11: CLAP needs a number");
    CHECK(refusal(zemax_text("DIAM 10 1", "CLAP 10 10 0")) ==
          "a.zmx: line 11: CLAP has its inner radius, 0 or more, then a larger one");
    CHECK(refusal(zemax_text("N-BK7", "N-BK6"))
              .starts_with("a.zmx: line 10: unknown glass 'N-BK6'; did you mean"));
    CHECK(refusal(zemax_text("0.02", "two")) == "a.zmx: line 8: CURV needs a number, not \"two\"");
    CHECK(refusal(zemax_text("0.02", "nan")) == "a.zmx: line 8: CURV needs a number, not \"nan\"");
    CHECK(refusal(zemax_text("DISZ 4", "DISZ")) == "a.zmx: line 9: DISZ needs a number");
    CHECK(refusal(zemax_text("DISZ 4", "DISZ INFINITY")) == "a.zmx: line 5: what follows is at infinity");
    CHECK(refusal(zemax_text("SURF 2", "SURF 4")) == "a.zmx: line 12: surfaces do not follow each other");
    CHECK(refusal(zemax_text("PARM 2", "PARM 9")) ==
          "a.zmx: line 17: PARM 9 is not read of surfaces of type EVENASPH");
    CHECK(refusal(zemax_text("PARM 2", "PARM 1e300")) ==
          "a.zmx: line 17: PARM 1e300 is not read of surfaces of type EVENASPH");
    CHECK(refusal(zemax_text("MODE SEQ", "MODE NSC")).starts_with("a.zmx: line 1: is a system of mode NSC"));
    CHECK(refusal(zemax_text("DIAM 10", "DIAM -10")) == "a.zmx: line 11: DIAM is negative");
    CHECK(refusal("hello\n") == "a.zmx: has no line SURF: it is no Zemax lens file");
    CHECK(refusal("SURF 0\nSURF 1\n") == "a.zmx: has no surface between object and image");
    CHECK(refusal("", "a.len") == "a.len: is no lens file: its name ends neither in .zmx nor .seq nor .json");
    CHECK(refusal(R"({"surfaces": [{"radius": 3, "sag": 1}, {}]})", "a.json")
              .starts_with("a.json: /surfaces/0/sag: "));
}

TEST_CASE("a scene's lenses are optics behind its meshes, with their glasses and a ring for the stop",
          "[scene][lens]") {
    const Scene scene = load_text(lens_scene(kSinglet));
    REQUIRE(scene.meshes.size() == 3);
    const Mesh& lens = scene.meshes[1];
    CHECK(lens.name == "one/1");
    CHECK(lens.role == Role::kOptic);
    CHECK(lens.resolution == 3);
    REQUIRE(lens.primitive);
    const auto& shape = std::get<LensPrimitive>(lens.primitive->kind);
    CHECK(shape.thickness == 1.2);
    CHECK(shape.front.curvature == 0.1);
    CHECK(shape.back.aperture == 1.8);
    CHECK(lens.primitive->center == Vec3(0, 0, 1));
    const Material& glass = scene.materials[lens.material];
    CHECK(glass.name == "one/N-BK7");
    CHECK(glass.ior == 1.5168);
    CHECK(std::fabs(glass.dispersion - 20 / 64.17) < 1e-15);
    const Mesh& ring = scene.meshes[2];
    CHECK(ring.name == "one/stop");
    double nearest = 9, farthest = 0;
    for (const Vec3& p : ring.object.points) {
        CHECK(std::fabs(p.z - 4.2) < 1e-12);
        nearest = std::min(nearest, std::hypot(p.x, p.y));
        farthest = std::max(farthest, std::hypot(p.x, p.y));
    }
    CHECK(std::fabs(nearest - 1) < 1e-12);
    CHECK(std::fabs(farthest - 2.5) < 1e-12);
    // What the picture's header holds is the same scene again; overrides of lenses come before their bodies.
    CHECK(load_text(scene.resolved).meshes.size() == 3);
    const Scene thick = load_text(lens_scene(kSinglet), {{"/lenses/0/surfaces/0/thickness", "0.8"}});
    CHECK(std::get<LensPrimitive>(thick.meshes[1].primitive->kind).thickness == 1.6);
    const Box box = make_scene_info(scene).meshes[1].bounds;
    CHECK(std::fabs(box.low.z - 1) < 1e-12);
    CHECK(std::fabs(box.high.z - 2.2) < 1e-12);
    CHECK(std::fabs(box.high.x - 2) < 1e-12);
}

TEST_CASE("glasses that differ are materials that differ, whatever they are called", "[scene][lens]") {
    const Scene scene = load_text(lens_scene(R"([ { "name": "pair", "surfaces": [
        { "radius": 5, "thickness": 1, "ior": 1.5, "abbe": 60, "aperture": 1 },
        { "radius": -5, "thickness": 1, "aperture": 1 },
        { "radius": 5, "thickness": 1, "ior": 1.5, "abbe": 30, "aperture": 1 },
        { "radius": -5, "thickness": 1, "aperture": 1 },
        { "radius": 5, "thickness": 1, "ior": 1.5, "abbe": 60, "aperture": 1 },
        { "radius": -5, "aperture": 1 } ] } ])"));
    REQUIRE(scene.meshes.size() == 4);
    const auto glass = [&](std::size_t i) { return scene.materials.at(scene.meshes[i].material); };
    CHECK(scene.meshes[1].material == scene.meshes[3].material);
    CHECK(glass(1).name == "pair/1.5");
    CHECK(glass(2).name == "pair/1.5/2");
    CHECK(std::fabs(glass(2).dispersion - 2 * glass(1).dispersion) < 1e-12);
}

TEST_CASE("lenses that cannot be made are refused with their place in the scene",
          "[scene][lens][bad-input]") {
    const auto with = [](const std::string& what, const std::string& by) {
        std::string text = kSinglet;
        return scene_refusal(text.replace(text.find(what), what.size(), by));
    };
    CHECK(with("N-BK7", "N-BK6")
              .starts_with("room.json: /lenses/0/surfaces/0/glass: unknown glass 'N-BK6'; did"));
    CHECK(with("\"thickness\": 0.6, ", "")
              .starts_with("room.json: /lenses/0/surfaces/0: its glass has no thickness"));
    CHECK(with("\"aperture\": 1}", "\"aperture\": 5}").find("turns back") != std::string::npos);
    CHECK(with(", \"aperture\": 0.9", "").starts_with("room.json: /lenses/0/surfaces/1: has no aperture"));
    CHECK(with("\"resolution\": 3", "\"resolution\": 0").starts_with("room.json: /lenses/0/resolution: "));
    CHECK(with("\"glass\"", "\"ior\": 1.5, \"glass\"").find("'ior' is no key of a surface with a glass") !=
          std::string::npos);
    CHECK(with("\"surfaces\"", "\"surface\"").find("did you mean 'surfaces'?") != std::string::npos);
    CHECK(with("[2, 2, 2]", "[2, 2, 3]") ==
          "room.json: /lenses/0/transform: a lens stays exact only under a uniform scale");
    CHECK(scene_refusal(R"([{"file": "none.zmx"}])").starts_with("room.json: "));
    CHECK(scene_refusal("{}").starts_with("room.json: /lenses: "));
    // The stop on glass has no ring.
    std::string on_glass = kSinglet;
    const std::string stop = "\"stop\": true, ";
    on_glass.erase(on_glass.find(stop), stop.size());
    on_glass.insert(on_glass.find("\"radius\": 5"), stop);
    const Scene scene = load_text(lens_scene(on_glass));
    CHECK(scene.meshes.size() == 2);
    REQUIRE(!scene.warnings.empty());
    CHECK(scene.warnings.back().find("/lenses/0: its stop lies on glass") != std::string::npos);
}
