// trilens help, man and completion: what the program says of itself.
#include <trilens/files.h>

#include "terminal/command.h"
#include "terminal/manual.h"
#include "terminal/option.h"
#include "terminal/parse.h"

namespace trilens {
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
