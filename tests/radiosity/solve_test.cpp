// The radiosity equation: furnaces, both solvers, the balance of power, and threads.
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "base/util/parallel.h"
#include "radiosity/bake.h"
#include "radiosity/solve.h"
#include "radiosity/squares.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct Room {
    std::shared_ptr<const TriangleScene> scene;
    FormFactors factors;
    RadiosityProblem problem;

    explicit Room(int n = 3)
        : scene(std::make_shared<const TriangleScene>(closed_cube(n))),
          factors(scene, {FormFactorMethod::kHemicube, 32, 1, 1, 1e-6}) {
        for (const double one : triangle_areas(*scene)) problem.area.insert(problem.area.end(), 2, one);
        problem.reflectance.assign(problem.area.size(), Vec3(0));
        problem.exitance.assign(problem.area.size(), Vec3(0));
    }
    RowSource rows() const {
        return [this](Id side) { return factors.row(side); };
    }
    FormFactorMatrix matrix() const { return made_reciprocal(make_matrix(factors), problem.area); }
};

/// Walls of many colours, one of which shines.
Room coloured_room() {
    Room room;
    Draw draw(7);
    for (std::size_t s = 0; s < room.problem.area.size(); s += 2) {
        room.problem.reflectance[s] = {draw.uniform(0, 0.9), draw.uniform(0, 0.9), draw.uniform(0, 0.9)};
        if (s < 12) room.problem.exitance[s] = {3, 2, 1};
    }
    return room;
}

/// One grey, a floor that shines: how far light by rows as they are drawn is from that by the matrix.
double drawn_difference(int n) {
    Room room(n);
    for (std::size_t s = 0; s < room.problem.area.size(); s += 2) {
        room.problem.reflectance[s] = Vec3(0.6);
        if (s / 2 < 2 * static_cast<std::size_t>(n * n)) room.problem.exitance[s] = Vec3(1);
    }
    const RadiositySolution gathered = gather(room.problem, room.matrix(), {1e-12, 1000});
    const RadiositySolution drawn = shoot(room.problem, room.rows(), {1e-6, 1000000});
    double off = 0, sum = 0;
    for (std::size_t s = 0; s < room.problem.area.size(); ++s) {
        off += room.problem.area[s] * std::fabs(drawn.radiosity[s].x - gathered.radiosity[s].x);
        sum += room.problem.area[s] * gathered.radiosity[s].x;
    }
    return off / sum;
}

/// What comes in is absorbed, escapes or is on its way.
Vec3 missing_power(const RadiosityProblem& problem, const RadiositySolution& solution) {
    Vec3 sum = -solution.escaped - solution.unshot;
    for (std::size_t i = 0; i < problem.area.size(); ++i)
        sum += problem.area[i] *
               (problem.exitance[i] - (Vec3(1) - problem.reflectance[i]) * solution.arriving[i]);
    return sum;
}

}  // namespace

TEST_CASE("in a white furnace every side has E / (1 - rho), by both solvers", "[radiosity][law]") {
    Room room;
    const Vec3 rho(0.5, 0.8, 0), glow(1, 2, 3);
    for (std::size_t s = 0; s < room.problem.area.size(); s += 2) {
        room.problem.reflectance[s] = rho;
        room.problem.exitance[s] = glow;
    }
    const FormFactorMatrix matrix = room.matrix();
    const RadiositySolution gathered = gather(room.problem, matrix, {1e-12, 1000});
    const RadiositySolution shot =
        shoot(room.problem, [&](Id side) { return matrix.rows[side]; }, {1e-10, 1000000});
    CHECK(gathered.converged);
    CHECK(shot.converged);
    for (std::size_t s = 0; s < room.problem.area.size(); s += 2)
        for (int k = 0; k < 3; ++k) {
            CHECK(gathered.radiosity[s][k] == Approx(glow[k] / (1 - rho[k])).epsilon(1e-7));
            CHECK(shot.radiosity[s][k] == Approx(glow[k] / (1 - rho[k])).epsilon(1e-7));
        }
}

TEST_CASE("progressive refinement and Gauss-Seidel come to the same light", "[radiosity][law]") {
    const Room room = coloured_room();
    const FormFactorMatrix matrix = room.matrix();
    const RadiositySolution gathered = gather(room.problem, matrix, {1e-12, 1000});
    const RadiositySolution shot =
        shoot(room.problem, [&](Id side) { return matrix.rows[side]; }, {1e-10, 1000000});
    for (std::size_t s = 0; s < room.problem.area.size(); ++s)
        for (int k = 0; k < 3; ++k)
            CHECK(shot.radiosity[s][k] == Approx(gathered.radiosity[s][k]).epsilon(1e-7).margin(1e-9));
}

