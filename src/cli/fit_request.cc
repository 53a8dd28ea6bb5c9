#include "cli/fit_request.h"

#include <fmt/format.h>

#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/contact_options.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/from_chars.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/term_selection.h"
#include "mindahl/identification/terms.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::cli {

using identification::Interval;
using identification::Term;

namespace {

using request::kFitIt;

double ParseNumber(std::string_view text, std::string_view option, std::string_view form) {
  const auto value = NumberIn<double>(text.starts_with('+') ? text.substr(1) : text);
  if (value) return *value;
  throw InputError(fmt::format("{}: '{}' is not a number: write {}", option, text, form));
}

/// Returns "left<separator>right".
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

/// Reads NAME=VALUE, each NAME once.
template <typename Value, typename Parse>
void ReadAssignments(const std::vector<std::string>& texts, std::string_view option,
                     std::string_view form, std::map<std::string, Value>& assignments,
                     Parse parse) {
  assignments.clear();
  for (const std::string& text : texts) {
    const auto [name, value] = Split(text, '=', option, form);
    if (!assignments.emplace(name, parse(value, option, form)).second) ThrowTwice(option, name);
  }
}

Interval ParseInterval(std::string_view text, std::string_view option, std::string_view form) {
  const auto [lower, upper] = Split(text, ':', option, form);
  return {ParseNumber(lower, option, form), ParseNumber(upper, option, form)};
}

loop::CountRange ParseCountRange(std::string_view text, std::string_view option,
                                 std::string_view form) {
  const auto [first, last] = Split(text, ':', option, form);
  const auto count = [&](std::string_view digits) {
    const auto number = NumberIn<std::size_t>(digits);
    if (number && *number >= 1) return *number;
    throw InputError(
        fmt::format("{}: '{}' is not a whole number from 1 on: write {}", option, digits, form));
  };
  return {.first = count(first), .last = count(last)};
}

/// Reads COL, COL=fit or COL=C.
request::CovariateRequest ParseCovariate(const std::string& text) {
  constexpr std::string_view kForm = "COL[=C|fit], e.g. pressure=50";
  const std::size_t at = text.rfind('=');
  if (text.empty() || at == 0 || at + 1 == text.size()) {
    throw InputError(fmt::format("--covariate: '{}' is incomplete: write {}", text, kForm));
  }
  request::CovariateRequest choice{.column = text.substr(0, at)};
  if (at != std::string::npos && text.substr(at + 1) != kFitIt) {
    choice.coefficient = ParseNumber(std::string_view(text).substr(at + 1), "--covariate", kForm);
  }
  return choice;
}

/// Reads fit, a number, or the form of a slip position.
request::TermRequest ParseTerm(const std::string& text, const Term& term) {
  if (term.option == "--slip-position") return {.form = text};
  if (text == kFitIt) return {};
  const auto has = [&](std::string_view separator) {
    return text.find(separator) != std::string::npos;
  };
  if (term.name == "rig_stiffness" && (has("±") || has("+-") || has("+/-"))) {
    const contact::UncertainValue stated = ParseUncertainValue(text, term.option);
    RequirePositive(fmt::format("{}: standard uncertainty [{}]", term.option, term.unit),
                    stated.standard_error);
    return {.value = stated.value, .standard_uncertainty = stated.standard_error};
  }
  return {.value =
              ParseNumber(text, term.option,
                          term.unit == "-" ? std::string("a number, or fit")
                                           : fmt::format("a number in {}, or fit", term.unit))};
}

/// Adds an option that is read into an optional range.
template <typename Range, typename Parse>
void AddRange(const OptionGroup& group, const std::string& name, std::optional<Range>& range,
              const std::string& form, const std::string& help, Parse parse) {
  group.AddRead(
      name,
      [&range, name, form, parse](const std::string& text) { range = parse(text, name, form); },
      help, "LO:HI");
}

void AddLimitOptions(CLI::App& command, FitRequest& options) {
  const OptionGroup group(command, std::string(kColumnGroup));
  group.AddShown("--max-rows", options.max_rows, "refuse files with more rows than this in total")
      .WholeNumber(1, 1'000'000'000'000);
  group
      .Add("--max-memory", options.max_memory,
           "refuse files whose fit needs more memory [B], as 4GB or 500MB;\ndefault: the machine's "
           "memory, or the limit of the process",
           "SIZE")
      .WholeNumber(1, 1'000'000'000'000'000'000)
      .WithUnitOfSize();
}

void AddWindowOptions(CLI::App& command, FitRequest& options) {
  const OptionGroup group(command, std::string(kColumnGroup));
  AddRange(group, "--time-window", options.time_window, "LO:HI in seconds",
           "fit only samples from LO to HI [s]", &ParseInterval);
  AddRange(group, "--load-window", options.load_window, "LO:HI in newtons",
           "fit only samples under a normal load from LO to HI [N];\nthe others still count as "
           "loading history",
           &ParseInterval);
  const std::string counted = "LO:HI, counted from 1, e.g. 2:5";
  AddRange(group, "--cycles", options.cycles, counted,
           "fit only samples of the cycles LO to HI, counted from 1;\nthe others still count as "
           "loading history",
           &ParseCountRange);
  AddRange(group, "--samples", options.samples, counted,
           "fit only the samples LO to HI of each record, counted from 1;\nthe others still count "
           "as loading history",
           &ParseCountRange);
  group
      .AddShown("--skip-cycles", options.skip_cycles,
                "number of cycles to leave out at the start;\nthey still count as loading history")
      .WholeNumber(0, 1'000'000'000);
  group
      .AddShown("--trim", options.trim,
                "auto leaves out what at the ends of a record is not the test, with a\nnote: "
                "rests, and ramps of the load")
      .OneOf(request::kTrims);
}

void AddTermOptions(const OptionGroup& group, FitRequest& options) {
  for (const Term& term : identification::Terms()) {
    if (term.option.empty()) continue;
    const std::string option(term.option);
    const std::string help(term.help);
    const std::string argument(term.argument);
    if (term.of_column) {
      const auto read = [&options](const std::vector<std::string>& texts) {
        options.covariates.clear();
        for (const std::string& text : texts) options.covariates.push_back(ParseCovariate(text));
      };
      group.AddReadAll(option, read, help, argument).OneAtATime();
    } else if (argument.empty()) {
      group.AddAction(
          option, [&options, &term] { options.terms[term.name] = {}; }, help);
    } else {
      const auto read = [&options, &term](const std::string& text) {
        options.terms[term.name] = ParseTerm(text, term);
      };
      group.AddRead(option, read, help, argument);
    }
  }
}

std::string TermGroupNames() {
  std::string names;
  for (const identification::TermGroup& group : identification::TermGroups()) {
    names += fmt::format("{}{}", names.empty() ? "" : ", ", group.name);
  }
  return names;
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
      "hold a parameter at a value: {}; of each record: {} (with several files numbered, "
      "force_offset_2)",
      contact, record);
}

}  // namespace

