// What the small pictures show, read back through the image room's own decoder.
#include "report/page.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;

namespace {

Image grey_image(int width, int height, float value) {
    Image image{width, height, 0, 0, width, height, {}, {}};
    for (const char* name : {"R", "G", "B"})
        image.channels.push_back({name, std::vector<float>(image.pixels(), value)});
    return image;
}

std::vector<float>& channel(Image& image, const char* name) {
    return image.find(name)->floats();
}

/// The picture's pixel as linear RGB.
LinearRgb pixel(const PagePicture& picture, int x, int y) {
    const std::shared_ptr<const Texture> texture = decode_texture(picture.png, "picture");
    REQUIRE((texture->width == picture.width && texture->height == picture.height));
    const std::size_t at = static_cast<std::size_t>(y * texture->width + x) * 3;
    return {texture->rgb[at], texture->rgb[at + 1], texture->rgb[at + 2]};
}

void check_colour(const LinearRgb& seen, const LinearRgb& expected) {
    for (std::size_t i = 0; i < 3; ++i) CHECK(seen[i] == Approx(expected[i]).margin(0.006));
}

}  // namespace

TEST_CASE("sweep: a beauty picture shows the film, black outside the data window, magenta where not finite",
          "[report]") {
    Image image{4, 3, 1, 1, 2, 1, {}, {}};
    for (const char* name : {"R", "G", "B"})
        image.channels.push_back({name, std::vector<float>{0.5f, 0.25f}});
    channel(image, "B")[1] = NAN;
    const PagePicture picture = beauty_picture(image, "caption");
    CHECK((picture.width == 4 && picture.height == 3 && picture.caption == "caption"));
    check_colour(pixel(picture, 1, 1), {0.5f, 0.5f, 0.5f});
    check_colour(pixel(picture, 2, 1), {1, 0, 1});
    check_colour(pixel(picture, 0, 0), {0, 0, 0});

    image.channels.pop_back();
    CHECK_THROWS_AS(beauty_picture(image, ""), InputError);
}

TEST_CASE("sweep: large films shrink to the mean of what lies under a pixel", "[report]") {
    for (const int width : {1281, 1600, 2560}) {
        Image image = grey_image(width, width / 2, 0.0f);
        double sum = 0;
        for (std::size_t i = 0; i < image.pixels(); ++i) {
            channel(image, "R")[i] = static_cast<float>((i * 37 % 101) / 100.0);
            sum += static_cast<double>(channel(image, "R")[i]);
        }
        const PagePicture picture = beauty_picture(image, "");
        CHECK(picture.width == kLargestPicture);
        CHECK(picture.height == std::lround(width / 2 * 1280.0 / width));
        const auto texture = decode_texture(picture.png, "picture");
        double shrunk = 0;
        for (std::size_t i = 0; i < texture->rgb.size(); i += 3)
            shrunk += static_cast<double>(texture->rgb[i]);
        CHECK(shrunk / (picture.width * picture.height) ==
              Approx(sum / static_cast<double>(image.pixels())).epsilon(0.005));
    }
}

TEST_CASE("sweep: a difference picture is scaled and without sign; films of two sizes have none",
          "[report]") {
    const Image dark = grey_image(3, 2, 0.1f), light = grey_image(3, 2, 0.15f);
    check_colour(pixel(difference_picture(dark, light, 8, ""), 1, 1), {0.4f, 0.4f, 0.4f});
    check_colour(pixel(difference_picture(light, dark, 8, ""), 1, 1), {0.4f, 0.4f, 0.4f});
    CHECK_THROWS_AS(difference_picture(dark, grey_image(2, 3, 0), 1, ""), InputError);
}

TEST_CASE("sweep: the difference's scale is the largest power of two that keeps it below white", "[report]") {
    CHECK(difference_scale(0.03) == 32);
    CHECK(difference_scale(0.5) == 1);
    CHECK(difference_scale(0.49) == 2);
    CHECK(difference_scale(0) == 1048576);
    CHECK(difference_scale(1e-5) == 65536);
    CHECK(difference_scale(9) == 1);
}

TEST_CASE("sweep: a displacement picture tells small, large, none, lost and unmeasured apart", "[report]") {
    const ColourRange range{0.01, 10};
    const std::vector<float> pixels = {0.01f, 10.0f, NAN, INFINITY, 0.0f, 1e6f, -INFINITY, 1.0f, 1.0f};
    const PagePicture picture = displacement_picture(pixels, 3, range, "");
    CHECK((picture.width == 3 && picture.height == 3));
    check_colour(pixel(picture, 0, 2), {1, 1, 1});
    CHECK(displacement_colours(pixels) == "; grey: none, orange: lost, white: unmeasured");
    CHECK(displacement_colours(std::vector<float>{0.5f, NAN}) == "; grey: none");
    check_colour(pixel(picture, 0, 0), viridis(0));
    check_colour(pixel(picture, 1, 0), viridis(1));
    check_colour(pixel(picture, 1, 1), viridis(0));
    check_colour(pixel(picture, 2, 1), viridis(1));
    const LinearRgb none = pixel(picture, 2, 0), lost = pixel(picture, 0, 1);
    CHECK((std::abs(none[0] - none[1]) < 0.01f && std::abs(none[0] - none[2]) < 0.01f));
    CHECK((lost[0] > 0.9f && lost[2] < 0.1f));

    // One lost pixel among many stays visible.
    std::vector<float> large(2560 * 10, 0.5f);
    large[2561] = INFINITY;
    check_colour(pixel(displacement_picture(large, 2560, range, ""), 0, 0), lost);
}

TEST_CASE("sweep: the colour map grows lighter all along and ends where viridis ends", "[report]") {
    float previous = -1;
    for (int i = 0; i <= 100; ++i) {
        const LinearRgb colour = viridis(i / 100.0);
        const float luminance = 0.2126f * colour[0] + 0.7152f * colour[1] + 0.0722f * colour[2];
        CHECK(luminance > previous);
        previous = luminance;
    }
    CHECK(viridis_hex(0).substr(0, 2) == "#4");  // 68 1 84
    CHECK(viridis_hex(1).substr(0, 2) == "#f");  // 253 231 37
    CHECK((viridis(-3) == viridis(0) && viridis(7) == viridis(1) && viridis(NAN) == viridis(0)));
}
