// Lenses as optics: rays through their bodies are those of the prescription, and what is projected through
// them is what is traced.
#include <algorithm>
#include <cmath>
#include <string>

#include "cli/command_line.h"
#include "json/json.h"
#include "laws/agreement.h"
#include "laws/worlds.h"
#include "lens/sequential_rays.h"
#include "measure/displacement/displacement.h"
#include "render/picture/picture.h"
#include "render/shoot/shoot.h"
#include "scene/read/read_lens.h"
#include "support/draw.h"
#include "support/published_lenses.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string scene_of(const LensPrescription& lens) {
    Json surfaces = Json::array();
    for (const LensRow& row : lens.rows) {
        Json one{{"thickness", row.thickness}, {"aperture", row.side.aperture}, {"conic", row.side.conic}};
        if (row.side.curvature != 0) one["radius"] = 1 / row.side.curvature;
        if (has_coefficients(row.side)) one["coefficients"] = row.side.coefficients;
        const double across = row.side.across_curvature == 0 ? 0 : 1 / row.side.across_curvature;
        if (row.side.form == SideForm::kBiconic) {
            one["radiusX"] = across;
            one["conicX"] = row.side.across_conic;
        } else if (!is_round(row.side)) {
            one["rotationRadius"] = across;
            one["profileAlong"] = row.side.form == SideForm::kToricX ? "x" : "y";
        }
        if (!row.glass.is_air()) one["ior"] = row.glass.index;
        if (row.stop) one["stop"] = true;
        if (row.mirror) one["mirror"] = true;
        if (row.hole > 0) one["hole"] = row.hole;
        if (row.obscuration > 0) one["obscuration"] = row.obscuration;
        if (departs_along_normal(row.side)) one["normalDepartures"] = row.side.normal_departures;
        surfaces.push_back(one);
    }
    const Json scene{{"version", 1},
                     {"cameras", {{{"lookAt", {{"eye", {0, 0, -100}}, {"at", {0, 0, 0}}}}}}},
                     {"lenses", {{{"name", "lens"}, {"surfaces", surfaces}}}}};
    return scene.dump();
}

/// A convex hyperboloid before an even asphere, a stop behind.
LensPrescription aspheric_singlet() {
    LensPrescription lens{"asphere", "asphere", {}};
    lens.rows.resize(3);
    lens.rows[0] = {{0.03, -2, {}, 9}, 6, {"glass", 1.6, 0}};
    lens.rows[1] = {{-0.01, 0, {0.002, -8e-6, 2e-9}, 9}, 10};
    lens.rows[2].side.aperture = 7;
    lens.rows[2].stop = true;
    return lens;
}

/// A biconic before an aspheric toric side, and a cylinder before one that crosses it.
LensPrescription anamorphic_pair() {
    LensPrescription lens{"anamorphic", "anamorphic", {}};
    lens.rows.resize(4);
    lens.rows[0] = {{0.03, -2, {}, 9, {}, SideForm::kBiconic, 0.012, 1.5}, 6, {"glass", 1.6, 0}};
    lens.rows[1] = {{-0.01, 0, {0.002, -8e-6, 2e-9}, 9, {}, SideForm::kToricX, -0.02}, 10};
    lens.rows[2] = {{0.02, 0, {}, 11, {}, SideForm::kToricY}, 4, {"flint", 1.7, 0}};
    lens.rows[3] = {{0.015, 0, {}, 11, {}, SideForm::kToricX}, 0};
    return lens;
}

/// A mirror on the back of a meniscus, of Mangin's kind.
LensPrescription mangin() {
    LensPrescription lens{"Mangin", "Mangin", {}};
    lens.rows.resize(3);
    lens.rows[0] = {{-0.01, 0, {}, 20}, 5, {"glass", 1.52, 0}};
    lens.rows[1] = {{-0.0067, -0.3, {}, 20}, -5};
    lens.rows[1].mirror = true;
    lens.rows[2].side = lens.rows[0].side;
    return lens;
}

/// A Cassegrain, of a hyperboloid and a paraboloid with a hole.
LensPrescription cassegrain() {
    LensPrescription lens{"Cassegrain", "Cassegrain", {}};
    lens.rows.resize(2);
    lens.rows[0] = {{-1.0 / 600, -1, {}, 50}, -210};
    lens.rows[1] = {{-1.0 / 270, -4, {}, 16}, 270};
    lens.rows[0].mirror = lens.rows[1].mirror = true;
    lens.rows[0].hole = 13;
    return lens;
}

/// A lens with a Qbfs front and the light's way through a plate that is tilted behind it.
const char* const kTilted = R"([{"name": "lens", "surfaces": [
    {"radius": 60, "qbfs": [0.05, -0.02], "aperture": 12, "thickness": 5, "ior": 1.6},
    {"radius": -80, "aperture": 12, "thickness": 20},
    {"aperture": 15, "thickness": 6, "ior": 1.5, "decentre": [0.5, -1, 0], "tilt": [25, -10, 5]},
    {"aperture": 15, "thickness": 60},
    {"aperture": 45, "thickness": -30, "mirror": true, "radius": -300, "tilt": [25, 0, 0], "axisBehind": "bends"}]}])";

