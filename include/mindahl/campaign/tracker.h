#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <optional>
#include <span>
#include <vector>

#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/loop/record.h"

namespace mindahl::campaign {

struct TrackOptions {
  /// Options of each fit. The reversal gate splits the record; without one it is 0.
  identification::FitOptions fit{};
  std::optional<double> compliance = std::nullopt;  ///< G* [1/Pa], for the contact radius
  /// Cycles in a row that are one fit, >= 1; the last of a file may be of fewer.
  std::size_t together = 1;
  std::size_t threads = 1;  ///< worker threads that fit, >= 1; where it is 1 the calling one fits
  std::size_t skipped = 0;  ///< fits at the beginning that are not made: a multiple of kBatch
};

/// Fits of a batch begin one where the last one ended, the first anew: whatever the number of
/// threads, and wherever a run begins, a batch has the same results.
inline constexpr std::size_t kBatch = 64;

/// Takes the samples of a long record and gives the fits of its cycles, in their order and by whole
/// batches but for the last. Memory: of a batch a thread, and one cycle.
class Tracker {
 public:
  using Done = std::function<void(std::span<const CycleFit>)>;

  /// @param done  called by Add() and Finish(), in the thread that calls these
  /// @throws InvalidArgument for options that break a rule
  Tracker(TrackOptions options, Done done);
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  /// @param samples, lines  as CycleSplitter takes them
  /// Waits where a batch a thread is at work.
  void Add(const loop::RecordView& samples, std::span<const std::size_t> lines);

  /// Declares that the samples that follow are from another file.
  /// @returns samples at the end of the last that are part of no whole cycle
  std::size_t NextFile();

  /// Fits what is left, after the NextFile() of the last file.
  void Finish();

  /// Returns the loops of the cycles 1, 10, 100, … so far, thinned to what a figure shows.
  [[nodiscard]] const std::vector<Cycle>& log() const { return log_; }

  /// Returns the number of whole cycles so far, fitted or not.
  [[nodiscard]] std::size_t cycles() const { return splitter_.cycles(); }

 private:
  void Take(std::vector<Cycle>& cycles);
  void Begin();
  void Deliver();

  TrackOptions options_;
  Done done_;
  CycleSplitter splitter_;
  std::vector<Cycle> batch_;
  std::size_t fits_ = 0;                                  // made or skipped
  std::deque<std::future<std::vector<CycleFit>>> begun_;  // in their order
  std::vector<Cycle> log_;
};

}  // namespace mindahl::campaign
