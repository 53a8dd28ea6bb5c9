#include "identification/diagnosis/diagnosis.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/probability.h"
#include "loop/statistics.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::identification {
namespace {

/// Finds something in each record, and adds the record's number where there are several.
template <typename Records, typename Find>
std::vector<Finding> FindInEach(const Records& records, Find find) {
  std::vector<Finding> findings;
  for (std::size_t r = 0; r < records.size(); ++r) {
    for (Finding& finding : find(records[r])) {
      if (records.size() > 1) finding.numbers.emplace_back("record", static_cast<double>(r + 1));
      findings.push_back(std::move(finding));
    }
  }
  return findings;
}

/// True if a spring parallel to the contact is fitted to a loop that leaves Tc open above: far from
/// slip a force σx − cx² has the same loop with less of σ and a spring for the rest.
bool HidesInSpring(const FitResult& result) {
  const ParameterEstimate* spring = result.Find("plateau_slope");
  const ParameterEstimate& slip_force = *result.Find("slip_force");
  return spring != nullptr && spring->status != ParameterStatus::kFixed &&
         slip_force.status != ParameterStatus::kFixed && !slip_force.upper95;
}

/// True if a record of two strokes ends where it began, in both channels: one closed cycle.
bool IsOneCycle(const ScaledRecord& record, const Thresholds& thresholds) {
  const auto returns = [&](std::span<const double> values) {
    const auto [lowest, highest] = std::ranges::minmax(values);
    return std::abs(values.back() - values.front()) <= thresholds.one_cycle * (highest - lowest);
  };
  return record.reversals.size() == 1 && returns(record.displacement) && returns(record.force);
}

/// Contacts whose history before the record is not known:
/// - a Masing fit short of slip that puts the unloaded position near a stroke's end and far from
///   the first sample: the first branch, then probably from an unrecorded reversal, is the virgin
///   curve scaled by two;
/// - records that turn less than twice and do not start where the contact is unloaded.
std::vector<Finding> FindUnknownPast(const Estimates& fitted, const FitResult& result) {
  constexpr double kNearEnd = 0.2;  // [half range]
  constexpr double kFar = 0.5;
  const Problem& problem = fitted.problem();
  const Thresholds& thresholds = fitted.thresholds();
  const bool is_virgin_masing = problem.is_virgin() && problem.is_masing();
  bool is_told = false;  // by one record
  bool is_cut = true;    // every record begins inside a stroke: none shows the slope at rest
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const ScaledRecord& record = problem.data->records[r];
    const std::size_t origin = problem.parameters.PositionOfOrigin(r);
    const double unloaded = fitted.solution().theta[origin];
    const auto [lowest, highest] = std::ranges::minmax(record.excitation());
    const double half = (highest - lowest) / 2;
    const double inside = std::min(unloaded - lowest, highest - unloaded);
    const double front = record.excitation().front();
    const double away = std::abs(front - unloaded);
    if (is_virgin_masing && inside < kNearEnd * half && away > kFar * half &&
        !loop::HasSlipped(result.records[r].facts)) {
      return {{.code = "unknown_past", .parameters = {"alpha", "slip_force"}, .kind = "elsewhere"}};
    }
    const bool starts_unloaded = problem.is_virgin() && !problem.parameters[origin].assumed &&
                                 away <= thresholds.starts_unloaded * half;
    is_told =
        is_told || record.CountTurns() >= 2 || IsOneCycle(record, thresholds) || starts_unloaded;
    is_cut = is_cut &&
             (problem.parameters[origin].assumed || record.StartsInside(thresholds.starts_inside));
  }
  if (is_told) return {};
  Finding finding{.code = "unknown_past", .parameters = {"alpha", "slip_force"}, .kind = "cut"};
  if (is_cut) finding.parameters.insert(finding.parameters.begin(), "sigma");
  return {finding};
}

/// An asymmetry of a contact that had been cycled before the records, and does not slip as a whole
/// in every one of those whose force has a known zero.
std::vector<Finding> FindUntoldAsymmetry(const FitResult& result, const Thresholds& thresholds) {
  const ParameterEstimate* asymmetry = result.Find("asymmetry");
  const bool is_asked = asymmetry != nullptr && asymmetry->status != ParameterStatus::kFixed &&
                        result.initial_state == models::InitialState::kSteady &&
                        result.model->memory != models::Memory::kNone;
  if (!is_asked) return {};
  for (const RecordFit& record : result.records) {
    const ParameterEstimate* zero = result.FindOf(record, "force_offset");
    const bool is_known = zero == nullptr || zero->status == ParameterStatus::kFixed;
    const models::BranchLaw law = result.LawOf(record);
    const double amplitude = ContactAmplitude(result, law, record.facts.amplitude);
    const double peak_force = models::SteadyPeakForce(*result.model, law, amplitude);
    if (!is_known || peak_force >= (1 - thresholds.never_slips) * law.slip_force) continue;
    return {{.code = "not_identifiable", .parameters = {"asymmetry"}, .kind = "below_slip"}};
  }
  return {};
}

