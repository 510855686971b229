// Completion for zsh: one function of _arguments for each command.
#include "terminal/manual.h"
#include "terminal/option.h"

namespace trilens {
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
