#pragma once

#include <optional>
#include <vector>

#include "mindahl/io/plot.h"
#include "mindahl/report/report.h"
#include "mindahl/report/units.h"

// The figures of a report, each one panel. None is of a fit that failed.
namespace mindahl::report {

struct PanelUnits {
  ScaledUnit displacement;
  ScaledUnit force;
  ScaledUnit residual;
};

/// Displacements in the unit in which the widest record has a number between 1 and 1000, as far as
/// there is one; forces as they are.
PanelUnits PlainUnits(const Report& report);

/// Returns the same, with forces and residuals in units of their own.
PanelUnits PrefixedUnits(const Report& report);

/// Says how points are distinguished: by record, or, of a record that is alone, those of each of
/// its cycles too.
enum class LoopColours { kOneARecord, kByCycle };

/// Measured and fitted force over the displacement, with the reversals. By cycle, a record of many
/// samples has the fit of its last cycle alone: of all of them a page would draw chords.
io::PlotPanel LoopPanel(const Report& report, const PanelUnits& units, LoopColours colours);

/// Returns the fitted less measured force, of samples in the load window where there is one.
io::PlotPanel ResidualAlongStroke(const Report& report, const PanelUnits& units,
                                  LoopColours colours);

// Plots the residuals of the samples that count.
io::PlotPanel ResidualInTime(const Report& report, const PanelUnits& units);
/// Returns how often a residual is how large, in bins of 2·IQR·n^(−1/3) (Freedman & Diaconis 1981),
/// 10 to 60 of them, out to five standard deviations; and the normal distribution of the same
/// standard deviation.
io::PlotPanel ResidualDistribution(const Report& report, const PanelUnits& units);
/// Correlation of residuals that many samples apart, up to a little over a cycle, with the limits
/// ±1.96/√n of white noise. Empty for fewer than eight samples, or where nothing is left over.
std::optional<io::PlotPanel> ResidualAutocorrelation(const Report& report);

/// Draws a joint confidence region, with the estimate and Mindlin's exponent; nothing without a
/// region of these parameters or where either is not identified.
/// @param first  "sigma" or "slip_force"; the second is alpha
std::optional<io::PlotPanel> RegionPanel(const Report& report, std::string_view first);

/// Returns the likelihood along the slip force. Empty where the fit had no need to look at it, and
/// under a model that is inadequate.
std::optional<io::PlotPanel> SlipForceLikelihood(const Report& report);

enum class OverLoad { kStiffness, kSlipForce };

/// Draws σ or Tc against the load: of the whole series a line where it determines it, of each file
/// alone an interval. Empty where the records have one load, or determine nothing.
std::optional<io::PlotPanel> LoadPanel(const Report& report, const PanelUnits& units,
                                       OverLoad quantity);

}  // namespace mindahl::report
