#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/plot_rules.h"
#include "io/power_of_ten.h"
#include "io/thinning.h"
#include "mindahl/io/html.h"

namespace mindahl::io {
namespace {

constexpr std::size_t kMostPointsOnPage = 6000;
constexpr std::size_t kLeastPoints = 64;   // of each of many series
constexpr std::size_t kColourClasses = 6;  // classes s0 … s5
constexpr std::size_t kShadeClasses = 8;   // classes h0 … h7

// The drawing [px], where it is not scaled to the page.
constexpr double kWidth = 560;
constexpr double kTop = 30;     // the label of the vertical axis
constexpr double kBottom = 52;  // tics and the label of the horizontal axis
constexpr double kRightMargin = 16;
constexpr double kTicCharacter = 9.6;  // of a tic on a narrow screen, where letters are larger

constexpr std::string_view kStyle = R"css(
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
.bars{fill:var(--c);fill-opacity:.35;stroke:var(--c);stroke-width:.8}
.legend{list-style:none;display:flex;flex-wrap:wrap;gap:.1rem 1.1rem;padding:0;margin:.1rem 0;font-size:.9rem}
.legend li{margin:0;overflow-wrap:anywhere}
.legend svg{width:26px;height:12px;margin-right:.35rem;vertical-align:-1px}
)css";

/// One axis: data to pixels, and where its tics are.
class Axis {
 public:
  /// @param margin  on either side of the data, a fraction of their span
  Axis(double least, double greatest, double margin, bool logarithmic)
      : logarithmic_(logarithmic), from_(At(least)), to_(At(greatest)) {
    double span = to_ - from_;
    // A constant has an axis too: a fraction of it to either side, far above what rounding leaves.
    const double size = std::max(std::abs(from_), std::abs(to_));
    if (!(span > 1e-9 * size)) {
      span = size > 0 ? (logarithmic ? 0.3 : 0.2 * size) : 1.0;
      from_ -= span / 2;
      to_ += span / 2;
    }
    from_ -= margin * span;
    to_ += margin * span;
    PlaceTics();
  }

  void Place(double from_pixel, double to_pixel) {
    from_pixel_ = from_pixel;
    to_pixel_ = to_pixel;
  }
  [[nodiscard]] double Pixel(double value) const {
    return from_pixel_ + (At(value) - from_) / (to_ - from_) * (to_pixel_ - from_pixel_);
  }
  [[nodiscard]] bool Shows(double value) const { return At(value) >= from_ && At(value) <= to_; }
  [[nodiscard]] const std::vector<double>& tics() const { return tics_; }
  [[nodiscard]] std::string Label(double tic) const;
  [[nodiscard]] std::size_t LongestLabel() const {
    std::size_t longest = 1;
    for (const double tic : tics_) longest = std::max(longest, Characters(Label(tic)));
    return longest;
  }

 private:
  [[nodiscard]] double At(double value) const { return logarithmic_ ? std::log10(value) : value; }
  static std::size_t Characters(std::string_view text) {
    return static_cast<std::size_t>(std::ranges::count_if(
        text, [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0) != 0x80; }));
  }
  void PlaceTics();

  bool logarithmic_;
  double from_;
  double to_;
  double from_pixel_ = 0.0;
  double to_pixel_ = 1.0;
  double step_ = 0.0;  // between tics; 0 of a logarithmic axis
  std::vector<double> tics_;
};

void Axis::PlaceTics() {
  constexpr double kTics = 5.5;
  constexpr double kShortest = 0.75;  // of the distance between that many
  const double span = to_ - from_;
  if (logarithmic_ && span > 0.6) {
    const bool has_multiples = span < 2.5;
    for (int power = static_cast<int>(std::floor(from_)); power <= std::ceil(to_); ++power) {
      for (const double multiple : {1.0, 2.0, 5.0}) {
        const double tic = multiple * std::pow(10.0, power);
        if ((multiple > 1 && !has_multiples) || !Shows(tic)) continue;
        tics_.push_back(tic);
      }
    }
    return;
  }
  const double from = logarithmic_ ? std::pow(10.0, from_) : from_;
  const double to = logarithmic_ ? std::pow(10.0, to_) : to_;
  const double rough = (to - from) / kTics;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  step_ = 10 * power;
  for (const double multiple : {5.0, 2.0, 1.0}) {
    if (multiple * power >= kShortest * rough) step_ = multiple * power;
  }
  for (double k = std::ceil(from / step_); k * step_ <= to; ++k) tics_.push_back(k * step_);
}

