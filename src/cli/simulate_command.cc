#include <fmt/format.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/contact_options.h"
#include "cli/contact_parameters.h"
#include "cli/whole_number.h"
#include "mindahl/core/error.h"
#include "mindahl/io/atomic_file.h"
#include "mindahl/io/csv_writer.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/response.h"

namespace mindahl::cli {
namespace {

struct SimulateOptions {
  std::string model = "mindlin";
  std::optional<double> sigma;
  std::optional<double> alpha;
  std::optional<double> slip_force;
  ContactOptions contact;
  std::string waveform = "sine";
  std::optional<double> lambda;
  std::optional<double> amplitude;
  ExcitationOptions excitation{.cycles = 1.0};
  std::string path;
  std::string path_unit;
  double force_noise = 0.0;
  double displacement_noise = 0.0;
  std::uint64_t seed = 1;
  std::string method = "exact";
  std::string output;
};

/// What drives the contact: one displacement a row.
struct Drive {
  std::vector<double> time;
  std::vector<double> displacement;
  std::vector<double> envelope;  // empty unless the amplitude changes along the way
};

BranchLaw LawFromParameters(const SimulateOptions& options) {
  if (!options.sigma || !options.slip_force) {
    throw InputError(fmt::format(
        "{} missing: give --sigma and --slip-force, or a contact (--friction, --normal-load, "
        "--contact-radius, --compliance or materials and radii)",
        options.sigma ? "--slip-force" : "--sigma"));
  }
  return {.tangential_stiffness = *options.sigma, .slip_force = *options.slip_force};
}

BranchLaw ResolveLaw(const SimulateOptions& options, const FrictionModel& model) {
  const bool by_parameters = options.sigma || options.slip_force;
  const bool by_contact = IsAnythingGiven(options.contact);
  if (by_parameters && by_contact) {
    throw InputError(
        "--sigma and --slip-force exclude --friction, --normal-load and whatever else describes a "
        "contact: give one of the two");
  }
  BranchLaw law;
  if (by_contact) {
    const MindlinDahlParameters dahl = ResolveContact(options.contact).dahl;
    law = {dahl.tangential_stiffness, dahl.shape_exponent, dahl.slip_force};
  } else {
    law = LawFromParameters(options);
  }
  if (model.shape_exponent) {
    if (options.alpha && *options.alpha != *model.shape_exponent) {
      throw InputError(fmt::format(
          "--alpha {} contradicts --model {}, whose alpha is {}: use --model mindlin-dahl",
          *options.alpha, model.name, *model.shape_exponent));
    }
    law.shape_exponent = *model.shape_exponent;
  } else if (options.alpha) {
    law.shape_exponent = *options.alpha;
  }
  Validate(law);
  return law;
}

Drive DriveFromFile(const SimulateOptions& options) {
  Drive drive;
  drive.displacement =
      ReadDisplacementPath(options.path, {.column = "", .unit = options.path_unit});
  for (std::size_t i = 0; i < drive.displacement.size(); ++i) {
    drive.time.push_back(static_cast<double>(i));
  }
  return drive;
}

Drive DriveFromWaveform(const SimulateOptions& options, const BranchLaw& law) {
  ExcitationOptions excitation = options.excitation;
  excitation.waveform = *FindWaveform(options.waveform);
  if (options.lambda.has_value() == options.amplitude.has_value()) {
    throw InputError("--lambda or --amplitude, one of the two, must be given (or --path)");
  }
  if (options.lambda) {
    RequirePositive("--lambda [-]", *options.lambda);
    const double gross_slip = GrossSlipDisplacement(law);
    if (!std::isfinite(gross_slip)) {
      throw InputError(fmt::format(
          "--lambda needs a finite gross-slip displacement, which alpha = {} >= 1 has not: give "
          "--amplitude",
          law.shape_exponent));
    }
    excitation.amplitude = *options.lambda * gross_slip;
  } else {
    RequirePositive("--amplitude [m]", *options.amplitude);
    excitation.amplitude = *options.amplitude;
  }
  Excitation made = MakeExcitation(excitation);
  Drive drive{std::move(made.time), std::move(made.displacement), {}};
  if (excitation.waveform == Waveform::kGrowingSine) drive.envelope = std::move(made.envelope);
  return drive;
}

std::vector<double> Respond(const FrictionModel& model, const BranchLaw& law, const Drive& drive) {
  // Only a model that refers to its steady loop sees the envelope.
  const bool follows_envelope = !drive.envelope.empty() && model.scaled_by_peak;
  const LoadingPath path =
      follows_envelope ? MakeEnvelopePath(drive.displacement, drive.envelope, 0.0)
                       : MakeLoadingPath(drive.displacement, FindReversals(drive.displacement, 0.0),
                                         model.memory, {.state = InitialState::kVirgin});
  std::vector<double> force(drive.displacement.size());
  EvaluateForce(model, law, path, drive.displacement, force);
  return force;
}

void AddNoise(std::vector<double>& values, double standard_deviation,
              boost::random::mt19937_64& engine) {
  if (standard_deviation == 0) return;
  boost::random::normal_distribution<double> normal(0.0, standard_deviation);
  for (double& value : values) value += normal(engine);
}

void RunSimulate(const SimulateOptions& options, Console& console) {
  Validate(options.contact);
  RequireNonNegative("--noise-force [N]", options.force_noise);
  RequireNonNegative("--noise-displacement [m]", options.displacement_noise);
  const FrictionModel& model = *FindFrictionModel(options.model);
  const BranchLaw law = ResolveLaw(options, model);
  Drive drive = options.path.empty() ? DriveFromWaveform(options, law) : DriveFromFile(options);
  std::vector<double> force = Respond(model, law, drive);

  boost::random::mt19937_64 engine(options.seed);
  AddNoise(force, options.force_noise, engine);
  AddNoise(drive.displacement, options.displacement_noise, engine);
  const std::string text = CsvText(
      {{"time [s]", drive.time}, {"displacement [m]", drive.displacement}, {"force [N]", force}});
  if (options.output.empty() || options.output == "-") {
    console.out << text;
  } else {
    WriteFileAtomically(options.output, text);
  }
}

std::vector<std::string> ModelNames() {
  std::vector<std::string> names;
  for (const FrictionModel& model : FrictionModels()) names.emplace_back(model.name);
  return names;
}

}  // namespace

void AddSimulateCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = app.add_subcommand(
      "simulate",
      "Tangential force of a model along an imposed displacement, exact for any history.\n"
      "The contact is unloaded at displacement zero; a first row that is not zero is the first\n"
      "loading step. Writes time [s], displacement [m], force [N].");
  command->add_option("--model", options->model, "friction model")
      ->capture_default_str()
      ->check(CLI::IsMember(ModelNames()));
  const std::string parameters = "Parameters";
  AddOptional(*command, "--sigma", options->sigma, "tangential stiffness sigma [N/m]", "N/M")
      ->group(parameters);
  AddOptional(*command, "--alpha", options->alpha,
              "shape exponent [-], default 1/3 where the model leaves it free", "ALPHA")
      ->group(parameters);
  AddOptional(*command, "--slip-force", options->slip_force, "slip force Tc [N]", "N")
      ->group(parameters);
  AddContactOptions(*command, options->contact);
  AddFrictionOption(*command, options->contact);

