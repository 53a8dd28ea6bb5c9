#include "mindahl/request/batch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cctype>
#include <cmath>
#include <deque>
#include <filesystem>
#include <future>
#include <new>
#include <optional>
#include <utility>

#include "core/platform.h"
#include "core/probability.h"
#include "io/source.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "report/html.h"
#include "report/json.h"
#include "report/statements.h"

namespace mindahl::request {

using identification::ParameterEstimate;
using report::At;
using report::Dump;
using report::Json;
using report::NumberOrNull;

namespace {

/// A column of the table, and where `fit --json` has it.
struct ColumnRow {
  std::string_view name;
  std::string_view pointer;
};

constexpr std::array kBatchColumns = {
    ColumnRow{"samples", "/input/samples"},
    ColumnRow{"model", "/model"},
    ColumnRow{"initial_state", "/initial_state"},
    ColumnRow{"adequacy", "/adequacy/verdict"},
    ColumnRow{"cycles", "/input/cycles"},
    ColumnRow{"amplitude", "/measured/amplitude"},
    ColumnRow{"peak_force", "/measured/peak_force"},
    ColumnRow{"half_gap", "/measured/half_gap/value"},
    ColumnRow{"energy_per_cycle", "/measured/energy_per_cycle"},
    ColumnRow{"energy_ratio", "/measured/energy_ratio"},
    ColumnRow{"sigma", "/parameters/sigma/value"},
    ColumnRow{"sigma_error", "/parameters/sigma/standard_error"},
    ColumnRow{"sigma_lower95", "/parameters/sigma/ci95/0"},
    ColumnRow{"sigma_upper95", "/parameters/sigma/ci95/1"},
    ColumnRow{"sigma_verdict", "/parameters/sigma/identifiability"},
    ColumnRow{"alpha", "/parameters/alpha/value"},
    ColumnRow{"alpha_error", "/parameters/alpha/standard_error"},
    ColumnRow{"alpha_lower95", "/parameters/alpha/ci95/0"},
    ColumnRow{"alpha_upper95", "/parameters/alpha/ci95/1"},
    ColumnRow{"alpha_verdict", "/parameters/alpha/identifiability"},
    ColumnRow{"slip_force", "/parameters/slip_force/value"},
    ColumnRow{"slip_force_error", "/parameters/slip_force/standard_error"},
    ColumnRow{"slip_force_lower95", "/parameters/slip_force/ci95/0"},
    ColumnRow{"slip_force_upper95", "/parameters/slip_force/ci95/1"},
    ColumnRow{"slip_force_verdict", "/parameters/slip_force/identifiability"},
    ColumnRow{"rms", "/residuals/rms"},
    ColumnRow{"r_squared", "/residuals/r_squared"},
    ColumnRow{"slides", "/measured/slides"},
    ColumnRow{"normal_load", "/contact/normal_load/value"},
    ColumnRow{"friction_coefficient", "/contact/friction_coefficient/value"},
    ColumnRow{"friction_coefficient_lower95", "/contact/friction_coefficient/ci95/0"},
    ColumnRow{"friction_coefficient_upper95", "/contact/friction_coefficient/ci95/1"},
    ColumnRow{"contact_radius", "/contact/contact_radius/value"},
};

/// A quantity that repeats of a test have in common, by the names of its columns.
struct Repeated {
  std::string_view name;
  std::string_view parameter;  // whose errors it has; "" of what is measured, which states none
  std::string_view unit;
};
constexpr std::array kRepeated = {Repeated{"sigma", "sigma", "N/m"},
                                  Repeated{"alpha", "alpha", "-"},
                                  Repeated{"slip_force", "slip_force", "N"},
                                  Repeated{"friction_coefficient", "slip_force", "-"},
                                  Repeated{"half_gap", "", "N"},
                                  Repeated{"energy_per_cycle", "", "J"}};

Json DocumentOf(const BatchEntry& entry) {
  return entry.fit.empty() ? Json() : Json::parse(entry.fit);
}

Json TableRows(std::span<const BatchEntry> entries) {
  Json rows = Json::array();
  for (const BatchEntry& entry : entries) {
    const Json fit = DocumentOf(entry);
    Json row = {{"file", entry.file}, {"done", entry.done}};
    for (const ColumnRow& column : kBatchColumns) row[column.name] = At(fit, column.pointer);
    std::vector<std::string> codes;
    for (const Json& warning : At(fit, "/warnings")) codes.push_back(warning["code"]);
    row["warnings"] = fmt::format("{}", fmt::join(codes, " "));
    row["fault"] = entry.fault;
    row["version"] = Version();
    row["sha256"] = entry.sha256;
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Compares the scatter of repeats of a test with their stated errors.
/// @param errors  by which they should scatter, > 0; none where they state none
Json RepeatsRow(const std::vector<double>& values, const std::vector<double>& errors,
                std::string_view unit) {
  const auto count = static_cast<double>(values.size());
  const double mean = boost::math::statistics::mean(values);
  const double deviation = std::sqrt(boost::math::statistics::sample_variance(values));
  std::optional<double> stated;
  std::optional<double> p_value;
  std::string says = "without stated errors";
  if (!errors.empty()) {
    double squares = 0.0;
    double weights = 0.0;
    double weighted = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      squares += errors[k] * errors[k];
      weights += 1 / (errors[k] * errors[k]);
      weighted += values[k] / (errors[k] * errors[k]);
    }
    // P(χ²(n − 1) ≥ Σ((x − x̄)/e)²), x̄ weighted: chance of such a scatter from the stated errors.
    double chi_squared = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double off = (values[k] - weighted / weights) / errors[k];
      chi_squared += off * off;
    }
    stated = std::sqrt(squares / count);
    p_value = PValueOfChiSquared(chi_squared, count - 1);
    constexpr double kChance = 0.01;
    says = fmt::format("{}, {}", *p_value < kChance ? "more than the errors" : "as the errors say",
                       report::ChanceText(*p_value, 2));
  }
  return {{"files", values.size()},
          {"mean", mean},
          {"standard_deviation", deviation},
          {"stated_error", NumberOrNull(stated)},
          {"p_value", NumberOrNull(p_value)},
          {"unit", unit},
          {"says", says}};
}

/// Returns what repeats of a test say of a quantity; null of fewer than two.
/// @param rows  the table's, of the same fits
Json RepeatsOf(std::span<const BatchEntry> fits, const Json& rows, const Repeated& quantity) {
  std::vector<double> values;
  std::vector<double> errors;  // by which repeats scatter
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const BatchEntry& fit = fits[k];
    const auto number = [&](std::string_view name, const char* suffix) {
      const Json value = rows[k].value(fmt::format("{}{}", name, suffix), Json());
      return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
    };
    const std::optional<double> value = number(quantity.name, "");
    if (!fit.done || !value) continue;
    const std::string_view parameter = quantity.parameter;
    if (parameter.empty()) {
      values.push_back(*value);
      continue;
    }
    const Json& verdict = rows[k].at(fmt::format("{}_verdict", parameter));
    const bool is_known = verdict.is_null() || verdict == "identifiable" || verdict == "effective";
    const std::optional<double> of_parameter = number(parameter, "");
    const std::optional<double> lower = number(quantity.name, "_lower95");
    const std::optional<double> upper = number(quantity.name, "_upper95");
    if (!is_known || !of_parameter) continue;
    constexpr double kWidth = 2 * kNormalQuantile95;  // in standard errors
    const double whole = lower && upper ? (*upper - *lower) / kWidth : 0.0;
    // μ = Tc/N scatters as Tc does; a parameter at a bound has an interval only.
    const double own = number(parameter, "_error").value_or(0.0) * (*value / *of_parameter);
    const double error = own > 0 ? own : whole;
    if (!(error > 0)) continue;
    values.push_back(*value);
    errors.push_back(error);
  }
  return values.size() < 2 ? Json() : RepeatsRow(values, errors, quantity.unit);
}

/// Returns what repeats of a test say of each quantity.
Json RepeatRows(std::span<const BatchEntry> entries) {
  const Json table = TableRows(entries);
  Json rows = Json::object();
  for (const Repeated& quantity : kRepeated) {
    Json row = RepeatsOf(entries, table, quantity);
    if (!row.is_null()) rows[quantity.name] = std::move(row);
  }
  return rows;
}

// --- the index of pages

const std::string kNone = "–";
constexpr std::array<std::string_view, 3> kParameters = {"sigma", "alpha", "slip_force"};

/// Returns no number of what is not known.
std::string ParameterText(const BatchEntry& entry, std::string_view name) {
  const auto found = std::ranges::find(entry.parameters, name, &ParameterEstimate::name);
  return found == entry.parameters.end() ? kNone : report::ValueText(*found);
}

/// Returns an address within a page: whatever is no letter, digit, '-', '_' or '.' in hexadecimal.
std::string Address(std::string_view name) {
  std::string address;
  for (const char character : name) {
    const auto byte = static_cast<unsigned char>(character);
    const bool is_plain = (byte < 128 && std::isalnum(byte) != 0) ||
                          std::string_view("-_.").find(character) != std::string_view::npos;
    address += is_plain ? std::string(1, character) : fmt::format("%{:02X}", byte);
  }
  return address;
}

}  // namespace

