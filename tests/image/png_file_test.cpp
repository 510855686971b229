// Ordinary PNGs are read without the library of all pictures, to the same values; the others are left to it.
#include "image/png_file.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "base/util/error.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;

namespace {

using Bytes = std::vector<unsigned char>;

Bytes png_bytes(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

Bytes every_value() {
    std::vector<float> rgb;
    for (int i = 0; i < 768; ++i) rgb.push_back(static_cast<float>(i) / 767);
    return encode_png(16, 16, rgb);
}

/// The file with a chunk after its header, whose checksum is wrong: it is not looked at.
Bytes with_chunk(const Bytes& png, const std::string& type, const Bytes& data) {
    constexpr std::ptrdiff_t kAfterHeader = 33;
    Bytes chunk{0, 0, 0, static_cast<unsigned char>(data.size())};
    chunk.insert(chunk.end(), type.begin(), type.end());
    chunk.insert(chunk.end(), data.begin(), data.end());
    chunk.insert(chunk.end(), {1, 2, 3, 4});
    Bytes file = png;
    file.insert(file.begin() + kAfterHeader, chunk.begin(), chunk.end());
    return file;
}

const PictureLibrary& library() {
    std::string reason;
    const PictureLibrary* library = picture_library(reason);
    INFO(reason);
    REQUIRE(library);
    return *library;
}

}  // namespace

TEST_CASE("an ordinary PNG has the values that the library of all pictures gives it", "[image][oracle]") {
    const Bytes own = every_value();
    const auto texture = decode_ordinary_png(own);
    REQUIRE(texture);
    CHECK(texture->rgb == library().decode(own, "own")->rgb);

    if (!trilens_test::has_program("oiiotool")) TRILENS_SKIP("needs oiiotool");
    const std::string folder = trilens_test::scratch_dir("ordinary_png");
    for (const std::string channels : {"1", "2 --chnames Y,A", "3", "4"}) {
        INFO(channels);
        const std::string file = folder + "/a.png";
        const std::string line = "cd '" + folder + "' && oiiotool --pattern noise:seed=7 23x17 " + channels +
                                 " --attrib oiio:UnassociatedAlpha 1 -d uint8 -o a.png > log.txt 2>&1";
        REQUIRE(std::system(line.c_str()) == 0);
        const auto read = read_ordinary_png(file);
        REQUIRE(read);
        CHECK(read->width == 23);
        CHECK(read->height == 17);
        const auto expected = library().read(file);
        CHECK(read->rgb == expected->rgb);
        REQUIRE(read->alpha.size() == expected->alpha.size());
        CHECK(read->alpha.empty() == (channels == "1" || channels == "3"));
        for (std::size_t i = 0; i < read->alpha.size(); ++i)
            CHECK(std::abs(read->alpha[i] - expected->alpha[i]) < 1e-6F);
        CHECK(decode_ordinary_png(png_bytes(file))->rgb == read->rgb);
    }
    const std::string opaque = "cd '" + folder +
                               "' && oiiotool --pattern constant:color=0.2,0.4,0.6,1 5x3 4 " +
                               "-d uint8 -o opaque.png > log.txt 2>&1";
    REQUIRE(std::system(opaque.c_str()) == 0);
    const auto read = read_ordinary_png(folder + "/opaque.png");
    REQUIRE(read);
    CHECK(read->alpha.empty());
}

TEST_CASE("a PNG with depth, gamma, profile or interlacing of its own is left to the library", "[image]") {
    const Bytes png = every_value();
    REQUIRE(decode_ordinary_png(png));
    Bytes deep = png, interlaced = png;
    deep[24] = 16;
    interlaced[28] = 1;
    CHECK_FALSE(decode_ordinary_png(deep));
    CHECK_FALSE(decode_ordinary_png(interlaced));
    CHECK_FALSE(decode_ordinary_png(with_chunk(png, "gAMA", {0, 1, 0x86, 0xa0})));
    CHECK_FALSE(decode_ordinary_png(with_chunk(png, "gAMA", {0})));
    CHECK_FALSE(decode_ordinary_png(with_chunk(png, "iCCP", {0, 0, 0})));
    CHECK_FALSE(decode_ordinary_png(Bytes(png.rbegin(), png.rend())));
    CHECK_FALSE(decode_ordinary_png({}));
}

TEST_CASE("a damaged or boasting PNG is left to the library, wherever it is cut", "[image][bad-input]") {
    const Bytes png = every_value();
    for (std::size_t length = 0; length + 20 < png.size(); length += 7) {
        INFO("length " << length << " of " << png.size());
        CHECK_FALSE(decode_ordinary_png(std::span(png).first(length)));
    }
    Bytes huge = png;
    huge[16] = huge[20] = 0x7f;
    CHECK_FALSE(decode_ordinary_png(huge));
    huge = png;
    huge[18] = huge[22] = 0x7f;
    CHECK_FALSE(decode_ordinary_png(huge));
    CHECK_THROWS_AS(read_ordinary_png("no/such.png"), InputError);
}
