// Pages carry everything themselves and let no text become markup.
#include "report/page.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "base/files/files.h"
#include "base/util/error.h"
#include "report/plot.h"
#include "report/text.h"
#include "support/test.h"

using namespace trilens;

namespace {

const std::string kEvil = "<img src=x onerror=\"alert('1')\"> & \x01\xFF";

Report evil_report() {
    Report report;
    report.title = report.summary = report.plots_note = report.pictures_note = kEvil;
    report.headlines = {{kEvil, kEvil}};
    report.warnings = report.commands = {kEvil};
    report.plots = {log_log_plot({kEvil, kEvil, kEvil, {{1, kEvil}}, true, 640, 420},
                                 std::vector<PlotSeries>{{kEvil, {{1, 1}}, std::nullopt}})};
    report.table_columns = {kEvil};
    report.table_rows = {{kEvil}};
    report.sentences = {kEvil};
    report.runs = {
        {kEvil,
         {{kEvil, 1, 1, {1, 2, 3}, ColourLegend{{0.01, 10}, kEvil}, false}, {kEvil, 0, 0, {}, {}, true}},
         {{kEvil, kEvil}},
         {kEvil},
         kEvil}};
    report.versions = {{kEvil, kEvil}};
    return report;
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

/// Every value of src=, href= and url( in the page.
std::vector<std::string> references(const std::string& html) {
    std::vector<std::string> found;
    for (const std::string& opening : {std::string("src=\""), std::string("href=\""), std::string("url(")})
        for (std::size_t at = html.find(opening); at != std::string::npos; at = html.find(opening, at + 1))
            found.push_back(html.substr(
                at + opening.size(), html.find_first_of("\")", at + opening.size()) - at - opening.size()));
    return found;
}

}  // namespace

TEST_CASE("sweep: no text of a report becomes markup", "[report]") {
    const std::string html = report_html(evil_report());
    CHECK(html.find("<img src=x") == std::string::npos);
    CHECK(html.find("onerror=\"") == std::string::npos);
    CHECK(html.find('\x01') == std::string::npos);
    CHECK(html.find('\xFF') == std::string::npos);
    CHECK(count(html, "&lt;img src=x") >= 20);
    CHECK(count(html, "<img ") == 1);  // the one picture that has bytes
}

TEST_CASE("sweep: pages refer to nothing outside themselves", "[report]") {
    Gallery gallery{"scenes", "all of them", {}, {"trilens sweep run a.json"}, {{"trilens", "0.1"}}};
    gallery.entries.push_back(
        {"inside", "", {{"one", 1, 1, {1}, {}, false}}, {}, "ball/report.html", evil_report().plots[0]});
    gallery.entries.push_back({"outside", "", {}, {{"order", "2"}}, "https://example.org/x", ""});
    gallery.entries.push_back({"script", "", {}, {}, "javascript:alert(1)", ""});
    gallery.entries.push_back({"host", "", {}, {}, "//example.org", ""});
    gallery.entries.push_back({"colon in a folder", "", {}, {}, "a/b:c.html", ""});
    const std::string pages = report_html(evil_report()) + gallery_html(gallery);

    const std::vector<std::string> found = references(pages);
    CHECK(found.size() == 4);  // two pictures, two links inside
    for (const std::string& reference : found) {
        INFO(reference);
        CHECK((reference.rfind("data:image/png;base64,", 0) == 0 || reference == "ball/report.html" ||
               reference == "a/b:c.html"));
    }
    CHECK(pages.find("@import") == std::string::npos);
    CHECK(pages.find("<link") == std::string::npos);
    CHECK(pages.find("fetch(") == std::string::npos);
}

TEST_CASE("sweep: a page holds its pictures' bytes, captions and the reason where there is none",
          "[report]") {
    const std::vector<unsigned char> bytes = {0x89, 'P', 'N', 'G', 1, 2, 3};
    const std::string html =
        html_pictures({{"projected", 320, 240, bytes, {}, false}, {"truth: missing", 0, 0, {}, {}, true}});
    CHECK(html.find("base64," + base64_text(bytes) + "\"") != std::string::npos);
    CHECK(html.find("width=\"320\" height=\"240\"") != std::string::npos);
    CHECK(count(html, "<figcaption>") == 2);
    CHECK(count(html, "class=\"wipe\"") == 0);  // nothing to slide to
    CHECK(count(html, "<img") == 1);
    CHECK(html.find("truth: missing") != std::string::npos);
}

TEST_CASE("sweep: pages are written whole or not at all", "[report]") {
    const std::string folder = trilens_test::scratch_dir("sweep_html");
    write_report(folder + "/report.html", evil_report());
    CHECK(read_whole_file(folder + "/report.html") == report_html(evil_report()));
    write_gallery(folder + "/gallery.html", {});
    CHECK(read_whole_file(folder + "/gallery.html") == gallery_html({}));

    CHECK_THROWS_AS(write_report(folder + "/none/report.html", {}), OutputError);
    std::filesystem::create_directories(folder + "/taken/x");
    CHECK_THROWS_AS(write_report(folder + "/taken", {}), OutputError);
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files += entry.is_regular_file();
    CHECK(files == 2);
}

TEST_CASE("sweep: two pictures of one thing lie under a slider, and beside each other without scripts",
          "[report]") {
    const std::vector<PagePicture> pictures = {
        {"projected", 4, 3, {1}, {}, false},
        {"truth", 4, 3, {2}, {}, true},
        {"displacement", 4, 3, {3}, ColourLegend{{0.01, 100}, "px"}, false}};
    const std::string html = html_pictures(pictures);
    CHECK(count(html, "class=\"wipe\"") == 1);
    CHECK(count(html, "<input type=\"range\"") == 1);
    CHECK(html.find("aria-label=\"border between projected and truth\"") != std::string::npos);
    CHECK(count(html, "<img ") == 3);
    // The scale's ends and middle stand beside the picture.
    for (const char* mark : {"<span>0.01 px</span>", "<span>1 px</span>", "<span>100 px</span>"})
        CHECK(count(html, mark) == 1);
    // What lies over another and what hides is for scripts and screens alone.
    const std::string page = html_page("t", html);
    const std::size_t screen = page.find("@media screen{.js");
    REQUIRE(screen != std::string::npos);
    CHECK(page.find("clip-path") > screen);
    CHECK(page.find(".slider{display:none}") < screen);
}
