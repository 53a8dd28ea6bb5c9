#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/evolution.h"
#include "mindahl/campaign/pages.h"
#include "mindahl/campaign/test_summary.h"

namespace mindahl::request {

/// Holds the answer for a test of many cycles, apart from its rows.
struct TrackedTest {
  /// @param cycles_per_row  that a fit stands for, >= 1
  explicit TrackedTest(std::size_t cycles_per_row = 1) : energy(cycles_per_row) {}

  /// Adds a fit, in their order, but for its energy: of rows that are made again that counts once.
  void Add(const campaign::CycleFit& fit);
  /// True unless no fit converged.
  [[nodiscard]] bool established() const;

  std::vector<std::string> files;
  std::string output;  ///< path of the table of cycles; "" where none was written
  bool is_torsional = false;
  std::size_t samples = 0;  ///< number of samples read
  std::size_t cycles = 0;
  std::size_t unused_samples = 0;  ///< at the ends, part of no whole cycle
  std::size_t broken_rows = 0;     ///< number of rows skipped
  double reversal_gate = 0.0;      ///< [m]
  bool is_gate_certain = true;
  std::size_t fits = 0;
  std::size_t flagged = 0;
  std::size_t resumed = 0;  ///< fits that the table had already
  std::map<std::string, std::size_t> flags;
  campaign::TrackedCourses courses;
  campaign::DissipatedEnergy energy;
  std::optional<campaign::PooledValue> shared_alpha;  ///< empty where each cycle has its own
};

/// Returns the JSON of schema mindahl.track/1, as `mindahl track --json` writes it.
/// @param described  of the test's time histories, by Describe()
std::string ToJson(const TrackedTest& test,
                   const std::vector<campaign::CourseDescription>& described);

/// Returns the summary that `mindahl track` prints, likewise.
std::string ToText(const TrackedTest& test,
                   const std::vector<campaign::CourseDescription>& described);

/// Returns what the page and the figure of the test show, likewise.
campaign::TestSummary SummaryOf(const TrackedTest& test,
                                const std::vector<campaign::CourseDescription>& described);

/// Collects the answers for several separate tests in one table.
class SeparateTests {
 public:
  /// @param has_document  ToJson() is asked for: the description of each test is kept
  SeparateTests(std::string output, bool has_document);
  ~SeparateTests();
  SeparateTests(const SeparateTests&) = delete;
  SeparateTests& operator=(const SeparateTests&) = delete;

  /// @param fault      why the test ended before its record; empty where it did not
  /// @param was_there  its rows were in the table already
  void Add(const std::string& file, const std::string& fault, const TrackedTest& test,
           bool was_there);
  /// Returns the number of tests that were added.
  [[nodiscard]] std::size_t size() const { return tests_; }
  /// True unless a test has a fault, or no fit of one converged.
  [[nodiscard]] bool established() const { return established_; }
  /// Returns the JSON of schema mindahl.track_separate/1.
  [[nodiscard]] std::string ToJson() const;
  /// Returns the summary that `mindahl track --separate` prints.
  [[nodiscard]] std::string ToText() const;

 private:
  struct Document;

  std::string output_;
  std::unique_ptr<Document> document_;  // null where it is not asked for
  std::size_t tests_ = 0;
  std::size_t fits_ = 0;
  std::size_t flagged_ = 0;
  std::size_t kept_ = 0;  // fits that were there
  double energy_ = 0.0;   // [J]
  bool established_ = true;
  std::vector<std::string> faults_;
};

}  // namespace mindahl::request
