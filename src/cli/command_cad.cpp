// trilens cad: starts the program that makes scenes of STEP and IGES files.
#include <memory>
#include <utility>

#include "cli/cad_options.h"
#include "cli/commands.h"
#include "terminal/other_program.h"

namespace trilens {
namespace {

Answer start_converter(const CadOptions&, Console& console) {
    become_program("trilens-cad",
                   "the reader of STEP and IGES, trilens-cad, is not installed; it is built from source "
                   "where libocct-data-exchange-dev is",
                   console);
}

}  // namespace

Command cad_command(std::function<Answer(const CadOptions&, Console&)> convert) {
    auto options = std::make_shared<CadOptions>();
    Command command{.name = "cad",
                    .summary = "a STEP or IGES file's bodies as a scene: mirrors and glass as NURBS patches",
                    .schema = "cad"};
    command.options = {{.names = "FILE",
                        .target = &options->file,
                        .help = "STEP (.step, .stp) or IGES (.iges, .igs)",
                        .offer = Offer::kFile,
                        .is_required = true},
                       {.names = "-o,--output",
                        .target = &options->output,
                        .help = "the scene, - for standard output",
                        .value = "SCENE.json",
                        .offer = Offer::kFile,
                        .is_required = true},
                       {.names = "--mirror",
                        .target = &options->mirrors,
                        .help = "bodies that are mirrors, by name; * stands for any letters. Without "
                                "--mirror and --glass all are",
                        .value = "NAME"},
                       {.names = "--glass",
                        .target = &options->glass,
                        .help = "bodies that are glass, by name",
                        .value = "NAME"},
                       {.names = "--ior", .target = &options->ior, .help = "of the glass", .range = {1, 4}},
                       {.names = "--deviation",
                        .target = &options->deviation,
                        .help = "how far an object's triangles may lie off it, as a share of the file's size",
                        .range = {1e-7, 1}}};
    command.body = [options, convert = std::move(convert)](Console& console) {
        return convert(*options, console);
    };
    return command;
}

Command cad_command() {
    return cad_command(start_converter);
}

}  // namespace trilens