std::string scene_with(const std::string& lenses) {
    return R"({"version": 1, "cameras": [{"lookAt": {"eye": [0, 0, -100], "at": [0, 0, 0]}}], "lenses": )" +
           lenses + "}";
}

/// How far rays that are shot come out from those of the prescription: directions, and how far one line
/// passes by the other's start.
double worst_of(const World& world, const std::string& word, const std::vector<Ray>& rays,
                const std::vector<Ray>& ends) {
    ShootRequest request;
    request.path = EventWord(word);
    const ShotRays shots = shoot_rays(world, request, rays);
    double worst = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const ShotRay& shot = shots.rays[i];
        REQUIRE(shot.followed());
        const Vec3 off = shot.origin - ends[i].origin;
        const double aside = length(off - dot(off, ends[i].direction) * ends[i].direction);
        worst = std::max({worst, length(shot.direction - ends[i].direction), aside / 100});
    }
    return worst;
}

}  // namespace

TEST_CASE("rays by the mirrors of a Cassegrain go by its secondary and out of its hole", "[lens][law]") {
    const LensPrescription lens = cassegrain();
    const auto world = world_from("cassegrain", scene_of(lens), 8);
    Draw draw(6);
    std::vector<Ray> rays, ends;
    while (rays.size() < 300) {
        const double turn = draw.uniform(0, 6.2831853), reach = draw.uniform(17, 49);
        const Vec3 at(reach * std::cos(turn), reach * std::sin(turn), -400);
        const Ray ray{at, normalize(Vec3(draw.uniform(-0.002, 0.002), draw.uniform(-0.002, 0.002), 1))};
        const auto end = trace_lens(lens, ray);
        // Those that come by the secondary on their way to the primary.
        const Vec3 passing = ray.origin + 190.0 / ray.direction.z * ray.direction;
        if (!end || std::hypot(passing.x, passing.y) < 16.5) continue;
        rays.push_back(ray);
        ends.push_back(*end);
    }
    CHECK(worst_of(*world, "RR", rays, ends) < 1e-11);
}

TEST_CASE("rays through tilted and decentred bodies, by a mirror, are those of the prescription",
          "[lens][law]") {
    const auto world = world_from("tilted", scene_with(kTilted), 8);
    const Json surfaces = parse_json(kTilted, "tilted").at(0).at("surfaces");
    const LensPrescription lens = parse_lens(Json{{"surfaces", surfaces}}.dump(), "tilted.json");
    CHECK(lens.rows.size() == 5);
    Draw draw(8);
    std::vector<Ray> rays, ends;
    while (rays.size() < 300) {
        const Vec3 at(draw.uniform(-9, 9), draw.uniform(-9, 9), 0);
        const Vec3 direction = normalize(Vec3(draw.uniform(-0.1, 0.1), draw.uniform(-0.1, 0.1), 1));
        const Ray ray{at - 60.0 * direction, direction};
        const auto end = trace_lens(lens, ray);
        if (!end) continue;
        rays.push_back(ray);
        ends.push_back(*end);
    }
    CHECK(worst_of(*world, "TTTTR", rays, ends) < 1e-11);
}

TEST_CASE("rays through a lens' bodies are those of its prescription, cemented, aspheric or not",
          "[lens][law]") {
    for (const LensPrescription& lens :
         {cooke_triplet(), double_gauss(), aspheric_singlet(), anamorphic_pair(), mangin()}) {
        CAPTURE(lens.name);
        const auto world = world_from("lens", scene_of(lens), 8);
        std::string word;  // a transmission for each surface of glass
        for (std::size_t i = 0; i < lens.rows.size(); ++i)
            if (!lens.rows[i].glass.is_air() || (i > 0 && !lens.rows[i - 1].glass.is_air()) ||
                lens.rows[i].mirror || lens.name == "Mangin")
                word += lens.rows[i].mirror ? 'R' : 'T';
        // So that none comes near the stop's ring, which has corners.
        LensPrescription narrow = lens;
        for (LensRow& row : narrow.rows) row.side.aperture *= 0.99;
        Draw draw(5);
        std::vector<Ray> rays, ends;
        while (rays.size() < 300) {
            const double reach = 0.9 * lens.rows[0].side.aperture;
            const Vec3 at(draw.uniform(-reach, reach), draw.uniform(-reach, reach), 0);
            const Vec3 direction = normalize(Vec3(draw.uniform(-0.2, 0.2), draw.uniform(-0.2, 0.2), 1));
            const Ray ray{at - 60.0 * direction, direction};
            const auto end = trace_lens(narrow, ray);
            if (!end) continue;
            rays.push_back(ray);
            ends.push_back(*end);
        }
        CHECK(worst_of(*world, word, rays, ends) < 1e-11);
    }
}

