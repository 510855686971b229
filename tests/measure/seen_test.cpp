// What is seen, and the difference to look at.
#include "measure/compare.h"

#include <cmath>
#include <string>
#include <vector>

#include "image/image_io.h"
#include "measure/pictures.h"
#include "measure/synthetic.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("what is seen is counted in disjoint classes", "[measure][seen]") {
    // A row of pixels: nothing in both, one sided twice, another object, another triangle, the same.
    const std::vector<Seen> first = {{}, {}, {1, 0, {}}, {1, 0, {}}, {1, 0, {}}, {1, 0, {}}};
    const std::vector<Seen> second = {{}, {1, 0, {}}, {}, {2, 0, {}}, {1, 5, {}}, {1, 0, {}}};
    const Image a = image_of(6, 1, [&](double x, double) { return first[static_cast<std::size_t>(x)]; });
    const Image b = image_of(6, 1, [&](double x, double) { return second[static_cast<std::size_t>(x)]; });
    const SeenMismatch seen = compare_seen(a, b, "reflect").value();
    CHECK(seen.pixels == 5);
    CHECK(seen.coverage_mismatch == 2);
    CHECK(seen.object_mismatch == 1);
    CHECK(seen.primitive_mismatch == 1);
    CHECK_FALSE(compare_seen(a, b, "refract").has_value());

    Image c = a, d = a;
    c.channels.push_back({"optic.object", std::vector<Id>{4, 4, kNone, kNone, 7, 8}});
    d.channels.push_back({"optic.object", std::vector<Id>{4, kNone, 4, kNone, 8, 8}});
    const SeenMismatch optic = compare_seen(c, d, "optic").value();
    CHECK(optic.pixels == 5);
    CHECK(optic.coverage_mismatch == 2);
    CHECK(optic.object_mismatch == 1);
    CHECK(compare_seen(c, d, "reflect", 7)->pixels == 1);
}

TEST_CASE("the difference image holds test minus reference, the mask and the shifts",
          "[measure][difference][golden]") {
    const Image a = noise(20, 9, 7), b = noise(21, 9, 7);
    const Image difference = make_difference(a, b);
    for (std::size_t i = 0; i < a.pixels(); ++i) {
        const float d = b.find("G")->floats()[i] - a.find("G")->floats()[i];
        CHECK(difference.find("G")->floats()[i] == d);
        CHECK(difference.find("abs.G")->floats()[i] == std::abs(d));
    }
    CHECK(difference.find("mask.M")->floats() == std::vector<float>(63, 1));
    CHECK_FALSE(difference.find("shift.X"));

    // It is an image like any other: it can be written and read.
    Displacement displacement;
    displacement.state.assign(63, Shift::kFound);
    displacement.state[0] = Shift::kLost;
    displacement.state[1] = Shift::kNothing;
    displacement.shift_x.assign(63, 0.25f);
    displacement.shift_y.assign(63, -2);
    const std::string file = trilens_test::scratch_dir("difference") + "/diff.exr";
    Image moved = make_difference(a, b);
    add_shift("reflect", displacement, moved);
    write_exr(file, moved);
    const Image read = read_exr(file);
    CHECK(read.channels.size() == 11);
    CHECK(read.find("reflect.shift.X")->floats() == displacement.shift_x);
    CHECK(read.find("reflect.shift.M")->floats()[0] == -1);
    CHECK(read.find("reflect.shift.M")->floats()[1] == 0);
    CHECK(read.find("reflect.shift.M")->floats()[2] == 1);
}
