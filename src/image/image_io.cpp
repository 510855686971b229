#include "image/image_io.h"

#include <dlfcn.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <mutex>

#include "base/files/files.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "base/util/version.h"
#include "image/exr_file.h"
#include "image/png_file.h"
#include "image/png_strips.h"

namespace trilens {

namespace {

constexpr const char* kFile = TRILENS_PICTURES_FILE;

struct Loaded {
    std::mutex mutex;
    const PictureLibrary* library = nullptr;
    int threads = 0;
};

Loaded& loaded() {
    static Loaded one;
    return one;
}

/// The file of machine code that this function is in; empty where the system cannot tell.
std::filesystem::path own_file() {
    Dl_info info{};
    if (!dladdr(reinterpret_cast<const void*>(&picture_library), &info) || !info.dli_fname) return {};
    return info.dli_fname;
}

/// Opens the library, or says why the system could not.
void* open_library(std::string& reason) {
    std::error_code none;
    const std::filesystem::path beside = own_file().parent_path() / kFile;
    const bool is_there = std::filesystem::exists(beside, none);
    void* handle = dlopen(is_there ? beside.c_str() : kFile, RTLD_LAZY | RTLD_LOCAL);
    if (!handle) {
        const char* why = dlerror();
        reason = one_line(why ? why : "unknown reason");
    }
    return handle;
}

const PictureLibrary* load(std::string& reason) {
    void* handle = open_library(reason);
    if (!handle) return nullptr;
    const auto entry =
        reinterpret_cast<decltype(&trilens_picture_library)>(dlsym(handle, "trilens_picture_library"));
    const PictureLibrary* library = entry ? entry() : nullptr;
    if (library && std::string(library->version) == kVersion) return library;
    reason = std::string(kFile) +
             (library ? " is of version " + std::string(library->version) + ", not " + kVersion
                      : " is something else");
    dlclose(handle);
    return nullptr;
}

}  // namespace

const PictureLibrary* picture_library(std::string& reason) {
    Loaded& state = loaded();
    const std::lock_guard lock(state.mutex);
    if (!state.library) {
        state.library = load(reason);
        if (state.library && state.threads > 0) state.library->set_threads(state.threads);
    }
    return state.library;
}

void set_picture_threads(int threads) {
    Loaded& state = loaded();
    const std::lock_guard lock(state.mutex);
    state.threads = threads;
    if (state.library) state.library->set_threads(threads);
}

std::string library_reason(const std::string& report) {
    std::string line;
    for (const char c : report) {
        if (c != '\n' && c != '\r')
            line += c;
        else if (!line.empty() && line.back() != ' ')
            line += ' ';
    }
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
    return line.empty() ? "unknown reason" : line;
}

// Pictures for the eye: any file as a linear texture, linear pixels as an 8-bit PNG.

namespace {

constexpr const char* kNeedsLibrary = "needs trilens' library of pictures, which cannot be loaded: ";

const PictureLibrary& library_to_read(const std::string& name) {
    std::string reason;
    if (const PictureLibrary* library = picture_library(reason)) return *library;
    throw InputError(name, "", kNeedsLibrary + reason);
}

std::vector<unsigned char> encode_named_png(const std::string& name, int width, int height,
                                            std::span<const float> rgb) {
    TRILENS_CHECK(width > 0 && height > 0, "a picture has pixels");
    TRILENS_CHECK(rgb.size() == 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                  "three values per pixel");
    std::vector<unsigned char> stored(rgb.size());
    parallel_for(rgb.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        store_srgb(rgb.subspan(first, last - first), std::span(stored).subspan(first, last - first));
    });
    return encode_stored_png(name, width, height, stored);
}

bool is_exr(std::span<const unsigned char> bytes) {
    constexpr unsigned char kMagic[4] = {0x76, 0x2f, 0x31, 0x01};
    return bytes.size() >= 4 && std::equal(kMagic, kMagic + 4, bytes.begin());
}

/// A channel's values as a texture has them: ids as fractions of their largest.
std::vector<float> as_floats(const Channel& channel) {
    if (!channel.is_id()) return channel.floats();
    std::vector<float> values(channel.ids().size());
    std::transform(channel.ids().begin(), channel.ids().end(), values.begin(),
                   [](Id id) { return static_cast<float>(static_cast<double>(id) / 4294967295.0); });
    return values;
}

/// Which channels are red, green and blue: by name, else the first three, else one grey.
std::array<const Channel*, 3> colour_channels(const Image& image) {
    const std::array named{image.find("R"), image.find("G"), image.find("B")};
    if (named[0] && named[1] && named[2]) return named;
    const std::vector<Channel>& all = image.channels;
    if (all.size() >= 3) return {&all[0], &all[1], &all[2]};
    return {&all[0], &all[0], &all[0]};
}

/// The display window of an OpenEXR file's first part; black, and of no opacity, where there is no data.
std::shared_ptr<const Texture> exr_texture(ExrFile& in, const std::string& name) {
    if (in.is_deep(0)) throw InputError(name, "", "is no flat picture");
    const ExrWindows shape = in.windows(0);
    const Image image = in.read(0);
    for (const Channel& channel : image.channels)
        if (!channel.is_id() && !std::all_of(channel.floats().begin(), channel.floats().end(),
                                             [](float value) { return std::isfinite(value); }))
            throw InputError(name, "", "holds a value that is not finite");

    auto texture = std::make_shared<Texture>();
    texture->width = shape.display_width;
    texture->height = shape.display_height;
    const auto columns = static_cast<std::size_t>(shape.display_width);
    texture->rgb.assign(columns * static_cast<std::size_t>(shape.display_height) * 3, 0);
    const int dx = shape.data_x - shape.display_x, dy = shape.data_y - shape.display_y;
    const int first_x = std::max(0, dx), last_x = std::min(shape.display_width, dx + shape.data_width);
    const int first_y = std::max(0, dy), last_y = std::min(shape.display_height, dy + shape.data_height);
    const auto copy = [&](const Channel& channel, std::vector<float>& into, std::size_t stride,
                          std::size_t c) {
        const std::vector<float> values = as_floats(channel);
        for (int y = first_y; y < last_y; ++y)
            for (int x = first_x; x < last_x; ++x) {
                const std::size_t from =
                    static_cast<std::size_t>(y - dy) * static_cast<std::size_t>(shape.data_width) +
                    static_cast<std::size_t>(x - dx);
                into[stride * (static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)) + c] =
                    values[from];
            }
    };
    std::size_t c = 0;
    for (const Channel* channel : colour_channels(image)) copy(*channel, texture->rgb, 3, c++);
    if (const Channel* alpha = image.find("A")) {
        texture->alpha.resize(texture->rgb.size() / 3);
        copy(*alpha, texture->alpha, 1, 0);
        for (float& value : texture->alpha) value = std::clamp(value, 0.0F, 1.0F);
        texture->is_premultiplied = true;
        texture->drop_opaque_alpha();
    }
    return texture;
}

