// Textures come out linear, PNGs come out sRGB.
#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>

#include "base/image/texture_lookup.h"
#include "base/util/error.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;

/// libpng jumps out of OpenImageIO past a string of its own when a PNG is cut; no fault of ours to find.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:ImageInput::geterror\n";
}

namespace {

double linear_from_srgb(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

void oiiotool(const std::string& folder, const std::string& arguments) {
    const std::string line = "cd '" + folder + "' && oiiotool " + arguments + " > log.txt 2>&1";
    REQUIRE(std::system(line.c_str()) == 0);
}

std::vector<unsigned char> file_bytes(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void check_constant(const Texture& texture, std::array<double, 3> rgb, double tolerance) {
    REQUIRE(texture.rgb.size() ==
            3 * static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height));
    for (std::size_t i = 0; i < texture.rgb.size(); ++i)
        REQUIRE(static_cast<double>(texture.rgb[i]) == Approx(rgb[i % 3]).margin(tolerance));
}

}  // namespace

TEST_CASE("a picture with a NaN or an infinity is refused by name", "[image][bad-input]") {
    const std::string file = trilens_test::scratch_dir("odd_texture") + "/sky.exr";
    for (const float odd :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Image image;
        image.width = image.data_width = image.height = image.data_height = 4;
        for (const char* name : {"R", "G", "B"})
            image.channels.push_back({name, std::vector<float>(16, 0.5f)});
        write_exr(file, image);
        CHECK(read_texture(file)->width == 4);
        image.channels[1].floats()[3] = odd;
        write_exr(file, image);
        CHECK_THROWS_WITH(read_texture(file), file + ": holds a value that is not finite");
    }
}

TEST_CASE("a PNG read back is the linear picture to half a step", "[image]") {
    const std::string folder = trilens_test::scratch_dir("png");
    std::vector<float> rgb;
    for (int i = 0; i < 1024; ++i)
        for (const double power : {1.0, 2.0, 3.0})
            rgb.push_back(static_cast<float>(std::pow(i / 1023.0, power)));
    write_png(folder + "/a.png", 32, 32, rgb);
    const auto texture = read_texture(folder + "/a.png");
    REQUIRE(texture->width == 32);
    REQUIRE(texture->height == 32);
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        // Half a step of 1/255 in sRGB, as a difference of linear values: at most half a step times the
        // slope 2.3.
        CHECK(static_cast<double>(texture->rgb[i]) ==
              Approx(static_cast<double>(rgb[i])).margin(0.5 / 255 * 2.3));
    }
    const auto decoded = decode_texture(encode_png(32, 32, rgb), "memory");
    CHECK(decoded->rgb == texture->rgb);
    CHECK(file_bytes(folder + "/a.png") == encode_png(32, 32, rgb));
}

TEST_CASE("every 8-bit value survives reading and writing", "[image]") {
    std::vector<float> rgb;
    for (int i = 0; i < 256; ++i)
        for (int c = 0; c < 3; ++c) rgb.push_back(static_cast<float>(linear_from_srgb(i / 255.0)));
    const auto first = decode_texture(encode_png(16, 16, rgb), "first");
    for (std::size_t i = 0; i < rgb.size(); ++i) CHECK(first->rgb[i] == Approx(rgb[i]).epsilon(1e-6));
    CHECK(encode_png(16, 16, first->rgb) == encode_png(16, 16, rgb));
}

TEST_CASE("every value is stored as the nearest step of sRGB", "[image]") {
    // Every 9973rd float of (0, 1], and those next to where two steps meet.
    std::vector<float> values;
    for (std::uint32_t bits = 1; bits <= std::bit_cast<std::uint32_t>(1.0f); bits += 9973)
        values.push_back(std::bit_cast<float>(bits));
    for (int step = 0; step < 255; ++step) {
        float at = static_cast<float>(linear_from_srgb((step + 0.5) / 255));
        for (int k = 0; k < 4; ++k) at = std::nextafter(at, 0.0f);
        for (int k = 0; k < 8; ++k) values.push_back(at), at = std::nextafter(at, 1.0f);
    }
    while (values.size() % 3 != 0) values.push_back(0);
    const int pixels = static_cast<int>(values.size() / 3);
    const auto back = decode_texture(encode_png(pixels, 1, values), "steps");
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double v = static_cast<double>(values[i]);
        const double srgb = v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
        wrong += back->rgb[i] != static_cast<float>(linear_from_srgb(std::lround(255 * srgb) / 255.0));
    }
    CHECK(values.size() > 100000);
    CHECK(wrong == 0);
}

