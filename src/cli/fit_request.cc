#include "cli/fit_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>
#include <utility>

#include "cli/text_output.h"
#include "cli/whole_number.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/terms.h"

namespace mindahl::cli {

using identification::FitOptions;
using identification::Interval;
using identification::Loss;
using identification::Term;

namespace {

constexpr std::string_view kFitIt = "fit";
constexpr std::string_view kColumnGroup = "Columns and units";

double ParseNumber(std::string_view text, std::string_view option, std::string_view form) {
  double value = 0.0;
  const std::string_view digits = text.starts_with('+') ? text.substr(1) : text;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    throw InputError(fmt::format("{}: '{}' is not a number: write {}", option, text, form));
  }
  return value;
}

/// "left<separator>right"
std::pair<std::string_view, std::string_view> Split(std::string_view text, char separator,
                                                    std::string_view option,
                                                    std::string_view form) {
  const std::size_t at = text.find(separator);
  if (at == std::string_view::npos || at == 0 || at + 1 == text.size()) {
    throw InputError(fmt::format("{}: '{}' is incomplete: write {}", option, text, form));
  }
  return {text.substr(0, at), text.substr(at + 1)};
}

[[noreturn]] void ThrowTwice(std::string_view option, std::string_view name) {
  throw InputError(fmt::format("{}: '{}' is given twice: give it once", option, name));
}

std::map<std::string, double> ParseAssignments(const std::vector<std::string>& texts,
                                               std::string_view option) {
  constexpr std::string_view kForm = "NAME=VALUE, e.g. alpha=0.3333";
  std::map<std::string, double> assignments;
  for (const std::string& text : texts) {
    const auto [name, value] = Split(text, '=', option, kForm);
    const double number = ParseNumber(value, option, kForm);
    if (!assignments.emplace(name, number).second) ThrowTwice(option, name);
  }
  return assignments;
}

Interval ParseInterval(std::string_view text, std::string_view option, std::string_view form) {
  const auto [lower, upper] = Split(text, ':', option, form);
  const Interval interval{ParseNumber(lower, option, form), ParseNumber(upper, option, form)};
  if (!(interval.lower < interval.upper)) {
    throw InputError(
        fmt::format("{}: '{}' is empty: the first number must be the smaller", option, text));
  }
  return interval;
}

std::map<std::string, Interval> ParseBounds(const std::vector<std::string>& texts) {
  constexpr std::string_view kForm = "NAME=LO:HI, e.g. alpha=0:2";
  std::map<std::string, Interval> bounds;
  for (const std::string& text : texts) {
    const auto [name, interval] = Split(text, '=', "--bound", kForm);
    const Interval parsed = ParseInterval(interval, "--bound", kForm);
    if (!bounds.emplace(name, parsed).second) ThrowTwice("--bound", name);
  }
  return bounds;
}

/// What was asked of a term: to be fitted, or a value that is known.
void ApplyTerm(const Term& term, const std::string& text, FitOptions& fit) {
  const std::string name(term.name);
  if (text == kFitIt) {
    if (fit.fixed.contains(name)) {
      throw InputError(fmt::format("{} {} contradicts --fix {}: give one of the two", term.option,
                                   term.argument.empty() ? "" : kFitIt, name));
    }
    fit.terms.push_back(name);
    return;
  }
  const double value =
      ParseNumber(text, term.option, fmt::format("a number in {}, or fit", term.unit));
  if (term.positive) RequirePositive(fmt::format("{} [{}]", term.option, term.unit), value);
  if (!fit.fixed.emplace(name, value).second) {
    throw InputError(
        fmt::format("{} and --fix {} say the same: give one of the two", term.option, name));
  }
}

struct CovariateChoice {
  std::string column;
  std::optional<double> value;  // empty: fitted
};

/// COL, COL=fit or COL=C.
CovariateChoice ParseCovariate(const std::string& text) {
  constexpr std::string_view kForm = "COL[=C|fit], e.g. pressure=50";
  const std::size_t at = text.rfind('=');
  if (text.empty() || at == 0 || at + 1 == text.size()) {
    throw InputError(fmt::format("--covariate: '{}' is incomplete: write {}", text, kForm));
  }
  CovariateChoice choice{.column = text.substr(0, at), .value = {}};
  if (at != std::string::npos && text.substr(at + 1) != kFitIt) {
    choice.value = ParseNumber(std::string_view(text).substr(at + 1), "--covariate", kForm);
  }
  return choice;
}

void ApplyCovariates(const std::vector<std::string>& texts, FitOptions& fit) {
  for (const std::string& text : texts) {
    const CovariateChoice choice = ParseCovariate(text);
    const std::string name = identification::NameOfCovariate(choice.column);
    const bool is_there = std::ranges::any_of(fit.covariates, [&](const std::string& other) {
      return identification::NameOfCovariate(other) == name;
    });
    if (is_there) ThrowTwice("--covariate", choice.column);
    fit.covariates.push_back(choice.column);
    if (!choice.value) continue;
    if (!fit.fixed.emplace(name, *choice.value).second) {
      throw InputError(
          fmt::format("--covariate {} and --fix {} say the same: give one of the two", text, name));
    }
  }
}

loop::CountRange ParseCountRange(std::string_view text, std::string_view option) {
  constexpr std::string_view kForm = "LO:HI, counted from 1, e.g. 2:5";
  const auto [first, last] = Split(text, ':', option, kForm);
  const auto count = [&](std::string_view digits) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error == std::errc() && end == digits.data() + digits.size() && number >= 1) return number;
    throw InputError(
        fmt::format("{}: '{}' is not a whole number from 1 on: write {}", option, digits, kForm));
  };
  const loop::CountRange range{.first = count(first), .last = count(last)};
  if (range.first <= range.last) return range;
  throw InputError(
      fmt::format("{}: '{}' is empty: the first number must not be the larger", option, text));
}