TEST_CASE("rows that are drawn one at a time come to the same light as patches become small",
          "[radiosity][law]") {
    const double coarse = drawn_difference(3), fine = drawn_difference(6);
    CHECK(coarse < 0.03);
    CHECK(fine < 0.8 * coarse);
}

TEST_CASE("no power is lost by shooting, whenever it ends, nor by gathering", "[radiosity][law]") {
    const Room room = coloured_room();
    for (const std::size_t most : {std::size_t{1}, std::size_t{40}, std::size_t{100000}}) {
        const RadiositySolution shot = shoot(room.problem, room.rows(), {1e-4, most});
        CHECK(length(missing_power(room.problem, shot)) < 1e-12);
        CHECK(shot.converged == (most == 100000));
    }
    const RadiositySolution gathered = gather(room.problem, room.matrix(), {1e-9, 1000});
    CHECK(length(missing_power(room.problem, gathered)) < 1e-7);
    CHECK(length(gathered.unshot) < 1e-6);
}

TEST_CASE("what is unshot falls to the tolerance", "[radiosity]") {
    const Room room = coloured_room();
    const RadiositySolution shot = shoot(room.problem, room.rows(), {1e-3, 100000});
    CHECK(shot.steps.front().unshot == Approx(1));
    CHECK(shot.steps.back().unshot <= 1e-3);
    CHECK(shot.steps[shot.steps.size() - 2].unshot > 1e-3);
    CHECK(std::is_sorted(shot.steps.begin(), shot.steps.end(),
                         [](const RadiosityStep& a, const RadiosityStep& b) { return a.rows < b.rows; }));
}

TEST_CASE("light has the same bytes for any number of threads", "[radiosity][law]") {
    const Room room = coloured_room();
    set_thread_count(1);
    const RadiositySolution one = shoot(room.problem, room.rows(), {1e-3, 100000});
    set_thread_count(4);
    const RadiositySolution four = shoot(room.problem, room.rows(), {1e-3, 100000});
    set_thread_count(0);
    CHECK(one.radiosity == four.radiosity);
    CHECK(one.escaped == four.escaped);
}

TEST_CASE("a solver that is told to stop does", "[radiosity]") {
    const Room room = coloured_room();
    const std::atomic<bool> stop = true;
    Progress progress;
    progress.cancel = &stop;
    CHECK_THROWS_AS(shoot(room.problem, room.rows(), {}, progress), Interrupted);
    CHECK_THROWS_AS(
        gather(room.problem, FormFactorMatrix{std::vector<FormFactorRow>(room.problem.area.size())}, {},
               progress),
        Interrupted);
    CHECK_THROWS_AS(make_matrix(room.factors, progress), Interrupted);
}

TEST_CASE("progressive refinement foretells its time within a factor of two", "[radiosity][law]") {
    Room room(7);
    for (std::size_t s = 0; s < room.problem.area.size(); s += 2) {
        room.problem.reflectance[s] = Vec3(0.5);
        if (s < 40) room.problem.exitance[s] = Vec3(1);
    }
    // A side's first row takes a while, then it is there.
    std::vector<FormFactorRow> made(room.problem.area.size());
    const RowSource rows = [&](Id side) {
        if (made[side].side.empty()) {
            made[side] = room.factors.row(side);
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return made[side];
    };
    const Stopwatch watch;
    std::vector<std::pair<double, double>> told;  // share, seconds
    Progress progress;
    progress.report = [&](double share) { told.emplace_back(share, watch.seconds()); };
    shoot(room.problem, rows, {1e-3, 100000}, progress);
    const double all = watch.seconds();
    std::size_t looked = 0;
    for (const auto& [share, seconds] : told) {
        if (share < 0.1 || seconds > 0.9 * all) continue;
        INFO(share << " after " << seconds << " s of " << all);
        CHECK(seconds / share < 2 * all);
        CHECK(seconds / share > 0.5 * all);
        ++looked;
    }
    CHECK(looked > 0);
}

TEST_CASE("the convergence is a plot", "[radiosity]") {
    BakeReport report;
    report.patches = 12;
    for (std::size_t i = 0; i < 6; ++i) report.convergence.push_back({32 * i, std::pow(0.3, double(i))});
    CHECK(convergence_plot(report, "a.svg").find("unshot power") != std::string::npos);
    CHECK(convergence_plot(report, "a.pdf").rfind("%PDF", 0) == 0);
    CHECK_THROWS_AS(convergence_plot(report, "a.png"), UsageError);
}
