// Where a command's picture goes: a file, or standard output.
#pragma once

#include <trilens/image.h>
#include <span>
#include <string>

#include "terminal/command.h"

namespace trilens {

struct OutputFormat {
    ImageFormat file = ImageFormat::kExr;
    ToneMapping tone;  // of kPng
};

/// Throws UsageError where `output` is an input, or is standard output and the JSON answer is there too;
/// OutputError where it could not be written. Before long work.
void check_output(const std::string& output, Console& console);

/// The answer for a file that was written while it was drawn.
Answer name_output(const std::string& output, Console& console);

/// Writes the picture and answers with its name; on standard output with the bytes alone. Throws OutputError.
Answer write_output(const std::string& output, const Image& image, const OutputFormat& format,
                    Console& console);

/// The same for a picture that is encoded already.
Answer write_output(const std::string& output, std::span<const unsigned char> encoded, Console& console);

/// The same for text.
Answer write_output(const std::string& output, const std::string& text, Console& console);

}  // namespace trilens
