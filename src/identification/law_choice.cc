#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ranges>
#include <vector>

#include "identification/continued_fit.h"
#include "identification/solved_fit.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::identification {
namespace {

using models::InitialState;
using models::Memory;

/// True if the two laws can have a σ and a Tc of their own: not before the motion turns; σ and Tc
/// that the user holds, or bounds where the fit comes to lie, are of one law only.
bool AreComparable(const FitOptions& options, const ScaledRecords& data, const FitResult& fit) {
  if (fit.law.shape_exponent <= options.thresholds.jenkins_shape) return false;
  // Slip forces that differ are directions that differ in stiffness too of Dahl's own.
  if (fit.Find("asymmetry") != nullptr) return false;
  if (std::ranges::none_of(data.records, &ScaledRecord::Turns)) return false;
  return std::ranges::none_of(std::array{"sigma", "slip_force"}, [&](const char* name) {
    return options.fixed.contains(name) ||
           (options.bounds.contains(name) && fit.Find(name)->is_at_bound());
  });
}

/// Returns what lies before the first turns of records of unknown initial state: they begin under a
/// force or on their later loop, or have no whole stroke and begin elsewhere than at the file's
/// zeros.
/// @param dahl  fit of Dahl's own law
std::vector<SampleRange> UnknownPast(std::span<const loop::RecordView> records,
                                     const FitOptions& options, const ScaledRecords& data,
                                     const FitResult& fit, const FitResult& dahl) {
  constexpr double kUnloaded = 0.05;   // of the half range, or of Tc
  constexpr double kDeviations = 4.0;  // of the noise
  const double noise = std::sqrt(WhiteVariance(fit)) / data.response_unit();
  std::vector<SampleRange> past;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    if (record.reversals.empty()) continue;
    const auto [low, high] = std::ranges::minmax(record.force);
    const double unloaded = std::max(kUnloaded * (high - low) / 2, kDeviations * noise);
    // Whatever forces are added to its own, a virgin contact may be unloaded at the first sample.
    const ParameterEstimate* const origin = dahl.FindOf(dahl.records[r], "displacement_offset");
    // The row of the unloaded contact may be missing: it lies within two samples' travel.
    const std::span<const double> x = records[r].displacement;
    const double elastic = kUnloaded * dahl.law.slip_force / dahl.law.tangential_stiffness;
    const bool begins_unloaded =
        std::abs(record.force.front() - (low + high) / 2) <= unloaded ||
        (dahl.initial_state == InitialState::kVirgin && origin != nullptr &&
         std::abs(x[0] - origin->value) <= std::max(elastic, 2 * std::abs(x[1] - x[0])));
    const bool is_excerpt = record.reversals.size() < 2 ? !record.BeginsAtZeros(options.thresholds)
                                                        : record.BeginsOnLoop();
    if (!begins_unloaded || is_excerpt) past.push_back({r, 0, record.reversals.front()});
  }
  return past;
}

/// Returns the options of a fit of the other law, from the same steady loop. A held α stays.
FitOptions OptionsOfOther(const FitOptions& options, const FitResult& fit, bool load_varies,
                          const models::FrictionModel& other, const models::BranchLaw& law) {
  FitOptions others = options;
  others.model = &other;
  others.start.clear();
  if (fit.Find("alpha")->status == ParameterStatus::kFixed) {
    others.fixed["alpha"] = fit.law.shape_exponent;
  }
  // A fit that determines only a combination of parameters gives no start for the other law, nor
  // does one under a load that varies: no loop of the one law is then one of the other.
  if (load_varies || fit.FindFinding("not_identifiable", "combination") != nullptr) return others;
  StartFrom(fit, others);
  others.start["sigma"] = law.tangential_stiffness;
  others.start["slip_force"] = law.slip_force;
  if (!others.fixed.contains("alpha")) others.start["alpha"] = law.shape_exponent;
  return others;
}

/// Independent samples of a fit: where its residuals repeat in every stroke, those of one.
double IndependentSamples(const ScaledRecords& data, const FitResult& fit,
                          const Thresholds& thresholds) {
  std::vector<double> residual;
  double widening = 1.0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const std::vector<double>& own = fit.records[r].residual;
    residual.insert(residual.end(), own.begin(), own.end());
    widening = std::max(widening, DescribeStructure(data.records[r], own, thresholds).Widening());
  }
  return std::max(EffectiveSamples(data, residual) / widening, 1.0);
}

/// True if all swings of the records are as wide as the widest, but for the steps of an encoder,
/// those to their ends no wider. Then a steady contact of Masing's law and one of Dahl's own run
/// along one curve, each with a σ and a Tc of its own (models/steady_loop.h).
/// @param step  of an encoder [units of the data]
bool HasOneAmplitude(const ScaledRecords& data, double step, const Thresholds& thresholds) {
  double widest = 0.0;
  double narrowest = std::numeric_limits<double>::infinity();
  for (const ScaledRecord& record : data.records) {
    if (record.reversals.empty()) return false;
    const std::vector<Stroke> strokes = StrokesOf(record);
    widest = std::max(widest, std::ranges::max(strokes, {}, &Stroke::length).length);
    for (const Stroke& stroke : std::span(strokes).subspan(1, strokes.size() - 2)) {
      narrowest = std::min(narrowest, stroke.length);
    }
  }
  return widest <= (1 + thresholds.one_amplitude) * narrowest + 2 * step;
}

}  // namespace

