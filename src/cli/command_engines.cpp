// trilens sweep engines: how the classic engine's picture comes near the exact one, and what its clipping
// leaves uncovered.
#include <trilens/engine_study.h>

#include "cli/commands.h"
#include "cli/scene_options.h"
#include "terminal/format.h"

namespace trilens {
namespace {

struct StudyOptions {
    SceneOptions scene;
    std::vector<std::string> scenes;
    std::string output;
};

std::string table_text(const std::vector<StudyRow>& rows) {
    std::string text = fmt::format("{:<14} {:>4}  {:<27} {:>8} {:>9} {:>10} {:>9} {:>9}\n", "scene", "n",
                                   "classic", "pixels", "differing", "share", "uncovered", "seconds");
    for (const StudyRow& row : rows)
        text += fmt::format("{:<14} {:>4}  {:<27} {:>8} {:>9} {:>9.4f}% {:>9} {:>9.3f}\n", row.scene,
                            row.resolution, classic_name(row.params), row.pixels, row.differing,
                            100 * row.share(), row.uncovered, row.classic_seconds);
    return text;
}

Answer run(const StudyOptions& options, Console& console) {
    console.files().reads(options.scenes);
    StudyRequest request;
    request.camera = options.scene.camera;
    request.folder = options.output;
    for (const std::string& file : options.scenes) {
        SceneOptions scene = options.scene;
        scene.scene = file;
        request.scenes.push_back(scene_request(scene));
    }
    const EngineStudy study = study_engines(request, sweep_talk(console));
    Answer answer;
    answer.text = table_text(study.curves) + "\n" + table_text(study.clipping);
    answer.fields["files"] = study.files;
    return answer;
}

}  // namespace

Command sweep_engines_command() {
    auto options = std::make_shared<StudyOptions>();
    options->scene.resolution = 2;
    Command command{.name = "engines",
                    .summary = "the classic engine against the exact one: curves and clipping",
                    .schema = "sweep"};
    command.options =
        joined({{{.names = "SCENES",
                  .target = &options->scenes,
                  .help = "scene files",
                  .offer = Offer::kScene,
                  .is_required = true},
                 {.names = "-o,--output",
                  .target = &options->output,
                  .help = "folder for the tables and plots",
                  .value = "DIR",
                  .offer = Offer::kFolder,
                  .is_required = true},
                 {.names = "-n,--resolution",
                  .target = &options->scene.resolution,
                  .help = "resolution of the optics while K varies: coarse facets bend edges most; "
                          "default: 2",
                  .range = {1, 1024}}},
                scene_overrides(options->scene)});
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
