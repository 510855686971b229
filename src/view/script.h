// Scripts that drive the viewer, step by step, without a hand on the mouse: for tests and for pictures of
// pages.
//
//     {"steps": [{"show": {"n": 16, "birdsEye": true}},
//                {"orbit": [60, 10], "frames": 30},
//                {"pixel": [320, 240]}, {"wait": "done"},
//                {"screenshot": "ball.png"}, {"save": "turned.json"}]}
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "view/viewer.h"

namespace trilens {

/// A hand on the mouse, window pixels.
struct Pointer {
    Vec2 at{0};
    int button = -1;  // pressed: 0 left, 1 right, 2 middle; -1: none
    double wheel = 0;
    bool ctrl = false, alt = false, shift = false;
};

/// What one step came to.
struct StepReport {
    std::string action;
    int frames = 0;      // pictures that it waited for
    double seconds = 0;  // from its beginning to its end
    std::string error;   // what the window showed at its end; empty: none
};

/// Goes one frame of one step further each time that it is asked, so that a window can be drawn in between.
class Script {
  public:
    /// The steps of a file's text. Throws InputError with the place of a step that is none.
    Script(const std::string& file, const std::string& text);

    /// Takes a picture of the whole window into a PNG.
    std::function<void(const std::string& file)> screenshot;
    /// Moves the mouse and lets the window have a frame of it.
    std::function<void(const Pointer& pointer)> point;

    /// Does the next; false after the last. Throws InputError for a step that cannot be done, as a camera
    /// that the scene does not have, and OutputError. What a scene's change leads to stands in the viewer's
    /// error().
    bool advance(SceneViewer& viewer);

    const std::vector<StepReport>& reports() const { return reports_; }

  private:
    bool run(SceneViewer& viewer, const Json& step);
    bool run_moves(SceneViewer& viewer, const Json& step, const std::string& action);
    bool run_pointer(SceneViewer& viewer, const Json& step, const std::string& action);
    void run_random(SceneViewer& viewer);

    std::string file_;
    std::vector<Json> steps_;
    std::size_t at_ = 0;
    int frame_ = 0;  // of the step
    std::uint64_t random_ = 0;
    std::chrono::steady_clock::time_point begun_;
    std::vector<StepReport> reports_;
};

/// The settings that a step's "show" names on top of those of now. Throws UsageError for others, and for
/// values that are none.
ViewSettings shown_settings(const Json& show, const ViewSettings& from, const Json& scene);

// The values of steps. All throw UsageError for what is none, or out of its range.

/// So many numbers: an array of them, or one by itself.
std::vector<double> numbers_in(const Json& value, std::size_t count);
/// One from `least` to `most`, which may be infinite.
double number_in(const Json& value, double least, double most);
/// A whole one from 1.
int count_in(const Json& value, int most);
std::string text_in(const Json& value);
bool flag_in(const Json& value);

}  // namespace trilens
