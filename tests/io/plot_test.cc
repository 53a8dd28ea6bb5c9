#include "mindahl/io/plot.h"

#include <cstdlib>
#include <set>
#include <stdexcept>

#include "support/prelude.h"
#include "temporary_directory.h"

namespace mindahl::io::plot_test {
namespace {

/// Sets an environment variable for one test.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* const old_value = std::getenv(name)) old_value_ = old_value;
    ::setenv(name, value.c_str(), 1);
  }
  ~ScopedVariable() { old_value_ ? ::setenv(name_, old_value_->c_str(), 1) : ::unsetenv(name_); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> old_value_;
};

Plot OnePanel(PlotSeries series) {
  Plot plot;
  plot.panels.push_back({"displacement δ [µm]", "force T [N]", {std::move(series)}});
  return plot;
}

std::string Svg(const Plot& plot) {
  const TemporaryDirectory directory;
  WritePlot(plot, directory.path() / "plot.svg");
  EXPECT_EQ(directory.FileCount(), 1u);
  return FileContent(directory.path() / "plot.svg");
}

std::size_t Count(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

/// Dots that are drawn, each a line of no length.
std::size_t Dots(const std::string& svg) {
  const std::size_t at = svg.find("class=\"dots");
  return at == std::string::npos ? 0 : Count(svg.substr(at, svg.find('>', at) - at), "h0");
}

TEST(Plot, WritesSvgWithLabelsAsTheyAre) {
  Plot plot = OnePanel({"run_7^2 {a} @b 'c' \"d\" \\n % <b>", {0, 1}, {0, 1}});
  plot.title = "σ = 4·10⁷ N/m, it's";
  const std::string svg = Svg(plot);
  EXPECT_EQ(svg.rfind("<?xml", 0), 0u);
  EXPECT_NE(svg.find("displacement δ [µm]"), std::string::npos);
  EXPECT_NE(svg.find("σ = 4·10⁷ N/m, it&#39;s"), std::string::npos);
  EXPECT_NE(svg.find("run_7^2 {a} @b &#39;c&#39; &quot;d&quot; \\n % &lt;b&gt;"),
            std::string::npos);
}

TEST(Plot, WritesPngOfTheSizeAsked) {
  if (std::system("rsvg-convert --version >/dev/null 2>&1") != 0) {
    GTEST_SKIP() << "rsvg-convert is not installed";
  }
  const TemporaryDirectory directory;
  Plot plot = OnePanel({"", {0, 1}, {0, 1}});
  plot.width = 320;
  plot.height = 240;
  WritePlot(plot, directory.path() / "plot.PNG");
  const std::string png = FileContent(directory.path() / "plot.PNG");
  ASSERT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1A\n");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\1\x40\0\0\0\xF0", 8));
}

TEST(Plot, DrawsEveryPanel) {
  Plot plot = OnePanel({"", {0, 1}, {0, 1}});
  plot.panels.push_back({"time [s]", "residual [N]", {{"", {0, 1}, {0, 1}}}, 0.5});
  const std::string svg = Svg(plot);
  EXPECT_EQ(Count(svg, "residual [N]"), 1u);
  EXPECT_EQ(Count(svg, "force T [N]"), 1u);
}

TEST(Plot, DrawsPointsOnlyForThatStyle) {
  EXPECT_EQ(Dots(Svg(OnePanel({"", {0, 1, 2}, {0, 1, 0}, PlotStyle::kPoints}))), 3u);
  EXPECT_EQ(Dots(Svg(OnePanel({"", {0, 1, 2}, {0, 1, 0}, PlotStyle::kLine}))), 0u);
}

/// Returns the anchor of a text in its drawing, from the left and the top [px].
std::pair<double, double> PlaceOf(const std::string& svg, const std::string& text) {
  const std::size_t at = svg.rfind("<text x=\"", svg.find(">" + text + "<"));
  if (at == std::string::npos) throw std::runtime_error("no " + text);
  return {std::stod(svg.substr(at + 9)), std::stod(svg.substr(svg.find("y=\"", at) + 3))};
}

