// Fits of cameras that stand in glass: pairs of exact rays, of Snell's law at a flat surface, and projected
// images are what a fit has there.
#include <algorithm>
#include <cmath>

#include "base/util/format.h"
#include "inverse/fit/fit.h"
#include "inverse/fit/fit_problem.h"
#include "scene/read/override.h"
#include "support/test.h"
#include "trilens/project.h"
#include "trilens/scene.h"

using namespace trilens;

namespace {

/// A camera in glass; where a fit of the free numbers begins beside the scene.
struct InGlass {
    const char* name;
    std::string json, word;
    std::vector<SceneOverride> start;
    std::vector<std::string> free;
};

std::string scene_of(const std::string& camera, const std::string& meshes) {
    return R"({"version": 1, "film": {"width": 320, "height": 240}, "render": {"maxDepth": 4},
 "cameras": [{"name": "main", )" +
           camera + R"(}],
 "materials": [{"name": "chrome", "metallicFactor": 1}, {"name": "water", "transmissionFactor": 1, "ior": 1.33},
               {"name": "glass", "transmissionFactor": 1, "ior": 1.5}, {"name": "air", "transmissionFactor": 1, "ior": 1}],
 "meshes": [)" +
           meshes + "]}";
}

std::string sphere(const std::string& name, const std::string& place, const std::string& more) {
    return R"({"name": ")" + name + R"(", "role": "optic", "primitive": {"type": "sphere", )" + place +
           "}, " + more + "}";
}

/// A box of eight corners, a pool with its surface at y = 0, or a smooth body that it rules.
std::string box(const std::string& name, const std::string& more) {
    return R"({"name": ")" + name + R"(", "role": "optic", "points": [[-4,-3,-4],[4,-3,-4],[4,-3,4],[-4,-3,4],
        [-4,0,-4],[4,0,-4],[4,0,4],[-4,0,4]], "faceVertexCounts": [4,4,4,4,4,4],
        "faceVertexIndices": [0,1,2,3, 7,6,5,4, 4,5,1,0, 5,6,2,1, 6,7,3,2, 7,4,0,3], )" +
           more + "}";
}

std::string pool() {
    return box("pool", R"("material": "water", "subdivisionScheme": "bilinear")");
}

const std::string kLooksUp =
    R"("type": "perspective", "yfov": 18, "lookAt": {"eye": [0.3, -2.6, 1.1], "at": [0.05, -1, 0.1]})";

std::vector<InGlass> cameras_in_glass() {
    const std::string ball = sphere("ball", R"("center": [0.05, -1, 0.1], "radius": 0.6)",
                                    R"("material": "glass", "priority": 1)");
    const std::string bubble = sphere("bubble", R"("center": [0.02, -0.01, 0.1], "radius": 1)",
                                      R"("material": "air", "priority": 1)");
    return {
        {"under water: a glass ball's centre and radius, and both indices",
         scene_of(kLooksUp, ball + "," + pool()),
         "TTT",
         {{"/meshes/0/primitive/center", "[0.07, -1.02, 0.09]"}, {"/materials/water/ior", "1.32"}},
         {"/meshes/0/primitive/center", "/meshes/0/primitive/radius", "/materials/glass/ior",
          "/materials/water/ior"}},
        {"under water, by parallel rays: a glass ball's centre and radius",
         scene_of(
             R"("type": "orthographic", "ymag": 0.3, "lookAt": {"eye": [0.25, -2.6, 0.3], "at": [0.05, -1, 0.1]})",
             ball + "," + pool()),
         "TTT",
         {{"/meshes/0/primitive/center", "[0.07, -1.02, 0.09]"}},
         {"/meshes/0/primitive/center", "/meshes/0/primitive/radius"}},
        {"under water: a mirror's centre, the camera's place and the index",
         scene_of(
             R"("type": "perspective", "yfov": 10, "lookAt": {"eye": [0.3, -0.9, 2.1], "at": [0.1, -0.8, 0.52]})",
             sphere("mirror", R"("center": [0.05, -1.2, 0.1], "radius": 0.6)", R"("material": "chrome")") +
                 "," + pool()),
         "RT",
         {{"/meshes/0/primitive/center", "[0.06, -1.22, 0.09]"}, {"/materials/water/ior", "1.3"}},
         {"/meshes/0/primitive/center", "/materials/water/ior", "/cameras/0/yfov"}},
        {"in a ball of glass, in a bubble of air: its centre and radius, and the index around",
         scene_of(
             R"("type": "perspective", "yfov": 40, "lookAt": {"eye": [0.3, 0.2, 0.4], "at": [0, 0, -1]})",
             bubble + "," +
                 sphere("dome", R"("center": [0.1, 0, 0], "radius": 1.6)", R"("material": "glass")")),
         "TT",
         {{"/meshes/0/primitive/center", "[0.03, 0, 0.08]"}, {"/meshes/0/primitive/radius", "0.97"}},
         {"/meshes/0/primitive/center", "/meshes/0/primitive/radius", "/materials/glass/ior"}},
        {"in a smooth body that moves: its place, and the camera's",
         scene_of(
             R"("type": "perspective", "yfov": 7, "lookAt": {"eye": [0.3, -1.2, 0.9], "at": [0.1, -1.3, -0.8]})",
             box("body", R"("material": "glass", "transform": {"translate": [0.1, 0, 0]})") + "," +
                 sphere("ball", R"("center": [0.1, -1.3, -0.8], "radius": 0.5)",
                        R"("material": "water", "priority": 1)")),
         "TTT",
         {{"/meshes/body/transform/translate", "[0.12, -0.03, 0.02]"}},
         {"/meshes/body/transform/translate", "/cameras/0/lookAt/eye"}}};
}