  const std::string excitation = "Excitation";
  command->add_option("--waveform", options->waveform, "imposed displacement")
      ->capture_default_str()
      ->check(CLI::IsMember({"sine", "triangle", "growing-sine"}))
      ->group(excitation);
  AddOptional(*command, "--lambda", options->lambda,
              "amplitude over the gross-slip displacement [-]", "L")
      ->group(excitation);
  AddOptional(*command, "--amplitude", options->amplitude, "amplitude [m]", "M")->group(excitation);
  command->add_option("--cycles", options->excitation.cycles, "cycles [-]")
      ->capture_default_str()
      ->group(excitation);
  command
      ->add_option("--samples-per-cycle", options->excitation.samples_per_cycle,
                   "samples in a cycle; multiples of 4 put samples on the extremes")
      ->capture_default_str()
      ->check(WholeNumber(4, 1'000'000'000))
      ->group(excitation);
  command->add_option("--frequency", options->excitation.frequency, "frequency [Hz]")
      ->capture_default_str()
      ->group(excitation);
  command
      ->add_option("--growth", options->excitation.growth,
                   "growing sine: last amplitude over the first [-]")
      ->capture_default_str()
      ->group(excitation);
  CLI::Option* path =
      command
          ->add_option("--path", options->path,
                       "CSV file whose first column is the displacement [m], any sequence; one "
                       "output row for each, time counting rows")
          ->type_name("FILE")
          ->group(excitation);
  command
      ->add_option("--path-unit", options->path_unit, "unit of that column, default the header's")
      ->type_name("UNIT")
      ->needs(path)
      ->group(excitation);
  for (const char* name : {"--waveform", "--lambda", "--amplitude", "--cycles",
                           "--samples-per-cycle", "--frequency", "--growth"}) {
    path->excludes(command->get_option(name));
  }

  const std::string noise = "Noise";
  command->add_option("--noise-force", options->force_noise, "standard deviation [N]")
      ->type_name("N")
      ->group(noise);
  command->add_option("--noise-displacement", options->displacement_noise, "standard deviation [m]")
      ->type_name("M")
      ->group(noise);
  command->add_option("--seed", options->seed, "of the noise")
      ->capture_default_str()
      ->check(WholeNumber(0, std::numeric_limits<std::uint64_t>::max()))
      ->group(noise);

  command
      ->add_option("--method", options->method,
                   "how the response is computed: exact, the closed form without time steps")
      ->capture_default_str()
      ->check(CLI::IsMember({"exact"}));
  command->add_option("-o,--output", options->output, "CSV file; default standard output")
      ->type_name("FILE");
  command->callback([options, &console] { RunSimulate(*options, console); });
}

}  // namespace mindahl::cli
