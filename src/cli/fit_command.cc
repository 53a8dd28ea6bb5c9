#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/contact_options.h"
#include "cli/established.h"
#include "cli/output_path.h"
#include "cli/progress.h"
#include "cli/text_output.h"
#include "cli/whole_number.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/model_selection.h"
#include "mindahl/identification/terms.h"
#include "mindahl/identification/too_few_samples.h"
#include "mindahl/io/atomic_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/io/time_window.h"
#include "mindahl/report/contact.h"
#include "mindahl/report/figure.h"
#include "mindahl/report/json.h"
#include "mindahl/report/report.h"
#include "mindahl/report/residual_table.h"
#include "mindahl/report/text.h"

namespace mindahl::cli {

using identification::FitOptions;
using identification::Interval;
using identification::Loss;
using identification::Term;
using io::RecordFile;
using loop::Record;

namespace {

constexpr std::string_view kFitIt = "fit";

struct FitCommandOptions {
  std::vector<std::string> files;
  io::RecordColumns columns;
  std::string time_window;
  std::string model = "mindlin-dahl";
  std::string initial_state = "auto";
  std::string force_sign = "auto";
  std::string offsets = "on";
  std::map<std::string_view, std::string> terms;  // what was asked of each, by its name
  std::vector<std::string> covariates;
  std::string load_window;
  std::string cycles;
  std::string samples;
  std::size_t skip_cycles = 0;
  std::string loss = "none";
  std::size_t starts = FitOptions{}.starts;
  std::uint64_t seed = FitOptions{}.seed;
  bool strict = false;
  std::vector<std::string> fix;
  std::vector<std::string> start;
  std::vector<std::string> bound;
  std::optional<double> force_noise;
  std::optional<double> displacement_noise;
  std::optional<double> reversal_gate;
  ContactOptions contact;
  std::string json_path;
  std::string residuals_path;
  std::string plot_path;
};

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

constexpr std::string_view kAutomatic = "auto";

FitOptions MakeFitOptions(const FitCommandOptions& options) {
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

std::vector<RecordFile> ReadInputs(const FitCommandOptions& options, Console& console) {
  std::vector<RecordFile> inputs;
  for (const std::string& file : options.files) {
    io::RecordColumns columns = options.columns;
    for (const std::string& text : options.covariates) {
      columns.covariates.push_back(ParseCovariate(text).column);
    }
    RecordFile& input = inputs.emplace_back(io::ReadRecord(file, columns));
    if (!options.time_window.empty()) {
      const Interval window =
          ParseInterval(options.time_window, "--time-window", "LO:HI in seconds");
      io::KeepTimeWindow(input, file, window.lower, window.upper);
    }
    for (const std::string& note : input.notes) {
      console.err << fmt::format("mindahl fit: note: {}\n", note);
    }
  }
  return inputs;
}

/// "file:line:column" of a sample, and of the whole file where the record does not know its lines.
std::string PlaceOf(const std::string& file, const RecordFile& input,
                    const io::ChosenColumn& column, std::size_t sample) {
  if (sample >= input.lines.size()) return fmt::format("{}:{}", file, column.number);
  return fmt::format("{}:{}:{}", file, input.lines[sample], column.number);
}

/// Half the range of a column in SI units; refuses what is beyond any unit that is meant.
double RequireHalfRange(const std::string& file, const RecordFile& input,
                        const io::ChosenColumn& column, const std::vector<double>& values,
                        std::string_view what, std::string_view unit) {
  constexpr double kSmallest = 1e-100;
  constexpr double kLargest = 1e100;
  const auto [least, greatest] = std::ranges::minmax_element(values);
  const double half_range = *greatest / 2 - *least / 2;
  if (half_range == 0 || (half_range >= kSmallest && half_range <= kLargest)) return half_range;
  const auto widest = std::abs(*least) > std::abs(*greatest) ? least : greatest;
  throw InputError(
      fmt::format("{}: half the range of the {} is {} {}: must lie between 1e-100 and 1e100: "
                  "choose other units",
                  PlaceOf(file, input, column, static_cast<std::size_t>(widest - values.begin())),
                  what, half_range, unit));
}

/// Where a whole file is at fault, it is named too, with a line and a column to look at.
void RequireLoops(const FitCommandOptions& options, const std::vector<RecordFile>& inputs) {
  bool is_loaded = false;
  std::size_t samples = 0;
  for (std::size_t r = 0; r < inputs.size(); ++r) {
    const RecordFile& input = inputs[r];
    const Record& record = input.record;
    const std::string& file = options.files[r];
    const bool torsional = input.is_torsional;
    samples += record.size();
    if (!(RequireHalfRange(file, input, input.displacement, record.displacement, "displacement",
                           torsional ? "rad" : "m") > 0)) {
      throw InputError(fmt::format(
          "{}: the displacement never changes, it is {} {} in every row: a fit needs a moving "
          "contact; choose another column with --displacement",
          PlaceOf(file, input, input.displacement, 0), record.displacement.front(),
          torsional ? "rad" : "m"));
    }
    is_loaded = RequireHalfRange(file, input, input.force, record.force, "force",
                                 torsional ? "N m" : "N") > 0 ||
                is_loaded;
  }
  const RecordFile& first = inputs.front();
  if (!is_loaded) {
    throw InputError(fmt::format(
        "{}: the force never changes, it is {} {} in every row: a fit needs a loaded contact; "
        "choose another column with --force",
        PlaceOf(options.files.front(), first, first.force, 0), first.record.force.front(),
        first.is_torsional ? "N m" : "N"));
  }
  constexpr std::size_t kLeast = 3;  // as many as the law has parameters
  if (samples < kLeast && options.fix.empty()) {
    throw InputError(fmt::format(
        "{}: {} samples are too few: a fit needs more than it has free parameters; record more",
        PlaceOf(options.files.back(), inputs.back(), inputs.back().force,
                inputs.back().record.size() - 1),
        samples));
  }
}

/// A unit of what no file has would be taken without a word; and a joint fit is of one kind.
void RequireColumns(const FitCommandOptions& options, const std::vector<RecordFile>& inputs) {
  const auto require = [&](std::string_view option, const io::ColumnChoice& choice,
                           std::string_view column_option, std::string_view what,
                           std::optional<io::ChosenColumn> RecordFile::*column) {
    const bool is_there = std::ranges::any_of(
        inputs, [column](const RecordFile& input) { return (input.*column).has_value(); });
    if (choice.unit.empty() || is_there) return;
    throw InputError(
        fmt::format("{} {}: {} has no column of the {}, so this has no effect: name it with {}",
                    option, choice.unit, options.files.front(), what, column_option));
  };
  require("--time-unit", options.columns.time, "--time", "time", &RecordFile::time);
  require("--normal-load-unit", options.columns.normal_load, "--normal-load-column", "normal load",
          &RecordFile::normal_load);
  for (std::size_t r = 1; r < inputs.size(); ++r) {
    if (inputs[r].is_torsional == inputs.front().is_torsional) continue;
    throw InputError(fmt::format("{} holds a force and {} a torque: fit them apart",
                                 options.files[inputs[r].is_torsional ? 0 : r],
                                 options.files[inputs[r].is_torsional ? r : 0]));
  }
}

/// What needs a load column must have one, and a window some samples, before the fit says so in its
/// own words.
void RequireLoads(const FitCommandOptions& options, const std::optional<Interval>& window,
                  const std::vector<RecordFile>& inputs) {
  if (!window) return;
  for (std::size_t r = 0; r < inputs.size(); ++r) {
    const std::vector<double>& load = inputs[r].record.normal_load;
    if (load.empty()) {
      throw InputError(
          fmt::format("{}: --load-window needs a normal load: name its column with "
                      "--normal-load-column",
                      options.files[r]));
    }
    const auto lies_outside = [&](double value) {
      return value < window->lower || value > window->upper;
    };
    if (!std::ranges::all_of(load, lies_outside)) continue;
    const auto [least, greatest] = std::ranges::minmax(load);
    throw InputError(
        fmt::format("{}: --load-window {}:{} holds no sample: the normal load runs from {:.6g} to "
                    "{:.6g} N",
                    options.files[r], window->lower, window->upper, least, greatest));
  }
}

/// One normal load for all files, or one a file.
void RequireLoadsOfFiles(const FitCommandOptions& options) {
  const std::size_t loads = options.contact.normal_loads.size();
  if (loads <= 1 || loads == options.files.size()) return;
  throw InputError(
      fmt::format("--normal-load: {} loads for {} file{}: give one for all or one a "
                  "file",
                  loads, options.files.size(), options.files.size() > 1 ? "s" : ""));
}

/// The measured normal load where it was not given: its mean.
void UseMeasuredNormalLoad(ContactOptions& contact, const identification::FitResult& fit,
                           std::span<const RecordFile> inputs,
                           const std::optional<Interval>& window, Console& console) {
  if (contact.known.normal_load) return;
  if (fit.normal_load) {
    contact.known.normal_load = *fit.normal_load;
    console.err << fmt::format("mindahl fit: note: normal load: the mean of its column, {:.6g} N\n",
                               *fit.normal_load);
    return;
  }
  std::vector<Record> records;
  for (const RecordFile& input : inputs) records.push_back(input.record);
  const std::optional<double> mean = report::MeanNormalLoad(records, window);
  if (!mean) return;
  console.err << fmt::format(
      "mindahl fit: note: the mean normal load is {:.4g} N, not positive in every file: it is not "
      "used\n",
      *mean);
}

void Write(const FitCommandOptions& options, const report::Report& report, Console& console) {
  for (const report::Warning& warning : report.fit_warnings) {
    if (warning.code == "fit_failed") continue;  // an error, below
    console.err << fmt::format("mindahl fit: warning: {}\n", warning.message);
  }
  for (const report::Warning& warning : report.contact_warnings) {
    if (warning.code != "contact_implausible") continue;  // the others are in the text
    console.err << fmt::format("mindahl fit: warning: {}\n", warning.message);
  }
  if (report.failed()) {  // no curve to draw, no residual to list
    console.err << fmt::format("mindahl fit: the fit failed: {}\n", report.fit.termination);
    if (!options.json_path.empty()) WriteText(report::ToJson(report), options.json_path, console);
    return;
  }
  // The plot first: it alone may still fail.
  if (!options.plot_path.empty()) io::WritePlot(report::ToPlot(report), options.plot_path);
  if (!options.residuals_path.empty()) {
    io::WriteFileAtomically(options.residuals_path, report::ResidualsCsv(report));
  }
  if (!options.json_path.empty()) WriteText(report::ToJson(report), options.json_path, console);
  if (options.json_path != "-") console.out << report::ToText(report);
}

/// The fit that the options ask for, of the model that they name or choose.
/// @param selection  written where the model is chosen
identification::FitResult FitRecords(const FitCommandOptions& options,
                                     const FitOptions& fit_options, std::span<const Record> records,
                                     const Console& console,
                                     std::optional<identification::ModelSelection>& selection) {
  std::size_t samples = 0;
  for (const Record& record : records) samples += record.size();
  const Progress progress(console.err, fmt::format("fitting {} samples", samples));
  try {
    if (options.model != kAutomatic) return identification::Fit(records, fit_options);
    selection = identification::SelectModel(records, fit_options);
    return selection->fit;
  } catch (const identification::TooFewSamples& error) {
    throw InputError(fmt::format("{}: {}", fmt::join(options.files, ", "), error.what()));
  }
}

void RunFit(FitCommandOptions options, Console& console) {
  Validate(options.contact);
  RequireDistinctFiles(options.files);
  RequireLoadsOfFiles(options);
  std::vector<std::string> read = console.inputs;
  read.insert(read.end(), options.files.begin(), options.files.end());
  RequireOutputPaths({{"--json", options.json_path, /*dash_is_stdout=*/true},
                      {"--residuals", options.residuals_path},
                      {"--plot", options.plot_path}},
                     read);
  const FitOptions fit_options = MakeFitOptions(options);
  std::vector<RecordFile> inputs = ReadInputs(options, console);
  RequireColumns(options, inputs);
  if (inputs.front().is_torsional && IsAnythingGiven(options.contact)) {
    throw InputError(
        "--normal-load and whatever else describes a contact say nothing of a torque against an "
        "angle: leave them out");
  }
  RequireLoops(options, inputs);
  RequireLoads(options, fit_options.preparation.load_window, inputs);
  std::vector<Record> records;
  for (const RecordFile& input : inputs) records.push_back(input.record);

  std::optional<identification::ModelSelection> selection;
  identification::FitResult fit = FitRecords(options, fit_options, records, console, selection);
  UseMeasuredNormalLoad(options.contact, fit, inputs, fit_options.preparation.load_window, console);
  console.exit_status = Established(fit, options.strict) ? kDone : kNotEstablished;
  const report::Report report =
      report::MakeReport({.files = options.files,
                          .records = std::move(inputs),
                          .fit = std::move(fit),
                          .known = options.contact.known,
                          .load_window = fit_options.preparation.load_window,
                          .selection = std::move(selection)});
  Write(options, report, console);
}

void AddColumnOptions(CLI::App& command, FitCommandOptions& options) {
  const std::string group = "Columns and units";
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

void AddTermOptions(CLI::App& command, FitCommandOptions& options, const std::string& group) {
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

void AddModelOptions(CLI::App& command, FitCommandOptions& options) {
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

}  // namespace

void AddFitCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<FitCommandOptions>();
  CLI::App* command = app.add_subcommand("fit",
                                         "Fits sigma, alpha and Tc to one or more records of a "
                                         "contact (several files: one joint fit)\n"
                                         "and translates them into the contact. Exit status 3 when "
                                         "the fit does not converge or, with\n"
                                         "--strict, a parameter is not identifiable or the model "
                                         "inadequate.");
  command->add_option("files", options->files, "CSV records of one contact")
      ->type_name("FILE")
      ->required();
  AddColumnOptions(*command, *options);
  AddModelOptions(*command, *options);
  AddContactOptions(*command, options->contact, NormalLoads::kOneAFile);
  const std::string group = "Results";
  command->add_option("--json", options->json_path, "result as JSON; - for standard output alone")
      ->type_name("PATH")
      ->group(group);
  command
      ->add_option("--residuals", options->residuals_path,
                   "measured and fitted force of every sample as CSV")
      ->type_name("PATH")
      ->group(group);
  command->add_option("--plot", options->plot_path, "loop and residuals as svg or png")
      ->type_name("PATH")
      ->group(group);
  command
      ->add_flag("--strict", options->strict,
                 "exit status 3 unless every free parameter is identifiable\n"
                 "and the model not inadequate")
      ->group(group);
  command->callback([options, &console] { RunFit(*options, console); });
}

}  // namespace mindahl::cli
