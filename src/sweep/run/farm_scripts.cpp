#include "sweep/run/farm_scripts.h"

#include <algorithm>

#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/names.h"

namespace trilens {
namespace {

std::string shell_line(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_quoted(word);
    return line;
}

/// A name without characters that batch systems interpret.
std::string job_name(const std::string& title) {
    std::string name = "trilens-";
    for (const char c : title)
        name += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '-';
    return name;
}

bool has_control(const std::string& text) {
    return std::ranges::any_of(text, [](unsigned char c) { return c < ' ' || c == 127; });
}

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
    throw UsageError(one_line(text) + " cannot stand in a script " + why);
}

/// A path in which Slurm replaces nothing: %% is a percent sign; a backslash would turn all patterns off.
std::string slurm_path(const std::string& folder) {
    if (folder.find('\\') != std::string::npos)
        refuse(folder, "for Slurm: names of its logs hold no backslash; choose another folder");
    std::string path;
    for (const char c : folder) path += c == '%' ? std::string("%%") : std::string(1, c);
    return path;
}

/// A value of a #SBATCH line, whose words end at blanks and at #, as sbatch reads quotes there.
std::string sbatch_quoted(const std::string& value) {
    std::string quoted = "\"";
    for (const char c : value) quoted += c == '"' ? std::string("\\\"") : std::string(1, c);
    return quoted + "\"";
}

/// The part's number is written out, so that a few parts can be handed in again: --array=3,17.
std::string slurm_script(const FarmRequest& request) {
    const std::string name = job_name(request.title), folder = slurm_path(request.folder);
    return fmt::format(
        "#!/bin/bash\n"
        "# sbatch THIS_FILE; what is done already is not done again. Some parts only: sbatch --array=3,17 "
        "THIS_FILE\n"
        "#SBATCH --job-name={0}\n"
        "#SBATCH --array=0-{1}\n"
        "#SBATCH --requeue\n"
        "#SBATCH --open-mode=append\n"
        "#SBATCH --output={2}\n"
        "set -eu\n"
        "# The first part hands in the report, which waits for all parts.\n"
        "if [ \"$SLURM_ARRAY_TASK_ID\" = \"${{SLURM_ARRAY_TASK_MIN:-0}}\" ] && "
        "[ \"${{SLURM_RESTART_COUNT:-0}}\" = 0 ]; then\n"
        "    sbatch --dependency=\"afterany:$SLURM_ARRAY_JOB_ID\" --job-name={0}-report "
        "--output={6} --wrap={3}\n"
        "fi\n"
        "exec {4} --threads \"${{SLURM_CPUS_PER_TASK:-1}}\" --shard \"$SLURM_ARRAY_TASK_ID/{5}\"\n",
        name, request.parts - 1, sbatch_quoted(folder + "/slurm-%a.log"),
        shell_quoted(shell_line(request.report)), shell_line(request.command), request.parts,
        shell_quoted(folder + "/slurm-report.log"));
}

/// Text in which HTCondor replaces nothing.
std::string condor_text(const std::string& text) {
    std::string literal;
    for (const char c : text) literal += c == '$' ? std::string("$(DOLLAR)") : std::string(1, c);
    return literal;
}

/// HTCondor's own quoting of arguments: single quotes around, doubled inside; double quotes doubled.
std::string condor_argument(const std::string& word) {
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("''") : c == '"' ? "\"\"" : std::string(1, c);
    return condor_text(quoted + "'");
}

std::string condor_script(const FarmRequest& request) {
    std::string arguments;
    for (std::size_t i = 1; i < request.command.size(); ++i)
        arguments += condor_argument(request.command[i]) + " ";
    return fmt::format(
        "# condor_submit THIS_FILE; the folder lies where all machines see it. Then: {0}\n"
        "universe = vanilla\n"
        "executable = {1}\n"
        "arguments = \"{2}'--threads' '1' '--shard' '$(Process)/{3}'\"\n"
        "initialdir = $ENV(PWD)\n"
        "should_transfer_files = NO\n"
        "request_cpus = 1\n"
        "output = {4}/condor-$(Process).out\n"
        "error = {4}/condor-$(Process).err\n"
        "log = {4}/condor.log\n"
        "queue {3}\n",
        shell_line(request.report), condor_text(request.command.at(0)), arguments, request.parts,
        condor_text(request.folder));
}

std::string parallel_script(const FarmRequest& request) {
    // What stands in braces is its own, however it is quoted.
    for (const std::string& word : request.command)
        if (word.find('{') != std::string::npos)
            refuse(word, "for GNU parallel, which replaces what is in braces");
    return fmt::format(
        "#!/bin/sh\n"
        "# sh THIS_FILE; more machines: PARALLEL='--sshlogin a,b --workdir .' sh THIS_FILE\n"
        "set -u\n"
        "seq 0 {0} | parallel --joblog {1} --halt never {2} --threads 1 --shard '{{}}/{3}'\n"
        "exec {4}\n",
        request.parts - 1, shell_quoted(request.folder + "/parallel.log"),
        // parallel hands its words to a shell once more.
        shell_quoted(shell_line(request.command)), request.parts, shell_line(request.report));
}

}  // namespace

const std::vector<std::string>& farm_systems() {
    static const std::vector<std::string> systems = {"slurm", "htcondor", "parallel"};
    return systems;
}

std::string shell_quoted(const std::string& word) {
    constexpr const char* kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%^";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string farm_script(const FarmRequest& request) {
    if (request.parts < 1) throw UsageError("a job array has at least one part");
    if (request.command.empty()) throw UsageError("a job array needs a command");
    // Each of them is a part of one line.
    for (const std::vector<std::string>& words : {request.command, request.report, {request.folder}})
        for (const std::string& word : words)
            if (has_control(word)) refuse(word, "for a batch system: it holds a control character");
    if (request.system == "slurm") return slurm_script(request);
    if (request.system == "htcondor") return condor_script(request);
    if (request.system == "parallel") return parallel_script(request);
    throw UsageError("there is no batch system \"" + request.system + "\"" +
                     suggestion(request.system, farm_systems()));
}

}  // namespace trilens
