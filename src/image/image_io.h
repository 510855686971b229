// The library of all other pictures, loaded when the first such picture is met: OpenImageIO brings hundreds
// of libraries with it, and most commands need none of them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/description/marks.h"
#include "base/description/material.h"
#include "base/image/height_grid.h"
#include "base/image/image.h"

namespace trilens {

/// What the library can do; contracts as in image_io.h. It is built with this program, from src/pictures.
struct PictureLibrary {
    const char* version = nullptr;  // of trilens: another one's is refused
    std::shared_ptr<const Texture> (*read)(const std::string& file) = nullptr;
    std::shared_ptr<const Texture> (*decode)(std::span<const unsigned char> encoded,
                                             const std::string& name) = nullptr;
    HeightGrid (*read_heights)(const std::string& file) = nullptr;
    TextMask (*draw_letters)(const TextStyle& style) = nullptr;
    void (*set_threads)(int threads) = nullptr;
};

/// The library, loaded where it is not yet: it lies beside the file of machine code that this function is in,
/// or where the system's loader looks. Null where it is missing, cannot be loaded or belongs to another
/// version; then `reason` says so.
const PictureLibrary* picture_library(std::string& reason);

/// The thread count of the library, now or once it is loaded; 0 means all.
void set_picture_threads(int threads);

/// A library's report as part of an Error's message: one line without a full stop; "unknown reason" where it
/// is empty.
std::string library_reason(const std::string& report);

// Files of pictures: THE door to OpenEXR; other pictures go through a library that is loaded when one is met.

/// Writes one part, scan lines, zip, float32 and uint32 channels in their native types to the last bit (NaN
/// and infinity too); beside its name, then renamed. The file's bytes depend on the image alone: DateTime is
/// SOURCE_DATE_EPOCH where that is set, else 1970. Metadata names must start with "trilens:"; empty values
/// are not kept. Throws OutputError.
void write_exr(const std::string& file, const Image& image);

/// The bytes that write_exr writes. `name`: for messages. Throws OutputError.
std::vector<unsigned char> encode_exr(const std::string& name, const Image& image);

/// Reads every channel of the only part in its native type (half becomes float), and the "trilens:" texts of
/// its header. Channels come layer by layer (in a layer R G B A Z, then the others by name), whatever order
/// they were written in. All or nothing: throws InputError where the file is missing, no OpenEXR, truncated
/// or damaged, has more than one part or deep pixels, or its display window does not start at (0, 0).
Image read_exr(const std::string& file);

/// The same of every part of a file, by name (empty where the file gives none). Throws InputError as read_exr
/// does, and where two parts have one name.
std::vector<std::pair<std::string, Image>> read_exr_parts(const std::string& file);

/// Whether a file starts as OpenEXR files do. Throws InputError where it cannot be read.
bool is_exr_file(const std::string& file);

/// Reads any picture that OpenImageIO knows as linear Rec.709: 8 and 16 bit integer files are taken as sRGB
/// unless they say that they are linear, all others as linear. One or two channels become grey; alpha
/// stands beside colours, which stay as the file has them: is_premultiplied says how that is. Of a file with
/// layers the root R G B are taken; of a data window that is not the display window the display window, black
/// where there is no data. Throws InputError.
std::shared_ptr<const Texture> read_texture(const std::string& file);

/// The same for a PNG, JPEG, WebP, OpenEXR or Radiance file held in memory. `name`: for messages.
std::shared_ptr<const Texture> decode_texture(std::span<const unsigned char> encoded,
                                              const std::string& name);

/// Reads the numbers of the first channel of any picture that OpenImageIO knows, all of its data window: see
/// HeightGrid. Throws InputError, also where a side has more than kMostHeightsSide samples.
HeightGrid read_heights(const std::string& file);

/// A line of text as OpenImageIO and FreeType draw it, as small as it goes. Throws InputError(file, "") with
/// the font's file, or "" where there is no DejaVu Sans, if the font cannot be read; InputError("", "") for a
/// text without letters, or too large.
TextMask draw_letters(const TextStyle& style);

/// An 8-bit sRGB PNG of linear RGB triples, rows from the top; values are clamped to 0..1 before encoding,
/// NaN becomes 0. Beside its name, then renamed. Throws OutputError.
void write_png(const std::string& file, int width, int height, std::span<const float> rgb);

/// The same PNG as bytes in memory. Throws OutputError.
std::vector<unsigned char> encode_png(int width, int height, std::span<const float> rgb);

/// Sets the thread count of OpenImageIO; 0 means all. OpenEXR uses as many as parallel_for.
void set_image_threads(int threads);

/// "OpenImageIO 2.4.7.1, OpenEXR 3.1.5": for `trilens info`.
std::string image_library_version();

}  // namespace trilens

/// The library's only symbol.
extern "C" const trilens::PictureLibrary* trilens_picture_library();