/// A start or a bound of what the fit does not move would be taken without a word.
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
  if (term->name == "displacement_offset" && fit.initial_state == models::InitialState::kSteady) {
    refuse("that of a steady loop is its centre; use --initial-state virgin");
  }
  if (term->option.empty()) return;
  if (term->of_column) return;  // the fit knows the columns
  const bool is_tried = is_automatic && term->name == "rig_stiffness";
  if (is_tried || std::ranges::find(fit.terms, term->name) != fit.terms.end()) return;
  refuse(fmt::format("add {}{}", term->option, term->argument.empty() ? "" : " fit"));
}

/// What is held must lie where it is bounded to lie.
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

void AddWindowOptions(CLI::App& command, FitRequest& options) {
  const std::string group(kColumnGroup);
  command.add_option("--time-window", options.time_window, "fit only samples from LO to HI [s]")
      ->type_name("LO:HI")
      ->group(group);
  command
      .add_option("--load-window", options.load_window,
                  "fit only samples under a normal load from LO to HI [N]; the others still make "
                  "history")
      ->type_name("LO:HI")
      ->group(group);
  command
      .add_option("--cycles", options.cycles,
                  "fit only samples of the cycles LO to HI, counted from 1;\n"
                  "the others still make history")
      ->type_name("LO:HI")
      ->group(group);
  command
      .add_option("--samples", options.samples,
                  "fit only the samples LO to HI of each record, counted from 1;\n"
                  "the others still make history")
      ->type_name("LO:HI")
      ->group(group);
  command
      .add_option("--skip-cycles", options.skip_cycles,
                  "leave out so many cycles at the start; they still make history")
      ->capture_default_str()
      ->check(WholeNumber(0, 1'000'000'000))
      ->group(group);
}

void AddTermOptions(CLI::App& command, FitRequest& options, const std::string& group) {
  for (const Term& term : identification::Terms()) {
    if (term.option.empty()) continue;
    const std::string option(term.option);
    const std::string help(term.help);
    if (term.of_column) {
      command.add_option(option, options.covariates, help)
          ->type_name(std::string(term.argument))
          ->allow_extra_args(false)
          ->group(group);
    } else if (term.argument.empty()) {
      command
          .add_flag_callback(
              option, [&options, &term] { options.terms[term.name] = kFitIt; }, help)
          ->group(group);
    } else {
      command
          .add_option_function<std::string>(
              option,
              [&options, &term](const std::string& text) { options.terms[term.name] = text; }, help)
          ->type_name(std::string(term.argument))
          ->group(group);
    }
  }
}

std::string DescribeParameters() {
  std::string contact;
  std::string record;
  for (const Term& term : identification::Terms()) {
    if (term.of_column) continue;  // --covariate takes its value
    std::string& list = term.scope == identification::Scope::kContact ? contact : record;
    list += fmt::format("{}{} [{}]", list.empty() ? "" : ", ", term.name, term.unit);
  }
  return fmt::format(
      "hold a parameter: {}, {}; with several files the latter are numbered, force_offset_2",
      contact, record);
}

}  // namespace

void AddColumnOptions(CLI::App& command, FitRequest& options) {
  const std::string group(kColumnGroup);
  const auto column = [&](const char* name, io::ColumnChoice& choice, const char* description) {
    command.add_option(name, choice.column, description)->type_name("COL")->group(group);
  };
  const auto unit = [&](const char* name, io::ColumnChoice& choice, const char* description) {
    command.add_option(name, choice.unit, description)->type_name("UNIT")->group(group);
  };
  column("--displacement", options.columns.displacement,
         "column by header name or 1-based number; default a recognised name, else column 1");
  column("--force", options.columns.force, "likewise, else column 2");
  column("--time", options.columns.time, "time column; optional");
  column("--normal-load-column", options.columns.normal_load, "normal load column; optional");
  unit("--displacement-unit", options.columns.displacement,
       "m, mm, um, nm, in; of an angle rad, mrad, deg, rev;\ndefault the header's, else m");
  unit("--force-unit", options.columns.force,
       "N, mN, uN, kN, MN, lbf, kgf, kip; of a torque 'N m', 'mN m', 'uN m',\n"
       "'kN m', 'N mm', 'lbf in', 'lbf ft'; default the header's, else N");
  unit("--time-unit", options.columns.time, "s, ms, us, min; default the header's, else s");
  unit("--normal-load-unit", options.columns.normal_load, "as --force-unit of a force");
}

void AddModelOptions(CLI::App& command, FitRequest& options) {
  const std::string group = "Model";
  std::vector<std::string> models;
  std::string description = "friction model:";
  for (const models::FrictionModel& model : models::FrictionModels()) {
    if (model.scaled_by_peak) continue;
    models.emplace_back(model.name);
    description += fmt::format(" {} ({});", model.name, model.title);
  }
  models.emplace_back(kAutomatic);
  description += " auto (chosen by AICc and held-out cycles, each with and without a rig).";
  command.add_option("--model", options.model, description)
      ->capture_default_str()
      ->check(CLI::IsMember(models))
      ->group(group);
  command
      .add_option("--initial-state", options.initial_state,
                  "does the record start from an unloaded contact; auto fits both and keeps the "
                  "smaller AICc")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "virgin", "steady"}))
      ->group(group);
  command
      .add_option(
          "--force-sign", options.force_sign,
          "have force and displacement the same sign in the file; auto decides from the sign of "
          "the loop's energy")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "same", "opposite"}))
      ->group(group);
  command.add_option("--offsets", options.offsets, "fit offsets of force and displacement")
      ->capture_default_str()
      ->check(CLI::IsMember({"on", "off"}))
      ->group(group);
  AddTermOptions(command, options, group);
  command
      .add_flag_callback(
          "--follow-load",
          [] {
            throw InputError(
                "--follow-load is no longer needed: a load column that varies by more than 1 % is "
                "followed by itself; leave the option out");
          },
          "no longer needed: a load that varies is followed by itself")
      ->group("");  // not shown
  command.add_option("--fix", options.fix, DescribeParameters())
      ->type_name("NAME=VALUE")
      ->group(group);
  command.add_option("--start", options.start, "start from a value instead of the data's")
      ->type_name("NAME=VALUE")
      ->group(group);
  command.add_option("--bound", options.bound, "keep a parameter between two values")
      ->type_name("NAME=LO:HI")
      ->group(group);
  AddOptional(command, "--force-noise", options.force_noise,
              "known standard deviation of the force [N]; default from the residuals", "N")
      ->group(group);
  AddOptional(command, "--displacement-noise", options.displacement_noise,
              "known standard deviation of the displacement [m]; default from the data where "
              "they show any",
              "M")
      ->group(group);
  command
      .add_option("--loss", options.loss,
                  "what large residuals count; the scale is the data's: huber and cauchy less, "
                  "tukey in the end nothing")
      ->capture_default_str()
      ->check(CLI::IsMember({"none", "huber", "cauchy", "tukey"}))
      ->group(group);
  command
      .add_option("--starts", options.starts,
                  "starting points refined: the best looks, beyond four drawn at random")
      ->capture_default_str()
      ->check(WholeNumber(1, 1000))
      ->group(group);
  command.add_option("--seed", options.seed, "of starting points drawn at random")
      ->capture_default_str()
      ->check(WholeNumber(0, std::numeric_limits<std::uint64_t>::max()))
      ->group(group);
  AddOptional(command, "--reversal-gate", options.reversal_gate,
              "excursions up to this [m] are noise, not reversals; default from the data", "M")
      ->group(group);
}

