// What every shell's completion is made of; and bash's.
#include <trilens/scene.h>

#include <map>

#include "terminal/command.h"

namespace trilens {
namespace {

std::string spaced(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

/// The shell function that offers what the value may be.
std::string bash_offer(const Option& option, const Command& root) {
    const std::vector<std::string> words = offered_words(option, root);
    if (!words.empty()) return "_trilens_words \"" + spaced(words) + "\"";
    if (option.offer == Offer::kFolder) return "_trilens_folders";
    if (offers_files(option.offer)) return "_trilens_files \"" + spaced(offered_endings(option.offer)) + "\"";
    return ":";
}

/// One `case` whose patterns are grouped by what they do.
using Cases = std::map<std::string, std::string>;  // what is done -> patterns

void add_case(Cases& cases, const std::string& pattern, const std::string& done) {
    std::string& patterns = cases[done];
    patterns += (patterns.empty() ? "        '" : " | \\\n        '") + pattern + "'";
}

std::string case_text(const std::string& subject, const Cases& cases, const std::string& then) {
    std::string text = "    case \"" + subject + "\" in\n";
    for (const auto& [done, patterns] : cases)
        text += patterns + ")\n            " + done + (then.empty() ? "" : "\n            " + then) + " ;;\n";
    return text + "    esac\n";
}

constexpr const char* kBashStart = R"bash(# bash completion for trilens

_trilens_words() {
    COMPREPLY=($(compgen -W "$1" -- "$cur"))
}

_trilens_folders() {
    compopt -o filenames 2>/dev/null
    local IFS=$'\n'
    COMPREPLY=($(compgen -d -- "$cur"))
}

# Files with one of these endings, and the folders on the way to them; every file where there are no endings.
_trilens_files() {
    compopt -o filenames 2>/dev/null
    local ending endings=$1 IFS=$' \n'
    set -- $endings
    IFS=$'\n'
    COMPREPLY=($(compgen -d -- "$cur"))
    if [ $# -eq 0 ]; then COMPREPLY=($(compgen -f -- "$cur")); fi
    for ending in "$@"; do
        COMPREPLY+=($(compgen -f -X "!*.$ending" -- "$cur"))
    done
}

_trilens() {
    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} command=trilens options="" i
    COMPREPLY=()
    # The shell splits --option=value at the sign.
    if [ "$cur" = "=" ]; then
        cur="" prev="$prev="
    elif [ "$prev" = "=" ] && [ "$COMP_CWORD" -ge 2 ]; then
        prev="${COMP_WORDS[COMP_CWORD-2]}="
    fi
)bash";

constexpr const char* kBashEnd = R"bash(}

complete -F _trilens trilens
)bash";

}  // namespace

std::vector<std::string> offered_words(const Option& option, const Command& root) {
    std::vector<std::string> words = option.choices;
    if (option.offer == Offer::kExample)
        for (const SceneExample& example : scene_examples()) words.push_back(example.name);
    if (option.offer == Offer::kCommand)
        for (const Command& command : root.commands) words.push_back(command.name);
    return words;
}

std::vector<std::string> offered_endings(Offer offer) {
    if (offer == Offer::kScene) return {"json", "gltf", "glb", "exr", "yaml", "txt"};
    if (offer == Offer::kImage) return {"exr", "png", "svg"};
    return {};
}

bool offers_files(Offer offer) {
    return offer == Offer::kScene || offer == Offer::kImage || offer == Offer::kFile;
}

std::string bash_completion(const Command& root) {
    Cases values, arguments, names;
    std::string nested;
    for (const NamedCommand& named : all_commands(root)) {
        std::string options;
        for (const Option& option : named.command->options) {
            if (is_argument(option)) {
                add_case(arguments, named.called, bash_offer(option, root));
                break;
            }
        }
        for (const Option& option : named.command->options) {
            if (is_argument(option)) continue;
            for (const std::string& name : option_names(option)) {
                options += (options.empty() ? "" : " ") + name;
                if (is_flag(option)) continue;
                add_case(values, named.called + " " + name + (option.value_follows ? "=" : ""),
                         bash_offer(option, root));
            }
        }
        add_case(names, named.called, "options=\"" + options + "\"");
        std::vector<std::string> below;
        for (const Command& command : named.command->commands) {
            below.push_back(command.name);
            nested += (nested.empty() ? "'" : " | '") + named.called + " " + command.name + "'";
        }
        if (!below.empty()) add_case(arguments, named.called, "_trilens_words \"" + spaced(below) + "\"");
    }

    // Options whose value may be left out take one behind the sign only.
    std::string follows;
    for (const Option& option : root.options)
        if (option.value_follows)
            for (const std::string& name : option_names(option))
                follows += (follows.empty() ? "" : " | ") + name + "=";
    std::string text = kBashStart;
    text += "    case \"$prev\" in\n        " + follows + ") ;;\n        *) prev=${prev%=} ;;\n    esac\n";
    text +=
        "    for ((i = 1; i < COMP_CWORD; i++)); do\n        case \"$command ${COMP_WORDS[i]}\" in\n         "
        "   " +
        nested + ") command=\"$command ${COMP_WORDS[i]}\" ;;\n        esac\n    done\n";
    text += case_text("$command $prev", values, "return");
    text += case_text("$command", names, "");
    text +=
        "    case \"$cur\" in\n        -*)\n            _trilens_words \"$options\"\n            return ;;\n "
        "   esac\n";
    return text + case_text("$command", arguments, "") + kBashEnd;
}

// Completion for fish: one `complete` for each option and each command.

namespace {

std::string fish_text(const std::string& text) {
    std::string safe = "'";
    for (const char letter : text) {
        if (letter == '\'' || letter == '\\') safe += '\\';
        safe += letter;
    }
    return safe + "'";
}

std::string start(const NamedCommand& named) {
    return "complete -c trilens -n " + fish_text("__trilens_at " + named.called);
}

/// What fish offers for a value: words, files, or nothing.
std::string value_text(const Option& option, const Command& root) {
    std::string words;
    for (const std::string& word : offered_words(option, root)) words += (words.empty() ? "" : " ") + word;
    if (!words.empty()) return " -x -a " + fish_text(words);
    if (option.offer == Offer::kFolder) return " -x -a '(__fish_complete_directories)'";
    return offers_files(option.offer) ? " -r -F" : " -x";
}

std::string option_text(const NamedCommand& named, const Option& option, const Command& root) {
    std::string text = start(named);
    for (const std::string& name : option_names(option))
        text += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!is_flag(option) && !option.value_follows) text += value_text(option, root);
    return text + " -d " + fish_text(option.help) + "\n";
}

/// An argument's words stand alone; -x and -r are of options.
std::string argument_text(const NamedCommand& named, const Option& option, const Command& root) {
    std::string words;
    for (const std::string& word : offered_words(option, root)) words += (words.empty() ? "" : " ") + word;
    if (!words.empty()) return start(named) + " -a " + fish_text(words) + "\n";
    if (option.offer == Offer::kFolder) return start(named) + " -a '(__fish_complete_directories)'\n";
    return offers_files(option.offer) ? start(named) + " -F\n" : "";
}

constexpr const char* kFishStart = R"fish(# fish completion for trilens

# Whether the words so far lead to the command that the arguments name.
function __trilens_at
    set -l at trilens
    set -l words (commandline -opc)
    set -e words[1]
    for word in $words
        switch "$at $word"
            case )fish";

}  // namespace

