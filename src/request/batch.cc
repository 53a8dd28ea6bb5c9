#include "mindahl/request/batch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <future>
#include <new>
#include <set>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/io/output_file.h"
#include "report/html.h"
#include "report/json.h"
#include "report/statements.h"

namespace mindahl::request {

using report::At;
using report::Json;

namespace {

/// A quantity that repeats of a test have in common, by the names of its columns.
struct Repeated {
  std::string name;
  std::string parameter;  // whose error it has; "" of what is measured, which states none
  std::string_view unit;
};
const auto kRepeated = std::to_array<Repeated>({{"sigma", "sigma", "N/m"},
                                                {"alpha", "alpha", "-"},
                                                {"slip_force", "slip_force", "N"},
                                                {"friction_coefficient", "slip_force", "-"},
                                                {"half_gap", "", "N"},
                                                {"energy_per_cycle", "", "J"}});

/// Returns the row of a file in the table, of the JSON of its fit, which may be null.
Json RowOf(const BatchEntry& entry, const Json& fit) {
  Json row = {{"file", entry.file},
              {"done", entry.done()},
              {"samples", At(fit, "/input/samples")},
              {"model", At(fit, "/model")},
              {"initial_state", At(fit, "/initial_state")},
              {"adequacy", At(fit, "/adequacy/verdict")},
              {"cycles", At(fit, "/input/cycles")}};
  for (const char* name :
       {"amplitude", "peak_force", "half_gap", "energy_per_cycle", "energy_ratio"}) {
    const Json measured = At(fit, fmt::format("/measured/{}", name));
    row[name] = measured.is_object() ? measured["value"] : measured;
  }
  for (const std::string name : report::kLawParameters) {
    const Json parameter = At(fit, "/parameters/" + name);
    const Json verdict = At(parameter, "/identifiability");
    const bool is_known = verdict != "bounded_below" && verdict != "not_identifiable";
    row[name] = is_known ? At(parameter, "/value") : Json();
    row[name + "_error"] = At(parameter, "/standard_error");
    row[name + "_lower95"] = At(parameter, "/ci95/0");
    row[name + "_upper95"] = At(parameter, "/ci95/1");
    row[name + "_verdict"] = verdict;
  }
  std::vector<std::string> codes;
  for (const Json& warning : At(fit, "/warnings")) {
    const std::string code = warning["code"];
    if (std::ranges::find(codes, code) == codes.end()) codes.push_back(code);
  }
  row.update({{"rms", At(fit, "/residuals/rms")},
              {"r_squared", At(fit, "/residuals/r_squared")},
              {"slides", At(fit, "/measured/slides")},
              {"normal_load", At(fit, "/contact/normal_load/value")},
              {"friction_coefficient", At(fit, "/contact/friction_coefficient/value")},
              {"friction_coefficient_lower95", At(fit, "/contact/friction_coefficient/ci95/0")},
              {"friction_coefficient_upper95", At(fit, "/contact/friction_coefficient/ci95/1")},
              {"contact_radius", At(fit, "/contact/contact_radius/value")},
              {"warnings", fmt::format("{}", fmt::join(codes, " "))},
              {"fault", entry.fault},
              {"version", Version()}});
  return row;
}

constexpr std::string_view kSeveralLaws =
    "fits are by several laws, whose parameters are not compared: --model NAME fits all by one";

/// Returns the scatter of each quantity of two files or more, and the rms of their stated errors.
/// @param table  with a row an entry
Json RepeatRows(const Json& table, std::span<const BatchEntry> entries, bool has_several_laws) {
  const double seen_loop = identification::Thresholds().seen_loop;
  Json repeats = Json::object();
  for (const auto& [name, parameter, unit] : kRepeated) {
    if (has_several_laws && !parameter.empty()) continue;
    std::vector<double> values;
    std::vector<double> squares;  // of the errors
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const Json& row = table[k];
      const Json& r_squared = row["r_squared"];
      const bool describes = row["warnings"].get_ref<const std::string&>().find(
                                 "model_inadequate") == std::string::npos;
      const bool is_loop = describes || r_squared.is_null() || r_squared >= seen_loop;
      if (!row["done"].get<bool>() || !is_loop || row[name].is_null()) continue;
      const double value = row[name];
      if (!parameter.empty()) {
        const auto error = entries[k].errors.find(parameter);
        if (error == entries[k].errors.end()) continue;
        // μ = Tc/N scatters as Tc does.
        const double square = std::pow(error->second * value / row[parameter].get<double>(), 2);
        if (square > 0 && std::isfinite(square)) squares.push_back(square);
      }
      values.push_back(value);
    }
    if (values.size() < 2) continue;
    namespace statistics = boost::math::statistics;
    repeats[name] = {
        {"files", values.size()},
        {"mean", statistics::mean(values)},
        {"standard_deviation", std::sqrt(statistics::sample_variance(values))},
        {"stated_error", squares.empty() ? Json() : Json(std::sqrt(statistics::mean(squares)))},
        {"unit", unit}};
  }
  return repeats;
}

std::string PageName(std::size_t k) { return fmt::format("page-{}.html", k + 1); }

/// Returns the index of the entries' pages, with a note on the repeats.
std::string IndexPage(std::span<const BatchEntry> entries, std::string_view title,
                      const Json& repeats, std::string_view note, std::string_view command) {
  std::vector<report::TableLine> files;
  for (const BatchEntry& entry : entries) {
    std::vector<std::string> cells = {fmt::format("{}", files.size() + 1), entry.verdict};
    cells.insert(cells.end(), entry.parameters.begin(), entry.parameters.end());
    cells.resize(2 + report::kLawParameters.size());
    cells.push_back(entry.fault);
    files.push_back({entry.file, std::move(cells), report::JudgementOf(entry.verdict),
                     entry.fit.empty() ? "" : PageName(files.size())});
  }
  return report::PageHtml(
      title,
      report::SectionHtml(
          "Files", report::TableHtml("one fit a file; only identified quantities have a number",
                                     {"file", "number", "verdict", "sigma", "alpha", "slip_force",
                                      "why not done"},
                                     files)) +
          report::SectionHtml(
              "If these are repeats",
              report::TableHtml("over the fitted files in which the quantity is known", repeats) +
                  (note.empty() ? "" : report::ParagraphHtml(note))),
      command);
}

}  // namespace

