#include "io/html.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "io/panel_drawing.h"

namespace mindahl::io {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

/// Bytes of the character of UTF-8 that begins there, 0 where there is none.
std::size_t LengthOfCharacter(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  std::size_t length = 0;
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) length = 2;
  if (first >= 0xE0 && first <= 0xEF) length = 3;
  if (first >= 0xF0 && first <= 0xF4) length = 4;
  if (length == 0 || at + length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(at + i) & 0xC0) != 0x80) return 0;
  }
  const unsigned char second = byte(at + 1);
  const bool is_overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool is_beyond = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
  return is_overlong || is_beyond ? 0 : length;
}

constexpr std::string_view kFigureStyle = R"css(
:root{color-scheme:light dark;--paper:#fff;--panel:#f5f6f8;--ink:#1b1f24;--faint:#57606a;--grid:#d8dde3;
 --accent:#0b5cad;--good:#1a6b3c;--poor:#8a5300;--bad:#b3202e;
 --s0:#c2334a;--s1:#2f6ea5;--s2:#2b7f57;--s3:#7a55a3;--s4:#a86700;--s5:#5f6b76;
 --h0:#440154;--h1:#46327e;--h2:#365c8d;--h3:#277f8e;--h4:#1b8f74;--h5:#3d9a4b;--h6:#6b9a1f;--h7:#a07a00}
@media (prefers-color-scheme:dark){:root{--paper:#14171a;--panel:#1d2226;--ink:#e8eaed;--faint:#a8b1ba;
 --grid:#363d44;--accent:#7cb7ff;--good:#62d394;--poor:#f0b34c;--bad:#ff8a93;
 --s0:#ff7b8e;--s1:#6db3f2;--s2:#5fd19a;--s3:#c39bf0;--s4:#f2b34c;--s5:#a9b4bf;
 --h0:#9a8cff;--h1:#6fa8ff;--h2:#4fc3e8;--h3:#3fd6c1;--h4:#5fe08f;--h5:#a2e05f;--h6:#dcd94f;--h7:#ffcf4a}}
@media print{:root{color-scheme:light;--paper:#fff;--panel:#fff;--ink:#000;--faint:#444;--grid:#ccc;--accent:#000;
 --good:#1a6b3c;--poor:#8a5300;--bad:#b3202e;
 --s0:#c2334a;--s1:#2f6ea5;--s2:#2b7f57;--s3:#7a55a3;--s4:#a86700;--s5:#5f6b76;
 --h0:#440154;--h1:#46327e;--h2:#365c8d;--h3:#277f8e;--h4:#1b8f74;--h5:#3d9a4b;--h6:#6b9a1f;--h7:#a07a00}}
.s0{--c:var(--s0)}.s1{--c:var(--s1)}.s2{--c:var(--s2)}.s3{--c:var(--s3)}.s4{--c:var(--s4)}.s5{--c:var(--s5)}
.h0{--c:var(--h0)}.h1{--c:var(--h1)}.h2{--c:var(--h2)}.h3{--c:var(--h3)}
.h4{--c:var(--h4)}.h5{--c:var(--h5)}.h6{--c:var(--h6)}.h7{--c:var(--h7)}
figure{margin:0;min-width:0}
figure h3{margin:.2rem 0}
figure p{margin:.1rem 0 .3rem;color:var(--faint);font-size:.9rem}
figure svg.plot{display:block;width:100%;height:auto;max-width:52rem}
svg text{font:13px system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",sans-serif;fill:var(--ink)}
@media (max-width:600px){svg text{font-size:17px}}
.grid{stroke:var(--grid);stroke-width:1;fill:none}
.axis{stroke:var(--faint);stroke-width:1.2;fill:none}
.mark{stroke:var(--ink);stroke-width:1.3;stroke-dasharray:5 4;fill:none}
.line{fill:none;stroke:var(--c);stroke-width:1.7;stroke-linejoin:round;stroke-linecap:round}
.dots{fill:none;stroke:var(--c);stroke-width:3.2;stroke-linecap:round}
.marker{fill:var(--paper);stroke:var(--c);stroke-width:1.8}
.area{fill:var(--c);fill-opacity:.22;stroke:none}
.full{fill:var(--c)}
.d1{stroke-dasharray:10 5}.d2{stroke-dasharray:3 4}
.bars{fill:var(--c);fill-opacity:.35;stroke:var(--c);stroke-width:.8}
.legend{list-style:none;display:flex;flex-wrap:wrap;gap:.1rem 1.1rem;padding:0;margin:.1rem 0;font-size:.9rem}
.legend li{margin:0;overflow-wrap:anywhere}
.legend svg{width:26px;height:12px;margin-right:.35rem;vertical-align:-1px}
)css";

constexpr std::string_view kPageStyle = R"css(
*{box-sizing:border-box}
body{margin:0 auto;padding:1.2rem 1rem 3rem;max-width:82rem;background:var(--paper);color:var(--ink);
 font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",sans-serif;overflow-wrap:anywhere}
h1{font-size:1.45rem;line-height:1.25;margin:.2rem 0 .6rem}
h2{font-size:1.15rem;margin:2.2rem 0 .6rem;padding-top:.5rem;border-top:1px solid var(--grid)}
h3{font-size:1rem;margin:1.2rem 0 .4rem}
p,ul,ol{margin:.4rem 0;max-width:60rem}
ul,ol{padding-left:1.3rem}
li{margin:.25rem 0}
a{color:var(--accent)}
.faint{color:var(--faint)}
.verdict{border-left:.4rem solid var(--faint);padding:.5rem .9rem;margin:.6rem 0;background:var(--panel);
 max-width:60rem;border-radius:0 .3rem .3rem 0}
.verdict.good{border-color:var(--good)} .verdict.poor{border-color:var(--poor)} .verdict.bad{border-color:var(--bad)}
.good b,.good strong,td.good{color:var(--good)} .poor b,.poor strong,td.poor{color:var(--poor)}
.bad b,.bad strong,td.bad{color:var(--bad)}
.table{overflow-x:auto;margin:.5rem 0}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;overflow-wrap:normal}
caption{text-align:left;color:var(--faint);font-size:.9rem;padding:.2rem 0}
th,td{text-align:left;padding:.28rem .8rem .28rem 0;border-bottom:1px solid var(--grid);vertical-align:top}
thead th{color:var(--faint);font-weight:600;font-size:.88rem}
tbody th{font-weight:600}
td.number{white-space:nowrap}
td.words{min-width:13rem;overflow-wrap:anywhere}
code,pre{font:0.9em/1.45 ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;overflow-wrap:anywhere}
pre{background:var(--panel);border:1px solid var(--grid);border-radius:.3rem;padding:.5rem .7rem;
 white-space:pre-wrap;margin:.4rem 0;max-width:60rem}
.option{white-space:nowrap}
.figures{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,27rem),1fr));gap:1.4rem 2rem;
 align-items:start}
.first{display:grid;grid-template-columns:minmax(0,1fr) minmax(0,1fr);gap:.5rem 2rem;align-items:start}
.first h2{border:0;margin:.8rem 0 .3rem;padding:0} .first p,.first .verdict{margin-top:.2rem} .first td.words{min-width:0;overflow-wrap:normal} .first th,.first td{padding-right:.6rem}
@media (max-width:900px){.first{display:block}}
@media (max-width:600px){body{padding:.8rem .8rem 2rem} th,td{padding-right:.6rem}
 tbody th{min-width:7rem;overflow-wrap:anywhere} td.words{min-width:8rem}}
@media print{body{max-width:none;font-size:10.5pt;padding:0} figure,tr,.verdict,pre{break-inside:avoid}
 h2,h3,caption,thead,thead tr{break-after:avoid} tbody tr:nth-child(-n+2){break-before:avoid}
 .first{display:block} .first figure{max-width:32rem} .figures{grid-template-columns:1fr 1fr} .figures svg text{font-size:17px}
 .table{overflow:visible} td.number{white-space:normal} td.words{min-width:6rem}
 tbody th{min-width:6rem;overflow-wrap:anywhere} a{color:inherit}}
)css";

}  // namespace

