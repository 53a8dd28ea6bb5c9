#include "mindahl/io/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <string_view>
#include <utility>

#include "io/gnuplot.h"
#include "mindahl/core/error.h"
#include "mindahl/io/atomic_file.h"

namespace mindahl {
namespace {

constexpr std::size_t kMostPoints = 20'000;
constexpr std::size_t kExtremesPerRun = 4;  // least and greatest x and y

// Of unlike lightness, so that they are told apart in grey and by colour-blind readers too.
constexpr std::array<std::string_view, 6> kColours = {"#4878a8", "#d1495b", "#3a9d6e",
                                                      "#8d6bb1", "#e09f3e", "#5f6b76"};

// Margins [px]
constexpr double kLeft = 95;
constexpr double kRight = 25;
constexpr double kTitle = 40;
constexpr double kLegend = 30;  // above each panel
constexpr double kBelow = 58;   // tics and x label under each panel
constexpr double kEdge = 8;

void Validate(const Plot& plot) {
  if (plot.panels.empty()) throw InvalidArgument("number of panels = 0 is invalid: must be >= 1");
  RequirePositive("plot width [px]", plot.width);
  RequirePositive("plot height [px]", plot.height);
  for (std::size_t panel = 0; panel < plot.panels.size(); ++panel) {
    const std::string where = fmt::format("panel {}", panel + 1);
    RequirePositive("height of " + where, plot.panels[panel].height);
    if (plot.panels[panel].series.empty()) {
      throw InvalidArgument(where + " has no series: must have one");
    }
    for (const PlotSeries& series : plot.panels[panel].series) {
      const std::string name = fmt::format("'{}' of {}", series.label, where);
      RequireSameSize("x of " + name, series.x.size(), "y of " + name, series.y.size());
      if (series.x.empty()) throw InvalidArgument(name + " has no points: must have one");
      for (const double x : series.x) RequireFinite("x of " + name, x);
      for (const double y : series.y) RequireFinite("y of " + name, y);
    }
  }
}

/// In single quotes gnuplot interprets nothing but the quote itself; the terminal is told to leave
/// the text alone too. A string ends with its line.
std::string Quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char character : text) {
    if (character == '\'') quoted += '\'';
    quoted += static_cast<unsigned char>(character) < 0x20 ? ' ' : character;
  }
  return quoted + "'";
}

/// Indices of the points to draw.
std::vector<std::size_t> Thinned(const PlotSeries& series) {
  const std::size_t size = series.x.size();
  std::vector<std::size_t> kept;
  if (size <= kMostPoints) {
    for (std::size_t point = 0; point < size; ++point) kept.push_back(point);
    return kept;
  }
  constexpr std::size_t kRuns = kMostPoints / kExtremesPerRun;
  for (std::size_t run = 0; run < kRuns; ++run) {
    const auto begin = static_cast<std::ptrdiff_t>(run * size / kRuns);
    const auto end = static_cast<std::ptrdiff_t>((run + 1) * size / kRuns);
    std::vector<std::size_t> extremes;
    for (const std::vector<double>* values : {&series.x, &series.y}) {
      const auto [least, greatest] =
          std::minmax_element(values->begin() + begin, values->begin() + end);
      extremes.push_back(static_cast<std::size_t>(least - values->begin()));
      extremes.push_back(static_cast<std::size_t>(greatest - values->begin()));
    }
    std::ranges::sort(extremes);
    const auto repeated = std::ranges::unique(extremes);
    extremes.erase(repeated.begin(), repeated.end());
    kept.insert(kept.end(), extremes.begin(), extremes.end());
  }
  return kept;
}

std::string_view StyleCommand(PlotStyle style) {
  switch (style) {
    case PlotStyle::kPoints:
      return "points pt 7 ps 0.35";
    case PlotStyle::kLineAndPoints:
      return "linespoints lw 1.5 pt 7 ps 0.35";
    case PlotStyle::kLine:
      break;
  }
  return "lines lw 2";
}

