#include <fstream>
#include <variant>

#include "cli/command.h"
#include "mindahl/convert/conversion.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::cli {

using convert::TargetRow;

namespace {

struct ConvertOptions {
  std::string fit;  // file of `mindahl fit --json`, or a record: law and amplitude, unless given
  io::RecordColumns columns;  // of the record
  LawRequest law;
  std::optional<double> amplitude;  // X [m] of the contact's steady loop
  std::string from;                 // "masing", "dahl" or "": that of the fit, else masing
  std::string to;
  convert::ConversionOptions options = {};
  std::string input_lines_path;
};

/// Reads what `mindahl fit --json` wrote, or fits a record and says what was assumed of it.
Json ReadFit(const std::string& file, const io::RecordColumns& columns, Console& console) {
  std::ifstream stream(file);
  if (!stream) Refuse("{}: cannot be read", file);
  Json fit = Json::parse(stream, nullptr, /*allow_exceptions=*/false);
  if (fit.is_discarded() && !file.ends_with(".json")) {
    const FitRequest request{.files = {file}, .columns = columns};
    const report::Report report = FitRecords(request, ReadRecords(request));
    Say("convert: note", report.notes, console);
    if (!report.check.empty()) Say("convert: note", {report.check}, console);
    return report::DocumentOf(report);
  }
  const Json schema = report::At(fit, "/schema");
  if (schema.is_string() && schema.get<std::string>().starts_with("mindahl.fit/")) return fit;
  Refuse("{}: is not the result of a fit: give what `mindahl fit --json {}` writes", file, file);
}

const models::FrictionModel& ModelOf(const ConvertOptions& request) {
  return *models::FindFrictionModel(request.from == "dahl" ? "dahl" : "mindlin-dahl");
}

/// Takes law and amplitude from a fit where they are not given.
void TakeFit(const Json& fit, ConvertOptions& request) {
  if (request.from.empty()) request.from = report::At(fit, "/model") == "dahl" ? "dahl" : "masing";
  const auto take = [&](std::optional<double>& value, const std::string& place) {
    const Json found = report::At(fit, place);
    if (!value && found.is_number()) value = found.get<double>();
  };
  std::optional<double> drag;
  take(drag, "/parameters/drag_fraction/value");
  for (const auto& [value, name] : {std::pair(&request.law.sigma, "sigma"),
                                    {&request.law.alpha, "alpha"},
                                    {&request.law.slip_force, "slip_force"}}) {
    const std::string place = fmt::format("/parameters/{}", name);
    const Json known = report::At(fit, place + "/identifiability");
    const bool is_open = known == "not_identifiable" || known == "bounded_below";
    if (*value || (is_open && report::At(fit, place + "/status") != "fixed")) continue;
    take(*value, place + "/value");
    // The force of a drag, which no target has, is in both.
    if (drag && *value && name != std::string_view("alpha")) **value *= 1 - *drag;
  }
  const LawRequest& law = request.law;
  if (request.amplitude || !law.sigma || !law.slip_force) return;
  take(request.amplitude, "/measured/amplitude");
  std::optional<double> rig;
  take(rig, "/parameters/rig_stiffness/value");
  if (!rig || !request.amplitude) return;
  // The rest of the amplitude is the rig's.
  request.amplitude = models::ContactAmplitude(
      ModelOf(request), {*law.sigma, law.alpha.value_or(1.0 / 3), *law.slip_force},
      {.stiffness = *rig}, *request.amplitude);
}

/// Takes the load of a fit's slip force, as µ is of both.
void TakeLoad(const Json& fit, ConvertOptions& request) {
  constexpr double kSame = 0.01;  // as a load that varies by no more is constant
  std::optional<double>& load = request.options.normal_load;
  const Json found = report::At(fit, "/contact/normal_load/value");
  if (!found.is_number()) return;
  const auto of_fit = found.get<double>();
  if (load && std::abs(*load / of_fit - 1) > kSame) {
    Refuse(
        "--normal-load {} contradicts the fit, whose slip force is that at {:.6g} N: leave it out, "
        "or give --slip-force at that load",
        *load, of_fit);
  }
  load = of_fit;
}

double Require(const std::optional<double>& value, std::string_view option) {
  if (!value) Refuse("{} missing: give it, or a fit or record that determines it", option);
  return *value;
}

/// Returns an error in percent; what rounding leaves of two curves that are one is 0.
std::string Percent(double error) {
  constexpr double kRounding = 1e-9;
  return std::abs(error) < kRounding ? "0 %" : fmt::format("{:.3g} %", 100 * error);
}

void RunConvert(const ConvertOptions& given, Console& console) {
  ConvertOptions request = given;
  const TargetRow& target = *std::ranges::find(convert::Targets(), request.to, &TargetRow::name);
  std::vector<std::string> left_out;  // terms of the fit that no target has
  if (!request.fit.empty()) {
    const Json fit = ReadFit(request.fit, request.columns, console);
    TakeFit(fit, request);
    if (target.form == convert::Form::kSpring && !given.law.slip_force) TakeLoad(fit, request);
    if (!given.amplitude && report::At(fit, "/parameters/load_exponent").is_object() &&
        report::At(fit, "/input/files").size() > 1) {
      Say("convert: note",
          {"the fit's amplitude is of the file nearest to slip, at that file's load; sigma and the "
           "slip force are those at the mean load: --amplitude gives another"},
          console);
    }
    const Json verdict = report::At(fit, "/adequacy/verdict");
    if (verdict.is_string() && verdict != "adequate") {
      Say("convert: note",
          {fmt::format("the fit is {}: its values are converted, its intervals are not",
                       verdict.get<std::string>())},
          console);
    }
    left_out = fit.value(Json::json_pointer("/terms/added"), left_out);
    std::erase(left_out, "rig_stiffness");  // the amplitude is without it
    Require(request.law.alpha, "--alpha");
  }
  if (request.from.empty()) request.from = "masing";
  const models::BranchLaw law = {Require(request.law.sigma, "--sigma"),
                                 request.law.alpha.value_or(1.0 / 3),
                                 Require(request.law.slip_force, "--slip-force")};
  const double amplitude = Require(request.amplitude, "--amplitude");
  request.options.amplitude = amplitude;
  const double tolerance = request.options.tolerance;
  const auto made = convert::Convert({&ModelOf(request), law}, target, request.options);
  Json parameters = Json::object();
  for (const auto& [row, value] : made.parameters) {
    parameters[row.name] = {{"value", value}, {"unit", row.unit}, {"meaning", row.meaning}};
  }
  Json elements = Json::array();
  if (const auto* jenkins = std::get_if<methods::IwanElements>(&made.law)) {
    for (std::size_t j = 0; j < jenkins->size(); ++j) {
      elements.push_back(
          {{"stiffness", jenkins->stiffness[j]}, {"slip_force", jenkins->slip_force[j]}});
    }
  }
  const convert::LoopError& error = made.at_amplitude;
  std::string accuracy = fmt::format(
      "at {:.6g} m the force is within {} of T*, the energy {}", amplitude, Percent(error.force),
      std::isfinite(error.energy) ? "off by " + Percent(error.energy)
                                  : "lost where the contact loses none");
  if (!left_out.empty()) {
    accuracy += fmt::format(", of the law alone: without the fit's {}", fmt::join(left_out, ", "));
  }
  const auto& within = made.within;
  constexpr int kDigits = 8;
  const std::string text =
      fmt::format("{}; {}\n\n{}{}\n{}\n", target.title, accuracy,
                  report::TableText(parameters, kDigits), report::TableText(elements, kDigits),
                  within ? fmt::format("force and energy within {} from {:.4g} to {:.4g} m",
                                       Percent(tolerance), within->first, within->second)
                         : fmt::format("not within {} at the amplitude", Percent(tolerance)));
  Json from = {{"law", request.from}};
  from.update(report::LawJson(law));
  const std::string json = report::Document(
      "mindahl.convert/1",
      {{"from", std::move(from)},
       {"to", target.name},
       {"amplitude", amplitude},
       {"tolerance", tolerance},
       {"parameters", parameters},
       {"elements", elements},
       {"error_at_amplitude",
        {{"force", NumberOrNull(error.force)}, {"energy", NumberOrNull(error.energy)}}},
       {"within", within ? Json(*within) : Json()},
       {"left_out", left_out}});
  const std::string& lines_path = request.input_lines_path;
  if (!lines_path.empty()) {
    if (made.input_lines.empty()) {
      Refuse("--input-lines for LAMMPS need --normal-load: friction coefficient Tc/N");
    }
    // Lines for mindahl simulate are command line options, which cannot contain comments.
    const bool has_comments = !made.input_lines.front().starts_with("--");
    WriteText(fmt::format("{}{}\n", has_comments ? "# " + accuracy + '\n' : "",
                          fmt::join(made.input_lines, "\n")),
              lines_path, console);
  }
  WriteAnswer(console, json, lines_path == "-" ? "" : text);
}

}  // namespace

