// Images for reports: tone-mapped pictures, false-colour errors, displacement maps.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/image/image.h"
#include "report/plot.h"
#include "report/text.h"

namespace trilens {

inline constexpr int kLargestPicture = 1280;  // width, pixels

/// What the colours of a picture mean.
struct ColourLegend {
    ColourRange range;
    std::string unit;
};

/// A picture as a report embeds it, at the film's size where that is no wider than kLargestPicture: PNG bytes
/// and what they show.
struct PagePicture {
    std::string caption;
    int width = 0, height = 0;
    std::vector<unsigned char> png = {};      // empty: there is none, and the caption says why
    std::optional<ColourLegend> legend = {};  // of a colour-mapped one
    bool is_over_previous = false;  // shows the same as the picture before it: a slider between them
    std::string file = {};  // where the page finds it, a path from its folder; empty: it carries the bytes

    bool is_there() const { return !png.empty() || !file.empty(); }
};

/// R G B of the whole film (black outside the data window), scaled down to kLargestPicture where wider;
/// values that are not finite show as magenta. Throws InputError where a channel is missing.
PagePicture beauty_picture(const Image& image, const std::string& caption);

/// scale * |test - truth| per channel, the same way. The films must be of one size.
PagePicture difference_picture(const Image& test, const Image& truth, double scale,
                               const std::string& caption);

/// The colours of `range` over a film of width x height values, rows from the top: NaN (nothing to measure)
/// is grey, infinite (lost) is orange, minus infinite (unmeasured) is white. Where it is scaled down, a pixel
/// shows the largest value under it.
PagePicture displacement_picture(std::span<const float> pixels, int width, const ColourRange& range,
                                 const std::string& caption);

/// What a displacement picture's colours mean beside its scale, for those of the values that occur:
/// "; grey: none, orange: lost".
std::string displacement_colours(std::span<const float> pixels);

/// Viridis from 0 (dark) to 1 (yellow) over a film of width x height values, rows from the top: NaN is grey.
/// Where it is scaled down, a pixel shows the largest value under it.
PagePicture share_picture(std::span<const float> shares, int width, const std::string& caption);

/// The largest power of two, between 1 and 2^20, that keeps scale * difference below 1.
double difference_scale(double difference);

// A report as one self-contained HTML page: what was found, the plots, every run with its pictures, and how
// to do it again.

/// A page around `body` (markup). The title is text.
std::string html_page(const std::string& title, const std::string& body);

/// A row of pictures with captions and the meaning of their colours. Two that show the same lie one over the
/// other with a slider between them, for mouse, finger and keys; a click, a tap or Enter shows full size.
/// Without scripts all lie side by side.
std::string html_pictures(const std::vector<PagePicture>& pictures);

/// A row of pictures whose first two show the same: the second is exchanged for the first under the pointer,
/// with the key F all over the page, and by a button, for fingers. Without scripts all stand still side by
/// side. Pictures without PNG bytes are captions.
std::string html_flip(const PagePicture& first, const PagePicture& second,
                      const std::vector<PagePicture>& others);

/// A two-column list.
std::string html_facts(const Facts& facts);

/// A table; every row has as many cells as there are columns. All is text. With scripts a click on a column's
/// head sorts by it, and of eight rows and more a field shows those that hold the words typed there.
std::string html_table(const std::vector<std::string>& columns,
                       const std::vector<std::vector<std::string>>& rows);

/// One element around text: html_text("h2", "Runs & warnings").
std::string html_text(const std::string& element, const std::string& text);

// A report as one HTML file: what was found, the plots, every run with its pictures, and how to do it again.

/// A number large enough to be read first, and what it means.
struct Headline {
    std::string value, meaning;
};

struct ReportRun {
    std::string title;                  // "n = 8"
    std::vector<PagePicture> pictures;  // projected with truth, displacement, difference
    Facts facts;
    std::vector<std::string> warnings;
    std::string error;       // not empty: the run failed with this
    bool is_folded = false;  // only its title shows until it is opened
    int row = -1;            // of the table, whose filter it follows; < 0: none
};

/// Everything a report shows, as text; plots are SVG documents, all else is escaped.
struct Report {
    std::string title, summary;
    std::vector<Headline> headlines;
    std::vector<std::string> warnings;
    std::vector<std::string> plots;
    std::vector<std::string> sentences;  // what needs no plot
    std::string plots_note;
    std::vector<std::string> table_columns;
    std::vector<std::vector<std::string>> table_rows;
    std::string pictures_note;  // "differences are shown times 16"
    std::vector<ReportRun> runs;
    std::vector<std::string> commands;
    Facts versions;
};

/// The report as one HTML document without anything from outside.
std::string report_html(const Report& report);

/// The same, written beside `file` and renamed. Throws OutputError.
void write_report(const std::string& file, const Report& report);

/// One scene of a gallery.
struct GalleryEntry {
    std::string title, text;
    std::vector<PagePicture> pictures;  // projected, truth, difference
    Facts metrics;
    std::string
        link;  // a relative path, empty for none; one with a scheme ("https:") is shown but not linked
    std::string plot;  // an SVG document, empty for none
};

struct Gallery {
    std::string title, text;
    std::vector<GalleryEntry> entries;
    std::vector<std::string> commands;
    Facts versions;
    std::vector<std::string> warnings = {};  // before the scenes
};

std::string gallery_html(const Gallery& gallery);
void write_gallery(const std::string& file, const Gallery& gallery);

}  // namespace trilens