TEST(Plot, PutsLabelsOfCloseMarksOneUnderTheOther) {
  Plot plot = OnePanel({"", {0, 1000}, {1, 2}, PlotStyle::kLine});
  plot.panels[0].marks = {
      {100, "a step, 100"}, {110, "a step, 110"}, {120, "a step, 120"}, {700, "a step, 700"}};
  const std::string svg = Svg(plot);
  constexpr double kLine = 13;  // [px], the height of letters
  EXPECT_GT(PlaceOf(svg, "a step, 110").second, PlaceOf(svg, "a step, 100").second + kLine);
  EXPECT_GT(PlaceOf(svg, "a step, 120").second, PlaceOf(svg, "a step, 110").second + kLine);
  EXPECT_EQ(PlaceOf(svg, "a step, 700").second, PlaceOf(svg, "a step, 100").second);
}

TEST(Plot, PutsTheLabelOfALastMarkOnTheLeftOfIt) {
  Plot plot = OnePanel({"", {0, 1000}, {1, 2}, PlotStyle::kLine});
  plot.panels[0].marks = {{990, "a step, 990"}};
  const std::string svg = Svg(plot);
  const std::size_t at = svg.find("a step, 990");
  ASSERT_NE(at, std::string::npos);
  const std::size_t anchor = svg.rfind("text-anchor=", at);
  EXPECT_EQ(svg.substr(anchor, 17), "text-anchor=\"end\"");
}

TEST(Plot, DrawsIntervalsThatReachToTheirEnds) {
  // A linear axis takes the ends in: 9 is beyond every point.
  Plot plot = OnePanel({"", {0, 1, 2}, {1, 2, 1}, PlotStyle::kIntervals});
  EXPECT_THROW(Svg(plot), InvalidArgument) << "no ends";
  plot.panels.front().series.front().lower = {0, 1, 0};
  plot.panels.front().series.front().upper = {2, 9, 2};
  EXPECT_EQ(Count(Svg(plot), ">8</text>"), 1u);
  plot.panels.front().series.front().style = PlotStyle::kMarkers;
  EXPECT_EQ(Count(Svg(plot), ">8</text>"), 0u);
}

/// Returns the path of the first element of a class.
std::string PathOf(const std::string& svg, const std::string& name) {
  const std::size_t begin = svg.find(" d=\"", svg.find("class=\"" + name)) + 4;
  return svg.substr(begin, svg.find('"', begin) - begin);
}

TEST(Plot, HasNoTicBesideItsAxes) {
  const std::string svg = Svg(OnePanel({"", {0.37, 1.81}, {-2.3, 4.7}}));
  const std::string axis = PathOf(svg, "axis");  // "M<left> <top>V<bottom>H<right>"
  const double left = std::stod(axis.substr(1));
  const double bottom = std::stod(axis.substr(axis.find('V') + 1));
  const std::string grid = PathOf(svg, "grid");  // "M<x> <top>V<bottom>" or "M<left> <y>H<right>"
  for (std::size_t at = 0; at != std::string::npos; at = grid.find('M', at + 1)) {
    EXPECT_GE(std::stod(grid.substr(at + 1)), left);
    EXPECT_LE(std::stod(grid.substr(grid.find(' ', at) + 1)), bottom);
  }
}

TEST(Plot, LeavesRoomForBothHalvesOfTheOuterBars) {
  const std::string svg = Svg(OnePanel({"", {1, 2, 3}, {1, 2, 1}, PlotStyle::kBars}));
  const std::string axis = PathOf(svg, "axis");
  const double left = std::stod(axis.substr(1));
  const double right = std::stod(axis.substr(axis.find('H') + 1));
  const std::string bars = PathOf(svg, "bars");
  EXPECT_GT(std::stod(bars.substr(1)), left);
  EXPECT_LT(std::stod(bars.substr(bars.rfind('H') + 1)), right);
}