void AddConvertCommand(CLI::App& app, Console& console) {
  const auto [command, options] = AddCommand(
      app, console, "convert",
      "Converts a contact's steady loop to another law or program: the\n"
      "parameters, the remaining error, and the amplitudes at which it is\n"
      "small.",
      {"mindahl convert fit.json --to dahl",
       "mindahl convert --sigma 4e7 --slip-force 40 --amplitude 1.2e-6 --to iwan --elements 5 \\",
       "    --input-lines contact.tcl"},
      &RunConvert);
  const OptionGroup contact(command, "The contact");
  contact.Add("fit", options.fit,
              "what mindahl fit --json wrote, or a record to fit: law and amplitude,\nunless "
              "given below",
              "FILE");
  AddLawParameters(contact, options.law);
  contact.AddWord(
      "--from", options.from, {"masing", "dahl"},
      "law of these parameters: of fit --model mindlin-dahl or --model dahl;\ndefault the "
      "fit's, else masing");
  contact.AddQuantity("--amplitude", options.amplitude,
                      "amplitude X of the contact's steady loop [m], without the rig's travel", "M",
                      "m");
  AddColumnOptions(command, options.columns);
  const OptionGroup result(command, "What it becomes");
  result
      .AddWord("--to", options.to, NamesOf(convert::Targets(), &TargetRow::name), "law or program")
      ->required();
  result
      .AddQuantity("--tolerance", options.options.tolerance,
                   "largest error of force and energy at the amplitudes given as good:\n0.01 or 1%",
                   "E", "-")
      ->capture_default_str();
  result.AddCount("--elements", options.options.elements, "number of elements of --to iwan", 1,
                  10'000);
  result.AddQuantity(
      "--normal-load", options.options.normal_load,
      "normal load [N] for --to lammps: friction coefficient Tc/N;\ndefault the fit's", "N", "N");
  const OptionGroup outputs(command, "Output");
  outputs.Add("--input-lines", options.input_lines_path,
              "lines as the other program reads them; - for standard output", "PATH");
  outputs.AddJson(console);
}

}  // namespace mindahl::cli
