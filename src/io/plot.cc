#include "mindahl/io/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <string_view>

#include "core/platform.h"
#include "core/text.h"
#include "io/html.h"
#include "io/panel_drawing.h"
#include "io/unfinished_output.h"
#include "mindahl/core/error.h"
#include "mindahl/io/output_file.h"

namespace mindahl::io {
namespace {

constexpr std::size_t kMostPointsOfPlot = 20'000;

// Heights of a plot's and its panels' parts [px].
constexpr double kTitleHeight = 40;     // of the whole plot
constexpr double kSubtitleHeight = 22;  // under it
constexpr double kHeading = 26;         // title and legend of a panel, above its drawing
constexpr double kLabelBelow = 24;      // label of the horizontal axis, where it has one
constexpr double kEdge = 8;

// A legend entry [px]: its symbol, and a character of its text, as wide as most fonts draw it.
constexpr double kSymbol = 34;
constexpr double kBetweenEntries = 14;
constexpr double kCharacter = 7.5;
constexpr double kEntryHeight = 20;
constexpr std::size_t kMostAbove = 4;
constexpr double kLargestLegend = 0.4;  // of a column's width

void Validate(const Plot& plot) {
  if (plot.panels.empty()) throw InvalidArgument("number of panels = 0 is invalid: must be >= 1");
  RequirePositive("plot width [px]", plot.width);
  RequirePositive("plot height [px]", plot.height);
  RequirePositive("number of plot columns", plot.columns);
  for (std::size_t panel = 0; panel < plot.panels.size(); ++panel) {
    RequireDrawable(plot.panels[panel], fmt::format("panel {}", panel + 1));
  }
}

/// Returns the rules of style of a drawing by itself, on white, without variables, which programs
/// that convert SVG do not know.
std::string StyleOfPlot() {
  // Colours differ in lightness, so that they are distinct in grey and for colour-blind readers
  // too; shades go from early, dark, to late.
  constexpr std::array<std::string_view, 6> kPlotColours = {"#4878a8", "#d1495b", "#3a9d6e",
                                                            "#8d6bb1", "#e09f3e", "#5f6b76"};
  constexpr std::array<std::string_view, 8> kPlotShades = {
      "#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#8fb52d", "#c2a50a"};
  std::string rules =
      "text{font-family:sans-serif;font-size:13px;fill:#1b1f24}"
      ".grid,.axis,.mark,.line,.dots{fill:none}.grid{stroke:#e4e4e4}"
      ".axis{stroke:#444;stroke-width:1.2}.mark{stroke:#444;stroke-width:1.3;stroke-dasharray:5 4}"
      ".line{stroke-width:1.7;stroke-linejoin:round;stroke-linecap:round}"
      ".dots{stroke-width:3.2;stroke-linecap:round}.marker{fill:#fff;stroke-width:1.8}"
      ".area{fill-opacity:.22;stroke:none}.bars{fill-opacity:.35;stroke-width:.8}"
      ".d1{stroke-dasharray:10 5}.d2{stroke-dasharray:3 4}";
  const auto add = [&](char kind, std::span<const std::string_view> colours) {
    for (std::size_t k = 0; k < colours.size(); ++k) {
      rules += fmt::format(
          ".{0}{1}.line,.{0}{1}.dots,.{0}{1}.marker,.{0}{1}.bars{{stroke:{2}}}"
          ".{0}{1}.area,.{0}{1}.bars,.{0}{1}.full{{fill:{2}}}",
          kind, k, colours[k]);
    }
  };
  add('s', kPlotColours);
  add('h', kPlotShades);
  return rules;
}

/// About how wide a text is [px].
double TextWidth(std::string_view text) {
  return kCharacter * static_cast<double>(CharactersIn(text));
}

struct Legend {
  std::size_t entries = 0;
  double longest = 0.0;  // [px]
  double row = 0.0;      // [px], all in one row
};

Legend LegendOf(const PlotPanel& panel) {
  Legend legend;
  for (const PlotSeries& series : panel.series) {
    if (series.label.empty()) continue;
    const double width = kSymbol + TextWidth(series.label) + kBetweenEntries;
    ++legend.entries;
    legend.longest = std::max(legend.longest, width);
    legend.row += width;
  }
  return legend;
}

class Page {
 public:
  explicit Page(const Plot& plot) : plot_(plot) {
    Add("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
        "viewBox=\"0 0 {0} {1}\">\n<style>{2}</style>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        plot.width, plot.height, StyleOfPlot());
    AddPanels();
    Add("</svg>\n");
  }

  std::string Text() && { return std::move(text_); }

 private:
  template <typename... Arguments>
  void Add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  void AddText(double x, double y, std::string_view attributes, std::string_view text) {
    Add("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", x, y, attributes, HtmlText(text));
  }

  std::size_t Columns() const { return static_cast<std::size_t>(plot_.columns); }

  bool IsLegendAtSide(const PlotPanel& panel) const {
    const Legend legend = LegendOf(panel);
    const double room = plot_.width / static_cast<double>(plot_.columns) - 2 * kEdge;
    return legend.entries > kMostAbove || TextWidth(panel.title) + kEdge + legend.row > room;
  }

  /// Returns the room for the legends on the right of each column [px]. One that stands where a
  /// panel is missing from the last row needs none.
  std::vector<double> LegendWidths() const {
    std::vector<double> widths(Columns(), 0.0);
    const double largest = kLargestLegend * plot_.width / plot_.columns;
    for (std::size_t panel = 0; panel < plot_.panels.size(); ++panel) {
      const std::size_t column = panel % Columns();
      const bool is_room_free = panel + 1 == plot_.panels.size() && column + 1 < Columns();
      if (is_room_free || !IsLegendAtSide(plot_.panels[panel])) continue;
      widths[column] =
          std::max(widths[column], std::min(LegendOf(plot_.panels[panel]).longest, largest));
    }
    return widths;
  }

  void AddPanels() {
    struct Row {
      double height = 0.0;  // of the axes, relative to other rows
      double heading = 0.0;
      double below = kBelowAxes - kLabelBelow;
    };
    std::vector<Row> rows((plot_.panels.size() + Columns() - 1) / Columns());
    for (std::size_t k = 0; k < plot_.panels.size(); ++k) {
      const PlotPanel& panel = plot_.panels[k];
      Row& row = rows[k / Columns()];
      row.height = std::max(row.height, panel.height);
      if (!panel.title.empty() || LegendOf(panel).entries > 0) row.heading = kHeading;
      if (!panel.x_label.empty()) row.below = kBelowAxes;
    }
    double heights = 0.0;
    double around = 0.0;
    for (const Row& row : rows) {
      heights += row.height;
      around += row.heading + kAboveAxes + row.below;
    }
    const double subtitle = plot_.subtitle.empty() ? 0.0 : kSubtitleHeight;
    double top = (plot_.title.empty() ? kEdge : kTitleHeight) + subtitle;
    // A page too small for its margins still gets axes one pixel high.
    const double drawable = std::max(plot_.height - top - around - kEdge, heights);
    constexpr std::string_view kCentred = " text-anchor=\"middle\"";
    if (!plot_.title.empty()) {
      AddText(plot_.width / 2.0, 0.65 * kTitleHeight,
              " text-anchor=\"middle\" style=\"font-size:17px\"", plot_.title);
    }
    if (subtitle > 0) AddText(plot_.width / 2.0, top - 0.4 * subtitle, kCentred, plot_.subtitle);
    const std::vector<double> legends = LegendWidths();
    double legends_width = 0.0;
    for (const double legend : legends) legends_width += legend;
    const double width = std::max((plot_.width - legends_width) / plot_.columns - kEdge, 1.0);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const double axes = drawable * rows[row].height / heights;
      double left = kEdge / 2;
      for (std::size_t column = 0; column < Columns(); ++column) {
        const std::size_t panel = row * Columns() + column;
        if (panel >= plot_.panels.size()) break;
        AddPanel(plot_.panels[panel], left, top, top + rows[row].heading, width, axes);
        left += width + legends[column] + kEdge;
      }
      top += rows[row].heading + kAboveAxes + axes + rows[row].below;
    }
  }

