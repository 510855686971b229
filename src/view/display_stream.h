// The viewer's pictures on a display server, stage by stage as they are drawn, with lines over them.
#pragma once

#include <trilens/display.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "view/painter.h"

namespace trilens {

/// Shows what a viewer draws: the projected picture under the scene's name, the truth beside it once it is
/// drawn, facets, edges, folds and the images of a place as lines over the first.
class DisplayStream {
  public:
    /// `name`: of the projected picture. Throws UsageError for what is no address, OutputError where nobody
    /// answers there.
    DisplayStream(const std::string& address, const std::string& name);

    /// Sends a stage's pictures, but for those of fewer pixels, and those that come within kDisplayPause of
    /// the last ones: while things move. A stage after them brings what was left out. Once the server has
    /// gone away it sends nothing and adds a warning to `warnings`.
    void send(const StagePictures& stage, std::vector<std::string>& warnings);

  private:
    struct Sent {
        int width = 0, height = 0;
        std::vector<std::string> channels;
    };
    void send_picture(const std::string& name, const Image& image, Sent& before);

    std::string name_, failure_;
    DisplayServer server_;
    Sent projected_, truth_;
    bool has_lines_ = false;
    std::optional<std::chrono::steady_clock::time_point> last_;
};

/// Pictures are sent no oftener than this, but for the last ones of a state.
inline constexpr double kDisplayPause = 0.1;  // seconds

/// The lines over the picture of a stage, by their colours: facets white, edges blue, folds orange, a place's
/// images yellow crosses.
std::vector<DisplayLine> stage_lines(const StagePictures& stage);

}  // namespace trilens
