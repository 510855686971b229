// Heights out of pictures: numbers as they are, shares of the greatest where integers have no sign.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;

namespace {

/// A ramp of 5 x 3 samples, 0 on the left to `most` on the right, by oiiotool.
std::string ramp(const std::string& name, const std::string& type, double most, int channels = 1) {
    const std::string folder = trilens_test::scratch_dir("heights_" + name), colour = std::to_string(most);
    std::string left, right;
    for (int c = 0; c < channels; ++c) {
        left += (c > 0 ? ",0" : "0");
        right += (c > 0 ? "," : "") + colour;
    }
    const std::string line = "cd '" + folder + "' && oiiotool --pattern fill:left=" + left +
                             ":right=" + right + " 5x3 " + std::to_string(channels) + " -d " + type + " -o " +
                             name + " > log.txt 2>&1";
    REQUIRE(std::system(line.c_str()) == 0);
    return folder + "/" + name;
}

void check_ramp(const HeightGrid& heights, double most, double tolerance) {
    REQUIRE(heights.columns == 5);
    REQUIRE(heights.rows == 3);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x)
            CHECK(static_cast<double>(heights.at(x, y)) == Approx(most * x / 4).margin(tolerance));
}

void write_heights(const std::string& file, int columns, int rows, const std::vector<float>& values) {
    Image image;
    image.width = image.data_width = columns;
    image.height = image.data_height = rows;
    image.channels.push_back({"Y", values});
    write_exr(file, image);
}

}  // namespace

TEST_CASE("heights of pictures are their numbers, of unsigned integers their shares", "[image]") {
    if (!trilens_test::has_program("oiiotool")) TRILENS_SKIP("needs oiiotool");
    check_ramp(read_heights(ramp("a.png", "uint16", 1)), 1, 1e-5);  // no sRGB in between
    check_ramp(read_heights(ramp("b.png", "uint8", 1)), 1, 0.003);
    check_ramp(read_heights(ramp("c.tif", "float", 1234.5)), 1234.5, 1e-3);
    check_ramp(read_heights(ramp("d.tif", "uint16", 1)), 1, 1e-5);
    check_ramp(read_heights(ramp("e.exr", "half", 8)), 8, 0.01);
    // Signed integers are numbers: shares of 1 are of 32767.
    check_ramp(read_heights(ramp("f.tif", "int16", 1)), 32767, 1);
    const HeightGrid three = read_heights(ramp("g.tif", "uint16", 1, 3));
    check_ramp(three, 1, 1e-5);
    CHECK(three.channels == 3);
}

TEST_CASE("heights that are not finite come as they are", "[image][bad-input]") {
    const std::string file = trilens_test::scratch_dir("odd_heights") + "/h.exr";
    std::vector<float> values(12, 0.25f);
    values[5] = std::numeric_limits<float>::quiet_NaN();
    values[7] = -std::numeric_limits<float>::infinity();
    write_heights(file, 4, 3, values);
    const HeightGrid heights = read_heights(file);
    CHECK(std::isnan(heights.at(1, 1)));
    CHECK(std::isinf(heights.at(3, 1)));
    CHECK(heights.at(0, 2) == 0.25f);
}

