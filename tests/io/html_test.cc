#include "io/html.h"

#include "io/panel_drawing.h"
#include "support/prelude.h"

namespace mindahl::io::html_test {
namespace {

PlotPanel OnePanel(PlotSeries series) {
  return {.x_label = "displacement [µm]", .y_label = "force [N]", .series = {std::move(series)}};
}

PlotSeries Wave(std::size_t points, PlotStyle style) {
  PlotSeries series{"wave", {}, {}, style};
  for (std::size_t i = 0; i < points; ++i) {
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(std::sin(0.01 * static_cast<double>(i)));
  }
  return series;
}

/// Everything that is drawn of a panel: its elements, and the symbols and labels of its legend.
std::string Drawn(const PlotPanel& panel) {
  const PageDrawing drawing = DrawForPage(panel, "f");
  std::string drawn = drawing.elements;
  for (const auto& [symbol, label] : drawing.legend) drawn += symbol + label;
  return drawn;
}

std::size_t Count(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

TEST(HtmlText, EscapesMarkup) {
  EXPECT_EQ(HtmlText("<script>alert('a & \"b\"')</script>"),
            "&lt;script&gt;alert(&#39;a &amp; &quot;b&quot;&#39;)&lt;/script&gt;");
}

TEST(HtmlText, KeepsUtf8AndReplacesInvalidBytes) {
  EXPECT_EQ(HtmlText("σ = 4·10⁷ 𝛼"), "σ = 4·10⁷ 𝛼");
  EXPECT_EQ(HtmlText("a\xFF\x62"), "a\uFFFDb");
  EXPECT_EQ(HtmlText("a\xC3"), "a\uFFFD");
  EXPECT_EQ(HtmlText("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD");  // half of a surrogate pair
  EXPECT_EQ(HtmlText(std::string("\x01\n", 2)), "\uFFFD\n");
}

TEST(PageDrawing, HasItsLabelsAsText) {
  PlotPanel panel = OnePanel(Wave(50, PlotStyle::kLine));
  panel.series[0].label = "<b>&";
  panel.y_label = "T < \"Tc\"";
  const PageDrawing drawing = DrawForPage(panel, "loop");
  EXPECT_THAT(drawing.elements, HasSubstr("T &lt; &quot;Tc&quot;"));
  EXPECT_THAT(drawing.elements, Not(HasSubstr("<b>")));
  ASSERT_THAT(drawing.legend, SizeIs(1));
  EXPECT_EQ(drawing.legend[0].label, "<b>&");  // the page's template escapes it
}

TEST(PageDrawing, DrawsEveryStyle) {
  const std::vector<std::pair<PlotStyle, std::string>> drawn = {
      {PlotStyle::kLine, "class=\"line s0\" d=\"M"},
      {PlotStyle::kPoints, "class=\"dots s0\" d=\"M"},
      {PlotStyle::kMarkers, "<circle class=\"marker s0\""},
      {PlotStyle::kLineAndPoints, "<circle class=\"marker s0\""},
      {PlotStyle::kIntervals, "<circle class=\"marker s0\""},
      {PlotStyle::kBand, "class=\"area s0\" d=\"M"},
      {PlotStyle::kBars, "class=\"bars s0\" d=\"M"},
  };
  for (const auto& [style, element] : drawn) {
    PlotSeries series = Wave(20, style);
    series.label.clear();  // or its key would be found
    series.lower = series.y;
    series.upper = series.y;
    for (double& end : series.upper) end += 1;
    EXPECT_THAT(Drawn(OnePanel(series)), HasSubstr(element));
  }
}

TEST(PageDrawing, DrawsAConstantAndAPointAlone) {
  for (const double value : {0.0, 5.0, -1e-9, 1e12}) {
    const PlotSeries series{"", {value}, {value}, PlotStyle::kLine};
    const std::string figure = Drawn(OnePanel(series));
    EXPECT_THAT(figure, HasSubstr("h0\"/>"));
    EXPECT_THAT(figure, Not(HasSubstr("nan")));
    EXPECT_THAT(figure, Not(HasSubstr("inf")));
  }
}

TEST(PageDrawing, ColoursShadesByPlaceAndOthersByOrder) {
  PlotPanel panel = OnePanel(Wave(5, PlotStyle::kLine));
  for (const double shade : {0.0, 0.5, 1.0}) {
    panel.series.push_back(Wave(5, PlotStyle::kLine));
    panel.series.back().shade = shade;
  }
  panel.series.push_back(Wave(5, PlotStyle::kLine));
  panel.series.push_back(Wave(5, PlotStyle::kLine));
  panel.series.back().label.clear();
  const std::string figure = Drawn(panel);
  for (const char* colour : {"h0", "h4", "h7", "s0"}) {
    EXPECT_EQ(Count(figure, std::string("class=\"line ") + colour + "\""), 2U)
        << colour;  // and key
  }
  // The one without a label has the colour of the one before it, and no key.
  EXPECT_EQ(Count(figure, "class=\"line s1\""), 3U);
}

TEST(PageDrawing, PlacesPointsWhereTheirTicsSay) {
  // Of tics at 0 and 10 the pixel of 5 is the middle: from the drawing alone.
  PlotSeries series{"", {0, 5, 10}, {0, 5, 10}, PlotStyle::kMarkers};
  const std::string figure = Drawn(OnePanel(series));
  std::vector<double> places;
  for (std::size_t at = figure.find("cx=\""); at != std::string::npos;
       at = figure.find("cx=\"", at + 1)) {
    places.push_back(std::stod(figure.substr(at + 4)));
  }
  ASSERT_EQ(places.size(), 3U);
  constexpr double kTenthOfPixel = 0.1;
  EXPECT_NEAR(places[1], (places[0] + places[2]) / 2, kTenthOfPixel);
  const std::size_t label = figure.find(">10</text>");
  ASSERT_NE(label, std::string::npos);
  const std::size_t x = figure.rfind("<text x=\"", label);
  EXPECT_NEAR(std::stod(figure.substr(x + 9)), places[2], kTenthOfPixel);
}

TEST(PageDrawing, MarksWhereSomethingHappened) {
  PlotPanel panel = OnePanel(Wave(50, PlotStyle::kLine));
  panel.marks = {{.x = 10, .label = "step <1>"}, {.x = 20, .label = ""}};
  const std::string figure = Drawn(panel);
  EXPECT_EQ(Count(figure, "class=\"mark\""), 2U);
  EXPECT_THAT(figure, HasSubstr("step &lt;1&gt;"));
}

TEST(PageDrawing, HasASizeThatDoesNotGrowWithTheRecord) {
  constexpr std::size_t kMost = 200'000;  // bytes: 6000 points of some 15, twice of a band
  for (const PlotStyle style : {PlotStyle::kLine, PlotStyle::kPoints, PlotStyle::kBand}) {
    PlotSeries series = Wave(300'000, style);
    series.lower = series.y;
    series.upper = series.y;
    EXPECT_LT(Drawn(OnePanel(series)).size(), kMost);
  }
}

TEST(PageDrawing, RefusesWhatCannotBeDrawn) {
  PlotSeries series{"force", {0, 1}, {0, std::numeric_limits<double>::quiet_NaN()}};
  EXPECT_THROW(Drawn(OnePanel(series)), InvalidArgument);
}

TEST(Thinning, KeepsTheExtremesOfALineAndOfACloud) {
  constexpr std::size_t kPoints = 100'000;
  constexpr std::size_t kMost = 1000;
  PlotSeries series = Wave(kPoints, PlotStyle::kLine);
  series.y[31'415] = 50;
  series.y[27'182] = -70;
  series.x[77'777] = -3;
  for (const auto& kept : {Thinned(series, kMost), ThinnedCloud(series, kMost)}) {
    EXPECT_LE(kept.size(), kMost + 4);  // and the four extremes
    EXPECT_GT(kept.size(), 100U);
    EXPECT_TRUE(std::ranges::is_sorted(kept));
    for (const std::size_t extreme : {31'415U, 27'182U, 77'777U})
      EXPECT_THAT(kept, Contains(extreme));
  }
}

TEST(Thinning, KeepsThePeaksOfABand) {
  PlotSeries series = Wave(50'000, PlotStyle::kBand);
  series.lower = series.y;
  series.upper = series.y;
  series.upper[12'345] = 9;
  series.lower[23'456] = -9;
  const std::vector<std::size_t> kept = Thinned(series, 800);
  EXPECT_THAT(kept, Contains(12'345U));
  EXPECT_THAT(kept, Contains(23'456U));
}

TEST(Thinning, LeavesShortSeriesAlone) {
  const PlotSeries series = Wave(500, PlotStyle::kPoints);
  EXPECT_EQ(Thinned(series, 500).size(), 500U);
  EXPECT_EQ(ThinnedCloud(series, 500).size(), 500U);
}

}  // namespace
}  // namespace mindahl::io::html_test