std::string_view LegendStyleCommand(PlotStyle style) {
  switch (style) {
    case PlotStyle::kPoints:
      return "points pt 7 ps 0.9";
    case PlotStyle::kLineAndPoints:
      return "linespoints lw 1.5 pt 7 ps 0.7";
    case PlotStyle::kLine:
      break;
  }
  return "lines lw 2";
}

class Script {
 public:
  Script(const Plot& plot, std::string_view terminal) : plot_(plot) {
    Add("set encoding utf8\n");
    Add("set terminal {} size {},{} noenhanced background '#ffffff'\n", terminal, plot.width,
        plot.height);
    Add("set border 3 lc rgb '#444444'\nset tics nomirror scale 0.6\n");
    Add("set grid back lc rgb '#e4e4e4' lw 1 lt 1\n");
    Add("set xlabel offset 0,0.3\n");
    Add("set xrange [*:*] noextend\nset yrange [*:*] noextend\n");
    Add("set offsets graph 0.02, graph 0.02, graph 0.05, graph 0.05\n");
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
        for (const std::size_t point : Thinned(all[series])) {
          Add("{:.9g} {:.9g}\n", all[series].x[point], all[series].y[point]);
        }
        Add("END\n");
      }
    }
  }

  void AddPanels() {
    double shares = 0.0;
    for (const PlotPanel& panel : plot_.panels) shares += panel.height;
    const double title = plot_.title.empty() ? kEdge : kTitle;
    const double around = (kLegend + kBelow) * static_cast<double>(plot_.panels.size());
    // A page too small for its margins still gets axes one pixel high.
    const double drawable = std::max(plot_.height - title - around - kEdge, shares);
    if (!plot_.title.empty()) {
      Add("set label 1 {} at screen 0.5, screen {:.6f} center font ',15'\n", Quoted(plot_.title),
          1.0 - kTitle / 2 / plot_.height);
    }
    double top = title;
    for (std::size_t panel = 0; panel < plot_.panels.size(); ++panel) {
      top += kLegend;
      const double bottom = top + drawable * plot_.panels[panel].height / shares;
      AddPanel(panel, top, bottom);
      top = bottom + kBelow;
    }
  }

  /// @param top, bottom  of its axes, from the top of the page [px]
  void AddPanel(std::size_t index, double top, double bottom) {
    const PlotPanel& panel = plot_.panels[index];
    Add("set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}\n", kLeft / plot_.width,
        1.0 - kRight / plot_.width);
    Add("set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n", 1.0 - top / plot_.height,
        1.0 - bottom / plot_.height);
    Add("set xlabel {}\nset ylabel {}\n", Quoted(panel.x_label), Quoted(panel.y_label));
    Add("set key at graph 1, screen {:.6f} right center horizontal samplen 2\n",
        1.0 - (top - kLegend / 2) / plot_.height);
    Add("plot ");
    for (std::size_t series = 0; series < panel.series.size(); ++series) {
      const PlotSeries& curve = panel.series[series];
      const std::string_view colour = kColours[series % kColours.size()];
      Add("{}$data_{}_{} using 1:2 with {} lc rgb '{}' notitle", series == 0 ? "" : ", ", index,
          series, StyleCommand(curve.style), colour);
      if (curve.label.empty()) continue;
      // An entry of its own: the dots of a dense series are too small to tell in a legend.
      Add(", keyentry with {} lc rgb '{}' title {}", LegendStyleCommand(curve.style), colour,
          Quoted(curve.label));
    }
    Add("\nunset label 1\n");
  }

  const Plot& plot_;
  std::string text_;
};

std::string_view Terminal(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char character) {
    return static_cast<char>(std::tolower(character));
  });
  if (extension == ".svg") return "svg font 'sans-serif,14'";
  if (extension == ".png") return "pngcairo font 'sans,11'";
  throw InputError(
      fmt::format("cannot draw '{}': its name must end in .svg or .png", path.string()));
}

}  // namespace

void WritePlot(const Plot& plot, const std::filesystem::path& path) {
  Validate(plot);
  const std::string_view terminal = Terminal(path);
  WriteFileAtomically(path, RunGnuplot(Script(plot, terminal).Text()));
}

}  // namespace mindahl
