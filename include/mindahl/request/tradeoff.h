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
  LawRequest law{};                        ///< default: the contact of Peyret et al. (2017) §3
  std::vector<std::string> excitations{};  ///< names of ExcitationNames(); empty: all
  std::vector<double> displacement{};      ///< [m] a path of the user's instead of these
  std::string path_name{};                 ///< title of that path
  double tolerance = 0.01;                 ///< largest error that is allowed [-], in (0, 1]
};

/// Returns the names of the excitations, in their order.
std::vector<std::string_view> ExcitationNames();

/// An excitation as it was measured.
struct MeasuredExcitation {
  std::string name;
  std::string title;
  std::size_t samples = 0;
  std::vector<tradeoff::WorkPrecision> points;
  std::size_t cheapest = 0;              ///< point whose force is within the tolerance
  std::size_t cheapest_with_energy = 0;  ///< and the dissipated energy too
};

struct Tradeoff {
  models::BranchLaw law;
  double tolerance = 0.01;
  std::vector<MeasuredExcitation> excitations = {};
};

/// Runs and times every model and method along the excitations, and finds the cheapest within the
/// tolerance.
/// @throws InputError or InvalidArgument naming the option
Tradeoff MakeTradeoff(const TradeoffRequest& request, const Tell& warn);

/// Returns the JSON of schema mindahl.tradeoff/1, as `mindahl tradeoff --json` writes it.
std::string ToJson(const Tradeoff& study);

/// Returns the tables that `mindahl tradeoff` prints.
std::string ToText(const Tradeoff& study);

/// Returns every point as CSV.
std::string PointsCsv(const Tradeoff& study);

/// Returns errors against cost, one panel an excitation: a curve for each method with its
/// resolutions, a marker for each model.
io::Plot ToPlot(const Tradeoff& study);

}  // namespace mindahl::request
