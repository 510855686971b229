// Anamorphoses: a flat mirror's page is the picture mirrored at true scale; a cylinder's is seen as the
// picture.
#include <cmath>
#include <regex>

#include "ball_worlds.h"
#include "base/util/error.h"
#include "inverse/anamorph/anamorph.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A mirror on a page of 20 x 16 units, seen by a camera above; its film is 200 x 160.
std::string page_json(const std::string& mirror, const std::string& look, double yfov) {
    return R"({"version": 1, "film": {"width": 200, "height": 160},
  "cameras": [{"name": "viewer", "type": "perspective", "yfov": )" +
           std::to_string(yfov) + R"(, "lookAt": )" + look + R"(}],
  "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0, "baseColorFactor": [0.9, 0.9, 0.9]},
                {"name": "paper", "unlit": true}],
  "meshes": [{"name": "mirror", "role": "optic", "material": "chrome", "resolution": 8, "primitive": )" +
           mirror + R"(},
             {"name": "page", "role": "object", "material": "paper",
              "points": [[-10, 0, 8], [10, 0, 8], [10, 0, -8], [-10, 0, -8]],
              "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]},
             {"name": "bent", "role": "object", "material": "paper",
              "points": [[50, 0, 0], [51, 0, 0], [51, 1, 0], [50, 1, 1]],
              "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]}],
  "render": {"maxDepth": 0}})";
}

/// The same before a parallel camera whose film is 16 units high.
std::string before_parallel_rays(std::string json) {
    const std::size_t at = json.find("\"perspective\"");
    json.replace(at, 13, "\"orthographic\"");
    const std::size_t yfov = json.find("\"yfov\": ");
    json.replace(yfov, json.find(',', yfov) - yfov, "\"ymag\": 8");
    return json;
}

std::string cylinder_json() {
    return page_json(
        R"({"type": "cylinder", "center": [0, 4, -3], "axis": [0, 1, 0], "radius": 2, "height": 8})",
        R"({"eye": [0, 20, 26], "at": [0, 3, -3], "up": [0, 1, 0]})", 16);
}

std::shared_ptr<Texture> smooth_picture(int width, int height) {
    auto picture = std::make_shared<Texture>(Texture{width, height, {}, {}});
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const double v :
                 {0.5 + 0.4 * std::sin(9.0 * x / width), 0.5 + 0.4 * std::cos(7.0 * y / height),
                  0.3 + 0.5 * x / width * y / height})
                picture->rgb.push_back(static_cast<float>(v));
    return picture;
}

AnamorphRequest request_for(const World& world, const std::string& page = "page") {
    AnamorphRequest request;
    request.picture = smooth_picture(120, 120);
    for (std::size_t m = 0; m < world.scene.meshes.size(); ++m)
        if (world.scene.meshes[m].name == page) request.page = static_cast<Id>(m);
    request.dpi = 60;
    return request;
}

}  // namespace

TEST_CASE("the page of a flat mirror is the picture, mirrored, at true scale", "[inverse][law]") {
    // A mirror upright at z = -5, seen level from far away by parallel rays at 45 degrees: the page's rows
    // are the film's, and across it nothing is stretched.
    const std::string json = before_parallel_rays(page_json(
        R"({"type": "plane", "center": [0, 6, -5], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [12, 12]})",
        R"({"eye": [0, 30, 25], "at": [0, 0, -5], "up": [0, 1, 0]})", 16));
    const auto world = world_of(json);
    AnamorphRequest request = request_for(*world);
    request.window = PictureWindow{60, 30, 100, 70};
    const Anamorph made = make_anamorph(*world, request);
    // ymag 8: 160 film pixels are 16 units, 10 pixels a unit, 1 mm a pixel (units of 1 cm): 40 mm across.
    // Left and right are exchanged by no upright mirror that is seen from above, but near and far are.
    CHECK(made.extents[2] - made.extents[0] == Approx(40 + 2 * request.bleed).margin(1.0));
    CHECK(made.extents[3] - made.extents[1] == Approx(40 * std::sqrt(2.0) + 2 * request.bleed).margin(1.0));
    CHECK(made.coverage == 1);
    CHECK(made.conflict == 0);
    const AnamorphPage& page = made.page;
    CHECK(page.paper.width == Approx(200));
    CHECK(page.paper.height == Approx(160));
    int checked = 0;
    for (int y = 0; y < page.height; ++y)
        for (int x = 0; x < page.width; ++x) {
            // Dot -> world; mirrored at z = -5; to the film by the parallel camera.
            const double wx = (x + 0.5) / page.width * 20 - 10, wz = (y + 0.5) / page.height * 16 - 8;
            const Vec3 image(wx, 0, -10 - wz);
            const double film_x = 100 + 10 * image.x;
            const double film_y = 80 - 10 * (0 * std::sqrt(0.5) - (image.z + 5) * std::sqrt(0.5));
            if (film_x < 61 || film_x > 99 || film_y < 31 || film_y > 69) continue;
            const double u = 3 * (film_x - 60), v = 3 * (film_y - 30);
            const float* dot = &page.rgb[3 * static_cast<std::size_t>(y * page.width + x)];
            CHECK(dot[0] == Approx(0.5 + 0.4 * std::sin(9.0 * (u - 0.5) / 120)).margin(0.01));
            CHECK(dot[1] == Approx(0.5 + 0.4 * std::cos(7.0 * (v - 0.5) / 120)).margin(0.01));
            ++checked;
        }
    CHECK(checked > 5000);
}

