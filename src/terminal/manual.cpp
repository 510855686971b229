// Manual pages in roff, with the macros of man(7).
#include "terminal/command.h"

#include <trilens/utilities.h>
#include <trilens/version.h>

#include <algorithm>

namespace trilens {
namespace {

/// When the words of the commands were last gone over.
constexpr const char* kDate = "2026-11-21";

/// Breaks lines at spaces, as manual sources are written.
std::string wrapped(const std::string& text) {
    constexpr std::size_t kColumns = 72;
    std::string lines;
    std::size_t column = 0;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t end = std::min(text.find(' ', from), text.size());
        if (column > 0 && column + (end - from) > kColumns) {
            lines += '\n';
            column = 0;
        } else if (column > 0) {
            lines += ' ';
        }
        lines += text.substr(from, end - from);
        column += end - from + 1;
        from = end + 1;
    }
    return lines;
}

/// Text as roff takes it: backslashes and dashes as themselves, no line that starts as a request.
std::string roff(const std::string& text) {
    std::string safe;
    bool is_line_start = true;
    for (const char letter : text) {
        if (is_line_start && (letter == '.' || letter == '\'')) safe += "\\&";
        is_line_start = letter == '\n';
        if (letter == '\\')
            safe += "\\e";
        else if (letter == '-')
            safe += "\\-";
        else if (letter == '~')
            safe += "\\(ti";
        else if (letter == '^')
            safe += "\\(ha";
        else
            safe += letter;
    }
    return safe;
}

std::string page_name(std::string called) {
    for (char& letter : called)
        if (letter == ' ') letter = '-';
    return called;
}

std::string synopsis(const NamedCommand& named) {
    std::string text = ".SH SYNOPSIS\n.B " + roff(named.called) + "\n";
    if (!named.command->commands.empty()) text += ".I COMMAND\n";
    text += ".RI [ OPTIONS ]\n";
    for (const Option& option : named.command->options) {
        if (!is_argument(option)) continue;
        text +=
            option.is_required ? ".I " + roff(option.names) + "\n" : ".RI [ " + roff(option.names) + " ]\n";
        if (takes_many(option)) text += "\\&...\n";
    }
    return text;
}

std::string option_text(const Option& option) {
    std::string names;
    for (const std::string& name : option_names(option))
        names += std::string(names.empty() ? "" : ", ") + (is_argument(option) ? "\\fI" : "\\fB") +
                 roff(name) + "\\fR";
    if (!is_argument(option) && !is_flag(option))
        names += std::string(option.value_follows ? "" : " ") + "\\fI" + roff(value_name(option)) + "\\fR";
    const std::string text = ".TP\n" + names + "\n";
    const std::string taken = takes(option);
    const bool says_more = !is_flag(option) && taken != value_name(option) && !option.value_follows;
    return text + roff(wrapped(option.help + (says_more ? " (" + taken + ")" : ""))) + "\n";
}

std::string options_text(const Command& command, bool is_common) {
    std::string text;
    for (const Option& option : command.options)
        if (option.is_common == is_common) text += option_text(option);
    return text;
}

std::string commands_text(const NamedCommand& group) {
    if (group.command->commands.empty()) return "";
    std::string text = ".SH COMMANDS\n";
    for (const Command& command : group.command->commands)
        text += ".TP\n.BR " + roff(page_name(group.called + " " + command.name)) + " (1)\n" +
                roff(wrapped(command.summary)) + "\n";
    return text;
}

std::string examples_text(const Command& command) {
    std::string text;
    for (const Example& example : command.examples)
        text += (text.empty() ? "" : ".PP\n") + roff(example.what) + ":\n.PP\n.RS\n.nf\n" +
                roff(example.line) + "\n.fi\n.RE\n";
    return text.empty() ? "" : ".SH EXAMPLES\n" + text;
}

constexpr const char* kExitStatus = R"roff(.SH EXIT STATUS
.TP
.B 0
done; of a comparison: within tolerance
.TP
.B 1
tolerance exceeded
.TP
.B 2
the command line makes no sense
.TP
.B 3
an input cannot be used
.TP
.B 4
an output cannot be written
.TP
.B 5
the computation failed
.TP
.B 6
some jobs could not run; the others are valid
.TP
.B 130, 143
interrupted, terminated; what was finished is kept
)roff";

std::string see_also(const NamedCommand& named, const std::vector<NamedCommand>& all) {
    std::string text;
    for (const NamedCommand& other : all) {
        const bool is_above = named.called.rfind(other.called + " ", 0) == 0;
        const bool is_below = other.called.rfind(named.called + " ", 0) == 0;
        if (!is_above && !is_below) continue;
        text += (text.empty() ? ".BR " : " ,\n.BR ") + roff(page_name(other.called)) + " (1)";
    }
    return ".SH SEE ALSO\n" + text + "\n";
}

