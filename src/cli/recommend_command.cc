#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "cli/commands.h"
#include "cli/drive_options.h"
#include "cli/examples.h"
#include "cli/fit_request.h"
#include "cli/json_output.h"
#include "cli/law_options.h"
#include "cli/one_of.h"
#include "cli/output_path.h"
#include "cli/precision_table.h"
#include "cli/record_recommendation.h"
#include "cli/tolerance.h"
#include "cli/whole_number.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/models/limit_law.h"
#include "mindahl/tradeoff/recommendation.h"

namespace mindahl::cli {

using models::BranchLaw;
using tradeoff::Approximation;
using tradeoff::Candidate;
using tradeoff::Criterion;
using tradeoff::Recommendation;
using tradeoff::RecommendOptions;

namespace {

struct RecommendCommandOptions {
  LawOptions law;
  DriveOptions drive;
  std::string tolerance = "1%";
  std::optional<double> cost;
  std::string criterion = "max";
  std::size_t transient_cycles = 0;
  std::string record;
  io::RecordColumns columns;
  std::string json;
};

const std::map<std::string, Criterion>& Criteria() {
  static const std::map<std::string, Criterion> criteria = {
      {"max", Criterion::kMaxForce}, {"rms", Criterion::kRmsForce}, {"energy", Criterion::kEnergy}};
  return criteria;
}

std::string_view CriterionInWords(Criterion criterion) {
  switch (criterion) {
    case Criterion::kMaxForce:
      return "largest force error, of the peak force";
    case Criterion::kRmsForce:
      return "rms force error, of the peak force";
    case Criterion::kEnergy:
      break;
  }
  return "error of the dissipated energy";
}

/// The command that computes the same.
std::string CommandCall(const RecommendCommandOptions& options, const Approximation& approximation,
                        const BranchLaw& law) {
  std::string call = fmt::format("mindahl simulate --model {}", approximation.model);
  if (const methods::Method* method = methods::FindMethod(approximation.method)) {
    if (method->name != "exact") call += fmt::format(" --method {}", method->name);
    if (method->adaptive) {
      call += fmt::format(" --tolerance {:g}", approximation.resolution.tolerance);
    } else if (!method->steps.empty()) {
      call += fmt::format(" --steps {}", approximation.resolution.steps);
    }
  }
  const models::FrictionModel* model = models::FindFrictionModel(approximation.model);
  const BranchLaw own = tradeoff::LawOf(approximation, law);
  if (model == nullptr || model->shape_exponent) {
    call += fmt::format(" --sigma {} --slip-force {}", own.tangential_stiffness, own.slip_force);
  } else {
    call += " " + LawArguments(own);
  }
  if (!options.drive.path.empty()) {
    call += fmt::format(" --path '{}'", options.drive.path);
    if (!options.drive.path_unit.empty()) {
      call += fmt::format(" --path-unit {}", options.drive.path_unit);
    }
  } else {
    const models::ExcitationOptions& excitation = options.drive.excitation;
    call +=
        fmt::format(" --waveform {} {} --cycles {} --samples-per-cycle {}", options.drive.waveform,
                    options.drive.lambda ? fmt::format("--lambda {}", *options.drive.lambda)
                                         : fmt::format("--amplitude {}", *options.drive.amplitude),
                    excitation.cycles, excitation.samples_per_cycle);
    if (options.drive.waveform == "growing-sine") {
      call += fmt::format(" --growth {}", excitation.growth);
    }
    if (options.drive.waveform == "random") call += fmt::format(" --seed {}", options.drive.seed);
  }
  return call;
}

std::string LibraryCall(const Approximation& approximation, const BranchLaw& contact) {
  const BranchLaw law = tradeoff::LawOf(approximation, contact);
  const methods::Method* method = methods::FindMethod(approximation.method);
  std::string resolution;
  if (method != nullptr && method->adaptive) {
    resolution = fmt::format(", {{.tolerance = {:g}}}", approximation.resolution.tolerance);
  } else if (method != nullptr && !method->steps.empty()) {
    resolution = fmt::format(", {{.steps = {}}}", approximation.resolution.steps);
  }
  return fmt::format(
      "#include \"mindahl/tradeoff/approximation.h\"\n"
      "const mindahl::models::BranchLaw law{{.tangential_stiffness = {}, .shape_exponent = {}, "
      ".slip_force = {}}};\n"
      "const auto evaluate = mindahl::tradeoff::Prepare(mindahl::tradeoff::Approximation{{\"{}\", "
      "\"{}\"{}}}, law);\n"
      "evaluate({{.displacement = x}}, force);  // spans of one length, the contact unloaded at "
      "0\n",
      law.tangential_stiffness, law.shape_exponent, law.slip_force, approximation.model,
      approximation.method, resolution);
}

/// Returns the verdict on the scene in one line.
std::string RecommendationVerdict(const Recommendation& recommendation) {
  if (!recommendation.choice) return "nothing meets what is asked";
  const std::size_t choice = *recommendation.choice;
  const Approximation& approximation = recommendation.candidates[choice].point.approximation;
  if (choice == recommendation.exact) {
    return fmt::format("{}: nothing cheaper will do", tradeoff::Describe(approximation));
  }
  if (const models::LimitLaw* limit = models::FindLimitLaw(approximation.model)) {
    return fmt::format("{}: {}", approximation.model, limit->title);
  }
  return fmt::format("{}: {}", tradeoff::Describe(approximation),
                     models::FindFrictionModel(approximation.model)->title);
}

std::string AfterTransient(const Recommendation& recommendation) {
  const Candidate& candidate = recommendation.candidates[*recommendation.after_transient];
  return fmt::format("{} after {} cycle{}, {:.1f} ns/sample",
                     tradeoff::Describe(candidate.point.approximation), *candidate.settles_after,
                     *candidate.settles_after == 1 ? "" : "s", candidate.point.cost);
}

nlohmann::ordered_json RecommendationJson(const RecommendCommandOptions& options,
                                          const BranchLaw& law, const RecommendOptions& asked,
                                          std::size_t samples,
                                          const Recommendation& recommendation) {
  nlohmann::ordered_json json;
  json["schema"] = "mindahl.recommend/1";
  json["version"] = Version();
  json["excitation"] = {{"samples", samples},
                        {"cycles", recommendation.cycles},
                        {"peak_force", recommendation.peak_force}};
  json["law"] = {{"sigma", law.tangential_stiffness},
                 {"alpha", law.shape_exponent},
                 {"slip_force", law.slip_force}};
  json["criterion"] = options.criterion;
  json["tolerance"] = asked.tolerance;
  json["largest_cost"] = NumberOrNull(asked.largest_cost);
  json["transient_cycles"] = asked.transient_cycles;
  json["cost_floor"] = {{"memory_ns_per_sample", recommendation.floor.memory},
                        {"arithmetic_ns_per_sample", recommendation.floor.arithmetic}};
  const auto candidate_json = [](const Candidate& candidate) {
    nlohmann::ordered_json entry = PrecisionJson(candidate.point);
    entry["meets"] = candidate.meets;
    entry["settles_after_cycles"] = nullptr;
    if (candidate.settles_after) entry["settles_after_cycles"] = *candidate.settles_after;
    return entry;
  };
  json["verdict"] = RecommendationVerdict(recommendation);
  json["choice"] = nullptr;
  json["command"] = nullptr;
  json["cpp"] = nullptr;
  if (recommendation.choice) {
    const Candidate& choice = recommendation.candidates[*recommendation.choice];
    json["choice"] = candidate_json(choice);
    json["command"] = CommandCall(options, choice.point.approximation, law);
    json["cpp"] = LibraryCall(choice.point.approximation, law);
  }
  json["after_transient"] = nullptr;
  if (recommendation.after_transient) {
    json["after_transient"] =
        candidate_json(recommendation.candidates[*recommendation.after_transient]);
  }
  json["candidates"] = nlohmann::ordered_json::array();
  for (const Candidate& candidate : recommendation.candidates) {
    json["candidates"].push_back(candidate_json(candidate));
  }
  return json;
}

void PrintReport(const RecommendCommandOptions& options, const BranchLaw& law,
                 const RecommendOptions& asked, std::size_t samples,
                 const Recommendation& recommendation, std::ostream& out) {
  out << fmt::format("{} samples, {:.3g} cycles, peak force {:.6g} N\n", samples,
                     recommendation.cycles, recommendation.peak_force);
  if (asked.largest_cost) {
    out << fmt::format("asked: the most precise within {:g} ns/sample ({})\n", *asked.largest_cost,
                       CriterionInWords(asked.criterion));
  } else {
    out << fmt::format("asked: the cheapest within {:g} % ({})\n", 100 * asked.tolerance,
                       CriterionInWords(asked.criterion));
  }
  if (asked.transient_cycles > 0) {
    out << fmt::format("       errors count after {} cycles\n", asked.transient_cycles);
  }
  out << fmt::format("\n-> {}\n", RecommendationVerdict(recommendation));
  if (recommendation.after_transient) {
    out << fmt::format("   or, once its transient is over: {}\n", AfterTransient(recommendation));
  }
  if (recommendation.choice) {
    const Candidate& choice = recommendation.candidates[*recommendation.choice];
    const Candidate& exact = recommendation.candidates[recommendation.exact];
    if (*recommendation.choice != recommendation.exact) {
      out << fmt::format("   {:.1f} times as fast as the exact {}\n",
                         exact.point.cost / choice.point.cost, exact.point.approximation.model);
    }
    if (choice.point.approximation.law) {
      out << fmt::format("   with {}, which suit this excitation and belong to no other\n",
                         RefittedParameters(choice.point.approximation));
    }
    const auto& energy = choice.point.precision.energy;
    if (asked.criterion != Criterion::kEnergy && energy && *energy > asked.tolerance) {
      out << fmt::format(
          "   note: it misses {:.3g} % of the dissipated energy; where damping matters, ask with "
          "--criterion energy\n",
          100 * *energy);
    }
    out << fmt::format("\ncommand line:\n  {}\n\nC++:\n",
                       CommandCall(options, choice.point.approximation, law));
    const std::string call = LibraryCall(choice.point.approximation, law);
    std::string indented = "  ";
    for (std::size_t i = 0; i < call.size(); ++i) {
      indented += call[i];
      if (call[i] == '\n' && i + 1 < call.size()) indented += "  ";
    }
    out << indented;
  }
  out << fmt::format(
      "\nevidence, costs by counted operations (floor: one square root and division, "
      "{:.2f} ns/sample):\n  {}\n",
      recommendation.floor.arithmetic, PrecisionTableHead(/*is_timed=*/false));
  for (std::size_t i = 0; i < recommendation.candidates.size(); ++i) {
    const Candidate& candidate = recommendation.candidates[i];
    std::string remark;
    if (recommendation.choice == i) {
      remark = "<- this";
    } else if (candidate.meets) {
      remark = asked.largest_cost ? "cheap enough" : "meets it";
    } else if (candidate.settles_after && *candidate.settles_after > 0) {
      remark = fmt::format("force within {:g} % after {} cycle{}", 100 * asked.tolerance,
                           *candidate.settles_after, *candidate.settles_after == 1 ? "" : "s");
    }
    const std::string row = PrecisionTableRow(candidate.point, recommendation.floor.arithmetic);
    out << fmt::format("  {}{}\n", row, remark.empty() ? "" : "  " + remark);
  }
}

/// A record brings its contact, its motion and its tolerance.
void RunForRecord(const RecommendCommandOptions& options, const CLI::App& command,
                  Console& console) {
  for (const CLI::Option* option : command.get_options()) {
    const std::string& name = option->get_name();
    const bool is_of_record = name == "--record" || option->get_group() == kColumnGroup;
    if (option->count() == 0 || is_of_record || name == "--json") continue;
    throw InputError(fmt::format(
        "--record excludes {}: contact, motion and tolerance are those of the record", name));
  }
  std::vector<std::string> inputs = console.inputs;
  inputs.push_back(options.record);
  RequireOutputPaths({{"--json", options.json, /*dash_is_stdout=*/true}}, inputs);
  RecommendForRecord(options.record, options.columns, options.json, console);
}

void RunRecommend(const RecommendCommandOptions& options, Console& console) {
  RequireNoColumns(options.columns);
  Validate(options.law);
  RecommendOptions asked{.tolerance = ParseTolerance(options.tolerance),
                         .criterion = Criteria().at(options.criterion),
                         .largest_cost = options.cost,
                         .transient_cycles = options.transient_cycles};
  if (options.cost) RequirePositive("--cost [ns/sample]", *options.cost);
  std::vector<std::string> inputs = console.inputs;
  inputs.push_back(options.drive.path);
  RequireOutputPaths({{"--json", options.json, /*dash_is_stdout=*/true}}, inputs);
  const BranchLaw law = ResolveLaw(options.law);
  WarnOfDoubts(options.law.contact, "recommend", console);
  const ImposedMotion motion = MakeMotion(options.drive, law);
  const std::size_t samples = motion.displacement.size();
  const Recommendation recommendation = tradeoff::Recommend(law, motion.drive(), asked);
  if (options.json != "-") {
    PrintReport(options, law, asked, samples, recommendation, console.out);
  }
  if (!options.json.empty()) {
    WriteJson(RecommendationJson(options, law, asked, samples, recommendation), options.json,
              console);
  }
  if (!recommendation.choice) console.exit_status = kNotEstablished;
}

}  // namespace

void AddRecommendCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<RecommendCommandOptions>();
  CLI::App* command = app.add_subcommand(
      "recommend",
      "The cheapest model and method that meet a tolerance along a given displacement: each is\n"
      "run and compared with the exact Masing response of the contact (Mindlin's for alpha = "
      "1/3).");
  AddExamples(
      *command, app,
      {"mindahl recommend --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 3 --tolerance 1%",
       "mindahl recommend --record loop.csv"});
  AddLawOptions(*command, options->law);
  AddDriveOptions(*command, options->drive);
  command->add_option("--seed", options->drive.seed, "of the random waveform")
      ->capture_default_str()
      ->check(WholeNumber(0, std::numeric_limits<std::uint64_t>::max()))
      ->group("Excitation");
  const std::string asked = "What is asked";
  command
      ->add_option("--tolerance", options->tolerance,
                   "largest error allowed, of the peak force or the energy: 0.01 or 1%")
      ->capture_default_str()
      ->type_name("E")
      ->group(asked);
  AddOptional(*command, "--cost", options->cost,
              "the other way round: the most precise that costs no more [ns/sample]", "NS")
      ->group(asked);
  std::vector<std::string> names;
  for (const auto& [name, criterion] : Criteria()) names.push_back(name);
  command
      ->add_option("--criterion", options->criterion,
                   "error that counts: max or rms of the force, or the energy dissipated")
      ->capture_default_str()
      ->check(OneOf(names))
      ->group(asked);
  command
      ->add_option("--transient-cycles", options->transient_cycles,
                   "cycles at the start that do not count")
      ->capture_default_str()
      ->check(WholeNumber(0, 1'000'000'000))
      ->group(asked);
  command->add_option("--json", options->json, "results for scripts; - is standard output")
      ->type_name("PATH");
  command
      ->add_option("--record", options->record,
                   "measured record: the cheapest law that it does not tell from the best,\n"
                   "each fitted to it; instead of all of the above")
      ->type_name("FILE")
      ->group("What is asked");
  AddColumnOptions(*command, options->columns);
  command->callback([options, command, &console] {
    if (options->record.empty()) {
      RunRecommend(*options, console);
    } else {
      RunForRecord(*options, *command, console);
    }
  });
}

}  // namespace mindahl::cli