/// A camera at the skin of a ball of glass, within it or not, which looks through it.
InGlass at_skin(const std::string& eye, const std::string& word, const std::string& start) {
    return {
        "at the skin of a ball of glass",
        scene_of(R"("type": "perspective", "yfov": 30, "lookAt": {"eye": )" + eye + R"(, "at": [0, 0, 0]})",
                 sphere("ball", R"("radius": 2)", R"("material": "glass")")),
        word,
        {{"/cameras/0/lookAt/eye", start}},
        {"/cameras/0/lookAt/eye"}};
}

/// Pairs, and the paths of their exact rays as the scene has them.
struct ExactPairs {
    std::vector<Correspondence> pairs;
    std::vector<std::vector<PathEvent>> events;
};

/// What exact rays through every 20th pixel see some way behind the last of the word's optics.
ExactPairs exact_pairs(const InGlass& one) {
    const Scene scene = parse_scene(one.json);
    std::vector<Vec2> places;
    for (int y = 10; y < scene.film.height; y += 20)
        for (int x = 10; x < scene.film.width; x += 20) places.emplace_back(x, y);
    ShootRequest request;
    request.path = EventWord(one.word);
    const ShotRays shot = Renderer(scene).shoot(places, request);
    ExactPairs made;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const ShotRay& ray = shot.rays[i];
        if (!ray.followed()) continue;
        Correspondence pair;
        pair.pixel = places[i];
        pair.point = ray.origin + (4 + 0.1 * static_cast<double>(i % 7)) * ray.direction;
        made.pairs.push_back(pair);
        made.events.emplace_back(shot.events_of(ray).begin(), shot.events_of(ray).end());
    }
    return made;
}

/// How far a fit's numbers are from those of the scene that its pairs were made with.
double worst_error(const FitResult& fit, const std::string& json) {
    Json truth = resolved_json(parse_scene(json));
    double worst = 0;
    for (const FittedParameter& one : fit.parameters) {
        const std::vector<std::string> pointer{one.pointer};
        const std::vector<FitParameter> found = find_parameters(truth, pointer, "", 1);
        worst = std::max(worst, std::abs(one.value - parameter_value(truth, found[0], truth)));
    }
    return worst;
}

bool is_word(const WorldImage& image, const std::string& word) {
    std::string is;
    for (const Step& step : image.steps)
        if (step.event != Event::kPass) is += step.event == Event::kReflect ? 'R' : 'T';
    return is == word;
}

bool tells(const FitResult& fit, const std::string& what) {
    return std::ranges::any_of(
        fit.warnings, [&](const std::string& warning) { return warning.find(what) != std::string::npos; });
}

