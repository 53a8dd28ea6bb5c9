#include <map>

#include "cli/command_line.h"
#include "support/text.h"

// docs/contract.md against the program: it names every option and exit status, and none besides.
namespace mindahl::cli::contract_test {
namespace {

const Words kCommands = "fit simulate validate contact convert tradeoff plan batch track";
// Columns, units and model are "as for `fit`".
const Words kLikeFit = "batch track";
const char* const kCommonSection = "What is known of the contact";
const char* const kOption = "(--[a-z][a-z0-9-]*)";

/// The contract by its headings, "mindahl fit"; what stands before the first has the heading "".
std::map<std::string, std::string> ContractSections() {
  std::map<std::string, std::string> sections;
  std::string heading;
  for (const std::string& line : Lines(FileContent(MINDAHL_SOURCE_DIR "/docs/contract.md"))) {
    if (line.starts_with("## ")) heading = line.substr(3);
    sections[heading] += line + "\n";
  }
  return sections;
}

std::set<std::string> Difference(const std::set<std::string>& all,
                                 const std::set<std::string>& less) {
  std::set<std::string> rest;
  std::ranges::set_difference(all, less, std::inserter(rest, rest.end()));
  return rest;
}

std::set<std::string> OptionsOfHelp(const std::string& command) {
  std::set<std::string> options =
      Matches(Done(command + " --help-all").out, "\n  (?:-[a-z],)?(--[a-z][a-z0-9-]*)");
  options.erase("--help");
  options.erase("--help-all");
  return options;
}

TEST(Contract, HasASectionForEveryCommandAndNoOther) {
  const std::string help = Done("--help").out;
  std::set<std::string> commands = Matches(help.substr(help.find("Subcommands:")), "\n  ([a-z]+) ");
  std::set<std::string> documented;
  for (const auto& [heading, text] : ContractSections()) {
    if (heading.starts_with("mindahl ")) documented.insert(heading.substr(8));
  }
  EXPECT_EQ(documented, commands);
  EXPECT_EQ(commands, std::set<std::string>(kCommands.begin(), kCommands.end()));
}

TEST(Contract, NamesEveryOptionOfEveryCommand) {
  const auto sections = ContractSections();
  const std::set<std::string> common = Matches(sections.at(kCommonSection), kOption);
  for (const std::string& command : kCommands) {
    const std::set<std::string> options = OptionsOfHelp(command);
    ASSERT_FALSE(options.empty()) << command;
    std::set<std::string> named = Matches(sections.at("mindahl " + command), kOption);
    named.insert(common.begin(), common.end());
    if (std::ranges::find(kLikeFit, command) != kLikeFit.end()) {
      named.merge(Matches(sections.at("mindahl fit"), kOption));
    }
    EXPECT_THAT(Difference(options, named), IsEmpty()) << command;
  }
}

TEST(Contract, NamesNoOptionThatACommandDoesNotHave) {
  const auto sections = ContractSections();
  // The last four are accepted, and in no help.
  const std::set<std::string> of_all = {"--help",   "--version", "--config",      "--help-all",
                                        "--cycles", "--samples", "--time-window", "--load-window"};
  std::set<std::string> of_any = of_all;
  for (const std::string& command : kCommands) {
    std::set<std::string> options = OptionsOfHelp(command);
    of_any.insert(options.begin(), options.end());
    options.insert(of_all.begin(), of_all.end());
    const std::set<std::string> named = Matches(sections.at("mindahl " + command), kOption);
    EXPECT_THAT(Difference(named, options), IsEmpty()) << command;
  }
  for (const char* heading : {"", kCommonSection}) {
    const std::set<std::string> named = Matches(sections.at(heading), kOption);
    EXPECT_THAT(Difference(named, of_any), IsEmpty()) << heading;
  }
}

TEST(Contract, ListsEveryExitStatus) {
  const std::string preamble = ContractSections().at("");
  EXPECT_EQ(Matches(preamble, "\n\\| ([0-9]+) \\|"),
            (std::set<std::string>{std::to_string(cli::kDone), std::to_string(cli::kInternalError),
                                   std::to_string(cli::kBadInput),
                                   std::to_string(cli::kNotEstablished)}));
}

}  // namespace
}  // namespace mindahl::cli::contract_test