std::string fish_completion(const Command& root) {
    const std::vector<NamedCommand> all = all_commands(root);
    std::string text = kFishStart;
    for (const NamedCommand& named : all)
        if (named.command != &root) text += fish_text(named.called) + " ";
    text +=
        "\n                set at \"$at $word\"\n        end\n    end\n    test \"$at\" = \"$argv\"\nend\n\n";
    text += "complete -c trilens -f\n";
    for (const NamedCommand& named : all) {
        for (const Command& command : named.command->commands)
            text += start(named) + " -a " + command.name + " -d " + fish_text(command.summary) + "\n";
        for (const Option& option : named.command->options)
            text +=
                is_argument(option) ? argument_text(named, option, root) : option_text(named, option, root);
    }
    return text;
}

// Completion for zsh: one function of _arguments for each command.

namespace {

/// Text within [..] of a specification within single quotes.
std::string zsh_text(const std::string& text) {
    std::string safe;
    for (const char letter : text) {
        if (letter == '[' || letter == ']' || letter == ':' || letter == '\\') safe += '\\';
        if (letter == '\'')
            safe += "'\\''";
        else
            safe += letter;
    }
    return safe;
}

std::string function_name(std::string called) {
    for (char& letter : called)
        if (letter == ' ') letter = '_';
    return "_" + called;
}

/// ":message:action" of a value.
std::string action(const Option& option, const Command& root) {
    std::string words;
    for (const std::string& word : offered_words(option, root)) words += (words.empty() ? "" : " ") + word;
    const std::string message = ":" + zsh_text(value_name(option)) + ":";
    if (!words.empty()) return message + "(" + words + ")";
    if (option.offer == Offer::kFolder) return message + "_files -/";
    if (!offers_files(option.offer)) return message + " ";
    std::string endings;
    for (const std::string& ending : offered_endings(option.offer))
        endings += (endings.empty() ? "" : "|") + ending;
    return message + (endings.empty() ? "_files" : "_files -g \"*.(" + endings + ")\"");
}

std::string specification(const Option& option, const Command& root, std::size_t place) {
    if (is_argument(option))
        return "'" + (takes_many(option) ? "*" : std::to_string(place)) + action(option, root) + "'";
    const std::vector<std::string> names = option_names(option);
    const std::string help = "[" + zsh_text(option.help) + "]";
    const std::string value = is_flag(option) ? "" : (option.value_follows ? ":" : "") + action(option, root);
    std::string excluded, text;
    for (const std::string& name : names) excluded += (excluded.empty() ? "" : " ") + name;
    for (const std::string& name : names) {
        const bool is_long = name.rfind("--", 0) == 0;
        const std::string sign = is_flag(option) ? "" : option.value_follows ? "=-" : is_long ? "=" : "+";
        text += (text.empty() ? "" : " \\\n        ") + std::string("'") +
                (takes_many(option) ? "*" : "(" + excluded + ")") + name + sign + help + value + "'";
    }
    return text;
}

std::string arguments_call(const NamedCommand& named, const Command& root) {
    const bool is_group = !named.command->commands.empty();
    std::string text = std::string("    _arguments -s") + (is_group ? " -C" : "");
    std::size_t place = 0;
    for (const Option& option : named.command->options) {
        place += is_argument(option);
        text += " \\\n        " + specification(option, root, place);
    }
    if (is_group) text += " \\\n        '1: :->command' \\\n        '*:: :->rest'";
    return text + "\n";
}

std::string function_text(const NamedCommand& named, const Command& root) {
    std::string text = function_name(named.called) + "() {\n";
    if (named.command->commands.empty()) return text + arguments_call(named, root) + "}\n\n";
    text += "    local curcontext=\"$curcontext\" state line\n    typeset -A opt_args\n";
    text +=
        arguments_call(named, root) + "    case $state in\n        command)\n            local -a commands\n";
    text += "            commands=(";
    for (const Command& command : named.command->commands)
        text += "\n                '" + command.name + ":" + zsh_text(command.summary) + "'";
    text +=
        ")\n            _describe -t commands command commands ;;\n        rest)\n            case $words[1] "
        "in\n";
    for (const Command& command : named.command->commands)
        text += "                " + command.name + ") " + function_name(named.called + " " + command.name) +
                " ;;\n";
    return text + "            esac ;;\n    esac\n}\n\n";
}

}  // namespace

std::string zsh_completion(const Command& root) {
    std::string text = "#compdef trilens\n# zsh completion for trilens\n\n";
    for (const NamedCommand& named : all_commands(root)) text += function_text(named, root);
    return text +
           "if [ \"$funcstack[1]\" = _trilens ]; then\n    _trilens \"$@\"\nelse\n    compdef _trilens "
           "trilens\nfi\n";
}

}  // namespace trilens