TEST(Plot, LabelsLogarithmicAxesWithPowersOfTen) {
  Plot plot = OnePanel({"", {1e-6, 1e-3}, {2e-19, 5e-11}});
  plot.panels.front().log_x = true;
  plot.panels.front().log_y = true;
  const std::string svg = Svg(plot);
  for (const char* label : {">10⁻⁶<", ">10⁻⁵<", ">10⁻⁴<", ">10⁻³<", ">10⁻¹⁸<", ">10⁻¹²<"}) {
    EXPECT_EQ(Count(svg, label), 1u) << label;
  }
}

TEST(Plot, LabelsAtLeastTwoTicsOfAShortLogarithmicAxis) {
  const auto svg = [](std::vector<double> y) {
    Plot plot = OnePanel({"", std::vector<double>(y.size(), 0.0), y});
    plot.panels.front().log_y = true;
    return Svg(plot);
  };
  const std::string within_a_decade = svg({0.21, 0.59});
  EXPECT_EQ(Count(within_a_decade, ">0.3<"), 1u);
  EXPECT_EQ(Count(within_a_decade, ">0.5<"), 1u);
  const std::string single = svg({7e-9});
  EXPECT_EQ(Count(single, ">0.6·10⁻⁸<"), 1u);
  EXPECT_EQ(Count(single, ">0.8·10⁻⁸<"), 1u);
}

TEST(Plot, DrawsLogarithmicAxesOfManyDecades) {
  Plot plot = OnePanel({"", {1e-305, 1.0, 1e305}, {1, 2, 3}, PlotStyle::kPoints});
  plot.panels.front().log_x = true;
  const std::string svg = Svg(plot);
  EXPECT_EQ(Dots(svg), 3u);
  EXPECT_EQ(Count(svg, ">10³⁰⁰<"), 1u);
  EXPECT_LE(Count(svg, ">10"), 8u);
}

TEST(Plot, GoesBackToLinearAxesInTheNextPanel) {
  Plot plot = OnePanel({"", {1, 2}, {1e-6, 1}});
  plot.panels.front().log_y = true;
  plot.panels.push_back({"", "", {{"", {-1, 1}, {-100, 100}, PlotStyle::kPoints}}});
  const std::string svg = Svg(plot);
  EXPECT_EQ(Dots(svg), 2u);
  EXPECT_EQ(Count(svg, ">−100<"), 1u);
}

TEST(Plot, DistinguishesTwelveSeries) {
  Plot plot;
  plot.panels.push_back({"", "", {}});
  for (int series = 0; series < 12; ++series) {
    plot.panels.front().series.push_back(
        {std::to_string(series), {0}, {1.0 * series}, PlotStyle::kMarkers});
  }
  const std::string svg = Svg(plot);
  std::set<std::string> looks;  // colour, filling and shape; the places differ anyway
  for (std::size_t at = svg.find("class=\"marker"); at != std::string::npos;
       at = svg.find("class=\"marker", at + 1)) {
    looks.insert(svg.substr(at, svg.find('"', at + 7) - at));
  }
  EXPECT_EQ(looks.size(), 12u);
  EXPECT_EQ(Count(svg, "<circle"), 4u) << "shapes too: two of twelve and their legend are circles";
}

TEST(Plot, PutsPanelsInColumnsRowByRow) {
  Plot plot;
  plot.columns = 2;
  for (const char* title : {"first", "second", "third"}) {
    plot.panels.push_back({"", "", {{"", {0, 1}, {0, 1}}}});
    plot.panels.back().title = title;
  }
  const std::string svg = Svg(plot);
  constexpr double kTenthOfPixel = 0.1;
  const auto [first_x, first_y] = PlaceOf(svg, "first");
  const auto [second_x, second_y] = PlaceOf(svg, "second");
  const auto [third_x, third_y] = PlaceOf(svg, "third");
  EXPECT_NEAR(second_x - first_x, plot.width / 2.0, kTenthOfPixel);
  EXPECT_EQ(second_y, first_y);
  EXPECT_EQ(third_x, first_x);
  EXPECT_GT(third_y, plot.height / 2.0);
}

