#include "caustics/beams/hidden_histories.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace trilens {
namespace {

/// A probe stands for this share of the light that comes to the window, or for the share of a window's
/// triangles of different histories that so many probes leave to each.
constexpr double kProbeLight = 1e-5;
constexpr double kMostProbes = 8192;
/// Rounds, each with twice as many probes for the same light as the one before, in what that one divided.
constexpr int kProbeRounds = 8;
/// Steps of the R2 sequence (Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018): powers
/// of the plastic number, the root of x^3 = x + 1.
constexpr double kPlasticStep[2] = {0.7548776662466927, 0.5698402909980532};

struct Probe {
    Id triangle = kNone;
    Vec3 weights{0};
};

/// The n-th place in a triangle: of the square, folded.
Vec3 probe_weights(std::size_t n) {
    const double count = static_cast<double>(n) + 0.5;
    double u = std::fmod(count * kPlasticStep[0], 1.0), v = std::fmod(count * kPlasticStep[1], 1.0);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    return {1 - u - v, u, v};
}

/// The light that comes to a triangle: the sum of its colours.
double light_to(const BeamGrid& grid, const BeamGrid::Triangle& triangle) {
    const auto& [a, b, c] = triangle.corner;
    const double measure = grid.window().measure(grid.place(a), grid.place(b), grid.place(c));
    double sum = 0;
    for (const Id corner : triangle.corner)
        if (!grid.paths(corner).empty())
            sum += measure / 3 * strength_of(grid.paths(corner).front().arriving);
    return sum;
}

class HistoryProbes {
  public:
    HistoryProbes(BeamGrid& grid, GridHistories& histories, const Progress& progress)
        : grid_(grid), histories_(histories), progress_(progress) {}

    void find() {
        for (int round = 0; round < kProbeRounds; ++round) {
            while (grid_.divide_more(histories_.triangles_that_hide(), progress_))
                histories_.find_borders(progress_);
            const std::vector<Probe> probes = next_probes();
            const std::vector<Id> found = triangles_that_hide(probes);
            if (!grid_.divide_more(found, progress_)) return;
            histories_.find_borders(progress_);
        }
    }

  private:
    /// Of triangles that came since the last ones.
    std::vector<Probe> next_probes() {
        const std::vector<BeamGrid::Triangle>& triangles = grid_.triangles();
        std::vector<double> light(triangles.size(), 0.0);
        double all = 0;
        for (Id t = 0; t < triangles.size(); ++t) {
            const bool is_new = t >= probed_.size() || probed_[t] != triangles[t].corner;
            if (is_new && histories_.is_mixed(triangles[t])) all += light[t] = light_to(grid_, triangles[t]);
        }
        if (probed_.empty()) {
            const double size = grid_.scene_size();
            light_of_probe_ = std::max(kProbeLight * grid_.mean_arriving() * size * size, all / kMostProbes);
        } else {
            light_of_probe_ /= 2;
        }
        probed_.clear();
        for (const BeamGrid::Triangle& one : triangles) probed_.push_back(one.corner);

        // What is left of one triangle's share is the next one's.
        std::vector<Probe> probes;
        double share = 0;
        for (Id t = 0; t < triangles.size(); ++t)
            for (share += light[t] / light_of_probe_; share >= 1; --share)
                probes.push_back({t, probe_weights(count_++)});
        return probes;
    }

    std::vector<Id> triangles_that_hide(const std::vector<Probe>& probes) const {
        std::vector<char> hides(probes.size());
        parallel_for(probes.size(), 16, [&](std::size_t from, std::size_t to) {
            progress_.stop_if_cancelled();
            for (std::size_t i = from; i < to; ++i)
                hides[i] = histories_.hides_at(grid_.triangles()[probes[i].triangle], probes[i].weights);
        });
        std::vector<Id> found;
        for (std::size_t i = 0; i < probes.size(); ++i)
            if (hides[i] && (found.empty() || found.back() != probes[i].triangle))
                found.push_back(probes[i].triangle);
        return found;
    }

    BeamGrid& grid_;
    GridHistories& histories_;
    const Progress& progress_;
    std::vector<std::array<Id, 3>> probed_;  // corners of the triangles as they were
    std::size_t count_ = 0;                  // of probes so far
    double light_of_probe_ = 0;
};

}  // namespace

void find_hidden_histories(BeamGrid& grid, GridHistories& histories, const Progress& progress) {
    HistoryProbes(grid, histories, progress).find();
}

}  // namespace trilens