void AddJoin(CLI::App& command, FitRequest& options) {
  OptionGroup(command, "Files")
      .AddFlag("--join", options.join,
               "join the files, in their order, into one record, as of a logger that\nbegins a "
               "file every stroke; a clock that starts anew is continued");
}

void AddColumnOptions(CLI::App& command, io::RecordColumns& columns) {
  const OptionGroup group(command, std::string(kColumnGroup));
  group.Add(
      "--displacement", columns.displacement,
      "displacement column: header name or number from 1, with its unit if\nthe header has "
      "none, \"3 [mm]\", or that alone, \"[mm]\"; or a sum of\ncolumns with factors and an "
      "offset, \"lvdt2-lvdt1\",\n\"raw*0.0123-4.5 [mm]\"; found from names,\nunits and numbers by default; m, cm, mm, um, nm, in, or "
      "rad, deg",
      "COL");
  group.Add("--force", columns.force,
            "force column, likewise: \"cell1+cell2\"; N, mN, uN, kN, lbf, kgf; of a\ntorque 'N m', "
            "'N mm'",
            "COL");
  group.Add("--time", columns.time, "time column, likewise; optional", "COL");
  group.Add("--normal-load-column", columns.normal_load, "normal load column, likewise; optional",
            "COL");
  group.Add("--sample-rate", columns.sample_rate, "samples a second [Hz], where there is no time",
            "HZ");
  group.Add("--encoding", columns.encoding,
            "encoding of the files, as iconv names it [latin1, sjis, utf-16le];\ndefault UTF-8, or "
            "found from their first bytes",
            "NAME");
}

