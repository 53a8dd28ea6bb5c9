#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/request/conversion.h"

namespace mindahl::cli {
namespace {

constexpr std::size_t kMostElements = 10'000;

struct ConvertCommandOptions {
  request::ConversionRequest asked;
  std::string tolerance = "1%";
  std::string json_path;
  std::string input_lines_path;
};

void RunConvert(const ConvertCommandOptions& options, Console& console) {
  if (options.json_path == "-" && options.input_lines_path == "-") {
    throw InputError("--json - and --input-lines - both write to standard output: give a file");
  }
  RequireOutputPaths({{"--json", options.json_path, /*dash_is_stdout=*/true},
                      {"--input-lines", options.input_lines_path, /*dash_is_stdout=*/true}},
                     console, {options.asked.fit});
  request::ConversionRequest asked = options.asked;
  asked.options.tolerance = ParseTolerance(options.tolerance);
  const request::ConvertedContact converted = request::MakeConversion(asked);
  if (!options.input_lines_path.empty()) {
    std::string lines;
    for (const std::string& line : InputLines(converted)) lines += line + '\n';
    WriteText(lines, options.input_lines_path, console);
  }
  if (!options.json_path.empty()) WriteText(ToJson(converted), options.json_path, console);
  if (options.json_path != "-" && options.input_lines_path != "-") {
    console.out << ToText(converted);
  }
}

}  // namespace

void AddConvertCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<ConvertCommandOptions>();
  CLI::App& command = AddCommand(
      app, "convert",
      "Converts a contact's steady loop to another law or program: the\n"
      "parameters, the remaining error, and the amplitudes at which it is\n"
      "small.",
      {"mindahl convert fit.json --to dahl",
       "mindahl convert --sigma 4e7 --slip-force 40 --amplitude 1.2e-6 --to iwan --elements 5 \\",
       "    --input-lines contact.tcl"});
  const OptionGroup contact(command, "The contact");
  contact.Add("fit", options->asked.fit,
              "what mindahl fit --json wrote: law and amplitude, unless given below", "FILE");
  contact.Add("--sigma", options->asked.sigma, "tangential stiffness [N/m]", "N/M");
  contact.Add("--alpha", options->asked.alpha, "shape exponent [-], default 1/3", "ALPHA");
  contact.Add("--slip-force", options->asked.slip_force, "slip force Tc [N]", "N");
  contact
      .Add("--from", options->asked.from,
           "law of these parameters: of fit --model mindlin-dahl or --model dahl;\ndefault the "
           "fit's, "
           "else masing")
      ->check(OneOf({"masing", "dahl"}));
  contact.Add("--amplitude", options->asked.amplitude,
              "amplitude X of the contact's steady loop [m], without the rig's travel", "M");
  const OptionGroup result(command, "What it becomes");
  result.Add("--to", options->asked.to, "law or program")
      ->required()
      ->check(OneOf(NamesOf(convert::Targets(), &convert::TargetRow::name)));
  result.AddShown("--tolerance", options->tolerance,
                  "largest error of force and energy at the amplitudes given as good:\n0.01 or 1%",
                  "E");
  result.AddShown("--elements", options->asked.options.elements, "number of elements of --to iwan")
      ->check(WholeNumber(1, kMostElements));
  result.AddShown("--beta", options->asked.options.beta,
                  "beta of --to bouc-wen for T/Tc, in (0, 1]; gamma is 1 - beta", "BETA");
  result.Add("--normal-load", options->asked.normal.normal_load,
             "normal load [N] for --to lammps, liggghts and yade: friction\ncoefficient Tc/N", "N");
  result.Add("--contact-radius", options->asked.normal.contact_radius,
             "contact radius [m] for --to lammps: the stiffness follows it", "M");
  result.Add("--viscous", options->asked.normal.viscous,
             "force per speed [N s/m]: lugre, mujoco, mujoco-joint, urdf, sdf", "C");
  const OptionGroup outputs(command, "Output");
  outputs.Add("--input-lines", options->input_lines_path,
              "lines as the other program reads them; - for standard output", "PATH");
  outputs.Add("--json", options->json_path, "result as JSON; - for standard output", "PATH");
  command.callback([options, &console] { RunConvert(*options, console); });
}

}  // namespace mindahl::cli
