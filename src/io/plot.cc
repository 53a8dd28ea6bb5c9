#include "mindahl/io/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/locale/encoding_utf.hpp>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>

#include "core/platform.h"
#include "core/text.h"
#include "io/drawing.h"
#include "io/source.h"
#include "mindahl/core/error.h"
#include "mindahl/io/output_file.h"

namespace mindahl::io {
namespace {

// On white. Colours differ in lightness, so that they are distinct in grey and for colour-blind
// readers too; shades go from early, dark, to late.
constexpr std::string_view kStyle =
    "text{font-family:sans-serif;font-size:13px;fill:#1b1f24}"
    ".grid{stroke:#e4e4e4}.axis,.mark{stroke:#444}"
    ".s0{color:#c2334a}.s1{color:#2f6ea5}.s2{color:#3a9d6e}"
    ".s3{color:#8d6bb1}.s4{color:#e09f3e}.s5{color:#5f6b76}.s6{color:#6b3410}"
    ".h0{color:#440154}.h1{color:#46327e}.h2{color:#365c8d}.h3{color:#277f8e}"
    ".h4{color:#1fa187}.h5{color:#4ac16d}.h6{color:#8fb52d}.h7{color:#c2a50a}";
constexpr double kCharacter = 9.6;  // [px] on a narrow screen, where letters are larger
constexpr double kRow = 20;         // [px] of a title or a legend
constexpr double kEdge = 8;         // [px]

using Values = std::vector<double>;

double WidthOf(std::string_view text) {
  return kCharacter * static_cast<double>(CharactersIn(text));
}

std::string Text(double x, double y, std::string_view anchor, std::string_view text) {
  return fmt::format("<text x=\"{:.4g}\" y=\"{:.4g}\" text-anchor=\"{}\">{}</text>", x, y, anchor,
                     HtmlText(text));
}

std::string Path(std::string_view css_class, std::string_view path) {
  return fmt::format("<path class=\"{}\" d=\"{}\"/>", css_class, path);
}

std::string Group(double x, double y, std::string_view elements) {
  return fmt::format("<g transform=\"translate({:.1f},{:.1f})\">{}</g>\n", x, y, elements);
}

/// Returns the label of a tic, "0.5" or "2e-07".
std::string TicLabel(double value) {
  return (value < 0 ? "−" : "") + fmt::format("{:.6g}", std::abs(value));
}

/// One axis: data to pixels, and where its tics are.
class Axis {
 public:
  double from_pixel = 0.0, to_pixel = 0.0;
  Values tics = {};

  /// @param margin  on either side of the data, a fraction of their span
  Axis(const Values& data, double margin, bool is_logarithmic) : is_logarithmic_(is_logarithmic) {
    const auto [least, greatest] = std::ranges::minmax(data);
    double span = At(greatest) - At(least);
    // A constant has an axis too: a fraction of it to either side, far above what rounding leaves.
    const double size = std::max(std::abs(At(least)), std::abs(At(greatest)));
    if (!(span > 1e-9 * size)) span = is_logarithmic ? 0.3 : size > 0 ? 0.2 * size : 1.0;
    const double middle = (At(least) + At(greatest)) / 2;
    from_ = middle - (0.5 + margin) * span;
    to_ = middle + (0.5 + margin) * span;
    if (is_logarithmic) {
      PlaceTicsOfPowers();
    } else {
      PlaceTics();
    }
  }

  [[nodiscard]] double Pixel(double value) const {
    return from_pixel + (At(value) - from_) / (to_ - from_) * (to_pixel - from_pixel);
  }

 private:
  [[nodiscard]] double At(double value) const {
    return is_logarithmic_ ? std::log10(value) : value;
  }

  void PlaceTics() {
    constexpr double kTics = 5.5;
    constexpr double kShortest = 0.75;  // of the distance between that many
    const double rough = (to_ - from_) / kTics;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    double step = 10 * power;
    for (const double multiple : {5.0, 2.0, 1.0}) {
      if (multiple * power >= kShortest * rough) step = multiple * power;
    }
    for (double k = std::ceil(from_ / step); k * step <= to_; ++k) tics.push_back(k * step);
  }

  /// Places them at powers of ten, of few decades also at 2 and 5, of a part of one at all digits.
  void PlaceTicsOfPowers() {
    const double decades = to_ - from_;
    const double step = std::ceil(decades / 8);
    for (double power = step * std::floor(from_ / step); power <= to_; power += step) {
      for (int digit = 1; digit < 10; ++digit) {
        const double at = power + std::log10(digit);
        const bool is_one =
            digit == 1 || decades < 0.8 || ((digit == 2 || digit == 5) && decades < 2.5);
        if (is_one && at >= from_ && at <= to_) tics.push_back(digit * std::pow(10.0, power));
      }
    }
  }