std::string Axis::Label(double tic) const {
  if (tic == 0 || std::abs(tic) < 1e-9 * step_) return "0";
  double largest = std::abs(tic);
  for (const double other : tics_) largest = std::max(largest, std::abs(other));
  const double size = step_ > 0 ? largest : std::abs(tic);
  if (size >= 1e5 || size < 1e-3) {
    const int power = static_cast<int>(std::floor(std::log10(size) + 1e-9));
    return fmt::format("{}{:.4g}·{}", tic < 0 ? "−" : "", std::abs(tic) / std::pow(10.0, power),
                       PowerOfTen(power));
  }
  if (step_ == 0) return fmt::format("{:.6g}", tic);
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step_) - 1e-9)));
  std::string label = fmt::format("{:.{}f}", tic, decimals);
  if (label.front() == '-') label = "−" + label.substr(1);
  return label;
}

/// Holds the axes of a panel and its place on the page.
struct Frame {
  Axis x;
  Axis y;
  double left;
  double right;
  double top;
  double bottom;
};

std::pair<double, double> Ends(const PlotPanel& panel, bool horizontal) {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  const auto include = [&](const std::vector<double>& values) {
    for (const double value : values) {
      least = std::min(least, value);
      greatest = std::max(greatest, value);
    }
  };
  for (const PlotSeries& series : panel.series) {
    include(horizontal ? series.x : series.y);
    if (!horizontal && HasEnds(series.style)) {
      include(series.lower);
      include(series.upper);
    }
    if (series.style != PlotStyle::kBars) continue;
    if (!horizontal) include({0.0});
    if (horizontal && series.x.size() > 1) {
      const double half = (series.x[1] - series.x[0]) / 2;
      include({series.x.front() - half, series.x.back() + half});
    }
  }
  if (horizontal) {
    for (const PlotMark& mark : panel.marks) include({mark.x});
  }
  return {least, greatest};
}

