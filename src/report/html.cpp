// A report as one HTML file: what was found, the plots, every run with its pictures, and how to do it again.
#include "report/html.h"

#include "base/files/file_bytes.h"
#include "report/text.h"

namespace trilens {
namespace {

std::string paragraph(const std::string& style, const std::string& text) {
    return text.empty() ? "" : "<p class=\"" + style + "\">" + escape_markup(text) + "</p>\n";
}

std::string heading(const std::string& text) {
    return html_text("h2", text) + "\n";
}

std::string plot_figure(const std::string& svg) {
    return "<figure class=\"plot\">\n" + svg + "</figure>\n";
}

std::string run_section(const ReportRun& run) {
    const std::string row = run.row < 0 ? "" : " data-row=\"" + std::to_string(run.row) + "\"";
    std::string html =
        run.is_folded ? "<details class=\"run quiet\"" + row + ">" + html_text("summary", run.title) + "\n"
                      : "<section class=\"run\"" + row + ">\n" + html_text("h3", run.title) + "\n";
    html += paragraph("error", run.error);
    for (const std::string& warning : run.warnings) html += paragraph("warning", warning);
    if (!run.pictures.empty()) html += html_pictures(run.pictures);
    if (!run.facts.empty()) html += html_facts(run.facts);
    return html + (run.is_folded ? "</details>\n" : "</section>\n");
}

std::string how_to_repeat(const std::vector<std::string>& commands, const Facts& versions) {
    std::string html;
    if (!commands.empty()) {
        html += heading("To do it again") + "<pre>";
        for (const std::string& command : commands) html += escape_markup(command) + "\n";
        html += "</pre>\n";
    }
    if (!versions.empty()) html += heading("Versions") + html_facts(versions);
    return html;
}

/// Whether a browser would take `link` to another host or run it: it has a scheme or begins with two slashes.
bool leads_outside(const std::string& link) {
    return link.find(':') < link.find_first_of("/?#") || link.substr(0, 2) == "//" ||
           link.find('\\') != std::string::npos;
}

std::string gallery_card(const GalleryEntry& entry) {
    std::string html = "<section class=\"run\">\n<h3>";
    if (entry.link.empty() || leads_outside(entry.link))
        html += escape_markup(entry.title);
    else
        html += "<a href=\"" + escape_markup(entry.link) + "\">" + escape_markup(entry.title) + "</a>";
    html += "</h3>\n" + paragraph("soft", entry.text);
    if (!entry.link.empty() && leads_outside(entry.link)) html += paragraph("soft", entry.link);
    if (!entry.pictures.empty()) html += html_pictures(entry.pictures);
    if (!entry.plot.empty()) html += plot_figure(entry.plot);
    if (!entry.metrics.empty()) html += html_facts(entry.metrics);
    return html + "</section>\n";
}

}  // namespace

std::string report_html(const Report& report) {
    std::string body = html_text("h1", report.title) + "\n" + paragraph("soft", report.summary);
    if (!report.headlines.empty()) {
        body += "<div class=\"cards\">\n";
        for (const Headline& headline : report.headlines)
            body += "<div class=\"card\">" + html_text("b", headline.value) +
                    html_text("span", headline.meaning) + "</div>\n";
        body += "</div>\n";
    }
    for (const std::string& warning : report.warnings) body += paragraph("warning", warning);
    if (!report.plots.empty() || !report.sentences.empty()) body += heading("Convergence");
    for (const std::string& sentence : report.sentences) body += paragraph("", sentence);
    if (!report.plots.empty()) {
        body += "<div class=\"plots\">\n";
        for (const std::string& plot : report.plots) body += plot_figure(plot);
        body += "</div>\n" + paragraph("soft", report.plots_note);
    }
    if (!report.table_rows.empty())
        body += heading("Numbers") + html_table(report.table_columns, report.table_rows);
    if (!report.runs.empty()) {
        body += heading("Runs") + paragraph("soft", report.pictures_note);
        for (const ReportRun& run : report.runs) body += run_section(run);
    }
    return html_page(report.title, body + how_to_repeat(report.commands, report.versions));
}

void write_report(const std::string& file, const Report& report) {
    replace_text_file(file, report_html(report));
}

std::string gallery_html(const Gallery& gallery) {
    std::string body = html_text("h1", gallery.title) + "\n" + paragraph("soft", gallery.text);
    for (const std::string& warning : gallery.warnings) body += paragraph("warning", warning);
    body += "<div class=\"gallery\">\n";
    for (const GalleryEntry& entry : gallery.entries) body += gallery_card(entry);
    return html_page(gallery.title, body + "</div>\n" + how_to_repeat(gallery.commands, gallery.versions));
}

void write_gallery(const std::string& file, const Gallery& gallery) {
    replace_text_file(file, gallery_html(gallery));
}

}  // namespace trilens