  /// @param left, top  of the panel with its heading [px]
  /// @param drawing    top of what is below the heading [px]
  void AddPanel(const PlotPanel& panel, double left, double top, double drawing, double width,
                double axes) {
    const double heading = top + 0.7 * kHeading;
    if (!panel.title.empty()) AddText(left + kEdge, heading, "", panel.title);
    const bool at_side = IsLegendAtSide(panel);
    double x = at_side ? left + width + kEdge : left + width - LegendOf(panel).row;
    double y = at_side ? drawing + kAboveAxes : heading;
    const std::vector<SeriesLook> looks = LooksOf(panel);
    for (std::size_t k = 0; k < panel.series.size(); ++k) {
      const PlotSeries& series = panel.series[k];
      if (series.label.empty()) continue;
      Add("<g transform=\"translate({:.1f},{:.1f})\">{}</g>", x, y - 11,
          LegendSymbol(series.style, looks[k]));
      AddText(x + kSymbol, y, "", series.label);
      if (at_side) {
        y += kEntryHeight;
      } else {
        x += kSymbol + TextWidth(series.label) + kBetweenEntries;
      }
    }
    Add("<g transform=\"translate({:.1f},{:.1f})\">{}</g>\n", left, drawing,
        DrawPanel(panel, width, axes, kMostPointsOfPlot * panel.series.size()));
  }

