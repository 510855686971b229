// Streams of gzip, of one member and of several.
#include <cstdint>
#include <span>
#include <string>

#include "image/zlib_stream.h"
#include "support/test.h"

using namespace trilens;

namespace {

std::string little(std::uint32_t value, int bytes) {
    std::string text;
    for (int k = 0; k < bytes; ++k) text += static_cast<char>(value >> 8 * k & 255);
    return text;
}

/// One member of gzip, its bytes as they are in one block.
std::string member(const std::string& bytes) {
    const auto size = static_cast<std::uint32_t>(bytes.size());
    const std::span all(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    return std::string("\x1f\x8b\x08\0\0\0\0\0\0\3\1", 11) + little(size, 2) + little(~size, 2) + bytes +
           little(png_checksum(all), 4) + little(size, 4);
}

/// What is unpacked; "?" where that is refused.
std::string unpacked(std::string packed, std::size_t size) {
    std::string bytes(size, '\0');
    const bool done = inflate_gzip({reinterpret_cast<unsigned char*>(packed.data()), packed.size()},
                                   {reinterpret_cast<unsigned char*>(bytes.data()), bytes.size()});
    return done ? bytes : "?";
}

}  // namespace

TEST_CASE("gzip is unpacked of one member and of several", "[image]") {
    const std::string whole = "the light of one lamp, and of another";
    CHECK(unpacked(member(whole), whole.size()) == whole);
    for (const std::size_t cut : {1u, 10u, 36u}) {
        const std::string halves = member(whole.substr(0, cut)) + member(whole.substr(cut));
        INFO(cut);
        CHECK(unpacked(halves, whole.size()) == whole);
        CHECK(unpacked(halves + "what follows", whole.size()) == whole);
        CHECK(unpacked(halves, whole.size() + 1) == "?");
        CHECK(unpacked(halves, cut - 1) == "?");
        CHECK(unpacked(halves.substr(0, halves.size() - 9), whole.size()) == "?");
        std::string damaged = halves;
        damaged[damaged.size() - 12] ^= 1;
        CHECK(unpacked(damaged, whole.size()) == "?");
    }
    CHECK(unpacked(member("") + member(whole) + member(""), whole.size()) == whole);
}
