#include "io/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/locale/encoding_utf.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "core/text.h"
#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

constexpr std::size_t kLeastPoints = 64;  // of each of many series
constexpr double kRightMargin = 16;       // [px]
constexpr double kLeftMargin = 76;        // [px], of labels of common length
constexpr double kTicCharacter = 9.6;     // [px] on a narrow screen, where letters are larger

using Values = std::vector<double>;

/// Returns the coordinates on the vertical axis, with the ends of a band.
std::vector<const Values*> HeightsOf(const PlotSeries& series) {
  if (series.style != PlotStyle::kBand) return {&series.y};
  return {&series.y, &series.lower, &series.upper};
}

void RequireDrawable(const PlotPanel& panel) {
  RequirePositive("height of a panel", panel.height);
  if (panel.series.empty()) throw InvalidArgument("a panel has no series: must have one");
  for (const PlotSeries& series : panel.series) {
    const auto require = [&](char axis, const Values& values, bool is_logarithmic) {
      const std::string what = fmt::format("{} of '{}'", axis, series.label);
      RequireSameSize("x of '" + series.label + "'", series.x.size(), what, values.size());
      if (values.empty()) throw InvalidArgument(what + " has no points: must have one");
      for (const double value : values) {
        RequireFinite(what, value);
        if (is_logarithmic) RequirePositive(what, value);
      }
    };
    for (const Values* y : HeightsOf(series)) require('y', *y, panel.log_y);
    require('x', series.x, panel.log_x);
  }
}

/// Returns a number as factor·10ⁿ in plain text.
std::string WithPower(double value, bool shows_one) {
  constexpr std::array<std::string_view, 10> kDigits = {"⁰", "¹", "²", "³", "⁴",
                                                        "⁵", "⁶", "⁷", "⁸", "⁹"};
  const int power = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
  const std::string factor = fmt::format("{:.4g}", std::abs(value) / std::pow(10.0, power));
  std::string text = factor == "1" && !shows_one ? "10" : factor + "·10";
  for (const char character : std::to_string(power)) {
    text += character == '-' ? "⁻" : kDigits[static_cast<std::size_t>(character - '0')];
  }
  return value < 0 ? "−" + text : text;
}

/// One axis: data to pixels, and where its tics are.
class Axis {
 public:
  double from_pixel = 0.0;
  double to_pixel = 0.0;

  /// @param margin  on either side of the data, a fraction of their span
  Axis(const Values& data, double margin, bool logarithmic)
      : logarithmic_(logarithmic),
        from_(At(std::ranges::min(data))),
        to_(At(std::ranges::max(data))) {
    double span = to_ - from_;
    // A constant has an axis too: a fraction of it to either side, far above what rounding leaves.
    const double size = std::max(std::abs(from_), std::abs(to_));
    if (!(span > 1e-9 * size)) {
      span = logarithmic ? 0.3 : size > 0 ? 0.2 * size : 1.0;
      from_ -= span / 2;
      to_ += span / 2;
    }
    from_ -= margin * span;
    to_ += margin * span;
    PlaceTics();
  }

