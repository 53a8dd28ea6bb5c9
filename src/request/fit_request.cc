#include "mindahl/request/fit_request.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/term_selection.h"
#include "mindahl/identification/terms.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::request {

using identification::FitOptions;
using identification::Loss;
using identification::Term;

namespace {

// --drift is of the channel that is fitted.
constexpr std::string_view kDriftOfForce = "force_drift";
constexpr std::string_view kDriftOfDisplacement = "displacement_drift";

// The term that has the option --slip-position.
constexpr std::string_view kSlipPosition = "slip_slope";

[[noreturn]] void ThrowTwice(std::string_view option, std::string_view name) {
  throw InputError(fmt::format("{}: '{}' is given twice: give it once", option, name));
}

void RequireOrdered(std::string_view option, double lower, double upper) {
  if (lower < upper) return;
  throw InputError(fmt::format("{}: '{}:{}' is empty: the first number must be the smaller", option,
                               lower, upper));
}

void RequireCounts(std::string_view option, const std::optional<loop::CountRange>& range) {
  if (!range || (range->first >= 1 && range->first <= range->last)) return;
  throw InputError(fmt::format("{}: '{}:{}' is empty: the first number must not be the larger",
                               option, range->first, range->last));
}

/// Fits the other terms of a group, those that are not given.
void ApplyCompanions(std::string_view group, std::string_view but, FitOptions& fit) {
  for (const std::string_view name : identification::FindTermGroup(group)->terms) {
    const std::string term(name);
    if (name == but || fit.fixed.contains(term)) continue;
    if (std::ranges::find(fit.terms, term) == fit.terms.end()) fit.terms.push_back(term);
  }
}

void ApplySlipPosition(std::string_view text, FitOptions& fit) {
  constexpr std::array<std::string_view, 2> kForms = {"linear", "quadratic"};
  RequireOneOf("--slip-position", text, kForms);
  ApplyCompanions(text == kForms[0] ? "slip_position" : "slip_position_quadratic", "", fit);
}

void ApplyTerm(const Term& term, const TermRequest& asked, FitOptions& fit) {
  const std::string name(term.name);
  if (!asked.value) {
    if (fit.fixed.contains(name)) {
      throw InputError(fmt::format("{} {} contradicts --fix {}: give one of the two", term.option,
                                   term.argument.empty() ? "" : kFitIt, name));
    }
    fit.terms.push_back(name);
    return;
  }
  (term.must_be_positive() ? RequirePositive : RequireFinite)(
      fmt::format("{} [{}]", term.option, term.unit), *asked.value);
  if (asked.standard_uncertainty && !fit.fixed.contains(name)) {
    fit.terms.push_back(name);
    fit.priors[name] = {*asked.value, *asked.standard_uncertainty};
    return;
  }
  if (!fit.fixed.emplace(name, *asked.value).second) {
    throw InputError(
        fmt::format("{} and --fix {} say the same: give one of the two", term.option, name));
  }
}

void ApplyCovariates(const std::vector<CovariateRequest>& covariates, FitOptions& fit) {
  for (const CovariateRequest& choice : covariates) {
    if (choice.column.empty()) {
      throw InputError("--covariate: '' is no column: give its name or number");
    }
    const std::string name = identification::NameOfCovariate(choice.column);
    const bool is_there = std::ranges::any_of(fit.covariates, [&](const std::string& other) {
      return identification::NameOfCovariate(other) == name;
    });
    if (is_there) ThrowTwice("--covariate", choice.column);
    fit.covariates.push_back(choice.column);
    if (!choice.coefficient) continue;
    if (!fit.fixed.emplace(name, *choice.coefficient).second) {
      throw InputError(
          fmt::format("--covariate {}={} and --fix {} say the same: give one of the two",
                      choice.column, *choice.coefficient, name));
    }
  }
}

void ApplyTermNames(const FitRequest& request, FitOptions& fit) {
  std::vector<std::string_view> names = {kAutomatic, kNoTerms};
  for (const identification::TermGroup& group : identification::TermGroups()) {
    names.push_back(group.name);
  }
  std::vector<std::string_view> given;
  const std::vector<std::string> named = NamedTerms(request);
  for (const std::string_view name : named) {
    RequireOneOf("--terms", name, names);
    if (std::ranges::find(given, name) != given.end()) ThrowTwice("--terms", name);
    given.push_back(name);
    const identification::TermGroup* group = identification::FindTermGroup(name);
    if (group == nullptr) {
      throw InputError(fmt::format("--terms: '{}' stands alone: write auto, none or names", name));
    }
    if (const std::string_view term = group->terms.front(); request.terms.contains(term)) {
      throw InputError(fmt::format("--terms {} and {} say the same: give one of the two", name,
                                   identification::FindTerm(term)->option));
    }
    ApplyCompanions(name, "", fit);
  }
}

void RequireOptionsOfDisplacement(const FitRequest& request) {
  const auto refuse = [](std::string_view option, std::string_view why) {
    throw InputError(
        fmt::format("{} cannot be combined with --noise-in displacement: {}", option, why));
  };
  constexpr std::string_view kBeside = "it needs a fit of the force; leave one of the two out";
  for (const auto& [name, asked] : request.terms) {
    if (name != kDriftOfForce) refuse(identification::FindTerm(name)->option, kBeside);
  }
  if (!request.covariates.empty()) refuse("--covariate", kBeside);
  if (!request.term_choice.empty() && request.term_choice != kNoTerms) refuse("--terms", kBeside);
  if (request.model == kAutomatic) {
    refuse("--model auto", "models are chosen by fits of the force; name one");
  }
  if (request.force_noise) {
    refuse("--force-noise", "the force is taken as exact; give --displacement-noise");
  }
  if (request.displacement_noise) {
    RequirePositive("--displacement-noise [m]", *request.displacement_noise);
  }
}

/// A start, a bound or a prior of what the fit does not move would be taken without a word.
void RequireFitted(std::string_view option, const std::string& name, bool is_automatic,
                   const FitOptions& fit) {
  const auto refuse = [&](std::string_view why) {
    throw InputError(
        fmt::format("{}: {} is not fitted, so this has no effect: {}", option, name, why));
  };
  if (fit.fixed.contains(name)) refuse("it is held at a value that is given; give one of the two");
  if (name == "alpha" && !is_automatic && fit.model != nullptr && fit.model->shape_exponent) {
    refuse(fmt::format("--model {} prescribes it; use --model mindlin-dahl", fit.model->name));
  }
  const Term* term = identification::FindTerm(identification::TermNameOf(name));
  if (term == nullptr) return;  // the fit knows all names
  if (term->presence == identification::Presence::kOffsets && !fit.offsets) {
    refuse("--offsets off holds it at 0; use --offsets on");
  }
  const std::string_view origin =
      fit.response() == loop::Channel::kForce ? "displacement_offset" : "force_offset";
  if (term->name == origin && fit.initial_state == models::InitialState::kSteady) {
    refuse("that of a steady loop is its centre; use --initial-state virgin");
  }
  if (term->option.empty() && term->name != kDriftOfDisplacement) return;
  if (term->of_column) return;  // the fit knows the columns
  const bool is_tried = is_automatic && term->name == "rig_stiffness";
  if (is_tried || std::ranges::find(fit.terms, term->name) != fit.terms.end()) return;
  if (term->name == kDriftOfDisplacement) {
    refuse(fit.response() == loop::Channel::kForce ? "add --drift --noise-in displacement"
                                                   : "add --drift");
  }
  refuse(fmt::format("add {}{}", term->option, term->argument.empty() ? "" : " fit"));
}

void RequireWithinBounds(const FitOptions& fit) {
  for (const auto& [name, interval] : fit.bounds) {
    const auto fixed = fit.fixed.find(name);
    if (fixed == fit.fixed.end()) continue;
    if (fixed->second >= interval.lower && fixed->second <= interval.upper) continue;
    throw InputError(
        fmt::format("{} is held at {}, outside its --bound {}:{}: change one of the two", name,
                    fixed->second, interval.lower, interval.upper));
  }
}

Loss FindLoss(std::string_view name) {
  if (name == "huber") return Loss::kHuber;
  if (name == "cauchy") return Loss::kCauchy;
  if (name == "tukey") return Loss::kTukey;
  return Loss::kNone;
}

void RequireKnownChoices(const FitRequest& request) {
  RequireOneOf("--model", request.model, ModelNames());
  RequireOneOf("--initial-state", request.initial_state, kInitialStates);
  RequireOneOf("--force-sign", request.force_sign, kForceSigns);
  RequireOneOf("--noise-in", request.noise_in, kNoiseIn);
  RequireOneOf("--offsets", request.offsets, kOnOff);
  RequireOneOf("--loss", request.loss, kLosses);
  RequireOneOf("--trim", request.trim, kTrims);
}

/// Refuses options that choose samples in addition to --trim auto.
void RequireTrimAlone(const FitRequest& request) {
  if (request.trim != kAutomatic) return;
  const auto refuse = [](std::string_view option, std::string_view why) {
    throw InputError(fmt::format("{} cannot be combined with --trim auto: {}", option, why));
  };
  constexpr std::string_view kBoth = "both say which cycles count; leave one of the two out";
  if (request.cycles) refuse("--cycles", kBoth);
  if (request.samples) refuse("--samples", kBoth);
  if (request.skip_cycles > 0) refuse("--skip-cycles", kBoth);
  if (request.noise_in == "displacement") {
    refuse("--noise-in displacement", "trimming compares cycles of an imposed displacement");
  }
}

}  // namespace

