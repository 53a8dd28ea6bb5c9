#include "io/panel_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "core/text.h"
#include "io/html.h"
#include "mindahl/core/error.h"

namespace mindahl::io {

std::vector<std::size_t> Thinned(const PlotSeries& series, std::size_t most) {
  const std::size_t size = series.x.size();
  std::vector<std::size_t> kept;
  if (size <= most) {
    for (std::size_t point = 0; point < size; ++point) kept.push_back(point);
    return kept;
  }
  std::vector<const std::vector<double>*> coordinates = {&series.x, &series.y};
  if (HasEnds(series.style)) coordinates.insert(coordinates.end(), {&series.lower, &series.upper});
  const std::size_t runs = std::max<std::size_t>(most / (2 * coordinates.size()), 1);
  for (std::size_t run = 0; run < runs; ++run) {
    const auto begin = static_cast<std::ptrdiff_t>(run * size / runs);
    const auto end = static_cast<std::ptrdiff_t>((run + 1) * size / runs);
    std::vector<std::size_t> extremes;
    for (const std::vector<double>* values : coordinates) {
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

std::vector<std::size_t> ThinnedCloud(const PlotSeries& series, std::size_t most) {
  const std::size_t size = series.x.size();
  std::vector<std::size_t> kept;
  if (size <= most) {
    for (std::size_t point = 0; point < size; ++point) kept.push_back(point);
    return kept;
  }
  const auto [least_x, greatest_x] = std::ranges::minmax_element(series.x);
  const auto [least_y, greatest_y] = std::ranges::minmax_element(series.y);
  const std::array extremes = {
      static_cast<std::size_t>(least_x - series.x.begin()),
      static_cast<std::size_t>(greatest_x - series.x.begin()),
      static_cast<std::size_t>(least_y - series.y.begin()),
      static_cast<std::size_t>(greatest_y - series.y.begin()),
  };
  const auto cell = [](double value, double least, double greatest, std::size_t cells) {
    if (!(greatest > least)) return std::size_t{0};
    const double share = value / (greatest - least) - least / (greatest - least);
    return std::min(static_cast<std::size_t>(share * static_cast<double>(cells)), cells - 1);
  };
  for (std::size_t cells = 512; cells >= 1; cells /= 2) {
    kept.assign(extremes.begin(), extremes.end());
    std::vector<bool> is_taken(cells * cells, false);
    for (std::size_t point = 0; point < size && kept.size() <= most; ++point) {
      const std::size_t at = cell(series.x[point], *least_x, *greatest_x, cells) * cells +
                             cell(series.y[point], *least_y, *greatest_y, cells);
      if (is_taken[at]) continue;
      is_taken[at] = true;
      kept.push_back(point);
    }
    if (kept.size() <= most) break;
  }
  std::ranges::sort(kept);
  const auto repeated = std::ranges::unique(kept);
  kept.erase(repeated.begin(), repeated.end());
  return kept;
}

namespace {

constexpr std::size_t kLeastPoints = 64;  // of each of many series
constexpr std::size_t kColours = 6;       // classes s0 … s5
constexpr std::size_t kShades = 8;        // classes h0 … h7
constexpr double kRightMargin = 16;       // [px]
constexpr double kTicCharacter = 9.6;  // [px] of a tic on a narrow screen, where letters are larger

void RequireNumbers(const std::string& name, const std::vector<double>& values, bool logarithmic) {
  for (const double value : values) {
    RequireFinite(name, value);
    if (logarithmic && value <= 0) ThrowInvalid(name, value, "must be > 0 on a logarithmic axis");
  }
}

/// Returns 10ⁿ in plain text, of which labels are made.
std::string PowerOfTen(int exponent) {
  constexpr std::array<std::string_view, 10> kDigits = {"⁰", "¹", "²", "³", "⁴",
                                                        "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = "10";
  for (const char character : std::to_string(exponent)) {
    text += character == '-' ? "⁻" : kDigits[static_cast<std::size_t>(character - '0')];
  }
  return text;
}

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
    for (const double tic : tics_) longest = std::max(longest, CharactersIn(Label(tic)));
    return longest;
  }

 private:
  [[nodiscard]] double At(double value) const { return logarithmic_ ? std::log10(value) : value; }
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
    constexpr std::array<int, 8> kPowers = {1, 2, 3, 5, 10, 20, 50, 100};
    constexpr double kMostPowers = 8;
    const auto* const step =
        std::ranges::find_if(kPowers, [&](int powers) { return span <= kMostPowers * powers; });
    for (int power = static_cast<int>(std::floor(from_)); power <= std::ceil(to_); ++power) {
      if (power % *step != 0) continue;
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
  const auto is_far = [](double value) { return std::abs(value) >= 1e5 || std::abs(value) < 1e-3; };
  if (is_far(size) || (step_ == 0 && std::ranges::any_of(tics_, is_far))) {
    const int power = static_cast<int>(std::floor(std::log10(size) + 1e-9));
    const std::string factor = fmt::format("{:.4g}", std::abs(tic) / std::pow(10.0, power));
    return (tic < 0 ? "−" : "") + (factor == "1" && step_ == 0 ? "" : factor + "·") +
           PowerOfTen(power);
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

/// Classes of a series' line: its colour, and dashes beyond the first six.
std::string LineClass(const SeriesLook& look) {
  return look.round == 0 ? look.colour : fmt::format("{} d{}", look.colour, look.round);
}

/// A circle, square, diamond, triangle up or down, or pentagon of about the same area.
std::string Marker(double x, double y, const SeriesLook& look) {
  constexpr std::array<std::string_view, 6> kShapes = {
      "",
      "m-3.3-3.3h6.6v6.6h-6.6z",
      "m0-4.6l4.6 4.6l-4.6 4.6l-4.6-4.6z",
      "m0-4.8l4.6 7.8h-9.2z",
      "m0 4.8l4.6-7.8h-9.2z",
      "m0-4.2l4 2.9l-1.5 4.7h-5l-1.5-4.7z",
  };
  const std::string classes =
      fmt::format("marker {}{}", look.colour, look.round == 1 ? " full" : "");
  if (look.shape == 0) {
    return fmt::format("<circle class=\"{}\" cx=\"{}\" cy=\"{}\" r=\"3.6\"/>", classes,
                       Coordinate(x), Coordinate(y));
  }
  return fmt::format("<path class=\"{}\" d=\"M{} {}{}\"/>", classes, Coordinate(x), Coordinate(y),
                     kShapes[look.shape]);
}

class Drawing {
 public:
  Drawing(const PlotPanel& panel, const Frame& frame, double width, std::size_t most_points)
      : frame_(frame), width_(width) {
    AddAxes(panel);
    const std::size_t most = std::max(kLeastPoints, most_points / panel.series.size());
    const std::vector<SeriesLook> looks = LooksOf(panel);
    for (std::size_t k = 0; k < panel.series.size(); ++k) {
      AddSeries(panel.series[k], looks[k], most);
    }
    AddMarks(panel);
  }

  std::string Text() && { return std::move(text_); }

 private:
  template <typename... Arguments>
  void Add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
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
    double last_end = -width_;
    for (const double tic : frame_.x.tics()) {
      const std::string label = frame_.x.Label(tic);
      const double half = kTicCharacter * static_cast<double>(CharactersIn(label)) / 2;
      const double at = frame_.x.Pixel(tic);
      if (at - half < last_end || at + half > width_) continue;
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

  void AddSeries(const PlotSeries& series, const SeriesLook& look, std::size_t most) {
    const std::string& colour = look.colour;
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
      Add("<path class=\"line {}\" d=\"{}\"/>", LineClass(look), Line(series.x, series.y, points));
    }
    if (has_markers) {
      for (const std::size_t point : points) text_ += Marker(x(point), y(point), look);
    }
  }

  /// Labels of marks that are close to each other stand one under the other.
  void AddMarks(const PlotPanel& panel) {
    constexpr double kLine = 18;
    double last_end = -width_;
    double line = 0;
    for (const PlotMark& mark : panel.marks) {
      const double at = frame_.x.Pixel(mark.x);
      Add("<path class=\"mark\" d=\"M{} {}V{}\"/>", Coordinate(at), Coordinate(frame_.top),
          Coordinate(frame_.bottom));
      if (mark.label.empty()) continue;
      const double width = kTicCharacter * static_cast<double>(CharactersIn(mark.label));
      line = at < last_end ? line + kLine : 0;
      const bool is_left = at + width > width_;
      last_end = at + (is_left ? 0 : width);
      Add("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>",
          Coordinate(at + (is_left ? -5 : 5)), Coordinate(frame_.top + 14 + line),
          is_left ? "end" : "start", HtmlText(mark.label));
    }
  }

  const Frame& frame_;
  double width_;
  std::string text_;
};

}  // namespace

void RequireDrawable(const PlotPanel& panel, const std::string& where) {
  RequirePositive("height of " + where, panel.height);
  if (panel.series.empty()) throw InvalidArgument(where + " has no series: must have one");
  for (const PlotSeries& series : panel.series) {
    const std::string name = fmt::format("'{}' of {}", series.label, where);
    RequireSameSize("x of " + name, series.x.size(), "y of " + name, series.y.size());
    if (series.x.empty()) throw InvalidArgument(name + " has no points: must have one");
    RequireNumbers("x of " + name, series.x, panel.log_x);
    RequireNumbers("y of " + name, series.y, panel.log_y);
    if (!HasEnds(series.style)) continue;
    for (const auto* ends : {&series.lower, &series.upper}) {
      RequireSameSize("ends of intervals of " + name, ends->size(), "points", series.y.size());
      RequireNumbers("ends of intervals of " + name, *ends, panel.log_y);
    }
  }
  for (const PlotMark& mark : panel.marks) {
    RequireNumbers(fmt::format("mark '{}' of {}", mark.label, where), {mark.x}, panel.log_x);
  }
}

std::vector<SeriesLook> LooksOf(const PlotPanel& panel) {
  constexpr std::size_t kRounds = 3;
  std::vector<SeriesLook> looks;
  std::size_t without_shade = 0;
  for (const PlotSeries& series : panel.series) {
    if (series.shade) {
      const double shade = std::clamp(*series.shade, 0.0, 1.0) * (kShades - 1);
      looks.push_back({.colour = fmt::format("h{}", std::lround(shade))});
      continue;
    }
    const bool continues = series.label.empty() && series.style == PlotStyle::kLine;
    if (!continues || without_shade == 0) ++without_shade;
    const std::size_t place = without_shade - 1;
    looks.push_back({.colour = fmt::format("s{}", place % kColours),
                     .shape = place % kColours,
                     .round = place / kColours % kRounds});
  }
  return looks;
}

std::string LegendSymbol(PlotStyle style, const SeriesLook& look) {
  std::string line = fmt::format("<path class=\"line {}\" d=\"M1 6H25\"/>", LineClass(look));
  switch (style) {
    case PlotStyle::kLine:
      return line;
    case PlotStyle::kPoints:
      return fmt::format("<path class=\"dots {}\" d=\"M5 6h0M13 6h0M21 6h0\"/>", look.colour);
    case PlotStyle::kMarkers:
      return Marker(13, 6, look);
    case PlotStyle::kIntervals:
      return fmt::format("<path class=\"line {}\" d=\"M13 0V12\"/>", look.colour) +
             Marker(13, 6, look);
    case PlotStyle::kLineAndPoints:
      return line + Marker(13, 6, look);
    case PlotStyle::kBand:
      return fmt::format("<path class=\"area {}\" d=\"M1 1H25V11H1Z\"/>", look.colour) + line;
    case PlotStyle::kBars:
      return fmt::format("<path class=\"bars {}\" d=\"M3 3H11V11H3ZM11 1H19V11H11Z\"/>",
                         look.colour);
  }
  return {};
}

std::string DrawPanel(const PlotPanel& panel, double width, double axes_height,
                      std::size_t most_points) {
  constexpr double kMarginX = 0.02;
  constexpr double kMarginY = 0.05;
  const auto [left, right] = Ends(panel, /*horizontal=*/true);
  const auto [bottom, top] = Ends(panel, /*horizontal=*/false);
  Frame frame{.x = Axis(left, right, kMarginX, panel.log_x),
              .y = Axis(bottom, top, kMarginY, panel.log_y),
              .left = 0,
              .right = width - kRightMargin,
              .top = kAboveAxes,
              .bottom = kAboveAxes + axes_height};
  frame.left =
      std::max(14 + kTicCharacter * static_cast<double>(frame.y.LongestLabel()), panel.label_room);
  frame.x.Place(frame.left, frame.right);
  frame.y.Place(frame.bottom, frame.top);
  return Drawing(panel, frame, width, most_points).Text();
}

PageDrawing DrawForPage(const PlotPanel& panel, std::string_view name) {
  RequireDrawable(panel, fmt::format("figure '{}'", name));
  constexpr int kWidth = 560;
  constexpr std::size_t kMostPoints = 6000;
  const double axes_height = std::round(kWidth / 2.0 * panel.height);
  PageDrawing drawing{.width = kWidth,
                      .height = static_cast<int>(kAboveAxes + axes_height + kBelowAxes),
                      .elements = DrawPanel(panel, kWidth, axes_height, kMostPoints)};
  const std::vector<SeriesLook> looks = LooksOf(panel);
  for (std::size_t k = 0; k < panel.series.size(); ++k) {
    const PlotSeries& series = panel.series[k];
    if (series.label.empty()) continue;
    drawing.legend.push_back({LegendSymbol(series.style, looks[k]), series.label});
  }
  return drawing;
}

}  // namespace mindahl::io
