// Completion for fish: one `complete` for each option and each command.
#include "terminal/manual.h"
#include "terminal/option.h"

namespace trilens {
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

}  // namespace trilens
