// Fits: parameters come back from projected points, and what the fit says of its own error is true.
#include <algorithm>
#include <cmath>
#include <map>

#include "base/util/format.h"
#include "fit_scenes.h"
#include "inverse/fit/fit.h"
#include "inverse/fit/fit_problem.h"
#include "scene/read/override.h"
#include "support/test.h"
#include "trilens/project.h"
#include "trilens/scene.h"

using namespace trilens;
using trilens_test::make_pairs;
using trilens_test::with_noise;

namespace {

struct FitCase {
    const char* name;
    std::string json, word;
    std::vector<SceneOverride> start;
    std::vector<std::string> free;
};

std::vector<FitCase> fit_cases() {
    return {{"mirror ball: centre, radius",
             trilens_test::ball_scene(),
             "R",
             {{"/meshes/0/primitive/center", "[0.1, 0.05, -0.08]"}, {"/meshes/0/primitive/radius", "0.93"}},
             {"/meshes/0/primitive/center", "/meshes/0/primitive/radius"}},
            {"mirror ball: centre, radius, focal length",
             trilens_test::ball_scene(),
             "R",
             {{"/meshes/0/primitive/center", "[0.1, 0.05, -0.08]"}, {"/cameras/0/yfov", "42"}},
             {"/meshes/0/primitive/center", "/meshes/0/primitive/radius", "/cameras/main/yfov"}},
            {"glass ball: centre, radius, index",
             trilens_test::glass_scene(),
             "TT",
             {{"/meshes/0/primitive/center", "[0.1, 0.05, -0.08]"}, {"/materials/glass/ior", "1.42"}},
             {"/meshes/0/primitive/center", "/meshes/0/primitive/radius", "/materials/glass/ior"}},
            {"saddle: pose",
             trilens_test::saddle_scene(),
             "R",
             {{"/meshes/0/transform/translate", "[0.1, 0.05, -0.08]"},
              {"/meshes/0/transform/rotate", "[0.08, -0.06, 0.05, 1]"}},
             {"/meshes/saddle/transform/translate", "/meshes/saddle/transform/rotate"}}};
}

/// 60 pairs of each case, made once.
const std::vector<Correspondence>& pairs_of(const FitCase& one) {
    static std::map<std::string, std::vector<Correspondence>> made;
    std::vector<Correspondence>& pairs = made[one.name];
    if (pairs.empty()) pairs = make_pairs(parse_scene(one.json), 60, one.word);
    return pairs;
}

/// How far the fitted numbers are from those of the truth, turns included.
double worst_error(const FitResult& found, const Scene& truth, const std::string& json) {
    const Scene fitted = parse_scene(json, "", found.changes);
    double worst = 0;
    const Mesh &a = truth.meshes[0], &b = fitted.meshes[0];
    if (a.primitive) {
        worst = std::max(length(a.primitive->center - b.primitive->center),
                         std::abs(std::get<SpherePrimitive>(a.primitive->kind).radius -
                                  std::get<SpherePrimitive>(b.primitive->kind).radius));
    }
    for (std::size_t k = 0; k < a.cage.points.size(); ++k)
        worst = std::max(worst, length(a.cage.points[k] - b.cage.points[k]));
    worst = std::max(worst, std::abs(std::get<PerspectiveCamera>(truth.cameras[0].kind).yfov -
                                     std::get<PerspectiveCamera>(fitted.cameras[0].kind).yfov) /
                                40);
    for (std::size_t k = 0; k < truth.materials.size(); ++k)
        worst = std::max(worst, std::abs(truth.materials[k].ior - fitted.materials[k].ior));
    return worst;
}

}  // namespace

TEST_CASE("a fit of projected points gives the scene's parameters back", "[inverse][law]") {
    for (const FitCase& one : fit_cases()) {
        INFO(one.name);
        const Scene truth = parse_scene(one.json);
        const std::vector<Correspondence> pairs = pairs_of(one);
        FitRequest request;
        request.free = one.free;
        const FitResult found = fit_scene(parse_scene(one.json, "", one.start), pairs, request);
        CHECK(found.converged);
        CHECK(found.used == pairs.size());
        CHECK(found.rank == found.parameters.size());
        CHECK(found.rms_start > 5);
        CHECK(found.rms < 1e-7);
        CHECK(worst_error(found, truth, one.json) < 1e-8);
    }
}