std::optional<LawChoice> CompareLaws(std::span<const loop::RecordView> records,
                                     const FitOptions& options, const ScaledRecords& data,
                                     const FitResult& fit) {
  if (!AreComparable(options, data, fit)) return std::nullopt;
  const bool is_masing = fit.model->memory == Memory::kReturnPoint;
  const double amplitude = ContactAmplitude(fit, fit.law, fit.WidestRecord().facts.amplitude);
  LawChoice choice;
  choice.alternative = models::FindFrictionModel(is_masing ? "dahl" : "mindlin-dahl");
  choice.law = is_masing ? models::DahlEquivalent(fit.law, amplitude)
                         : models::MasingEquivalent(fit.law, amplitude);
  FitOptions others =
      OptionsOfOther(options, fit, data.load_varies, *choice.alternative, choice.law);
  // On a steady loop the other law is the same curve; a record that may be virgin is tried as such.
  const bool is_open = !options.initial_state;
  const double step = data.is_forced() ? 0.0 : fit.EncoderStep() / data.length;
  const bool is_one_amplitude =
      !data.load_varies && HasOneAmplitude(data, step, options.thresholds);
  const bool is_one_curve = fit.initial_state == InitialState::kSteady && is_one_amplitude;
  const auto starts_inside = [&](const ScaledRecord& record) {
    return record.StartsInside(options.thresholds.starts_inside);
  };
  if (is_one_curve) {
    if (!is_open || std::ranges::none_of(data.records, starts_inside)) return choice;
    others.initial_state = InitialState::kVirgin;
  }
  if (step > options.thresholds.coarse_step) return choice;
  const FitResult other = FitWithout({}, records, others);
  // At a bound of α, σ or Tc the law turns into another one.
  if (!other.converged || std::ranges::any_of(other.parameters | std::views::take(kSlipForce + 1),
                                              &ParameterEstimate::is_at_bound)) {
    if (!is_one_curve) choice.preferred = fit.model;
    return choice;
  }
  const FitResult& better = other.likelihood_rms < fit.likelihood_rms ? other : fit;
  const Evidence evidence{data.counted, IndependentSamples(data, better, options.thresholds)};
  const auto criterion = [&](const FitResult& of) {
    const double rms = of.likelihood_rms / data.response_unit();
    return evidence.Aicc(static_cast<double>(data.counted) * rms * rms, of.CountFreeParameters());
  };
  double delta = criterion(other) - criterion(fit);
  // If the laws are one curve, a virgin start counts only if it is better.
  const auto is_undecided = [&](double difference) {
    return std::abs(difference) < options.thresholds.undecided;
  };
  if (is_one_curve && (delta > 0 || is_undecided(delta))) return choice;
  choice.law = other.law;
  // Returns the difference of both laws fitted again, without some samples or with one more term.
  const auto refitted = [&](std::span<const SampleRange> held_out,
                            std::string_view term) -> std::optional<double> {
    FitOptions same = options;
    StartFrom(fit, same);
    FitOptions other_same = others;
    if (!term.empty()) {
      same.terms.emplace_back(term);
      other_same.terms.emplace_back(term);
    }
    const FitResult own = FitWithout(held_out, records, std::move(same));
    const FitResult of_other = FitWithout(held_out, records, std::move(other_same));
    if (!own.converged || !of_other.converged) return std::nullopt;
    return criterion(of_other) - criterion(own);
  };
  // Under cycles of one amplitude the laws differ only in a transient, which a drift resembles: if
  // the residuals show one, the other law must also fit better with that term in both fits.
  const auto drift = std::ranges::find_if(fit.adequacy.causes, [](const Cause& cause) {
    return cause.term == "force_drift" || cause.term == "slip_trend";
  });
  if (drift != fit.adequacy.causes.end() && !is_undecided(delta) && delta < 0) {
    delta = std::max(delta, refitted({}, drift->term).value_or(delta));
  }
  // Dahl's own law can start from any force, Masing's only from reversals that may not be recorded:
  // the first branch of an excerpt is no evidence for Dahl's, unless a whole stroke follows it and
  // the loop is short of slip, where no such reversals give Masing's contact the loop of Dahl's,
  // and Dahl's leaves but noise.
  const bool is_for_dahl = !is_undecided(delta) && (delta > 0) != is_masing;
  const FitResult& masing = is_masing ? fit : other;
  const FitResult& dahl = is_masing ? other : fit;
  std::vector<SampleRange> past;
  if (is_open && is_for_dahl) past = UnknownPast(records, options, data, fit, dahl);
  bool is_told = true;
  if (!past.empty() && is_one_amplitude) {
    const auto leaves_more = [&](const FitResult& of) {
      return of.rms > options.thresholds.larger_rms * std::sqrt(WhiteVariance(of));
    };
    is_told = fit.WidestRecord().reversals.size() > 1 &&
              !loop::HasSlipped(fit.WidestRecord().facts) && leaves_more(masing) &&
              !leaves_more(dahl);
  } else if (!past.empty()) {
    const std::optional<double> without = refitted(past, "");
    if (!without) return choice;
    delta = *without;
  }
  choice.delta_aicc = delta;
  if (is_told && !is_undecided(delta)) {
    choice.preferred = delta > 0 ? fit.model : choice.alternative;
  }
  return choice;
}

}  // namespace mindahl::identification