/// A coordinate, to a tenth of a pixel.
std::string Coordinate(double pixel) {
  std::string text = fmt::format("{:.1f}", pixel);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

class Drawing {
 public:
  Drawing(const PlotPanel& panel, const Frame& frame) : frame_(frame) {
    AddAxes(panel);
    const std::size_t most = std::max(kLeastPoints, kMostPointsOnPage / panel.series.size());
    const std::vector<std::string> colours = Colours(panel);
    for (std::size_t k = 0; k < panel.series.size(); ++k) {
      AddSeries(panel.series[k], colours[k], most);
    }
    AddMarks(panel);
  }

  std::string Text() && { return std::move(text_); }

  /// The classes that colour the series of a panel. One without a label goes on with the colour of
  /// the one before it.
  static std::vector<std::string> Colours(const PlotPanel& panel) {
    std::vector<std::string> colours;
    std::size_t without_shade = 0;
    for (const PlotSeries& series : panel.series) {
      if (series.shade) {
        const double shade = std::clamp(*series.shade, 0.0, 1.0) * (kShadeClasses - 1);
        colours.push_back(fmt::format("h{}", std::lround(shade)));
      } else {
        if (!series.label.empty() || without_shade == 0) ++without_shade;
        colours.push_back(fmt::format("s{}", (without_shade - 1) % kColourClasses));
      }
    }
    return colours;
  }

  /// Draws the symbol of a series in the legend.
  static std::string Key(PlotStyle style, std::string_view colour) {
    std::string drawn;
    switch (style) {
      case PlotStyle::kLine:
        drawn = fmt::format("<path class=\"line {}\" d=\"M1 6H25\"/>", colour);
        break;
      case PlotStyle::kPoints:
        drawn = fmt::format("<path class=\"dots {}\" d=\"M5 6h0M13 6h0M21 6h0\"/>", colour);
        break;
      case PlotStyle::kMarkers:
        drawn = Marker(13, 6, colour);
        break;
      case PlotStyle::kIntervals:
        drawn = fmt::format("<path class=\"line {}\" d=\"M13 0V12\"/>{}", colour,
                            Marker(13, 6, colour));
        break;
      case PlotStyle::kLineAndPoints:
        drawn =
            fmt::format("<path class=\"line {}\" d=\"M1 6H25\"/>{}", colour, Marker(13, 6, colour));
        break;
      case PlotStyle::kBand:
        drawn = fmt::format(
            "<path class=\"area {0}\" d=\"M1 1H25V11H1Z\"/><path class=\"line {0}\" d=\"M1 "
            "6H25\"/>",
            colour);
        break;
      case PlotStyle::kBars:
        drawn = fmt::format("<path class=\"bars {}\" d=\"M3 3H11V11H3ZM11 1H19V11H11Z\"/>", colour);
        break;
    }
    return fmt::format("<svg viewBox=\"0 0 26 12\" aria-hidden=\"true\">{}</svg>", drawn);
  }

 private:
  template <typename... Arguments>
  void Add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  static std::string Marker(double x, double y, std::string_view colour) {
    return fmt::format("<circle class=\"marker {}\" cx=\"{}\" cy=\"{}\" r=\"3.6\"/>", colour,
                       Coordinate(x), Coordinate(y));
  }

  void AddAxes(const PlotPanel& panel) {
    std::string grid;
    for (const double tic : frame_.x.tics()) {
      grid += fmt::format("M{} {}V{}", Coordinate(frame_.x.Pixel(tic)), Coordinate(frame_.top),
                          Coordinate(frame_.bottom));
    }
    for (const double tic : frame_.y.tics()) {
      grid += fmt::format("M{} {}H{}", Coordinate(frame_.left), Coordinate(frame_.y.Pixel(tic)),
                          Coordinate(frame_.right));
    }
    Add("<path class=\"grid\" d=\"{}\"/>", grid);
    Add("<path class=\"axis\" d=\"M{} {}V{}H{}\"/>", Coordinate(frame_.left),
        Coordinate(frame_.top), Coordinate(frame_.bottom), Coordinate(frame_.right));
    // Letters are half as large again on a narrow screen: labels must not touch there.
    double last_end = -kWidth;
    for (const double tic : frame_.x.tics()) {
      const std::string label = frame_.x.Label(tic);
      const double half = kTicCharacter * static_cast<double>(label.size()) / 2;
      const double at = frame_.x.Pixel(tic);
      if (at - half < last_end || at + half > kWidth) continue;
      last_end = at + half;
      Add("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>", Coordinate(at),
          Coordinate(frame_.bottom + 19), HtmlText(label));
    }
    for (const double tic : frame_.y.tics()) {
      Add("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", Coordinate(frame_.left - 7),
          Coordinate(frame_.y.Pixel(tic) + 5), HtmlText(frame_.y.Label(tic)));
    }
    Add("<text x=\"2\" y=\"17\">{}</text>", HtmlText(panel.y_label));
    Add("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", Coordinate(frame_.right),
        Coordinate(frame_.bottom + 44), HtmlText(panel.x_label));
  }

  /// The points as "M1 2L3 4…", those left out that fall on the one before.
  std::string Line(const std::vector<double>& x, const std::vector<double>& y,
                   std::span<const std::size_t> points, char first = 'M') const {
    std::string path;
    std::string last;
    for (const std::size_t point : points) {
      const std::string at = fmt::format("{} {}", Coordinate(frame_.x.Pixel(x[point])),
                                         Coordinate(frame_.y.Pixel(y[point])));
      if (at == last) continue;
      path += (path.empty() ? first : 'L') + at;
      last = at;
    }
    // A path of one point draws nothing.
    if (!path.empty() && path.find('L') == std::string::npos && first == 'M') path += "h0";
    return path;
  }

  void AddSeries(const PlotSeries& series, std::string_view colour, std::size_t most) {
    const std::vector<std::size_t> points =
        series.style == PlotStyle::kPoints ? ThinnedCloud(series, most) : Thinned(series, most);
    const auto x = [&](std::size_t point) { return frame_.x.Pixel(series.x[point]); };
    const auto y = [&](std::size_t point) { return frame_.y.Pixel(series.y[point]); };
    const bool has_line = series.style == PlotStyle::kLine || series.style == PlotStyle::kBand ||
                          series.style == PlotStyle::kLineAndPoints;
    const bool has_markers = series.style == PlotStyle::kMarkers ||
                             series.style == PlotStyle::kIntervals ||
                             series.style == PlotStyle::kLineAndPoints;
    if (series.style == PlotStyle::kBand) {
      const std::vector<std::size_t> back(points.rbegin(), points.rend());
      Add("<path class=\"area {}\" d=\"{}{}Z\"/>", colour, Line(series.x, series.upper, points),
          Line(series.x, series.lower, back, 'L'));
    }
    if (series.style == PlotStyle::kIntervals) {
      std::string bars;
      for (const std::size_t point : points) {
        bars += fmt::format("M{} {}V{}", Coordinate(x(point)),
                            Coordinate(frame_.y.Pixel(series.lower[point])),
                            Coordinate(frame_.y.Pixel(series.upper[point])));
      }
      Add("<path class=\"line {}\" d=\"{}\"/>", colour, bars);
    }
    if (series.style == PlotStyle::kPoints) {
      std::string dots;
      std::string last;
      for (const std::size_t point : points) {
        const std::string at = fmt::format("M{} {}h0", Coordinate(x(point)), Coordinate(y(point)));
        if (at != last) dots += at;
        last = at;
      }
      Add("<path class=\"dots {}\" d=\"{}\"/>", colour, dots);
    }
    if (series.style == PlotStyle::kBars) {
      const double half =
          series.x.size() > 1 ? (series.x[1] - series.x[0]) / 2 : std::abs(series.x[0]) / 2 + 0.5;
      std::string bars;
      for (const std::size_t point : points) {
        bars += fmt::format("M{} {}V{}H{}V{}Z", Coordinate(frame_.x.Pixel(series.x[point] - half)),
                            Coordinate(frame_.y.Pixel(0.0)), Coordinate(y(point)),
                            Coordinate(frame_.x.Pixel(series.x[point] + half)),
                            Coordinate(frame_.y.Pixel(0.0)));
      }
      Add("<path class=\"bars {}\" d=\"{}\"/>", colour, bars);
    }
    if (has_line) {
      Add("<path class=\"line {}\" d=\"{}\"/>", colour, Line(series.x, series.y, points));
    }
    if (has_markers) {
      for (const std::size_t point : points) text_ += Marker(x(point), y(point), colour);
    }
  }

  /// Labels of marks that are close to each other stand one under the other.
  void AddMarks(const PlotPanel& panel) {
    constexpr double kLine = 18;
    double last_end = -kWidth;
    double line = 0;
    for (const PlotMark& mark : panel.marks) {
      const double at = frame_.x.Pixel(mark.x);
      Add("<path class=\"mark\" d=\"M{} {}V{}\"/>", Coordinate(at), Coordinate(frame_.top),
          Coordinate(frame_.bottom));
      if (mark.label.empty()) continue;
      const double width = kTicCharacter * static_cast<double>(mark.label.size());
      line = at < last_end ? line + kLine : 0;
      const bool is_left = at + width > kWidth;
      last_end = at + (is_left ? 0 : width);
      Add("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>",
          Coordinate(at + (is_left ? -5 : 5)), Coordinate(frame_.top + 14 + line),
          is_left ? "end" : "start", HtmlText(mark.label));
    }
  }

  const Frame& frame_;
  std::string text_;
};

std::string HtmlLegend(const PlotPanel& panel) {
  std::string entries;
  const std::vector<std::string> colours = Drawing::Colours(panel);
  for (std::size_t k = 0; k < panel.series.size(); ++k) {
    if (panel.series[k].label.empty()) continue;
    entries += fmt::format("<li>{}{}</li>", Drawing::Key(panel.series[k].style, colours[k]),
                           HtmlText(panel.series[k].label));
  }
  return entries.empty() ? "" : fmt::format("<ul class=\"legend\">{}</ul>\n", entries);
}

}  // namespace

