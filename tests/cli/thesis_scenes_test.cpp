// Every scene of the thesis' chapter 4 shows as many separate shapes as its configuration says.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr std::size_t kSpeck = 12;  // pixels

/// The length of the list after `"configuration":`; 0 where there is none.
std::size_t shapes_wanted(const std::string& file) {
    std::ifstream in(file);
    std::stringstream all;
    all << in.rdbuf();
    const std::string text = all.str();
    const std::size_t at = text.find("\"configuration\": [");
    if (at == std::string::npos) return 0;
    std::size_t count = 1;
    for (std::size_t i = at; text[i] != ']'; ++i) count += text[i] == ',';
    return count;
}

/// Regions of covered pixels whose sides or corners touch; a thin tip may fall apart into specks of a pixel
/// or two, which do not count.
std::size_t regions(const Image& image) {
    const std::vector<float>& alpha = image.find("A")->floats();
    const int width = image.width, height = image.height;
    std::vector<char> seen(alpha.size());
    std::size_t count = 0;
    for (std::size_t start = 0; start < alpha.size(); ++start) {
        if (seen[start] || !(alpha[start] > 0)) continue;
        std::size_t size = 0;
        std::vector<std::size_t> stack{start};
        seen[start] = 1;
        while (!stack.empty()) {
            const int x = static_cast<int>(stack.back()) % width, y = static_cast<int>(stack.back()) / width;
            stack.pop_back();
            ++size;
            for (int ny = std::max(0, y - 1); ny <= std::min(height - 1, y + 1); ++ny)
                for (int nx = std::max(0, x - 1); nx <= std::min(width - 1, x + 1); ++nx) {
                    const std::size_t next = static_cast<std::size_t>(ny * width + nx);
                    if (seen[next] || !(alpha[next] > 0)) continue;
                    seen[next] = 1;
                    stack.push_back(next);
                }
        }
        count += size >= kSpeck;
    }
    return count;
}

}  // namespace

TEST_CASE("the thesis' configurations show their shapes, projected and ray traced", "[cli][thesis]") {
    const std::string folder = scratch_dir("thesis_scenes");
    std::size_t scenes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(source_dir() + "/scenes/thesis")) {
        const std::string file = entry.path().string();
        const std::size_t wanted = shapes_wanted(file);
        if (wanted == 0) continue;
        ++scenes;
        INFO(file);
        for (const std::string command : {"render ", "trace "}) {
            REQUIRE(run_trilens(command + file + " --spp 1 -o " + folder + "/out.exr").exit_code == 0);
            CHECK(regions(read_exr(folder + "/out.exr")) == wanted);
        }
    }
    CHECK(scenes >= 7);
}
