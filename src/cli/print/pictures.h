// What `trilens render` and `trace` answer of a picture, and where it goes: a file, or standard output.
#pragma once

#include <trilens/image.h>
#include <trilens/render.h>

#include <span>
#include <string>

#include "terminal/command.h"
#include "terminal/libraries.h"

namespace trilens {

/// Size, counts, what was left out and seconds: fields of `trilens.render/1` and `trilens.trace/1`.
Json picture_fields(const Renderer& renderer, const Picture& picture);

/// The same of a picture as lines, or, with caustics, of an OBJ.
Json drawing_fields(const Film& film, const LineChoice& choice, const LineDrawing& drawing);

/// One line for those who want to read along.
std::string picture_note(const Picture& picture);

// Where a command's picture goes: a file, or standard output.

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