TEST_CASE("the ray residual and the image residual lead to the same parameters", "[inverse][law]") {
    for (const FitCase& one : fit_cases()) {
        INFO(one.name);
        const Scene scene = parse_scene(one.json);
        std::vector<FitPair> pairs;
        for (const Correspondence& from : std::span(pairs_of(one)).first(30))
            pairs.push_back({from.pixel, from.point, 0.5, 0, one.word, from.pixel, one.word.size()});
        Json document = resolved_json(scene);
        const std::vector<FitParameter> free = find_parameters(document, one.free, "scene", 3);
        double side = 0.003;  // near enough for images, which are looked for near their pixels
        for (const FitParameter& parameter : free)
            move_parameter(part_of(document, parameter), parameter, (side = -side) * parameter.scale);
        const Scene start = parse_scene(document.dump());
        std::vector<std::vector<double>> found;
        for (const FitResidual residual : {FitResidual::kRay, FitResidual::kImage}) {
            FitProblem problem(start, document, free, pairs);
            problem.huber = 100;
            problem.residual = residual;
            LeastSquaresParams patient;
            patient.most_iterations = 300;
            minimise(problem.least_squares(), patient);
            found.emplace_back();
            for (const FitParameter& parameter : free)
                found.back().push_back(parameter_value(problem.document(), parameter, document));
        }
        for (std::size_t p = 0; p < free.size(); ++p) {
            INFO(free[p].name);
            CHECK(std::abs(found[0][p] - found[1][p]) < 1e-5 * free[p].scale);
        }
    }
}

TEST_CASE("a fit's Jacobian is the difference of projected images", "[inverse][law]") {
    for (const FitCase& one : fit_cases()) {
        INFO(one.name);
        const Scene scene = parse_scene(one.json);
        std::vector<FitPair> pairs;
        std::vector<Vec3> points;
        for (const Correspondence& from : std::span(pairs_of(one)).first(12)) {
            pairs.push_back({from.pixel, from.point, 1, 0, one.word, from.pixel, one.word.size()});
            points.push_back(from.point);
        }
        Json document = resolved_json(scene);
        const std::vector<FitParameter> free = find_parameters(document, one.free, "scene", 3);
        FitProblem problem(scene, document, free, pairs);
        problem.residual = FitResidual::kImage;
        const Linearisation at = problem.linearise();
        // A cage's search is built anew for every pose: one turn tells.
        const bool is_cage = one.name[0] == 's';
        for (std::size_t p = is_cage ? 4 : 0; p < free.size(); p += is_cage ? 6 : 1) {
            const double step = 2e-5 * free[p].scale;
            std::vector<std::vector<PointProjection>> seen;
            for (const double amount : {-step, step}) {
                Json moved = document;
                move_parameter(part_of(moved, free[p]), free[p], amount);
                seen.push_back(Renderer(parse_scene(moved.dump())).project(points));
            }
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                std::array<Vec2, 2> place{};
                for (std::size_t side = 0; side < 2; ++side) {
                    double nearest = 1e9;
                    for (const WorldImage& image : seen[side][i].images)
                        if (image.path != Path::kDirect && length(image.pixel - pairs[i].pixel) < nearest) {
                            nearest = length(image.pixel - pairs[i].pixel);
                            place[side] = image.pixel;
                        }
                    REQUIRE(nearest < 50);
                }
                const Vec2 difference = (place[1] - place[0]) / (2 * step);
                const Vec2 implicit = Vec2(at.jacobian(2 * i, p), at.jacobian(2 * i + 1, p)) / free[p].scale;
                CHECK(length(difference - implicit) <= 2e-5 * length(implicit) + 1e-3 / free[p].scale);
            }
        }
    }
}

TEST_CASE("a fit's covariance is that of fits to noisy pixels", "[inverse][law]") {
    const FitCase one = fit_cases()[0];
    const Scene truth = parse_scene(one.json);
    const std::vector<Correspondence> pairs = pairs_of(one);
    FitRequest request;
    request.free = one.free;
    request.sigma = 0.5;
    const FitResult exact = fit_scene(truth, pairs, request);
    constexpr unsigned kDraws = 200;
    std::vector<double> squares(exact.parameters.size());
    double noise = 0;
    for (unsigned draw = 0; draw < kDraws; ++draw) {
        const FitResult found = fit_scene(truth, with_noise(pairs, 0.5, 100 + draw), request);
        for (std::size_t p = 0; p < squares.size(); ++p)
            squares[p] += std::pow(found.parameters[p].value - exact.parameters[p].value, 2) / kDraws;
        noise += found.noise / kDraws;
    }
    for (std::size_t p = 0; p < squares.size(); ++p) {
        INFO(exact.parameters[p].pointer);
        // A standard deviation of 200 draws is itself off by 5 % (one sigma).
        CHECK(std::abs(std::sqrt(squares[p]) / exact.parameters[p].sigma - 1) < 0.2);
    }
    CHECK(std::abs(noise / 0.5 - 1) < 0.05);
}

