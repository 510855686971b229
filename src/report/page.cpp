#include "report/page.h"

#include <cmath>
#include <cstddef>

#include "base/files/files.h"
#include "report/plot.h"
#include "report/text.h"

namespace trilens {

// The frame of every HTML page that is written: one file, readable without scripts and without a network.

namespace {

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--paper:#fff;--ink:#1f2328;--soft:#59636e;--line:#d8dee4;--panel:#f6f8fa;--accent:#0072b2;--bad:#b3261e}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);line-height:1.5;
font:15px/1.5 system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue','DejaVu Sans',sans-serif}
main{max-width:1400px;margin:0 auto;padding:28px 24px 64px}
h1{font-size:26px;line-height:1.25;margin:0 0 4px}h2{font-size:18px;margin:36px 0 12px;padding-bottom:6px;border-bottom:1px solid var(--line)}
h3{font-size:15px;margin:0 0 8px}p{margin:6px 0;max-width:85ch}.soft{color:var(--soft)}
a{color:var(--accent)}code,pre{font:13px/1.5 ui-monospace,SFMono-Regular,Menlo,'DejaVu Sans Mono',monospace}
pre{background:var(--panel);border:1px solid var(--line);border-radius:8px;padding:12px 14px;overflow-x:auto;margin:8px 0}
.cards{display:flex;flex-wrap:wrap;gap:12px;margin:20px 0}
.card{background:var(--panel);border:1px solid var(--line);border-radius:10px;padding:12px 18px;min-width:170px}
.card b{display:block;font-size:26px;line-height:1.25;font-variant-numeric:tabular-nums}.card span{color:var(--soft);font-size:13px}
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,380px),1fr));gap:16px}
.plots+p{margin-top:14px}figure{margin:0}.plot{border:1px solid var(--line);border-radius:10px;overflow:hidden}.plot svg{display:block;width:100%;height:auto}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:14px}
th,td{padding:5px 12px;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
th{white-space:normal;color:var(--soft);font-weight:600;border-bottom-width:2px;vertical-align:bottom}th:first-child,td:first-child{text-align:left;position:sticky;left:0;background:var(--paper)}
tbody tr:hover{background:var(--panel)}
.run{border:1px solid var(--line);border-radius:10px;padding:14px 16px;margin:14px 0;break-inside:avoid}
.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,290px),1fr));gap:16px;margin:8px 0}
.pictures figure{min-width:0;max-width:560px}.view{display:grid;gap:6px;border-radius:6px;overflow:hidden}
.view img{display:block;width:100%;height:auto;min-width:0;background:#808080}
.wipe .view{grid-template-columns:1fr 1fr}.slider{display:none}
.names{display:flex;justify-content:space-between;gap:12px;color:var(--soft);font-size:13px;margin-top:4px}
.js .view{cursor:zoom-in}.js .view:focus-visible{outline:3px solid var(--accent);outline-offset:2px}
.bar{height:12px;border-radius:3px;margin-top:6px}.scale{display:flex;justify-content:space-between;font-size:12px;color:var(--soft)}
.zoom{border:0;padding:0;max-width:100vw;max-height:100vh;width:100vw;height:100vh;background:var(--paper);color:var(--ink);overflow:auto}
.zoom figure{width:max(var(--width),min(96vw,110vh));padding:12px}.zoom .view{cursor:default}.zoom img{image-rendering:pixelated}
.zoom button{position:sticky;left:12px;top:8px;z-index:1;margin:8px 12px 0;font:inherit;padding:8px 16px;border:1px solid var(--line);border-radius:8px;background:var(--panel);color:var(--ink)}
.flip button{display:none}.flip .under{display:none}.js .flip button{display:block;font:inherit;font-size:13px;margin-top:4px;padding:6px 12px;border:1px solid var(--line);border-radius:8px;background:var(--panel);color:var(--ink)}
.js .flip .view{grid-template-columns:1fr}.js .flip img{grid-area:1/1}.js .flip .under{display:block;visibility:hidden}
.js .flip .view:hover .under,.flipped .flip .under,.flip.turned .under{visibility:visible}.flipped .flip .view:hover .under,.flipped .flip.turned .under{visibility:hidden}
.small .view img{image-rendering:pixelated}
@media screen{.js .wipe .view{grid-template-columns:1fr;position:relative}.js .wipe img{grid-area:1/1}
.js .wipe img+img{clip-path:inset(0 0 0 var(--cut))}
.js .wipe .view::after{content:"";position:absolute;top:0;bottom:0;left:var(--cut);border-left:2px solid #fff;box-shadow:-1px 0 0 #0008,1px 0 0 #0008}
.js .slider{display:block}.slider input{display:block;width:100%;height:36px;margin:0;touch-action:pan-y;accent-color:var(--accent)}}
figcaption{color:var(--soft);font-size:13px;margin-top:4px}
.facts{display:grid;grid-template-columns:repeat(auto-fill,minmax(290px,1fr));gap:2px 24px;margin:8px 0;font-size:14px}
.facts div{display:flex;justify-content:space-between;gap:12px;border-bottom:1px dotted var(--line)}
.facts dt{color:var(--soft)}.facts dd{margin:0;font-variant-numeric:tabular-nums;text-align:right;overflow-wrap:anywhere}
details.run>summary{cursor:pointer;font-weight:600;overflow-wrap:anywhere}details.run[open]>summary{margin-bottom:8px}
details.run.quiet{padding:6px 16px;margin:4px 0}
.tools{display:flex;flex-wrap:wrap;gap:8px 16px;align-items:center;margin:8px 0;color:var(--soft);font-size:14px}
.tools input{font:inherit;padding:7px 10px;border:1px solid var(--line);border-radius:8px;background:var(--paper);color:var(--ink);width:min(100%,320px)}
.tall{max-height:70vh;overflow:auto}.tall th{position:sticky;top:0;background:var(--paper);z-index:1}.tall th:first-child{z-index:2}
th button{all:unset;cursor:pointer}th button:focus-visible{outline:2px solid var(--accent)}th[aria-sort=ascending] button::after{content:" ▲"}th[aria-sort=descending] button::after{content:" ▼"}
.warning{border-left:4px solid #b07d00;padding:4px 12px;background:var(--panel);margin:6px 0}
.error{border-left:4px solid var(--bad);padding:4px 12px;background:var(--panel);margin:6px 0}
.gallery{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,640px),1fr));gap:18px}
.gallery .run{margin:0}.gallery .plot{max-width:480px}
@media (max-width:600px){main{padding:16px 12px 40px}.run{padding:12px}.card{flex:1 1 40%;min-width:0;padding:10px 12px}.card b{font-size:20px;overflow-wrap:anywhere}h1{overflow-wrap:anywhere}}
@media print{main{max-width:none;padding:0}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}h2{break-after:avoid}.plot{break-inside:avoid}}
)";

