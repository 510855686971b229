// How patches are continued beyond what a picture shows: fields whose continuation is known in closed form.
#include <array>
#include <bit>
#include <cmath>
#include <random>

#include "measure/displacement/image_query.h"
#include "measure/field/patch.h"
#include "measure/synthetic.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::image_of;
using trilens_test::Seen;

namespace {

constexpr int kWidth = 13, kHeight = 11;

/// A picture of one object with holes and steps: which pixels see it, and where it is cut in two.
struct Holes {
    std::array<bool, kWidth * kHeight> sees{};

    Holes(std::mt19937_64& random, unsigned one_in) {
        for (bool& one : sees) one = random() % one_in != 0;
    }
    bool at(double x, double y) const {
        return sees[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)];
    }
};

using Map = std::function<Vec3(double x, double y)>;

/// The field, linked. `image` is made anew and must outlive it.
PositionField field_of(const Map& map, const Holes& holes, Image& image) {
    image = image_of(kWidth, kHeight, [&](double x, double y) {
        return holes.at(x, y) ? Seen{4, 0, map(x, y)} : Seen{};
    });
    PositionField field = make_seen_field(image, "reflect").value();
    link_neighbours(field);
    return field;
}

/// A plane of random place and slopes.
Map random_plane(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    const Vec3 start = vector(), du = vector(), dv = vector();
    return [=](double x, double y) { return start + x * du + y * dv; };
}

/// Which pixels of a patch the corner reaches over links, by the closure of the relation (Warshall).
std::uint16_t reached(const PositionField& field, const PatchPlace& place) {
    std::array<std::array<bool, 16>, 16> linked{};
    const auto pixel = [&](std::size_t node) {
        return Vec2(place.column - 1 + static_cast<int>(node % 4),
                    place.row - 1 + static_cast<int>(node / 4));
    };
    const auto sees = [&](std::size_t node) {
        const int x = static_cast<int>(pixel(node).x), y = static_cast<int>(pixel(node).y);
        return field.contains(x, y) && field.sees(field.index(x, y));
    };
    for (std::size_t i = 0; i < 16; ++i) {
        linked[i][i] = sees(i);
        for (const std::size_t j : {i + 1, i + 4}) {
            if (j > 15 || (j == i + 1 && i % 4 == 3) || !sees(i) || !sees(j)) continue;
            const std::size_t at = field.index(static_cast<int>(pixel(i).x), static_cast<int>(pixel(i).y));
            const bool is_linked =
                field.links[at] & (j == i + 1 ? PositionField::kRight : PositionField::kDown);
            linked[i][j] = linked[j][i] = is_linked;
        }
    }
    for (std::size_t k = 0; k < 16; ++k)
        for (std::size_t i = 0; i < 16; ++i)
            for (std::size_t j = 0; j < 16; ++j)
                linked[i][j] = linked[i][j] || (linked[i][k] && linked[k][j]);
    std::uint16_t all = 0;
    const auto corner = static_cast<std::size_t>(kCellCorner[static_cast<std::size_t>(place.corner)]);
    for (std::size_t i = 0; i < 16; ++i)
        if (linked[corner][i]) all |= static_cast<std::uint16_t>(1u << i);
    return all;
}

/// Whether all pixels of the set stand in one row or one column.
bool is_line(std::uint16_t set) {
    for (unsigned line = 0; line < 4; ++line)
        if (!(set & ~(0x000fu << 4 * line)) || !(set & ~(0x1111u << line))) return true;
    return false;
}

/// Calls visit(place) for every corner of every cell that the picture holds.
template <typename Visit>
void for_each_place(const PositionField& field, Visit&& visit) {
    for (int row = -1; row < kHeight; ++row)
        for (int column = -1; column < kWidth; ++column)
            for (int corner = 0; corner < 4; ++corner)
                if (field.contains(column + corner % 2, row + corner / 2))
                    visit(PatchPlace{column, row, corner});
}

Vec3 at_node(const Map& map, const PatchPlace& place, std::size_t node) {
    return map(place.column - 0.5 + static_cast<double>(node % 4),
               place.row - 0.5 + static_cast<double>(node / 4));
}

