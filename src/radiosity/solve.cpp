#include "radiosity/solve.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/util/check.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

/// Sides whose rows are made at once: a number of its own, so that results do not depend on threads.
constexpr std::size_t kShotsAtOnce = 32;

double most_of(const Vec3& v) {
    return std::max({v.x, v.y, v.z});
}

Vec3 power_of(const RadiosityProblem& problem, const std::vector<Vec3>& exitance) {
    Vec3 power(0);
    for (std::size_t i = 0; i < exitance.size(); ++i) power += problem.area[i] * exitance[i];
    return power;
}

/// Of the colours that there are, the greatest share.
double share_of(const Vec3& power, const Vec3& whole) {
    double share = 0;
    for (int k = 0; k < 3; ++k)
        if (whole[k] > 0) share = std::max(share, power[k] / whole[k]);
    return share;
}

/// How far from 1 to the tolerance, on a logarithmic scale.
double way_done(double share, double tolerance) {
    if (!(share > 0)) return 1;
    return std::clamp(std::log(share) / std::log(tolerance), 0.0, 1.0);
}

/// How much of progressive refinement is done, by predicting the shots that are left: from the power that
/// is unshot now, and from the time that shots have taken. A side's first shot is told from others, whose
/// rows may be kept.
class ShootingForecast {
  public:
    ShootingForecast(const RadiosityProblem& problem, double tolerance, const Progress& progress)
        : problem_(problem), tolerance_(tolerance), progress_(progress), has_shot_(problem.area.size()) {}

    /// These have shot, in so many seconds.
    void add(const std::vector<Id>& shooters, double seconds) {
        // Shots of one batch take one time each: many batches tell both kinds apart.
        std::size_t first = 0;
        for (const Id i : shooters) first += !std::exchange(has_shot_[i], char{1});
        const double share = static_cast<double>(first) / static_cast<double>(shooters.size());
        for (const auto& [at, kind] : {std::pair(share, &first_), std::pair(1 - share, &again_)}) {
            if (!(at > 0.5)) continue;
            kind->seconds += seconds;
            kind->shots += static_cast<double>(shooters.size());
        }
        over_ += seconds;
    }

    /// `whole`: all power that there was, `left`: the share that is unshot.
    void tell(const std::vector<Vec3>& unshot, const Vec3& whole, double left) {
        constexpr double kBetween = 0.3;  // seconds
        if (!progress_.report || (has_told_ && watch_.seconds() < kBetween)) return;
        watch_ = {}, has_told_ = true;
        const Counts shots = predicted(unshot, whole, left);
        const double of_first = first_.each(), of_again = again_.shots > 0 ? again_.each() : 0;
        const double ahead = shots.first * of_first + shots.again * of_again;
        if (over_ > 0 && over_ + ahead > 0) progress_(over_ / (over_ + ahead));
    }

  private:
    struct Speed {
        double seconds = 0, shots = 0;
        double each() const { return shots > 0 ? seconds / shots : 0; }
    };
    struct Counts {
        double first = 0, again = 0;
    };

    /// The brightest sides whose shots leave no more than the tolerance, with what will be reflected to them.
    Counts predicted(const std::vector<Vec3>& unshot, const Vec3& whole, double left) const {
        std::vector<std::pair<double, Id>> powers;
        double sum = 0;
        for (Id i = 0; i < unshot.size(); ++i) {
            const double share = problem_.area[i] * share_of(unshot[i], whole);
            if (share > 0) powers.emplace_back(share, i);
            sum += share;
        }
        std::sort(powers.begin(), powers.end());
        double kept = 0;
        std::size_t k = 0;
        while (k < powers.size() && (kept + powers[k].first) * left <= kReflected * tolerance_ * sum)
            kept += powers[k++].first;
        Counts counts;
        for (; k < powers.size(); ++k) (has_shot_[powers[k].second] ? counts.again : counts.first)++;
        return counts;
    }

    /// What is left to sides of the power that there is now, as more is reflected to them.
    static constexpr double kReflected = 0.5;

    const RadiosityProblem& problem_;
    double tolerance_;
    const Progress& progress_;
    std::vector<char> has_shot_;
    Speed first_, again_;
    double over_ = 0;
    Stopwatch watch_;
    bool has_told_ = false;
};

/// The sides with most unshot power, most first.
std::vector<Id> brightest(const RadiosityProblem& problem, const std::vector<Vec3>& unshot) {
    std::vector<Id> sides;
    for (Id i = 0; i < unshot.size(); ++i)
        if (problem.area[i] > 0 && most_of(unshot[i]) > 0) sides.push_back(i);
    const auto is_before = [&](Id a, Id b) {
        const double p = problem.area[a] * most_of(unshot[a]), q = problem.area[b] * most_of(unshot[b]);
        return p != q ? p > q : a < b;
    };
    const std::size_t count = std::min(kShotsAtOnce, sides.size());
    std::partial_sort(sides.begin(), sides.begin() + static_cast<std::ptrdiff_t>(count), sides.end(),
                      is_before);
    sides.resize(count);
    return sides;
}