BatchEntry FitSource(const FitRequest& request, const std::string& name, Strictness strictness,
                     const ReadSource& read, const WritePage& write_page, std::size_t k) {
  BatchEntry entry;
  entry.file = name;
  FitRequest own = request;
  own.files = {name};
  std::string& fault = entry.fault;
  try {
    if (std::filesystem::is_regular_file(name)) entry.sha256 = io::Sha256OfFile(name).value_or("");
    Validate(own);
    const report::Report report = FitRecords(own, read(own));
    entry.notes = report.notes;
    entry.fit = ToJson(report);
    entry.done = Established(report.fit, strictness);
    entry.verdict = report::VerdictWord(report);
    entry.parameters = report.fit.parameters;
    if (write_page) entry.page = write_page(report, k);
    if (!entry.done) {
      fault = report.fit.converged ? "not established: the model is not adequate or a free "
                                     "parameter not identifiable"
                                   : report.fit.solver.message;
    }
  } catch (const InputError& error) {
    fault = error.what();
  } catch (const InvalidArgument& error) {
    fault = fmt::format("{}: {}", name, error.what());
  } catch (const std::bad_alloc&) {
    fault = fmt::format("{}: {}", name, OutOfMemoryText());
  }
  // A page that cannot be written, too, leaves a file that is not done.
  entry.done = entry.done && fault.empty();
  return entry;
}

