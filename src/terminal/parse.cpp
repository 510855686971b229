#include "terminal/command.h"

#include <trilens/utilities.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <span>

namespace trilens {
namespace {

using Given = std::vector<std::vector<std::string>>;  // per option of the command, its values

/// CLI11 only splits the words: what values mean, and whether they are there, is said in our words.
void add_options(const Command& command, CLI::App& app, Given& given) {
    given.resize(command.options.size());
    for (std::size_t k = 0; k < command.options.size(); ++k) {
        const Option& option = command.options[k];
        std::vector<std::string>& values = given[k];
        CLI::Option* added = nullptr;
        if (is_flag(option)) {
            added = app.add_flag_callback(
                option.names, [&values] { values = {"true"}; }, option.help);
        } else {
            const auto take = [&values](const CLI::results_t& results) {
                values = results;
                return true;
            };
            added = app.add_option(option.names, take, option.help);
            added->type_name(is_argument(option) ? "" : value_name(option));
            added->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)->allow_extra_args(false);
            if (is_argument(option) && takes_many(option)) added->allow_extra_args()->expected(1, -1);
        }
        if (option.is_common) added->group("Common");
        if (is_argument(option) && option.is_required) added->option_text("(required)");
    }
}

void set_up(CLI::App& app) {
    app.set_help_flag();
    app.allow_extras();
}

/// A suggestion where something is near; else where to look.
std::string nearest_or_help(const std::string& word, const std::vector<std::string>& known,
                            const Located& located) {
    const std::string nearest = suggestion(word, known);
    return nearest.find("did you mean") != std::string::npos ? nearest
                                                             : "; see " + located.called() + " --help";
}

// What follows it is no option, whatever it begins with.
const std::string kOptionsEnd = "--";

/// The words of `located` that may be options.
std::span<const std::string> before_options_end(const Located& located) {
    const auto end = std::find(located.rest.begin(), located.rest.end(), kOptionsEnd);
    return {located.rest.begin(), end};
}

/// Throws where a flag is given a value; CLI11 would take some of them.
void check_flags(const Located& located) {
    for (const std::string& word : before_options_end(located)) {
        const std::size_t equals = word.find('=');
        const Option* option = find_option(located.command(), word.substr(0, equals));
        if (equals != std::string::npos && option && is_flag(*option))
            throw UsageError(spoken_name(*option) + " takes no value");
    }
}

/// Throws where an option's value is left out and the next option would be taken for it.
void check_values(const Located& located) {
    const std::span<const std::string> words = before_options_end(located);
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        const Option* option = find_option(located.command(), words[i]);
        if (!option || is_flag(*option) || option->value_follows) continue;
        const std::string& next = words[++i];
        const std::string name = next.substr(0, next.find('='));
        if (name.rfind("--", 0) == 0 && find_option(located.command(), name))
            throw UsageError(spoken_name(*option) + " takes " + takes(*option) + ", but " + name +
                             " follows it");
    }
}

/// The last word must be an option that lacks its value: CLI11 lets an option eat whatever follows.
UsageError missing_value(const Located& located, const CLI::ParseError& complaint) {
    const std::string last = located.rest.empty() ? "" : located.rest.back();
    const bool is_bundle = last.size() > 2 && last[1] != '-';
    const Option* option = find_option(located.command(), is_bundle ? std::string("-") + last.back() : last);
    if (option && !is_flag(*option))
        return UsageError(spoken_name(*option) + " takes " + takes(*option) + ", but nothing follows it");
    return UsageError("the command line cannot be read: " + std::string(complaint.get_name()));
}

UsageError unknown_word(const Located& located, const std::vector<std::string>& extras) {
    std::vector<std::string> known;
    for (const Option& option : located.command().options)
        if (!is_argument(option)) known.push_back(long_name(option));
    const std::span<const std::string> options = before_options_end(located);
    for (const std::string& word : extras) {
        if (word.size() < 2 || word[0] != '-') continue;
        if (std::find(options.begin(), options.end(), word) == options.end()) continue;
        const std::string name = word.substr(0, word.find('='));
        return UsageError("there is no option \"" + name + "\"" + nearest_or_help(name, known, located));
    }
    return UsageError(located.called() + " takes no further argument \"" + extras[0] + "\"");
}

