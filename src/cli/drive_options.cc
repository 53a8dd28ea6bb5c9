#include "cli/drive_options.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "cli/contact_options.h"
#include "cli/one_of.h"
#include "cli/whole_number.h"
#include "mindahl/core/error.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::cli {
namespace {

/// Time counts rows.
std::vector<double> CountRows(std::size_t rows) {
  std::vector<double> time(rows);
  std::iota(time.begin(), time.end(), 0.0);
  return time;
}

ImposedMotion MotionFromFile(const DriveOptions& options) {
  ImposedMotion motion;
  const io::ColumnChoice displacement{.column = "", .unit = options.path_unit};
  if (options.load_column.empty()) {
    motion.displacement = io::ReadDisplacementPath(options.path, displacement);
  } else {
    io::LoadedPath loaded = io::ReadLoadedPath(
        options.path, displacement, {.column = options.load_column, .unit = options.load_unit});
    motion.displacement = std::move(loaded.displacement);
    motion.normal_load = std::move(loaded.normal_load);
  }
  motion.time = CountRows(motion.displacement.size());
  return motion;
}

ImposedMotion MotionFromWaveform(const DriveOptions& options, const models::BranchLaw& law) {
  models::ExcitationOptions excitation = options.excitation;
  excitation.waveform = *models::FindWaveform(options.waveform);
  excitation.seed = options.seed;
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
  models::Excitation made = models::MakeExcitation(excitation);
  ImposedMotion motion{std::move(made.time), std::move(made.displacement), {}, {}};
  if (excitation.waveform == models::Waveform::kGrowingSine)
    motion.envelope = std::move(made.envelope);
  return motion;
}

std::vector<std::string> Waveforms() {
  return {models::WaveformNames().begin(), models::WaveformNames().end()};
}

}  // namespace

void AddDriveOptions(CLI::App& command, DriveOptions& options) {
  const std::string group = "Excitation";
  command.add_option("--waveform", options.waveform, "imposed displacement")
      ->capture_default_str()
      ->check(OneOf(Waveforms()))
      ->group(group);
  AddOptional(command, "--lambda", options.lambda, "amplitude over the gross-slip displacement [-]",
              "L")
      ->group(group);
  AddOptional(command, "--amplitude", options.amplitude, "amplitude [m]", "M")->group(group);
  command.add_option("--cycles", options.excitation.cycles, "cycles [-]")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--samples-per-cycle", options.excitation.samples_per_cycle,
                  "samples in a cycle; multiples of 4 put samples on the extremes")
      ->capture_default_str()
      ->check(WholeNumber(4, 1'000'000'000))
      ->group(group);
  command.add_option("--frequency", options.excitation.frequency, "frequency [Hz]")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--growth", options.excitation.growth,
                  "growing sine: last amplitude over the first [-]")
      ->capture_default_str()
      ->group(group);
  CLI::Option* path =
      command
          .add_option("--path", options.path,
                      "CSV file whose first column is the displacement [m], any sequence;\n"
                      "one output row for each, time counting rows")
          ->type_name("FILE")
          ->group(group);
  command.add_option("--path-unit", options.path_unit, "unit of that column, default the header's")
      ->type_name("UNIT")
      ->needs(path)
      ->group(group);
  for (const char* name : {"--waveform", "--lambda", "--amplitude", "--cycles",
                           "--samples-per-cycle", "--frequency", "--growth"}) {
    path->excludes(command.get_option(name));
  }
}

void AddLoadColumnOptions(CLI::App& command, DriveOptions& options) {
  CLI::Option* path = command.get_option("--path");
  CLI::Option* column =
      command
          .add_option("--normal-load-column", options.load_column,
                      "column of the file with the normal load N [N], which then varies: Tc = mu N")
          ->type_name("COL")
          ->needs(path)
          ->group("Excitation");
  command
      .add_option("--normal-load-unit", options.load_unit,
                  "unit of that column, default the header's")
      ->type_name("UNIT")
      ->needs(column)
      ->group("Excitation");
}

void AddForcePathOptions(CLI::App& command, DriveOptions& options) {
  const std::string group = "Excitation";
  CLI::Option* force_path =
      command
          .add_option("--force-path", options.force_path,
                      "CSV file whose first column is the force [N], any sequence within the\n"
                      "slip force: the displacement follows from it")
          ->type_name("FILE")
          ->group(group);
  command
      .add_option("--force-path-unit", options.force_path_unit,
                  "unit of that column, default the header's")
      ->type_name("UNIT")
      ->needs(force_path)
      ->group(group);
  for (const char* name : {"--waveform", "--lambda", "--amplitude", "--cycles",
                           "--samples-per-cycle", "--frequency", "--growth", "--path"}) {
    force_path->excludes(command.get_option(name));
  }
}

ImposedForce ReadImposedForce(const DriveOptions& options, const models::BranchLaw& law) {
  io::ForcePath path =
      io::ReadForcePath(options.force_path, {.column = "", .unit = options.force_path_unit});
  for (std::size_t i = 0; i < path.force.size(); ++i) {
    if (std::abs(path.force[i]) < law.slip_force) continue;
    throw InputError(fmt::format(
        "{}:{}: a force of {} N is not within the slip force, {} N, at which the contact slides "
        "any distance: keep forces below it, or impose the displacement with --path",
        options.force_path, path.lines[i], path.force[i], law.slip_force));
  }
  return {CountRows(path.force.size()), std::move(path.force)};
}

ImposedMotion MakeMotion(const DriveOptions& options, const models::BranchLaw& law) {
  return options.path.empty() ? MotionFromWaveform(options, law) : MotionFromFile(options);
}

}  // namespace mindahl::cli
