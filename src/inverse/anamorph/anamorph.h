// Paper sizes (ISO 216 and ANSI), lengths and units as people write them.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/description/material.h"
#include "base/image/image.h"
#include "base/math/vec.h"
#include "base/util/error.h"
#include "inverse/maps/target.h"
#include "render/frame/request.h"

namespace trilens {

struct PaperSize {
    double width = 210, height = 297;  // millimetres
};

/// "A0" to "A6", "letter", "legal", "tabloid", or "WxH" in millimetres; upright. Throws UsageError with the
/// names.
PaperSize parse_paper(const std::string& text);

/// Metres: "mm", "cm", "dm", "m", "km", "in" or "ft". Throws UsageError with the names.
double parse_unit(const std::string& text);

/// Millimetres of "2mm", "0.5cm", "1in" or a bare number of millimetres, at least 0. Throws UsageError.
double parse_length(const std::string& text);

// Mirror anamorphosis: the page on which a picture must be printed so that the camera sees it undistorted in
// the mirror that stands on it (Niceron, La perspective curieuse, 1638), for any mirror, at true scale.

struct World;

/// x0, y0, x1, y1 on the film, pixels from its top left.
using PictureWindow = std::array<double, 4>;

struct AnamorphRequest {
    std::shared_ptr<const Texture> picture;  // what the mirror is to show
    std::string picture_name;                // what messages call it
    Id page = kNone;                         // index into Scene::meshes: a flat object
    std::optional<std::size_t> optic;        // index into World::optics; none: all mirrors
    std::optional<PictureWindow> window;     // where the picture is to be seen; none: the largest that fits
    std::optional<PaperSize> paper;  // centred on the page, its width along the page's first side; none: the
                                     // page's own size
    double dpi = 300;
    double unit = 0.01;       // metres per unit of the scene
    double bleed = 2;         // millimetres by which the picture's rim is drawn on beyond it
    double tolerance = 0.02;  // film pixels that places between exact ones may be off
    FrameParams frame;
};

/// A line on the page, millimetres from its lower left corner.
struct PageLine {
    Vec2 from{0}, to{0};
};

/// A page ready to print.
struct AnamorphPage {
    int width = 0, height = 0;  // dots
    std::vector<float> rgb;     // linear, rows from the top, white where nothing is drawn
    PaperSize paper;            // width and height as the page lies
    double dpi = 300;
    FlatRectangle place;             // the paper in the world
    std::vector<PageLine> outlines;  // where the mirrors stand
};

struct Anamorph {
    AnamorphPage page;
    PictureWindow window{};
    /// Share of the window whose rays end on the paper over a mirror.
    double coverage = 0;
    /// Share of the window that shows places of the page which it shows elsewhere, larger, too: what is
    /// printed there fits the larger one.
    double conflict = 0;
    PictureWindow extents{};  // of what is printed, millimetres from the page's lower left: x0, y0, x1, y1
    std::size_t exact_places = 0;
    double worst_accepted = 0;  // film pixels that an interpolated place was found to be off
};

/// Throws UsageError for what the scene does not have and numbers out of range, InputError where the page is
/// not flat, nothing of the page is seen in a mirror, or the window shows none of it; Interrupted.
Anamorph make_anamorph(const World& world, const AnamorphRequest& request, const Progress& progress = {});

/// What the window shows once the page is printed: the scene with the page as its texture, unlit, and mirrors
/// that take nothing of the light, ray traced with 4 x 4 samples per pixel; against the picture.
struct AnamorphCheck {
    double psnr_db =
        0;  // of stored (sRGB) values, over the pixels of the window that show the page over a mirror
    std::size_t pixels = 0;
    Image seen;  // the whole film, R G B A
};
AnamorphCheck verify_anamorph(const World& world, const AnamorphRequest& request, const Anamorph& made,
                              const Progress& progress = {});

/// The largest window of this aspect (width over height) inside the film's places for which `covered` is set;
/// none where there is none. `covered`: columns x rows cells that make up the film, rows from the top.
std::optional<PictureWindow> largest_window(const std::vector<unsigned char>& covered, int columns, int rows,
                                            const Vec2& film, double aspect);

// Pages at true scale: PDF (ISO 32000-1, the picture deflated without loss), SVG in millimetres, PNG with its
// dots per metre.

/// One page whose MediaBox is the paper's size to 0.01 point, with the mirrors' outlines and a line of 100 mm
/// (of 50 where the page is smaller) to check the print by. No printer driver may scale it.
std::vector<unsigned char> pdf_of(const AnamorphPage& page);

/// The same as SVG, the picture as PNG inside.
std::string svg_of(const AnamorphPage& page);

/// The picture alone, 8 bits sRGB, with pHYs.
std::vector<unsigned char> png_of(const AnamorphPage& page);

}  // namespace trilens
