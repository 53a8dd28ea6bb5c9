#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mindahl::io {

/// Points are small dots for dense records, those on a line are larger; an area is filled.
enum class PlotStyle { kLine, kPoints, kLineAndPoints, kArea };

/// One curve. Points are drawn and joined in the order given, so a loop is a loop.
struct PlotSeries {
  std::string label{};         ///< for the legend; "" = no entry
  std::vector<double> x = {};  ///< finite, at least one; > 0 on a logarithmic axis
  std::vector<double> y = {};  ///< finite, as many as x; > 0 on a logarithmic axis
  PlotStyle style = PlotStyle::kLine;
  /// Place on a scale of colours from 0 to 1, where series follow each other as cycles do; else
  /// each has a colour of its own, and one without a label that of the series before.
  std::optional<double> shade = {};
};

/// A vertical line across a panel, where something happened.
struct PlotMark {
  double x = 0.0;       ///< finite; > 0 on a logarithmic axis
  std::string label{};  ///< next to it
};

/// One pair of axes, with its title and its legend above it.
struct PlotPanel {
  std::string x_label{};  ///< with its unit, e.g. "displacement δ [µm]"; "" = none
  std::string y_label{};
  std::vector<PlotSeries> series = {};  ///< the first fourteen differ in colour and in grey
  double height = 1.0;                  ///< axes over half of the width, > 0
  bool log_x = false;
  bool log_y = false;
  std::string title = {};  ///< "" = none
  std::vector<PlotMark> marks = {};
};

/// Panels, one under the other.
struct Plot {
  std::string title{};  ///< "" = none
  std::vector<PlotPanel> panels = {};
};

/// Refuses a bad name, before the work whose plot it is.
/// @throws InputError when WritePlot() has no format for a file of that name
void RequirePlotName(const std::filesystem::path& path);

/// Draws a plot into an SVG or PNG file, by the extension of its name, atomically.
///
/// Labels are plain UTF-8 text: nothing in them is markup. Of a series of more than 20 000 points,
/// runs of points keep those with the least and greatest coordinates, in order: no peak is lost.
/// @throws InputError when the extension is another, the file cannot be written, or for PNG the
///   program rsvg-convert is not installed or fails
/// @throws InvalidArgument naming the series when a value is not finite, or not > 0 on a
///   logarithmic axis, numbers of values differ, or there is nothing to draw
void WritePlot(const Plot& plot, const std::filesystem::path& path);

}  // namespace mindahl::io