ManualPage page_of(const NamedCommand& named, const std::vector<NamedCommand>& all) {
    const std::string name = page_name(named.called);
    std::string upper = name;
    for (char& letter : upper)
        if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
    std::string text =
        ".TH " + roff(upper) + " 1 " + kDate + " \"trilens " + version() + "\" \"User Commands\"\n";
    text += ".SH NAME\n" + roff(wrapped(name + " - " + named.command->summary)) + "\n";
    text += synopsis(named) + ".SH DESCRIPTION\n" + roff(wrapped(named.command->summary)) + "\n";
    text += commands_text(named);
    const std::string own = options_text(*named.command, false);
    if (!own.empty()) text += ".SH OPTIONS\n" + own;
    text += ".SH COMMON OPTIONS\n" + options_text(*named.command, true);
    return {name, text + kExitStatus + examples_text(*named.command) + see_also(named, all)};
}

void collect(const Command& command, const std::string& above, std::vector<NamedCommand>& all) {
    const std::string called = (above.empty() ? "" : above + " ") + command.name;
    all.push_back({called, &command});
    for (const Command& below : command.commands) collect(below, called, all);
}

}  // namespace

std::vector<NamedCommand> all_commands(const Command& root) {
    std::vector<NamedCommand> all;
    collect(root, "", all);
    return all;
}

std::vector<ManualPage> manual_pages(const Command& root) {
    const std::vector<NamedCommand> all = all_commands(root);
    std::vector<ManualPage> pages;
    for (const NamedCommand& named : all) pages.push_back(page_of(named, all));
    return pages;
}

// trilens help, man and completion: what the program says of itself.

namespace {

Answer help(const Command& root, const std::vector<std::string>& names) {
    const Located located = locate(root, names);
    if (!located.unknown.empty()) throw unknown_command(located);
    if (!located.rest.empty())
        throw UsageError(located.called() + " has no commands, and so no \"" + located.rest[0] + "\"");
    const std::string text = help_text(located);
    return {.text = text, .fields = {{"command", located.called()}, {"help", text}}};
}

Answer write_pages(const Command& root, const std::string& folder) {
    make_folder(folder);
    Answer answer;
    answer.is_report = true;
    for (const ManualPage& page : manual_pages(root)) {
        const std::string file = folder + "/" + page.name + ".1";
        replace_text_file(file, page.roff);
        answer.text += file + "\n";
        answer.fields["files"].push_back(file);
    }
    return answer;
}

Answer manual(const Command& root, const std::vector<std::string>& names, const std::string& folder) {
    if (!folder.empty() && !names.empty())
        throw UsageError("man takes either a command or --all DIR, not both");
    if (!folder.empty()) return write_pages(root, folder);
    const Located located = locate(root, names);
    if (!located.unknown.empty()) throw unknown_command(located);
    if (!located.rest.empty())
        throw UsageError(located.called() + " has no commands, and so no \"" + located.rest[0] + "\"");
    std::string name = located.called();
    for (char& letter : name)
        if (letter == ' ') letter = '-';
    for (const ManualPage& page : manual_pages(root))
        if (page.name == name)
            return {.text = page.roff, .fields = {{"page", page.name}, {"roff", page.roff}}};
    throw UsageError("there is no page " + name);
}

Answer completion(const Command& root, const std::string& shell) {
    const std::string text = shell == "bash"  ? bash_completion(root)
                             : shell == "zsh" ? zsh_completion(root)
                                              : fish_completion(root);
    return {.text = text, .fields = {{"shell", shell}, {"script", text}}};
}

}  // namespace

std::vector<Command> manual_commands(const Command& root) {
    auto helped = std::make_shared<std::vector<std::string>>(),
         paged = std::make_shared<std::vector<std::string>>();
    auto folder = std::make_shared<std::string>(), shell = std::make_shared<std::string>();
    Command help_command{.name = "help",
                         .summary = "print the help of a command",
                         .options = {{.names = "COMMAND",
                                      .target = helped.get(),
                                      .help = "which; without it, the program",
                                      .offer = Offer::kCommand}},
                         .schema = "help"};
    help_command.body = [&root, helped](Console&) { return help(root, *helped); };

    Command man{.name = "man", .summary = "print a manual page (roff)", .schema = "man"};
    man.options = {{.names = "COMMAND",
                    .target = paged.get(),
                    .help = "of which command; without it, of the program",
                    .offer = Offer::kCommand},
                   {.names = "--all",
                    .target = folder.get(),
                    .help = "write every page into this folder",
                    .value = "DIR",
                    .offer = Offer::kFolder}};
    man.examples = {{"trilens man render | man -l -", "read a page that is not installed"},
                    {"trilens man --all share/man/man1", "write them all"}};
    man.body = [&root, paged, folder](Console&) { return manual(root, *paged, *folder); };

    Command completed{.name = "completion",
                      .summary = "print what completes trilens in a shell",
                      .options = {{.names = "SHELL",
                                   .target = shell.get(),
                                   .help = "which shell",
                                   .choices = {"bash", "zsh", "fish"},
                                   .is_required = true}},
                      .schema = "completion"};
    completed.examples = {
        {"source <(trilens completion bash)", "for this shell"},
        {"trilens completion fish > ~/.config/fish/completions/trilens.fish", "for every fish to come"}};
    completed.body = [&root, shell](Console&) { return completion(root, *shell); };
    return {std::move(help_command), std::move(man), std::move(completed)};
}

}  // namespace trilens
