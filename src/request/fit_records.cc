#include <algorithm>
#include <optional>
#include <span>
#include <tuple>

#include "core/refuse.h"
#include "loop/statistics.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/model_comparison.h"
#include "mindahl/identification/term_selection.h"
#include "mindahl/identification/terms.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/disturbances.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/loop/segments.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::request {

using identification::AdequacyVerdict;
using identification::FitOptions;
using identification::FitResult;
using identification::Identifiability;
using identification::ParameterEstimate;
using identification::ParameterStatus;
using identification::TermSelection;
using io::RecordFile;
using loop::Record;

namespace {

/// Cuts each record to its test, where that is asked for and nothing says which samples count.
/// @param options  changed: a contact that was cycled before is steady
/// @param input  changed: gets the samples that are cut off as left out
void KeepTests(const FitRequest& request, FitOptions& options, report::ReportInput& input) {
  const loop::PreparationOptions& given = options.preparation;
  const bool is_chosen = given.load_window || given.samples || given.cycles;
  if (!request.trim || is_chosen || options.response() != loop::Channel::kForce) return;
  bool all_cycled = true;
  for (RecordFile& record : input.records) {
    const loop::TestPart test = loop::FindTestPart(record.record);
    const auto leave_out = [&](std::string_view reason, std::size_t first, std::size_t last) {
      if (reason.empty()) return;
      input.left_out.push_back({.file = record.name,
                                .samples = last - first,
                                .first = record.LineOf(first),
                                .last = record.LineOf(last - 1),
                                .why = std::string(reason)});
    };
    leave_out(test.before, 0, test.first);
    leave_out(test.after, test.last, record.record.size());
    io::KeepSamples(record, test.first, test.last);
    all_cycled = all_cycled && test.begins_cycled;
  }
  if (all_cycled && !options.initial_state) options.initial_state = models::InitialState::kSteady;
}

/// Notes each file whose column of the normal load has another mean than the load that is given.
void NoteOtherLoads(const FitOptions& options, report::ReportInput& input) {
  const std::vector<double>& given = options.normal_loads;
  for (std::size_t r = 0; r < input.records.size() && !given.empty(); ++r) {
    const RecordFile& file = input.records[r];
    const double taken = given[std::min(r, given.size() - 1)];
    const double mean =
        file.record.normal_load.empty() ? taken : loop::Mean(file.record.normal_load);
    if (std::abs(mean / taken - 1) <= options.thresholds.load_change) continue;
    input.notes.push_back(
        fmt::format("{}: the mean load is {:.6g} N as given, not {:.6g} N as in its column",
                    file.name, taken, mean));
  }
}

/// Takes back a preference for the law that the program did not choose; true if there was one.
bool WithdrawPreference(FitResult& fit) {
  if (!fit.prefers_other_law()) return false;
  fit.law_choice->preferred = nullptr;
  fit.law_choice->delta_aicc.reset();
  std::erase_if(fit.findings,
                [](const identification::Finding& finding) { return finding.code == "other_law"; });
  return true;
}

/// Fits by the model of the options; if it is to be chosen, by Dahl's own law where that is better.
TermSelection FitByLaw(bool chooses, const FitOptions& options, std::span<const Record> records) {
  TermSelection asked{.options = options, .fit = identification::Fit(records, options)};
  if (chooses && asked.fit.prefers_other_law()) {
    FitOptions of_other = options;
    of_other.model = models::FindFrictionModel("dahl");
    FitResult other = identification::Fit(records, of_other);
    const auto& choice = other.law_choice;
    const bool is_preferred = !choice || (choice->decided() && !choice->prefers_alternative());
    if (other.converged && is_preferred) {
      asked.options = std::move(of_other);
      asked.fit = std::move(other);
    }
    // If each law fits better than the solution that was found for the other, neither is preferred.
    WithdrawPreference(asked.fit);
  }
  return asked;
}

/// Makes the requested fit. With `--model auto` the law is chosen without an asymmetry, beside
/// which laws are not compared, and again with terms that are chosen.
TermSelection FitAsked(const FitRequest& request, FitOptions options,
                       std::span<const Record> records) {
  const bool chooses_law = request.fit.model == nullptr;
  FitOptions symmetric = options;
  std::size_t of_asymmetry = std::erase(symmetric.terms, "asymmetry");
  const auto erase = [&](auto&... of) { of_asymmetry += (of.erase("asymmetry") + ...); };
  erase(symmetric.fixed, symmetric.priors, symmetric.start, symmetric.bounds);
  if (chooses_law && of_asymmetry > 0) {
    options.model = FitByLaw(true, symmetric, records).options.model;
  }
  TermSelection asked = FitByLaw(chooses_law, options, records);
  if (!request.chooses_terms) return asked;
  const std::vector<loop::RecordView> views(records.begin(), records.end());
  asked = identification::SelectTerms(views, asked.options, std::move(asked.fit));
  // A force in addition to the contact's may have decided the law: it is Dahl's own where this is
  // adequate with one or two terms, and Masing's is not, or less likely, or requires more.
  const auto is_adequate = [](const TermSelection& of) {
    return of.fit.adequacy.verdict == AdequacyVerdict::kAdequate;
  };
  const auto* const dahl = models::FindFrictionModel("dahl");
  const bool is_comparable = of_asymmetry == 0 && !asked.fit.WidestRecord().load_varies &&
                             !options.fixed.contains("sigma") &&
                             !options.fixed.contains("slip_force");
  if (chooses_law && is_comparable && asked.options.model != dahl &&
      (!is_adequate(asked) || asked.fit.prefers_other_law() || asked.added.size() > 1)) {
    options.model = dahl;
    TermSelection of_dahl = identification::SelectTerms(
        views, options, identification::Fit(records, options), identification::MostTerms::kTwo);
    const bool is_better = !is_adequate(asked) || asked.fit.prefers_other_law() ||
                           of_dahl.added.size() < asked.added.size();
    if (is_adequate(of_dahl) && is_better) asked = std::move(of_dahl);
  }
  // The answer does not mention the other law: it was not fitted with terms that it requires.
  if (chooses_law && WithdrawPreference(asked.fit)) asked.fit.law_choice.reset();
  return asked;
}

/// True if a term takes the slip force's place: it is known no more, or leaves what its interval
/// said; of a column that makes a part of the half gap, not even most of that is left.
bool LosesSlipForce(const FitResult& before, const FitResult& after, const FitOptions& tried) {
  const identification::ParameterEstimate& was = *before.Find("slip_force");
  const identification::ParameterEstimate& is = *after.Find("slip_force");
  if (was.is_known() && !is.is_known()) return true;
  // A force of the velocity belongs to the half gap, and so to the interval that the law alone has.
  const bool is_of_time = std::ranges::any_of(tried.terms, [](const std::string& term) {
    return identification::FindTerm(term)->needs_time;
  });
  if (is_of_time && after.adequacy.verdict == AdequacyVerdict::kAdequate) return false;
  const std::optional<double>& half_gap = after.WidestRecord().facts.half_gap;
  if (!tried.covariates.empty() && half_gap) {
    return !is.is_known() || is.value < tried.thresholds.rival * std::abs(*half_gap);
  }
  return is.value < was.lower95.value_or(0.0) || is.value > was.upper95.value_or(is.value);
}

/// True if a cause that no term describes explains clearly more than a term does; or as much, where
/// the term seems to describe the record: its values would be quoted, and may be wrong.
bool IsRivalled(const FitResult& before, const FitResult& after) {
  constexpr double kClearly = 1.2;
  const bool is_adequate = after.adequacy.verdict == AdequacyVerdict::kAdequate;
  const double explained = 1 - std::pow(after.rms / before.rms, 2);
  return std::ranges::any_of(before.adequacy.causes, [&](const identification::Cause& cause) {
    return cause.term.empty() && cause.explains >= (is_adequate ? 1.0 : kClearly) * explained;
  });
}

/// Says where half gaps of files that slide are not in proportion to their loads: a load series has
/// one μ, and what the law then misses is no term's.
std::optional<identification::Finding> FindDisproportion(const FitResult& fit) {
  constexpr double kLeastSpread = 0.05;
  if (!fit.is_load_series() || fit.adequacy.verdict == AdequacyVerdict::kAdequate) return {};
  std::vector<double> ratios;
  for (const identification::RecordFit& record : fit.records) {
    if (!loop::Slides(record.facts)) return {};
    ratios.push_back(*record.facts.half_gap / *record.normal_load);
  }
  const auto [least, most] = std::ranges::minmax(ratios);
  if (!(most > (1 + kLeastSpread) * least)) return {};
  return identification::Finding{.code = "load_varies",
                                 .numbers = {{"least", least}, {"most", most}},
                                 .kind = "not_proportional"};
}

/// Adds a term, named as by LikelyTerms(), to the options, and what a user does for it to the step.
void AddTerm(const std::string& name, const Record& record, FitOptions& options,
             report::NextStep& step) {
  if (const auto* group = identification::FindTermGroup(name)) {
    for (const std::string_view term : group->terms) {
      if (!options.fixed.contains(std::string(term))) options.terms.emplace_back(term);
    }
    step.text = group->meaning;
    step.options = name == "rig_stiffness" ? "--rig-stiffness fit" : "--terms " + name;
    return;
  }
  const std::string& column =
      std::ranges::find(record.covariates, name, [](const loop::Covariate& covariate) {
        return identification::NameOfCovariate(covariate.name);
      })->name;
  options.covariates = {column};
  step.text = "column " + column;
  const char* const quote = column.find(' ') == std::string::npos ? "" : "'";
  step.options = fmt::format("--covariate {}{}{}", quote, column, quote);
}

/// Fits with the options of a step, as the user will who gives them.
/// @returns false where the record does not determine it, or the options are not those of its fit
bool TryFit(const FitRequest& request, std::span<const Record> records, const FitOptions& tried,
            FitResult& found) {
  try {
    found = FitAsked(request, tried, records).fit;
  } catch (const InvalidArgument&) {
    return false;
  }
  return found.converged;
}

/// Fits the displacement in place of the force where an encoder reads it in few steps, and returns
/// that where it leaves no more than these and flicker of a count: they are then the noise.
std::optional<report::NextStep> TryNoiseInDisplacement(const FitRequest& request,
                                                       std::span<const Record> records,
                                                       const FitResult& fit, FitResult& found) {
  FitOptions tried = MakeFitOptions(request);
  tried.preparation.excitation = loop::Channel::kForce;
  constexpr double kOfSteps = 0.6;  // √(1/12 + 1/4) of one
  if (!TryFit(request, records, tried, found) ||
      found.adequacy.verdict != AdequacyVerdict::kAdequate ||
      found.rms > kOfSteps * found.EncoderStep()) {
    return std::nullopt;
  }
  return report::NextStep{.text = "steps of the displacement as its noise",
                          .options = "--noise-in displacement",
                          .misfit_before = *fit.adequacy.misfit_over_half_gap,
                          .misfit_after = found.adequacy.misfit / found.MisfitScale(),
                          .is_over_amplitude = true};
}

/// Fits the record again with the term that explains most of what the law misses, where the law
/// alone is not adequate; with the next one where it does not gain enough, or the slip force is
/// lost.
/// @param is_cut  are the records parts of their files? A fit of the displacement reads these whole
/// @param found   written: the fit of the step
std::optional<report::NextStep> FindNextStep(const FitRequest& request, const FitOptions& options,
                                             std::span<const Record> records, bool is_cut,
                                             const FitResult& fit, FitResult& found) {
  constexpr std::size_t kMostTried = 3;
  constexpr double kLeastMisfit = 1e-4;  // that the answer tells from none
  const std::optional<double> before = fit.adequacy.misfit_over_half_gap;
  if (!fit.converged || !(before > kLeastMisfit) || fit.prefers_other_law() ||
      fit.adequacy.verdict == AdequacyVerdict::kAdequate ||
      fit.FindFinding("force_at_limit") != nullptr || fit.FindFinding("rows_missing") != nullptr ||
      fit.FindFinding("prior_contradicted") != nullptr ||
      fit.FindFinding("model_inadequate", "no_loop") != nullptr) {
    return std::nullopt;
  }
  if (fit.EncoderStep() > options.thresholds.coarse_step * fit.WidestRecord().facts.amplitude) {
    if (is_cut) return std::nullopt;
    return TryNoiseInDisplacement(request, records, fit, found);
  }
  const std::vector<loop::RecordView> views(records.begin(), records.end());
  FitOptions fitted = options;
  fitted.model = fit.model;
  for (const std::string& name : identification::LikelyTerms(views, fitted, fit, kMostTried)) {
    FitOptions tried = options;
    report::NextStep step;
    AddTerm(name, records.front(), tried, step);
    if (!TryFit(request, records, tried, found)) continue;
    const std::optional<double> after = found.adequacy.misfit_over_half_gap;
    if (!after || *after > (1 - options.thresholds.advised_gain) * *before) continue;
    const bool changes_law =
        fit.law_choice && fit.law_choice->preferred == fit.model && found.model != fit.model;
    if (changes_law || LosesSlipForce(fit, found, tried)) continue;
    // A rig that cannot be told from the law is to be measured.
    const bool is_confounded =
        name == "rig_stiffness" && fit.FindFinding("shape_or_rig") != nullptr;
    if (is_confounded || IsRivalled(fit, found)) return std::nullopt;
    step.misfit_before = *before;
    step.misfit_after = *after;
    for (const auto& record : found.records) step.fitted_force.push_back(record.fitted_force);
    return step;
  }
  return std::nullopt;
}

}  // namespace