  bool is_logarithmic_;
  double from_, to_;
};

/// Appends coordinates, which must be such as can be drawn, to those of their axis.
void Append(const PlotSeries& series, char axis, const Values& values, bool is_logarithmic,
            Values& all) {
  const std::string what = fmt::format("{} of '{}'", axis, series.label);
  RequireSameSize("x of '" + series.label + "'", series.x.size(), what, values.size());
  if (values.empty()) throw InvalidArgument(what + " has no points: must have one");
  for (const double value : values) {
    is_logarithmic ? RequirePositive(what, value) : RequireFinite(what, value);
  }
  all.insert(all.end(), values.begin(), values.end());
}

/// Returns the points to draw, in order: all, or of runs those with least and greatest coordinates.
std::set<std::size_t> Thinned(const PlotSeries& series, std::size_t most) {
  const std::size_t size = series.x.size();
  const std::size_t runs = size <= most ? size : most / 4;
  std::set<std::size_t> kept;
  for (std::size_t run = 0; run < runs; ++run) {
    for (const double* const values : {series.x.data(), series.y.data()}) {
      const auto [least, greatest] =
          std::minmax_element(values + run * size / runs, values + (run + 1) * size / runs);
      kept.insert(static_cast<std::size_t>(least - values));
      kept.insert(static_cast<std::size_t>(greatest - values));
    }
  }
  return kept;
}

/// Returns points as "M1 2L3 4…", each as the shape that is given, unless it falls on the last one.
std::string Points(const Values& x, const Values& y, std::string_view shape) {
  std::string path, last;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::string at = fmt::format("{:.4g} {:.4g}", x[k], y[k]);
    if (at == last) continue;
    path += path.empty() || !shape.empty() ? 'M' : 'L';
    path.append(at).append(shape);
    last = at;
  }
  return path;
}

/// Draws a series whose coordinates are in pixels.
std::string DrawSeries(const Values& x, const Values& y, PlotStyle style, std::string_view look) {
  const auto draw = [&](std::string_view kind, const std::string& path) {
    return Path(fmt::format("{} {}", kind, look), path);
  };
  if (style == PlotStyle::kPoints) return draw("dots", Points(x, y, "h0"));
  if (style == PlotStyle::kArea) return draw("area", Points(x, y, "") + "Z");
  // A path of one point draws nothing.
  const std::string line = draw("line", Points(x, y, "") + "h0");
  return style == PlotStyle::kLine ? line : line + draw("marker", Points(x, y, "h0"));
}

/// Draws axes, grid, labels and marks.
std::string DrawAxes(const PlotPanel& panel, const Axis& x_axis, const Axis& y_axis) {
  const double left = x_axis.from_pixel;
  const double right = x_axis.to_pixel;
  const double top = y_axis.to_pixel;
  const double bottom = y_axis.from_pixel;
  std::string grid;
  std::string labels = Text(2, 14, "start", panel.title);
  double last_end = 0;
  for (const double tic : x_axis.tics) {
    const std::string label = TicLabel(tic);
    const double half = WidthOf(label) / 2;
    const double at = x_axis.Pixel(tic);
    grid += fmt::format("M{:.4g} {:.4g}V{:.4g}", at, top, bottom);
    if (at - half < last_end) continue;
    last_end = at + half;
    labels += Text(at, bottom + 19, "middle", label);
  }
  for (const double tic : y_axis.tics) {
    const double at = y_axis.Pixel(tic);
    grid += fmt::format("M{:.4g} {:.4g}H{:.4g}", left, at, right);
    labels += Text(left - 7, at + 5, "end", TicLabel(tic));
  }
  labels +=
      Text(2, top - 13, "start", panel.y_label) + Text(right, bottom + 44, "end", panel.x_label);
  // Labels of marks stand one under the other, in turn.
  double line = top + 14;
  for (const PlotMark& mark : panel.marks) {
    const double at = x_axis.Pixel(mark.x);
    const bool is_left = at + WidthOf(mark.label) > right;
    labels += Path("mark", fmt::format("M{:.4g} {:.4g}V{:.4g}", at, top, bottom)) +
              Text(at + (is_left ? -5 : 5), line, is_left ? "end" : "start", mark.label);
    line = line > top + 3 * kRow ? top + 14 : line + kRow;
  }
  const std::string lines = fmt::format("M{:.4g} {:.4g}V{:.4g}H{:.4g}", left, top, bottom, right);
  return Path("grid", grid) + Path("axis", lines) + labels;
}

std::string SvgOf(const Plot& plot) {
  constexpr double kWidth = 760;  // [px] of the axes with their labels
  constexpr std::size_t kMostPoints = 20'000;
  std::string elements;
  double top = kEdge;
  if (!plot.title.empty()) {
    elements = fmt::format("<g style=\"font-weight:bold\">{}</g>",
                           Text(kWidth / 2 + kEdge, top + 14, "middle", plot.title));
    top += kRow + kEdge;
  }
  for (const PlotPanel& panel : plot.panels) {
    const Drawing drawn = DrawPanel(panel, kWidth, kMostPoints * panel.series.size());
    elements += Group(kEdge, top, drawn.elements);
    top += drawn.height + kEdge;
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0} {1:.0f}\">\n<style>{2}{3}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{4}</svg>\n",
      kWidth + 2 * kEdge, top, kShapes, kStyle, elements);
}