TEST_CASE("what obscures a surface's middle stops the rays that the prescription stops", "[lens][law]") {
    LensPrescription before = aspheric_singlet();
    before.rows[0].obscuration = 2.5;
    LensPrescription behind = anamorphic_pair();
    behind.rows[1].obscuration = 4;
    LensPrescription mirrors = cassegrain();
    mirrors.rows[0].obscuration = 25;
    mirrors.rows[1].obscuration = 8;
    for (const LensPrescription& lens : {before, behind, mirrors}) {
        CAPTURE(lens.name);
        const auto world = world_from("lens", scene_of(lens), 8);
        ShootRequest request;
        request.path = EventWord(lens.rows[0].mirror ? "RR" : lens.rows.size() == 3 ? "TT" : "TTTT");
        // Rays that come nearer to an edge than a shell is thick are left out.
        LensPrescription wide = lens, narrow = lens;
        for (LensRow& row : wide.rows) row.obscuration *= 1.01;
        for (LensRow& row : narrow.rows) row.obscuration *= 0.99, row.side.aperture *= 0.99;
        Draw draw(9);
        std::vector<Ray> rays;
        std::vector<char> passes;
        while (rays.size() < 1000) {
            const double reach = 0.9 * lens.rows[0].side.aperture;
            const Vec3 at(draw.uniform(-reach, reach), draw.uniform(-reach, reach), 0);
            const Vec3 direction = normalize(Vec3(draw.uniform(-0.02, 0.02), draw.uniform(-0.02, 0.02), 1));
            const Ray ray{at - 400.0 * direction, direction};
            const Vec3 passing = ray.origin + 190.0 / ray.direction.z * ray.direction;
            if (lens.rows[0].mirror && std::hypot(passing.x, passing.y) < 16.5) continue;
            LensPrescription open = narrow;
            for (LensRow& row : open.rows) row.obscuration = 0;
            const bool is_stopped = !trace_lens(narrow, ray), is_by = trace_lens(wide, ray).has_value();
            if (!trace_lens(open, ray) || (!is_stopped && !is_by)) continue;
            rays.push_back(ray);
            passes.push_back(is_by);
        }
        const ShotRays shots = shoot_rays(*world, request, rays);
        std::size_t by = 0, off = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            by += passes[i];
            off += shots.rays[i].followed() != static_cast<bool>(passes[i]);
        }
        CHECK(off == 0);
        CHECK(by > 200);
        CHECK(by < 950);
    }
}

TEST_CASE("the triplet shows the same projected as traced", "[lens][law]") {
    std::string missing;
    const auto world = shipped_world("lenses/cooke-triplet", 8, 160, 120, &missing);
    REQUIRE(world);
    CHECK(world->scene.meshes.size() == 7);
    PictureRequest request;
    const Image drawn = draw_picture(*world, request, {}, ignore).image;
    request.engine = Engine::kLimitTruth;
    const Image truth = draw_picture(*world, request, {}, ignore).image;
    const auto found = measure_displacement(truth, drawn, "refract");
    REQUIRE(found);
    REQUIRE(found->summary);
    CHECK(found->pixels > 500);
    CHECK(found->summary->p95 < 0.5);
    CHECK(found->lost <= found->pixels / 100);
}

TEST_CASE("a lens as an optic and the facets' own rays show the same", "[lens][law]") {
    const std::string json = R"({"version": 1, "film": {"width": 80, "height": 60},
        "cameras": [{"name": "main", "yfov": 40, "lookAt": {"eye": [0.4, 0.3, 4], "at": [0, 0, 0]}}],
        "materials": [{"name": "glass", "transmissionFactor": 1, "ior": 1.6}],
        "meshes": [{"name": "lens", "role": "optic", "material": "glass", "primitive": {"type": "lens", "axis": [0.1, 0.2, 1],
            "thickness": 0.7, "front": {"radius": 2, "aperture": 0.9}, "back": {"radius": -1.8, "conic": -0.5, "coefficients": [0, 0.01],
            "aperture": 1}}},
            {"name": "box", "role": "object", "primitive": {"type": "box", "center": [0.5, 0.2, -3], "size": [1.5, 1, 0.6]}},
            {"name": "wall", "role": "object", "primitive": {"type": "plane", "center": [0, 0, -6], "normal": [0, 0, 1], "size": [9, 7]}}]})";
    const std::string anamorphic =
        replaced(replaced(json, R"("radius": 2, )", R"("radius": 2, "radiusX": -9, "conicX": 0.5, )"),
                 R"("radius": -1.8, )", R"("radius": -1.8, "rotationRadius": -6, "profileAlong": "x", )");
    for (const std::string& scene : {json, anamorphic}) {
        const auto world = world_from("lens", scene, 6);
        const Agreement agreement = compare_engines(*world);
        INFO(agreement.first_off_edge);
        CHECK(agreement.optic_pixels > 500);
        CHECK(agreement.off_edge == 0);
    }
}