TEST(Plot, PutsALongLegendBesideItsPanel) {
  Plot plot = OnePanel({"curve 1", {0, 1}, {0, 1}});
  const auto place = [&](const std::string& label) { return PlaceOf(Svg(plot), label); };
  for (const char* label : {"curve 2", "curve 3", "curve 4"}) {
    plot.panels.front().series.push_back({label, {0, 1}, {0, 1}});
  }
  EXPECT_EQ(place("curve 1").second, place("curve 4").second);
  plot.panels.front().series.push_back({"curve 5", {0, 1}, {0, 1}});
  EXPECT_EQ(place("curve 1").first, place("curve 5").first);
  EXPECT_LT(place("curve 1").second, place("curve 5").second);
  // Where a panel is missing from the last row, the legend takes its place.
  plot.columns = 2;
  EXPECT_GT(place("curve 1").first, plot.width / 2.0);
}

TEST(Plot, DrawsSinglePoint) {
  EXPECT_EQ(Dots(Svg(OnePanel({"", {3}, {3}, PlotStyle::kPoints}))), 1u);
}

TEST(Plot, DrawsEveryPointUpToTheLimit) {
  PlotSeries series{"", {}, {}, PlotStyle::kPoints};
  for (int point = 0; point < 20000; ++point) {
    series.x.push_back(point);
    series.y.push_back(point % 7);
  }
  EXPECT_EQ(Dots(Svg(OnePanel(series))), 20000u);
}

TEST(Plot, ThinsLongSeriesAndKeepsItsPeak) {
  PlotSeries series{"", {}, {}, PlotStyle::kPoints};
  for (int point = 0; point < 100000; ++point) {
    series.x.push_back(point);
    series.y.push_back(0.001 * (point % 11));
  }
  series.y[54321] = 1000;
  const std::string svg = Svg(OnePanel(series));
  const std::size_t drawn = Dots(svg);
  EXPECT_LE(drawn, 20000u);
  EXPECT_GE(drawn, 500u) << "as many as there are cells in a row";
  double highest = 1e9;  // [px] from the top
  const std::size_t dots = svg.find("class=\"dots");
  for (std::size_t at = svg.find("h0", dots); at != std::string::npos;
       at = svg.find("h0", at + 1)) {
    highest = std::min(highest, std::stod(svg.substr(svg.rfind(' ', at))));
  }
  EXPECT_LT(highest, 100) << "the peak is lost";
}

TEST(Plot, RefusesOtherExtensions) {
  const Plot plot = OnePanel({"", {0, 1}, {0, 1}});
  EXPECT_EQ(MessageOf<InputError>([&] { WritePlot(plot, "dir/loop.pdf"); }),
            "cannot draw 'dir/loop.pdf': its name must end in .svg or .png");
}

/// Puts a program of that text alone on PATH, by the name of the one that makes PNG.
class FakeConverter {
 public:
  explicit FakeConverter(const std::string& text) {
    std::filesystem::permissions(directory_.Write("rsvg-convert", "#!/bin/sh\n" + text),
                                 std::filesystem::perms::owner_all);
  }

 private:
  TemporaryDirectory directory_;
  ScopedVariable path_{"PATH", directory_.path().string()};
};