/// A force that stands at its largest or least reading in a twentieth of the samples, though it has
/// noise, the law leaves some, and no other reading repeats: at its sensor's limit.
std::vector<Finding> FindForceAtLimit(const loop::PreparedRecords& records,
                                      const FitResult& result) {
  constexpr double kOften = 0.05;  // of the samples
  constexpr double kLeast = 4;     // samples
  constexpr double kNoise = 1e-4;  // of the range: what is computed repeats its slip force
  if (!(result.rms > kNoise * result.PeakForce())) return {};
  for (const loop::PreparedRecord& record : records.records) {
    const std::span<const double> force = record.record.force;
    const auto [lowest, highest] = std::ranges::minmax(force);
    const auto count = static_cast<double>(force.size());
    for (const double limit : {highest, lowest}) {
      const auto at_limit = static_cast<double>(std::ranges::count(force, limit));
      if (at_limit < std::max(kLeast, kOften * count)) continue;
      std::vector<double> others(force.begin(), force.end());
      std::erase_if(others, [&](double at) { return at == lowest || at == highest; });
      const bool is_noisy =
          others.size() > 8 && loop::NoiseByDifferences(others, 4) > kNoise * (highest - lowest);
      std::ranges::sort(others);
      const std::size_t repeated = std::ranges::unique(others).size();
      if (!is_noisy || 2 * repeated > others.size()) continue;
      return {{.code = "force_at_limit",
               .parameters = {"alpha", "slip_force"},
               .numbers = {{"limit", limit}, {"share", at_limit / count}}}};
    }
  }
  return {};
}

/// Samples at few places of the loop, however many they are: no cycle shows what lies between them,
/// nor where it turned.
std::vector<Finding> FindFewPlaces(const Problem& problem, const Thresholds& thresholds) {
  std::size_t places = 0;
  for (const ScaledRecord& record : problem.data->records) {
    const std::span<const double> excitation = record.excitation();
    const std::vector<double> direction = DirectionsOf(record);
    std::array<std::vector<double>, 2> ways;  // down, up
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (record.counts[i] == 0) continue;
      ways[direction[i] > 0 ? 1 : 0].push_back(excitation[i]);
    }
    for (std::vector<double>& way : ways) {
      std::ranges::sort(way);
      const auto are_same = [&](double last, double next) {
        return next - last <= thresholds.same_place;
      };
      places += way.size() - std::ranges::unique(way, are_same).size();
    }
  }
  if (static_cast<double>(places) >= thresholds.fewest_places) return {};
  Finding finding{.code = "not_identifiable",
                  .numbers = {{"places", static_cast<double>(places)}},
                  .kind = "few_places"};
  for (const std::size_t p : {kStiffness, kShape}) {  // unless a prior says more
    if (problem.parameters[p].is_open()) finding.parameters.push_back(problem.parameters.NameOf(p));
  }
  if (finding.parameters.empty()) return {};
  return {finding};
}

/// Parameters whose prior lies far from the records' own estimate; where the model does not
/// describe the records, also those that the user holds elsewhere. The distance is that of a step
/// to first order without that knowledge, over its standard deviation.
std::vector<Finding> FindContradicted(const Estimates& fitted, const FitResult& result) {
  const FitOptions& options = fitted.options();
  const bool is_described = result.adequacy.verdict == AdequacyVerdict::kAdequate;
  if (options.priors.empty() && (options.fixed.empty() || is_described)) return {};
  const Problem& problem = fitted.problem();
  const std::vector<double>& theta = fitted.solution().theta;
  const std::vector<std::size_t>& free = problem.parameters.free();
  const Linearization at = fitted.WithPriors();
  Eigen::Index row = fitted.linearization().residual.size() - 1;
  std::vector<Finding> findings;
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    const Parameter& parameter = problem.parameters[p];
    const std::string name = problem.parameters.NameOf(p);
    const bool is_held = parameter.fixed && !is_described && options.fixed.contains(name);
    if (!is_held && (parameter.fixed || !parameter.has_prior())) continue;
    Eigen::VectorXd own = Response(problem).LinearizeAt(theta, {&p, 1}).jacobian.col(0);
    own.conservativeResizeLike(Eigen::VectorXd::Zero(at.residual.size()));
    Eigen::MatrixXd others = at.jacobian;
    double off = 0.0;
    double uncertainty = 0.0;
    if (!is_held) {
      others.row(++row).setZero();
      others.col(std::ranges::find(free, p) - free.begin()).setZero();
      off = theta[p] - parameter.prior_theta;
      uncertainty = problem.data->prior_noise / parameter.prior_root_weight;
    }
    // The columns of the other parameters are projected out.
    if (others.cols() > 0) own -= others * others.colPivHouseholderQr().solve(own);
    const double information = own.squaredNorm();
    const double step = -own.dot(at.residual) / information;
    const Eigen::VectorXd left = at.residual + own * step;
    const double effective = EffectiveSamples(*problem.data, {left.data(), problem.size()});
    const double error = left.norm() / std::sqrt(effective * information);
    const double distance = std::abs(off + step) / std::hypot(error, uncertainty);
    if (!(distance > options.thresholds.prior_distance)) continue;
    findings.push_back({.code = "prior_contradicted",
                        .parameters = {name},
                        .numbers = {{"distance", distance}},
                        .kind = is_held ? "held" : ""});
  }
  return findings;
}

}  // namespace