BatchEntry FitSource(const std::string& name, Strictness strictness,
                     const std::function<report::Report()>& fit) {
  BatchEntry entry{.file = name};
  try {
    const report::Report report = fit();
    entry.notes = report.notes;
    entry.fit = ToJson(report);
    entry.fault = WhyNotEstablished(report.fit, strictness);
    entry.verdict = report::VerdictWord(report);
    for (const char* parameter : report::kLawParameters) {
      const identification::ParameterEstimate* estimate = report.fit.Find(parameter);
      if (estimate == nullptr) continue;
      entry.parameters.push_back(report::ValueText(*estimate));
      const report::Shown shown = report::WhatIsShown(*estimate);
      const bool is_held = estimate->status == identification::ParameterStatus::kFixed;
      if (!shown.is_estimate() && !is_held) continue;
      entry.errors[parameter] = report.fit.ErrorOf(*estimate);
    }
  } catch (const InputError& error) {
    entry.fault = error.what();
  } catch (const InvalidArgument& error) {
    entry.fault = fmt::format("{}: {}", name, error.what());
  } catch (const std::bad_alloc&) {
    entry.fault = name + ": memory ran out";
  }
  return entry;
}

std::vector<BatchEntry> FitFiles(const FitRequest& request, Strictness strictness,
                                 std::size_t threads, const std::filesystem::path& pages,
                                 std::string_view command) {
  std::vector<BatchEntry> entries(request.files.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t k = next++; k < entries.size(); k = next++) {
      FitRequest own = request;
      own.files = {request.files[k]};
      entries[k] = FitSource(own.files.front(), strictness, [&] {
        report::Report report = FitRecords(own, ReadRecords(own));
        if (!pages.empty()) io::WriteFileAtomically(pages / PageName(k), ToPage(report, command));
        return report;
      });
    }
  };
  std::vector<std::future<void>> workers(threads);
  for (auto& worker : workers) worker = std::async(work);  // here where no thread can be started
  for (std::future<void>& worker : workers) worker.get();
  return entries;
}

BatchAnswer AnswerOf(std::span<const BatchEntry> entries, const std::string& output,
                     std::string_view command) {
  Json table = Json::array();
  Json files = Json::array();
  std::set<Json> laws;
  for (const BatchEntry& entry : entries) {
    const Json fit = entry.fit.empty() ? Json() : Json::parse(entry.fit);
    table.push_back(RowOf(entry, fit));
    files.push_back({{"file", entry.file},
                     {"done", entry.done()},
                     {"fault", entry.fault.empty() ? Json() : Json(entry.fault)},
                     {"fit", fit}});
    if (entry.done()) laws.insert(At(fit, "/model"));
  }
  // Parameters of one law are no repeats of another's.
  const bool has_several_laws = laws.size() > 1;
  const std::string_view note = has_several_laws ? kSeveralLaws : "";
  const Json repeats = RepeatRows(table, entries, has_several_laws);
  const std::string title = fmt::format(
      "{} of {} files fitted", std::ranges::count_if(entries, &BatchEntry::done), entries.size());
  return {.rows = report::Dump(table),
          .table = report::TableCsv(table),
          .json = report::Document("mindahl.batch/1",
                                   {{"output", output.empty() ? Json() : Json(output)},
                                    {"files", std::move(files)},
                                    {"repeats", repeats}}),
          .text = fmt::format("{}{}{}\n{}{}{}{}", title, output.empty() ? "" : ", in ", output,
                              repeats.empty() ? "" : "\nif these are repeats:\n",
                              report::TableText(repeats), note, note.empty() ? "" : "\n"),
          .index = IndexPage(entries, title, repeats, note, command)};
}

}  // namespace mindahl::request
