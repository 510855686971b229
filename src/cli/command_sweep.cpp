// trilens sweep: error against resolution or any other setting, for one scene or for a gallery of scenes.
#include <trilens/stopwatch.h>
#include <trilens/sweep.h>

#include <optional>

#include "cli/commands.h"
#include "cli/print/sweeps.h"
#include "cli/sweep_options.h"

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
    for (const SweepRequest& request : possible_sweeps(options, left_out, console)) {
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

}  // namespace trilens
