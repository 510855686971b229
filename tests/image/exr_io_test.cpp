// OpenEXR files keep every bit, or say why not.
#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "image/exr_file.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;

namespace {

/// Random bits in every value: all kinds of NaN, infinities and denormals are among them.
Image random_image(unsigned seed, int data_width, int data_height) {
    std::mt19937 random(seed);
    Image image;
    image.width = data_width + 11;
    image.height = data_height + 7;
    image.x0 = 4;
    image.y0 = 3;
    image.data_width = data_width;
    image.data_height = data_height;
    for (const char* name : {"R", "reflect.object", "G", "B", "Z", "reflect.X", "optic.facet"}) {
        Channel channel;
        channel.name = name;
        const bool id = std::string(name) == "reflect.object" || std::string(name) == "optic.facet";
        if (id)
            channel.values = std::vector<Id>(image.pixels());
        else
            channel.values = std::vector<float>(image.pixels());
        for (std::size_t i = 0; i < image.pixels(); ++i) {
            if (id)
                channel.ids()[i] = static_cast<Id>(random());
            else
                channel.floats()[i] = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
        }
        image.channels.push_back(std::move(channel));
    }
    image.channels[1].ids()[0] = kNone;
    const std::size_t second = image.pixels() > 1 ? 1 : 0;
    image.channels[1].ids()[second] = (1u << 24) + 1;
    image.channels[0].floats()[0] = std::numeric_limits<float>::quiet_NaN();
    image.channels[0].floats()[second] = -std::numeric_limits<float>::infinity();
    image.metadata["trilens:scene"] = "{\"version\":1,\n \"x\":\"\xc3\xa9\"}";
    image.metadata["trilens:command"] = std::string(5000, 'x');
    return image;
}

bool same_bits(const Channel& a, const Channel& b) {
    if (a.is_id() != b.is_id()) return false;
    if (a.is_id()) return a.ids() == b.ids();
    return a.floats().size() == b.floats().size() &&
           std::memcmp(a.floats().data(), b.floats().data(), 4 * a.floats().size()) == 0;
}

void check_same(const Image& a, const Image& b) {
    CHECK(a.width == b.width);
    CHECK(a.height == b.height);
    CHECK(a.x0 == b.x0);
    CHECK(a.y0 == b.y0);
    CHECK(a.data_width == b.data_width);
    CHECK(a.data_height == b.data_height);
    CHECK(a.metadata == b.metadata);
    REQUIRE(a.channels.size() == b.channels.size());
    for (const Channel& channel : a.channels) {
        const Channel* other = b.find(channel.name);
        REQUIRE(other);
        CHECK(same_bits(channel, *other));
    }
}

void put_bytes(const std::string& file, const unsigned char* bytes, std::size_t size) {
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
}

std::size_t files_in(const std::string& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

/// The message of the InputError that reading must throw; empty where it throws none.
std::string reading_error(const std::string& file) {
    try {
        read_exr(file);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("an EXR keeps every bit, the windows and the texts", "[image][law]") {
    const std::string folder = trilens_test::scratch_dir("exr_round_trip");
    const int width = GENERATE(1, 2, 33), height = GENERATE(1, 17, 600);
    const Image image = random_image(static_cast<unsigned>(width * 1000 + height), width + 1, height);
    write_exr(folder + "/a.exr", image);
    check_same(image, read_exr(folder + "/a.exr"));
    CHECK(files_in(folder) == 1);
}

namespace {

/// Few different values, as ids and flat colours are.
Image repetitive_image(unsigned seed, int width, int height) {
    Image image = random_image(seed, width, height);
    std::mt19937 random(seed + 1);
    for (Channel& channel : image.channels)
        for (std::size_t i = 0; i < image.pixels(); ++i) {
            if (channel.is_id())
                channel.ids()[i] = random() % 3 ? 7 : kNone;
            else
                channel.floats()[i] = static_cast<float>(random() % 3) + 0.1f;
        }
    return image;
}

}  // namespace

TEST_CASE("values that deflate shrinks keep every bit as well", "[image][law]") {
    const std::string folder = trilens_test::scratch_dir("exr_shrunk");
    const int width = GENERATE(1, 3, 100), height = GENERATE(1, 16, 70);
    const Image image = repetitive_image(8, width, height);
    write_exr(folder + "/a.exr", image);
    if (image.pixels() > 1000) CHECK(std::filesystem::file_size(folder + "/a.exr") < 14 * image.pixels());
    check_same(image, read_exr(folder + "/a.exr"));
}

TEST_CASE("another program's library reads our files to the last bit", "[image][oracle]") {
    if (!trilens_test::has_program("oiiotool")) TRILENS_SKIP("needs oiiotool");
    const std::string folder = trilens_test::scratch_dir("exr_for_others");
    Image image;
    image.width = image.data_width = 61;
    image.height = image.data_height = 53;
    for (const char* name : {"R", "G", "B"}) {
        std::vector<float> values(image.pixels());
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = std::sin(static_cast<float>(i / 8) * 0.37f + static_cast<float>(name[0]));
        image.channels.push_back({name, values});
    }
    write_exr(folder + "/a.exr", image);
    const std::string codec = GENERATE("none", "zip", "zips", "rle", "piz");
    const std::string line =
        "cd '" + folder + "' && oiiotool a.exr --compression " + codec + " -o b.exr > log.txt 2>&1";
    REQUIRE(std::system(line.c_str()) == 0);
    check_same(image, read_exr(folder + "/b.exr"));
}

TEST_CASE("a file does not depend on how its rows came", "[image]") {
    const Image image = random_image(10, 37, 83);
    const auto whole = encode_exr("whole", image);
    const int step = GENERATE(1, 5, 16, 20, 48, 82, 83);
    ExrStrips strips("strips", image);
    for (int row = 0; row < image.data_height; row += step)
        strips.add(image.channels, row, std::min(step, image.data_height - row));
    CHECK(strips.finish() == whole);

    std::vector<unsigned char> written;
    std::size_t pieces = 0;
    ExrStrips handed("handed on", image, [&](std::uint64_t at, std::span<const unsigned char> bytes) {
        ++pieces;
        written.resize(std::max(written.size(), at + bytes.size()));
        std::copy(bytes.begin(), bytes.end(), written.begin() + static_cast<std::ptrdiff_t>(at));
    });
    for (int row = 0; row < image.data_height; row += step)
        handed.add(image.channels, row, std::min(step, image.data_height - row));
    CHECK(handed.finish().empty());
    CHECK(written == whole);
    CHECK(pieces > (step < 48 ? 3 : 1));
}

TEST_CASE("what the taker of a file's bytes throws comes out", "[image]") {
    const Image image = random_image(11, 37, 83);
    const std::size_t taken = GENERATE(0, 1, 2);
    std::size_t pieces = 0;
    const auto make = [&] {
        ExrStrips strips("strips", image, [&](std::uint64_t, std::span<const unsigned char>) {
            if (pieces++ == taken) throw OutputError("strips", "no room");
        });
        for (int row = 0; row < image.data_height; row += 16)
            strips.add(image.channels, row, std::min(16, image.data_height - row));
        strips.finish();
    };
    CHECK_THROWS_WITH(make(), ContainsSubstring("no room"));
}

TEST_CASE("an image that is written while it is encoded has the encoded bytes", "[image]") {
    const std::string file = trilens_test::scratch_dir("exr_written") + "/a.exr";
    for (const Image& image : {random_image(11, 37, 83), repetitive_image(3, 64, 1500)}) {
        write_exr(file, image);
        const std::vector<unsigned char> encoded = encode_exr("encoded", image);
        CHECK(read_whole_file(file) == std::string(encoded.begin(), encoded.end()));
    }
}

TEST_CASE("a data window may reach beyond the film", "[image]") {
    const std::string folder = trilens_test::scratch_dir("exr_overscan");
    Image image = random_image(5, 20, 10);
    image.width = 12;
    image.height = 6;
    image.x0 = -4;
    image.y0 = -2;
    write_exr(folder + "/a.exr", image);
    check_same(image, read_exr(folder + "/a.exr"));
}

TEST_CASE("an EXR's bytes depend on the image alone", "[image]") {
    const bool shrinks = GENERATE(false, true);
    const Image image = shrinks ? repetitive_image(1, 64, 300) : random_image(1, 64, 300);
    set_thread_count(1);
    const auto one = encode_exr("one", image);
    encode_exr("another", repetitive_image(2, 50, 40));  // what was deflated before leaves no trace
    CHECK(encode_exr("again", image) == one);
    set_thread_count(7);
    const auto seven = encode_exr("seven", image);
    set_thread_count(0);
    CHECK(one == seven);

    REQUIRE(::setenv("SOURCE_DATE_EPOCH", "1700000000", 1) == 0);
    const auto dated = encode_exr("dated", image);
    REQUIRE(::setenv("SOURCE_DATE_EPOCH", "yesterday", 1) == 0);
    CHECK_THROWS_AS(encode_exr("dated", image), OutputError);
    ::unsetenv("SOURCE_DATE_EPOCH");
    const std::string text(dated.begin(), dated.end()), fixed(one.begin(), one.end());
    CHECK(text.find("2023:11:14 22:13:20") != std::string::npos);
    CHECK(fixed.find("1970:01:01 00:00:00") != std::string::npos);
}

TEST_CASE("a truncated EXR is an InputError at every length", "[image][bad-input]") {
    const std::string folder = trilens_test::scratch_dir("exr_truncated");
    const Image image = random_image(2, 19, 40);
    const auto bytes = encode_exr("whole", image);
    const std::string file = folder + "/cut.exr";
    for (std::size_t length = 0; length < bytes.size(); length += length < 1500 ? 1 : 37) {
        put_bytes(file, bytes.data(), length);
        INFO("length " << length << " of " << bytes.size());
        CHECK(reading_error(file).find("cut.exr") != std::string::npos);
    }
    put_bytes(file, bytes.data(), bytes.size() - 1);
    CHECK(reading_error(file) != "");
    put_bytes(file, bytes.data(), bytes.size());
    check_same(image, read_exr(file));
}

TEST_CASE("an EXR whose writer died before the offset table is never read as half an image", "[image]") {
    const std::string folder = trilens_test::scratch_dir("exr_offsets");
    const Image image = random_image(3, 30, 64);  // four blocks of sixteen rows
    const auto bytes = encode_exr("whole", image);

    // The table's first entry points at the first block, which starts right behind the table.
    std::size_t table = 0;
    for (std::size_t i = 8; i + 8 <= bytes.size() && !table; ++i) {
        std::uint64_t offset = 0;
        std::memcpy(&offset, &bytes[i], 8);
        if (offset == i + 4 * 8) table = i;
    }
    REQUIRE(table > 0);
    for (std::size_t entry = 0; entry < 4; ++entry) {
        for (const bool cut : {false, true}) {
            auto damaged = bytes;
            std::memset(&damaged[table + 8 * entry], 0, 8);
            if (cut) damaged.resize(damaged.size() - 100);
            put_bytes(folder + "/a.exr", damaged.data(), damaged.size());
            // The library may find the block again; then the image must be whole.
            const std::string error = reading_error(folder + "/a.exr");
            if (error.empty()) check_same(image, read_exr(folder + "/a.exr"));
            if (cut) CHECK(error != "");
        }
    }
}

TEST_CASE("a damaged EXR is an error or an image, never a crash", "[image][bad-input]") {
    const std::string folder = trilens_test::scratch_dir("exr_damaged");
    const auto bytes = encode_exr("whole", random_image(4, 19, 40));
    std::mt19937 random(99);
    int errors = 0;
    for (int round = 0; round < 400; ++round) {
        auto damaged = bytes;
        const std::size_t reach = round % 2 ? damaged.size() : 900;  // every other time the header alone
        for (unsigned hit = 0; hit < 1 + random() % 4; ++hit)
            damaged[random() % reach] = static_cast<unsigned char>(random());
        put_bytes(folder + "/a.exr", damaged.data(), damaged.size());
        if (!reading_error(folder + "/a.exr").empty()) ++errors;
    }
    CHECK(errors > 50);
}

TEST_CASE("what cannot be read is named with its reason", "[image][bad-input]") {
    const std::string folder = trilens_test::scratch_dir("exr_unreadable");
    CHECK(reading_error(folder + "/missing.exr").find("No such file") != std::string::npos);
    CHECK(reading_error(folder).find("is a folder") != std::string::npos);
    put_bytes(folder + "/text.exr", reinterpret_cast<const unsigned char*>("hello"), 5);
    CHECK(reading_error(folder + "/text.exr").find("no OpenEXR") != std::string::npos);
    // A whole header whose list of channels is empty.
    std::string header("\x76\x2f\x31\x01\x02\0\0\0", 8);
    const auto attribute = [&](const std::string& name, const std::string& type, const std::string& bytes) {
        header += name + '\0' + type + '\0' + static_cast<char>(bytes.size()) + std::string(3, '\0') + bytes;
    };
    const std::string window = std::string(8, '\0') + std::string("\3\0\0\0\3\0\0\0", 8);
    attribute("channels", "chlist", std::string(1, '\0'));
    attribute("compression", "compression", std::string(1, '\0'));
    for (const char* name : {"dataWindow", "displayWindow"}) attribute(name, "box2i", window);
    attribute("lineOrder", "lineOrder", std::string(1, '\0'));
    attribute("pixelAspectRatio", "float", std::string("\0\0\x80\x3f", 4));
    attribute("screenWindowCenter", "v2f", std::string(8, '\0'));
    attribute("screenWindowWidth", "float", std::string("\0\0\x80\x3f", 4));
    header += '\0' + std::string(64, '\0');
    put_bytes(folder + "/none.exr", reinterpret_cast<const unsigned char*>(header.data()), header.size());
    CHECK(reading_error(folder + "/none.exr").ends_with("none.exr: has no channels"));
    put_bytes(folder + "/empty.exr", nullptr, 0);
    CHECK(reading_error(folder + "/empty.exr") != "");
    const std::vector<float> grey(12, 0.5f);
    write_png(folder + "/picture.exr", 2, 2, grey);
    CHECK(reading_error(folder + "/picture.exr") != "");
}

TEST_CASE("what cannot be written is named with its reason and leaves nothing behind", "[image][bad-input]") {
    const std::string folder = trilens_test::scratch_dir("exr_unwritable");
    const Image image = random_image(6, 64, 64);
    const auto writing_error = [&](const std::string& file) -> std::string {
        try {
            write_exr(file, image);
        } catch (const OutputError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(writing_error(folder + "/no/such/a.exr").find("No such file") != std::string::npos);
    std::filesystem::create_directories(folder + "/folder.exr");
    CHECK(writing_error(folder + "/folder.exr").find("directory") != std::string::npos);
    CHECK(files_in(folder) == 1);

    // A full disk, as a limit on the size of files: the old file must survive.
    const Image old = random_image(7, 2, 2);
    write_exr(folder + "/a.exr", old);
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{20000, before.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
    const std::string full = writing_error(folder + "/a.exr");
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    CHECK(full.find("too large") != std::string::npos);
    check_same(old, read_exr(folder + "/a.exr"));
    CHECK(files_in(folder) == 2);
}

TEST_CASE("long names of channels are kept, longer ones than the format holds are an error that says so",
          "[image][bad-input]") {
    Image image = random_image(7, 3, 2);
    const std::string file = trilens_test::scratch_dir("exr_long_names") + "/a.exr";
    for (const std::size_t length : {31, 32, 255}) {
        image.channels.front().name = std::string(length, 'n');
        write_exr(file, image);
        check_same(image, read_exr(file));
    }
    image.channels.front().name = std::string(300, 'n');
    CHECK_THROWS_AS(encode_exr("long.exr", image), OutputError);
    CHECK_THROWS_WITH(encode_exr("long.exr", image), ContainsSubstring("long.exr: cannot be encoded: "));
}

TEST_CASE("files of other programs: half channels, tiles, parts", "[image]") {
    if (!trilens_test::has_program("oiiotool")) TRILENS_SKIP("needs oiiotool");
    const std::string folder = trilens_test::scratch_dir("exr_others");
    const auto make = [&](const std::string& arguments) {
        const std::string line = "cd '" + folder + "' && oiiotool " + arguments + " > log.txt 2>&1";
        REQUIRE(std::system(line.c_str()) == 0);
    };
    make("--pattern constant:color=0.5,0.25,2 70x90 3 -d half --tile 32 16 -o tiled.exr");
    const Image tiled = read_exr(folder + "/tiled.exr");
    REQUIRE(tiled.pixels() == 70 * 90);
    for (const auto& [name, value] : {std::pair{"R", 0.5f}, {"G", 0.25f}, {"B", 2.0f}})
        CHECK(tiled.find(name)->floats() == std::vector<float>(tiled.pixels(), value));

    make("--create 8x8 3 --create 8x8 3 --siappend -o parts.exr");
    CHECK(reading_error(folder + "/parts.exr").find("more than one part") != std::string::npos);
    make("--create 8x8 3 --fullsize 8x8+1+1 -o moved.exr");
    CHECK(reading_error(folder + "/moved.exr").find("display window") != std::string::npos);
}