void RequireNoColumns(const io::RecordColumns& columns) {
  const auto require = [](const std::string& given, std::string_view option) {
    if (given.empty()) return;
    throw InputError(
        fmt::format("{} {}: there is no record to read a column of: give --record", option, given));
  };
  require(columns.displacement, "--displacement");
  require(columns.force, "--force");
  require(columns.time, "--time");
  require(columns.normal_load, "--normal-load-column");
}

/// Breaks a list of names after every few of them.
std::string InLines(std::string names, int in_a_line) {
  int seen = 0;
  for (std::size_t at = names.find(", "); at != std::string::npos; at = names.find(", ", at + 2)) {
    if (++seen % in_a_line == 0) names.replace(at, 2, ",\n");
  }
  return names;
}

void AddModelOptions(CLI::App& command, FitRequest& options) {
  const OptionGroup group(command, "Model");
  const std::vector<std::string_view> models = request::ModelNames();
  std::string description = "friction model:";
  for (const models::FrictionModel& model : models::FrictionModels()) {
    if (model.scaled_by_peak) continue;
    description += fmt::format(" {} ({});", model.name, model.title);
  }
  description += " auto (chosen by AICc and held-out cycles, each with and without a rig).";
  group.AddShown("--model", options.model, description).OneOf(models);
  group
      .AddShown("--initial-state", options.initial_state,
                "virgin: the record starts from an unloaded contact; steady: from a\ncycled one; "
                "auto fits both and keeps the smaller AICc")
      .OneOf(request::kInitialStates);
  group
      .AddShown("--force-sign", options.force_sign,
                "sign of the force in the file relative to the displacement; auto\ndecides by the "
                "sign of the loop's energy")
      .OneOf(request::kForceSigns);
  group
      .AddShown("--noise-in", options.noise_in,
                "channel that has the noise and is fitted; the other one is taken as\nexact: give "
                "displacement where the machine imposes the force")
      .OneOf(request::kNoiseIn);
  group.AddShown("--offsets", options.offsets, "fit offsets of force and displacement")
      .OneOf(request::kOnOff);
  AddTermOptions(group, options);
  group.Add("--terms", options.term_choice,
            "auto adds the terms that the record requires, one at a time, as\njudged by held-out "
            "cycles; NAME,NAME,... fits these:\n" +
                InLines(TermGroupNames(), 4) +
                "\ndefault: auto for a single record that the law alone misses by more\nthan 5 %, "
                "without options for terms; else none; in track none",
            "auto|none|NAME,...");
  const OptionGroup hidden(command, "");
  hidden.AddAction(
      "--follow-load",
      [] {
        throw InputError(
            "--follow-load is no longer needed: a load column that varies by more than 1 % is "
            "followed by itself; leave the option out");
      },
      "no longer needed: a load that varies is followed by itself");
  const auto add_assignments = [&](const std::string& name, auto& target, const char* type,
                                   const char* form, auto parse, const std::string& help) {
    group.AddReadAll(
        name,
        [&target, name, form, parse](const std::vector<std::string>& texts) {
          ReadAssignments(texts, name, form, target, parse);
        },
        help, type);
  };
  constexpr const char* kValue = "NAME=VALUE, e.g. alpha=0.3333";
  add_assignments("--fix", options.fix, "NAME=VALUE", kValue, &ParseNumber, DescribeParameters());
  add_assignments("--start", options.start, "NAME=VALUE", kValue, &ParseNumber,
                  "start the search from a value instead of the data's");
  add_assignments("--bound", options.bound, "NAME=LO:HI", "NAME=LO:HI, e.g. alpha=0:2",
                  &ParseInterval, "keep a parameter between two values");
  add_assignments(
      "--prior", options.prior, "NAME=V+-U", "NAME=VALUE±U, e.g. sigma=4e7±5%",
      [](std::string_view value, std::string_view option, std::string_view) {
        const contact::UncertainValue prior = ParseUncertainValue(value, option);
        if (prior.standard_error > 0) return prior;
        throw InputError(fmt::format(
            "{}: '{}' has no standard uncertainty: write VALUE±U, or --fix an exact value", option,
            value));
      },
      "prior value and standard uncertainty of a parameter, in its unit [SI];\nV+-U, V±5%");
  group.AddShown("--confidence", options.confidence, "confidence of every interval [-]", "C");
  group.Add("--force-noise", options.force_noise,
            "known standard deviation of the force [N]; default from the residuals", "N");
  group.Add("--displacement-noise", options.displacement_noise,
            "known standard deviation of the displacement [m]; default from the data where "
            "they show any",
            "M");
  group
      .AddShown("--loss", options.loss,
                "weight of residuals that are large against their scatter: huber and\ncauchy "
                "reduce it, tukey reduces it to zero")
      .OneOf(request::kLosses);
  group
      .AddShown("--starts", options.starts,
                "number of starting points that are refined: the four most promising,\nthe others "
                "drawn at random")
      .WholeNumber(1, 1000);
  group.AddShown("--seed", options.seed, "seed of the starting points drawn at random")
      .WholeNumber(0, std::numeric_limits<std::uint64_t>::max());
  group.Add("--reversal-gate", options.reversal_gate,
            "excursions up to this [m] are noise, not reversals; default from the data", "M");
}