std::string ChooseTermsOfCycles(const FitRequest& request, const loop::RecordView& head,
                                FitOptions& options) {
  if (!request.chooses_terms) return "";
  FitOptions of_head = options;
  // The head is fitted like its cycles: an asymmetry is then an offset of each.
  of_head.initial_state = models::InitialState::kSteady;
  const TermSelection selection =
      identification::SelectTerms({&head, 1}, of_head, identification::Fitter(of_head).Fit(head));
  options.terms = selection.options.terms;
  if (selection.added.empty()) return "terms: the first cycles require none";
  return fmt::format("terms fitted to all cycles, as the first cycles require: {}",
                     fmt::join(selection.added, ", "));
}

std::string WhyNotEstablished(const FitResult& fit, Strictness strictness) {
  if (!fit.converged) return fit.solver.message;
  if (strictness == Strictness::kNone) return "";
  const bool is_strict = strictness == Strictness::kAdequate;
  const AdequacyVerdict verdict = fit.adequacy.verdict;
  if (is_strict ? verdict != AdequacyVerdict::kAdequate : verdict == AdequacyVerdict::kInadequate) {
    return "not established: the model is not adequate";
  }
  for (const ParameterEstimate& estimate : fit.parameters) {
    const bool suffices = estimate.status == ParameterStatus::kFixed ||
                          (is_strict ? estimate.identifiability == Identifiability::kIdentifiable
                                     : estimate.is_known());
    if (!suffices) return fmt::format("not established: {} is not identifiable", estimate.name);
  }
  return "";
}

