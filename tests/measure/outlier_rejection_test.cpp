// A jump in a displacement field is another image of the point; a steep field is not.
#include "measure/displacement/displacement.h"

#include <cmath>

#include "support/test.h"

using namespace trilens;

namespace {

constexpr int kFieldWidth = 40, kFieldHeight = 30;

template <typename Field>
Displacement field_of(const Field& shift) {
    Displacement d;
    for (int y = 0; y < kFieldHeight; ++y) {
        for (int x = 0; x < kFieldWidth; ++x) {
            d.state.push_back(Shift::kFound);
            d.shift_x.push_back(static_cast<float>(shift(x, y)));
            d.shift_y.push_back(0);
        }
    }
    return d;
}

std::size_t lost(const Displacement& d) {
    std::size_t count = 0;
    for (const Shift state : d.state) count += state == Shift::kLost;
    return count;
}

}  // namespace

TEST_CASE("an isolated jump and a rim of jumps are other images", "[measure]") {
    Displacement d =
        field_of([](int x, int y) { return (x == 20 && y == 15) || x == kFieldWidth - 1 ? 60.0 : 0.01; });
    drop_other_images(d, kFieldWidth);
    CHECK(lost(d) == 1 + kFieldHeight);
    CHECK(d.shift_x[15 * kFieldWidth + 20] == 0);
}

TEST_CASE("a fold, where shifts grow together, keeps every pixel", "[measure][law]") {
    for (const double scale : {0.01, 0.1, 1.0, 10.0}) {
        Displacement d = field_of([&](int x, int) { return scale / std::sqrt(std::fabs(x - 20) + 0.05); });
        drop_other_images(d, kFieldWidth);
        CHECK(lost(d) == 0);
    }
}

TEST_CASE("a large uniform displacement is a displacement", "[measure]") {
    Displacement d = field_of([](int, int) { return 50.0; });
    drop_other_images(d, kFieldWidth);
    CHECK(lost(d) == 0);
}
