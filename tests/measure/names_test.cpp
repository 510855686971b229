// Layers of what is seen are read by their newer names, then by their older ones.
#include "base/util/error.h"
#include "measure/common/comparable.h"
#include "measure/compare.h"
#include "measure/displacement/displacement.h"
#include "measure/synthetic.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::image_of;
using trilens_test::mirror_sphere;
using trilens_test::with_newer_names;

namespace {

Image sphere(double by) {
    return image_of(60, 60, [=](double x, double y) { return mirror_sphere(x + by, y, 60); });
}

}  // namespace

TEST_CASE("ids and places in layers of their own measure as the older names do", "[measure][names]") {
    const Image reference = sphere(0), test = sphere(0.2);
    const Image newer_reference = with_newer_names(reference), newer_test = with_newer_names(test);
    REQUIRE(newer_test.find("reflectID.primitive") != nullptr);
    REQUIRE(newer_test.find("reflectP.Z") != nullptr);
    REQUIRE(newer_test.find("reflect.Z") == nullptr);

    const Displacement older = measure_displacement(reference, test, "reflect").value();
    REQUIRE(older.pixels > 2000);
    for (const auto& [a, b] :
         {std::pair{&newer_reference, &newer_test}, {&reference, &newer_test}, {&newer_reference, &test}}) {
        const Displacement found = measure_displacement(*a, *b, "reflect").value();
        CHECK(found.state == older.state);
        CHECK(found.shift_x == older.shift_x);
        CHECK(found.missing == older.missing);
        const SeenMismatch seen = compare_seen(*a, *b, "reflect").value();
        const SeenMismatch expected = compare_seen(reference, test, "reflect").value();
        CHECK(seen.pixels == expected.pixels);
        CHECK(seen.primitive_mismatch == expected.primitive_mismatch);
        CHECK(seen.coverage_mismatch == expected.coverage_mismatch);
    }
}

TEST_CASE("a name that neither image's naming knows is still a difference", "[measure][names]") {
    const Image reference = with_newer_names(sphere(0));
    Image test = sphere(0);
    test.channels.push_back({"reflect.length", std::vector<float>(test.pixels(), 1)});
    CHECK_THROWS_AS(measure_displacement(reference, test, "reflect"), InputError);
    CHECK(seen_channel(reference, "reflect", "object") == "reflectID.object");
    CHECK(seen_channel(reference, "reflect", "X") == "reflectP.X");
    CHECK(seen_channel(test, "reflect", "X") == "reflect.X");
    CHECK(seen_channel(test, "optic", "object") == "optic.object");
}