constexpr const char* kDarkVariables =
    ":root{--paper:#0d1117;--ink:#e6edf3;--soft:#9198a1;--line:#30363d;--panel:#161b22;--accent:#56b4e9;--"
    "bad:#ff7b72}";

// A range input does the keys and the fingers of the slider; a dialog those of closing.
constexpr const char* kScript = R"(
document.documentElement.classList.add('js');
document.addEventListener('input',e=>{const pair=e.target.closest('.wipe');if(pair)pair.style.setProperty('--cut',e.target.value+'%')});
document.addEventListener('keydown',e=>{if((e.key==='f'||e.key==='F')&&!e.ctrlKey&&!e.metaKey&&!e.altKey&&!e.target.closest('input,textarea,select'))document.documentElement.classList.toggle('flipped')});
document.addEventListener('click',e=>{const turn=e.target.closest('.flip button');if(turn){const on=turn.closest('.flip').classList.toggle('turned');turn.setAttribute('aria-pressed',on)}});
const zoom=document.createElement('dialog'),close=document.createElement('button');zoom.className='zoom';close.textContent='Close';
close.addEventListener('click',()=>zoom.close());document.body.append(zoom);
const open=view=>{const figure=view.closest('figure').cloneNode(true),own=figure.querySelector('.view');
['tabindex','role','aria-label'].forEach(name=>own.removeAttribute(name));
const now=view.closest('figure').querySelector('input'),then=figure.querySelector('input');if(now)then.value=now.value;
figure.style.setProperty('--width',figure.querySelector('img').getAttribute('width')+'px');
zoom.replaceChildren(close,figure);zoom.showModal();zoom.scrollTo(0,0)};
document.querySelectorAll('.pictures .view').forEach(view=>{view.tabIndex=0;view.setAttribute('role','button');
view.setAttribute('aria-label','Full size: '+view.querySelector('img').alt);view.addEventListener('click',()=>open(view));
view.addEventListener('keydown',e=>{if(e.key==='Enter'||e.key===' '){e.preventDefault();open(view)}})});
)"
                                R"(