/// Where an eye under water, at y < 0, sees the surface y = 0 on the way to a point of the air, by Fermat.
Vec3 place_of_surface(const Vec3& eye, const Vec3& point, double ior) {
    const Vec2 across(point.x - eye.x, point.z - eye.z);
    const double whole = length(across);
    double low = 0, high = whole;
    for (int k = 0; k < 200; ++k) {
        const double way = 0.5 * (low + high), rest = whole - way;
        const bool is_far = ior * way / std::hypot(way, eye.y) > rest / std::hypot(rest, point.y);
        (is_far ? high : low) = way;
    }
    return {eye.x + low / whole * across.x, 0, eye.z + low / whole * across.y};
}

}  // namespace

TEST_CASE("a fit leads pairs of exact rays back to the truth of a camera in glass", "[inverse][law]") {
    for (const InGlass& one : cameras_in_glass()) {
        INFO(one.name);
        const std::vector<Correspondence> pairs = exact_pairs(one).pairs;
        REQUIRE(pairs.size() > 40);
        FitRequest request;
        request.free = one.free;
        for (const char* word : {"", one.word.c_str()}) {
            INFO("path \"" << word << "\"");
            request.path = word;
            const FitResult found = fit_scene(parse_scene(one.json, "", one.start), pairs, request);
            CHECK(found.used == pairs.size());
            CHECK(found.rank == found.parameters.size());
            CHECK(found.rms_start > 1);
            CHECK(found.rms < 1e-7);
            CHECK(worst_error(found, one.json) < 1e-7);
            CHECK_FALSE(tells(found, "does not end in what it began in"));
        }
    }
}

TEST_CASE("a fit's Jacobian is the difference of images that are projected into glass", "[inverse][law]") {
    for (const InGlass& one : cameras_in_glass()) {
        INFO(one.name);
        const Scene scene = parse_scene(one.json);
        const ExactPairs all = exact_pairs(one);
        std::vector<FitPair> pairs;
        std::vector<Vec3> points;
        std::vector<ImageStart> starts;
        for (std::size_t i = 0; i < all.pairs.size(); i += 7) {
            const auto& [pixel, point] = std::pair(all.pairs[i].pixel, all.pairs[i].point);
            starts.push_back({points.size(), all.events[i], pixel});
            pairs.push_back({pixel, point, 1, 0, one.word, pixel, one.word.size()});
            points.push_back(point);
        }
        Json document = resolved_json(scene);
        const std::vector<FitParameter> free = find_parameters(document, one.free, "scene", 1);
        FitProblem problem(scene, document, free, pairs);
        problem.residual = FitResidual::kImage;
        const Linearisation at = problem.linearise();
        for (const double residual : at.residuals) CHECK(std::abs(residual) < 1e-7);
        for (std::size_t p = 0; p < free.size(); ++p) {
            INFO(free[p].name);
            const double step = 1e-5 * free[p].scale;
            std::vector<std::vector<std::optional<WorldImage>>> seen;
            for (const double amount : {-step, step, -2 * step, 2 * step}) {
                Json moved = document;
                move_parameter(part_of(moved, free[p]), free[p], amount);
                seen.push_back(Renderer(parse_scene(moved.dump())).refine(points, starts));
            }
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                REQUIRE((seen[0][i] && seen[1][i] && seen[2][i] && seen[3][i]));
                const Vec2 near = seen[1][i]->pixel - seen[0][i]->pixel,
                           far = seen[3][i]->pixel - seen[2][i]->pixel;
                const Vec2 difference = (8.0 * near - far) / (12 * step);
                const Vec2 implicit = Vec2(at.jacobian(2 * i, p), at.jacobian(2 * i + 1, p)) / free[p].scale;
                CHECK(length(difference - implicit) <= 1e-5 * length(implicit) + 1e-3 / free[p].scale);
            }
        }
    }
}