std::vector<Finding> FindInRecords(std::span<const RecordFit> records) {
  return FindInEach(records, [](const RecordFit& record) {
    std::vector<Finding> findings;
    // Counted as the report does, after smoothing.
    const auto count = static_cast<double>(record.reversals.size());
    if (!record.gate.certain) {
      findings.push_back({.code = "reversals_uncertain",
                          .numbers = {{"count", count}, {"gate", record.gate.gate}}});
    }
    if (!record.facts.closed) findings.push_back({.code = "no_closed_cycle"});
    return findings;
  });
}

std::vector<Finding> FindMissingRows(std::span<const loop::PreparedRecord> records) {
  constexpr double kLong = 0.25;   // of a cycle: where it turned may not be seen
  constexpr double kMeans = 10.0;  // of the times between rows
  constexpr double kAway = 5.0;    // steps of the displacement: a pause goes on where it began
  return FindInEach(records, [](const loop::PreparedRecord& prepared) -> std::vector<Finding> {
    const loop::RecordView& record = prepared.record;
    if (record.time.size() < 2) return {};
    const Eigen::Index steps = std::ssize(record.time) - 1;
    const Eigen::Map<const Eigen::ArrayXd> time(record.time.data(), steps + 1);
    const Eigen::Map<const Eigen::ArrayXd> displacement(record.displacement.data(), steps + 1);
    const Eigen::ArrayXd ways = (displacement.tail(steps) - displacement.head(steps)).abs();
    Eigen::Index widest = 0;
    const double gap = (time.tail(steps) - time.head(steps)).maxCoeff(&widest);
    const double rest = time[steps] - time[0] - gap;
    const auto others = static_cast<double>(steps - 1);
    const double strokes = static_cast<double>(prepared.reversals.size()) + 1;
    const bool is_gap = gap > kLong * 2 * rest / strokes && gap * others > kMeans * rest &&
                        ways[widest] * others > kAway * (ways.sum() - ways[widest]);
    if (!is_gap) return {};
    return {{.code = "rows_missing", .numbers = {{"gap", gap}, {"from", time[widest]}}}};
  });
}

std::vector<Finding> FindVaryingLoads(const ScaledRecords& data) {
  return FindInEach(data.records, [](const ScaledRecord& record) -> std::vector<Finding> {
    const bool is_followed = !record.load_ratio.empty();
    const std::vector<double>& load = is_followed ? record.load_ratio : record.load_change;
    if (load.empty()) return {};
    std::vector<double> counted;
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (record.counts[i] != 0) counted.push_back(load[i]);
    }
    const Eigen::Map<const Eigen::ArrayXd> of(counted.data(), std::ssize(counted));
    // The mean of a load of either sign differs from that of its magnitude.
    const double variation = std::sqrt(2 * (of - of.mean()).square().mean());
    return {{.code = "load_varies",
             .severity = is_followed ? Severity::kNote : Severity::kWarning,
             .numbers = {{"variation", variation}},
             .kind = is_followed ? "followed" : "not_followed"}};
  });
}

std::vector<Finding> FindUndetermined(const Estimates& fitted) {
  if (fitted.open_directions() == 0) return {};
  std::vector<std::string> names;
  const Parameters& parameters = fitted.problem().parameters;
  for (const std::size_t p : parameters.free()) {
    if (std::isinf(fitted.ErrorOfTheta(p))) names.push_back(parameters.NameOf(p));
  }
  // With as many directions as names, each parameter is undetermined by itself.
  const bool are_alone = fitted.open_directions() >= names.size();
  return {{.code = "not_identifiable",
           .parameters = std::move(names),
           .kind = are_alone ? "without_effect" : "combination"}};
}

