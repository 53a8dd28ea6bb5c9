#include "mindahl/request/recommendation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/tradeoff/approximation.h"
#include "request/json.h"

namespace mindahl::request {

using identification::LawScore;
using identification::SimplerLaws;
using models::BranchLaw;
using tradeoff::Approximation;
using tradeoff::Candidate;
using tradeoff::Criterion;
using tradeoff::Recommendation;
using tradeoff::RecommendOptions;

namespace {

/// A criterion, its name and what it is in words.
struct CriterionRow {
  Criterion criterion;
  std::string_view name;
  std::string_view words;
};

constexpr std::array kCriteria = {
    CriterionRow{Criterion::kEnergy, "energy", "error of the dissipated energy"},
    CriterionRow{Criterion::kMaxForce, "max", "largest force error, of the peak force"},
    CriterionRow{Criterion::kRmsForce, "rms", "rms force error, of the peak force"},
};

const CriterionRow& RowOf(Criterion criterion) {
  return *std::ranges::find(kCriteria, criterion, &CriterionRow::criterion);
}

/// The command that computes the same.
std::string CommandCall(const RecommendationRequest& request, const Approximation& approximation,
                        const BranchLaw& law) {
  std::string call = fmt::format("mindahl simulate --model {}", approximation.model);
  if (const methods::Method* method = methods::FindMethod(approximation.method)) {
    if (method->name != "exact") call += fmt::format(" --method {}", method->name);
    if (method->adaptive) {
      call += fmt::format(" --tolerance {:g}", approximation.resolution.tolerance);
    } else if (!method->steps.empty()) {
      call += fmt::format(" --steps {}", approximation.resolution.steps);
    }
  }
  const models::FrictionModel* model = models::FindFrictionModel(approximation.model);
  const BranchLaw own = tradeoff::LawOf(approximation, law);
  if (model == nullptr || model->shape_exponent) {
    call += fmt::format(" --sigma {} --slip-force {}", own.tangential_stiffness, own.slip_force);
  } else {
    call += fmt::format(" --sigma {} --alpha {} --slip-force {}", own.tangential_stiffness,
                        own.shape_exponent, own.slip_force);
  }
  if (!request.drive.path.empty()) {
    call += fmt::format(" --path '{}'", request.drive.path);
    if (!request.drive.path_unit.empty()) {
      call += fmt::format(" --path-unit {}", request.drive.path_unit);
    }
  } else {
    const models::ExcitationOptions& excitation = request.drive.excitation;
    call +=
        fmt::format(" --waveform {} {} --cycles {} --samples-per-cycle {}", request.drive.waveform,
                    request.drive.lambda ? fmt::format("--lambda {}", *request.drive.lambda)
                                         : fmt::format("--amplitude {}", *request.drive.amplitude),
                    excitation.cycles, excitation.samples_per_cycle);
    if (request.drive.waveform == "growing-sine") {
      call += fmt::format(" --growth {}", excitation.growth);
    }
    if (request.drive.waveform == "random") call += fmt::format(" --seed {}", request.drive.seed);
  }
  return call;
}

std::string LibraryCall(const Approximation& approximation, const BranchLaw& contact) {
  const BranchLaw law = tradeoff::LawOf(approximation, contact);
  const methods::Method* method = methods::FindMethod(approximation.method);
  std::string resolution;
  if (method != nullptr && method->adaptive) {
    resolution = fmt::format(", {{.tolerance = {:g}}}", approximation.resolution.tolerance);
  } else if (method != nullptr && !method->steps.empty()) {
    resolution = fmt::format(", {{.steps = {}}}", approximation.resolution.steps);
  }
  return fmt::format(
      "#include \"mindahl/tradeoff/approximation.h\"\n"
      "const mindahl::models::BranchLaw law{{.tangential_stiffness = {}, .shape_exponent = {}, "
      ".slip_force = {}}};\n"
      "const auto evaluate = mindahl::tradeoff::Prepare(mindahl::tradeoff::Approximation{{\"{}\", "
      "\"{}\"{}}}, law);\n"
      "evaluate({{.displacement = x}}, force);  // spans of one length, the contact unloaded at "
      "0\n",
      law.tangential_stiffness, law.shape_exponent, law.slip_force, approximation.model,
      approximation.method, resolution);
}

std::string RecommendationVerdict(const Recommendation& recommendation) {
  if (!recommendation.choice) return "nothing meets the request";
  const std::size_t choice = *recommendation.choice;
  const Approximation& approximation = recommendation.candidates[choice].point.approximation;
  if (choice == recommendation.exact) {
    return fmt::format("{}: nothing cheaper meets the request", tradeoff::Describe(approximation));
  }
  if (const models::LimitLaw* limit = models::FindLimitLaw(approximation.model)) {
    return fmt::format("{}: {}", approximation.model, limit->title);
  }
  return fmt::format("{}: {}", tradeoff::Describe(approximation),
                     models::FindFrictionModel(approximation.model)->title);
}

std::string AfterTransient(const Recommendation& recommendation) {
  const Candidate& candidate = recommendation.candidates[*recommendation.after_transient];
  return fmt::format("{} after {} cycle{}, {:.1f} ns/sample",
                     tradeoff::Describe(candidate.point.approximation), *candidate.settles_after,
                     *candidate.settles_after == 1 ? "" : "s", candidate.point.cost);
}

std::string LawName(const LawScore& score) {
  return score.model + (score.exponent_is_one ? " with alpha = 1" : "");
}

std::string InPercent(double force, const SimplerLaws& laws) {
  return fmt::format("{:.2g} % of the peak force", 100 * force / laws.peak_force);
}

std::string RecordVerdict(const RecordRecommendation& priced) {
  const LawScore& choice = priced.laws.scores[priced.choice];
  const LawScore& best = priced.laws.scores[priced.laws.best];
  if (priced.choice == priced.laws.best) {
    return fmt::format("{}: the best, and nothing cheaper is as good", LawName(choice));
  }
  return fmt::format(
      "{}: the record does not distinguish it from {}, the best (dAICc = {:.2g}); it differs from "
      "it by {:.2g} N rms, {}, against noise of {:.2g} N",
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

Json CandidateJson(const Candidate& candidate) {
  Json json = PrecisionJson(candidate.point);
  json["meets"] = candidate.meets;
  json["settles_after_cycles"] = nullptr;
  if (candidate.settles_after) json["settles_after_cycles"] = *candidate.settles_after;
  return json;
}

/// Returns the command that computes the same, null of a motion that no command has.
Json CommandJson(const RecommendationRequest& request, const Approximation& approximation,
                 const BranchLaw& law) {
  if (!request.displacement.empty()) return nullptr;
  return CommandCall(request, approximation, law);
}

}  // namespace

std::vector<std::string_view> CriterionNames() { return NamesOf(kCriteria, &CriterionRow::name); }

Criterion FindCriterion(const std::string& name) {
  RequireOneOf("--criterion", name, CriterionNames());
  return std::ranges::find(kCriteria, name, &CriterionRow::name)->criterion;
}

MotionRecommendation MakeRecommendation(const RecommendationRequest& request, const Tell& warn) {
  if (request.asked.largest_cost) {
    RequirePositive("--cost [ns/sample]", *request.asked.largest_cost);
  }
  MotionRecommendation made{.request = request, .law = ResolveLaw(request.law)};
  for (const std::string& doubt : DoubtsAbout(request.law.contact)) warn(doubt);
  ImposedMotion motion;
  if (request.displacement.empty()) {
    motion = MakeMotion(request.drive, made.law);
  } else {
    motion.displacement = request.displacement;
  }
  made.samples = motion.displacement.size();
  made.found = tradeoff::Recommend(made.law, motion.drive(), request.asked);
  return made;
}

std::string ToJson(const MotionRecommendation& made) {
  const RecommendOptions& asked = made.request.asked;
  const Recommendation& recommendation = made.found;
  Json json;
  json["schema"] = "mindahl.recommend/1";
  json["version"] = Version();
  json["excitation"] = {{"samples", made.samples},
                        {"cycles", recommendation.cycles},
                        {"peak_force", recommendation.peak_force}};
  json["law"] = LawJson(made.law);
  json["criterion"] = RowOf(asked.criterion).name;
  json["tolerance"] = asked.tolerance;
  json["largest_cost"] = NumberOrNull(asked.largest_cost);
  json["transient_cycles"] = asked.transient_cycles;
  json["cost_floor"] = FloorJson(recommendation.floor);
  json["verdict"] = RecommendationVerdict(recommendation);
  json["choice"] = nullptr;
  json["command"] = nullptr;
  json["cpp"] = nullptr;
  if (recommendation.choice) {
    const Candidate& choice = recommendation.candidates[*recommendation.choice];
    json["choice"] = CandidateJson(choice);
    json["command"] = CommandJson(made.request, choice.point.approximation, made.law);
    json["cpp"] = LibraryCall(choice.point.approximation, made.law);
  }
  json["after_transient"] = nullptr;
  if (recommendation.after_transient) {
    json["after_transient"] =
        CandidateJson(recommendation.candidates[*recommendation.after_transient]);
  }
  json["candidates"] = Json::array();
  for (const Candidate& candidate : recommendation.candidates) {
    json["candidates"].push_back(CandidateJson(candidate));
  }
  return Dump(json);
}

std::string ToText(const MotionRecommendation& made) {
  const RecommendOptions& asked = made.request.asked;
  const Recommendation& recommendation = made.found;
  std::string text;
  text += fmt::format("{} samples, {:.3g} cycles, peak force {:.6g} N\n", made.samples,
                      recommendation.cycles, recommendation.peak_force);
  if (asked.largest_cost) {
    text += fmt::format("asked: the most precise within {:g} ns/sample ({})\n", *asked.largest_cost,
                        RowOf(asked.criterion).words);
  } else {
    text += fmt::format("asked: the cheapest within {:g} % ({})\n", 100 * asked.tolerance,
                        RowOf(asked.criterion).words);
  }
  if (asked.transient_cycles > 0) {
    text += fmt::format("       errors count after {} cycles\n", asked.transient_cycles);
  }
  text += fmt::format("\n-> {}\n", RecommendationVerdict(recommendation));
  if (recommendation.after_transient) {
    text += fmt::format("   or, once its transient is over: {}\n", AfterTransient(recommendation));
  }
  if (recommendation.choice) {
    const Candidate& choice = recommendation.candidates[*recommendation.choice];
    const Candidate& exact = recommendation.candidates[recommendation.exact];
    if (*recommendation.choice != recommendation.exact) {
      text += fmt::format("   {:.1f} times as fast as the exact {}\n",
                          exact.point.cost / choice.point.cost, exact.point.approximation.model);
    }
    if (choice.point.approximation.law) {
      text += fmt::format("   with {}, fitted to this excitation and valid for no other\n",
                          RefittedParameters(choice.point.approximation));
    }
    const auto& energy = choice.point.precision.energy;
    if (asked.criterion != Criterion::kEnergy && energy && *energy > asked.tolerance) {
      text += fmt::format(
          "   note: it misses {:.3g} % of the dissipated energy; where damping matters, ask with "
          "--criterion energy\n",
          100 * *energy);
    }
    if (made.request.displacement.empty()) {
      text += fmt::format("\ncommand line:\n  {}\n",
                          CommandCall(made.request, choice.point.approximation, made.law));
    }
    text += "\nC++:\n";
    const std::string call = LibraryCall(choice.point.approximation, made.law);
    std::string indented = "  ";
    for (std::size_t i = 0; i < call.size(); ++i) {
      indented += call[i];
      if (call[i] == '\n' && i + 1 < call.size()) indented += "  ";
    }
    text += indented;
  }
  text += fmt::format(
      "\nevidence, costs by counted operations (floor: one square root and division, "
      "{:.2f} ns/sample):\n  {}\n",
      recommendation.floor.arithmetic, PrecisionTableHead(/*is_timed=*/false));
  for (std::size_t i = 0; i < recommendation.candidates.size(); ++i) {
    const Candidate& candidate = recommendation.candidates[i];
    std::string remark;
    if (recommendation.choice == i) {
      remark = "<- this";
    } else if (candidate.meets) {
      remark = asked.largest_cost ? "cheap enough" : "meets it";
    } else if (candidate.settles_after && *candidate.settles_after > 0) {
      remark = fmt::format("force within {:g} % after {} cycle{}", 100 * asked.tolerance,
                           *candidate.settles_after, *candidate.settles_after == 1 ? "" : "s");
    }
    const std::string row = PrecisionTableRow(candidate.point, recommendation.floor.arithmetic);
    text += fmt::format("  {}{}\n", row, remark.empty() ? "" : "  " + remark);
  }
  return text;
}

RecordRecommendation RecommendForRecord(const std::string& name, const loop::Record& record,
                                        const Tell& warn) {
  const identification::FitOptions options;
  RecordRecommendation priced{.record = name,
                              .indistinguishable = options.thresholds.indistinguishable};
  try {
    priced.laws = identification::CompareSimplerLaws(record, options);
  } catch (const InvalidArgument& error) {
    throw InputError(fmt::format("--record: {}: {}", name, error.what()));
  }
  for (const LawScore& score : priced.laws.scores) {
    const bool has_history = models::FindLimitLaw(score.model) == nullptr;
    const tradeoff::Approximation approximation{score.model, has_history ? "exact" : ""};
    priced.cost.push_back(tradeoff::ModelledCost(
        tradeoff::CountOperations(approximation, score.law, {.displacement = record.displacement}),
        record.size()));
  }
  const auto is_not_told_apart = [&](std::size_t i) { return !priced.laws.scores[i].told_apart; };
  priced.choice = tradeoff::CheapestOf(priced.cost, is_not_told_apart).value_or(priced.laws.best);
  if (!priced.laws.describes_record) {
    warn(fmt::format(
        "{}: none of these laws describes the record: their differences are compared with their "
        "misfit, not with noise; see mindahl fit",
        name));
  }
  return priced;
}

std::string ToText(const RecordRecommendation& priced) {
  std::string text;
  const SimplerLaws& laws = priced.laws;
  text +=
      fmt::format("{}: {} samples, equivalent to {:.0f} independent ones; peak force {:.5g} N\n",
                  priced.record, laws.samples, laws.effective_samples, laws.peak_force);
  text += fmt::format(
      "asked: the cheapest law that the record does not distinguish from the best (dAICc below "
      "{:g})\n\n",
      priced.indistinguishable);
  text += fmt::format("-> {}\n   as options of simulate: {}\n\n", RecordVerdict(priced),
                      OptionsOf(laws.scores[priced.choice]));
  text += fmt::format("  {:<24} {:>9} {:>5} {:>10} {:>10} {:>9} {:>9} {:>9}\n", "", "ns/sample",
                      "free", "rms [N]", "lacks [N]", "dAICc", "2 ln L", "p");
  for (std::size_t i = 0; i < laws.scores.size(); ++i) {
    const LawScore& score = laws.scores[i];
    if (!score.converged) {
      text += fmt::format("  {:<24} {:>9.2f} {:>5}  no fit\n", LawName(score), priced.cost[i],
                          score.free_parameters);
      continue;
    }
    std::string remark = score.told_apart ? "distinguished" : "not distinguished";
    if (i == laws.best) remark = "best";
    if (i == priced.choice) remark += " <- this";
    text +=
        fmt::format("  {:<24} {:>9.2f} {:>5} {:>10.3g} {:>10.2g} {:>9.3g} {:>9.3g} {:>9}  {}\n",
                    LawName(score), priced.cost[i], score.free_parameters, score.rms, score.misfit,
                    score.delta_aicc, score.likelihood_ratio, Chance(score.p_value), remark);
  }
  return text;
}

std::string ToJson(const RecordRecommendation& priced) {
  const SimplerLaws& laws = priced.laws;
  Json json;
  json["schema"] = "mindahl.recommend/1";
  json["version"] = Version();
  json["record"] = {{"file", priced.record},
                    {"samples", laws.samples},
                    {"effective_samples", laws.effective_samples},
                    {"peak_force", laws.peak_force},
                    {"is_described", laws.describes_record}};
  json["indistinguishable"] = priced.indistinguishable;
  json["verdict"] = RecordVerdict(priced);
  json["law_options"] = OptionsOf(laws.scores[priced.choice]);
  json["laws"] = Json::array();
  for (std::size_t i = 0; i < laws.scores.size(); ++i) {
    const LawScore& score = laws.scores[i];
    const bool is_spring = score.model == "spring";
    const bool is_coulomb = score.model == "coulomb";
    const auto if_fitted = [&](double value) {
      return NumberOrNull(score.converged ? std::optional(value) : std::nullopt);
    };
    Json entry;
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
  return Dump(json);
}

}  // namespace mindahl::request
