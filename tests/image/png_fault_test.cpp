// Damaged pictures are told of once: libraries print nothing beside our message; and parts of OpenEXR files.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;

namespace {

/// What reaches the process's stderr meanwhile.
template <typename Work>
std::string heard(const std::string& folder, const Work& work) {
    const std::string file = folder + "/heard.txt";
    std::fflush(stderr);
    const int kept = dup(STDERR_FILENO), caught = open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    REQUIRE(caught >= 0);
    dup2(caught, STDERR_FILENO);
    close(caught);
    work();
    std::fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<unsigned char> some_png() {
    std::vector<float> rgb(3 * 40 * 40);
    for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = static_cast<float>((i * 7919) % 256) / 255;
    return encode_png(40, 40, rgb);
}

}  // namespace

TEST_CASE("a PNG with any damaged byte is read or refused without a word on stderr",
          "[image][png][bad-input]") {
    const std::string folder = trilens_test::scratch_dir("image_talk");
    const std::vector<unsigned char> whole = some_png();
    int refused = 0;
    const std::string said = heard(folder, [&] {
        for (std::size_t at = 0; at < whole.size(); at += 41) {
            std::vector<unsigned char> damaged = whole;
            damaged[at] ^= 0x55;
            try {
                decode_texture(damaged, "damaged");
            } catch (const InputError&) {
                ++refused;
            }
            const std::string file = folder + "/damaged.png";
            std::ofstream(file, std::ios::binary)
                .write(reinterpret_cast<const char*>(damaged.data()),
                       static_cast<std::streamsize>(damaged.size()));
            try {
                read_texture(file);
            } catch (const InputError&) {
                ++refused;
            }
        }
    });
    CHECK(refused > 20);
    CHECK(said.empty());
}

TEST_CASE("parts of an OpenEXR file come by name, each with its channels", "[image][png]") {
    if (!trilens_test::has_program("oiiotool")) TRILENS_SKIP("needs oiiotool");
    const std::string folder = trilens_test::scratch_dir("image_parts");
    const auto make = [&](const std::string& arguments) {
        REQUIRE(std::system(("cd '" + folder + "' && oiiotool " + arguments + " > log.txt 2>&1").c_str()) ==
                0);
    };
    make(
        "--pattern constant:color=0.5,0.25,2 8x6 3 --attrib oiio:subimagename one "
        "--pattern constant:color=7,8,9,1 8x6 4 -d half --attrib oiio:subimagename two --siappend -o "
        "parts.exr");
    const auto parts = read_exr_parts(folder + "/parts.exr");
    REQUIRE(parts.size() == 2);
    CHECK(parts[0].first == "one");
    CHECK(parts[1].first == "two");
    CHECK(parts[0].second.data_width == 8);
    CHECK(parts[1].second.data_width == 8);
    CHECK(parts[1].second.channels.size() == 4);
    for (const float value : parts[0].second.find("B")->floats()) CHECK(value == 2);
    for (const float value : parts[1].second.find("G")->floats()) CHECK(value == 8);
    CHECK_THROWS_AS(read_exr(folder + "/parts.exr"), InputError);
    CHECK(is_exr_file(folder + "/parts.exr"));
    CHECK_FALSE(is_exr_file(folder + "/log.txt"));
    CHECK_THROWS_AS(is_exr_file(folder + "/nothing"), InputError);
}
