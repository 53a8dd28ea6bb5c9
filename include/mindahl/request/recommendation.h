#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/identification/model_selection.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/request/contact_request.h"
#include "mindahl/request/fit_request.h"
#include "mindahl/request/motion.h"
#include "mindahl/tradeoff/recommendation.h"

namespace mindahl::request {

/// Holds the motion to compute and the error that is allowed: docs/contract.md, `mindahl
/// recommend`.
struct RecommendationRequest {
  LawRequest law;
  DriveRequest drive;
  std::vector<double> displacement;  ///< [m] a motion that no file and no waveform gives
  tradeoff::RecommendOptions asked;
};

/// Returns the names of the criteria, in their order.
std::vector<std::string_view> CriterionNames();

/// @throws InputError for a name that is none of these
tradeoff::Criterion FindCriterion(const std::string& name);

/// The cheapest model and method along a motion, and what it was chosen for.
struct MotionRecommendation {
  RecommendationRequest request;
  models::BranchLaw law;
  std::size_t samples = 0;
  tradeoff::Recommendation found = {};

  /// True if a model and a method meet what is asked.
  [[nodiscard]] bool established() const { return found.choice.has_value(); }
};

/// Finds the cheapest model and method that meet what is asked along a motion.
/// @throws InputError or InvalidArgument naming the option
MotionRecommendation MakeRecommendation(const RecommendationRequest& request, const Tell& warn);

/// The laws that a record does not distinguish from the best, with their costs.
struct RecordRecommendation {
  std::string record;  ///< name of the record
  identification::SimplerLaws laws = {};
  std::vector<double> cost = {};   ///< cost of each [ns/sample]
  std::size_t choice = 0;          ///< the cheapest that is not distinguished
  double indistinguishable = 0.0;  ///< ΔAICc

  /// True if the best of the laws describes the record.
  [[nodiscard]] bool established() const { return laws.describes_record; }
};

/// Finds the cheapest law that a record does not distinguish from the best.
/// @throws InputError naming the record
RecordRecommendation RecommendForRecord(const std::string& name, const loop::Record& record,
                                        const Tell& warn);

// Return the JSON of schema mindahl.recommend/1, as `mindahl recommend --json` writes it, and the
// text that it prints.
std::string ToJson(const MotionRecommendation& recommendation);
std::string ToText(const MotionRecommendation& recommendation);
std::string ToJson(const RecordRecommendation& recommendation);
std::string ToText(const RecordRecommendation& recommendation);

}  // namespace mindahl::request
