#include <fmt/format.h>

#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/drive_options.h"
#include "cli/fit_request.h"
#include "cli/options.h"
#include "cli/output.h"
#include "mindahl/core/error.h"
#include "mindahl/request/recommendation.h"

namespace mindahl::cli {
namespace {

struct RecommendCommandOptions {
  request::RecommendationRequest asked;
  std::string tolerance = "1%";
  std::string criterion = "max";
  std::string record;
  io::RecordColumns columns;
  std::string json;
};

template <typename Recommendation>
void Write(const Recommendation& recommendation, const std::string& json, Console& console) {
  WriteAnswer(json, console, recommendation);
  if (!recommendation.established()) console.exit_status = kNotEstablished;
}

/// A record brings its contact, its motion and its tolerance.
void RunForRecord(const RecommendCommandOptions& options, const CLI::App& command,
                  Console& console) {
  for (const OptionState& option : OptionsOf(command)) {
    const bool is_of_record = option.name == "record" || option.group == kColumnGroup;
    if (!option.is_given || is_of_record || option.name == "json") continue;
    throw InputError(
        fmt::format("--record excludes --{}: the record determines contact, motion and tolerance",
                    option.name));
  }
  RequireOutputPaths({{"--json", options.json, /*dash_is_stdout=*/true}}, console,
                     {options.record});
  const Messages messages{console.err, "recommend"};
  const io::RecordFile file = io::ReadRecord(options.record, options.columns);
  for (const std::string& note : file.notes) messages.Note(note);
  Write(request::RecommendForRecord(options.record, file.record,
                                    [&](std::string_view warning) { messages.Warn(warning); }),
        options.json, console);
}

void RunRecommend(const RecommendCommandOptions& options, Console& console) {
  RequireNoColumns(options.columns);
  request::RecommendationRequest request = options.asked;
  request.asked.tolerance = ParseTolerance(options.tolerance);
  request.asked.criterion = request::FindCriterion(options.criterion);
  RequireOutputPaths({{"--json", options.json, /*dash_is_stdout=*/true}}, console,
                     {request.drive.path});
  const Messages messages{console.err, "recommend"};
  Write(request::MakeRecommendation(request,
                                    [&](std::string_view warning) { messages.Warn(warning); }),
        options.json, console);
}

}  // namespace

void AddRecommendCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<RecommendCommandOptions>();
  CLI::App& command = AddCommand(
      app, "recommend",
      "Finds the cheapest model and method that meet a tolerance along a\n"
      "given displacement: each is run and compared with the exact Masing\n"
      "response of the contact (Mindlin's for alpha = 1/3).",
      {"mindahl recommend --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 3 --tolerance 1%",
       "mindahl recommend --record loop.csv"});
  AddLawOptions(command, options->asked.law);
  AddDriveOptions(command, options->asked.drive);
  OptionGroup(command, "Excitation")
      .AddShown("--seed", options->asked.drive.seed, "seed of the random waveform")
      .WholeNumber(0, std::numeric_limits<std::uint64_t>::max());
  const OptionGroup asked(command, "What is asked");
  asked.AddShown("--tolerance", options->tolerance,
                 "largest error allowed, of the peak force or the energy: 0.01 or 1%", "E");
  asked.Add("--cost", options->asked.asked.largest_cost,
            "instead find the most precise one that costs no more [ns/sample]", "NS");
  asked
      .AddShown("--criterion", options->criterion,
                "error that counts: max or rms of the force, or the energy dissipated")
      .OneOf(request::CriterionNames());
  asked
      .AddShown("--transient-cycles", options->asked.asked.transient_cycles,
                "cycles at the start that do not count")
      .WholeNumber(0, 1'000'000'000);
  OptionGroup(command, kPlainGroup)
      .Add("--json", options->json, "results for scripts; - is standard output", "PATH");
  OptionGroup(command, "What is asked")
      .Add("--record", options->record,
           "fit all laws to this record, and find the cheapest that it does not\ndistinguish from "
           "the best; instead of all options above",
           "FILE");
  AddColumnOptions(command, options->columns);
  WhenCalled(command, [options, &command, &console] {
    if (options->record.empty()) {
      RunRecommend(*options, console);
    } else {
      RunForRecord(*options, command, console);
    }
  });
}

}  // namespace mindahl::cli
