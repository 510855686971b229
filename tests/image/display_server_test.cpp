// tev's protocol: recorded bytes, and a small server that puts pictures together from them.
#include "image/display_server.h"

#include <cstring>
#include <map>
#include <random>

#include "base/util/error.h"
#include "support/small_server.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Reads messages as tev does.
struct Reader {
    const std::vector<std::uint8_t>& bytes;
    std::size_t at = 0;

    template <typename Number>
    Number number() {
        REQUIRE(at + sizeof(Number) <= bytes.size());
        Number value;
        std::memcpy(&value, &bytes[at], sizeof value);
        at += sizeof value;
        return value;
    }
    std::string text() {
        std::string found;
        while (const char c = number<char>()) found += c;
        return found;
    }
};

struct Shown {
    int width = 0, height = 0;
    std::map<std::string, std::vector<float>> channels;
    std::size_t tiles = 0;
};

std::map<std::string, Shown> pictures_of(const std::vector<std::uint8_t>& bytes) {
    std::map<std::string, Shown> all;
    Reader in{bytes};
    while (in.at < bytes.size()) {
        const std::size_t end = in.at + in.number<std::uint32_t>();
        const int operation = in.number<char>();
        in.number<char>();
        Shown& shown = all[in.text()];
        if (operation == 4) {
            shown = {};
            shown.width = in.number<std::int32_t>();
            shown.height = in.number<std::int32_t>();
            for (int left = in.number<std::int32_t>(); left > 0; --left)
                shown.channels[in.text()].resize(static_cast<std::size_t>(shown.width * shown.height), -1);
        } else {
            REQUIRE(operation == 6);
            ++shown.tiles;
            std::vector<std::string> names(static_cast<std::size_t>(in.number<std::int32_t>()));
            for (std::string& name : names) name = in.text();
            const int x = in.number<std::int32_t>(), y = in.number<std::int32_t>();
            const int width = in.number<std::int32_t>(), height = in.number<std::int32_t>();
            std::vector<std::int64_t> offset(names.size()), stride(names.size());
            for (std::int64_t& one : offset) one = in.number<std::int64_t>();
            for (std::int64_t& one : stride) one = in.number<std::int64_t>();
            const std::size_t data = in.at;
            for (std::size_t c = 0; c < names.size(); ++c)
                for (int p = 0; p < width * height; ++p) {
                    in.at = data + 4 * static_cast<std::size_t>(offset[c] + p * stride[c]);
                    shown.channels.at(
                        names[c])[static_cast<std::size_t>((y + p / width) * shown.width + x + p % width)] =
                        in.number<float>();
                }
        }
        CHECK(in.at == end);
    }
    return all;
}

Image random_picture(std::mt19937& random, int width, int height) {
    Image image;
    image.width = image.data_width = width;
    image.height = image.data_height = height;
    for (const char* name : {"R", "G", "B", "A", "reflectP.X"}) {
        std::vector<float> values(image.pixels());
        for (float& value : values) value = std::uniform_real_distribution<float>(-2, 9)(random);
        image.channels.push_back({name, values});
    }
    image.channels.push_back({"reflectID.object", std::vector<Id>(image.pixels(), kNone)});
    return image;
}

}  // namespace

