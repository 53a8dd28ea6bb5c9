#include "mindahl/io/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "io/gnuplot.h"
#include "io/plot_rules.h"
#include "io/power_of_ten.h"
#include "io/thinning.h"
#include "mindahl/core/error.h"
#include "mindahl/io/output_file.h"

namespace mindahl::io {
namespace {

constexpr std::size_t kMostPoints = 20'000;

// Colours of different lightness, distinct in grey and for colour-blind readers too.
constexpr std::array<std::string_view, 6> kColours = {"#4878a8", "#d1495b", "#3a9d6e",
                                                      "#8d6bb1", "#e09f3e", "#5f6b76"};

// Shades for a sequence of series: from early, dark, to late.
constexpr std::array<std::string_view, 8> kShades = {"#440154", "#46327e", "#365c8d", "#277f8e",
                                                     "#1fa187", "#4ac16d", "#8fb52d", "#c2a50a"};

// gnuplot's point types, one a colour: filled at first, then open and on another colour than
// before.
constexpr std::array<int, 12> kMarkerShapes = {7, 5, 9, 13, 11, 15, 8, 12, 6, 4, 14, 10};
// For the first six lines, the next six and so on.
constexpr std::array<std::string_view, 3> kDashes = {"", " dt (10,5)", " dt (3,4)"};
constexpr int kDot = 7;
constexpr int kCross = 2;

// Margins [px]
constexpr double kLeft = 95;
constexpr double kRight = 25;
constexpr double kTitle = 40;
constexpr double kSubtitle = 22;
constexpr double kLegend = 30;  // above each panel
constexpr double kBelow = 58;   // tics and x label under each panel
constexpr double kEdge = 8;

// A legend entry [px]: its sample, and a character of its text, as wide as most fonts draw it.
constexpr double kSample = 60;
constexpr double kCharacter = 8;
constexpr std::size_t kMostAbove = 4;
constexpr double kLargestLegendShare = 0.4;  // of a column's width

void Validate(const Plot& plot) {
  if (plot.panels.empty()) throw InvalidArgument("number of panels = 0 is invalid: must be >= 1");
  RequirePositive("plot width [px]", plot.width);
  RequirePositive("plot height [px]", plot.height);
  RequirePositive("number of plot columns", plot.columns);
  for (std::size_t panel = 0; panel < plot.panels.size(); ++panel) {
    RequireDrawable(plot.panels[panel], fmt::format("panel {}", panel + 1));
  }
}

/// Quotes a text: in single quotes gnuplot interprets nothing but the quote itself; the terminal is
/// told to leave the text alone too. A string ends with its line.
std::string Quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char character : text) {
    if (character == '\'') quoted += '\'';
    quoted += static_cast<unsigned char>(character) < 0x20 ? ' ' : character;
  }
  return quoted + "'";
}

std::string_view ColourOf(const PlotSeries& curve, std::size_t series) {
  if (!curve.shade) return kColours[series % kColours.size()];
  const auto shade = static_cast<std::size_t>(std::lround(*curve.shade * (kShades.size() - 1)));
  return kShades[std::min(shade, kShades.size() - 1)];
}

/// Returns how a series is drawn. Beyond the first six, colours repeat with dashes, crosses or
/// other markers.
/// @param series     its place in the panel
/// @param in_legend  there the dots of a dense series would be too small to see
std::string StyleCommand(const PlotSeries& curve, std::size_t series, bool in_legend) {
  const PlotStyle style = curve.style;
  const std::size_t round = series / kColours.size();
  const std::string dashes(kDashes[round % kDashes.size()]);
  const int marker = kMarkerShapes[series % kMarkerShapes.size()];
  std::string command;
  switch (style) {
    case PlotStyle::kLine:
      command = "lines lw 2" + dashes;
      break;
    case PlotStyle::kPoints:
      command =
          fmt::format("points pt {} ps {}", round % 2 == 0 ? kDot : kCross, in_legend ? 0.9 : 0.35);
      break;
    case PlotStyle::kMarkers:
      command = fmt::format("points pt {} ps 0.9", marker);
      break;
    case PlotStyle::kIntervals:
      // A key has no errors to draw.
      command = fmt::format("{} pt {} ps 0.9 lw 1.5", in_legend ? "points" : "yerrorbars", marker);
      break;
    case PlotStyle::kLineAndPoints:
      command = fmt::format("linespoints lw 1.5 pt {} ps 0.9{}", marker, dashes);
      break;
    case PlotStyle::kBand:
      command = "lines lw 1.5" + dashes;
      break;
    case PlotStyle::kBars:
      command = "boxes fill transparent solid 0.4";
      break;
  }
  return command + fmt::format(" lc rgb '{}'", ColourOf(curve, series));
}

