// A report as one HTML file: what was found, the plots, every run with its pictures, and how to do it again.
#pragma once

#include <string>
#include <vector>

#include "report/page.h"

namespace trilens {

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
