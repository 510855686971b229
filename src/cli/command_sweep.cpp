// trilens sweep: error against resolution or any other setting, for one scene or for a gallery of scenes.
#include <trilens/sweep.h>
#include <trilens/utilities.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"

namespace trilens {
namespace {

/// The sweeps that are asked for, those first taken out that their scene has nothing for.
std::vector<SweepRequest> possible_sweeps(const SweepOptions& options, std::vector<LeftOutScene>& left_out,
                                          Console& console) {
    const std::vector<SweepRequest> all = sweep_requests(options);
    if (options.scenes.size() <= 1) return all;
    std::vector<SweepRequest> possible;
    for (const SweepRequest& request : all) {
        const std::optional<LeftOutScene> without = why_left_out(request);
        if (without)
            left_out.push_back(*without);
        else
            possible.push_back(request);
    }
    if (possible.empty()) throw InputError("", "", "no scene can be swept: " + left_out.front().reason);
    for (const LeftOutScene& one : left_out) console.warn("left out of the sweep: " + one.reason);
    keep_left_out(options.output, left_out);
    return possible;
}

Answer run(const SweepOptions& options, Console& console) {
    console.files().reads(options.scenes);
    if (options.scenes.size() > 1) require_no_sweep(options.output);
    std::vector<SweepSummary> summaries;
    std::vector<LeftOutScene> left_out;
    const std::vector<SweepRequest> requests = possible_sweeps(options, left_out, console);
    // The status of a gallery that is stopped early then knows the scenes that it did not come to.
    if (requests.size() > 1)
        for (const SweepRequest& request : requests) plan_sweep(request, sweep_talk(console));
    for (const SweepRequest& request : requests) {
        const Stopwatch watch;
        summaries.push_back(run_sweep(request, sweep_talk(console)));
        console.note_stage("swept " + summaries.back().manifest.subject.title, watch);
    }
    // A shard sums up nothing: `sweep report` does once all are done.
    const bool is_whole = is_whole_sweep(options.shard);
    const std::string report = is_whole ? options.output + "/report.html" : "";
    if (is_whole && options.scenes.size() > 1) write_sweep_gallery(options.output, summaries);
    Answer answer = answer_of(summaries, report, left_out);
    answer.is_report = true;
    return answer;
}

Answer plan(const SweepOptions& options, Console& console) {
    Answer answer;
    answer.is_report = true;
    console.files().reads(options.scenes);
    std::vector<LeftOutScene> left_out;
    for (const SweepRequest& request : possible_sweeps(options, left_out, console)) {
        const std::string file = plan_sweep(request, sweep_talk(console));
        answer.text += file + "\n";
        answer.fields["plans"].push_back(file);
    }
    answer.fields["left_out"] = left_out_json(left_out);
    return answer;
}

}  // namespace

Command sweep_command() {
    auto options = std::make_shared<SweepOptions>();
    Command all{.name = "run",
                .summary = "do what is not done yet, then report",
                .options = sweep_options(*options),
                .schema = "sweep"};
    all.body = [options](Console& console) { return run(*options, console); };
    Command planned{.name = "plan",
                    .summary = "write the plan, run nothing",
                    .options = sweep_options(*options),
                    .schema = "sweep"};
    planned.body = [options](Console& console) { return plan(*options, console); };
    Command sweep{.name = "sweep",
                  .summary = "render, trace and compare over resolutions, engines or any setting",
                  .commands = {std::move(all), std::move(planned)}};
    for (Command& command : sweep_folder_commands()) sweep.commands.push_back(std::move(command));
    sweep.commands.push_back(sweep_submit_command());
    return sweep;
}

// What is done with the folders of sweeps: status, report, merge; and the schema of what they hold.

namespace {

struct MergeOptions {
    std::vector<std::string> parts;
    std::string output;
};

/// The folder itself, or those below it where a sweep of several scenes made it; in the order of their names.
std::vector<std::string> sweeps_in(const std::string& folder) {
    namespace fs = std::filesystem;
    std::error_code none;
    std::vector<std::string> found;
    if (!fs::exists(folder + "/manifest.json", none))
        for (fs::directory_iterator entry(folder, none), end; !none && entry != end; entry.increment(none))
            if (fs::exists(entry->path() / "manifest.json", none)) found.push_back(entry->path().string());
    std::sort(found.begin(), found.end());
    // Nothing there: the sweep's own message says so.
    return found.empty() ? std::vector<std::string>{folder} : found;
}

Answer status(const std::string& folder) {
    std::vector<SweepSummary> summaries;
    for (const std::string& one : sweeps_in(folder)) summaries.push_back(load_sweep(one));
    return status_answer(summaries, folder, left_out_of_gallery(folder));
}

Answer merge(const MergeOptions& options, Console& console) {
    const std::size_t copied = merge_folders(options.parts, options.output, console.progress("merge"));
    Answer answer = answer_of({report_sweep(options.output)}, options.output + "/report.html");
    answer.fields["copied"] = copied;
    answer.is_report = true;
    return answer;
}

Answer report(const std::string& folder) {
    std::vector<SweepSummary> summaries;
    for (const std::string& one : sweeps_in(folder)) summaries.push_back(report_sweep(one));
    const std::vector<LeftOutScene> left_out = left_out_of_gallery(folder);
    if (summaries.front().folder != folder) write_sweep_gallery(folder, summaries);
    return answer_of(summaries, folder + "/report.html", left_out);
}

Command folder_command(const std::string& name, const std::string& summary,
                       Answer (*body)(const std::string& folder)) {
    auto folder = std::make_shared<std::string>();
    return {.name = name,
            .summary = summary,
            .options = {{.names = "DIR",
                         .target = folder.get(),
                         .help = "the sweep's folder",
                         .offer = Offer::kFolder,
                         .is_required = true}},
            .schema = "sweep",
            .body = [folder, body](Console&) { return body(*folder); }};
}

}  // namespace

std::vector<Command> sweep_folder_commands() {
    auto merged = std::make_shared<MergeOptions>();
    Command join{.name = "merge",
                 .summary = "join folders of one sweep from several machines, then report",
                 .options = {{.names = "DIRS",
                              .target = &merged->parts,
                              .help = "the parts' folders",
                              .offer = Offer::kFolder,
                              .is_required = true},
                             {.names = "-o,--output",
                              .target = &merged->output,
                              .help = "folder for all of it; what it holds of the sweep stays",
                              .value = "DIR",
                              .offer = Offer::kFolder,
                              .is_required = true}},
                 .schema = "sweep"};
    join.body = [merged](Console& console) { return merge(*merged, console); };
    auto of_file = std::make_shared<bool>(false);
    Command schema{.name = "schema",
                   .summary = "the JSON Schema of summary.json, or of the files that say what is swept",
                   .options = {{.names = "--file",
                                .target = of_file.get(),
                                .help = "of the files that `sweep run` reads: sweep.json"}},
                   .schema = "sweep"};
    schema.body = [of_file](Console&) {
        Answer answer;
        answer.text = *of_file ? sweep_schema() : summary_schema();
        answer.fields[*of_file ? "file" : "summary"] = answer.text;
        return answer;
    };
    return {folder_command("status", "what is done of a sweep", status),
            folder_command("report", "sum up again: tables, fits, plots, page", report), std::move(join),
            std::move(schema)};
}

Command report_command() {
    return folder_command("report", "make the tables, plots and page of a results folder again", report);
}

// trilens sweep submit: the runs of a sweep as the job array of a batch system.

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
    if (given.prints && options.replace)
        throw UsageError("--print shows a script, and --replace would remove the runs that the folder holds");
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
                                      .help = "print the script; else it is written into the folder, "
                                              "which has the plan either way"}}}),
                 .schema = "sweep"};
    farm.body = [submitted](Console& console) { return submit(*submitted, console); };
    return farm;
}

}  // namespace trilens
