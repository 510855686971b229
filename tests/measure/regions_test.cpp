// Regions of a picture against drawn shapes, and against labels that spread until nothing changes.
#include "measure/pixel/regions.h"

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "support/test.h"

using namespace trilens;

namespace {

/// One character per pixel: '.' is the environment.
Image drawn(const std::vector<std::string>& rows) {
    Image image;
    image.width = image.data_width = static_cast<int>(rows.front().size());
    image.height = image.data_height = static_cast<int>(rows.size());
    std::vector<float> alpha;
    for (const std::string& row : rows)
        for (const char c : row) alpha.push_back(c == '.' ? 0.f : c == '#' ? 1.f : 0.25f);
    image.channels.push_back({"A", alpha});
    return image;
}

/// Every seen pixel takes the least label of its neighbours, until none changes.
std::size_t count_by_labels(const Image& image, std::size_t least) {
    const std::vector<float>& alpha = image.find("A")->floats();
    const int width = image.data_width, height = image.data_height;
    const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * width + x); };
    const auto is_seen = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < width && y < height && alpha[at(x, y)] > 0;
    };
    std::vector<std::size_t> label(alpha.size());
    for (std::size_t i = 0; i < label.size(); ++i) label[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int d = 0; d < 9; ++d) {
                    const int nx = x + d % 3 - 1, ny = y + d / 3 - 1;
                    if (!is_seen(x, y) || !is_seen(nx, ny) || label[at(nx, ny)] >= label[at(x, y)]) continue;
                    label[at(x, y)] = label[at(nx, ny)];
                    changed = true;
                }
    }
    std::map<std::size_t, std::size_t> sizes;
    for (std::size_t i = 0; i < label.size(); ++i)
        if (alpha[i] > 0) ++sizes[label[i]];
    return static_cast<std::size_t>(
        std::count_if(sizes.begin(), sizes.end(), [&](const auto& size) { return size.second >= least; }));
}

}  // namespace

TEST_CASE("regions touch by sides and corners, partly covered pixels are seen, and specks do not count",
          "[measure][law]") {
    CHECK(count_regions(drawn({"....", "...."}), 1) == 0);
    CHECK(count_regions(drawn({"####", "####"}), 1) == 1);
    CHECK(count_regions(drawn({"#..#", ".##.", "#..#"}), 1) == 1);
    CHECK(count_regions(drawn({"##.##", "#+.+#", "##.##"}), 1) == 2);
    CHECK(count_regions(drawn({"#...#", "##...", "##.##"}), 1) == 3);
    CHECK(count_regions(drawn({"#...#", "##...", "##.##"}), 2) == 2);
    // A row's end does not touch the next row's beginning.
    CHECK(count_regions(drawn({"...#", "....", "#..."}), 1) == 2);
    CHECK(count_regions(drawn({"...##", "##...", "....."}), 1) == 2);
    CHECK(count_regions(drawn({"############", "............", "###########."})) == 1);
}

TEST_CASE("regions of random pictures are those that spreading labels find", "[measure][oracle][law]") {
    std::mt19937 random(11);
    for (int i = 0; i < 200; ++i) {
        const int width = std::uniform_int_distribution(1, 24)(random),
                  height = std::uniform_int_distribution(1, 24)(random);
        std::bernoulli_distribution seen(std::uniform_real_distribution<>(0.05, 0.6)(random));
        std::vector<std::string> rows(static_cast<std::size_t>(height));
        for (std::string& row : rows)
            for (int x = 0; x < width; ++x) row += seen(random) ? '#' : '.';
        const Image image = drawn(rows);
        for (const std::size_t least : {1u, 2u, 5u})
            CHECK(count_regions(image, least) == count_by_labels(image, least));
    }
}

TEST_CASE("an image without alpha has no regions to count", "[measure]") {
    Image image = drawn({"##"});
    image.channels[0].name = "R";
    CHECK_THROWS_AS(count_regions(image), InputError);
    image.channels[0] = {"A", std::vector<Id>(2)};
    CHECK_THROWS_AS(count_regions(image), InputError);
    image.channels[0] = {"A", std::vector<float>(3)};
    CHECK_THROWS_AS(count_regions(image), InputError);
}