TEST(Plot, SaysWhatToInstallForPng) {
  const TemporaryDirectory directory;
  const ScopedVariable path("PATH", directory.path().string());
  const Plot plot = OnePanel({"", {0, 1}, {0, 1}});
  EXPECT_EQ(MessageOf<InputError>([&] { WritePlot(plot, directory.path() / "plot.png"); }),
            "pictures in PNG need rsvg-convert, which is not on PATH: install it (Debian: "
            "librsvg2-bin), or give a name that ends in .svg");
  EXPECT_EQ(directory.FileCount(), 0u);
}

TEST(Plot, QuotesTheConverterWhenItFails) {
  const FakeConverter converter("echo 'out of ink' >&2\nexit 3\n");
  const TemporaryDirectory directory;
  const Plot plot = OnePanel({"", {0, 1}, {0, 1}});
  const std::string name = (directory.path() / "plot.png").string();
  EXPECT_EQ(MessageOf<InputError>([&] { WritePlot(plot, name); }),
            "cannot draw '" + name + "': rsvg-convert failed: out of ink");
  EXPECT_EQ(directory.FileCount(), 0u);
}

TEST(Plot, RefusesAPartOfAPicture) {
  const FakeConverter converter("echo PNG > \"${2#--output=}\"\n");
  const TemporaryDirectory directory;
  const std::string name = (directory.path() / "loop.png").string();
  const Plot plot = OnePanel({"", {0, 1}, {0, 1}});
  EXPECT_EQ(MessageOf<InputError>([&] { WritePlot(plot, name); }),
            "cannot draw '" + name + "': rsvg-convert wrote only a part of it; is the disk full?");
  EXPECT_FALSE(std::filesystem::exists(name));
}

TEST(Plot, LeavesNoScratchFilesBehind) {
  const FakeConverter converter("exit 3\n");
  const TemporaryDirectory directory;
  const ScopedVariable scratch("TMPDIR", directory.path().string());
  const Plot plot = OnePanel({"", {0, 1}, {0, 1}});
  EXPECT_THROW(WritePlot(plot, directory.path() / "plot.png"), InputError);
  EXPECT_EQ(directory.FileCount(), 0u);
}

TEST(Plot, RefusesWhatCannotBeDrawn) {
  const auto refusal = [](const Plot& plot) {
    return MessageOf<InvalidArgument>([&] { WritePlot(plot, "/nowhere/plot.svg"); });
  };
  EXPECT_EQ(refusal(Plot{}), "number of panels = 0 is invalid: must be >= 1");
  EXPECT_EQ(refusal(OnePanel({"fit", {0, 1}, {0}})),
            "x of 'fit' of panel 1 has 2 values and y of 'fit' of panel 1 has 1: must be equal");
  EXPECT_EQ(refusal(OnePanel({"fit", {}, {}})), "'fit' of panel 1 has no points: must have one");
  EXPECT_EQ(refusal(OnePanel({"fit", {0}, {std::nan("")}})),
            "y of 'fit' of panel 1 = nan is invalid: must be finite");
  Plot logarithmic = OnePanel({"fit", {0, 1}, {1, 1}});
  logarithmic.panels.front().log_y = true;
  logarithmic.panels.front().log_x = true;
  EXPECT_EQ(refusal(logarithmic),
            "x of 'fit' of panel 1 = 0 is invalid: must be > 0 on a logarithmic axis");
  logarithmic.panels.front().series.front() = {"fit", {1, 1}, {1, -2}};
  EXPECT_EQ(refusal(logarithmic),
            "y of 'fit' of panel 1 = -2 is invalid: must be > 0 on a logarithmic axis");
  Plot no_columns = OnePanel({"fit", {0}, {0}});
  no_columns.columns = 0;
  EXPECT_EQ(refusal(no_columns), "number of plot columns = 0 is invalid: must be finite and > 0");
  Plot empty = OnePanel({"fit", {0}, {0}});
  empty.panels.front().series.clear();
  EXPECT_EQ(refusal(empty), "panel 1 has no series: must have one");
}

}  // namespace
}  // namespace mindahl::io::plot_test
