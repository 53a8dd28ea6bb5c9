#include "cli/record_recommendation.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "cli/json_output.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/identification/simpler_laws.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/limit_law.h"
#include "mindahl/tradeoff/cost_model.h"

namespace mindahl::cli {

using identification::LawScore;
using identification::SimplerLaws;

namespace {

struct Priced {
  SimplerLaws laws;
  std::vector<double> cost;  // [ns/sample], of each
  std::size_t choice = 0;
  double indistinguishable = 0.0;  // ΔAICc
};

Priced PriceLaws(const loop::Record& record) {
  const identification::FitOptions options;
  Priced priced{.laws = identification::CompareSimplerLaws(record, options),
                .cost = {},
                .indistinguishable = options.thresholds.indistinguishable};
  for (const LawScore& score : priced.laws.scores) {
    const bool has_history = models::FindLimitLaw(score.model) == nullptr;
    const tradeoff::Approximation approximation{score.model, has_history ? "exact" : ""};
    priced.cost.push_back(tradeoff::ModelledCost(
        tradeoff::CountOperations(approximation, score.law, {.displacement = record.displacement}),
        record.size()));
  }
  const auto is_not_told_apart = [&](std::size_t i) { return !priced.laws.scores[i].told_apart; };
  priced.choice = tradeoff::CheapestOf(priced.cost, is_not_told_apart).value_or(priced.laws.best);
  return priced;
}

std::string LawName(const LawScore& score) {
  return score.model + (score.exponent_is_one ? " with alpha = 1" : "");
}

std::string InPercent(double force, const SimplerLaws& laws) {
  return fmt::format("{:.2g} % of the peak force", 100 * force / laws.peak_force);
}

std::string RecordVerdict(const Priced& priced) {
  const LawScore& choice = priced.laws.scores[priced.choice];
  const LawScore& best = priced.laws.scores[priced.laws.best];
  if (priced.choice == priced.laws.best) {
    return fmt::format("{}: the best, and nothing cheaper will do", LawName(choice));
  }
  return fmt::format(
      "{}: the record does not tell it from {}, the best (dAICc = {:.2g}); what it lacks is {:.2g} "
      "N "
      "rms, {}, beside noise of {:.2g} N",
      LawName(choice), LawName(best), choice.delta_aicc, choice.misfit,
      InPercent(choice.misfit, priced.laws), best.rms);
}

std::string Chance(const std::optional<double>& p_value) {
  constexpr double kLeast = 1e-99;  // below it digits mean nothing
  if (!p_value) return "-";
  return *p_value < kLeast ? "<1e-99" : fmt::format("{:.2g}", *p_value);
}

/// The options of simulate that are this law.
std::string OptionsOf(const LawScore& score) {
  const models::FrictionModel* model = models::FindFrictionModel(score.model);
  std::string options = fmt::format("--model {} --sigma {:.6g} --slip-force {:.6g}", score.model,
                                    score.law.tangential_stiffness, score.law.slip_force);
  if (model != nullptr && !model->shape_exponent) {
    options += fmt::format(" --alpha {:.6g}", score.law.shape_exponent);
  }
  return options;
}

void PrintRecommendation(const std::string& record, const Priced& priced, std::ostream& out) {
  const SimplerLaws& laws = priced.laws;
  out << fmt::format(
      "{}: {} samples that say as much as {:.0f} independent ones; peak force {:.5g} N\n", record,
      laws.samples, laws.effective_samples, laws.peak_force);
  out << fmt::format(
      "asked: the cheapest law that the record does not tell from the best (dAICc below {:g})\n\n",
      priced.indistinguishable);
  out << fmt::format("-> {}\n   as options of simulate: {}\n\n", RecordVerdict(priced),
                     OptionsOf(laws.scores[priced.choice]));
  out << fmt::format("  {:<24} {:>9} {:>5} {:>10} {:>10} {:>9} {:>9} {:>9}\n", "", "ns/sample",
                     "free", "rms [N]", "lacks [N]", "dAICc", "2 ln L", "p");
  for (std::size_t i = 0; i < laws.scores.size(); ++i) {
    const LawScore& score = laws.scores[i];
    if (!score.converged) {
      out << fmt::format("  {:<24} {:>9.2f} {:>5}  no fit\n", LawName(score), priced.cost[i],
                         score.free_parameters);
      continue;
    }
    std::string remark = score.told_apart ? "told apart" : "not told apart";
    if (i == laws.best) remark = "best";
    if (i == priced.choice) remark += " <- this";
    out << fmt::format("  {:<24} {:>9.2f} {:>5} {:>10.3g} {:>10.2g} {:>9.3g} {:>9.3g} {:>9}  {}\n",
                       LawName(score), priced.cost[i], score.free_parameters, score.rms,
                       score.misfit, score.delta_aicc, score.likelihood_ratio,
                       Chance(score.p_value), remark);
  }
}

nlohmann::ordered_json RecordRecommendationJson(const std::string& record, const Priced& priced) {
  const SimplerLaws& laws = priced.laws;
  nlohmann::ordered_json json;
  json["schema"] = "mindahl.recommend/1";
  json["version"] = Version();
  json["record"] = {{"file", record},
                    {"samples", laws.samples},
                    {"effective_samples", laws.effective_samples},
                    {"peak_force", laws.peak_force},
                    {"is_described", laws.describes_record}};
  json["indistinguishable"] = priced.indistinguishable;
  json["verdict"] = RecordVerdict(priced);
  json["law_options"] = OptionsOf(laws.scores[priced.choice]);
  json["laws"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < laws.scores.size(); ++i) {
    const LawScore& score = laws.scores[i];
    const bool is_spring = score.model == "spring";
    const bool is_coulomb = score.model == "coulomb";
    const auto if_fitted = [&](double value) {
      return NumberOrNull(score.converged ? std::optional(value) : std::nullopt);
    };
    nlohmann::ordered_json entry;
    entry["model"] = score.model;
    entry["sigma"] = is_coulomb ? nullptr : if_fitted(score.law.tangential_stiffness);
    entry["alpha"] = is_spring || is_coulomb ? nullptr : if_fitted(score.law.shape_exponent);
    entry["slip_force"] = is_spring ? nullptr : if_fitted(score.law.slip_force);
    entry["free_parameters"] = score.free_parameters;
    entry["cost_ns_per_sample"] = priced.cost[i];
    entry["rms"] = if_fitted(score.rms);
    entry["misfit"] = if_fitted(score.misfit);
    entry["delta_aicc"] = if_fitted(score.delta_aicc);
    entry["likelihood_ratio"] = if_fitted(score.likelihood_ratio);
    entry["p_value"] = NumberOrNull(score.p_value);
    entry["told_apart"] = score.told_apart;
    entry["best"] = i == laws.best;
    entry["choice"] = i == priced.choice;
    json["laws"].push_back(entry);
  }
  return json;
}

}  // namespace

void RecommendForRecord(const std::string& record, const io::RecordColumns& columns,
                        const std::string& json, Console& console) {
  const io::RecordFile file = io::ReadRecord(record, columns);
  for (const std::string& note : file.notes) {
    console.err << fmt::format("mindahl recommend: note: {}\n", note);
  }
  Priced priced;
  try {
    priced = PriceLaws(file.record);
  } catch (const InvalidArgument& error) {
    throw InputError(fmt::format("--record: {}: {}", record, error.what()));
  }
  if (!priced.laws.describes_record) {
    console.err << fmt::format(
        "mindahl recommend: warning: {}: none of these laws describes the record: what they differ "
        "by is set against their misfit, not against noise; mindahl fit says more\n",
        record);
    console.exit_status = kNotEstablished;
  }
  if (json != "-") PrintRecommendation(record, priced, console.out);
  if (!json.empty()) WriteJson(RecordRecommendationJson(record, priced), json, console);
}

}  // namespace mindahl::cli
