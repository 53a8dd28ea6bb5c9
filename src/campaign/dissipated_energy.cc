#include "mindahl/campaign/dissipated_energy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/math/statistics/univariate_statistics.hpp>
#include <string>
#include <vector>

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

std::string InWords(const EnergyCounts& counts) {
  std::vector<std::string> parts;
  if (counts.replaced > 0) {
    parts.push_back(fmt::format("{} that do not close by those before them", counts.replaced));
  }
  if (counts.left_out > 0) parts.push_back(fmt::format("{} by nothing", counts.left_out));
  return parts.empty() ? "" : fmt::format(", counting {}", fmt::join(parts, " and "));
}

}  // namespace mindahl::campaign
