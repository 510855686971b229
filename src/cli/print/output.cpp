#include "cli/print/output.h"

#include <trilens/files.h>
#include <trilens/stopwatch.h>
#include <cstdio>

namespace trilens {
namespace {

void write_bytes(const void* bytes, std::size_t size) {
    stop_at_once(true);  // a pipe that nobody reads
    if (std::fwrite(bytes, 1, size, stdout) != size || std::fflush(stdout) != 0)
        throw OutputError("standard output", "cannot be written");
}

Answer named(const std::string& output) {
    Answer answer;
    answer.is_report = true;
    answer.fields["output"] = output;
    if (!is_standard_stream(output)) answer.text = output;
    return answer;
}

Answer answer_of(const std::string& output, const Stopwatch& watch, Console& console) {
    console.note_stage("wrote " + (is_standard_stream(output) ? "standard output" : output), watch);
    return named(output);
}

}  // namespace

void check_output(const std::string& output, Console& console) {
    if (is_standard_stream(output) && console.is_stdout_answered())
        throw UsageError(
            "-o - and --json both write to standard output; give one of them a file: --json=FILE");
    console.files().writes(output);
}

Answer name_output(const std::string& output, Console& console) {
    console.note("wrote " + output + " meanwhile");
    return named(output);
}

Answer write_output(const std::string& output, const Image& image, const OutputFormat& format,
                    Console& console) {
    const Stopwatch watch;
    if (is_standard_stream(output)) {
        const std::vector<unsigned char> bytes = encode_image_as(image, format.file, format.tone);
        write_bytes(bytes.data(), bytes.size());
    } else {
        write_image_as(output, image, format.file, format.tone);
    }
    return answer_of(output, watch, console);
}

Answer write_output(const std::string& output, std::span<const unsigned char> encoded, Console& console) {
    const Stopwatch watch;
    if (is_standard_stream(output))
        write_bytes(encoded.data(), encoded.size());
    else
        replace_file(output, encoded);
    return answer_of(output, watch, console);
}

Answer write_output(const std::string& output, const std::string& text, Console& console) {
    const Stopwatch watch;
    if (is_standard_stream(output))
        write_bytes(text.data(), text.size());
    else
        replace_text_file(output, text);
    return answer_of(output, watch, console);
}

}  // namespace trilens