TEST_CASE("files of heights that lie, end early or are too large are refused by name", "[image][bad-input]") {
    const std::string folder = trilens_test::scratch_dir("bad_heights");
    CHECK_THROWS_AS(read_heights(folder + "/missing.exr"), InputError);
    CHECK_THROWS_AS(read_heights(folder), InputError);
    const std::string wide = folder + "/wide.exr";
    write_heights(wide, kMostHeightsSide + 1, 2,
                  std::vector<float>(2 * static_cast<std::size_t>(kMostHeightsSide + 1), 1));
    CHECK_THROWS_WITH(read_heights(wide), wide + ": has 8194 x 2 samples, more than 8193 along a side");

    const std::string whole = folder + "/whole.exr", cut = folder + "/cut.exr";
    std::vector<float> noise;
    for (int i = 0; i < 64 * 64; ++i) noise.push_back(static_cast<float>(i * 7919 % 1009));
    write_heights(whole, 64, 64, noise);
    std::ifstream in(whole, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    std::ofstream(cut, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
    CHECK_THROWS_AS(read_heights(cut), InputError);

    if (!trilens_test::has_program("oiiotool")) TRILENS_SKIP("needs oiiotool");
    // A TIFF's header that claims a million times its pixels.
    const std::string lying = ramp("lying.tif", "uint16", 1);
    std::fstream tiff(lying, std::ios::binary | std::ios::in | std::ios::out);
    std::string all{std::istreambuf_iterator<char>(tiff), {}};
    bool changed = false;
    for (std::size_t at = 0; at + 12 <= all.size(); ++at) {
        const auto word = [&](std::size_t k) {
            return static_cast<unsigned char>(all[at + k]) | static_cast<unsigned char>(all[at + k + 1]) << 8;
        };
        // Tags 256 and 257, little-endian: width and length.
        if ((word(0) != 256 && word(0) != 257) || (word(2) != 3 && word(2) != 4) || word(4) != 1) continue;
        all[at + 2] = 4;
        all.replace(at + 8, 4, std::string("\0\x20\0\0", 4));  // 8192
        changed = true;
    }
    REQUIRE(changed);
    tiff.seekp(0);
    tiff << all;
    tiff.close();
    CHECK_THROWS_AS(read_heights(lying), InputError);
}

namespace {

/// A TIFF of 3 x 2 samples, not packed, with GDAL's word for samples that hold nothing.
class TiffWriter {
  public:
    TiffWriter(bool big_endian, bool big) : big_endian_(big_endian), big_(big) {}

    /// `bits` and `format` (1: unsigned, 3: float) of the samples.
    std::string file(const std::string& samples, std::uint64_t bits, std::uint64_t format,
                     const std::string& word) {
        const std::uint64_t data = big_ ? 16 : 8, text = data + samples.size();
        std::string all = (big_endian_ ? "MM" : "II") + number(big_ ? 43 : 42, 2);
        if (big_) all += number(8, 2) + number(0, 2);
        all += number(text + word.size() + 1, offset()) + samples + word + '\0';
        const std::vector<std::array<std::uint64_t, 3>> tags{
            {256, 3, 3}, {257, 3, 2}, {258, 3, bits},           {259, 3, 1},     {262, 3, 1}, {273, 4, data},
            {277, 3, 1}, {278, 3, 2}, {279, 4, samples.size()}, {339, 3, format}};
        all += number(tags.size() + 1, big_ ? 8 : 2);
        for (const auto& [tag, type, value] : tags) {
            const std::size_t size = type == 3 ? 2 : 4;
            all += number(tag, 2) + number(type, 2) + number(1, offset()) + number(value, size) +
                   std::string(offset() - size, '\0');
        }
        all += number(42113, 2) + number(2, 2) + number(word.size() + 1, offset());
        if (word.size() + 1 > offset())
            all += number(text, offset());
        else
            all += word + std::string(offset() - word.size(), '\0');
        return all + number(0, offset());
    }
    std::string number(std::uint64_t value, std::size_t size) const {
        std::string bytes;
        for (std::size_t k = 0; k < size; ++k) bytes += static_cast<char>(value >> 8 * k & 255);
        if (big_endian_) std::reverse(bytes.begin(), bytes.end());
        return bytes;
    }

  private:
    std::size_t offset() const { return big_ ? 8 : 4; }
    bool big_endian_, big_;
};

HeightGrid heights_in(const std::string& bytes) {
    const std::string file = trilens_test::scratch_dir("heights_no_data") + "/a.tif";
    std::ofstream(file, std::ios::binary) << bytes;
    return read_heights(file);
}

}  // namespace

TEST_CASE("samples that a GeoTIFF says hold nothing are no numbers", "[image]") {
    for (const bool big_endian : {false, true})
        for (const bool big : {false, true}) {
            INFO((big_endian ? "MM" : "II") << (big ? " big" : ""));
            TiffWriter tiff(big_endian, big);
            const auto heights = [&](const std::vector<std::uint64_t>& values, std::size_t size,
                                     std::uint64_t format, const std::string& word) {
                std::string samples;
                for (const std::uint64_t value : values) samples += tiff.number(value, size);
                const HeightGrid grid = heights_in(tiff.file(samples, 8 * size, format, word));
                REQUIRE(grid.columns == 3);
                REQUIRE(grid.rows == 2);
                return grid;
            };
            // Floats 0, 1, 2, -9999, 1.5, the lowest of all; 7 has five digits less than the tag has room
            // for.
            const std::vector<std::uint64_t> floats{0,          0x3f800000, 0x40000000,
                                                    0xc61c3c00, 0x3fc00000, 0xff7fffff};
            const HeightGrid some = heights(floats, 4, 3, "-9999");
            CHECK(std::isnan(some.at(0, 1)));
            CHECK(some.at(2, 0) == 2);
            CHECK(!std::isnan(some.at(2, 1)));
            const HeightGrid lowest = heights(floats, 4, 3, "-3.40282346638529e+38");
            CHECK(std::isnan(lowest.at(2, 1)));
            CHECK(!std::isnan(lowest.at(0, 1)));
            CHECK(std::isnan(heights(floats, 4, 3, "2").at(2, 0)));
            for (const char* word : {"nan", "none", "", "1.25"})
                for (const float value : heights(floats, 4, 3, word).values) CHECK(!std::isnan(value));
            const HeightGrid shares = heights({0, 1, 65535, 32767, 32768, 7}, 2, 1, "32767");
            CHECK(std::isnan(shares.at(0, 1)));
            CHECK(shares.at(1, 1) == Approx(32768 / 65535.));
            CHECK(std::isnan(heights({0, 1, 255, 12, 13, 14}, 1, 1, "12").at(0, 1)));
        }
}

TEST_CASE("heights know the numbers of their file", "[image]") {
    if (!trilens_test::has_program("oiiotool")) TRILENS_SKIP("needs oiiotool");
    const auto last = [](const std::string& name, const std::string& type, double most, double raw) {
        const HeightGrid heights = read_heights(ramp(name, type, most));
        INFO(name << " " << heights.at(4, 0));
        CHECK(heights.stands_for(heights.at(4, 0), raw));
        CHECK(!heights.stands_for(heights.at(3, 0), raw));
        CHECK(!heights.stands_for(heights.at(4, 0), raw + 1));
    };
    last("a.png", "uint8", 1, 255);
    last("b.png", "uint8", 100. / 255, 100);
    last("c.png", "uint16", 1, 65535);
    last("d.tif", "uint16", 257. / 65535, 257);
    last("e.tif", "int16", 1, 32767);
    last("f.tif", "float", -32768.1, -32768.1);
    last("g.exr", "half", 0.1, 0.1);
    const HeightGrid bit = read_heights(ramp("h.tif", "uint1", 1));
    CHECK(bit.stands_for(bit.at(4, 0), 1));
    CHECK(!bit.stands_for(bit.at(0, 0), 1));
}
