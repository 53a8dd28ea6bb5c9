#include "mindahl/campaign/test_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "core/probability.h"
#include "mindahl/core/error.h"
#include "report/statements.h"

namespace mindahl::campaign {

namespace {

constexpr std::size_t kNeighbours = 9;

}  // namespace

void DissipatedEnergy::Add(const CycleFit& fit) {
  const double steps = fit.samples > 1 ? static_cast<double>(fit.samples - 1) : 0.0;
  const bool is_open = fit.HasFlag("not_closed");
  if (is_open && !of_a_step_.empty()) {
    std::vector<double> neighbours(of_a_step_.begin(), of_a_step_.end());
    total_ += cycles_ * steps * boost::math::statistics::median(neighbours);
    ++counts_.replaced;
  } else if (is_open || !fit.energy) {
    ++counts_.left_out;
  } else {
    total_ += cycles_ * *fit.energy;
    ++counts_.measured;
    if (of_a_step_.size() == kNeighbours) of_a_step_.pop_front();
    of_a_step_.push_back(*fit.energy / steps);
  }
}

std::string Repeats::InWords() const {
  if (!p_value) return "without stated errors";
  return fmt::format("{}, {}", exceed_errors() ? "more than the errors" : "as the errors say",
                     report::ChanceText(*p_value, 2));
}

double Repeats::mean_error() const {
  const double own = std::max(standard_deviation, stated_error.value_or(0.0));
  return std::hypot(own / std::sqrt(static_cast<double>(count)), common_error.value_or(0.0));
}

namespace {

double RootMeanSquare(std::span<const double> values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

std::optional<Repeats> DescribeRepeats(std::span<const double> values,
                                       std::span<const double> errors,
                                       std::span<const double> common) {
  if (!errors.empty()) RequireSameSize("values", values.size(), "errors", errors.size());
  if (!common.empty()) RequireSameSize("values", values.size(), "common errors", common.size());
  if (values.size() < 2) return std::nullopt;
  const auto count = static_cast<double>(values.size());
  Repeats repeats{.count = values.size()};
  for (const double value : values) repeats.mean += value / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - repeats.mean) * (value - repeats.mean);
  repeats.standard_deviation = std::sqrt(squares / (count - 1));
  if (!common.empty()) repeats.common_error = RootMeanSquare(common);
  if (errors.empty()) return repeats;
  double weights = 0.0;
  double weighted = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    weights += 1 / (errors[k] * errors[k]);
    weighted += values[k] / (errors[k] * errors[k]);
  }
  repeats.stated_error = RootMeanSquare(errors);
  double chi_squared = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double off = (values[k] - weighted / weights) / errors[k];
    chi_squared += off * off;
  }
  repeats.p_value = PValueOfChiSquared(chi_squared, count - 1);
  return repeats;
}

}  // namespace mindahl::campaign