std::string ToPng(const std::string& svg, const std::filesystem::path& path) {
  const std::optional<std::string> png = OutputOf("rsvg-convert --format=png", svg);
  // A disk that is full may end the file, and not the program.
  if (png && png->ends_with("IEND\xAE\x42\x60\x82")) return *png;
  Refuse(
      "cannot draw '{}': rsvg-convert, which makes PNG, is not on PATH (Debian: librsvg2-bin) or "
      "failed: a name that ends in .svg needs no program",
      path.string());
}

bool IsPng(const std::filesystem::path& path) {
  const std::string extension = LowerCase(path.extension().string());
  if (extension == ".svg" || extension == ".png") return extension == ".png";
  Refuse("cannot draw '{}': its name must end in .svg or .png", path.string());
}

}  // namespace

Drawing DrawPanel(const PlotPanel& panel, double width, std::size_t most_points) {
  constexpr double kAbove = 30;  // [px] above the axes, for the label of the vertical one
  constexpr double kBelow = 52;
  constexpr double kRight = 16;
  constexpr double kLeft = 76;              // of labels of common length
  constexpr double kSymbol = 34;            // of a legend
  constexpr std::size_t kLeastPoints = 64;  // of each of many series
  constexpr int kColours = 7;               // classes s0 … s6
  constexpr double kLastShade = 7;          // classes h0 … h7
  if (panel.series.empty()) throw InvalidArgument("a panel has no series: must have one");
  Values all_x, all_y;
  for (const PlotSeries& series : panel.series) {
    Append(series, 'x', series.x, panel.log_x, all_x);
    Append(series, 'y', series.y, panel.log_y, all_y);
  }
  for (const PlotMark& mark : panel.marks) all_x.push_back(mark.x);
  Axis x_axis(all_x, 0.02, panel.log_x);
  Axis y_axis(all_y, 0.05, panel.log_y);
  y_axis.to_pixel = kAbove + (panel.title.empty() ? 0 : kRow);
  y_axis.from_pixel = y_axis.to_pixel + std::round(width / 2 * panel.height);
  x_axis.to_pixel = width - kRight;
  x_axis.from_pixel = kLeft;
  for (const double tic : y_axis.tics) {
    x_axis.from_pixel = std::max(x_axis.from_pixel, 14 + WidthOf(TicLabel(tic)));
  }
  Drawing drawing{DrawAxes(panel, x_axis, y_axis), y_axis.from_pixel + kBelow};
  // The legend is in rows below.
  double entry = width;
  int place = -1;  // of a series in the order of colours
  for (const PlotSeries& series : panel.series) {
    if (!series.shade && (place < 0 || !series.label.empty())) ++place;
    // In these it differs from others, beyond the first seven in dashes.
    const std::string look =
        series.shade
            ? fmt::format("h{:.0f}", std::round(std::clamp(*series.shade, 0.0, 1.0) * kLastShade))
            : fmt::format("s{}{}", place % kColours, place / kColours % 2 == 1 ? " more" : "");
    Values x, y;
    const std::size_t most = std::max(kLeastPoints, most_points / panel.series.size());
    for (const std::size_t point : Thinned(series, most)) {
      x.push_back(x_axis.Pixel(series.x[point]));
      y.push_back(y_axis.Pixel(series.y[point]));
    }
    drawing.elements += DrawSeries(x, y, series.style, look);
    if (series.label.empty()) continue;
    const double size = kSymbol + WidthOf(series.label);
    if (entry + size > width) {
      entry = 0;
      drawing.height += kRow;
    }
    drawing.elements += Group(
        entry, drawing.height - kRow,
        DrawSeries({1, 25}, {6, 6}, series.style, look) + Text(kSymbol, 11, "start", series.label));
    entry += size;
  }
  return drawing;
}

std::string HtmlText(std::string_view text) {
  // The conversion omits bytes that are not valid UTF-8.
  const std::string valid = boost::locale::conv::utf_to_utf<char>(std::string(text));
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

void RequirePlotName(const std::filesystem::path& path) { IsPng(path); }

void WritePlot(const Plot& plot, const std::filesystem::path& path) {
  const bool is_png = IsPng(path);
  const std::string svg = SvgOf(plot);
  WriteFileAtomically(path, is_png ? ToPng(svg, path) : svg);
}

}  // namespace mindahl::io
