#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/established.h"
#include "cli/examples.h"
#include "cli/file_list.h"
#include "cli/fit_records.h"
#include "cli/fit_request.h"
#include "cli/json_output.h"
#include "cli/output_path.h"
#include "cli/progress.h"
#include "cli/provenance.h"
#include "cli/whole_number.h"
#include "core/normal_quantile.h"
#include "mindahl/campaign/pages.h"
#include "mindahl/campaign/repeats.h"
#include "mindahl/core/error.h"
#include "mindahl/core/memory.h"
#include "mindahl/core/version.h"
#include "mindahl/io/csv_writer.h"
#include "mindahl/io/digest.h"
#include "mindahl/io/output_file.h"
#include "mindahl/report/json.h"
#include "mindahl/report/page.h"
#include "mindahl/report/report.h"
#include "report/statements.h"

namespace mindahl::cli {
namespace {

using Json = nlohmann::ordered_json;

struct BatchCommandOptions {
  FitRequest request;
  FileList list;
  Strictness strict = Strictness::kNone;
  std::size_t threads = std::max(1U, std::thread::hardware_concurrency());
  std::string output;
  std::string json_path;
  std::string report_directory;
  bool overwrite = false;
};

/// Holds the result of a file, or the fault for which it has none.
struct FileFit {
  bool done = false;     // fitted, and established as fit's exit status says it
  Json fit;              // of `fit --json`; null where there is none
  std::string fault;     // why not done
  std::string messages;  // notes and warnings of the run
  std::string sha256;    // of the file; "" for what cannot be read twice
  campaign::FileResult result;
};

/// A column of the table, and where `fit --json` has it.
struct BatchColumn {
  std::string_view name;
  std::string_view pointer;
};

constexpr std::array kColumns = {
    BatchColumn{"samples", "/input/samples"},
    BatchColumn{"model", "/model"},
    BatchColumn{"initial_state", "/initial_state"},
    BatchColumn{"adequacy", "/adequacy/verdict"},
    BatchColumn{"cycles", "/input/cycles"},
    BatchColumn{"amplitude", "/loop/amplitude"},
    BatchColumn{"peak_force", "/loop/peak_force"},
    BatchColumn{"half_gap", "/measured/half_gap/value"},
    BatchColumn{"sliding_amplitude", "/measured/sliding_amplitude"},
    BatchColumn{"energy_per_cycle", "/measured/energy_per_cycle"},
    BatchColumn{"energy_ratio", "/measured/energy_ratio"},
    BatchColumn{"sigma", "/parameters/sigma/value"},
    BatchColumn{"sigma_error", "/parameters/sigma/standard_error"},
    BatchColumn{"sigma_lower95", "/parameters/sigma/ci95/0"},
    BatchColumn{"sigma_upper95", "/parameters/sigma/ci95/1"},
    BatchColumn{"sigma_verdict", "/parameters/sigma/identifiability"},
    BatchColumn{"alpha", "/parameters/alpha/value"},
    BatchColumn{"alpha_error", "/parameters/alpha/standard_error"},
    BatchColumn{"alpha_lower95", "/parameters/alpha/ci95/0"},
    BatchColumn{"alpha_upper95", "/parameters/alpha/ci95/1"},
    BatchColumn{"alpha_verdict", "/parameters/alpha/identifiability"},
    BatchColumn{"slip_force", "/parameters/slip_force/value"},
    BatchColumn{"slip_force_error", "/parameters/slip_force/standard_error"},
    BatchColumn{"slip_force_lower95", "/parameters/slip_force/ci95/0"},
    BatchColumn{"slip_force_upper95", "/parameters/slip_force/ci95/1"},
    BatchColumn{"slip_force_verdict", "/parameters/slip_force/identifiability"},
    BatchColumn{"rms", "/residuals/rms"},
    BatchColumn{"r_squared", "/residuals/r_squared"},
    BatchColumn{"slip_regime", "/loop/slip_regime"},
    BatchColumn{"normal_load", "/contact/normal_load"},
    BatchColumn{"friction_coefficient", "/contact/friction_coefficient/value"},
    BatchColumn{"friction_coefficient_error", "/contact/friction_coefficient/standard_error"},
    BatchColumn{"contact_radius", "/contact/contact_radius/value"},
};

/// A quantity that repeats of a test have in common, by the names of its columns.
struct Repeated {
  std::string_view name;
  std::string_view verdict;
  std::string_view unit;
};
constexpr std::array kRepeated = {Repeated{"sigma", "sigma_verdict", "N/m"},
                                  Repeated{"alpha", "alpha_verdict", "-"},
                                  Repeated{"slip_force", "slip_force_verdict", "N"},
                                  Repeated{"friction_coefficient", "", "-"},
                                  Repeated{"half_gap", "", "N"},
                                  Repeated{"energy_per_cycle", "", "J"}};

Json ValueAt(const Json& fit, std::string_view pointer) {
  const Json::json_pointer at{std::string(pointer)};
  if (fit.is_null() || !fit.contains(at)) return nullptr;
  return fit.at(at);
}

Json ValueOf(const Json& fit, std::string_view column) {
  const auto found = std::ranges::find(kColumns, column, &BatchColumn::name);
  return found == kColumns.end() ? Json(nullptr) : ValueAt(fit, found->pointer);
}

/// Names the page of each file: its name without the directory and characters that a path may not
/// have, and a number where two files would have one page.
class PageNames {
 public:
  std::string Next(const std::string& file) {
    std::string stem = std::filesystem::path(file).stem().string();
    for (char& character : stem) {
      const auto byte = static_cast<unsigned char>(character);
      if (byte < 0x20 || std::string_view("<>:\"|?*\\").find(character) != std::string_view::npos) {
        character = '_';
      }
    }
    std::string name = stem;
    for (std::size_t number = 2; !taken_.insert(name).second; ++number) {
      name = fmt::format("{}-{}", stem, number);
    }
    return name + ".html";
  }