TEST_CASE("outliers are told, and leave the parameters where they were", "[inverse]") {
    const FitCase one = fit_cases()[0];
    const Scene truth = parse_scene(one.json);
    std::vector<Correspondence> pairs = pairs_of(one);
    for (std::size_t i = 0; i < 60; i += 12) pairs[i].pixel += Vec2(40, -25);
    pairs[7].pixel = {2, 2};  // beside the ball
    FitRequest request;
    request.free = one.free;
    const FitResult found = fit_scene(parse_scene(one.json, "", one.start), pairs, request);
    CHECK(found.outliers + found.lost == 6);
    CHECK(found.pairs[0].state == PairState::kOutlier);
    CHECK(found.pairs[7].state != PairState::kUsed);
    CHECK(worst_error(found, truth, one.json) < 0.04);
    CHECK(std::any_of(found.warnings.begin(), found.warnings.end(), [&](const std::string& warning) {
        return warning.find(fmt::format("{} of 60 pairs are outliers", found.outliers)) == 0 &&
               warning.find("pull a little") != std::string::npos;
    }));
}

TEST_CASE("what no pair tells of is named: a body's turn about its axis, and two names of one motion",
          "[inverse][law]") {
    std::string json = trilens_test::ball_scene();
    const std::string sphere =
        R"("primitive": {"type": "sphere", "center": [0.05, -0.03, 0.02], "radius": 1})";
    json.replace(json.find(sphere), sphere.size(),
                 R"("primitive": {"type": "paraboloid", "center": [0, 0, 0], "axis": [0, 0, -1], "radius": 1,
                    "focalLength": 0.6}, "transform": {"translate": [0.02, 0.01, 0.5]})");
    const Scene scene = parse_scene(json);
    const std::vector<Correspondence> pairs = make_pairs(scene, 30, "R");
    FitRequest request;
    request.free = {"/meshes/0/transform/translate", "/meshes/0/transform/rotate"};
    const FitResult found = fit_scene(scene, pairs, request);
    CHECK(found.rank == 5);
    REQUIRE(found.undetermined.size() == 1);
    CHECK(found.undetermined[0] == "turning /meshes/0 about the axis (0, 0, 1)");
    CHECK(found.parameters[5].sigma == 0);

    request.free = {"/meshes/0/primitive/center/0", "/meshes/0/transform/translate"};
    const FitResult twice = fit_scene(scene, pairs, request);
    REQUIRE(twice.undetermined.size() == 1);
    CHECK(twice.undetermined[0].find("/meshes/0/primitive/center/0") != std::string::npos);
    CHECK(twice.undetermined[0].find("/meshes/0/transform/translate/0") != std::string::npos);

    // A prior settles it.
    request.priors = {{"/meshes/0/primitive/center/0", {0}, 0.01}};
    CHECK(fit_scene(scene, pairs, request).undetermined.empty());
}

TEST_CASE("several cameras fix what one does not, and pairs are matched by image as by ray", "[inverse]") {
    std::string json = trilens_test::ball_scene();
    const std::string end = "}],\n \"materials\"";
    REQUIRE(json.find(end) != std::string::npos);
    json.replace(json.find(end), end.size(), R"(}, {"name": "side", "type": "perspective", "yfov": 40,
        "lookAt": {"eye": [4, 1, 2], "at": [0, 0, 0]}}],
 "materials")");
    const Scene truth = parse_scene(json);
    std::vector<Correspondence> pairs = make_pairs(truth, 30, "R");
    std::vector<Vec3> points;
    for (int k = 0; k < 30; ++k)
        points.emplace_back(3 + 0.1 * (k % 6), -1 + 0.4 * (k / 6), 2 - 0.2 * (k % 5));
    ProjectRequest of_side;
    of_side.frame.camera = 1;
    const std::vector<PointProjection> seen = Renderer(truth).project(points, of_side);
    for (std::size_t k = 0; k < points.size(); ++k)
        for (const WorldImage& image : seen[k].images)
            if (image.path == Path::kReflect && image.inside) {
                Correspondence pair;
                pair.pixel = image.pixel, pair.point = points[k], pair.camera = "side";
                pairs.push_back(pair);
            }
    REQUIRE(pairs.size() > 45);
    FitRequest request;
    request.free = {"/meshes/0/primitive/center", "/meshes/0/primitive/radius", "/cameras/side/yfov"};
    const std::vector<SceneOverride> start{{"/meshes/0/primitive/center", "[0.08, 0, -0.02]"},
                                           {"/cameras/side/yfov", "41"}};
    const FitResult by_ray = fit_scene(parse_scene(json, "", start), pairs, request);
    CHECK(by_ray.used == pairs.size());
    CHECK(by_ray.rms < 1e-7);
    CHECK(std::abs(by_ray.parameters[4].value - 40) < 1e-7);
    request.match = FitMatch::kNearest;
    const FitResult by_image = fit_scene(parse_scene(json, "", start), pairs, request);
    CHECK(by_image.rms < 1e-7);
    for (std::size_t p = 0; p < by_ray.parameters.size(); ++p)
        CHECK(std::abs(by_ray.parameters[p].value - by_image.parameters[p].value) < 1e-7);
}

