// The fits' own Levenberg-Marquardt against Ceres Solver: the same pairs, the same minimum. Ceres takes
// images from complete searches that are then followed, and their derivatives from paths that are projected;
// fits follow rays.
#include <trilens/ceres.h>
#include <trilens/fit.h>

#include <algorithm>
#include <cmath>

#include "inverse/fit_scenes.h"
#include "scene/read/override.h"
#include "support/test.h"  // Ceres' headers take CHECK for their own: REQUIRE is the tests'

using namespace trilens;
using trilens_test::make_pairs;
using trilens_test::with_noise;

namespace {

struct SolverCase {
    const char* name;
    std::string json, word;
    std::vector<std::string> free;
    std::vector<SceneOverride> start;
    /// A quaternion's place in Ceres' block, and how many numbers stand before it.
    std::optional<int> quaternion = {};
};

/// A calibrated lens before the mirror ball of fit_scenes.
std::string distorting_scene() {
    std::string json = trilens_test::ball_scene();
    const std::string plain = R"("type": "perspective", "yfov": 40)";
    return json.replace(json.find(plain), plain.size(),
                        R"("type": "opencv", "model": "pinhole", "fx": 900, "fy": 900, "cx": 512, "cy": 384,
                           "distortion": [-0.22, 0.06, 0.0008, -0.0005])");
}

std::vector<SolverCase> solver_cases() {
    return {{"a cage's pose",
             trilens_test::saddle_scene(),
             "R",
             {"/meshes/0/transform/translate", "/meshes/0/transform/rotate"},
             {{"/meshes/0/transform/translate", "[0.055, -0.028, 0.016]"},
              {"/meshes/0/transform/rotate", "[0.052, -0.102, 0.021, 1]"}},
             3},
            {"a lens: where it is, how large, and its index",
             trilens_test::glass_scene(),
             "TT",
             {"/meshes/0/primitive/center", "/meshes/0/primitive/radius", "/materials/1/ior"},
             {{"/meshes/0/primitive/center", "[0.08, -0.02, 0]"}, {"/materials/1/ior", "1.47"}}},
            {"a camera: focal lengths and distortion",
             distorting_scene(),
             "R",
             {"/cameras/0/fx", "/cameras/0/fy", "/cameras/0/distortion"},
             {{"/cameras/0/fx", "890"}, {"/cameras/0/distortion", "[-0.2, 0.05, 0, 0]"}}}};
}

/// Half the sum of the losses, as Ceres counts it, of residuals in standard deviations.
double cost_of_fit(const FitResult& found, const FitRequest& request) {
    const double most = request.huber;
    double sum = 0;
    for (const FittedPair& pair : found.pairs) {
        const double off = length(pair.residual) / request.sigma;
        sum += off <= most ? off * off : (2 * off - most) * most;
    }
    return sum / 2;
}

struct CeresAnswer {
    std::vector<SceneNumber> numbers;
    double cost = 0;
};

CeresAnswer by_ceres(const SolverCase& one, std::span<const Correspondence> pairs,
                     const FitRequest& request) {
    CeresImages images(parse_scene(one.json, "", one.start), one.free, EventWord(one.word));
    for (const Correspondence& pair : pairs)
        images.add({.pixel = pair.pixel, .point = pair.point, .sigma = request.sigma});
    if (one.quaternion) {  // the file's may have any length
        double* q = images.block() + *one.quaternion;
        const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        for (int k = 0; k < 4; ++k) q[k] /= size;
    }
    ceres::Problem::Options options;
    options.evaluation_callback = &images;
    ceres::Problem problem(options);
    images.add_to(problem, std::isfinite(request.huber) ? new ceres::HuberLoss(request.huber) : nullptr);
    if (one.quaternion)
        problem.SetManifold(
            images.block(),
            new ceres::ProductManifold<ceres::EuclideanManifold<3>, ceres::EigenQuaternionManifold>{});
    ceres::Solver::Options how;
    how.linear_solver_type = ceres::DENSE_QR;
    how.function_tolerance = 1e-14;
    how.parameter_tolerance = 1e-12;
    how.gradient_tolerance = 1e-14;
    how.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(how, &problem, &summary);
    INFO(summary.BriefReport());
    REQUIRE(summary.IsSolutionUsable());
    REQUIRE(images.lost() == 0);
    return {images.numbers(), summary.final_cost};
}

/// Of the fitted scene's document, at Ceres' numbers: a turn's quaternion up to its length and sign.
void check_same(const SolverCase& one, const FitResult& found, const CeresAnswer& ceres) {
    std::vector<SceneNumber> own = find_numbers(parse_scene(found.document), one.free);
    REQUIRE(own.size() == ceres.numbers.size());
    if (one.quaternion) {
        double size = 0, along = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t at = static_cast<std::size_t>(*one.quaternion) + k;
            size += own[at].value * own[at].value;
            along += own[at].value * ceres.numbers[at].value;
        }
        for (std::size_t k = 0; k < 4; ++k)
            own[static_cast<std::size_t>(*one.quaternion) + k].value *=
                (along < 0 ? -1 : 1) / std::sqrt(size);
    }
    for (std::size_t k = 0; k < own.size(); ++k) {
        INFO(ceres.numbers[k].pointer << ": " << own[k].value << ", by Ceres " << ceres.numbers[k].value);
        // At equal costs numbers that the pairs fix weakly, as distortion, rest less exactly.
        REQUIRE(std::abs(own[k].value - ceres.numbers[k].value) <
                1e-5 * std::max(1.0, std::abs(own[k].value)));
    }
}

}  // namespace

TEST_CASE("own least squares and Ceres' end at the same minimum", "[ceres][oracle]") {
    for (const SolverCase& one : solver_cases()) {
        const std::vector<Correspondence> exact = make_pairs(parse_scene(one.json), 40, one.word);
        for (const bool has_outliers : {false, true}) {
            // The cage ends: images of outlying pixels leave it on the way, and a lost one pulls nowhere.
            if (has_outliers && one.quaternion) continue;
            INFO(one.name << (has_outliers ? ", outliers under Huber's loss" : ""));
            std::vector<Correspondence> pairs = with_noise(exact, 0.5, 7);
            FitRequest request;
            request.free = one.free;
            request.path = one.word;
            request.huber = has_outliers ? 4 : std::numeric_limits<double>::infinity();
            if (has_outliers)  // inward, so that their rays still meet the optic
                for (std::size_t k = 0; k < pairs.size(); k += 13)
                    pairs[k].pixel += 7.0 * normalize(Vec2(512, 384) - pairs[k].pixel);
            const FitResult found = fit_scene(parse_scene(one.json, "", one.start), pairs, request);
            REQUIRE(found.converged);
            REQUIRE(found.lost == 0);
            const CeresAnswer ceres = by_ceres(one, pairs, request);
            const double own_cost = cost_of_fit(found, request);
            INFO("costs " << own_cost << " and " << ceres.cost);
            REQUIRE(own_cost > 1);
            REQUIRE(std::abs(own_cost - ceres.cost) < 1e-9 * own_cost);
            check_same(one, found, ceres);
        }
    }
}