TEST_CASE("values outside 0..1 and NaN have a defined colour", "[image][bad-input]") {
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                infinity = std::numeric_limits<float>::infinity();
    const std::vector<float> odd = {-1, 7, nan, infinity, -infinity, 0.5f};
    const std::vector<float> plain = {0, 1, 0, 1, 0, 0.5f};
    CHECK(encode_png(2, 1, odd) == encode_png(2, 1, plain));
}

TEST_CASE("pictures of every kind become linear", "[image]") {
    if (!trilens_test::has_program("oiiotool")) TRILENS_SKIP("needs oiiotool");
    const std::string folder = trilens_test::scratch_dir("textures");
    const std::array<double, 3> stored = {0.8, 0.4, 0.2};
    std::array<double, 3> linear{};
    for (std::size_t c = 0; c < 3; ++c) linear[c] = linear_from_srgb(stored[c]);
    const std::string colour = "--pattern constant:color=0.8,0.4,0.2 24x17 3 ";

    SECTION("integers are sRGB") {
        oiiotool(folder, colour + "-d uint8 -o a.png");
        check_constant(*read_texture(folder + "/a.png"), linear, 1e-6);
        oiiotool(folder, colour + "-d uint16 -o a16.png");
        check_constant(*read_texture(folder + "/a16.png"), linear, 3e-5);
        oiiotool(folder, colour + "-d uint8 --compression jpeg:98 -o a.jpg");
        check_constant(*read_texture(folder + "/a.jpg"), linear, 0.01);
        oiiotool(folder, colour + "-d uint8 -o a.tif");
        check_constant(*read_texture(folder + "/a.tif"), linear, 1e-6);
    }
    SECTION("floats are linear") {
        oiiotool(folder, colour + "-d float -o a.exr");
        check_constant(*read_texture(folder + "/a.exr"), stored, 1e-6);
        oiiotool(folder, colour + "-d half -o half.exr");
        check_constant(*read_texture(folder + "/half.exr"), stored, 1e-3);
        oiiotool(folder, colour + "-o a.hdr");
        check_constant(*read_texture(folder + "/a.hdr"), stored, 0.01);
    }
    SECTION("integers that say so are linear") {
        oiiotool(folder,
                 colour + "-d uint8 --attrib oiio:ColorSpace Linear --attrib oiio:Gamma 1.0 -o linear.png");
        check_constant(*read_texture(folder + "/linear.png"), stored, 1e-6);
    }
    SECTION("one channel is grey, with alpha or without; alpha does not darken") {
        oiiotool(folder, "--pattern constant:color=0.4 9x9 1 -d uint8 -o grey.png");
        check_constant(*read_texture(folder + "/grey.png"), {linear[1], linear[1], linear[1]}, 1e-6);
        oiiotool(folder,
                 "--pattern constant:color=0.4,0.4 9x9 2 --chnames Y,A -d uint8 "
                 "--attrib oiio:UnassociatedAlpha 1 -o grey_alpha.png");
        check_constant(*read_texture(folder + "/grey_alpha.png"), {linear[1], linear[1], linear[1]}, 1e-6);
        oiiotool(folder,
                 "--pattern constant:color=0.8,0.4,0.2,0.4 9x9 4 -d uint8 "
                 "--attrib oiio:UnassociatedAlpha 1 -o alpha.png");
        check_constant(*read_texture(folder + "/alpha.png"), linear, 1e-6);
    }
    SECTION("alpha stands beside colours, of OpenEXR multiplied by it, of TIFF straight whichever it was") {
        const std::string pattern = "--pattern constant:color=0.2,0.3,0.05,0.5 9x9 4 -d float ";
        oiiotool(folder, pattern + "-o alpha.exr");
        const auto exr = read_texture(folder + "/alpha.exr");
        check_constant(*exr, {0.2, 0.3, 0.05}, 1e-6);
        CHECK(exr->alpha == std::vector<float>(81, 0.5F));
        CHECK(exr->is_premultiplied);
        CHECK(decode_texture(file_bytes(folder + "/alpha.exr"), "exr")->is_premultiplied);
        oiiotool(folder, pattern + "-o associated.tif");
        oiiotool(folder, pattern + "--attrib oiio:UnassociatedAlpha 1 -o straight.tif");
        const auto tiff_of = [&](const std::string& name, const std::array<double, 3>& colours) {
            const auto tiff = read_texture(folder + "/" + name);
            INFO(name);
            check_constant(*tiff, colours, 1e-6);
            CHECK(!tiff->is_premultiplied);
            CHECK(tiff->alpha == std::vector<float>(81, 0.5F));
        };
        tiff_of("associated.tif", {0.4, 0.6, 0.1});
        tiff_of("straight.tif", {0.2, 0.3, 0.05});
    }
    SECTION("a picture whose camera was held otherwise is turned upright, whatever the file") {
        // Exif 2.3, table of Orientation: which side of the upright picture row 0 and column 0 are.
        constexpr std::array kSides{"TL", "TR", "BR", "BL", "LT", "RT", "RB", "LB"};
        for (const std::string kind : {"tif", "jpg"})
            for (std::size_t held = 1; held <= 8; ++held) {
                const auto held_file = [&](std::size_t tag) {
                    const std::string name = "held" + std::to_string(tag) + "." + kind;
                    oiiotool(folder,
                             "--pattern fill:topleft=0.1,0.2,0.3,1:topright=0.9,0.2,0.4,0.9:"
                             "bottomleft=0.1,0.8,0.5,0.8:bottomright=1,1,0.6,0.7 16x8 4 " +
                                 std::string(kind == "jpg" ? "--ch R,G,B " : "") + "--attrib Orientation " +
                                 std::to_string(tag) + " -d uint8 -o " + name);
                    return name;
                };
                const auto plain = read_texture(folder + "/" + held_file(1));
                const std::string name = held_file(held);
                const auto upright = read_texture(folder + "/" + name);
                INFO(name);
                REQUIRE(upright->width == (held < 5 ? 16 : 8));
                REQUIRE(upright->height == (held < 5 ? 8 : 16));
                std::size_t off = 0;
                for (int y = 0; y < 8; ++y)
                    for (int x = 0; x < 16; ++x) {
                        int to_x = 0, to_y = 0;
                        for (const auto& [side, inward] :
                             {std::pair{kSides[held - 1][0], y}, std::pair{kSides[held - 1][1], x}}) {
                            if (side == 'L') to_x = inward;
                            if (side == 'R') to_x = upright->width - 1 - inward;
                            if (side == 'T') to_y = inward;
                            if (side == 'B') to_y = upright->height - 1 - inward;
                        }
                        const auto from = static_cast<std::size_t>(y * 16 + x),
                                   to = static_cast<std::size_t>(to_y * upright->width + to_x);
                        for (std::size_t c = 0; c < 3; ++c)
                            off += upright->rgb[3 * to + c] != plain->rgb[3 * from + c];
                        if (kind != "jpg") off += upright->alpha[to] != plain->alpha[from];
                    }
                CHECK(off == 0);
                if (kind == "jpg")
                    CHECK(decode_texture(file_bytes(folder + "/" + name), "held")->rgb == upright->rgb);
            }
    }
    SECTION("a data window is placed in its display window") {
        oiiotool(folder,
                 "--pattern constant:color=1,1,1 4x3 3 --origin +2+1 --fullsize 8x6+0+0 -o window.exr");
        const auto texture = read_texture(folder + "/window.exr");
        REQUIRE(texture->width == 8);
        REQUIRE(texture->height == 6);
        for (std::size_t y = 0; y < 6; ++y) {
            for (std::size_t x = 0; x < 8; ++x) {
                const bool inside = x >= 2 && x < 6 && y >= 1 && y < 4;
                CHECK(texture->rgb[3 * (y * 8 + x)] == (inside ? 1.0f : 0.0f));
            }
        }
    }
    SECTION("files in memory are the files") {
        for (const std::string name : {"m.png", "m.jpg", "m.exr", "m.hdr"}) {
            oiiotool(
                folder,
                "--pattern fill:topleft=1,0,0:topright=0,1,0:bottomleft=0,0,1:bottomright=1,1,1 33x21 3 -o " +
                    name);
            const auto from_file = read_texture(folder + "/" + name);
            const auto bytes = file_bytes(folder + "/" + name);
            const auto from_memory = decode_texture(bytes, name);
            CHECK(from_memory->width == 33);
            CHECK(from_memory->rgb == from_file->rgb);
        }
    }
    SECTION("a truncated PNG is an error") {
        oiiotool(folder, "--pattern noise 40x40 3 -d uint8 -o noise.png");
        const auto bytes = file_bytes(folder + "/noise.png");
        for (std::size_t length = 0; length + 60 < bytes.size(); length += 611) {
            INFO("length " << length << " of " << bytes.size());
            CHECK_THROWS_AS(decode_texture(std::span(bytes).first(length), "cut"), InputError);
        }
    }
}

