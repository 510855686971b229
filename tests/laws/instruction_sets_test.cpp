// What is measured does not depend on the processor.
#include <optional>
#include <string>
#include <vector>

#include "measure/displacement.h"
#include "measure/synthetic.h"
#include "projector/kernel.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("displacement has the same bits with every instruction set", "[laws][displacement]") {
    constexpr int kSize = 90;
    const Image reference =
        image_of(kSize, kSize, [](double x, double y) { return mirror_sphere(x, y, kSize); });
    const Image test = image_of(kSize, kSize, [](double x, double y) {
        return mirror_sphere(x + 0.8 * std::sin(0.1 * y), y + 3 * std::cos(0.05 * x), kSize);
    });
    std::optional<Displacement> first;
    const std::vector<std::string> sets = kernel_instruction_sets();
    for (const std::string& set : sets) {
        REQUIRE(use_instruction_set(set));
        const Displacement found = measure_displacement(reference, test, "reflect").value();
        if (!first) first = found;
        INFO(set);
        CHECK(found.pixels > 3000);
        CHECK(found.shift_x == first->shift_x);
        CHECK(found.shift_y == first->shift_y);
        CHECK(found.state == first->state);
        CHECK(found.missing == first->missing);
    }
    CHECK(use_instruction_set(""));
}