/// Powers of ten between two labels of a logarithmic axis.
int LabelStep(int powers) {
  constexpr int kMostLabels = 7;
  for (const int step : {1, 2, 3, 5, 10, 20, 50}) {
    if (powers <= kMostLabels * step) return step;
  }
  return 100;
}

/// Tics of a logarithmic axis, for `set xtics`. Labels are at powers of ten; where there are not
/// two of them, at other multiples too.
std::string LogTics(double from, double to) {
  const int first = static_cast<int>(std::floor(std::log10(from)));
  const int last = static_cast<int>(std::ceil(std::log10(to)));
  const int step = LabelStep(last - first);
  const bool has_powers = std::floor(std::log10(to)) - std::ceil(std::log10(from)) >= 1;
  const bool is_short = !has_powers && from >= 1e-3 && to <= 1e4;  // 0.02 rather than 2·10⁻²
  std::vector<std::string> tics;
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int multiple = 1; multiple <= (step == 1 ? 9 : 1); ++multiple) {
      const double at = multiple * std::pow(10.0, exponent);
      if (at < from || at > to) continue;
      const bool is_whole = multiple == 1 || multiple == 2 || multiple == 3 || multiple == 5;
      const bool is_labelled = has_powers ? multiple == 1 && exponent % step == 0 : is_whole;
      if (is_labelled) {
        std::string label = PowerOfTen(exponent);
        if (multiple > 1) label = fmt::format("{}·{}", multiple, label);
        if (is_short) label = fmt::format("{:.9g}", at);
        tics.push_back(fmt::format("'{}' {:.9g} 0", label, at));
      } else if (step < 10) {
        tics.push_back(fmt::format("'' {:.9g} 1", at));
      }
    }
  }
  return fmt::format("({})", fmt::join(tics, ", "));
}

/// Legend entries of a panel.
struct Legend {
  std::size_t entries = 0;
  double longest = 0.0;  ///< [px]
};

/// About how wide a text is [px].
double TextWidth(std::string_view text) {
  const auto characters = std::ranges::count_if(text, [](char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0) != 0x80;  // of UTF-8: not a continuation
  });
  return kCharacter * static_cast<double>(characters);
}

Legend LegendOf(const PlotPanel& panel) {
  Legend legend;
  for (const PlotSeries& series : panel.series) {
    if (series.label.empty()) continue;
    ++legend.entries;
    legend.longest = std::max(legend.longest, kSample + TextWidth(series.label));
  }
  return legend;
}

/// Holds the place of a panel's axes, from the top left of the page [px].
struct PanelFrame {
  double left;
  double right;
  double top;
  double bottom;
};

class Script {
 public:
  Script(const Plot& plot, std::string_view terminal) : plot_(plot) {
    Add("set encoding utf8\n");
    Add("set terminal {} size {},{} noenhanced background '#ffffff'\n", terminal, plot.width,
        plot.height);
    Add("set border 3 lc rgb '#444444'\nset tics nomirror scale 0.6\n");
    Add("set grid back lc rgb '#e4e4e4' lw 1 lt 1\n");
    Add("set xlabel offset 0,0.3\n");
    AddData();
    Add("set multiplot\n");
    AddPanels();
    Add("unset multiplot\n");
  }

