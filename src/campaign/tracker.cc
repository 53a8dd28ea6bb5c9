#include "mindahl/campaign/tracker.h"

#include <cmath>
#include <memory>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::campaign {

Tracker::Tracker(TrackOptions options, Done done)
    : options_(std::move(options)),
      done_(std::move(done)),
      splitter_(options_.fit.preparation.reversal_gate.value_or(0.0), options_.together) {
  if (options_.threads < 1) ThrowInvalid("threads [-]", 0, "must be >= 1");
  const CycleFitter refused_here(options_.fit);  // and not in a thread
}

void Tracker::Add(const loop::RecordView& samples, std::span<const std::size_t> lines) {
  std::vector<Cycle> cycles;
  splitter_.Add(samples, lines, cycles);
  Take(cycles);
}

std::size_t Tracker::NextFile() {
  std::vector<Cycle> cycles;
  const std::size_t left = splitter_.Restart(cycles);
  Take(cycles);
  return left;
}

void Tracker::Take(std::vector<Cycle>& cycles) {
  constexpr std::size_t kMostPoints = 400;
  for (Cycle& cycle : cycles) {
    // The first cycle from 1, 10, 100, … on is kept.
    if (static_cast<double>(cycle.number) >= std::pow(10.0, log_.size())) {
      const std::size_t stride = cycle.record.size() / kMostPoints + 1;
      Cycle& kept = log_.emplace_back();
      kept.number = cycle.number;
      for (std::size_t i = 0; i < cycle.record.size(); i += stride) {
        kept.record.displacement.push_back(cycle.record.displacement[i]);
        kept.record.force.push_back(cycle.record.force[i]);
      }
    }
    if (fits_++ < options_.skipped) continue;
    batch_.push_back(std::move(cycle));
    if (batch_.size() == kBatch) Begin();
  }
}

void Tracker::Finish() {
  if (!batch_.empty()) Begin();
  while (!begun_.empty()) Deliver();
}

void Tracker::Begin() {
  while (begun_.size() >= options_.threads) Deliver();
  // If no thread starts std::async defers, but has then moved from its argument: fit is copied.
  const auto cycles = std::make_shared<const std::vector<Cycle>>(std::exchange(batch_, {}));
  const auto fit = [this, cycles] {
    CycleFitter fitter(options_.fit, options_.compliance);
    std::vector<CycleFit> fits;
    fits.reserve(cycles->size());
    for (const Cycle& cycle : *cycles) fits.push_back(fitter.Fit(cycle));
    return fits;
  };
  const auto policy =
      options_.threads > 1 ? std::launch::async | std::launch::deferred : std::launch::deferred;
  begun_.push_back(std::async(policy, fit));
}

void Tracker::Deliver() {
  const std::vector<CycleFit> fits = begun_.front().get();
  begun_.pop_front();
  done_(fits);
}

}  // namespace mindahl::campaign
