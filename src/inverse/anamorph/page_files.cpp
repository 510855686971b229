#include "inverse/anamorph/anamorph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/names.h"
#include "image/image_io.h"
#include "image/png_file.h"
#include "image/tone.h"
#include "image/zlib_stream.h"
#include "inverse/maps/number_list.h"

namespace trilens {

namespace {

using NamedPaper = std::pair<const char*, PaperSize>;
constexpr std::array<NamedPaper, 10> kPapers{{{"A0", {841, 1189}},
                                              {"A1", {594, 841}},
                                              {"A2", {420, 594}},
                                              {"A3", {297, 420}},
                                              {"A4", {210, 297}},
                                              {"A5", {148, 210}},
                                              {"A6", {105, 148}},
                                              {"letter", {215.9, 279.4}},
                                              {"legal", {215.9, 355.6}},
                                              {"tabloid", {279.4, 431.8}}}};

using NamedUnit = std::pair<const char*, double>;
constexpr std::array<NamedUnit, 7> kUnits{
    {{"mm", 1e-3}, {"cm", 1e-2}, {"dm", 0.1}, {"m", 1}, {"km", 1e3}, {"in", 0.0254}, {"ft", 0.3048}}};

template <class Table>
std::vector<std::string> names_in(const Table& table) {
    std::vector<std::string> names;
    for (const auto& [name, value] : table) names.emplace_back(name);
    return names;
}

}  // namespace

PaperSize parse_paper(const std::string& text) {
    for (const auto& [name, size] : kPapers)
        if (text == name) return size;
    const std::size_t x = text.find('x');
    if (x != std::string::npos) {
        std::string height = text.substr(x + 1);
        if (height.ends_with("mm")) height.resize(height.size() - 2);
        const auto w = number_list(text.substr(0, x)), h = number_list(height);
        if (w && h && w->size() == 1 && h->size() == 1 && w->front() > 0 && h->front() > 0 &&
            w->front() <= 1e5 && h->front() <= 1e5)
            return {w->front(), h->front()};
    }
    const std::vector<std::string> names = names_in(kPapers);
    throw UsageError("there is no paper \"" + text + "\" (WxH in millimetres is one)" +
                     suggestion(text, names));
}

double parse_unit(const std::string& text) {
    for (const auto& [name, metres] : kUnits)
        if (text == name) return metres;
    const std::vector<std::string> names = names_in(kUnits);
    throw UsageError("there is no unit \"" + text + "\"" + suggestion(text, names));
}

double parse_length(const std::string& text) {
    const std::size_t end = text.find_last_of("0123456789.");
    const auto number = number_list(text.substr(0, end == std::string::npos ? 0 : end + 1));
    const std::string unit = end == std::string::npos ? text : text.substr(end + 1);
    if (!number || number->size() != 1 || number->front() < 0)
        throw UsageError("a length is a number with its unit, as 0.5cm, or of millimetres, not \"" + text +
                         "\"");
    return number->front() * (unit.empty() ? 1 : parse_unit(unit) * 1000);
}

namespace {

constexpr double kPointsPerMm = 72 / 25.4;

/// The line to check the print by: its ends, millimetres from the lower left.
struct ControlLine {
    double length = 100, x = 8, y = 6;
};

ControlLine control_line(const AnamorphPage& page) {
    ControlLine line;
    if (page.paper.width < 120) line.length = page.paper.width < 60 ? 10 : 50;
    line.y = std::min(line.y, 0.1 * page.paper.height);
    line.x = std::min(line.x, 0.1 * page.paper.width);
    return line;
}

std::vector<unsigned char> stored_values(const AnamorphPage& page) {
    std::vector<unsigned char> stored(page.rgb.size());
    for (std::size_t i = 0; i < stored.size(); ++i)
        stored[i] = static_cast<unsigned char>(
            std::lround(255 * srgb_from_linear(std::clamp(double(page.rgb[i]), 0.0, 1.0))));
    return stored;
}

std::vector<unsigned char> deflated(std::vector<unsigned char> bytes) {
    std::vector<unsigned char> stream(bytes.size() + bytes.size() / 8 + 1024);
    const std::size_t size = deflate(bytes, stream);
    TRILENS_CHECK(size > 0, "deflate leaves room for incompressible bytes");
    stream.resize(size);
    return stream;
}

/// The page's content: the picture over all of it, then outlines and the control line, in points.
std::string pdf_content(const AnamorphPage& page) {
    const double wide = page.paper.width * kPointsPerMm, high = page.paper.height * kPointsPerMm;
    std::string content = fmt::format("q {:.4f} 0 0 {:.4f} 0 0 cm /Page Do Q\n0.25 w 0.5 G\n", wide, high);
    for (const PageLine& line : page.outlines)
        content +=
            fmt::format("{:.3f} {:.3f} m {:.3f} {:.3f} l S\n", line.from.x * kPointsPerMm,
                        line.from.y * kPointsPerMm, line.to.x * kPointsPerMm, line.to.y * kPointsPerMm);
    const ControlLine control = control_line(page);
    const double x0 = control.x * kPointsPerMm, x1 = (control.x + control.length) * kPointsPerMm,
                 y = control.y * kPointsPerMm;
    content += fmt::format(
        "{0:.3f} {2:.3f} m {1:.3f} {2:.3f} l {0:.3f} {3:.3f} m {0:.3f} {4:.3f} l "
        "{1:.3f} {3:.3f} m {1:.3f} {4:.3f} l S\n",
        x0, x1, y, y - 3, y + 3);
    return content +
           fmt::format("0.4 g BT /Text 7 Tf {:.3f} {:.3f} Td ({:.0f} mm) Tj ET\n", x0, y + 4, control.length);
}

std::string base64(const std::vector<unsigned char>& bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < left ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= left ? kDigits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

}  // namespace

std::vector<unsigned char> pdf_of(const AnamorphPage& page) {
    std::vector<unsigned char> pdf;
    std::vector<std::size_t> places;
    const auto put = [&](const std::string& text) { pdf.insert(pdf.end(), text.begin(), text.end()); };
    const auto begin = [&](const std::string& dictionary) {
        places.push_back(pdf.size());
        put(fmt::format("{} 0 obj\n{}\n", places.size(), dictionary));
    };
    const auto put_stream = [&](const std::vector<unsigned char>& bytes) {
        put("stream\n");
        pdf.insert(pdf.end(), bytes.begin(), bytes.end());
        put("\nendstream\n");
    };
    put("%PDF-1.4\n%\xe2\xe3\xcf\xd3\n");
    begin("<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>");
    put("endobj\n");
    begin("<< /Type /Pages /Kids [3 0 R] /Count 1 >>");
    put("endobj\n");
    begin(fmt::format(
        "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.4f} {:.4f}] /Contents 4 0 R /Resources << "
        "/XObject << /Page 5 0 R >> /Font << /Text 6 0 R >> >> >>",
        page.paper.width * kPointsPerMm, page.paper.height * kPointsPerMm));
    put("endobj\n");
    const std::string content = pdf_content(page);
    begin(fmt::format("<< /Length {} >>", content.size()));
    put_stream({content.begin(), content.end()});
    put("endobj\n");
    const std::vector<unsigned char> picture = deflated(stored_values(page));
    begin(
        fmt::format("<< /Type /XObject /Subtype /Image /Width {} /Height {} /ColorSpace /DeviceRGB "
                    "/BitsPerComponent 8 /Filter /FlateDecode /Length {} >>",
                    page.width, page.height, picture.size()));
    put_stream(picture);
    put("endobj\n");
    begin("<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>");
    put("endobj\n");
    const std::size_t table = pdf.size();
    put(fmt::format("xref\n0 {}\n0000000000 65535 f \n", places.size() + 1));
    for (const std::size_t place : places) put(fmt::format("{:010} 00000 n \n", place));
    put(fmt::format("trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{}\n%%EOF\n", places.size() + 1, table));
    return pdf;
}

std::string svg_of(const AnamorphPage& page) {
    const double wide = page.paper.width, high = page.paper.height;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.4f}mm\" height=\"{1:.4f}mm\" viewBox=\"0 0 "
        "{0:.4f} "
        "{1:.4f}\">\n<image width=\"{0:.4f}\" height=\"{1:.4f}\" preserveAspectRatio=\"none\" "
        "href=\"data:image/png;base64,{2}\"/>\n",
        wide, high, base64(png_of(page)));
    svg += "<path id=\"mirrors\" fill=\"none\" stroke=\"#808080\" stroke-width=\"0.1\" d=\"";
    for (const PageLine& line : page.outlines)
        svg += fmt::format("M{:.3f} {:.3f}L{:.3f} {:.3f}", line.from.x, high - line.from.y, line.to.x,
                           high - line.to.y);
    const ControlLine control = control_line(page);
    svg += fmt::format(
        "\"/>\n<path id=\"control\" fill=\"none\" stroke=\"#808080\" stroke-width=\"0.1\" "
        "d=\"M{0:.3f} {1:.3f}h{2:.3f}M{0:.3f} {3:.3f}v2m{2:.3f} 0v-2\"/>\n",
        control.x, high - control.y, control.length, high - control.y - 1);
    svg += fmt::format(
        "<text x=\"{:.3f}\" y=\"{:.3f}\" font-size=\"2.5\" fill=\"#606060\">{:.0f} mm</text>\n</svg>\n",
        control.x, high - control.y - 1.5, control.length);
    return svg;
}

std::vector<unsigned char> png_of(const AnamorphPage& page) {
    const std::vector<unsigned char> plain =
        encode_stored_png("page", page.width, page.height, stored_values(page));
    // After the signature and IHDR, before all others: 8 + 12 + 13 bytes.
    constexpr std::ptrdiff_t kHead = 33;
    Bytes dots, png(plain.begin(), plain.begin() + kHead);
    const auto per_metre = static_cast<std::uint32_t>(std::lround(page.dpi / 0.0254));
    put32(dots, per_metre);
    put32(dots, per_metre);
    dots.push_back(1);
    put_png_chunk(png, {"pHYs", dots});
    png.insert(png.end(), plain.begin() + kHead, plain.end());
    return png;
}

}  // namespace trilens
