#include "mindahl/io/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include "core/platform.h"
#include "core/text.h"
#include "io/drawing.h"
#include "io/source.h"
#include "mindahl/core/error.h"
#include "mindahl/io/output_file.h"

namespace mindahl::io {
namespace {

// On white. Colours differ in lightness, so that they
// are distinct in grey and for colour-blind readers too; shades go from early, dark, to late.
constexpr std::string_view kStyle =
    "text{font-family:sans-serif;font-size:13px;fill:#1b1f24}"
    ".grid,.axis,.mark,.line,.dots{fill:none}.grid{stroke:#e4e4e4}"
    ".axis{stroke:#444;stroke-width:1.2}.mark{stroke:#444;stroke-width:1.3;stroke-dasharray:5 4}"
    ".line{stroke-width:1.7;stroke-linejoin:round;stroke-linecap:round}"
    ".dots{stroke-width:3.2;stroke-linecap:round}.marker{fill:#fff;stroke-width:1.8}"
    ".area{fill-opacity:.22}.line.more{stroke-dasharray:10 5}";
constexpr std::array<std::string_view, 6> kColours = {"#c2334a", "#2f6ea5", "#3a9d6e",
                                                      "#8d6bb1", "#e09f3e", "#5f6b76"};
constexpr std::array<std::string_view, 8> kShades = {"#440154", "#46327e", "#365c8d", "#277f8e",
                                                     "#1fa187", "#4ac16d", "#8fb52d", "#c2a50a"};

/// The rules of style of a drawing by itself.
std::string Style() {
  std::string style(kStyle);
  const auto add = [&](char kind, std::span<const std::string_view> colours) {
    for (std::size_t k = 0; k < colours.size(); ++k) {
      style += fmt::format(
          ".{0}{1}.line,.{0}{1}.dots,.{0}{1}.marker{{stroke:{2}}}"
          ".{0}{1}.area,.{0}{1}.more.marker{{fill:{2}}}",
          kind, k, colours[k]);
    }
  };
  add('s', kColours);
  add('h', kShades);
  return style;
}

/// Returns the legend of a panel in rows.
/// @param height  written: [px]
std::string LegendRows(const PlotPanel& panel, double room, double& height) {
  constexpr double kSymbol = 34;      // [px]
  constexpr double kCharacter = 7.5;  // as wide as most fonts draw it
  constexpr double kBetween = 14;
  constexpr double kRow = 20;
  std::string rows;
  height = 0.0;
  double x = 0.0;
  for (const auto& [symbol, label] : LegendOf(panel)) {
    const double width = kSymbol + kCharacter * static_cast<double>(CharactersIn(label)) + kBetween;
    if (height == 0 || (x > kSymbol && x + width > room)) {
      x = kSymbol;
      height += kRow;
    }
    rows += fmt::format(
        "<g transform=\"translate({:.1f},{:.1f})\">{}<text x=\"{}\" y=\"11\">{}</text></g>\n", x,
        height - kRow, symbol, kSymbol, HtmlText(label));
    x += width;
  }
  return rows;
}

std::string SvgOf(const Plot& plot) {
  constexpr double kEdge = 8;  // [px]
  constexpr double kHeading = 26;
  constexpr std::size_t kMostPoints = 20'000;
  if (plot.panels.empty()) throw InvalidArgument("number of panels = 0 is invalid: must be >= 1");
  RequirePositive("plot width [px]", plot.width);
  RequirePositive("plot height [px]", plot.height);
  std::string svg = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\">\n<style>{2}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      plot.width, plot.height, Style());
  double top = kEdge;
  if (!plot.title.empty()) {
    svg += fmt::format(
        "<text x=\"{}\" y=\"26\" text-anchor=\"middle\" style=\"font-size:17px\">{}</text>\n",
        plot.width / 2, HtmlText(plot.title));
    top += kHeading + kEdge;
  }
  const double width = plot.width - kEdge;
  double relative = 0.0;
  double room = plot.height - top - kEdge;  // [px] for the axes of all panels
  double legend_height = 0.0;
  for (const PlotPanel& panel : plot.panels) {
    LegendRows(panel, width, legend_height);
    relative += panel.height;
    room -= legend_height + kAboveAxes + kBelowAxes + (panel.title.empty() ? 0 : kHeading);
  }
  for (const PlotPanel& panel : plot.panels) {
    // A page too small for its margins still has axes of a pixel.
    const double axes = std::max(room * panel.height / relative, 1.0);
    if (!panel.title.empty()) {
      svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\">{}</text>\n", kEdge, top + 0.7 * kHeading,
                         HtmlText(panel.title));
      top += kHeading;
    }
    const auto add = [&](const std::string& elements, double height) {
      svg += fmt::format("<g transform=\"translate(4,{:.1f})\">{}</g>\n", top, elements);
      top += height;
    };
    const std::string legend = LegendRows(panel, width, legend_height);
    add(legend, legend_height);
    add(DrawPanel(panel, width, axes, kMostPoints * std::max<std::size_t>(panel.series.size(), 1)),
        kAboveAxes + axes + kBelowAxes);
  }
  return svg + "</svg>\n";
}

std::string ToPng(const std::string& svg, const std::filesystem::path& path) {
  ProgramOutput png;
  const int error = RunProgram({"rsvg-convert", "--format=png"}, svg, png);
  if (error == ENOENT) {
    Refuse(
        "pictures in PNG need rsvg-convert, which is not on PATH: install it (Debian: "
        "librsvg2-bin), or give a name that ends in .svg");
  }
  const std::string said = error != 0 ? std::strerror(error) : png.messages;
  // A disk that is full may end the file, and not the program.
  if (error == 0 && png.succeeded && png.output.ends_with("IEND\xAE\x42\x60\x82")) {
    return png.output;
  }
  Refuse("cannot draw '{}': rsvg-convert {}", path.string(),
         png.succeeded ? "wrote only a part of it; is the disk full?"
                       : "failed: " + said.substr(0, said.find('\n')));
}

bool IsPng(const std::filesystem::path& path) {
  const std::string extension = LowerCase(path.extension().string());
  if (extension == ".svg" || extension == ".png") return extension == ".png";
  Refuse("cannot draw '{}': its name must end in .svg or .png", path.string());
}

}  // namespace

void RequirePlotName(const std::filesystem::path& path) { IsPng(path); }

void WritePlot(const Plot& plot, const std::filesystem::path& path) {
  const bool is_png = IsPng(path);
  const std::string svg = SvgOf(plot);
  WriteFileAtomically(path, is_png ? ToPng(svg, path) : svg);
}

}  // namespace mindahl::io