FitOptions MakeFitOptions(const FitRequest& options) {
  FitOptions fit;
  if (options.model != kAutomatic) fit.model = models::FindFrictionModel(options.model);
  if (options.initial_state == "virgin") fit.initial_state = models::InitialState::kVirgin;
  if (options.initial_state == "steady") fit.initial_state = models::InitialState::kSteady;
  loop::PreparationOptions& preparation = fit.preparation;
  if (options.force_sign == "same") preparation.force_sense = 1;
  if (options.force_sign == "opposite") preparation.force_sense = -1;
  fit.offsets = options.offsets == "on";
  for (const contact::UncertainValue& load : options.contact.normal_loads) {
    fit.normal_loads.push_back(load.value);
  }
  if (!options.load_window.empty()) {
    preparation.load_window =
        ParseInterval(options.load_window, "--load-window", "LO:HI in newtons");
  }
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
  if (options.reversal_gate) RequireNonNegative("--reversal-gate [m]", *options.reversal_gate);
  preparation.reversal_gate = options.reversal_gate;
  fit.fixed = ParseAssignments(options.fix, "--fix");
  for (const auto& [name, text] : options.terms) {
    ApplyTerm(*identification::FindTerm(name), text, fit);
  }
  ApplyCovariates(options.covariates, fit);
  if (!options.cycles.empty()) preparation.cycles = ParseCountRange(options.cycles, "--cycles");
  if (!options.samples.empty()) preparation.samples = ParseCountRange(options.samples, "--samples");
  fit.start = ParseAssignments(options.start, "--start");
  fit.bounds = ParseBounds(options.bound);
  const bool is_automatic = options.model == kAutomatic;
  RequireWithinBounds(fit);
  for (const auto& [name, value] : fit.start) RequireFitted("--start", name, is_automatic, fit);
  for (const auto& [name, interval] : fit.bounds) {
    RequireFitted("--bound", name, is_automatic, fit);
  }
  return fit;
}

std::vector<std::string> CovariateColumns(const FitRequest& request) {
  std::vector<std::string> columns;
  for (const std::string& text : request.covariates) {
    columns.push_back(ParseCovariate(text).column);
  }
  return columns;
}

std::optional<Interval> TimeWindow(const FitRequest& request) {
  if (request.time_window.empty()) return std::nullopt;
  return ParseInterval(request.time_window, "--time-window", "LO:HI in seconds");
}

void AddFitOptions(CLI::App& command, FitRequest& request, NormalLoads loads) {
  AddColumnOptions(command, request);
  AddWindowOptions(command, request);
  AddModelOptions(command, request);
  AddContactOptions(command, request.contact, loads);
}

}  // namespace mindahl::cli
