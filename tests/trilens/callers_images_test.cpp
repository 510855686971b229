// Pictures that are none, handed to the public functions: errors come of it, and nothing else does.
#include "support/test.h"
#include "trilens/odd_images.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("images that are none are refused by all that takes images", "[trilens][bad-input]") {
    const std::string folder = scratch_dir("callers_images");
    const Image good = small_image();
    for (const Image& odd : odd_images()) {
        only_errors("check_image", [&] { check_image(odd); });
        only_errors("encode_image", [&] { encode_image(odd); });
        only_errors("encode_image_as", [&] { encode_image_as(odd, ImageFormat::kPng); });
        only_errors("write_image", [&] { write_image(folder + "/a.exr", odd); });
        only_errors("image_format", [&] { image_format("picture.gif"); });
        only_errors("write_image_as", [&] { write_image_as(folder + "/a", odd, ImageFormat::kPng); });
        only_errors("count_regions", [&] { count_regions(odd, 0); });
        only_errors("keep_common_channels", [&] { keep_common_channels(odd, good); });
        for (const auto& pair : {std::pair(&good, &odd), std::pair(&odd, &good), std::pair(&odd, &odd)}) {
            const Image &a = *pair.first, &b = *pair.second;
            only_errors("compare", [&] { compare(a, b); });
            only_errors("layer_flip", [&] { layer_flip(a, b, ""); });
            only_errors("compare_layers", [&] { compare_layers(a, b); });
            only_errors("compare_seen", [&] { compare_seen(a, b, "reflect"); });
            only_errors("measure_displacement", [&] { measure_displacement(a, b, "reflect"); });
            only_errors("make_difference", [&] { make_difference(a, b); });
        }
    }
    const std::vector<float> few(3);
    CHECK(refusal([&] { compare(good, good, {}, &few); }).rfind("flip: ", 0) == 0);
    CHECK(refusal([&] { make_difference(good, good, {}, few); }).rfind("flip: ", 0) == 0);
    Image difference = make_difference(good, good);
    CHECK(refusal([&] { add_shift("reflect", Displacement(), difference); }).rfind("reflect: ", 0) == 0);
    LayerComparison layer{"reflect", {}, Displacement()};
    layer.displacement->coverage = 1;
    only_errors("add_shifts", [&] { add_shifts({layer}, difference); });
    only_errors("total_seen", [&] { total_seen({layer, {}}); });
    only_errors("total_displacement", [&] { total_displacement({}, "x"); });
    only_errors("named_metrics", [&] { named_metrics({}, {layer, {}}); });
    only_errors("broken_limits", [&] { broken_limits({{"x", kNaN}, {"", 0}}, {}); });
    only_errors("metric_names", [] { metric_names(); });
    for (const double x : kOddNumbers) {
        DisplacementOptions options;
        options.radius = x;
        only_errors("radius", [&] { compare_layers(good, good, options); });
        CompareOptions limits;
        limits.fail = limits.failpercent = limits.warn = limits.hardfail = x;
        only_errors("limits", [&] { compare(good, good, limits); });
    }
}
