// One run of a program: parsed, run, answered; the one place where failures become exit codes.
#include <trilens/utilities.h>
#include <trilens/version.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <new>

#include "terminal/command.h"

namespace trilens {

Json json_number(double value) {
    if (std::isfinite(value)) return value;
    return shortest_text(value);
}

namespace {

/// Options that every command has.
struct CommonOptions {
    ConsoleOptions console;
    std::string progress = "auto", colour = "auto";
    int threads = 0;
    std::string json;  // empty: text; "-": stdout; else a file beside the text
    bool help = false, version = false;
};

std::vector<Option> common_options(CommonOptions& common) {
    std::vector<Option> options{
        {.names = "-h,--help", .target = &common.help, .help = "print this help", .is_answer = true},
        {.names = "--version", .target = &common.version, .help = "print the version", .is_answer = true},
        {.names = "-q,--quiet",
         .target = &common.console.quiet,
         .help = "say errors only; stdout gets only what was asked for"},
        {.names = "-v,--verbose",
         .target = &common.console.verbose,
         .help = "say more: versions, what was read, every stage with its seconds"},
        {.names = "-t,--threads",
         .target = &common.threads,
         .help = "threads; 0 means all",
         .range = {0, 4096}},
        {.names = "--json",
         .target = &common.json,
         .help = "answer with one JSON object on stdout, or beside the text in =FILE",
         .value = "[=FILE]",
         .offer = Offer::kFile,
         .value_follows = true},
        {.names = "--progress",
         .target = &common.progress,
         .help = "how progress is shown",
         .choices = {"auto", "bar", "plain", "json", "none"}},
        {.names = "--color",
         .target = &common.colour,
         .help = "colours on stderr",
         .choices = {"auto", "always", "never"}}};
    for (Option& option : options) option.is_common = true;
    return options;
}

void add_common(Command& command, const std::vector<Option>& common) {
    command.options.insert(command.options.end(), common.begin(), common.end());
    for (Command& below : command.commands) add_common(below, common);
}

ConsoleOptions console_options(const CommonOptions& common) {
    ConsoleOptions options = common.console;
    options.progress = common.progress == "bar"     ? ProgressStyle::kBar
                       : common.progress == "plain" ? ProgressStyle::kPlain
                       : common.progress == "json"  ? ProgressStyle::kJson
                       : common.progress == "none"  ? ProgressStyle::kSilent
                                                    : ProgressStyle::kAuto;
    options.colour = common.colour == "always"  ? ColourStyle::kAlways
                     : common.colour == "never" ? ColourStyle::kNever
                                                : ColourStyle::kAuto;
    options.wants_json = !common.json.empty();
    options.is_stdout_answered = common.json == "-";
    return options;
}

Json answer_object(const std::string& schema, int code, const Console& console) {
    Json object;
    object["schema"] = "trilens." + schema + "/1";
    object["status"] = code == 0 ? "ok" : code == 1 ? "fail" : "error";
    object["exit_code"] = code;
    object["warnings"] = console.warnings();
    object["errors"] = Json::array();
    return object;
}

std::string json_text(const Json& object) {
    return object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void print(const std::string& text) {
    stop_at_once(true);  // a pipe that nobody reads
    std::fputs(text.c_str(), stdout);
    if (!text.empty() && text.back() != '\n') std::fputc('\n', stdout);
    // A flush knows nothing of a write before it that failed.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
        throw OutputError("standard output", "cannot be written");
}

/// What the words ask for, and where its answer goes.
struct Run {
    Located located;
    CommonOptions common;
    std::vector<std::string> words;

    std::string schema() const {
        if (!located.command().schema.empty()) return located.command().schema;
        return located.path.size() > 1 ? located.path[1]->name : "help";
    }
};

void give_answer(const Run& run, const Console& console, const Answer& answer) {
    const std::string text = console.is_quiet() && answer.is_report ? "" : answer.text;
    if (run.common.json.empty()) return print(text);
    Json object = answer_object(run.schema(), static_cast<int>(answer.code), console);
    object["errors"] = answer.errors;
    object.update(answer.fields);
    if (run.common.json == "-") return print(json_text(object));
    replace_text_file(run.common.json, json_text(object));
    print(text);
}

/// A failure may be told in a file only where the command line means that file for nothing else.
bool is_free_for_json(const Run& run, const Console& console) {
    for (const std::string& input : console.files().inputs())
        if (is_one_file(run.common.json, input)) return false;
    for (const std::string& word : run.words) {
        if (word.rfind("--json=", 0) == 0) continue;
        const std::size_t equals = word.find('=');
        if (is_one_file(run.common.json, word)) return false;
        if (equals != std::string::npos && is_one_file(run.common.json, word.substr(equals + 1)))
            return false;
    }
    return true;
}

/// `may_write` false: it is known that the answer's file cannot be written.
int fail(const Run& run, Console& console, const Error& error, bool may_write = true) {
    const int code =
        error.code() == ExitCode::kInterrupted ? stop_exit_code() : static_cast<int>(error.code());
    console.error(error.what());
    if (run.common.json.empty()) return code;
    Json object = answer_object(run.schema(), code, console);
    object["errors"].push_back(error.what());
    try {
        if (run.common.json == "-")
            print(json_text(object));
        else if (may_write && is_free_for_json(run, console))
            replace_text_file(run.common.json, json_text(object));
    } catch (const Error& second) {
        if (std::string(second.what()) != error.what()) console.error(second.what());
    }
    return code;
}

/// A bare `--json` means stdout.
std::vector<std::string> spelled_out(int argc, const char* const* argv) {
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    for (std::string& word : words)
        if (word == "--json") word = "--json=-";
    return words;
}

/// A command line that cannot be parsed may still say where its answer goes.
std::string json_of(const std::vector<std::string>& words) {
    std::string json;
    for (const std::string& word : words)
        if (word.rfind("--json=", 0) == 0) json = word.substr(7);
    return json;
}

void parse(const Run& run) {
    const Located& located = run.located;
    if (!located.unknown.empty()) throw unknown_command(located);
    parse_options(located);
    if (located.command().commands.empty() || run.common.help || run.common.version) return;
    std::vector<std::string> names;
    for (const Command& command : located.command().commands) names.push_back(command.name);
    throw UsageError("a command is required: " + located.called() + " " + one_of(names) + "; see " +
                     located.called() + " --help");
}

/// What is said where a signal ends the program at once and JSON was asked for on stdout.
void prepare_last_words(const Run& run, const Console& console) {
    if (run.common.json != "-") return;
    std::vector<std::string> said;
    for (const int code : {130, 143}) {
        Json object = answer_object(run.schema(), code, console);
        object["errors"].push_back("interrupted");
        said.push_back(json_text(object));
    }
    set_last_words(said[0], said[1]);
}

int run_command(const Run& run, Console& console) {
    try {
        console.files().writes(run.common.json);
    } catch (const Error& error) {
        return fail(run, console, error, false);
    }
    try {
        prepare_last_words(run, console);
        set_threads(run.common.threads);
        std::string built = "trilens " + version();
        for (const std::string& library : library_versions()) built += ", " + library;
        console.note(built + ", " + std::to_string(threads()) + " threads");
        const Stopwatch watch;
        const Answer answer = run.located.command().body(console);
        give_answer(run, console, answer);
        console.note_stage(run.located.called() + ": done", watch);
        return static_cast<int>(answer.code);
    } catch (const Error& error) {
        return fail(run, console, error);
    } catch (const std::bad_alloc&) {
        return fail(run, console, ComputationError("out of memory"));
    } catch (const std::exception& error) {
        return fail(run, console, ComputationError(std::string("internal error: ") + error.what()));
    }
}

}  // namespace

int run_program(Command root, int argc, const char* const* argv) {
    install_signal_handlers();
    Run run;
    for (Command& command : manual_commands(root)) root.commands.push_back(std::move(command));
    add_common(root, common_options(run.common));
    run.words = spelled_out(argc, argv);
    run.located = locate(root, run.words);
    try {
        parse(run);
    } catch (const UsageError& error) {
        run.common.json = json_of(run.words);
        Console console(console_options(run.common));
        return fail(run, console, error);
    }
    ConsoleOptions options = console_options(run.common);
    options.words = run.words;
    Console console(options);
    if (!run.common.help && !run.common.version) return run_command(run, console);
    try {
        print(run.common.help ? help_text(run.located) : "trilens " + version());
    } catch (const Error& error) {
        console.error(error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}

}  // namespace trilens
