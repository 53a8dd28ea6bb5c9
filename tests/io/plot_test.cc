#include "mindahl/io/plot.h"

#include <cstdlib>
#include <stdexcept>

#include "io/drawing.h"
#include "support/prelude.h"
#include "support/text.h"
#include "temporary_directory.h"

namespace mindahl::io::plot_test {
namespace {

Plot OnePanel(PlotSeries series) {
  Plot plot;
  plot.panels.push_back({"displacement δ [µm]", "force T [N]", {std::move(series)}});
  return plot;
}

PlotSeries Wave(std::size_t points, PlotStyle style) {
  PlotSeries series{"", {}, {}, style};
  for (std::size_t i = 0; i < points; ++i) {
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(std::sin(0.01 * static_cast<double>(i)));
  }
  return series;
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

/// Returns the path of the first element of a class.
std::string PathOf(const std::string& svg, const std::string& name) {
  const std::size_t at = svg.find("class=\"" + name);
  if (at == std::string::npos) return "";
  const std::size_t begin = svg.find(" d=\"", at) + 4;
  return svg.substr(begin, svg.find('"', begin) - begin);
}

/// Returns the numbers that follow a letter or a blank of a path.
std::vector<double> NumbersAfter(const std::string& path, char sign) {
  std::vector<double> numbers;
  for (std::size_t at = path.find(sign); at != std::string::npos; at = path.find(sign, at + 1)) {
    numbers.push_back(std::stod(path.substr(at + 1)));
  }
  return numbers;
}

/// Dots that are drawn, each a line of no length.
std::size_t Dots(const std::string& svg) { return Count(PathOf(svg, "dots"), "h0"); }

/// Returns the anchor of a text in its drawing, from the left and the top [px].
std::pair<double, double> PlaceOf(const std::string& svg, const std::string& text) {
  const std::size_t at = svg.rfind("<text x=\"", svg.find(">" + text + "<"));
  if (at == std::string::npos) throw std::runtime_error("no " + text);
  return {std::stod(svg.substr(at + 9)), std::stod(svg.substr(svg.find("y=\"", at) + 3))};
}

TEST(HtmlText, EscapesMarkupKeepsUtf8AndDropsInvalidBytes) {
  EXPECT_EQ(HtmlText("<script>alert('a & \"b\"')</script>"),
            "&lt;script&gt;alert(&#39;a &amp; &quot;b&quot;&#39;)&lt;/script&gt;");
  EXPECT_EQ(HtmlText("σ = 4·10⁷ 𝛼"), "σ = 4·10⁷ 𝛼");
  EXPECT_EQ(HtmlText("a\xFF\x62"), "ab");
  EXPECT_EQ(HtmlText("a\xC3"), "a");
  EXPECT_EQ(HtmlText("\xED\xA0\x80"), "");  // half of a surrogate pair
  EXPECT_EQ(HtmlText(std::string("\x01\n", 2)), "\uFFFD\n");
}

TEST(Plot, WritesSvgWithLabelsAsTheyAre) {
  Plot plot = OnePanel({"run_7^2 {a} @b 'c' \"d\" \\n % <b>", {0, 1}, {0, 1}});
  plot.title = "σ = 4·10⁷ N/m, it's";
  plot.panels.front().title = "a < b";
  plot.panels.push_back({"time [s]", "residual [N]", {{"", {0, 1}, {0, 1}}}, 0.5});
  const std::string svg = Svg(plot);
  EXPECT_EQ(svg.rfind("<?xml", 0), 0u);
  for (const char* label :
       {"displacement δ [µm]", "σ = 4·10⁷ N/m, it&#39;s", "a &lt; b", "residual [N]", "force T [N]",
        "run_7^2 {a} @b &#39;c&#39; &quot;d&quot; \\n % &lt;b&gt;"}) {
    EXPECT_EQ(Count(svg, std::string(">") + label + "<"), 1u) << label;
  }
}

TEST(Plot, DrawsEveryStyle) {
  const std::vector<std::pair<PlotStyle, std::vector<std::string>>> drawn = {
      {PlotStyle::kLine, {"line"}},
      {PlotStyle::kPoints, {"dots"}},
      {PlotStyle::kLineAndPoints, {"line", "marker"}},
      {PlotStyle::kArea, {"area"}},
  };
  for (const auto& [style, kinds] : drawn) {
    Plot plot = OnePanel(Wave(20, style));
    const auto has = [&](const std::string& svg, const char* kind) {
      return Count(svg, fmt::format("class=\"{} s0\"", kind));
    };
    const std::string svg = Svg(plot);
    plot.panels.front().series.front().label = "wave";
    const std::string with_symbol = Svg(plot);
    for (const char* kind : {"line", "dots", "marker", "area"}) {
      EXPECT_EQ(has(svg, kind), std::ranges::count(kinds, kind)) << kind;
      EXPECT_EQ(has(with_symbol, kind), 2 * std::ranges::count(kinds, kind)) << kind;
    }
  }
}

TEST(Plot, DrawsAConstantAndAPointAlone) {
  for (const double value : {0.0, 5.0, -1e-9, 1e12}) {
    const std::string svg = Svg(OnePanel({"", {value}, {value}, PlotStyle::kLine}));
    EXPECT_THAT(svg, HasSubstr("h0\"/>"));
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    EXPECT_THAT(svg, Not(HasSubstr("inf")));
  }
}

TEST(Plot, PlacesPointsWhereTheirTicsSay) {
  // The point at 5 lies midway between the tics at 0 and 10, by the pixels of the drawing.
  const std::string svg = Svg(OnePanel({"", {0, 5, 10}, {-2, 5, 9}, PlotStyle::kPoints}));
  const std::vector<double> places = NumbersAfter(PathOf(svg, "dots"), 'M');
  ASSERT_EQ(places.size(), 3U);
  constexpr double kTenthOfPixel = 0.1;
  EXPECT_NEAR(places[1], (places[0] + places[2]) / 2, kTenthOfPixel);
  EXPECT_NEAR(PlaceOf(svg, "10").first, places[2], kTenthOfPixel);
  // No tic is outside the axes, "M<left> <top>V<bottom>H<right>".
  const std::string axis = PathOf(svg, "axis");
  const std::string grid = PathOf(svg, "grid");
  EXPECT_THAT(NumbersAfter(grid, 'M'), Each(::testing::Ge(NumbersAfter(axis, 'M')[0])));
  EXPECT_THAT(NumbersAfter(grid, ' '), Each(::testing::Le(NumbersAfter(axis, 'V')[0])));
}

TEST(Plot, PutsLabelsOfMarksWhereTheyHaveRoom) {
  Plot plot = OnePanel({"", {0, 1000}, {1, 2}});
  plot.panels[0].marks = {
      {100, "step <100>"}, {110, "step, 110"}, {700, "step, 700"}, {990, "the last"}};
  const std::string svg = Svg(plot);
  constexpr double kLine = 13;  // [px], the height of letters
  EXPECT_GT(PlaceOf(svg, "step, 110").second, PlaceOf(svg, "step &lt;100&gt;").second + kLine);
  EXPECT_EQ(Count(svg, "class=\"mark\""), 4u);
  EXPECT_THAT(svg, HasSubstr("text-anchor=\"end\">the last")) << "on the left of its line";
}

TEST(Plot, LabelsLogarithmicAxes) {
  const auto svg = [](std::vector<double> y) {
    Plot plot = OnePanel({"", std::vector<double>(y.size(), 0.0), std::move(y)});
    plot.panels.front().log_y = true;
    plot.panels.push_back({"", "", {{"", {-1, 1}, {-100, 100}}}});
    return Svg(plot);
  };
  const std::vector<std::pair<std::vector<double>, std::vector<std::string>>> labels = {
      {{1e-6, 1e-3}, {"1e-06", "1e-05", "0.0001", "0.001"}},
      {{2e-19, 5e-11}, {"1e-18", "1e-12"}},
      {{1.0, 50.0}, {"1", "2", "5", "10", "20", "50"}},
      {{0.21, 0.59}, {"0.3", "0.5"}},
      {{7e-9}, {"6e-09", "8e-09"}},
      {{1e-305, 1e305}, {"1"}},
      {{1, 2}, {"−100"}},  // of the linear axis of the next panel
  };
  for (const auto& [values, expected] : labels) {
    const std::string drawn = svg(values);
    for (const std::string& label : expected) {
      EXPECT_GE(Count(drawn, ">" + label + "<"), 1u) << label;
    }
    EXPECT_LE(Count(drawn, ">10"), 12u);
  }
}

TEST(Plot, DistinguishesFourteenSeriesAndShadesByPlace) {
  Plot plot;
  plot.panels.push_back({"", "", {}});
  for (int series = 0; series < 14; ++series) {
    plot.panels.front().series.push_back(
        {std::to_string(series), {0}, {1.0 * series}, PlotStyle::kLineAndPoints});
  }
  EXPECT_THAT(testing::Matches(Svg(plot), "class=\"line([^\"]*)\""), SizeIs(14))
      << "colours and dashes";
  EXPECT_THAT(testing::Matches(Svg(plot), "class=\"line s([0-9])\""), SizeIs(7))
      << "the seven curves of tradeoff have a colour each";

  PlotPanel shades{"", "", {{"line", {0, 1}, {0, 1}}, {"", {0, 1}, {0, 1}}}};
  for (const double shade : {0.0, 0.5, 1.0}) {
    shades.series.push_back({"", {0, 1}, {0, 1}});
    shades.series.back().shade = shade;
  }
  const std::string drawn = DrawPanel(shades, 560, 100).elements;
  EXPECT_EQ(Count(drawn, "line s0\""), 3u) << "one without a label continues the one before";
  for (const char* colour : {"h0", "h4", "h7"}) {
    EXPECT_EQ(Count(drawn, fmt::format("line {}\"", colour)), 1u);
  }
}

TEST(Plot, PutsALongLegendInFurtherRows) {
  Plot plot = OnePanel({"curve 1", {0, 1}, {0, 1}});
  const auto rows = [&] {  // of groups from the top, that of the axes among them
    return testing::Matches(Svg(plot), "<g transform=\"[^,]*,([^)]*)\\)").size();
  };
  const std::size_t with_one = rows();
  for (int k = 2; k < 20; ++k) {
    plot.panels.front().series.push_back({fmt::format("curve {}", k), {0, 1}, {0, 1}});
  }
  EXPECT_EQ(rows(), with_one + 2);
}

TEST(Plot, ThinsLongSeriesAndKeepsTheirPeaks) {
  EXPECT_GT(Dots(Svg(OnePanel(Wave(20'000, PlotStyle::kPoints)))), 19'000u) << "but repeated ones";
  for (const auto& [style, kind] : {std::pair{PlotStyle::kLine, "line"},
                                    {PlotStyle::kPoints, "dots"},
                                    {PlotStyle::kArea, "area"}}) {
    PlotSeries series = Wave(300'000, style);
    series.y[31'415] = 50;
    series.y[27'182] = -70;
    const std::string drawn = DrawPanel(OnePanel(series).panels.front(), 560, 6000).elements;
    EXPECT_LT(drawn.size(), 250'000u) << "6000 points of some 15 bytes";
    // Under a margin of 5 % the least and greatest are 280/1.1 px apart.
    const std::vector<double> heights = NumbersAfter(PathOf(drawn, kind), ' ');
    const auto [highest, lowest] = std::ranges::minmax(heights);
    EXPECT_NEAR(lowest - highest, 280 / 1.1, 0.2);
  }
}

TEST(Plot, WritesPng) {
  if (std::system("rsvg-convert --version >/dev/null 2>&1") != 0) {
    GTEST_SKIP() << "rsvg-convert is not installed";
  }
  const TemporaryDirectory directory;
  Plot plot = OnePanel({"", {0, 1}, {0, 1}});
  WritePlot(plot, directory.path() / "plot.PNG");
  const std::string png = FileContent(directory.path() / "plot.PNG");
  ASSERT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1A\n");
  EXPECT_EQ(png.substr(16, 4), std::string("\0\0\3\x08", 4)) << "776 px wide";
}

TEST(Plot, SaysWhyThereIsNoPng) {
  for (const std::string program : {"", "echo 'out of ink' >&2\nexit 3\n", "echo PNG\n"}) {
    const TemporaryDirectory programs;
    const TemporaryDirectory directory;
    if (!program.empty()) {
      std::filesystem::permissions(programs.Write("rsvg-convert", "#!/bin/sh\n" + program),
                                   std::filesystem::perms::owner_all);
    }
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", programs.path().c_str(), 1);
    ::setenv("TMPDIR", directory.path().c_str(), 1);
    const std::string name = (directory.path() / "plot.png").string();
    EXPECT_THAT(MessageOf<InputError>([&] {
                  WritePlot(OnePanel({"", {0}, {0}}), name);
                }),
                StartsWith("cannot draw '" + name + "': rsvg-convert, which makes PNG"));
    ::setenv("PATH", path.c_str(), 1);
    ::unsetenv("TMPDIR");
    EXPECT_EQ(directory.FileCount(), 0u) << "scratch files stay";
  }
}

TEST(Plot, RefusesWhatCannotBeDrawn) {
  EXPECT_EQ(MessageOf<InputError>([] {
              WritePlot(OnePanel({"", {0}, {0}}), "dir/loop.pdf");
            }),
            "cannot draw 'dir/loop.pdf': its name must end in .svg or .png");
  const auto refusal = [](const Plot& plot) {
    return MessageOf<InvalidArgument>([&] { WritePlot(plot, "/nowhere/plot.svg"); });
  };
  EXPECT_EQ(refusal(OnePanel({"fit", {0, 1}, {0}})),
            "x of 'fit' has 2 values and y of 'fit' has 1: must be equal");
  EXPECT_EQ(refusal(OnePanel({"fit", {}, {}})), "x of 'fit' has no points: must have one");
  EXPECT_EQ(refusal(OnePanel({"fit", {0}, {std::nan("")}})),
            "y of 'fit' = nan is invalid: must be finite");
  Plot logarithmic = OnePanel({"fit", {0, 1}, {1, 1}});
  logarithmic.panels.front().log_x = true;
  EXPECT_EQ(refusal(logarithmic), "x of 'fit' = 0 is invalid: must be finite and > 0");
  Plot empty = OnePanel({"fit", {0}, {0}});
  empty.panels.front().series.clear();
  EXPECT_EQ(refusal(empty), "a panel has no series: must have one");
}

}  // namespace
}  // namespace mindahl::io::plot_test