document.querySelectorAll('table').forEach(table=>{const body=table.tBodies[0],rows=[...body.rows],heads=[...table.tHead.rows[0].cells];
if(rows.length<2)return;const value=(row,i)=>row.cells[i].textContent.trim(),
number=text=>text===''?NaN:Number(text.replace(/[ %<>]/g,'').replace('−','-'));
heads.forEach((head,i)=>{const button=document.createElement('button');button.textContent=head.textContent;head.replaceChildren(button);
button.addEventListener('click',()=>{const up=head.getAttribute('aria-sort')!=='ascending';heads.forEach(other=>other.removeAttribute('aria-sort'));
head.setAttribute('aria-sort',up?'ascending':'descending');
const keyed=rows.map((row,k)=>({row,k,text:value(row,i),number:number(value(row,i))}));
keyed.sort((a,b)=>{const na=Number.isNaN(a.number),nb=Number.isNaN(b.number);if(a.text===''||b.text==='')return (a.text==='')-(b.text==='')||a.k-b.k;
const order=!na&&!nb?a.number-b.number:a.text.localeCompare(b.text);return (up?order:-order)||a.k-b.k});
body.append(...keyed.map(one=>one.row))})});
if(rows.length<8)return;const tools=document.createElement('div'),find=document.createElement('input'),count=document.createElement('span');
tools.className='tools';find.type='search';find.placeholder='filter: words that a row holds';find.setAttribute('aria-label','Filter the rows of the table');
count.setAttribute('aria-live','polite');tools.append(find,count);table.parentElement.before(tools);if(rows.length>24)table.parentElement.classList.add('tall');
const texts=rows.map(row=>[...row.cells].map(cell=>cell.textContent).join(' ').toLowerCase());
const folds=[...document.querySelectorAll('.run[data-row]')];
const apply=()=>{const words=find.value.toLowerCase().split(/\s+/).filter(Boolean);let shown=0;
rows.forEach((row,i)=>{const is=words.every(word=>texts[i].includes(word));row.hidden=!is;shown+=is;
folds.filter(fold=>fold.dataset.row===String(i)).forEach(fold=>fold.hidden=!is)});count.textContent=shown+' of '+rows.length+' rows'};
find.addEventListener('input',apply);apply()});
)";

/// A browser decodes it when it comes into view.
std::string image_element(const PagePicture& picture) {
    return "<img loading=\"lazy\" decoding=\"async\" alt=\"" + escape_markup(picture.caption) +
           "\" width=\"" + std::to_string(picture.width) + "\" height=\"" + std::to_string(picture.height) +
           "\" src=\"" +
           (picture.file.empty() ? "data:image/png;base64," + base64_text(picture.png)
                                 : escape_markup(picture.file)) +
           "\">";
}