std::string HtmlText(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = LengthOfCharacter(text, at);
    const auto first = static_cast<unsigned char>(text[at]);
    if (length == 0 || (first < 0x20 && first != '\n' && first != '\t') || first == 0x7F) {
      escaped += kReplacement;
    } else if (first == '&') {
      escaped += "&amp;";
    } else if (first == '<') {
      escaped += "&lt;";
    } else if (first == '>') {
      escaped += "&gt;";
    } else if (first == '"') {
      escaped += "&quot;";
    } else if (first == '\'') {
      escaped += "&#39;";
    } else {
      escaped += text.substr(at, length);
    }
    at += length == 0 ? 1 : length;
  }
  return escaped;
}

std::string_view FigureStyle() { return kFigureStyle; }

std::string HtmlFigure(const PlotPanel& panel, const FigureText& text) {
  RequireDrawable(panel, fmt::format("figure '{}'", text.id));
  constexpr double kWidth = 560;  // [px], where it is not scaled to the page
  constexpr std::size_t kMostPoints = 6000;
  const double height = std::round(kWidth / 2 * panel.height);
  std::string legend;
  const std::vector<SeriesLook> looks = LooksOf(panel);
  for (std::size_t k = 0; k < panel.series.size(); ++k) {
    if (panel.series[k].label.empty()) continue;
    legend +=
        fmt::format("<li><svg viewBox=\"0 0 26 12\" aria-hidden=\"true\">{}</svg>{}</li>",
                    LegendSymbol(panel.series[k].style, looks[k]), HtmlText(panel.series[k].label));
  }
  if (!legend.empty()) legend = fmt::format("<ul class=\"legend\">{}</ul>\n", legend);
  const std::string id = HtmlText(text.id);
  return fmt::format(
      "<figure id=\"{0}\">\n<h3>{1}</h3>\n<p>{2}</p>\n{3}"
      "<svg class=\"plot\" viewBox=\"0 0 {4} {5}\" role=\"img\" aria-labelledby=\"{0}-title "
      "{0}-text\"><title id=\"{0}-title\">{1}</title><desc id=\"{0}-text\">{2}</desc>{6}</svg>\n"
      "</figure>\n",
      id, HtmlText(text.title), HtmlText(text.description), legend, kWidth,
      kAboveAxes + height + kBelowAxes, DrawPanel(panel, kWidth, height, kMostPoints));
}

std::string HtmlPage(std::string_view title, std::string_view body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'; img-src data:\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<meta name=\"generator\" content=\"mindahl\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n{}</body>\n</html>\n",
      HtmlText(title), FigureStyle(), kPageStyle, body);
}

}  // namespace mindahl::io
