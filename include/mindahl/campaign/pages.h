#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mindahl/campaign/evolution.h"
#include "mindahl/campaign/test_summary.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/report/page.h"

namespace mindahl::campaign {

/// Counts the cycles with a flag, and explains the flag.
struct FlagCount {
  std::string name;
  std::string meaning;
  std::size_t cycles = 0;
};

/// Holds everything that the page of a test of many cycles shows.
struct TestSummary {
  std::vector<std::string> files;
  std::size_t cycles = 0;
  std::size_t samples = 0;
  std::size_t fits = 0;
  std::size_t unused_samples = 0;
  double dissipated = 0.0;          ///< [J] in all
  EnergyCounts energy_counts = {};  ///< how the energy of each fit was obtained
  /// Exponent of all cycles; empty where each has its own.
  std::optional<PooledValue> shared_alpha = {};
  std::vector<FlagCount> flags = {};  ///< those that a cycle has
  std::vector<Evolution> evolutions = {};
  std::vector<std::string> changes = {};  ///< in words, one sentence each
};

/// Returns a test of many cycles as one page of HTML, as report::ToPage() makes one of a fit.
std::string ToPage(const TestSummary& test, const report::Provenance& provenance = {});

/// A file of a batch.
struct FileResult {
  std::string file;
  std::string page;     ///< address of its page, relative to the index; "" where there is none
  std::string verdict;  ///< one word for the fit's adequacy; "" where there is none
  std::string fault;    ///< why it is not done; "" where it is
  std::vector<identification::ParameterEstimate> parameters;  ///< empty where the fit failed
};

/// A quantity of files that are repeats of one test, in words.
struct RepeatedQuantity {
  std::string name;
  std::string unit;
  Repeats repeats;
};

/// Returns the index of a batch: every file with its verdict and parameters, those alone that it
/// identifies, what failed and why, and the scatter between files against their stated errors.
std::string BatchIndexPage(std::span<const FileResult> files,
                           std::span<const RepeatedQuantity> repeated,
                           const report::Provenance& provenance = {});

}  // namespace mindahl::campaign