TEST_CASE("what is no picture is an InputError that names it", "[image][bad-input]") {
    const std::string folder = trilens_test::scratch_dir("no_texture");
    std::ofstream(folder + "/a.png") << "not a picture at all";
    CHECK_THROWS_AS(read_texture(folder + "/a.png"), InputError);
    CHECK_THROWS_AS(read_texture(folder + "/missing.png"), InputError);
    CHECK_THROWS_AS(read_texture(folder), InputError);
    const std::vector<unsigned char> noise(100, 7), none;
    CHECK_THROWS_AS(decode_texture(noise, "noise"), InputError);
    CHECK_THROWS_AS(decode_texture(none, "none"), InputError);
    try {
        decode_texture(noise, "truck.glb image 2");
    } catch (const InputError& error) {
        CHECK(std::string(error.what()).find("truck.glb image 2") == 0);
    }
    CHECK_THROWS_AS(write_png(folder + "/no/such.png", 1, 1, std::vector<float>(3)), OutputError);
}

TEST_CASE("textures for graphics cards are refused by the name of their kind", "[image][bad-input]") {
    using namespace std::string_literals;
    const std::string folder = trilens_test::scratch_dir("card_textures");
    const auto refusal = [](const auto& read) {
        try {
            read();
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string rest =
        ", a texture for graphics cards, which is not read: give it as PNG, JPEG or OpenEXR";
    for (const auto& [magic, kind] :
         {std::pair("\xabKTX 20\xbb\r\n\x1a\n"s, "KTX2"), std::pair("\xabKTX 11\xbb\r\n\x1a\n"s, "KTX"),
          std::pair("sB\x13\0"s, "Basis Universal")}) {
        // By its bytes, whatever its name.
        for (const char* name : {"/a.ktx2", "/a.jpg"}) {
            const std::string file = folder + name, bytes = magic + std::string(80, '\0');
            std::ofstream(file, std::ios::binary) << bytes;
            CHECK(refusal([&] { read_texture(file); }) == file + ": is " + kind + rest);
            CHECK(refusal([&] { read_heights(file); }) == file + ": is " + kind + rest);
            const std::vector<unsigned char> encoded(bytes.begin(), bytes.end());
            CHECK(refusal([&] { decode_texture(encoded, "a.glb image 0"); }) ==
                  "a.glb image 0: is " + std::string(kind) + rest);
        }
        // Cut off within the signature it is nothing.
        const std::vector<unsigned char> cut(magic.begin(), magic.end() - 1);
        CHECK(refusal([&] { decode_texture(cut, "cut"); }) ==
              "cut: is neither PNG, JPEG, WebP, OpenEXR nor Radiance");
    }
}

TEST_CASE("the library says which it is", "[image]") {
    CHECK(image_library_version().find("OpenImageIO 2.") == 0);
}

TEST_CASE("WebP is read from memory, its colours as they are, whatever its alpha", "[image]") {
    // 4 x 1, all of (200, 100, 50), of alpha 255, 128, 16 and 0; without loss, then with some.
    const std::vector<unsigned char> exact = {
        0x52, 0x49, 0x46, 0x46, 0x26, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56, 0x50, 0x38, 0x4c,
        0x1a, 0x00, 0x00, 0x00, 0x2f, 0x03, 0x00, 0x00, 0x10, 0x1f, 0x30, 0x64, 0x83, 0x3c, 0x32, 0x02,
        0x01, 0x42, 0x82, 0x54, 0x07, 0xd6, 0xe3, 0x40, 0x84, 0xd1, 0x8d, 0x88, 0xfe, 0x07};
    const std::vector<unsigned char> lossy = {
        0x52, 0x49, 0x46, 0x46, 0x5e, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56, 0x50, 0x38, 0x58, 0x0a,
        0x00, 0x00, 0x00, 0x10, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00, 0x41, 0x4c, 0x50, 0x48,
        0x05, 0x00, 0x00, 0x00, 0x00, 0xff, 0x80, 0x10, 0x00, 0x00, 0x56, 0x50, 0x38, 0x20, 0x32, 0x00, 0x00,
        0x00, 0xd0, 0x01, 0x00, 0x9d, 0x01, 0x2a, 0x04, 0x00, 0x01, 0x00, 0x00, 0xc0, 0x12, 0x25, 0xa0, 0x02,
        0x74, 0xba, 0x01, 0xf8, 0x00, 0x03, 0xb0, 0x00, 0xfe, 0xda, 0x26, 0xff, 0xee, 0xf3, 0x7e, 0xd3, 0xd7,
        0xb4, 0xf5, 0xfd, 0x4c, 0xff, 0xf8, 0xca, 0x9f, 0x20, 0x3f, 0xe3, 0x2a, 0x7f, 0xc5, 0xcc, 0x00, 0x00};
    const std::string file = trilens_test::scratch_dir("image_webp") + "/a.webp";
    const auto holds = [](const Texture& texture, double within) {
        REQUIRE(texture.width == 4);
        REQUIRE(texture.height == 1);
        REQUIRE(texture.alpha.size() == 4);
        constexpr std::array kAlpha{255, 128, 16, 0};
        constexpr std::array kColour{200, 100, 50};
        for (std::size_t x = 0; x < 4; ++x) {
            CHECK(std::fabs(static_cast<double>(texture.alpha[x]) - kAlpha[x] / 255.0) < 1e-6);
            for (std::size_t c = 0; c < 3; ++c)
                CHECK(std::fabs(static_cast<double>(texture.rgb[3 * x + c]) -
                                linear_from_srgb(kColour[c] / 255.0)) < within);
        }
    };
    for (const auto& [encoded, within] : {std::pair(exact, 1e-6), std::pair(lossy, 0.02)}) {
        holds(*decode_texture(encoded, "a.glb image 0"), within);
        std::ofstream(file, std::ios::binary)
            .write(reinterpret_cast<const char*>(encoded.data()),
                   static_cast<std::streamsize>(encoded.size()));
        holds(*read_texture(file), within);
        for (std::size_t length = 12; length + 4 < encoded.size(); ++length) {
            const std::vector<unsigned char> cut(encoded.begin(),
                                                 encoded.begin() + static_cast<std::ptrdiff_t>(length));
            CHECK_THROWS_AS(decode_texture(cut, "a.glb image 0"), InputError);
        }
    }
}

TEST_CASE("A WebP of one colour is no damage, however small it is", "[image]") {
    // 1024 x 1024 of (128, 128, 255).
    const std::vector<unsigned char> encoded = {
        0x52, 0x49, 0x46, 0x46, 0x50, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56, 0x50, 0x38,
        0x4c, 0x43, 0x00, 0x00, 0x00, 0x2f, 0xff, 0xc3, 0xff, 0x00, 0x07, 0x50, 0xc0, 0x02, 0xf6,
        0xbf, 0xff, 0x01, 0x81, 0x40, 0xb2, 0xbf, 0xf9, 0x04, 0x45, 0xf4, 0x3f, 0xe3, 0x3f, 0xff,
        0xf9, 0xcf, 0x7f, 0xfe, 0xf3, 0x9f, 0xff, 0xfc, 0xe7, 0x3f, 0xff, 0xf9, 0xcf, 0x7f, 0xfe,
        0xf3, 0x9f, 0xff, 0xfc, 0xe7, 0x3f, 0xff, 0xf9, 0xcf, 0x7f, 0xfe, 0xf3, 0x9f, 0xff, 0xfc,
        0xe7, 0x3f, 0xff, 0xf9, 0xcf, 0x7f, 0xfe, 0xf3, 0x9f, 0xff, 0xfc, 0xdf, 0x00};
    const std::shared_ptr<const Texture> texture = decode_texture(encoded, "flat");
    CHECK(texture->width == 1024);
    CHECK(texture->height == 1024);
    CHECK(texture->alpha.empty());
    CHECK(texture->rgb.back() == 1);
}
