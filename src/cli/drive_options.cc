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
  const OptionGroup group(command, "Excitation");
  group.AddShown("--waveform", request.waveform, "imposed displacement").OneOf(Waveforms());
  group.Add("--lambda", request.lambda, "amplitude over the gross-slip displacement [-]", "L");
  group.Add("--amplitude", request.amplitude, "amplitude [m]", "M");
  group.AddShown("--cycles", request.excitation.cycles, "cycles [-]");
  group
      .AddShown("--samples-per-cycle", request.excitation.samples_per_cycle,
                "samples in a cycle; multiples of 4 put samples on the extremes")
      .WholeNumber(4, 1'000'000'000);
  group.AddShown("--frequency", request.excitation.frequency, "frequency [Hz]");
  group.AddShown("--growth", request.excitation.growth,
                 "growing sine: last amplitude over the first [-]");
  const Option path =
      group.Add("--path", request.path,
                "CSV file whose first column is the displacement [m], any sequence;\n"
                "one output row for each, time counting rows",
                "FILE");
  group.Add("--path-unit", request.path_unit, "unit of that column, default the header's", "UNIT")
      .Needs(path);
  for (const char* name : {"--waveform", "--lambda", "--amplitude", "--cycles",
                           "--samples-per-cycle", "--frequency", "--growth"}) {
    path.Excludes(FindOption(command, name));
  }
}

void AddLoadColumnOptions(CLI::App& command, DriveOptions& request) {
  const Option path = FindOption(command, "--path");
  const Option column =
      OptionGroup(command, "Excitation")
          .Add("--normal-load-column", request.load_column,
               "column of the file with the normal load N [N], which then varies: Tc = mu N", "COL")
          .Needs(path);
  OptionGroup(command, "Excitation")
      .Add("--normal-load-unit", request.load_unit, "unit of that column, default the header's",
           "UNIT")
      .Needs(column);
}

void AddForcePathOptions(CLI::App& command, DriveOptions& request) {
  const OptionGroup group(command, "Excitation");
  const Option force_path =
      group.Add("--force-path", request.force_path,
                "CSV file whose first column is the force [N], any sequence within the\n"
                "slip force: the displacement follows from it",
                "FILE");
  group
      .Add("--force-path-unit", request.force_path_unit,
           "unit of that column, default the header's", "UNIT")
      .Needs(force_path);
  for (const char* name : {"--waveform", "--lambda", "--amplitude", "--cycles",
                           "--samples-per-cycle", "--frequency", "--growth", "--path"}) {
    force_path.Excludes(FindOption(command, name));
  }
}

}  // namespace mindahl::cli
