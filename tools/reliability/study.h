#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "apart.h"
#include "kind.h"
#include "verdict.h"

/// Fits of many loops of many kinds, counted.
namespace mindahl::reliability {

struct Case {
  const Kind* kind = nullptr;
  std::size_t level = 0;
  std::uint64_t seed = 0;
};

/// Every level of the kinds, with the seeds first, first + 1, …
std::vector<Case> CasesOf(const std::vector<Kind>& kinds, std::size_t loops, std::uint64_t first);

struct Result {
  Judgement judgement;
  double seconds = 0.0;  ///< of processor time: making the loop, and the fit
};

/// @param adds_terms  as Try() takes it
/// @param progress  called with the number of fits done; may be empty
std::vector<Result> Run(const std::vector<Case>& cases, bool adds_terms,
                        const ApartOptions& options,
                        const std::function<void(std::size_t)>& progress = {});

struct Tally {
  std::size_t fits = 0;
  std::array<std::size_t, kOutcomes> outcomes{};  ///< fits of each
  std::array<std::size_t, kLevels> silent{};      ///< by level
  std::size_t alarms = 0;
  std::size_t intervals = 0;
  std::size_t misses = 0;
  std::size_t false_limits = 0;  ///< fits with one
  double slowest = 0.0;          ///< [s]

  void Add(const Case& of, const Result& result);
  [[nodiscard]] std::size_t Of(Outcome outcome) const {
    return outcomes[static_cast<std::size_t>(outcome)];
  }
  /// Of the fits, in 0 … 1.
  [[nodiscard]] double Share(Outcome outcome) const;
  [[nodiscard]] double AlarmShare() const;
  [[nodiscard]] double FalseLimitShare() const;
  /// Of the intervals.
  [[nodiscard]] double MissShare() const;
};

}  // namespace mindahl::reliability