constexpr SurfaceId kPiece{4, 0, std::nullopt};

}  // namespace

TEST_CASE("a patch holds the pixels that links reach, none where they stand in one line",
          "[measure][displacement][oracle][law][many]") {
    std::mt19937_64 random(14);
    std::size_t patches = 0, none = 0;
    for (int trial = 0; trial < 60; ++trial) {
        Image one, blank;
        const Map plane = random_plane(random);
        // Now and then a step where links end.
        const double cut = 4 + static_cast<double>(random() % 9);
        const Map stepped = [&](double x, double y) {
            return plane(x, y) + (x > cut ? Vec3(300, 0, 0) : Vec3(0));
        };
        const Holes holes(random, 2 + random() % 6);
        const PositionField field = field_of(stepped, holes, one),
                            beside = field_of(plane, Holes(random, 1), blank);  // sees nothing
        for_each_place(field, [&](const PatchPlace& place) {
            const auto patch = make_patch(field, beside, place, kPiece);
            const std::uint16_t expected = reached(field, place);
            // Of pixels in one line nothing says how the surface goes across; three corners of the cell say
            // all.
            const std::uint16_t corners = expected & 0x0660;
            if (is_line(expected)) CHECK_FALSE(patch.has_value());
            if (std::popcount(corners) >= 3) CHECK(patch.has_value());
            (patch ? patches : none) += 1;
            if (!patch) return;
            CHECK(patch->measured == expected);
            CHECK(patch->supported == expected);
        });
    }
    INFO(patches << " patches, " << none << " none");
    CHECK(patches > 10000);
    CHECK(none > 5000);
}

TEST_CASE("a plane is continued as the plane that it is, whichever pixels are missing",
          "[measure][displacement][oracle][law]") {
    std::mt19937_64 random(15);
    std::size_t continued = 0;
    double worst = 0;
    for (int trial = 0; trial < 60; ++trial) {
        Image one, blank;
        const Map plane = random_plane(random);
        const PositionField field = field_of(plane, Holes(random, 2 + random() % 6), one),
                            beside = field_of(plane, Holes(random, 1), blank);
        for_each_place(field, [&](const PatchPlace& place) {
            const auto patch = make_patch(field, beside, place, kPiece);
            if (!patch) return;
            continued += static_cast<std::size_t>(16 - std::popcount(patch->measured));
            for (std::size_t node = 0; node < 16; ++node)
                worst = std::max(worst, length(patch->nodes[node] - at_node(plane, place, node)));
        });
    }
    INFO(continued << " nodes continued");
    CHECK(worst < 1e-3);  // float positions of some 30, extrapolated
    CHECK(continued > 50000);
}

TEST_CASE("where the other picture sees on, a patch is that picture and the two's difference",
          "[measure][displacement][oracle][law]") {
    // However the seen surface bends: the two differ by a constant.
    std::mt19937_64 random(16);
    std::size_t alongside = 0;
    double worst = 0;
    for (int trial = 0; trial < 60; ++trial) {
        Image one, other;
        std::normal_distribution<double> normal;
        const Vec3 apart = 0.1 * Vec3(normal(random), normal(random), normal(random));
        const double a = normal(random), b = normal(random);
        const Map bent = [=](double x, double y) {
            return Vec3(x + 0.3 * std::sin(a * x + y), y + 0.3 * std::cos(b * y - x), 0.2 * x * y);
        };
        const PositionField field = field_of([&](double x, double y) { return bent(x, y) + apart; },
                                             Holes(random, 3), one),
                            beside = field_of(bent, Holes(random, 1000000), other);
        for_each_place(field, [&](const PatchPlace& place) {
            const auto patch = make_patch(field, beside, place, kPiece);
            if (!patch) return;
            for (std::size_t node = 0; node < 16; ++node) {
                if (!(patch->supported >> node & 1)) continue;
                alongside += !(patch->measured >> node & 1);
                worst = std::max(worst, length(patch->nodes[node] - at_node(bent, place, node) - apart));
            }
        });
    }
    INFO(alongside << " nodes continued alongside");
    CHECK(worst < 1e-4);
    CHECK(alongside > 20000);
}