TEST_CASE("a cylinder's page is seen as the picture in the mirror", "[inverse][law]") {
    const auto world = world_of(cylinder_json());
    const AnamorphRequest request = request_for(*world);
    const Anamorph made = make_anamorph(*world, request);
    CHECK(made.coverage > 0.99);
    CHECK(made.conflict < 1e-3);
    CHECK(made.worst_accepted <= request.tolerance);
    const double aspect = (made.window[2] - made.window[0]) / (made.window[3] - made.window[1]);
    CHECK(aspect == Approx(1).margin(1e-9));
    const AnamorphCheck check = verify_anamorph(*world, request, made);
    CHECK(check.pixels > 300);
    CHECK(check.psnr_db > 34);

    // Printed with a tenth of its height cut off it is seen worse.
    Anamorph cut = made;
    for (std::size_t i = 0; i < cut.page.rgb.size() / 2; ++i) cut.page.rgb[i] = 1;
    CHECK(verify_anamorph(*world, request, cut).psnr_db < check.psnr_db - 6);
}

TEST_CASE("the largest window inside a mask is found", "[inverse][oracle]") {
    Draw draw(21);
    for (int trial = 0; trial < 20; ++trial) {
        const int columns = 24, rows = 17;
        std::vector<unsigned char> mask(static_cast<std::size_t>(columns * rows));
        for (auto& cell : mask) cell = draw.uniform(0, 1) < 0.93;
        const auto found = largest_window(mask, columns, rows, {240, 170}, 1);
        // Squares by brute force.
        int best = 0;
        for (int side = 1; side <= rows; ++side)
            for (int y = 0; y + side <= rows; ++y)
                for (int x = 0; x + side <= columns; ++x) {
                    bool whole = true;
                    for (int k = 0; k < side * side && whole; ++k)
                        whole = mask[static_cast<std::size_t>((y + k / side) * columns + x + k % side)];
                    if (whole) best = side;
                }
        REQUIRE(found);
        CHECK((*found)[2] - (*found)[0] == Approx(10 * best));
    }
    CHECK(!largest_window(std::vector<unsigned char>(12, 0), 4, 3, {4, 3}, 1));
}

TEST_CASE("pages are written at true scale", "[inverse]") {
    AnamorphPage page;
    page.width = 8, page.height = 4;
    page.rgb.assign(3 * 32, 0.5f);
    page.paper = {297, 210};
    page.dpi = 300;
    page.outlines = {{{10, 20}, {30, 40}}};
    const auto bytes = pdf_of(page);
    const std::string pdf(bytes.begin(), bytes.end());
    std::smatch box;
    REQUIRE(std::regex_search(pdf, box, std::regex(R"(/MediaBox \[0 0 ([0-9.]+) ([0-9.]+)\])")));
    CHECK(std::stod(box[1]) == Approx(297 / 25.4 * 72).margin(0.01));
    CHECK(std::stod(box[2]) == Approx(210 / 25.4 * 72).margin(0.01));
    CHECK(pdf.find("/FlateDecode") != std::string::npos);
    CHECK(pdf.find("(100 mm) Tj") != std::string::npos);
    // The table of objects says where they are.
    const std::size_t start = std::stoul(pdf.substr(pdf.find("startxref\n") + 10));
    CHECK(pdf.compare(start, 4, "xref") == 0);
    for (int object = 1; object <= 6; ++object) {
        const std::size_t place =
            std::stoul(pdf.substr(start + 9 + 20 * static_cast<std::size_t>(object), 10));
        CHECK(pdf.compare(place, 8, std::to_string(object) + " 0 obj\n") == 0);
    }
    const std::string svg = svg_of(page);
    CHECK(svg.find("width=\"297.0000mm\" height=\"210.0000mm\"") != std::string::npos);
    CHECK(svg.find("base64,iVBOR") != std::string::npos);
    const auto png = png_of(page);
    CHECK(std::string(png.begin() + 37, png.begin() + 41) == "pHYs");
    const auto back = decode_texture(png, "page");
    CHECK(back->width == 8);
}

TEST_CASE("papers, units and lengths are what people write", "[inverse]") {
    CHECK(parse_paper("A4").width == 210);
    CHECK(parse_paper("100x50mm").height == 50);
    CHECK(parse_unit("in") == 0.0254);
    CHECK(parse_length("0.5cm") == Approx(5));
    CHECK(parse_length("3") == 3);
    for (const char* text : {"A9", "x", "0x4", "4x", "-1x2", ""})
        CHECK_THROWS_AS(parse_paper(text), UsageError);
    CHECK_THROWS_WITH(parse_unit("furlong"), ContainsSubstring("furlong"));
    for (const char* text : {"2 parsec", "-1mm", "mm", ""}) CHECK_THROWS_AS(parse_length(text), UsageError);
}

TEST_CASE("an anamorphosis that cannot be is refused", "[inverse][bad-input]") {
    const auto world = world_of(cylinder_json());
    AnamorphRequest request = request_for(*world, "bent");
    CHECK_THROWS_WITH(make_anamorph(*world, request), ContainsSubstring("not flat"));
    request = request_for(*world, "mirror");
    CHECK_THROWS_WITH(make_anamorph(*world, request), ContainsSubstring("optic"));
    request = request_for(*world);
    request.window = PictureWindow{0, 0, 4, 4};  // beside the mirror
    CHECK_THROWS_WITH(make_anamorph(*world, request), ContainsSubstring("not seen"));
    request.window = PictureWindow{4, 4, 4, 8};
    CHECK_THROWS_AS(make_anamorph(*world, request), UsageError);
    request = request_for(*world);
    request.unit = 1000;
    CHECK_THROWS_WITH(make_anamorph(*world, request), ContainsSubstring("unit"));
    request = request_for(*world);
    request.picture.reset();
    CHECK_THROWS_AS(make_anamorph(*world, request), UsageError);
}
