#include "cli/drive_options.h"

#include <string>
#include <vector>

#include "cli/contact_options.h"
#include "cli/options.h"

namespace mindahl::cli {
namespace {

std::vector<std::string> Waveforms() {
  return {models::WaveformNames().begin(), models::WaveformNames().end()};
}

}  // namespace

void AddDriveOptions(CLI::App& command, DriveOptions& request) {
  const std::string group = "Excitation";
  command.add_option("--waveform", request.waveform, "imposed displacement")
      ->capture_default_str()
      ->check(OneOf(Waveforms()))
      ->group(group);
  AddOptional(command, "--lambda", request.lambda, "amplitude over the gross-slip displacement [-]",
              "L")
      ->group(group);
  AddOptional(command, "--amplitude", request.amplitude, "amplitude [m]", "M")->group(group);
  command.add_option("--cycles", request.excitation.cycles, "cycles [-]")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--samples-per-cycle", request.excitation.samples_per_cycle,
                  "samples in a cycle; multiples of 4 put samples on the extremes")
      ->capture_default_str()
      ->check(WholeNumber(4, 1'000'000'000))
      ->group(group);
  command.add_option("--frequency", request.excitation.frequency, "frequency [Hz]")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--growth", request.excitation.growth,
                  "growing sine: last amplitude over the first [-]")
      ->capture_default_str()
      ->group(group);
  CLI::Option* path =
      command
          .add_option("--path", request.path,
                      "CSV file whose first column is the displacement [m], any sequence;\n"
                      "one output row for each, time counting rows")
          ->type_name("FILE")
          ->group(group);
  command.add_option("--path-unit", request.path_unit, "unit of that column, default the header's")
      ->type_name("UNIT")
      ->needs(path)
      ->group(group);
  for (const char* name : {"--waveform", "--lambda", "--amplitude", "--cycles",
                           "--samples-per-cycle", "--frequency", "--growth"}) {
    path->excludes(command.get_option(name));
  }
}

void AddLoadColumnOptions(CLI::App& command, DriveOptions& request) {
  CLI::Option* path = command.get_option("--path");
  CLI::Option* column =
      command
          .add_option("--normal-load-column", request.load_column,
                      "column of the file with the normal load N [N], which then varies: Tc = mu N")
          ->type_name("COL")
          ->needs(path)
          ->group("Excitation");
  command
      .add_option("--normal-load-unit", request.load_unit,
                  "unit of that column, default the header's")
      ->type_name("UNIT")
      ->needs(column)
      ->group("Excitation");
}

void AddForcePathOptions(CLI::App& command, DriveOptions& request) {
  const std::string group = "Excitation";
  CLI::Option* force_path =
      command
          .add_option("--force-path", request.force_path,
                      "CSV file whose first column is the force [N], any sequence within the\n"
                      "slip force: the displacement follows from it")
          ->type_name("FILE")
          ->group(group);
  command
      .add_option("--force-path-unit", request.force_path_unit,
                  "unit of that column, default the header's")
      ->type_name("UNIT")
      ->needs(force_path)
      ->group(group);
  for (const char* name : {"--waveform", "--lambda", "--amplitude", "--cycles",
                           "--samples-per-cycle", "--frequency", "--growth", "--path"}) {
    force_path->excludes(command.get_option(name));
  }
}

}  // namespace mindahl::cli