 private:
  std::set<std::string> taken_ = {"index"};
};

/// @param write_page  is given the report, and gives the name of its page
FileFit FitFile(const FitRequest& batch, const std::string& file, Strictness strict,
                const std::function<std::string(const report::Report&)>& write_page) {
  FileFit result;
  result.result.file = file;
  FitRequest request = batch;
  request.files = {file};
  std::ostringstream messages;
  try {
    result.sha256 = io::Sha256OfFile(file).value_or("");
    const report::Report report = FitRecords(request, {messages, "batch"});
    result.fit = Json::parse(report::ToJson(report));
    result.done = Established(report.fit, strict);
    result.result.verdict = report::VerdictWord(report);
    result.result.parameters = report.fit.parameters;
    if (write_page) result.result.page = write_page(report);
    if (!result.done) {
      result.fault = report.fit.converged ? "not established: the model is not adequate or a free "
                                            "parameter not identifiable"
                                          : report.fit.solver.message;
    }
  } catch (const InputError& error) {
    result.fault = error.what();
  } catch (const InvalidArgument& error) {
    result.fault = fmt::format("{}: {}", file, error.what());
  } catch (const std::bad_alloc&) {
    result.fault = fmt::format("{}: {}", file, OutOfMemoryText());
  }
  // A page that cannot be written, too, leaves a file that is not done.
  result.done = result.done && result.fault.empty();
  result.messages = messages.str();
  result.result.fault = result.fault;
  return result;
}

/// Fits the files and returns them in their order, whatever the number of threads.
std::vector<FileFit> FitFiles(const BatchCommandOptions& options, const CLI::App& command,
                              const Console& console, Progress& progress) {
  const std::vector<std::string>& files = options.request.files;
  std::vector<FileFit> fits;
  std::deque<std::future<FileFit>> at_work;
  PageNames names;
  std::size_t threads = options.threads;
  for (std::size_t next = 0; fits.size() < files.size();) {
    while (next < files.size() && at_work.size() < threads) {
      const std::string& file = files[next];
      std::function<std::string(const report::Report&)> write_page;
      if (!options.report_directory.empty()) {
        write_page = [&, page = names.Next(file)](const report::Report& report) {
          io::WriteFileAtomically(
              std::filesystem::path(options.report_directory) / page,
              report::ToPage(report, ProvenanceOfOneFit(command, console, file)));
          return page;
        };
      }
      const auto fit = [&options, &file, write_page] {
        return FitFile(options.request, file, options.strict, write_page);
      };
      try {
        at_work.push_back(std::async(std::launch::async, fit));
      } catch (const std::system_error&) {  // no other thread: those that there are will do
        threads = std::max<std::size_t>(1, at_work.size());
        at_work.push_back(std::async(std::launch::deferred, fit));
      }
      ++next;
    }
    fits.push_back(at_work.front().get());
    at_work.pop_front();
    progress.Say(fmt::format("fitted {} of {} files", fits.size(), files.size()));
  }
  return fits;
}

std::string CellOf(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return io::CsvCell(value.get<std::string>());
  return value.dump();  // as many digits as read back the same double
}

std::string WarningsOf(const Json& fit) {
  std::vector<std::string> codes;
  for (const Json& warning : ValueAt(fit, "/warnings")) codes.push_back(warning["code"]);
  return fmt::format("{}", fmt::join(codes, " "));
}

std::string TableOf(const std::vector<std::string>& files, const std::vector<FileFit>& fits) {
  std::string table = "file,done";
  for (const BatchColumn& column : kColumns) table += fmt::format(",{}", column.name);
  table += ",warnings,fault,version,sha256\n";
  for (std::size_t k = 0; k < files.size(); ++k) {
    const FileFit& fit = fits[k];
    table += fmt::format("{},{}", io::CsvCell(files[k]), fit.done ? "yes" : "no");
    for (const BatchColumn& column : kColumns) {
      table += "," + CellOf(ValueAt(fit.fit, column.pointer));
    }
    table += fmt::format(",{},{},{},{}\n", WarningsOf(fit.fit),
                         fit.fault.empty() ? "" : io::CsvCell(fit.fault), Version(), fit.sha256);
  }
  return table;
}

/// True of what is measured without a model, which states no error.
bool IsMeasured(const Repeated& quantity) {
  return quantity.name == "half_gap" || quantity.name == "energy_per_cycle";
}

/// One standard error: of an interval that is inflated beyond the noise, a fraction of that.
std::optional<double> StatedError(const Json& fit, const Repeated& quantity) {
  if (IsMeasured(quantity)) return std::nullopt;
  const std::string_view name = quantity.name;
  const Json error = ValueOf(fit, std::string(name) + "_error");
  if (!error.is_number() || !(error.get<double>() > 0)) return std::nullopt;
  const Json lower = ValueOf(fit, std::string(name) + "_lower95");
  const Json upper = ValueOf(fit, std::string(name) + "_upper95");
  if (!lower.is_number() || !upper.is_number()) return error.get<double>();
  constexpr double kWidth = 2 * kNormalQuantile95;  // in standard errors
  return std::max(error.get<double>(), (upper.get<double>() - lower.get<double>()) / kWidth);
}

std::optional<campaign::Repeats> RepeatsOf(const std::vector<FileFit>& fits,
                                           const Repeated& quantity) {
  std::vector<double> values;
  std::vector<double> errors;
  for (const FileFit& fit : fits) {
    const Json value = ValueOf(fit.fit, quantity.name);
    const std::optional<double> error = StatedError(fit.fit, quantity);
    const Json verdict = ValueOf(fit.fit, quantity.verdict);
    const bool is_known = verdict.is_null() || verdict == "identifiable" || verdict == "effective";
    if (!fit.done || !value.is_number() || !is_known) continue;
    if (!IsMeasured(quantity) && !error) continue;
    values.push_back(value);
    if (error) errors.push_back(*error);
  }
  return campaign::DescribeRepeats(values, errors);
}

std::string TextOf(const std::vector<FileFit>& fits, const BatchCommandOptions& options) {
  const auto done = std::ranges::count_if(fits, &FileFit::done);
  std::string text =
      fmt::format("{} of {} files fitted, in {}\n", done, fits.size(), options.output);
  std::string scatter;
  for (const Repeated& quantity : kRepeated) {
    const std::optional<campaign::Repeats> found = RepeatsOf(fits, quantity);
    if (!found) continue;
    scatter += fmt::format("  {:<22}{:>6}{:>14.6g}{:>14.2g}{:>14}   {}\n", quantity.name,
                           found->count, found->mean, found->standard_deviation,
                           found->stated_error ? fmt::format("{:.2g}", *found->stated_error) : "-",
                           found->InWords());
  }
  if (!scatter.empty()) {
    text += fmt::format("\nif these are repeats:\n  {:<22}{:>6}{:>14}{:>14}{:>14}\n", "", "files",
                        "mean", "scatter", "stated error") +
            scatter;
  }
  return text;
}

Json OrNull(const std::optional<double>& number) { return number ? Json(*number) : Json(nullptr); }

Json JsonOf(const std::vector<FileFit>& fits, const BatchCommandOptions& options) {
  Json json;
  json["schema"] = "mindahl.batch/1";
  json["version"] = Version();
  json["output"] = options.output;
  Json files = Json::array();
  for (std::size_t k = 0; k < fits.size(); ++k) {
    files.push_back({{"file", options.request.files[k]},
                     {"done", fits[k].done},
                     {"fault", fits[k].fault.empty() ? Json(nullptr) : Json(fits[k].fault)},
                     {"fit", fits[k].fit}});
  }
  json["files"] = files;
  Json repeats = Json::object();
  for (const Repeated& quantity : kRepeated) {
    const std::optional<campaign::Repeats> found = RepeatsOf(fits, quantity);
    if (!found) continue;
    repeats[std::string(quantity.name)] = {{"files", found->count},
                                           {"mean", found->mean},
                                           {"standard_deviation", found->standard_deviation},
                                           {"stated_error", OrNull(found->stated_error)},
                                           {"p_value", OrNull(found->p_value)}};
  }
  json["repeats"] = repeats;
  return json;
}

/// A directory that is there, or can be made where it is to be, and no file that is written.
void RequireReportDirectory(const BatchCommandOptions& options) {
  const std::string& directory = options.report_directory;
  if (directory.empty()) return;
  for (const auto& [option, path] :
       {std::pair("--output", options.output), {"--json", options.json_path}}) {
    RequireDistinctOutputs({option, path}, {"--report", directory});
  }
  std::error_code error;
  if (std::filesystem::is_directory(directory, error)) return;
  if (std::filesystem::exists(directory, error)) {
    throw InputError(
        fmt::format("--report: '{}' is a file: give a directory for the pages", directory));
  }
  if (!std::filesystem::create_directory(directory, error)) {
    throw InputError(
        fmt::format("--report: cannot make the directory '{}': {}", directory, error.message()));
  }
}

std::string IndexOf(const std::vector<FileFit>& fits, const report::Provenance& provenance) {
  std::vector<campaign::FileResult> results;
  results.reserve(fits.size());
  for (const FileFit& fit : fits) results.push_back(fit.result);
  std::vector<campaign::RepeatedQuantity> repeated;
  for (const Repeated& quantity : kRepeated) {
    const std::optional<campaign::Repeats> found = RepeatsOf(fits, quantity);
    if (!found) continue;
    repeated.push_back({.name = std::string(quantity.name),
                        .unit = std::string(quantity.unit),
                        .repeats = *found});
  }
  return campaign::BatchIndexPage(results, repeated, provenance);
}

void RunBatch(const BatchCommandOptions& options, const CLI::App& command, Console& console) {
  const FitRequest& request = options.request;
  Validate(request.contact);
  RequireDistinctFiles(request.files);
  std::vector<std::string> read = console.inputs;
  read.insert(read.end(), request.files.begin(), request.files.end());
  RequireOutputPaths(
      {{"--output", options.output}, {"--json", options.json_path, /*dash_is_stdout=*/true}}, read);
  if (!options.overwrite) RequireNotThere({"--output", options.output}, "--overwrite");
  MakeFitOptions(request);  // what is wrong with the options is no fault of a file
  RequireReportDirectory(options);
  std::vector<FileFit> fits;
  {
    Progress progress(console.err, "fitting files");
    fits = FitFiles(options, command, console, progress);
  }
  for (std::size_t k = 0; k < fits.size(); ++k) {
    console.err << fits[k].messages;
    if (fits[k].fault.empty()) continue;
    console.err << fmt::format("mindahl batch: warning: {}: {}\n", request.files[k], fits[k].fault);
  }
  io::WriteFileAtomically(options.output, TableOf(request.files, fits));
  if (!options.report_directory.empty()) {
    io::WriteFileAtomically(std::filesystem::path(options.report_directory) / "index.html",
                            IndexOf(fits, ProvenanceOf(command, console, request.files)));
  }
  if (!options.json_path.empty()) WriteJson(JsonOf(fits, options), options.json_path, console);
  if (options.json_path != "-") console.out << TextOf(fits, options);
  console.exit_status = std::ranges::all_of(fits, &FileFit::done) ? kDone : kNotEstablished;
}

}  // namespace

void AddBatchCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<BatchCommandOptions>();
  CLI::App* command =
      app.add_subcommand("batch",
                         "Fits each file on its own, with any option of fit for all of them:\n"
                         "one row a file, and the scatter between files beside their stated\n"
                         "errors. A file that fails does not stop the others: exit status 3\n"
                         "when any did.");
  AddExamples(
      *command, app,
      {"mindahl batch run1.csv run2.csv run3.csv --output table.csv --normal-load 50",
       "mindahl batch run1.csv run2.csv run3.csv --output mindlin.csv --model mindlin --strict"});
  command->add_option("files", options->request.files, "CSV records, each a test of its own")
      ->type_name("FILE");
  AddFilesFrom(*command, options->list);
  AddShard(*command, options->list);
  AddFitOptions(*command, options->request, NormalLoads::kOne);
  const std::string group = "Results";
  command->add_option("--output", options->output, "table as CSV, one row a file, in SI units")
      ->type_name("PATH")
      ->required()
      ->group(group);
  command
      ->add_option("--json", options->json_path,
                   "what fit says of each as JSON; - for standard output alone")
      ->type_name("PATH")
      ->group(group);
  command
      ->add_option("--report", options->report_directory,
                   "directory for a page of HTML a file, and index.html with all of\n"
                   "them; made where it is not there")
      ->type_name("DIR")
      ->group(group);
  command
      ->add_option("--threads", options->threads,
                   "that fit; the results do not depend on it; default one a core")
      ->check(WholeNumber(1, 1024))
      ->group(group);
  command->add_flag("--overwrite", options->overwrite, "write over a table that is there")
      ->group(group);
  AddStrict(*command, options->strict, "a file fails too", group);
  command->callback([options, command, &console] {
    options->request.files = FilesOf(options->request.files, options->list);
    RunBatch(*options, *command, console);
  });
}

}  // namespace mindahl::cli
