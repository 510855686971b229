// A scene without geometry: what two optics show is displaced by a known number of pixels that falls as
// n^-order.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "sweep/run/sweep.h"

namespace trilens_test {

inline constexpr int kFakeWidth = 96, kFakeHeight = 40;
inline constexpr double kLeftConstant = 1.5, kRightConstant = 2.9;  // pixels at n = 1

/// The left half is optic 0, the right half optic 1; both show object 7, displaced to the left by `left`,
/// `right` pixels.
inline trilens::Image fake_image(double left, double right) {
    using trilens::Id;
    const std::size_t pixels = static_cast<std::size_t>(kFakeWidth) * kFakeHeight;
    std::vector<float> x(pixels), y(pixels), z(pixels), grey(pixels);
    std::vector<Id> optic(pixels), object(pixels, 7), primitive(pixels, 0);
    for (std::size_t i = 0; i < pixels; ++i) {
        const double column = static_cast<double>(i % kFakeWidth), row = static_cast<double>(i / kFakeWidth);
        optic[i] = column < kFakeWidth / 2 ? 0 : 1;
        const double seen = column + (optic[i] == 0 ? left : right);
        x[i] = static_cast<float>(0.125 * seen);
        y[i] = static_cast<float>(-0.125 * row);
        z[i] = static_cast<float>(0.001 * seen * seen);
        grey[i] = static_cast<float>(0.5 + 0.4 * std::sin(0.2 * seen) * std::cos(0.15 * row));
    }
    trilens::Image image{kFakeWidth, kFakeHeight, 0, 0, kFakeWidth, kFakeHeight, {}, {}};
    for (const char* name : {"R", "G", "B"}) image.channels.push_back({name, grey});
    image.channels.push_back({"optic.object", optic});
    image.channels.push_back({"reflect.object", object});
    image.channels.push_back({"reflect.primitive", primitive});
    image.channels.push_back({"reflect.X", x});
    image.channels.push_back({"reflect.Y", y});
    image.channels.push_back({"reflect.Z", z});
    return image;
}

inline trilens::SweepAxes resolution_axes(const std::vector<int>& values) {
    trilens::AxisKind kind{"resolution", "n", "n", trilens::ValueKind::kWhole, 1, 1024, true};
    std::vector<std::string> texts;
    for (const int n : values) texts.push_back(std::to_string(n));
    return {{trilens::make_axis(kind, {"resolution", texts}, "axis")}, false};
}

/// A sweep of that scene that counts how often it is asked for pictures.
struct FakeSweep {
    trilens::SweepParams params;
    trilens::SweepCallbacks callbacks;
    int renders = 0, traces = 0;
    std::function<void(int n)> before_render = [](int) {};
    std::function<trilens::Image(int n)> render, trace;
    std::string job_key = "scene 1", truth_key = {};  // truth_key empty: job_key
    bool truth_per_run = false;
    std::vector<trilens::SweptOptic> optics = {{0, "left"}, {1, "right"}};

    FakeSweep(const std::string& folder, const std::vector<int>& values, double order = 2) {
        params.folder = folder;
        params.axes = resolution_axes(values);
        params.subject.title = "Two mirrors & a <test>";
        params.subject.scene = "two, \"mirrors\".json";
        params.subject.camera = "main";
        params.subject.method = "exact";
        params.subject.truth = "limit";
        params.subject.commands = {"trilens sweep run mirrors.json --over resolution=1..8:x2 -o out"};
        params.subject.versions = {{"trilens", "0.1.0"}};
        render = [this, order](int n) {
            ++renders;
            before_render(n);
            const double fall = std::pow(n, -order);
            trilens::Image image = fake_image(kLeftConstant * fall, kRightConstant * fall);
            image.metadata["trilens:facets"] = std::to_string(12 * n * n);
            return image;
        };
        trace = [this](int) {
            ++traces;
            return fake_image(0, 0);
        };
        callbacks.keys = [this](const trilens::Coordinates& point) {
            const std::string at = trilens::point_text(point);
            return trilens::RunKeys{
                job_key + at, (truth_key.empty() ? job_key : truth_key) + (truth_per_run ? at : ""), optics};
        };
        callbacks.render = [this](const trilens::PlannedRun& run) {
            return trilens::DrawnPicture{render(run.n()), {{"draw", 0.001}}};
        };
        callbacks.trace = [this](const trilens::PlannedRun& run) { return trace(run.n()); };
    }

    FakeSweep(const FakeSweep&) = delete;
    trilens::SweepSummary run() { return trilens::run_sweep(params, callbacks); }
};

}  // namespace trilens_test