  const Plot& plot_;
  std::string text_;
};

/// Returns the first line of a program's messages.
std::string FirstLine(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

std::string Content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Runs `rsvg-convert --format=png --output=PNG SVG`; false where it fails.
bool Convert(const std::string& svg, const std::string& png, const std::string& messages) {
  bool succeeded = false;
  const int error =
      RunProgram({"rsvg-convert", "--format=png", "--output=" + png, svg}, messages, succeeded);
  if (error == ENOENT) {
    throw InputError(
        "pictures in PNG need rsvg-convert, which is not on PATH: install it (Debian: "
        "librsvg2-bin), or give a name that ends in .svg");
  }
  if (error != 0)
    throw InputError(fmt::format("cannot run rsvg-convert: {}", std::strerror(error)));
  return succeeded;
}

std::string ToPng(const std::string& svg, const std::filesystem::path& path) {
  std::string pattern = (std::filesystem::temp_directory_path() / "mindahl-plot-XXXXXX").string();
  if (const int error = MakeNewDirectory(pattern); error != 0) {
    throw InputError(
        fmt::format("cannot make the directory '{}': {}", pattern, std::strerror(error)));
  }
  const TemporaryName scratch(pattern);
  const TemporaryName drawing(pattern + "/plot.svg");
  const TemporaryName picture(pattern + "/plot.png");
  const TemporaryName messages(pattern + "/messages");
  if (!(std::ofstream(drawing.name(), std::ios::binary) << svg).flush()) {
    throw InputError(fmt::format("cannot write '{}': is the disk full?", drawing.name()));
  }
  if (!Convert(drawing.name(), picture.name(), messages.name())) {
    throw InputError(fmt::format("cannot draw '{}': rsvg-convert failed: {}", path.string(),
                                 FirstLine(messages.name())));
  }
  const std::string png = Content(picture.name());
  // A disk that is full may end the file, and not the program.
  if (!png.ends_with("IEND\xAE\x42\x60\x82")) {
    throw InputError(
        fmt::format("cannot draw '{}': rsvg-convert wrote only a part of it; is the disk full?",
                    path.string()));
  }
  return png;
}

enum class Format { kSvg, kPng };

Format FormatOf(const std::filesystem::path& path) {
  const std::string extension = LowerCase(path.extension().string());
  if (extension == ".svg") return Format::kSvg;
  if (extension == ".png") return Format::kPng;
  throw InputError(
      fmt::format("cannot draw '{}': its name must end in .svg or .png", path.string()));
}

}  // namespace

void RequirePlotName(const std::filesystem::path& path) { FormatOf(path); }

void WritePlot(const Plot& plot, const std::filesystem::path& path) {
  Validate(plot);
  const Format format = FormatOf(path);
  std::string drawn = Page(plot).Text();
  if (format == Format::kPng) drawn = ToPng(drawn, path);
  WriteFileAtomically(path, drawn);
}

}  // namespace mindahl::io
