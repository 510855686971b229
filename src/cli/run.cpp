// Parsing, dispatch, and the one place where failures become exit codes.
#include <trilens/files.h>
#include <trilens/text.h>
#include <trilens/version.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>

#include "cli/command.h"

namespace trilens {

Json json_number(double value) {
    if (std::isfinite(value)) return value;
    return shortest_text(value);
}

namespace {

/// Options that every command has.
struct CommonOptions {
    ConsoleOptions console;
    int threads = 0;
    std::string json;  // empty: text; "-": stdout; else a file beside the text
};

struct Chosen {
    std::string name;
    CommandBody body;
};

const std::map<std::string, ProgressStyle> kProgressNames{{"auto", ProgressStyle::kAuto},
                                                          {"bar", ProgressStyle::kBar},
                                                          {"plain", ProgressStyle::kPlain},
                                                          {"json", ProgressStyle::kJson},
                                                          {"none", ProgressStyle::kSilent}};
const std::map<std::string, ColourStyle> kColourNames{
    {"auto", ColourStyle::kAuto}, {"always", ColourStyle::kAlways}, {"never", ColourStyle::kNever}};

void add_common(CLI::App& command, CommonOptions& common) {
    command.add_flag("-q,--quiet", common.console.quiet, "say errors only")->group("Common");
    command.add_flag("-v,--verbose", common.console.verbose, "say more")->group("Common");
    command.add_option("-t,--threads", common.threads, "threads; 0 means all")
        ->check(CLI::Range(0, 4096))
        ->group("Common");
    command
        .add_option("--json", common.json,
                    "answer with one JSON object on stdout, or beside the text in =FILE")
        ->type_name("[=FILE]")
        ->group("Common");
    command.add_option("--progress", common.console.progress, "auto, bar, plain, json or none")
        ->transform(CLI::CheckedTransformer(kProgressNames, CLI::ignore_case).description(""))
        ->type_name("STYLE")
        ->group("Common");
    command.add_option("--color", common.console.colour, "auto, always or never")
        ->transform(CLI::CheckedTransformer(kColourNames, CLI::ignore_case).description(""))
        ->type_name("WHEN")
        ->group("Common");
}

/// A bare `--json` means stdout; CLI11 would otherwise take the next word for its value.
std::vector<std::string> spelled_out(int argc, const char* const* argv) {
    std::vector<std::string> words;
    for (int i = 1; i < argc; ++i) words.push_back(std::string(argv[i]) == "--json" ? "--json=-" : argv[i]);
    return words;
}

Json answer_object(const std::string& command, ExitCode code, const Console& console) {
    Json object;
    object["schema"] = "trilens." + command + "/1";
    object["status"] = code == ExitCode::kDone ? "ok" : code == ExitCode::kExceeded ? "fail" : "error";
    object["exit_code"] = static_cast<int>(code);
    object["warnings"] = console.warnings();
    object["errors"] = Json::array();
    return object;
}

void print(const std::string& text) {
    std::fputs(text.c_str(), stdout);
    if (!text.empty() && text.back() != '\n') std::fputc('\n', stdout);
    if (std::fflush(stdout) != 0) throw OutputError("stdout", "cannot be written");
}

void give_answer(const Chosen& chosen, const CommonOptions& common, const Console& console,
                 const Answer& answer) {
    if (common.json.empty()) return print(answer.text);
    Json object = answer_object(chosen.name, answer.code, console);
    object["errors"] = answer.errors;
    object.update(answer.fields);
    if (common.json == "-") return print(object.dump(2));
    replace_text_file(common.json, object.dump(2) + "\n");
    print(answer.text);
}

int fail(const std::string& command, const std::string& json, Console& console, const Error& error) {
    const int code =
        error.code() == ExitCode::kInterrupted ? stop_exit_code() : static_cast<int>(error.code());
    console.error(error.what());
    if (!json.empty()) {
        Json object = answer_object(command, error.code(), console);
        object["exit_code"] = code;
        object["errors"].push_back(error.what());
        try {
            if (json == "-")
                print(object.dump(2, ' ', false, Json::error_handler_t::replace));
            else
                replace_text_file(json, object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
        } catch (const Error& second) {
            if (std::string(second.what()) != error.what()) console.error(second.what());
        }
    }
    return code;
}

/// The long options of a command and of the commands below it.
void collect_options(const CLI::App& command, std::vector<std::string>& known) {
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    for (const CLI::App* below : command.get_subcommands(nullptr)) collect_options(*below, known);
}

/// The usage error behind a CLI11 complaint, with the nearest known word where one was mistyped.
UsageError usage_error(const CLI::App& app, const CLI::ParseError& complaint,
                       const std::vector<std::string>& words) {
    std::vector<std::string> commands;
    for (const CLI::App* command : app.get_subcommands(nullptr)) commands.push_back(command->get_name());
    if (words.empty()) return UsageError("a command is required; see trilens --help");
    if (words[0].rfind("-", 0) != 0 &&
        std::find(commands.begin(), commands.end(), words[0]) == commands.end())
        return UsageError("there is no command \"" + words[0] + "\"" + suggestion(words[0], commands));

    // CLI11 lists what it did not take; the first option among it is the one to explain.
    std::vector<std::string> known;
    const CLI::App* chosen = nullptr;
    for (const CLI::App* command : app.get_subcommands(nullptr))
        if (command->get_name() == words[0]) chosen = command;
    if (chosen) collect_options(*chosen, known);
    if (dynamic_cast<const CLI::ExtrasError*>(&complaint)) {
        for (const std::string& word : words) {
            const std::string name = word.substr(0, word.find('='));
            if (word.rfind("--", 0) == 0 && std::find(known.begin(), known.end(), name) == known.end())
                return UsageError("there is no option \"" + name + "\"" + suggestion(name, known));
        }
    }
    return UsageError(complaint.what());
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
    install_signal_handlers();
    CLI::App app{"trilens draws what curved mirrors and glass show, by projection, and measures its error.",
                 "trilens"};
    app.require_subcommand(1);
    app.set_version_flag("--version", "trilens " + version());
    app.set_help_flag("-h,--help", "print this help");
    CommonOptions common;
    add_common(app, common);
    Chosen chosen;
    CommandRegistry registry;
    registry.app = &app;
    registry.add = [&](CLI::App* command, const std::string& name, CommandBody body) {
        add_common(*command, common);
        command->final_callback([&chosen, name, body = std::move(body)] { chosen = {name, body}; });
    };
    register_render(registry);
    register_compare(registry);
    register_sweep(registry);
    register_project(registry);
    register_scene(registry);
    register_info(registry);

    const std::vector<std::string> words = spelled_out(argc, argv);
    try {
        std::vector<std::string> reversed(words.rbegin(), words.rend());
        app.parse(reversed);
    } catch (const CLI::ParseError& complaint) {
        if (complaint.get_exit_code() == 0) return app.exit(complaint);
        Console console(common.console);
        std::string json = common.json;
        for (const std::string& word : words)
            if (word.rfind("--json=", 0) == 0) json = word.substr(7);
        return fail(words.empty() || words[0][0] == '-' ? "help" : words[0], json, console,
                    usage_error(app, complaint, words));
    }

    common.console.wants_json = !common.json.empty();
    Console console(common.console);
    try {
        set_threads(common.threads);
        const Answer answer = chosen.body(console);
        give_answer(chosen, common, console, answer);
        return static_cast<int>(answer.code);
    } catch (const Error& error) {
        return fail(chosen.name, common.json, console, error);
    } catch (const std::bad_alloc&) {
        return fail(chosen.name, common.json, console, ComputationError("out of memory"));
    } catch (const std::exception& error) {
        return fail(chosen.name, common.json, console,
                    ComputationError(std::string("internal error: ") + error.what()));
    }
}

}  // namespace trilens
