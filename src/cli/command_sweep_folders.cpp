// What is done with the folders of sweeps: status, report, merge; and the schema of what they hold.
#include <trilens/sweep.h>

#include <algorithm>
#include <filesystem>

#include "cli/commands.h"
#include "cli/print/sweeps.h"

namespace trilens {
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
    Command schema{.name = "schema", .summary = "the JSON Schema of summary.json", .schema = "sweep"};
    schema.body = [](Console&) {
        Answer answer;
        answer.text = summary_schema();
        answer.fields["summary"] = summary_schema();
        return answer;
    };
    return {folder_command("status", "what is done of a sweep", status),
            folder_command("report", "sum up again: tables, fits, plots, page", report), std::move(join),
            std::move(schema)};
}

Command report_command() {
    return folder_command("report", "make the tables, plots and page of a results folder again", report);
}

}  // namespace trilens