void check_problem(const RadiosityProblem& problem) {
    TRILENS_CHECK(
        problem.reflectance.size() == problem.area.size() && problem.exitance.size() == problem.area.size(),
        "one entry per side each");
}

}  // namespace

RadiositySolution shoot(const RadiosityProblem& problem, const RowSource& rows, const SolveParams& params,
                        const Progress& progress) {
    check_problem(problem);
    RadiositySolution solution;
    solution.radiosity = problem.exitance;
    solution.arriving.assign(problem.area.size(), Vec3(0));
    std::vector<Vec3> unshot = problem.exitance;
    const Vec3 whole = power_of(problem, problem.exitance);
    std::size_t shots = 0;
    ShootingForecast forecast(problem, params.tolerance, progress);
    while (true) {
        solution.unshot = power_of(problem, unshot);
        const double left = share_of(solution.unshot, whole);
        solution.steps.push_back({shots, left});
        solution.converged = left <= params.tolerance;
        progress.stop_if_cancelled();
        forecast.tell(unshot, whole, left);
        const Stopwatch watch;
        if (solution.converged || shots >= params.most_steps) return solution;
        const std::vector<Id> shooters = brightest(problem, unshot);
        if (shooters.empty()) return solution;
        std::vector<FormFactorRow> made(shooters.size());
        parallel_for(shooters.size(), 1, [&](std::size_t from, std::size_t to) {
            for (std::size_t k = from; k < to; ++k) made[k] = rows(shooters[k]);
        });
        for (std::size_t k = 0; k < shooters.size(); ++k, ++shots) {
            const Id i = shooters[k];
            const Vec3 power = problem.area[i] * unshot[i];
            unshot[i] = Vec3(0);
            solution.escaped += made[k].escaped * power;
            for (std::size_t e = 0; e < made[k].side.size(); ++e) {
                const Id j = made[k].side[e];
                if (!(problem.area[j] > 0)) continue;  // no ray sees such a triangle
                const Vec3 arriving = made[k].factor[e] / problem.area[j] * power;
                solution.arriving[j] += arriving;
                const Vec3 reflected = problem.reflectance[j] * arriving;
                solution.radiosity[j] += reflected;
                unshot[j] += reflected;
            }
        }
        forecast.add(shooters, watch.seconds());
    }
}

RadiositySolution gather(const RadiosityProblem& problem, const FormFactorMatrix& matrix,
                         const SolveParams& params, const Progress& progress) {
    check_problem(problem);
    TRILENS_CHECK(matrix.rows.size() == problem.area.size(), "one row per side");
    RadiositySolution solution;
    solution.radiosity = problem.exitance;
    solution.arriving.assign(problem.area.size(), Vec3(0));
    const Vec3 whole = power_of(problem, problem.exitance);
    solution.steps.push_back({0, 1});
    std::vector<Vec3> moved(problem.area.size());
    for (std::size_t sweep = 0; sweep < params.most_steps && !solution.converged; ++sweep) {
        progress.stop_if_cancelled();
        for (std::size_t i = 0; i < problem.area.size(); ++i) {
            const FormFactorRow& row = matrix.rows[i];
            Vec3 arriving(0);
            for (std::size_t k = 0; k < row.side.size(); ++k)
                arriving += row.factor[k] * solution.radiosity[row.side[k]];
            const Vec3 radiosity = problem.exitance[i] + problem.reflectance[i] * arriving;
            moved[i] = glm::abs(radiosity - solution.radiosity[i]);
            solution.arriving[i] = arriving;
            solution.radiosity[i] = radiosity;
        }
        const double left = share_of(power_of(problem, moved), whole);
        solution.steps.push_back({(sweep + 1) * problem.area.size(), left});
        solution.converged = left <= params.tolerance;
        progress(way_done(left, params.tolerance));
    }
    for (std::size_t i = 0; i < problem.area.size(); ++i)
        solution.escaped += problem.area[i] * matrix.rows[i].escaped * solution.radiosity[i];
    // What has left a side after others had gathered from it.
    Vec3 arrived(0);
    for (std::size_t i = 0; i < problem.area.size(); ++i) arrived += problem.area[i] * solution.arriving[i];
    solution.unshot = power_of(problem, solution.radiosity) - arrived - solution.escaped;
    return solution;
}

}  // namespace trilens
