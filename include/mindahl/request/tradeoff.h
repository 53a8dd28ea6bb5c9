#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mindahl/io/plot.h"
#include "mindahl/request/contact_request.h"
#include "mindahl/request/fit_request.h"
#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::request {

/// Holds the law and the excitations to study: docs/contract.md, `mindahl tradeoff`.
struct TradeoffRequest {
  LawRequest law;                        ///< default: the contact of Peyret et al. (2017) §3
  std::vector<std::string> excitations;  ///< names of ExcitationNames(); empty: all
  std::vector<double> displacement;      ///< [m] a path of the user's instead of these
  std::string path_name;                 ///< title of that path
};

/// Returns the names of the excitations, in their order.
std::vector<std::string_view> ExcitationNames();

/// An excitation as it was measured.
struct MeasuredExcitation {
  std::string name;
  std::string title;
  std::size_t samples = 0;
  tradeoff::CostFloor floor;
  std::vector<tradeoff::WorkPrecision> points;
  std::vector<bool> front = {};  ///< true on the Pareto front of the largest force error
};

struct Tradeoff {
  models::BranchLaw law;
  std::vector<MeasuredExcitation> excitations = {};
  std::vector<tradeoff::ModelRegion> regions = {};  ///< none for α >= 1
  tradeoff::ModelRegionOptions studied = {};
};

/// Runs and times every method along the excitations, and finds the amplitudes at which each model
/// is good enough.
/// @param progress  called with the step that begins now
/// @throws InputError or InvalidArgument naming the option
Tradeoff MakeTradeoff(const TradeoffRequest& request, const Tell& warn, const Tell& progress = {});

/// Returns the JSON of schema mindahl.tradeoff/1, as `mindahl tradeoff --json` writes it.
std::string ToJson(const Tradeoff& study);

/// Returns the tables that `mindahl tradeoff` prints.
std::string ToText(const Tradeoff& study);

/// Returns every point as CSV.
std::string PointsCsv(const Tradeoff& study);

/// Returns the amplitudes at which models serve as CSV.
std::string RegionsCsv(const Tradeoff& study);

/// Returns errors against cost, one panel an excitation: a curve for each method with its
/// resolutions, a marker for each model.
io::Plot ToPlot(const Tradeoff& study);

}  // namespace mindahl::request
