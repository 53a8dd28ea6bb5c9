#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mindahl::io {

/// Points are small dots for dense records. Markers are large, and of another shape in each series;
/// they show few values one by one, alone or joined by a line, or with an interval around each. A
/// band is a line with the area between its lower and upper ends; bars stand on 0 and touch.
enum class PlotStyle { kLine, kPoints, kMarkers, kLineAndPoints, kIntervals, kBand, kBars };

/// One curve. Points are drawn and joined in the order given, so a loop is a loop.
struct PlotSeries {
  std::string label{};         ///< for the legend; "" = no entry
  std::vector<double> x = {};  ///< finite, at least one; > 0 on a logarithmic axis
  std::vector<double> y = {};  ///< finite, as many as x; > 0 on a logarithmic axis
  PlotStyle style = PlotStyle::kLine;
  std::vector<double> lower = {};  ///< ends of intervals of y, as many; for kIntervals and kBand
  std::vector<double> upper = {};
  /// Place on a scale of colours from 0 to 1, where series follow each other as cycles do; else
  /// each has a colour of its own.
  std::optional<double> shade = {};
};

/// A vertical line across a panel, where something happened.
struct PlotMark {
  double x = 0.0;       ///< finite; > 0 on a logarithmic axis
  std::string label{};  ///< next to it; "" = none
};

/// One pair of axes. The legend stands above them, on the right of them when it has more than four
/// entries or is too long.
struct PlotPanel {
  std::string x_label{};  ///< with its unit, e.g. "displacement δ [µm]"; "" = none
  std::string y_label{};
  std::vector<PlotSeries> series = {};  ///< the first twelve differ in colour and in grey
  double height = 1.0;                  ///< fraction of the page, relative to the other panels, > 0
  bool log_x = false;
  bool log_y = false;
  std::string title = {};  ///< above the axes; "" = none
  std::vector<PlotMark> marks = {};
  double label_room = 0.0;  ///< least room for the numbers of the vertical axis [px]
};

/// Panels row by row; a row is as high as its highest panel.
struct Plot {
  std::string title{};  ///< "" = none
  std::vector<PlotPanel> panels = {};
  int width = 900;            ///< [px]
  int height = 700;           ///< [px]
  int columns = 1;            ///< >= 1
  std::string subtitle = {};  ///< under the title; "" = none
};

/// Refuses a bad name, before the work whose plot it is.
/// @throws InputError when WritePlot() has no format for a file of that name
void RequirePlotName(const std::filesystem::path& path);

/// Draws a plot into an SVG or PNG file, by the extension of its name, atomically.
///
/// Labels are plain UTF-8 text: nothing in them is markup. A series of more than 20 000
/// points is drawn through fewer: it is cut into 5000 runs of consecutive points, and of each run
/// the points with the least and greatest x and y are kept, in order; no peak is lost and the curve
/// moves by less than one run.
/// @throws InputError when the extension is another, the file cannot be written, or for PNG the
///   program rsvg-convert is not installed or fails
/// @throws InvalidArgument naming the panel and series when a value is not finite, or not > 0 on a
///   logarithmic axis, x and y differ in length, or there is nothing to draw
void WritePlot(const Plot& plot, const std::filesystem::path& path);

}  // namespace mindahl::io