std::vector<Finding> FindOpenSlipForce(const FitResult& result) {
  std::vector<Finding> findings;
  const ParameterEstimate& slip_force = *result.Find("slip_force");
  if (!slip_force.lower95 || slip_force.upper95) return findings;
  findings.push_back({.code = "bounded_below",
                      .parameters = {"slip_force"},
                      .kind = loop::Slides(result.WidestRecord().facts) ? "slides" : ""});
  if (result.Find("alpha")->status != ParameterStatus::kFixed) {
    findings.push_back({.code = "not_identifiable",
                        .parameters = {"alpha"},
                        .kind = HidesInSpring(result) ? "with_spring" : "with_slip_force"});
  }
  return findings;
}

std::vector<Finding> FindWideIntervals(const FitResult& result, const Thresholds& thresholds) {
  std::vector<Finding> findings;
  // The verdict is that of a 95 % interval; the model discrepancy does not scale with confidence.
  const double quantiles = StudentQuantile(result.degrees_of_freedom, 0.95) /
                           StudentQuantile(result.degrees_of_freedom, result.confidence);
  const bool hides = HidesInSpring(result);
  for (const std::string_view name : {"sigma", "alpha", "slip_force"}) {
    const ParameterEstimate& estimate = *result.Find(name);
    if (!estimate.lower95 || !estimate.upper95) continue;
    const double lower = *estimate.lower95;
    const double upper = *estimate.upper95;
    const double to_95 = estimate.includes_discrepancy ? 1.0 : quantiles;
    // Beside a spring the value may be at the lower end: the ratio is then that of an interval as
    // wide on its other side.
    const double ratio = hides
                             ? std::pow(std::max(upper / estimate.value, estimate.value / lower), 2)
                             : upper / lower;
    const bool wide =
        name == "alpha"
            ? to_95 * (upper - lower) > thresholds.widest_shape * std::max(1.0, estimate.value)
            : !(lower > 0) || std::pow(ratio, to_95) > thresholds.widest_ratio;
    const bool is_said = std::ranges::any_of(result.findings, [&](const Finding& finding) {
      return finding.code.row().verdict == Identifiability::kNotIdentifiable &&
             std::ranges::count(finding.parameters, name) > 0;
    });
    if (!wide || is_said) continue;
    findings.push_back({.code = "not_identifiable",
                        .parameters = {std::string(name)},
                        .numbers = {{"lower", lower}, {"upper", upper}},
                        .kind = hides ? "with_spring" : "wide"});
    if (hides) findings.back().parameters.emplace_back("plateau_slope");
  }
  return findings;
}

std::vector<Finding> FindSearchLimit(const Problem& problem, const Solution& solution) {
  const Parameters& parameters = problem.parameters;
  for (const std::size_t p : parameters.free()) {
    const BoundSide side = SideOf(parameters[p], solution.theta[p]);
    if (parameters[p].term->positive || p == kShape || !IsSearchLimit(parameters[p], side)) {
      continue;
    }
    Finding finding{.code = "search_limit", .parameters = {parameters.NameOf(p)}};
    for (const std::size_t law : {kStiffness, kShape, kSlipForce}) {
      if (!parameters[law].fixed) finding.parameters.push_back(parameters.NameOf(law));
    }
    return {finding};
  }
  return {};
}

std::vector<Finding> FindOnParameters(const Estimates& fitted, const loop::PreparedRecords& records,
                                      const FitResult& result) {
  const Problem& problem = fitted.problem();
  const Thresholds& thresholds = fitted.thresholds();
  std::vector<Finding> findings;
  if (result.depth >= Depth::kIntervals) {
    if (!fitted.options().initial_state) Append(findings, FindUnknownPast(fitted, result));
    Append(findings, FindFewPlaces(problem, thresholds));
    if (!problem.data->is_forced()) Append(findings, FindForceAtLimit(records, result));
  }
  Append(findings, FindUntoldAsymmetry(result, thresholds));
  Append(findings, FindContradicted(fitted, result));
  Append(findings, FindOpenSlipForce(result));
  return findings;
}

std::vector<Finding> FindOtherLaw(const std::optional<LawChoice>& choice) {
  if (!choice || (choice->decided() && !choice->prefers_alternative())) return {};
  const bool is_better = choice->prefers_alternative();
  return {{.code = "other_law",
           .severity = is_better ? Severity::kWarning : Severity::kNote,
           .parameters = {"sigma", "slip_force"},
           .kind = is_better ? "better" : "undecided"}};
}

}  // namespace mindahl::identification
