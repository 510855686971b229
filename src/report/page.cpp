// The frame of every HTML page that is written: one file, readable without scripts and without a network.
#include "report/page.h"

#include <cstddef>

#include "report/plot_style.h"
#include "report/text.h"

namespace trilens {
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
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,520px),1fr));gap:16px}
figure{margin:0}.plot{border:1px solid var(--line);border-radius:10px;overflow:hidden}.plot svg{display:block;width:100%;height:auto}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:14px}
th,td{padding:5px 12px;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
th{white-space:normal;color:var(--soft);font-weight:600;border-bottom-width:2px;vertical-align:bottom}th:first-child,td:first-child{text-align:left}
tbody tr:hover{background:var(--panel)}
.run{border:1px solid var(--line);border-radius:10px;padding:14px 16px;margin:14px 0;break-inside:avoid}
.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(200px,1fr));gap:12px;margin:8px 0}
.pictures figure{min-width:0}.pictures img{display:block;width:100%;height:auto;max-width:480px;border-radius:6px;cursor:zoom-in;background:#808080}
.pictures img.big{image-rendering:pixelated;cursor:zoom-out;max-width:none}
.pictures figure:has(img.big){grid-column:1/-1}
figcaption{color:var(--soft);font-size:13px;margin-top:4px}
.facts{display:grid;grid-template-columns:repeat(auto-fill,minmax(290px,1fr));gap:2px 24px;margin:8px 0;font-size:14px}
.facts div{display:flex;justify-content:space-between;gap:12px;border-bottom:1px dotted var(--line)}
.facts dt{color:var(--soft)}.facts dd{margin:0;font-variant-numeric:tabular-nums;text-align:right;overflow-wrap:anywhere}
.warning{border-left:4px solid #b07d00;padding:4px 12px;background:var(--panel);margin:6px 0}
.error{border-left:4px solid var(--bad);padding:4px 12px;background:var(--panel);margin:6px 0}
.bar{height:14px;border-radius:4px;max-width:420px}.scale{display:flex;justify-content:space-between;max-width:420px;font-size:12px;color:var(--soft)}
.gallery{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,620px),1fr));gap:18px}
.gallery .run{margin:0}.gallery .pictures{grid-template-columns:repeat(auto-fit,minmax(150px,1fr))}
@media print{main{max-width:none;padding:0}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}h2{break-after:avoid}.plot{break-inside:avoid}}
)";

constexpr const char* kDarkVariables =
    ":root{--paper:#0d1117;--ink:#e6edf3;--soft:#9198a1;--line:#30363d;--panel:#161b22;--accent:#56b4e9;--"
    "bad:#ff7b72}";

constexpr const char* kScript = R"(
document.querySelectorAll('.pictures').forEach(row=>{const [a,b]=row.querySelectorAll('img');
row.querySelectorAll('img').forEach(i=>i.addEventListener('click',()=>i.classList.toggle('big')));
if(!a||!b)return;const own=a.src,cap=a.parentNode.querySelector('figcaption'),words=cap.textContent;
a.addEventListener('mouseenter',()=>{a.src=b.src;cap.textContent=b.parentNode.querySelector('figcaption').textContent});
a.addEventListener('mouseleave',()=>{a.src=own;cap.textContent=words})});
)";

}  // namespace

std::string html_page(const std::string& title, const std::string& body) {
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
           escape_markup(title) + "</title>\n<style>" + kStyle +
           "@media screen and (prefers-color-scheme:dark){" + kDarkVariables + dark_plot_style(".plot svg") +
           "}\n</style>\n</head>\n<body>\n<main>\n" + body + "</main>\n<script>" + kScript +
           "</script>\n</body>\n</html>\n";
}

std::string html_pictures(const std::vector<Thumbnail>& pictures) {
    std::string html = "<div class=\"pictures\">\n";
    for (const Thumbnail& picture : pictures) {
        const std::string caption = escape_markup(picture.caption);
        html += "<figure>";
        if (!picture.png.empty())
            html += "<img alt=\"" + caption + "\" width=\"" + std::to_string(picture.width) + "\" height=\"" +
                    std::to_string(picture.height) + "\" src=\"data:image/png;base64," +
                    base64_text(picture.png) + "\">";
        html += "<figcaption>" + caption + "</figcaption></figure>\n";
    }
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

}  // namespace trilens