  [[nodiscard]] double Pixel(double value) const {
    return from_pixel + (At(value) - from_) / (to_ - from_) * (to_pixel - from_pixel);
  }
  [[nodiscard]] const Values& tics() const { return tics_; }
  [[nodiscard]] std::string Label(double tic) const {
    if (tic == 0 || std::abs(tic) < 1e-9 * step_) return "0";
    double size = std::abs(tic);
    for (const double other : tics_) size = std::max(size, std::abs(other));
    const bool is_far = size >= 1e5 || (step_ > 0 ? size : std::abs(tics_.front())) < 1e-3;
    if (is_far) return WithPower(tic, step_ > 0);
    if (step_ == 0) return fmt::format("{:.6g}", tic);
    const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step_) - 1e-9)));
    return fmt::format("{}{:.{}f}", tic < 0 ? "−" : "", std::abs(tic), decimals);
  }

 private:
  [[nodiscard]] double At(double value) const { return logarithmic_ ? std::log10(value) : value; }

  void PlaceTics() {
    constexpr double kTics = 5.5;
    constexpr double kShortest = 0.75;  // of the distance between that many
    const double span = to_ - from_;
    if (logarithmic_ && span > 0.6) {
      const double step = std::ceil(span / 8);
      for (double power = step * std::floor(from_ / step); power <= to_; power += step) {
        for (const double multiple : {1.0, 2.0, 5.0}) {
          const double at = power + std::log10(multiple);
          if ((multiple > 1 && span > 2.5) || at < from_ || at > to_) continue;
          tics_.push_back(multiple * std::pow(10.0, power));
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

  bool logarithmic_;
  double from_;
  double to_;
  double step_ = 0.0;  // between tics; 0 of powers of ten
  Values tics_;
};

/// Returns the points to draw, in order: of runs of consecutive points those with the least and
/// greatest coordinates; all, where there are at most `most`.
std::vector<std::size_t> Thinned(const PlotSeries& series, std::size_t most) {
  const std::size_t size = series.x.size();
  std::vector<const Values*> coordinates = HeightsOf(series);
  coordinates.push_back(&series.x);
  const std::size_t runs = size <= most ? size : most / (2 * coordinates.size());
  std::vector<std::size_t> kept;
  kept.reserve(most);
  for (std::size_t run = 0; run < runs; ++run) {
    for (const Values* values : coordinates) {
      const auto at = [&](std::size_t k) {
        return values->begin() + static_cast<std::ptrdiff_t>(k * size / runs);
      };
      const auto [least, greatest] = std::minmax_element(at(run), at(run + 1));
      kept.push_back(static_cast<std::size_t>(least - values->begin()));
      kept.push_back(static_cast<std::size_t>(greatest - values->begin()));
    }
  }
  std::ranges::sort(kept);
  const auto repeated = std::ranges::unique(kept);
  kept.erase(repeated.begin(), repeated.end());
  return kept;
}

/// Returns the classes of each series: in these it differs from others, in colour, and beyond the
/// first six in dashes or filled markers.
std::vector<std::string> LooksOf(const PlotPanel& panel) {
  constexpr int kColours = 6;       // classes s0 … s5
  constexpr double kLastShade = 7;  // classes h0 … h7
  std::vector<std::string> looks;
  int place = -1;
  for (const auto& [label, x, y, style, lower, upper, shade] : panel.series) {
    const bool continues = label.empty() && style == PlotStyle::kLine && place >= 0;
    if (!shade && !continues) ++place;
    looks.push_back(
        shade ? fmt::format("h{:.0f}", std::round(std::clamp(*shade, 0.0, 1.0) * kLastShade))
              : fmt::format("s{}{}", place % kColours, place / kColours % 2 == 1 ? " more" : ""));
  }
  return looks;
}

/// Points as "M1 2L3 4…" or, where a shape is given, each as that, those left out that fall on the
/// one before.
std::string Points(const Values& x, const Values& y, std::string_view shape, char first = 'M') {
  std::string path;
  std::string last;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::string at = fmt::format("{:.4g} {:.4g}", x[k], y[k]);
    if (at == last) continue;
    path += path.empty() || !shape.empty() ? first : 'L';
    path.append(at).append(shape);
    last = at;
  }
  return path;
}

std::string Path(std::string_view css_class, std::string_view path) {
  return fmt::format("<path class=\"{}\" d=\"{}\"/>", css_class, path);
}

/// Draws points whose coordinates are in pixels.
std::string DrawPoints(const PlotSeries& series, const std::string& look) {
  constexpr std::string_view kCircle = "m-3.6 0a3.6 3.6 0 1 0 7.2 0a3.6 3.6 0 1 0-7.2 0z";
  const auto& [label, x, y, style, lower, upper, shade] = series;
  const auto draw = [&](std::string_view kind, const std::string& path) {
    return Path(fmt::format("{} {}", kind, look), path);
  };
  if (style == PlotStyle::kPoints) return draw("dots", Points(x, y, "h0"));
  if (style == PlotStyle::kMarkers) return draw("marker", Points(x, y, kCircle));
  // A path of one point draws nothing.
  std::string line = draw("line", Points(x, y, "") + "h0");
  if (style == PlotStyle::kLineAndPoints) return line + draw("marker", Points(x, y, kCircle));
  if (style != PlotStyle::kBand) return line;
  const std::string back = Points({x.rbegin(), x.rend()}, {lower.rbegin(), lower.rend()}, "", 'L');
  return draw("area", Points(x, upper, "") + back + "Z") + line;
}

double WidthOf(std::string_view label) {
  return kTicCharacter * static_cast<double>(CharactersIn(label));
}

std::string Text(double x, double y, std::string_view anchor, std::string_view text) {
  return fmt::format("<text x=\"{:.4g}\" y=\"{:.4g}\" text-anchor=\"{}\">{}</text>", x, y, anchor,
                     HtmlText(text));
}

}  // namespace

std::vector<LegendEntry> LegendOf(const PlotPanel& panel) {
  std::vector<LegendEntry> legend;
  const std::vector<std::string> looks = LooksOf(panel);
  for (std::size_t k = 0; k < panel.series.size(); ++k) {
    const auto& [label, x, y, style, lower, upper, shade] = panel.series[k];
    if (label.empty()) continue;
    PlotSeries symbol{.x = {1, 25}, .y = {6, 6}, .style = style, .lower = {12, 12}};
    if (style == PlotStyle::kMarkers) symbol.x = {13, 13};
    symbol.upper = {0, 0};
    legend.push_back({DrawPoints(symbol, looks[k]), label});
  }
  return legend;
}

std::string DrawPanel(const PlotPanel& panel, double width, double axes_height,
                      std::size_t most_points) {
  RequireDrawable(panel);
  constexpr double kMarginX = 0.02;
  constexpr double kMarginY = 0.05;
  Values all_x;
  Values all_y;
  for (const PlotSeries& series : panel.series) {
    all_x.insert(all_x.end(), series.x.begin(), series.x.end());
    for (const Values* y : HeightsOf(series)) all_y.insert(all_y.end(), y->begin(), y->end());
  }
  for (const PlotMark& mark : panel.marks) all_x.push_back(mark.x);
  Axis x_axis(all_x, kMarginX, panel.log_x);
  Axis y_axis(all_y, kMarginY, panel.log_y);
  const double top = y_axis.to_pixel = kAboveAxes;
  const double bottom = y_axis.from_pixel = kAboveAxes + axes_height;
  const double right = x_axis.to_pixel = width - kRightMargin;
  double left = kLeftMargin;
  for (const double tic : y_axis.tics()) left = std::max(left, 14 + WidthOf(y_axis.Label(tic)));
  x_axis.from_pixel = left;

  std::string grid;
  std::string labels;
  double last_end = -width;
  for (const double tic : x_axis.tics()) {
    const std::string label = x_axis.Label(tic);
    const double half = WidthOf(label) / 2;
    const double at = x_axis.Pixel(tic);
    grid += fmt::format("M{:.4g} {:.4g}V{:.4g}", at, top, bottom);
    if (at - half < last_end || at + half > width) continue;
    last_end = at + half;
    labels += Text(at, bottom + 19, "middle", label);
  }
  for (const double tic : y_axis.tics()) {
    const double at = y_axis.Pixel(tic);
    grid += fmt::format("M{:.4g} {:.4g}H{:.4g}", left, at, right);
    labels += Text(left - 7, at + 5, "end", y_axis.Label(tic));
  }
  std::string elements =
      Path("grid", grid) +
      Path("axis", fmt::format("M{:.4g} {:.4g}V{:.4g}H{:.4g}", left, top, bottom, right)) + labels +
      Text(2, 17, "start", panel.y_label) + Text(right, bottom + 44, "end", panel.x_label);

  const std::size_t most = std::max(kLeastPoints, most_points / panel.series.size());
  const std::vector<std::string> looks = LooksOf(panel);
  for (std::size_t k = 0; k < panel.series.size(); ++k) {
    PlotSeries pixels = panel.series[k];
    const std::vector<std::size_t> kept = Thinned(pixels, most);
    const auto draw_on = [&](const Axis& axis, Values& values) {
      Values drawn;
      for (const std::size_t point : kept) drawn.push_back(axis.Pixel(values[point]));
      values = std::move(drawn);
    };
    draw_on(x_axis, pixels.x);
    draw_on(y_axis, pixels.y);
    if (pixels.style == PlotStyle::kBand) {
      draw_on(y_axis, pixels.lower);
      draw_on(y_axis, pixels.upper);
    }
    elements += DrawPoints(pixels, looks[k]);
  }

  // Labels of marks that are close to each other stand one under the other.
  last_end = -width;
  double line = 0;
  for (const PlotMark& mark : panel.marks) {
    constexpr double kLine = 18;
    const double at = x_axis.Pixel(mark.x);
    const bool is_left = at + WidthOf(mark.label) > width;
    line = at < last_end ? line + kLine : 0;
    last_end = at + (is_left ? 0 : WidthOf(mark.label));
    elements +=
        Path("mark", fmt::format("M{:.4g} {:.4g}V{:.4g}", at, top, bottom)) +
        Text(at + (is_left ? -5 : 5), top + 14 + line, is_left ? "end" : "start", mark.label);
  }
  return elements;
}

std::string HtmlText(std::string_view text) {
  // The conversion omits bytes that are not valid UTF-8.
  const std::string valid =
      boost::locale::conv::utf_to_utf<char>(text.data(), text.data() + text.size());
  std::string escaped;
  for (const char& character : valid) {
    const auto byte = static_cast<unsigned char>(character);
    const bool is_blank = character == '\n' || character == '\t';
    escaped += (byte < 0x20 && !is_blank) || byte == 0x7F ? "\uFFFD"
               : character == '&'                         ? "&amp;"
               : character == '<'                         ? "&lt;"
               : character == '>'                         ? "&gt;"
               : character == '"'                         ? "&quot;"
               : character == '\''                        ? "&#39;"
                                                          : std::string_view(&character, 1);
  }
  return escaped;
}

}  // namespace mindahl::io
