#include "cad/run_cad.h"

#include <trilens/error.h>
#include <unistd.h>

#include <csignal>

#include "cad/cad_file.h"
#include "cad/cad_scene.h"
#include "cli/print/print.h"

namespace trilens {
namespace {

/// What is said where OpenCASCADE dies of a file, as it does of points without all coordinates.
std::string last_words;

extern "C" void end_with_last_words(int) {
    // Nothing can be done where that fails, too.
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, last_words.data(), last_words.size());
    _exit(static_cast<int>(ExitCode::kInput));
}

void expect_a_crash(const std::string& file) {
    last_words = "trilens: error: " + file + ": cannot be read: OpenCASCADE dies of it\n";
    for (const int signal : {SIGSEGV, SIGFPE, SIGBUS, SIGABRT}) std::signal(signal, end_with_last_words);
}

}  // namespace

Answer run_cad(const CadOptions& options, Console& console) {
    console.files().reads({options.file});
    check_scene_output(options.output, console);
    expect_a_crash(options.file);
    const CadScene scene = scene_of_cad(read_cad_file(options.file, options.deviation), options);
    for (const std::string& warning : scene.warnings) console.warn(warning);
    Answer answer = write_output(options.output, scene.text, console);
    answer.fields.update({{"output", options.output},
                          {"mirrors", scene.mirrors},
                          {"glass", scene.glass},
                          {"objects", scene.objects},
                          {"patches", scene.patches}});
    return answer;
}

}  // namespace trilens
