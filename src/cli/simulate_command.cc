#include <numeric>

#include "cli/command.h"
#include "core/draws.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/methods/method.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/simplified_law.h"
#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::cli {

using methods::Method;
using models::FrictionModel;
using models::Waveform;

namespace {

struct SimulateOptions {
  std::string model = "mindlin";
  LawRequest law;
  models::ExcitationOptions excitation{.cycles = 1.0};
  std::optional<double> lambda;
  std::optional<double> amplitude;
  std::string path;                 // a file with the motion, instead
  std::string displacement;         // column of that file; "": the first, or by its name
  double force_noise = 0.0;         // standard deviation [N]
  double displacement_noise = 0.0;  // standard deviation [m]
  std::uint64_t seed = 1;           // of the noise
  std::string method = "exact";
  std::optional<std::size_t> steps;
  std::string output;
};

/// Returns the imposed displacement: of a file with its rows as time; with an envelope if it grows.
models::Excitation MakeMotion(const SimulateOptions& options, const models::BranchLaw& law) {
  models::Excitation motion;
  if (!options.path.empty()) {
    motion.displacement = io::ImposedDisplacement(options.path, options.displacement);
    motion.time.resize(motion.displacement.size());
    std::iota(motion.time.begin(), motion.time.end(), 0.0);
    return motion;
  }
  models::ExcitationOptions excitation = options.excitation;
  if (excitation.growth != models::ExcitationOptions().growth &&
      excitation.waveform != Waveform::kGrowingSine) {
    Refuse("--growth has no effect unless --waveform is growing-sine: leave it out");
  }
  if (options.lambda.has_value() == options.amplitude.has_value()) {
    Refuse("--lambda or --amplitude, one of the two, must be given (or --path)");
  }
  excitation.amplitude = options.amplitude.value_or(0.0);
  if (options.lambda) {
    RequirePositive("--lambda [-]", *options.lambda);
    const double slip = GrossSlipDisplacement(law);
    if (!std::isfinite(slip)) {
      Refuse("--lambda: a law of alpha = {} has no gross-slip displacement: give --amplitude",
             law.shape_exponent);
    }
    excitation.amplitude = *options.lambda * slip;
  }
  motion = models::MakeExcitation(excitation);
  if (excitation.waveform != Waveform::kGrowingSine) motion.envelope.clear();
  return motion;
}

void RunSimulate(const SimulateOptions& options, Console& console) {
  RequireNonNegative("--noise-force [N]", options.force_noise);
  RequireNonNegative("--noise-displacement [m]", options.displacement_noise);
  const auto steps = options.steps.value_or(methods::FindMethod(options.method)->default_steps);
  const tradeoff::Approximation approximation{options.model, options.method, {.steps = steps}};
  const FrictionModel* model = models::FindFrictionModel(options.model);
  const models::BranchLaw law = ResolveLaw(options.law, options.model,
                                           model == nullptr ? std::nullopt : model->shape_exponent);
  models::Excitation motion = MakeMotion(options, law);
  std::vector<double> force(motion.displacement.size());
  Prepare(approximation, law)({motion.displacement, motion.envelope}, force);
  Draws draws(options.seed);
  for (const auto& [values, noise] : {std::pair(&force, options.force_noise),
                                      {&motion.displacement, options.displacement_noise}}) {
    if (noise == 0) continue;
    for (double& value : *values) value += noise * draws.Normal();
  }
  Say("simulate: warning", contact::DoubtsAbout(options.law.contact.known), console);
  WriteText(io::CsvText({{"time [s]", motion.time},
                         {"displacement [m]", motion.displacement},
                         {"force [N]", force}}),
            options.output.empty() ? "-" : options.output, console);
}

}  // namespace

void AddSimulateCommand(CLI::App& app, Console& console) {
  const auto [command, options] = AddCommand(
      app, console, "simulate",
      "Computes the tangential force along an imposed displacement,\n"
      "exactly for any history. The contact is unloaded at displacement\n"
      "zero; a first row that is not zero is the first loading step.\n"
      "Writes time [s], displacement [m], force [N].",
      {"mindahl simulate --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 2 -o loop.csv",
       "mindahl simulate --model dahl --sigma 4e7 --alpha 1 --slip-force 40 \\",
       "    --path path.csv --displacement \"[um]\""},
      &RunSimulate);
  const OptionGroup plain(command, kPlainGroup);
  std::vector<std::string> models = NamesOf(models::FrictionModels(), &FrictionModel::name);
  models.emplace_back(models::kSimplifiedDahl);
  plain.AddWord("--model", options.model, models, "friction model");
  AddLawParameters(OptionGroup(command, "Parameters"), options.law);
  AddContactOptions(command, options.law.contact, /*has_friction=*/true);
  const OptionGroup drive(command, "Excitation");
  drive.AddChoice("--waveform", options.excitation.waveform,
                  {{"sine", Waveform::kSine},
                   {"triangle", Waveform::kTriangle},
                   {"growing-sine", Waveform::kGrowingSine}},
                  "imposed displacement");
  drive.Add("--lambda", options.lambda, "amplitude over the gross-slip displacement [-]", "L");
  drive.AddQuantity("--amplitude", options.amplitude, "amplitude [m]", "M", "m");
  drive.AddShown("--cycles", options.excitation.cycles, "cycles [-]");
  drive.AddCount("--samples-per-cycle", options.excitation.samples_per_cycle,
                 "samples in a cycle; multiples of 4 put samples on the extremes", 4);
  drive.AddShown("--frequency", options.excitation.frequency, "frequency [Hz]");
  drive.AddShown("--growth", options.excitation.growth,
                 "growing sine: last amplitude over the first [-]");
  CLI::Option* const path = drive.AddPath(options.path, options.displacement);
  for (const char* name : {"--waveform", "--lambda", "--amplitude", "--cycles",
                           "--samples-per-cycle", "--frequency", "--growth"}) {
    path->excludes(command.get_option(name));
  }

  const OptionGroup noise(command, "Noise");
  noise.AddQuantity("--noise-force", options.force_noise, "standard deviation [N]", "N", "N");
  noise.AddQuantity("--noise-displacement", options.displacement_noise, "standard deviation [m]",
                    "M", "m");
  noise.AddCount("--seed", options.seed, "seed of the noise", 0);

  const OptionGroup method(command, "Method");
  std::string help = "how the response is computed; --steps counts, by default";
  for (const Method& of : methods::Methods()) {
    help += fmt::format("\n{}: {}", of.name, of.title);
    if (!of.steps.empty()) help += fmt::format(" ({} {})", of.default_steps, of.steps);
  }
  method.AddWord("--method", options.method, NamesOf(methods::Methods(), &Method::name), help);
  method.AddCount("--steps", options.steps,
                  "substeps a sample, elements of iwan, intervals of table");
  plain.Add("-o,--output", options.output, "CSV file; default standard output", "PATH");
}

}  // namespace mindahl::cli
