// An animated PNG taken apart again: the chunks that its specification asks for, and every frame's pixels.
#include "image/apng.h"

#include <cstdlib>
#include <fstream>
#include <string>

#include "base/util/error.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;

namespace {

using ApngBytes = std::vector<unsigned char>;

ApngBytes picture(float red, int width = 7) {
    std::vector<float> rgb;
    for (int p = 0; p < width * 5; ++p)
        for (int c = 0; c < 3; ++c) rgb.push_back(c == 0 ? red : static_cast<float>(p % 4) / 4);
    return encode_png(width, 5, rgb);
}

std::size_t at32(const ApngBytes& bytes, std::size_t at) {
    return (std::size_t{bytes[at]} << 24) + (std::size_t{bytes[at + 1]} << 16) +
           (std::size_t{bytes[at + 2]} << 8) + bytes[at + 3];
}

/// The checksum of PNG, bit by bit.
std::size_t crc(const ApngBytes& bytes, std::size_t first, std::size_t last) {
    std::uint32_t sum = 0xffffffffu;
    for (std::size_t i = first; i < last; ++i) {
        sum ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ ((sum & 1) ? 0xedb88320u : 0);
    }
    return sum ^ 0xffffffffu;
}

struct Chunk {
    std::string type;
    ApngBytes data;
};

std::vector<Chunk> chunks(const ApngBytes& bytes) {
    std::vector<Chunk> all;
    for (std::size_t at = 8; at < bytes.size();) {
        const std::size_t size = at32(bytes, at);
        REQUIRE(at + 12 + size <= bytes.size());
        CHECK(at32(bytes, at + 8 + size) == crc(bytes, at + 4, at + 8 + size));
        all.push_back({std::string(bytes.begin() + static_cast<std::ptrdiff_t>(at) + 4,
                                   bytes.begin() + static_cast<std::ptrdiff_t>(at) + 8),
                       ApngBytes(bytes.begin() + static_cast<std::ptrdiff_t>(at) + 8,
                                 bytes.begin() + static_cast<std::ptrdiff_t>(at + 8 + size))});
        at += 12 + size;
    }
    return all;
}

}  // namespace

TEST_CASE("an animated PNG has its frames in order, numbered, each as long as asked", "[image]") {
    const std::vector<ApngBytes> pngs{picture(0.1f), picture(0.5f), picture(0.9f)};
    const ApngBytes file = encode_apng(pngs, 25);
    std::size_t frames = 0, numbers = 0, shown = 0;
    std::vector<ApngBytes> data(3);
    for (const Chunk& chunk : chunks(file)) {
        if (chunk.type == "acTL") shown = at32(chunk.data, 0);
        if (chunk.type == "fcTL") {
            CHECK(at32(chunk.data, 0) == numbers++);
            CHECK((at32(chunk.data, 4) == 7 && at32(chunk.data, 8) == 5));
            const double delay =
                (chunk.data[20] * 256.0 + chunk.data[21]) / (chunk.data[22] * 256.0 + chunk.data[23]);
            CHECK(delay == Approx(1.0 / 25));
            ++frames;
        }
        if (chunk.type == "IDAT") {
            REQUIRE(frames == 1);
            data[0].insert(data[0].end(), chunk.data.begin(), chunk.data.end());
        }
        if (chunk.type == "fdAT") {
            CHECK(at32(chunk.data, 0) == numbers++);
            data[frames - 1].insert(data[frames - 1].end(), chunk.data.begin() + 4, chunk.data.end());
        }
    }
    CHECK((frames == 3 && shown == 3));
    for (std::size_t k = 0; k < 3; ++k) {
        ApngBytes whole;
        for (const Chunk& chunk : chunks(pngs[k]))
            if (chunk.type == "IDAT") whole.insert(whole.end(), chunk.data.begin(), chunk.data.end());
        CHECK(data[k] == whole);
    }
    // A reader that knows no animation shows the first.
    const auto first = decode_texture(file, "animation"), alone = decode_texture(pngs[0], "alone");
    CHECK(first->rgb == alone->rgb);
}

TEST_CASE("a delay that no fraction of 16 bits has is the nearest", "[image]") {
    const std::vector<ApngBytes> pngs{picture(0.1f)};
    for (const double fps : {23.976, 24.0, 29.97, 1000.0, 0.001, 0.3}) {
        for (const Chunk& chunk : chunks(encode_apng(pngs, fps)))
            if (chunk.type == "fcTL")
                CHECK((chunk.data[20] * 256.0 + chunk.data[21]) / (chunk.data[22] * 256.0 + chunk.data[23]) *
                          fps ==
                      Approx(1).epsilon(1e-6));
    }
}

TEST_CASE("what is no animation is refused", "[image][bad-input]") {
    CHECK_THROWS_AS(encode_apng({}, 24), UsageError);
    const std::vector<ApngBytes> different{picture(0.1f), picture(0.1f, 8)}, damaged{ApngBytes(100, 7)},
        good{picture(0.1f)}, cut{ApngBytes(good[0].begin(), good[0].begin() + 50)};
    CHECK_THROWS_AS(encode_apng(different, 24), InputError);
    CHECK_THROWS_AS(encode_apng(damaged, 24), InputError);
    CHECK_THROWS_AS(encode_apng(cut, 24), InputError);
    CHECK_THROWS_AS(encode_apng(good, 0), UsageError);
}