/// The library of all pictures would say on stderr what is wrong with a PNG.
void require_sound_png(const std::optional<std::string>& fault, const std::string& name) {
    if (fault) throw InputError(name, "", "is no picture, or is damaged: " + *fault);
}

}  // namespace

std::shared_ptr<const Texture> read_texture(const std::string& file) {
    if (std::shared_ptr<const Texture> texture = read_ordinary_png(file)) return texture;
    if (!is_exr_file(file)) {
        require_sound_png(png_fault(file), file);
        return library_to_read(file).read(file);
    }
    ExrFile in(file);
    // Luminance and chroma at different rates are the other library's work.
    if (!in.is_deep(0) && !in.is_sampled_everywhere(0)) return library_to_read(file).read(file);
    return exr_texture(in, file);
}

std::shared_ptr<const Texture> decode_texture(std::span<const unsigned char> encoded,
                                              const std::string& name) {
    if (std::shared_ptr<const Texture> texture = decode_ordinary_png(encoded)) return texture;
    if (!is_exr(encoded)) {
        require_sound_png(png_fault(encoded), name);
        return library_to_read(name).decode(encoded, name);
    }
    ExrFile in(encoded, name);
    if (!in.is_deep(0) && !in.is_sampled_everywhere(0)) return library_to_read(name).decode(encoded, name);
    return exr_texture(in, name);
}

HeightGrid read_heights(const std::string& file) {
    if (!is_exr_file(file)) require_sound_png(png_fault(file), file);
    return library_to_read(file).read_heights(file);
}

TextMask draw_letters(const TextStyle& style) {
    return library_to_read(style.font).draw_letters(style);
}

std::vector<unsigned char> encode_png(int width, int height, std::span<const float> rgb) {
    return encode_named_png("PNG", width, height, rgb);
}

void write_png(const std::string& file, int width, int height, std::span<const float> rgb) {
    replace_file(file, encode_named_png(file, width, height, rgb));
}

void set_image_threads(int threads) {
    set_picture_threads(threads);
}

std::string image_library_version() {
    return TRILENS_IMAGE_LIBRARIES;
}

}  // namespace trilens
