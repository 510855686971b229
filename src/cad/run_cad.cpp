#include "cad/run_cad.h"

#include "cad/cad_file.h"
#include "cad/cad_scene.h"
#include "cli/print/print.h"

namespace trilens {

Answer run_cad(const CadOptions& options, Console& console) {
    console.files().reads({options.file});
    check_output(options.output, console);
    const CadScene scene = scene_of_cad(read_cad_file(options.file, options.deviation), options);
    for (const std::string& warning : scene.warnings) console.warn(warning);
    Answer answer = write_output(options.output, scene.text, console);
    answer.fields.update({{"output", options.output},
                          {"mirrors", scene.mirrors},
                          {"glass", scene.glass},
                          {"objects", scene.objects},
                          {"patches", scene.patches}});
    return answer;
}

}  // namespace trilens
