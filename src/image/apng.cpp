#include "image/apng.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/util/error.h"
#include "image/png_file.h"

namespace trilens {
namespace {

constexpr std::size_t kAroundData = 12;  // of a chunk: length, type and checksum

void put16(Bytes& bytes, std::uint32_t value) {
    for (const int shift : {8, 0}) bytes.push_back(static_cast<unsigned char>(value >> shift));
}
std::vector<PngChunk> chunks_of(std::span<const unsigned char> png) {
    const auto damaged = [] { return InputError("animation", "", "a frame is no PNG, or a damaged one"); };
    if (png.size() < kPngSignature.size() ||
        !std::equal(kPngSignature.begin(), kPngSignature.end(), png.begin()))
        throw damaged();
    std::vector<PngChunk> chunks;
    for (std::size_t at = kPngSignature.size(); at < png.size();) {
        if (png.size() - at < kAroundData) throw damaged();
        const std::size_t size = read32(png.subspan(at));
        if (size > png.size() - at - kAroundData) throw damaged();
        chunks.push_back(
            {{reinterpret_cast<const char*>(png.data()) + at + 4, 4}, png.subspan(at + 8, size)});
        at += kAroundData + size;
    }
    if (chunks.size() < 3 || chunks.front().type != "IHDR" || chunks.front().data.size() != 13)
        throw damaged();
    return chunks;
}

/// How long a frame stands, as a fraction of seconds.
struct Delay {
    std::uint32_t numerator = 1, denominator = 24;
};

Delay delay_of(double fps) {
    if (!(fps >= 0.001 && fps <= 1000)) throw UsageError("frames per second are 0.001 to 1000");
    // The fraction of 16 bits that lies nearest.
    Delay best;
    double least = 1e300;
    for (std::uint32_t denominator = 1; denominator <= 60000; ++denominator) {
        const double numerator = std::round(denominator / fps);
        if (numerator < 1 || numerator > 65535) continue;
        const double off = std::fabs(numerator / denominator * fps - 1);
        if (off < least - 1e-12) best = {static_cast<std::uint32_t>(numerator), denominator}, least = off;
    }
    return best;
}

Bytes frame_control(std::uint32_t number, std::span<const unsigned char> header, const Delay& delay) {
    Bytes data;
    put32(data, number);
    data.insert(data.end(), header.begin(), header.begin() + 8);  // width and height
    put32(data, 0);                                               // at the top left
    put32(data, 0);
    put16(data, delay.numerator);
    put16(data, delay.denominator);
    data.push_back(0);  // leave the frame as it is
    data.push_back(0);  // replace what was there
    return data;
}

}  // namespace

std::vector<unsigned char> encode_apng(std::span<const std::vector<unsigned char>> pngs, double fps) {
    if (pngs.empty()) throw UsageError("an animation has at least one frame");
    const Delay delay = delay_of(fps);
    const std::vector<PngChunk> first = chunks_of(pngs[0]);
    const std::span<const unsigned char> header = first[0].data;
    Bytes file(kPngSignature.begin(), kPngSignature.end());
    for (const PngChunk& chunk : first) {
        if (chunk.type == "IDAT") break;
        put_png_chunk(file, chunk);
        if (chunk.type != "IHDR") continue;
        Bytes control;
        put32(control, static_cast<std::uint32_t>(pngs.size()));
        put32(control, 0);  // again and again
        put_png_chunk(file, {"acTL", control});
    }
    std::uint32_t number = 0;
    for (std::size_t frame = 0; frame < pngs.size(); ++frame) {
        const std::vector<PngChunk> chunks = chunks_of(pngs[frame]);
        if (!std::equal(header.begin(), header.end(), chunks[0].data.begin(), chunks[0].data.end()))
            throw InputError("animation", "", "the frames differ in size or kind");
        put_png_chunk(file, {"fcTL", frame_control(number++, header, delay)});
        for (const PngChunk& chunk : chunks) {
            if (chunk.type != "IDAT") continue;
            if (frame == 0) {
                put_png_chunk(file, chunk);
                continue;
            }
            Bytes data;
            put32(data, number++);
            data.insert(data.end(), chunk.data.begin(), chunk.data.end());
            put_png_chunk(file, {"fdAT", data});
        }
    }
    put_png_chunk(file, {"IEND", {}});
    return file;
}

}  // namespace trilens