std::vector<std::string_view> ModelNames() {
  std::vector<std::string_view> names;
  for (const models::FrictionModel& model : models::FrictionModels()) {
    if (!model.scaled_by_peak) names.push_back(model.name);
  }
  names.push_back(kAutomatic);
  return names;
}

bool ChoosesTermsByDefault(const FitRequest& request) {
  const auto is_of_term = [](const auto& held) {
    const Term* term = identification::FindTerm(identification::TermNameOf(held.first));
    return term != nullptr && term->presence == identification::Presence::kOnDemand;
  };
  return request.term_choice.empty() && request.files.size() <= 1 && request.terms.empty() &&
         request.covariates.empty() && std::ranges::none_of(request.fix, is_of_term) &&
         request.model != kAutomatic && request.loss == kLosses.front() &&
         request.noise_in == kNoiseIn.front();
}

std::vector<std::string> NamedTerms(const FitRequest& request) {
  const std::string_view choice = request.term_choice;
  if (choice.empty() || choice == kNoTerms || choice == kAutomatic) return {};
  const std::vector<std::string_view> names = PartsOf(choice, ',');
  return {names.begin(), names.end()};
}

FitOptions MakeFitOptions(const FitRequest& options) {
  FitOptions fit;
  RequireKnownChoices(options);
  RequireTrimAlone(options);
  if (options.model != kAutomatic) fit.model = models::FindFrictionModel(options.model);
  if (options.initial_state == "virgin") fit.initial_state = models::InitialState::kVirgin;
  if (options.initial_state == "steady") fit.initial_state = models::InitialState::kSteady;
  loop::PreparationOptions& preparation = fit.preparation;
  if (options.force_sign == "same") preparation.force_sense = 1;
  if (options.force_sign == "opposite") preparation.force_sense = -1;
  if (options.noise_in == "displacement") {
    RequireOptionsOfDisplacement(options);
    preparation.excitation = loop::Channel::kForce;
  }
  fit.offsets = options.offsets == "on";
  for (const contact::UncertainValue& load : options.contact.normal_loads) {
    fit.normal_loads.push_back(load.value);
  }
  for (const auto& [option, window] :
       {std::pair("--load-window", options.load_window), {"--time-window", options.time_window}}) {
    if (window) RequireOrdered(option, window->lower, window->upper);
  }
  preparation.load_window = options.load_window;
  preparation.skip_cycles = options.skip_cycles;
  fit.loss = FindLoss(options.loss);
  fit.starts = options.starts;
  fit.seed = options.seed;
  if (options.displacement_noise) {
    RequireNonNegative("--displacement-noise [m]", *options.displacement_noise);
  }
  preparation.displacement_noise = options.displacement_noise;
  if (options.force_noise) RequirePositive("--force-noise [N]", *options.force_noise);
  fit.force_noise = options.force_noise;
  if (!(options.confidence > 0 && options.confidence < 1)) {
    ThrowInvalid("--confidence [-]", options.confidence, "must be between 0 and 1, as 0.95");
  }
  fit.confidence = options.confidence;
  if (options.reversal_gate) RequireNonNegative("--reversal-gate [m]", *options.reversal_gate);
  preparation.reversal_gate = options.reversal_gate;
  fit.fixed = options.fix;
  for (const auto& [name, asked] : options.terms) {
    const bool is_of_displacement =
        name == kDriftOfForce && fit.response() == loop::Channel::kDisplacement;
    if (name == kSlipPosition) continue;
    ApplyTerm(*identification::FindTerm(is_of_displacement ? kDriftOfDisplacement : name), asked,
              fit);
  }
  // Those that bring others come last: what is given of these is known.
  for (const auto& [name, asked] : options.terms) {
    if (name == kSlipPosition) ApplySlipPosition(asked.form, fit);
    if (name == "speed_exponent") ApplyCompanions("speed_exponent", name, fit);
    if (name == "slip_speed_exponent") ApplyCompanions("slip_speed", name, fit);
    if (name == "ripple_period") ApplyCompanions("ripple", name, fit);
  }
  ApplyTermNames(options, fit);
  ApplyCovariates(options.covariates, fit);
  RequireCounts("--cycles", options.cycles);
  RequireCounts("--samples", options.samples);
  preparation.cycles = options.cycles;
  preparation.samples = options.samples;
  fit.start = options.start;
  fit.bounds = options.bound;
  for (const auto& [name, interval] : fit.bounds) {
    RequireOrdered("--bound", interval.lower, interval.upper);
  }
  for (const auto& [name, value] : options.prior) {
    if (!fit.priors.emplace(name, identification::Prior{value.value, value.standard_error})
             .second) {
      throw InputError(
          fmt::format("--prior {} and --rig-stiffness say the same: give one of the two", name));
    }
  }
  const bool is_automatic = options.model == kAutomatic;
  RequireWithinBounds(fit);
  for (const auto& [name, value] : fit.priors) RequireFitted("--prior", name, is_automatic, fit);
  for (const auto& [name, value] : fit.start) RequireFitted("--start", name, is_automatic, fit);
  for (const auto& [name, interval] : fit.bounds) {
    RequireFitted("--bound", name, is_automatic, fit);
  }
  return fit;
}

FitOptions MakeCycleFitOptions(const FitRequest& request) {
  if (request.model == kAutomatic) {
    throw InputError(
        "--model auto: a model is chosen for a test, not for each cycle: choose one by fit "
        "--cycles and name it here");
  }
  if (!request.covariates.empty()) {
    throw InputError("--covariate is not available in track: fit a part of the record with fit");
  }
  if (request.noise_in == "displacement") {
    throw InputError(
        "--noise-in displacement is not available in track: fit a part of the record with fit");
  }
  if (request.terms.contains("asymmetry")) {
    throw InputError(
        "--asymmetry is not available in track: where the contact slips as a whole, force_offset "
        "of a cycle is (Tc+ - Tc-)/2 plus the sensor's own; fit a part of the record with fit");
  }
  return MakeFitOptions(request);
}

std::vector<std::string> CovariateColumns(const FitRequest& request) {
  std::vector<std::string> columns;
  columns.reserve(request.covariates.size());
  for (const CovariateRequest& choice : request.covariates) columns.push_back(choice.column);
  return columns;
}

}  // namespace mindahl::request