void check_presence(const Command& command, const std::string& called, const Given& given) {
    for (std::size_t k = 0; k < command.options.size(); ++k) {
        const Option& option = command.options[k];
        if (option.is_required && given[k].empty())
            throw UsageError(
                called + " needs " +
                (is_argument(option) ? option.names : spoken_name(option) + " " + value_name(option)) + ": " +
                option.help);
        if (option.excludes.empty() || given[k].empty()) continue;
        for (std::size_t other = 0; other < command.options.size(); ++other)
            if (long_name(command.options[other]) == option.excludes && !given[other].empty())
                throw UsageError(long_name(option) + " and " + option.excludes +
                                 " exclude each other: give one of them");
    }
}

std::string spoken(const std::vector<const Command*>& path) {
    std::string name;
    for (const Command* command : path) name += (name.empty() ? "" : " ") + command->name;
    return name;
}

}  // namespace

std::string Located::called() const {
    return spoken(path);
}

Located locate(const Command& root, const std::vector<std::string>& words) {
    Located located;
    located.path = {&root};
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string& word = words[i];
        if (word == kOptionsEnd) {
            located.rest.insert(located.rest.end(), words.begin() + static_cast<std::ptrdiff_t>(i),
                                words.end());
            break;
        }
        const bool is_option = word.size() > 1 && word[0] == '-';
        if (is_option || located.command().commands.empty()) {
            located.rest.push_back(word);
            const Option* option = is_option ? find_option(located.command(), word) : nullptr;
            const bool takes_next = option && !is_flag(*option) && !option->value_follows;
            if (takes_next && i + 1 < words.size()) located.rest.push_back(words[++i]);
            continue;
        }
        const Command* next = nullptr;
        for (const Command& command : located.command().commands)
            if (command.name == word) next = &command;
        if (!next) {
            located.unknown = word;
            return located;
        }
        located.path.push_back(next);
    }
    return located;
}

UsageError unknown_command(const Located& located) {
    std::vector<std::string> known;
    for (const Command& command : located.command().commands) known.push_back(command.name);
    const std::string group = spoken({located.path.begin() + 1, located.path.end()});
    return UsageError("there is no command \"" + group + (group.empty() ? "" : " ") + located.unknown + "\"" +
                      suggestion(located.unknown, known));
}

void parse_options(const Located& located) {
    const Command& command = located.command();
    check_flags(located);
    check_values(located);
    CLI::App app;
    set_up(app);
    Given given;
    add_options(command, app, given);
    try {
        app.parse(std::vector<std::string>(located.rest.rbegin(), located.rest.rend()));
    } catch (const CLI::ParseError& complaint) {
        throw missing_value(located, complaint);
    }

    for (std::size_t k = 0; k < command.options.size(); ++k)
        if (command.options[k].is_answer && !given[k].empty())
            return set_option(command.options[k], given[k]);
    // CLI11 has taken it for what it is, but leaves it there.
    std::vector<std::string> extras = app.remaining();
    if (const auto end = std::find(extras.begin(), extras.end(), kOptionsEnd); end != extras.end())
        extras.erase(end);
    if (!extras.empty()) throw unknown_word(located, extras);
    for (std::size_t k = 0; k < command.options.size(); ++k) set_option(command.options[k], given[k]);
    if (command.commands.empty()) check_presence(command, located.called(), given);
}

std::string help_text(const Located& located) {
    const Command& command = located.command();
    CLI::App app{command.summary, located.called()};
    set_up(app);
    Given given;
    add_options(command, app, given);
    for (const Command& below : command.commands)
        app.add_subcommand(below.name, below.summary)->set_help_flag();
    std::string text = app.help();
    if (!command.examples.empty()) text += "\nExamples:\n";
    for (const Example& example : command.examples)
        text += "  " + example.line + "\n      " + example.what + "\n";
    return text;
}

}  // namespace trilens