std::string_view FigureStyle() { return kStyle; }

std::string HtmlFigure(const PlotPanel& panel, const FigureText& text) {
  RequireDrawable(panel, fmt::format("figure '{}'", text.id));
  constexpr double kMarginX = 0.02;
  constexpr double kMarginY = 0.05;
  const auto [left, right] = Ends(panel, /*horizontal=*/true);
  const auto [bottom, top] = Ends(panel, /*horizontal=*/false);
  const double height = std::round(kWidth / 2 * panel.height);
  Frame frame{.x = Axis(left, right, kMarginX, panel.log_x),
              .y = Axis(bottom, top, kMarginY, panel.log_y),
              .left = 0,
              .right = kWidth - kRightMargin,
              .top = kTop,
              .bottom = kTop + height};
  frame.left = 14 + kTicCharacter * static_cast<double>(frame.y.LongestLabel());
  frame.x.Place(frame.left, frame.right);
  frame.y.Place(frame.bottom, frame.top);
  const std::string id = HtmlText(text.id);
  return fmt::format(
      "<figure id=\"{0}\">\n<h3>{1}</h3>\n<p>{2}</p>\n{3}"
      "<svg class=\"plot\" viewBox=\"0 0 {4} {5}\" role=\"img\" aria-labelledby=\"{0}-title "
      "{0}-text\"><title id=\"{0}-title\">{1}</title><desc id=\"{0}-text\">{2}</desc>{6}</svg>\n"
      "</figure>\n",
      id, HtmlText(text.title), HtmlText(text.description), HtmlLegend(panel), kWidth,
      Coordinate(frame.bottom + kBottom), Drawing(panel, frame).Text());
}

}  // namespace mindahl::io