std::string colour_bar(const ColourLegend& legend) {
    constexpr int kStops = 12;
    std::string gradient, marks;
    for (int i = 0; i <= kStops; ++i) gradient += "," + viridis_hex(static_cast<double>(i) / kStops);
    for (const double share : {0.0, 0.5, 1.0}) {
        const double value = legend.range.lo * std::pow(legend.range.hi / legend.range.lo, share);
        marks += html_text("span", rounded_text(value, 2) + " " + legend.unit);
    }
    return "<div class=\"bar\" style=\"background:linear-gradient(to right" + gradient +
           ")\"></div><div class=\"scale\">" + marks + "</div>";
}

std::string single_figure(const PagePicture& picture) {
    std::string html = "<figure>";
    if (picture.is_there()) html += "<div class=\"view\">" + image_element(picture) + "</div>";
    if (picture.legend) html += colour_bar(*picture.legend);
    return html + html_text("figcaption", picture.caption) + "</figure>\n";
}

/// Side by side without scripts and in print; with them one over the other, and a slider that moves the
/// border.
std::string pair_figure(const PagePicture& left, const PagePicture& right) {
    return "<figure class=\"wipe\" style=\"--cut:50%\"><div class=\"view\">" + image_element(left) +
           image_element(right) + "</div><div class=\"names\">" + html_text("span", left.caption) +
           html_text("span", right.caption) +
           "</div><div class=\"slider\"><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
           "aria-label=\"border between " +
           escape_markup(left.caption) + " and " + escape_markup(right.caption) + "\"></div></figure>\n";
}

}  // namespace

std::string html_page(const std::string& title, const std::string& body) {
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
           escape_markup(title) + "</title>\n<style>" + kStyle +
           "@media screen and (prefers-color-scheme:dark){" + kDarkVariables + dark_plot_style(".plot svg") +
           "}\n</style>\n</head>\n<body>\n<main>\n" + body + "</main>\n<script>" + kScript +
           "</script>\n</body>\n</html>\n";
}

std::string html_pictures(const std::vector<PagePicture>& pictures) {
    std::string html = "<div class=\"pictures\">\n";
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        const bool is_pair = i + 1 < pictures.size() && pictures[i + 1].is_over_previous &&
                             pictures[i].is_there() && pictures[i + 1].is_there();
        html += is_pair ? pair_figure(pictures[i], pictures[i + 1]) : single_figure(pictures[i]);
        i += is_pair;
    }
    return html + "</div>\n";
}

std::string html_flip(const PagePicture& first, const PagePicture& second,
                      const std::vector<PagePicture>& others) {
    std::string html = "<div class=\"pictures small\">\n" + single_figure(first);
    if (first.png.empty() || second.png.empty()) {
        html += single_figure(second);
    } else {
        std::string under = image_element(first);
        under.insert(4, " class=\"under\"");
        html += "<figure class=\"flip\"><div class=\"view\">" + image_element(second) + under + "</div>" +
                html_text("figcaption", second.caption) +
                "<button type=\"button\" aria-pressed=\"false\">Show " + escape_markup(first.caption) +
                "</button></figure>\n";
    }
    for (const PagePicture& picture : others) html += single_figure(picture);
    return html + "</div>\n";
}

std::string html_facts(const Facts& facts) {
    std::string html = "<dl class=\"facts\">\n";
    for (const auto& [name, value] : facts)
        html += "<div><dt>" + escape_markup(name) + "</dt><dd>" + escape_markup(value) + "</dd></div>\n";
    return html + "</dl>\n";
}

std::string html_table(const std::vector<std::string>& columns,
                       const std::vector<std::vector<std::string>>& rows) {
    std::string html = "<div class=\"scroll\"><table>\n<thead><tr>";
    for (const std::string& column : columns) html += html_text("th", column);
    html += "</tr></thead>\n<tbody>\n";
    for (const std::vector<std::string>& row : rows) {
        html += "<tr>";
        for (const std::string& cell : row) html += html_text("td", cell);
        html += "</tr>\n";
    }
    return html + "</tbody>\n</table></div>\n";
}

std::string html_text(const std::string& element, const std::string& text) {
    return "<" + element + ">" + escape_markup(text) + "</" + element + ">";
}

// A report as one HTML file: what was found, the plots, every run with its pictures, and how to do it again.

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