std::string ExplainColumnFault(const FitRequest& request, const std::string& fault) {
  for (const std::string& name : request.terms) {
    if (fault.find(fmt::format("covariate {}:", name)) == std::string::npos) continue;
    return fmt::format("--terms: '{}' is no term, so it is taken for a column: {}", name, fault);
  }
  return fault;
}

void RequireLoops(const std::vector<RecordFile>& inputs) {
  const RecordFile& first = inputs.front();
  const report::Units units = report::UnitsOf(first.is_torsional);
  for (const RecordFile& input : inputs) {
    if (input.is_torsional != first.is_torsional) {
      Refuse("of {} and {} one holds a force, one a torque: fit them apart", first.name,
             input.name);
    }
    const Record& record = input.record;
    for (const auto& [what, column, values, unit] :
         {std::tuple("displacement", &input.displacement, &record.displacement, units.displacement),
          {"force", &input.force, &record.force, units.force},
          {"time", &input.time, &record.time, "s"}}) {
      if (values->empty() || !*column) continue;
      const auto [least, greatest] = std::ranges::minmax_element(*values);
      const double half = *greatest / 2 - *least / 2;
      const auto widest = std::abs(*least) > std::abs(*greatest) ? least : greatest;
      const auto row = static_cast<std::size_t>((half == 0 ? least : widest) - values->begin());
      const std::string at = fmt::format("{}:{}:{}", input.name, input.LineOf(row), column->index);
      if (half == 0) {
        Refuse(
            "{}: the {} never changes, it is {} {} in every row: choose another column with --{}",
            at, what, *least, unit, what);
      }
      if (half >= 1e-100 && half <= 1e100) continue;
      Refuse(
          "{}: half the range of the {} is {} {}: must lie between 1e-100 and 1e100: choose other "
          "units",
          at, what, half, unit);
    }
  }
}