  std::string Text() && { return std::move(text_); }

 private:
  template <typename... Arguments>
  void Add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  void AddData() {
    for (std::size_t panel = 0; panel < plot_.panels.size(); ++panel) {
      const std::vector<PlotSeries>& all = plot_.panels[panel].series;
      for (std::size_t series = 0; series < all.size(); ++series) {
        Add("$data_{}_{} << END\n", panel, series);
        for (const std::size_t point : Thinned(all[series], kMostPoints)) {
          Add("{:.9g} {:.9g}", all[series].x[point], all[series].y[point]);
          if (HasEnds(all[series].style)) {
            Add(" {:.9g} {:.9g}", all[series].lower[point], all[series].upper[point]);
          }
          Add("\n");
        }
        Add("END\n");
      }
    }
  }

  std::size_t Columns() const { return static_cast<std::size_t>(plot_.columns); }

  bool IsLegendBeside(const PlotPanel& panel) const {
    const Legend legend = LegendOf(panel);
    const double room = plot_.width / static_cast<double>(plot_.columns) - kLeft - kRight;
    // Entries in a row are all as wide as the longest.
    const double row =
        TextWidth(panel.title) + static_cast<double>(legend.entries) * legend.longest;
    return legend.entries > kMostAbove || row > room;
  }

  /// Returns the room for the legends on the right of each column [px]. One that stands where a
  /// panel is missing from the last row needs none.
  std::vector<double> LegendWidths() const {
    std::vector<double> widths(Columns(), 0.0);
    const double largest = kLargestLegendShare * plot_.width / plot_.columns;
    for (std::size_t panel = 0; panel < plot_.panels.size(); ++panel) {
      const std::size_t column = panel % Columns();
      const bool is_room_free = panel + 1 == plot_.panels.size() && column + 1 < Columns();
      if (is_room_free || !IsLegendBeside(plot_.panels[panel])) continue;
      widths[column] =
          std::max(widths[column], std::min(LegendOf(plot_.panels[panel]).longest, largest));
    }
    return widths;
  }

  /// Left and right ends of the axes in each column [px]; all are equally wide.
  std::vector<std::pair<double, double>> ColumnFrames() const {
    const std::vector<double> legends = LegendWidths();
    double around = (kLeft + kRight) * plot_.columns;
    for (const double legend : legends) around += legend;
    const double axes = std::max((plot_.width - around) / plot_.columns, 1.0);
    std::vector<std::pair<double, double>> frames;
    double left = 0.0;
    for (const double legend : legends) {
      frames.emplace_back(left + kLeft, left + kLeft + axes);
      left += kLeft + axes + kRight + legend;
    }
    return frames;
  }