void AddFitOptions(CLI::App& command, FitRequest& request, NormalLoads loads) {
  AddColumnOptions(command, request.columns);
  AddLimitOptions(command, request);
  AddWindowOptions(command, request);
  AddModelOptions(command, request);
  AddContactOptions(command, request.contact, loads);
}

void AddStrict(const OptionGroup& group, Strictness& strictness, const std::string& otherwise) {
  // A configuration has `strict = true`.
  static const std::map<std::string, Strictness> levels = {{"adequate", Strictness::kAdequate},
                                                           {"true", Strictness::kAdequate},
                                                           {"doubtful", Strictness::kDoubtful},
                                                           {"false", Strictness::kNone}};
  const auto read = [&strictness](const std::string& given) {
    const auto level = levels.find(given);
    if (level == levels.end()) {
      throw InputError(fmt::format(
          "--strict: '{}' is no verdict: give --strict for adequate, or --strict=doubtful", given));
    }
    strictness = level->second;
  };
  group.AddFlagWithWord("--strict{adequate}", read,
                        otherwise +
                            " unless the model is adequate and every free\n"
                            "parameter identifiable; --strict=doubtful accepts a doubtful\n"
                            "model and parameters that are effective");
}

void Messages::Note(std::string_view text) const {
  stream << fmt::format("mindahl {}: note: {}\n", command, text);
}

void Messages::Warn(std::string_view text) const {
  stream << fmt::format("mindahl {}: warning: {}\n", command, text);
}

report::Report FitRecords(const FitRequest& request, const Messages& messages) {
  request::Validate(request);
  std::vector<io::RecordFile> inputs =
      request::ReadRecords(request, [&](std::string_view note) { messages.Note(note); });
  std::size_t samples = 0;
  for (const io::RecordFile& input : inputs) samples += input.record.size();
  std::vector<std::string> notes;  // not into the line of progress
  std::optional<Progress> progress(std::in_place, messages.stream,
                                   fmt::format("fitting {} samples", samples));
  report::Report report = request::FitRecords(
      request, std::move(inputs), [&](std::string_view note) { notes.emplace_back(note); });
  progress.reset();
  for (const std::string& note : notes) messages.Note(note);
  return report;
}

}  // namespace mindahl::cli