std::vector<BatchEntry> FitFiles(const FitRequest& request, Strictness strictness,
                                 std::size_t threads, const WritePage& write_page) {
  MakeFitOptions(request);  // what is wrong with the options is no fault of a file
  const std::vector<std::string>& files = request.files;
  std::vector<BatchEntry> entries;
  std::deque<std::future<BatchEntry>> at_work;
  for (std::size_t next = 0; entries.size() < files.size();) {
    while (next < files.size() && at_work.size() < threads) {
      const auto fit = [&, k = next] {
        return FitSource(request, files[k], strictness, &ReadRecords, write_page, k);
      };
      at_work.push_back(std::async(fit));  // here where no thread can be started
      ++next;
    }
    entries.push_back(at_work.front().get());
    at_work.pop_front();
  }
  return entries;
}

bool AllDone(std::span<const BatchEntry> entries) {
  return std::ranges::all_of(entries, &BatchEntry::done);
}

std::string TableCsv(std::span<const BatchEntry> entries) {
  return report::TableCsv(TableRows(entries));
}

std::string TableJson(std::span<const BatchEntry> entries) { return Dump(TableRows(entries)); }

std::string ToText(std::span<const BatchEntry> entries, const std::string& output) {
  const auto done = std::ranges::count_if(entries, &BatchEntry::done);
  std::string text = fmt::format("{} of {} files fitted{}{}\n", done, entries.size(),
                                 output.empty() ? "" : ", in ", output);
  const Json repeats = RepeatRows(entries);
  if (!repeats.empty()) text += "\nif these are repeats:\n" + report::TableText(repeats);
  return text;
}

std::string ToJson(std::span<const BatchEntry> entries, const std::string& output) {
  Json files = report::ListOf(entries, [](const BatchEntry& entry) -> Json {
    return {{"file", entry.file},
            {"done", entry.done},
            {"fault", entry.fault.empty() ? Json() : Json(entry.fault)},
            {"fit", DocumentOf(entry)}};
  });
  return report::Document("mindahl.batch/1", {{"output", output.empty() ? Json() : Json(output)},
                                              {"files", std::move(files)},
                                              {"repeats", RepeatRows(entries)}});
}

std::string IndexPage(std::span<const BatchEntry> entries, const report::Provenance& provenance) {
  const auto done =
      std::ranges::count_if(entries, [](const BatchEntry& entry) { return entry.fault.empty(); });
  std::vector<report::TableLine> files;
  for (const BatchEntry& entry : entries) {
    std::vector<std::string> cells = {fmt::format("{}", files.size() + 1),
                                      entry.verdict.empty() ? kNone : entry.verdict};
    for (const std::string_view name : kParameters) cells.push_back(ParameterText(entry, name));
    cells.push_back(entry.fault);
    files.push_back({entry.file, std::move(cells),
                     entry.verdict.empty() ? "" : report::Name(report::JudgementOf(entry.verdict)),
                     Address(entry.page)});
  }
  const std::string repeats = report::TableHtml(
      "over the fitted files in which the quantity is known", RepeatRows(entries));
  return report::PageHtml(
      fmt::format("{} of {} files fitted", done, entries.size()),
      report::SectionHtml(
          "Files", report::TableHtml("one fit a file; only identified quantities have a number",
                                     {"file", "number", "verdict", "sigma", "alpha", "slip_force",
                                      "why not done"},
                                     files)) +
          report::SectionHtml("If these are repeats", repeats) +
          report::ProvenanceHtml(provenance));
}

}  // namespace mindahl::request