TEST_CASE("what project lists for a camera in glass is what a fit holds against its pairs",
          "[inverse][law]") {
    for (const InGlass& one : cameras_in_glass()) {
        if (one.word.size() > 2) continue;  // of paths over many optics it may miss some, and takes long
        INFO(one.name);
        const Scene scene = parse_scene(one.json);
        std::vector<Correspondence> pairs;
        std::vector<Vec3> points;
        const std::vector<Correspondence> all = exact_pairs(one).pairs;
        for (std::size_t i = 0; i < all.size(); i += 20)
            pairs.push_back(all[i]), points.push_back(all[i].point);
        const std::vector<PointProjection> found = Renderer(scene).project(points);
        for (std::size_t i = 0; i < pairs.size(); ++i)
            CHECK(std::ranges::any_of(found[i].images, [&](const WorldImage& image) {
                return is_word(image, one.word) && length(image.pixel - pairs[i].pixel) < 1e-7;
            }));
    }
}

TEST_CASE("a camera under water is found by Snell's law at the flat surface", "[inverse][oracle][law]") {
    const Vec3 eye(0.2, -1.2, 2.5);
    const std::string json = scene_of(
        R"("type": "perspective", "yfov": 60, "lookAt": {"eye": [0.2, -1.2, 2.5], "at": [0.1, 1, 0.3]})",
        pool());
    const Vec3 ahead = normalize(Vec3(0.1, 1, 0.3) - eye), right = normalize(cross(ahead, Vec3(0, 1, 0))),
               up = cross(right, ahead);
    const double focal = 120 / std::tan(std::acos(-1.0) / 6);
    std::vector<Correspondence> pairs;
    for (int k = 0; k < 49; ++k) {
        Correspondence pair;
        pair.point = {-3 + k % 7, 0.5 + 0.05 * k, -3.0 + k / 7};
        const Vec3 to = place_of_surface(eye, pair.point, 1.33) - eye;
        pair.pixel = Vec2(160, 120) + focal / dot(to, ahead) * Vec2(dot(to, right), -dot(to, up));
        if (std::abs(pair.pixel.x - 160) < 160 && std::abs(pair.pixel.y - 120) < 120) pairs.push_back(pair);
    }
    REQUIRE(pairs.size() > 25);
    FitRequest request;
    request.free = {"/cameras/0/lookAt/eye", "/materials/water/ior", "/cameras/0/yfov"};
    const std::vector<SceneOverride> start{{"/cameras/0/lookAt/eye", "[0.3, -1.1, 2.6]"},
                                           {"/materials/water/ior", "1.3"},
                                           {"/cameras/0/yfov", "58"}};
    for (const FitMatch match : {FitMatch::kRay, FitMatch::kNearest}) {
        request.match = match;
        const FitResult found = fit_scene(parse_scene(json, "", start), pairs, request);
        CHECK(found.used == pairs.size());
        CHECK(found.rms_start > 5);
        CHECK(found.rms < 1e-7);
        CHECK(worst_error(found, json) < 1e-8);
    }
}

TEST_CASE("a camera that a fit takes into glass or out of it sees from there, and the fit says so",
          "[inverse][law]") {
    const std::string in = "[0.1, 0.2, 1.9]", out = "[0.1, 0.2, 2.1]";
    for (const bool enters : {true, false}) {
        INFO((enters ? "into glass" : "out of it"));
        const InGlass one = enters ? at_skin(in, "T", out) : at_skin(out, "TT", in);
        const std::vector<Correspondence> pairs = exact_pairs(one).pairs;
        FitRequest request;
        request.free = one.free;
        const FitResult found = fit_scene(parse_scene(one.json, "", one.start), pairs, request);
        CHECK(found.used == pairs.size());
        CHECK(found.rms < 1e-7);
        CHECK(worst_error(found, one.json) < 1e-7);
        CHECK(tells(found,
                    fmt::format("/cameras/0 does not end in what it began in: rays of {0} of its {0} "
                                "pairs start in {1} now, and started in {2}",
                                pairs.size(), enters ? "\"ball\"" : "air", enters ? "air" : "\"ball\"")));
    }
}