  void AddPanels() {
    std::vector<double> rows((plot_.panels.size() + Columns() - 1) / Columns(), 0.0);
    for (std::size_t panel = 0; panel < plot_.panels.size(); ++panel) {
      double& row = rows[panel / Columns()];
      row = std::max(row, plot_.panels[panel].height);
    }
    double shares = 0.0;
    for (const double row : rows) shares += row;
    const double subtitle = plot_.subtitle.empty() ? 0.0 : kSubtitle;
    const double title = (plot_.title.empty() ? kEdge : kTitle) + subtitle;
    const double around = (kLegend + kBelow) * static_cast<double>(rows.size());
    // A page too small for its margins still gets axes one pixel high.
    const double drawable = std::max(plot_.height - title - around - kEdge, shares);
    if (!plot_.title.empty()) {
      Add("set label 1 {} at screen 0.5, screen {:.6f} center font ',15'\n", Quoted(plot_.title),
          FromBottom(kTitle / 2));
    }
    if (!plot_.subtitle.empty()) {
      Add("set label 3 {} at screen 0.5, screen {:.6f} center\n", Quoted(plot_.subtitle),
          FromBottom(title - subtitle / 2));
    }
    const std::vector<std::pair<double, double>> columns = ColumnFrames();
    double top = title;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      top += kLegend;
      const double bottom = top + drawable * rows[row] / shares;
      for (std::size_t column = 0; column < Columns(); ++column) {
        const std::size_t panel = row * Columns() + column;
        if (panel >= plot_.panels.size()) break;
        AddPanel(panel, {columns[column].first, columns[column].second, top, bottom});
      }
      top = bottom + kBelow;
    }
  }

  double FromLeft(double pixels) const { return pixels / plot_.width; }
  double FromBottom(double pixels_from_top) const { return 1.0 - pixels_from_top / plot_.height; }

  /// Range and tics of one axis.
  /// @param name    "x" or "y"
  /// @param values  which of a series it shows
  /// @param margin  on either side of the data, a fraction of the axis
  void AddAxis(const PlotPanel& panel, char name, bool logarithmic,
               std::vector<double> PlotSeries::*values, double margin) {
    if (!logarithmic) {
      Add("unset logscale {0}\nset {0}range [*:*] noextend\nset {0}tics autofreq\n", name);
      return;
    }
    double least = std::numeric_limits<double>::infinity();
    double greatest = 0.0;
    for (const PlotSeries& series : panel.series) {
      const auto [low, high] = std::ranges::minmax(series.*values);
      least = std::min(least, low);
      greatest = std::max(greatest, high);
      if (name == 'x' || !HasEnds(series.style)) continue;
      least = std::min(least, std::ranges::min(series.lower));
      greatest = std::max(greatest, std::ranges::max(series.upper));
    }
    // Half a decade at least, so that there are tics to read.
    constexpr double kLeastSpan = 0.5;
    const double span = std::log10(greatest) - std::log10(least);
    const double around = std::pow(10.0, std::max(margin * span, (kLeastSpan - span) / 2));
    const double from = std::max(least / around, std::numeric_limits<double>::min());
    const double to = std::min(greatest * around, std::numeric_limits<double>::max());
    Add("set logscale {0}\nset {0}range [{1:.9g}:{2:.9g}]\nset {0}tics {3}\n", name, from, to,
        LogTics(from, to));
  }

  /// Above the axes in a row that ends with them, or next to them in a column.
  void AddKey(const PlotPanel& panel, const PanelFrame& frame) {
    if (IsLegendBeside(panel)) {
      Add("set key at screen {:.6f}, screen {:.6f} left top vertical Left reverse samplen 3\n",
          FromLeft(frame.right + kRight / 2), FromBottom(frame.top));
    } else {
      Add("set key at graph 1, screen {:.6f} right center horizontal Right noreverse samplen 2\n",
          FromBottom(frame.top - kLegend / 2));
    }
  }

  /// Labels that would meet stand one under the other, and those that would leave the panel on the
  /// left of their line.
  void AddMarks(const PlotPanel& panel, const PanelFrame& frame) {
    const auto along = [&](double x) { return panel.log_x ? std::log10(x) : x; };
    double least = std::numeric_limits<double>::infinity();
    double greatest = -least;
    for (const PlotSeries& series : panel.series) {
      for (const double x : series.x) {
        least = std::min(least, along(x));
        greatest = std::max(greatest, along(x));
      }
    }
    const double scale = (frame.right - frame.left) / std::max(greatest - least, 1e-300);
    std::vector<double> ends;  // [px] of the last label of each line
    for (const PlotMark& mark : panel.marks) {
      Add("set arrow from first {0:.9g}, graph 0 to first {0:.9g}, graph 1 nohead dt (4,4) lw 1.5 "
          "lc rgb '#444444'\n",
          mark.x);
      if (mark.label.empty()) continue;
      const double at = (along(mark.x) - least) * scale;
      const double width = kCharacter + TextWidth(mark.label);
      const bool is_left = at + width > frame.right - frame.left && at > width;
      const double begin = is_left ? at - width : at;
      const auto is_free = [&](double end) { return end <= begin; };
      const auto line = std::ranges::find_if(ends, is_free) - ends.begin();
      if (static_cast<std::size_t>(line) == ends.size()) ends.emplace_back();
      ends[static_cast<std::size_t>(line)] = begin + width;
      Add("set label {} at first {:.9g}, graph 0.97 {} offset {},{} font ',10'\n",
          Quoted(mark.label), mark.x, is_left ? "right" : "left", is_left ? -0.5 : 0.5, -line);
    }
  }

  void AddPanel(std::size_t index, const PanelFrame& frame) {
    const PlotPanel& panel = plot_.panels[index];
    Add("set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}\n", FromLeft(frame.left),
        FromLeft(frame.right));
    Add("set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n", FromBottom(frame.top),
        FromBottom(frame.bottom));
    Add("set xlabel {}\nset ylabel {}\n", Quoted(panel.x_label), Quoted(panel.y_label));
    constexpr double kMarginX = 0.02;
    constexpr double kMarginY = 0.05;
    AddAxis(panel, 'x', panel.log_x, &PlotSeries::x, kMarginX);
    AddAxis(panel, 'y', panel.log_y, &PlotSeries::y, kMarginY);
    // On a linear axis gnuplot adds the margin itself.
    const double x = panel.log_x ? 0.0 : kMarginX;
    const double y = panel.log_y ? 0.0 : kMarginY;
    Add("set offsets graph {0}, graph {0}, graph {1}, graph {1}\n", x, y);
    if (!panel.title.empty()) {
      Add("set label 2 {} at graph 0, screen {:.6f} left\n", Quoted(panel.title),
          FromBottom(frame.top - kLegend / 2));
    }
    AddKey(panel, frame);
    AddMarks(panel, frame);
    Add("plot ");
    std::size_t look = 0;  // a line without a label goes on with that of the series before
    for (std::size_t series = 0; series < panel.series.size(); ++series) {
      const PlotSeries& curve = panel.series[series];
      if (!curve.label.empty() || curve.style != PlotStyle::kLine) look = series;
      const bool has_ends = curve.style == PlotStyle::kIntervals;
      Add("{}", series == 0 ? "" : ", ");
      if (curve.style == PlotStyle::kBand) {
        Add("$data_{}_{} using 1:3:4 with filledcurves fill transparent solid 0.2 noborder "
            "lc rgb '{}' notitle, ",
            index, series, ColourOf(curve, look));
      }
      Add("$data_{}_{} using {} with {} notitle", index, series, has_ends ? "1:2:3:4" : "1:2",
          StyleCommand(curve, look, false));
      if (curve.label.empty()) continue;
      Add(", keyentry with {} title {}", StyleCommand(curve, look, true), Quoted(curve.label));
    }
    Add("\nunset label\nunset arrow\n");
  }

  const Plot& plot_;
  std::string text_;
};

