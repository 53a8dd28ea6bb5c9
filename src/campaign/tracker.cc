#include "mindahl/campaign/tracker.h"

#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::campaign {
namespace {

std::vector<CycleFit> FitBatch(const identification::FitOptions& options,
                               const std::vector<Cycle>& cycles) {
  CycleFitter fitter(options);
  std::vector<CycleFit> fits;
  fits.reserve(cycles.size());
  for (const Cycle& cycle : cycles) fits.push_back(fitter.Fit(cycle));
  return fits;
}

void RequireCount(const char* quantity, std::size_t count) {
  if (count < 1) ThrowInvalid(quantity, 0, "must be >= 1");
}

}  // namespace

Tracker::Tracker(TrackOptions options, Done done)
    : options_(std::move(options)),
      done_(std::move(done)),
      splitter_(options_.fit.preparation.reversal_gate.value_or(0.0), options_.together) {
  RequireCount("fits to choose one of [-]", options_.every);
  RequireCount("threads [-]", options_.threads);
  if (options_.skipped % kBatch != 0) {
    ThrowInvalid("skipped fits [-]", static_cast<double>(options_.skipped),
                 "must be a multiple of a batch");
  }
  const CycleFitter refused_here(options_.fit);  // and not in a thread
}

void Tracker::Add(const loop::RecordView& samples, std::span<const std::size_t> lines) {
  cycles_.clear();
  splitter_.Add(samples, lines, cycles_);
  for (Cycle& cycle : cycles_) {
    if (pieces_++ % options_.every != 0) continue;
    if (fits_++ < options_.skipped) continue;
    batch_.push_back(std::move(cycle));
    if (batch_.size() == kBatch) Begin();
  }
}

void Tracker::Finish() {
  if (!batch_.empty()) Begin();
  while (!at_work_.empty()) Deliver();
}

void Tracker::Begin() {
  while (at_work_.size() >= options_.threads) Deliver();
  at_work_.push_back(std::async(
      std::launch::async,
      [&fit = options_.fit, batch = std::exchange(batch_, {})] { return FitBatch(fit, batch); }));
  batch_.reserve(kBatch);
}

void Tracker::Deliver() {
  const std::vector<CycleFit> fits = at_work_.front().get();
  at_work_.pop_front();
  done_(fits);
}

}  // namespace mindahl::campaign