TEST_CASE("messages have the bytes that tev reads", "[image][display][golden]") {
    Image image;
    image.width = image.data_width = 2;
    image.height = image.data_height = 1;
    image.channels = {
        {"R", std::vector<float>{1, -2}}, {"ID", std::vector<Id>{7, 8}}, {"Z", std::vector<float>{0, 3}}};
    CHECK(create_image_message("ab", image) ==
          DisplayMessage{25, 0, 0, 0, 4, 1, 'a', 'b', 0, 2, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 'R', 0, 'Z', 0});
    CHECK_THROWS_AS(update_image_message("ab", image.channels, {0, 2, 2}), InputError);
    CHECK(update_image_message("ab", image.channels, {5, 1, 2}) ==
          DisplayMessage{81, 0, 0,    0,    6, 0, 'a', 'b',  0, 2, 0, 0, 0, 'R', 0,    'Z',
                         0,                                                                // name, channels
                         0,  0, 0,    0,    5, 0, 0,   0,    2, 0, 0, 0, 1, 0,   0,    0,  // x, y, size
                         0,  0, 0,    0,    0, 0, 0,   0,    2, 0, 0, 0, 0, 0,   0,    0,  // offsets
                         1,  0, 0,    0,    0, 0, 0,   0,    1, 0, 0, 0, 0, 0,   0,    0,  // strides
                         0,  0, 0x80, 0x3f, 0, 0, 0,   0xc0, 0, 0, 0, 0, 0, 0,   0x40, 0x40});  // 1, -2; 0, 3
}

TEST_CASE("a picture that is sent in strips arrives whole, to the last bit", "[image][display][law]") {
    std::mt19937 random(3);
    for (int round = 0; round < 10; ++round) {
        const Image image =
            random_picture(random, 1 + static_cast<int>(random() % 90), 1 + static_cast<int>(random() % 70));
        SmallServer server;
        std::size_t strips = 0;
        {
            DisplayServer display(server.address());
            const StripSink sink = display.sink("strips");
            sink.begin(image);
            for (int y = 0; y < image.data_height;) {
                const int rows = std::min(image.data_height - y, 1 + static_cast<int>(random() % 20));
                // As a sink gets them: the rows first, and then anything.
                std::vector<Channel> part = image.channels;
                for (Channel& channel : part)
                    std::visit(
                        [&](auto& values) {
                            values.erase(values.begin(), values.begin() + y * image.data_width);
                        },
                        channel.values);
                sink.add(part, rows);
                y += rows;
                ++strips;
            }
            CHECK(display.show("whole", image));
        }
        const auto pictures = pictures_of(server.received());
        REQUIRE(pictures.size() == 2);
        CHECK(pictures.at("strips").tiles == strips);
        for (const auto& [name, shown] : pictures) {
            CHECK((shown.width == image.data_width && shown.height == image.data_height));
            CHECK(shown.channels.size() == 5);  // ids are not sent
            for (const auto& [channel, values] : shown.channels)
                CHECK(values == image.find(channel)->floats());
        }
    }
}

TEST_CASE("a server that goes away in the middle of a tile is one message, and no harm",
          "[image][display][bad-input]") {
    std::mt19937 random(4);
    const Image image = random_picture(random, 800, 600);
    for (const std::size_t most : {1, 40, 5000, 100000}) {
        SmallServer server(most);
        std::vector<std::string> told;
        DisplayServer display(server.address(), [&](const std::string& message) { told.push_back(message); });
        const StripSink sink = display.sink("picture");
        sink.begin(image);
        for (int strip = 0; strip < 60; ++strip) sink.add(image.channels, 10);
        CHECK_FALSE(display.show("another", image));
        REQUIRE(told.size() == 1);
        INFO(told[0]);
        CHECK(told[0].find(server.address()) != std::string::npos);
        CHECK(told[0].find("went away") != std::string::npos);
        CHECK(server.received().size() == most);
    }
}

TEST_CASE("an address is HOST:PORT, and somebody must answer there", "[image][display][bad-input]") {
    for (const char* bad : {"", "localhost", ":14158", "localhost:", "localhost:port", "localhost:0",
                            "localhost:65536", "localhost:141580", "14158"})
        CHECK_THROWS_AS(DisplayServer(bad), UsageError);
    std::string closed;
    {
        SmallServer server(0);
        closed = server.address();
        DisplayServer once(closed);
    }
    CHECK_THROWS_AS(DisplayServer(closed), OutputError);
    CHECK_THROWS_AS(DisplayServer("no.such.host.invalid:14158"), OutputError);
}