/// A format that gnuplot writes.
struct Format {
  std::string_view terminal;
  std::string_view end;  ///< last bytes of every whole file of this format, but for line feeds
};

Format FormatOf(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char character) {
    return static_cast<char>(std::tolower(character));
  });
  if (extension == ".svg") return {"svg font 'sans-serif,14'", "</svg>"};
  if (extension == ".png") return {"pngcairo font 'sans,11'", "IEND\xAE\x42\x60\x82"};
  throw InputError(
      fmt::format("cannot draw '{}': its name must end in .svg or .png", path.string()));
}

}  // namespace

void RequirePlotName(const std::filesystem::path& path) { FormatOf(path); }

void WritePlot(const Plot& plot, const std::filesystem::path& path) {
  Validate(plot);
  const Format format = FormatOf(path);
  const std::string drawn = RunGnuplot(Script(plot, format.terminal).Text());
  // A disk that is full ends what gnuplot writes, and not gnuplot.
  const std::size_t size = drawn.find_last_not_of('\n') + 1;
  if (!std::string_view(drawn).substr(0, size).ends_with(format.end)) {
    throw InputError(fmt::format(
        "cannot draw '{}': gnuplot wrote only a part of it; is the disk full?", path.string()));
  }
  WriteFileAtomically(path, drawn);
}

}  // namespace mindahl::io
