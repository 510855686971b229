// trilens sweep submit: the runs of a sweep as the job array of a batch system.
#include <trilens/files.h>

#include <filesystem>

#include "cli/commands.h"
#include "cli/sweep_options.h"

namespace trilens {
namespace {

struct SubmitOptions {
    SweepOptions sweep;
    std::string system = "slurm";
    int parts = 0;  // 0: as many as runs
    bool prints = false;
};

std::string absolute(const std::string& file) {
    return std::filesystem::absolute(file).lexically_normal().string();
}

/// The options with files that are found from anywhere.
SweepOptions from_anywhere(SweepOptions options) {
    for (std::string& scene : options.scenes) scene = absolute(scene);
    for (std::string& over : options.over) {
        if (over.rfind("scene=", 0) != 0) continue;
        std::string longer;
        for (const std::string& file : parse_over(over).values)
            longer += (longer.empty() ? "scene=" : ",") + absolute(file);
        over = longer;
    }
    options.output = absolute(options.output);
    return options;
}

/// Writes the plan, and a script that hands it to a batch system: on standard output, or into the folder.
Answer submit(const SubmitOptions& given, Console& console) {
    const SweepOptions options = from_anywhere(given.sweep);
    const std::vector<SweepRequest> requests = sweep_requests(options);
    if (requests.size() > 1)
        throw UsageError("a gallery of scenes is several sweeps: submit each, or sweep over scene=A,B");
    plan_sweep(requests[0], sweep_talk(console));
    const SweepSummary planned = load_sweep(options.output);
    FarmRequest farm;
    farm.system = given.system;
    farm.parts = given.parts > 0 ? given.parts : static_cast<int>(planned.runs.size());
    farm.title = planned.manifest.subject.title;
    farm.folder = options.output;
    farm.command = command_words(options, options.scenes.empty() ? "" : options.scenes[0]);
    // The program itself: a farm's machines have another search path.
    std::error_code none;
    const std::string program = std::filesystem::read_symlink("/proc/self/exe", none).string();
    if (!none) farm.command[0] = program;
    farm.report = {farm.command[0], "sweep", "report", options.output};
    const std::string script = farm_script(farm);
    Answer answer;
    answer.fields["system"] = farm.system;
    answer.fields["parts"] = farm.parts;
    answer.fields["script"] = script;
    if (given.prints) {
        answer.text = script;
        return answer;
    }
    const std::string file = options.output + (farm.system == "htcondor" ? "/submit.sub" : "/submit.sh");
    replace_text_file(file, script);
    answer.text = file + "\n";
    answer.fields["file"] = file;
    return answer;
}

}  // namespace

Command sweep_submit_command() {
    auto submitted = std::make_shared<SubmitOptions>();
    Command farm{.name = "submit",
                 .summary = "write the plan and a script for a batch system: Slurm, HTCondor, GNU parallel",
                 .options = joined({sweep_options(submitted->sweep),
                                    {{.names = "--system",
                                      .target = &submitted->system,
                                      .help = "the batch system",
                                      .choices = farm_systems()},
                                     {.names = "--parts",
                                      .target = &submitted->parts,
                                      .help = "jobs of the array; default: one per run",
                                      .range = {1, 1000000}},
                                     {.names = "--print",
                                      .target = &submitted->prints,
                                      .help = "print the script; else it is written into the folder"}}}),
                 .schema = "sweep"};
    farm.body = [submitted](Console& console) { return submit(*submitted, console); };
    return farm;
}

}  // namespace trilens
