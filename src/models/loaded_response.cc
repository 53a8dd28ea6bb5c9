#include "models/loaded_response.h"

#include <algorithm>
#include <cmath>

#include "mindahl/core/error.h"
#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "models/load_zones.h"

namespace mindahl::models {
namespace {

/// Runs through a history.
/// @param log_rate   ln κ, as all that follows with its derivatives where they are taken along
/// @param remaining  β = 1 − α
/// @param at_rest    where the contact is unloaded
/// @param keep       takes each sample and its force over μN₀
template <typename Real, typename Share, typename Keep>
void Follow(const LoadedHistory& history, const Real& log_rate, const Real& remaining,
            const Share& share, const Real& at_rest, Keep keep) {
  // δc and Tc over μN₀: δc = (N/N₀)^β/(κβ).
  const auto rim_at = [&](std::size_t i) -> LoadRim<Real> {
    using std::exp;
    if (!(history.load_ratio[i] > 0)) return {Real(0.0), Real(0.0)};
    return {exp(remaining * history.log_load_ratio[i] - log_rate) / remaining,
            Real(history.load_ratio[i])};
  };
  const std::size_t first = history.before.empty() ? 0 : history.before.front();
  double load = history.load_ratio[first];
  LoadRim<Real> rim = rim_at(first);
  ZonedContact<Real> contact(rim, at_rest);
  const auto move = [&](std::size_t i) {
    if (history.load_ratio[i] != load) {
      load = history.load_ratio[i];
      rim = rim_at(i);
    }
    MoveTo(rim, history.displacement[i], share, contact);
  };
  for (const std::size_t i : history.before) move(i);
  for (std::size_t i = 0; i < history.displacement.size(); ++i) {
    move(i);
    keep(i, contact.force);
  }
}

/// Takes the nearest values that never fall, or never grow, from begin to end.
void MakeMonotone(std::span<double> values, bool grows) {
  struct Pool {
    double mean;
    double count;
  };
  std::vector<Pool> pools;
  for (const double value : values) {
    Pool last{value, 1.0};
    while (!pools.empty()) {
      const Pool& before = pools.back();
      if (grows ? last.mean >= before.mean : last.mean <= before.mean) break;
      const double count = before.count + last.count;
      last = {before.mean + (last.mean - before.mean) * (last.count / count), count};
      pools.pop_back();
    }
    pools.push_back(last);
  }
  auto value = values.begin();
  for (const auto& [mean, count] : pools) {
    value = std::fill_n(value, static_cast<std::size_t>(count), mean);
  }
}

}  // namespace

LoadedHistory MakeLoadedHistory(std::span<const double> displacement,
                                std::span<const double> load_ratio,
                                std::span<const std::size_t> reversals, InitialState state) {
  RequireSameSize("displacement", displacement.size(), "load ratio", load_ratio.size());
  if (displacement.empty()) throw InvalidArgument("a history needs at least one sample");
  LoadedHistory history;
  history.displacement.assign(displacement.begin(), displacement.end());
  history.load_ratio.assign(load_ratio.begin(), load_ratio.end());
  for (const double ratio : load_ratio) {
    RequireNonNegative("load ratio [-]", ratio);
    history.log_load_ratio.push_back(ratio > 0 ? std::log(ratio) : 0.0);  // 0: lifted off
  }
  std::size_t begin = 0;
  for (std::size_t stroke = 0; stroke <= reversals.size(); ++stroke) {
    const std::size_t end = stroke < reversals.size() ? reversals[stroke] : displacement.size() - 1;
    const bool grows = displacement[end] > displacement[begin];
    MakeMonotone(std::span(history.displacement).subspan(begin, end - begin + 1), grows);
    begin = end;
  }
  if (state == InitialState::kVirgin) return history;
  const auto [lowest, highest] = std::ranges::minmax_element(displacement);
  const auto low = static_cast<std::size_t>(lowest - displacement.begin());
  const auto high = static_cast<std::size_t>(highest - displacement.begin());
  const std::size_t first_end = reversals.empty() ? displacement.size() - 1 : reversals.front();
  const bool sets_out_up = displacement[first_end] > displacement.front();
  history.before = sets_out_up ? std::vector{high, low} : std::vector{low, high};
  // From the first sample to where the motion has turned twice and comes by there again.
  if (reversals.size() < 2) return history;
  const std::size_t stroke_end = reversals.size() > 2 ? reversals[2] : displacement.size() - 1;
  for (std::size_t i = 0; i <= stroke_end; ++i) {
    const bool is_back = i > reversals[1] && (sets_out_up ? displacement[i] > displacement.front()
                                                          : displacement[i] < displacement.front());
    if (is_back) break;
    history.before.push_back(i);
  }
  return history;
}

void EvaluateNormalizedForce(const NormalizedLaw& law, const LoadedHistory& history,
                             double unloaded, std::span<double> t,
                             const NormalizedGradient& gradient) {
  Validate(BranchLaw{law.rate, law.shape_exponent, 1.0});
  if (law.shape_exponent >= 1) {
    ThrowInvalid("shape exponent [-]", law.shape_exponent,
                 "must be < 1 under a varying load: slip is complete at a finite displacement");
  }
  if (law.spring_travel != 0) {
    ThrowInvalid("travel of the spring in series [m]", law.spring_travel,
                 "must be 0 under a varying load");
  }
  RequireSameSize("displacement", history.displacement.size(), "response", t.size());
  const bool has_origin = history.before.empty();
  Tangent at_rest(has_origin ? unloaded : 0.0);
  if (IsEmpty(gradient)) {
    backbone::WithShape(law.shape_exponent, [&](const auto& shape) {
      Follow(history, std::log(law.rate), 1 - law.shape_exponent,
             ShareOfWidth{shape, law.shape_exponent}, at_rest.value(),
             [&](std::size_t i, double force) { t[i] = force; });
    });
    return;
  }
  using Shape = backbone::GeneralShape<double>;
  if (has_origin) at_rest.derivatives()[kUnloaded] = 1.0;
  std::ranges::fill(gradient[kSpring], 0.0);
  const Tangent log_rate(std::log(law.rate), Eigen::Vector3d::Unit(kRate));
  const Tangent remaining(1 - law.shape_exponent, -Eigen::Vector3d::Unit(kShape));
  Follow(history, log_rate, remaining,
         ShareOfWidth<Shape>{{law.shape_exponent}, law.shape_exponent}, at_rest,
         [&](std::size_t i, const Tangent& force) {
           t[i] = force.value();
           for (const ResponseParameter by : {kRate, kShape, kUnloaded}) {
             const auto column = static_cast<std::size_t>(by);
             if (!gradient[column].empty()) gradient[column][i] = force.derivatives()[by];
           }
         });
}

}  // namespace mindahl::models
