// What every shell's completion is made of; and bash's.
#include <trilens/scene.h>
#include <map>

#include "terminal/manual.h"
#include "terminal/option.h"

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
    if (offer == Offer::kScene) return {"json", "exr"};
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

}  // namespace trilens