TEST_CASE("of a camera that leaves its glass no image is taken for one from within", "[inverse][law]") {
    const InGlass one = at_skin("[0.1, 0.2, 1.9]", "T", "");
    const Scene scene = parse_scene(one.json);
    std::vector<FitPair> pairs;
    for (const Correspondence& from : exact_pairs(one).pairs)
        pairs.push_back({from.pixel, from.point, 1, 0, one.word, from.pixel, one.word.size()});
    Json document = resolved_json(scene);
    const std::vector<FitParameter> free = find_parameters(document, one.free, "scene", 1);
    FitProblem problem(scene, document, free, pairs);
    problem.residual = FitResidual::kImage;
    for (const double residual : problem.linearise().residuals) CHECK(std::abs(residual) < 1e-7);
    const std::vector<double> outwards{0, 0, 0.2}, within{0, 0, 0.01};
    const std::vector<double> outside = *problem.least_squares().residuals_after(outwards),
                              inside = *problem.least_squares().residuals_after(within);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        CHECK(Vec2(outside[2 * i], outside[2 * i + 1]) == Vec2(40, 0));  // as of a pair that is lost
        CHECK(length(Vec2(inside[2 * i], inside[2 * i + 1])) < 10);
    }
}

TEST_CASE("of images near a pixel a fit takes one that its ray follows, none behind other glass",
          "[inverse][law]") {
    // A calibrated dome, from whose bubble of air the outer skin alone has images beside the exact ones.
    const InGlass one{
        "dome",
        scene_of(R"("type": "perspective", "yfov": 70, "lookAt": {"eye": [0, 0, 0], "at": [0, 0, 1]})",
                 sphere("bubble", R"("center": [0.002, -0.001, 0.012], "radius": 0.0501)",
                        R"("material": "air", "priority": 1)") +
                     "," +
                     sphere("dome", R"("center": [0.002, -0.001, 0.012], "radius": 0.0571)",
                            R"("material": "glass")")),
        "TT",
        {{"/meshes/0/primitive/center", "[0.001, 0, 0.011]"}},
        {"/meshes/0/primitive/center"}};
    const std::vector<Correspondence> pairs = exact_pairs(one).pairs;
    FitRequest request;
    request.free = one.free;
    request.match = FitMatch::kNearest;
    const FitResult found = fit_scene(parse_scene(one.json, "", one.start), pairs, request);
    CHECK(found.rms < 1e-7);
    CHECK(worst_error(found, one.json) < 1e-8);
    for (const FittedPair& pair : found.pairs) CHECK(pair.path == "TT");
}

TEST_CASE("under water a fit finds by itself which pairs are of points there, and which of points in the air",
          "[inverse][law]") {
    const InGlass one = cameras_in_glass()[2];
    ExactPairs all = exact_pairs(one);
    for (std::size_t i = 0; i < all.pairs.size(); i += 2)
        all.pairs[i].point = 0.5 * (all.events[i][0].point + all.events[i][1].point);
    FitRequest request;
    request.free = one.free;
    const FitResult found = fit_scene(parse_scene(one.json, "", one.start), all.pairs, request);
    CHECK(found.rms < 1e-7);
    CHECK(worst_error(found, one.json) < 1e-7);
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
        CHECK(found.pairs[i].state == PairState::kUsed);
        CHECK(found.pairs[i].path == (i % 2 == 0 ? "R" : "RT"));
    }
}

TEST_CASE("a fit says where it is not sure what its camera stands in", "[inverse]") {
    std::string open = pool();
    for (const std::string gone : {"4,4,4,4,4,4", "0,1,2,3, "})
        open.replace(open.find(gone), gone.size(), gone[0] == '4' ? "4,4,4,4,4" : "");
    InGlass one = cameras_in_glass()[2];
    const std::vector<Correspondence> pairs = exact_pairs(one).pairs;
    FitRequest request;
    request.free = {"/meshes/0/primitive/center"};
    const std::string unsure = "inside of \"pool\" in some directions only";
    const auto with_pool = [&](const std::string& water, const std::string& more) {
        std::string json = one.json;
        return json.replace(json.find(pool()), pool().size(), water + more);
    };
    const std::string far =
        "," + sphere("far", R"("center": [50, 0, 0], "radius": 1)", R"("material": "glass")");
    CHECK(tells(fit_scene(parse_scene(with_pool(open, far)), pairs, request), unsure));
    CHECK_FALSE(tells(fit_scene(parse_scene(with_pool(pool(), far)), pairs, request), unsure));
    CHECK_FALSE(tells(fit_scene(parse_scene(with_pool(open, "")), pairs, request), unsure));
}
