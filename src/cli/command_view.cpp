// trilens view: starts the viewer, which is a program and a package of its own.
#include <utility>

#include "cli/commands.h"
#include "cli/view_options.h"
#include "terminal/other_program.h"

namespace trilens {
namespace {

Answer start_viewer(const ViewOptions&, Console& console) {
    become_program("trilens-view",
                   "the viewer is not installed; it is a Debian package of its own, trilens-viewer, and is "
                   "built where libglfw3-dev and libimgui-dev are",
                   console);
}

}  // namespace

Command view_command(std::function<Answer(const ViewOptions&, Console&)> view) {
    auto options = std::make_shared<ViewOptions>();
    Command command{.name = "view",
                    .summary = "see the scene in a window: move, compare, point at pixels",
                    .schema = "view"};
    command.options =
        joined({scene_argument(options->scene),
                scene_overrides(options->scene),
                {{.names = "--script",
                  .target = &options->script,
                  .help = "steps (JSON) instead of a user's hands, without a window; - for standard "
                          "input",
                  .value = "STEPS.json",
                  .offer = Offer::kFile},
                 {.names = "--screenshot",
                  .target = &options->screenshot,
                  .help = "the whole window at the end, once all is drawn, without a window",
                  .value = "FILE.png",
                  .offer = Offer::kImage},
                 {.names = "--window", .target = &options->window, .help = "runs the script in a window"},
                 {.names = "--display-server",
                  .target = &options->display_server,
                  .help = "shows what is drawn in the viewer tev, too, with facets and folds as lines",
                  .value = "HOST:PORT"},
                 {.names = "--window-size",
                  .target = &options->window_size,
                  .help = "in pixels; else 1280x800",
                  .value = "WxH"}}});
    command.body = [options, view = std::move(view)](Console& console) { return view(*options, console); };
    return command;
}

Command view_command() {
    return view_command(start_viewer);
}

}  // namespace trilens
