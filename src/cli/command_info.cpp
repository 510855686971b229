// trilens info: the build, its libraries and the machine, for bug reports.
#include "cli/commands.h"
#include "cli/print/build.h"

namespace trilens {

Command info_command() {
    return {.name = "info",
            .summary = "the build, its libraries and the machine",
            .schema = "info",
            .body = [](Console&) { return build_answer(); }};
}

}  // namespace trilens