std::vector<RecordFile> ReadRecords(const FitRequest& request) {
  io::RecordColumns columns = request.columns;
  columns.covariates = MakeFitOptions(request).covariates;
  std::vector<RecordFile> inputs;
  for (const std::string& file : request.files) {
    try {
      inputs.push_back(io::ReadRecord(file, columns));
    } catch (const InputError& error) {
      throw InputError(ExplainColumnFault(request, error.what()));
    }
  }
  return inputs;
}

report::Report FitRecords(const FitRequest& request, std::vector<RecordFile> inputs) {
  if (inputs.empty()) Refuse("a fit needs a record: give one");
  FitOptions options = MakeFitOptions(request);
  if (const auto& window = request.time_window) {
    for (RecordFile& input : inputs) io::KeepTimeWindow(input, window->lower, window->upper);
  }
  Validate(request.contact, inputs.size());
  if (inputs.front().is_torsional && IsAnythingGiven(request.contact)) {
    Refuse(
        "--normal-load and other options that describe a contact do not apply to a torque against "
        "an angle: leave them out");
  }
  RequireLoops(inputs);
  report::ReportInput made{.records = std::move(inputs), .known = request.contact.known};
  for (const RecordFile& input : made.records) {
    made.notes.insert(made.notes.end(), input.notes.begin(), input.notes.end());
  }
  KeepTests(request, options, made);
  std::vector<Record> records;
  for (const RecordFile& input : made.records) records.push_back(input.record);
  if (request.compare) made.compared = identification::CompareModels(records, options);
  TermSelection asked = FitAsked(request, options, records);
  FitResult found;
  if (!request.chooses_terms) {
    made.next = FindNextStep(request, options, records, !made.left_out.empty(), asked.fit, found);
  }
  if (made.next && found.model == asked.fit.model) {
    identification::IncludeFit(found, asked.options.thresholds, asked.fit);
  }
  const auto disproportion = FindDisproportion(asked.fit);
  if (disproportion && !(made.next && found.adequacy.verdict == AdequacyVerdict::kAdequate)) {
    asked.fit.findings.push_back(*disproportion);
    asked.fit.adequacy.causes.clear();
    made.next.reset();
  }
  NoteOtherLoads(options, made);
  std::optional<contact::UncertainValue>& load = made.known.normal_load;
  if (!load && asked.fit.normal_load) {
    load = *asked.fit.normal_load;
  } else if (!load && !records.front().normal_load.empty()) {
    made.notes.emplace_back("the normal load is not positive in every file: it is not used");
  }
  made.fit = std::move(asked.fit);
  made.options = asked.options;
  if (request.chooses_terms) made.terms = std::move(asked);
  return report::MakeReport(std::move(made));
}

}  // namespace mindahl::request
