// A report as one self-contained HTML page: what was found, the plots, every run with its pictures, and how
// to do it again.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/pictures.h"
#include "report/text.h"

namespace trilens {

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