TEST_CASE("what cannot be fitted is refused with its place", "[inverse][bad-input]") {
    const Scene scene = parse_scene(trilens_test::ball_scene());
    std::vector<Correspondence> pairs = make_pairs(scene, 6, "R");
    FitRequest request;
    const auto refusal_in = [&](const Scene& in, const std::string& pointer) {
        request.free = {pointer};
        try {
            fit_scene(in, pairs, request);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    const auto refusal = [&](const std::string& pointer) { return refusal_in(scene, pointer); };
    CHECK(refusal("/meshes/0/name").find("no number") != std::string::npos);
    CHECK(refusal("/meshes/0/primitive").find("no number") != std::string::npos);
    CHECK(refusal("/meshes/nobody/primitive/radius").find("no entry 'nobody'") != std::string::npos);
    CHECK(refusal("/meshes/0/primitive/radios").find("radios") != std::string::npos);
    CHECK(refusal("/film/width").find("no number of a camera") != std::string::npos);
    CHECK(refusal("meshes").find("must begin with '/'") != std::string::npos);
    // A default that the scene does not have, for its mesh is no primitive.
    for (const char* pointer : {"/meshes/0/primitive/radius", "/meshes/0/primitive/center"})
        CHECK(refusal_in(parse_scene(trilens_test::saddle_scene()), pointer)
                  .find(std::string(pointer) + ": is not in the scene") != std::string::npos);

    const auto refusal_with = [&](const std::string& json, const SceneOverride& change) {
        return refusal_in(parse_scene(json, "", std::span(&change, 1)), "/meshes/0/transform/translate");
    };
    CHECK(refusal_with(trilens_test::saddle_scene(), {"/meshes/0/subdivisionScheme", "\"none\""})
              .find("/meshes/0/subdivisionScheme: \"none\"") != std::string::npos);
    CHECK(refusal_with(trilens_test::ball_scene(), {"/meshes/0/normals", R"({"type": "noise"})"})
              .find("/meshes/0/normals: ") != std::string::npos);

    const SceneOverride around_eye{"/meshes/0/primitive/radius", "40"};
    CHECK_THROWS_AS(refusal_with(trilens_test::ball_scene(), around_eye), ComputationError);

    request.free = {"/meshes/0/primitive/center", "/meshes/0/primitive/radius"};
    const std::vector<Correspondence> one{pairs[0]};
    CHECK_THROWS_AS(fit_scene(scene, one, request), InputError);
    for (Correspondence& pair : pairs) pair.pixel = {1, 1};
    CHECK_THROWS_AS(fit_scene(scene, pairs, request), ComputationError);
    request.path = "RX";
    CHECK_THROWS_AS(fit_scene(scene, pairs, request), UsageError);

    CHECK_THROWS_AS(parse_correspondences("x,y,X,Y\n1,2,3,4\n", "p.csv"), InputError);
    CHECK_THROWS_AS(parse_correspondences("1,2,3,4,five\n", "p.csv"), InputError);
    CHECK_THROWS_AS(parse_correspondences("x,y,X,Y,Z,sigma\n1,2,3,4,5,0\n", "p.csv"), InputError);
    CHECK_THROWS_AS(parse_correspondences("# nothing\n", "p.csv"), InputError);
    const std::vector<Correspondence> read =
        parse_correspondences("X, Y, Z, x, y, camera\r\n1,2,3,4,5,main\r\n\n", "p.csv");
    REQUIRE(read.size() == 1);
    CHECK(read[0].point == Vec3(1, 2, 3));
    CHECK(read[0].pixel == Vec2(4, 5));
    CHECK(read[0].camera == "main");

    request.path = "R";
    const auto told = [&](const std::string& text) {
        try {
            fit_scene(scene, parse_correspondences(text, "p.csv"), request);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    const std::string cells = "\n1,2,3,4,5,";
    CHECK(told("x,y,X,Y,Z,camera" + cells + cells + "side\n") ==
          "p.csv: line 3: there is no camera \"side\"; known: main");
    CHECK(told("x,y,X,Y,Z,path" + cells + "R" + cells + "RX\n").find("p.csv: line 3: a path is D") == 0);
    request.match = FitMatch::kId;
    CHECK(told("1,2,3,4,5\n") == "p.csv: line 1: names no image, which a match by id asks for");
    CHECK(told("x,y,X,Y,Z,image" + cells + "0" + cells + "\n").find("p.csv: line 3: names no image") == 0);
    CHECK_THROWS_AS(fit_scene(scene, pairs, request), UsageError);
}
