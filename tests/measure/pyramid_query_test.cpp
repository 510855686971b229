// The way down the pyramid for many points against a look at every cell.
#include "measure/field/field_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <utility>

#include "measure/synthetic.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

Image bent_image(std::mt19937_64& random, int width, int height) {
    std::uniform_real_distribution<double> share(-1, 1);
    const double amount = 3 * share(random), scale = std::pow(10.0, 4 * share(random));
    const unsigned holes = random() % 2 ? 30 : 1000000;
    return image_of(width, height, [&](double x, double y) {
        if (random() % holes == 0 || x > 0.8 * width) return Seen{};
        const Vec3 p(x + amount * std::sin(y), y + amount * std::cos(x), 0.1 * x * y);
        return Seen{1, static_cast<Id>(x / 5), scale * p};
    });
}

double squared_distance(const FieldSample& from, int column, int row) {
    const double dx = std::max({column - from.column, from.column - column - 1, 0}),
                 dy = std::max({row - from.row, from.row - row - 1, 0});
    return dx * dx + dy * dy;
}

}  // namespace

TEST_CASE("a packet finds the cells whose boxes hold its points, near enough, and no others",
          "[measure][displacement]") {
    std::mt19937_64 random(21);
    std::size_t held = 0, wrong = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const int width = 1 + static_cast<int>(random() % 40), height = 1 + static_cast<int>(random() % 30);
        const Image image = bent_image(random, width, height);
        const FieldPyramid index(make_seen_field(image, "reflect").value());
        const auto packet = std::make_unique<FieldPointPacket>();
        std::vector<FieldSample> points;
        std::vector<double> reach;
        for (std::size_t i = 0; i < image.pixels() && !packet->is_full(); i += 1 + random() % 9) {
            if (!index.field.sees(i)) continue;
            points.push_back(index.field.seen_point(i));
            points.back().column = static_cast<int>(random() % static_cast<std::size_t>(width));
            reach.push_back(random() % 3 ? std::numeric_limits<double>::infinity()
                                         : static_cast<double>(random() % 200));
            packet->add(points.back(), reach.back());
        }
        std::vector<CellOfMany> cells;
        find_cells(index, *packet, cells);
        std::map<std::pair<int, int>, std::uint64_t> found;
        for (const CellOfMany& cell : cells) found[{cell.column, cell.row}] |= cell.points;
        wrong += found.size() != cells.size();
        for (int row = -1; row < height; ++row)
            for (int column = -1; column < width; ++column)
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const bool is_held = index.may_show(points[i].point, column, row) &&
                                         squared_distance(points[i], column, row) <= reach[i];
                    held += is_held;
                    wrong += is_held != (found[{column, row}] >> i & 1);
                }
    }
    CHECK(held > 5000);
    CHECK(wrong == 0);
}

TEST_CASE("a packet drops no point that a cell's reach holds, and few others",
          "[measure][displacement][law]") {
    std::mt19937_64 random(22);
    std::size_t held = 0, lost = 0, more = 0, none = 0;
    for (int trial = 0; trial < 40; ++trial) {
        const Image image = bent_image(random, 20, 15);
        const FieldPyramid index(make_seen_field(image, "reflect").value());
        const auto packet = std::make_unique<FieldPointPacket>();
        std::vector<FieldSample> points;
        for (std::size_t i = 0; i < image.pixels() && !packet->is_full(); i += 1 + random() % 4) {
            if (!index.field.sees(i)) continue;
            points.push_back(index.field.seen_point(i));
            packet->add(points.back(), 0);
        }
        const std::uint64_t all = points.size() == 64 ? ~0ull : (1ull << points.size()) - 1;
        for (int row = -1; row < 15; ++row)
            for (int column = -1; column < 20; ++column) {
                const FieldCellBounds reach = reach_of_cell(index, index.field, column, row);
                const std::uint64_t asked = all & (random() | random()),
                                    answer = held_by(reach, *packet, asked);
                lost += (answer & ~asked) != 0;
                for (std::size_t i = 0; i < points.size(); ++i) {
                    if (!(asked >> i & 1)) continue;
                    const bool is_held = reach.may_hold(points[i].point), is_answered = answer >> i & 1;
                    (is_held ? held : none) += 1;
                    lost += is_held && !is_answered;
                    more += is_answered && !is_held;
                }
            }
    }
    CHECK(held > 3000);
    CHECK(none > 10000);
    CHECK(lost == 0);
    CHECK(more <= held / 50);
}
