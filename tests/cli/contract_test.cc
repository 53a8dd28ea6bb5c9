#include "support/contract.h"

#include <fstream>
#include <regex>
#include <set>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "report/fields.h"
#include "support/prelude.h"

// docs/contract.md against the program: it names every option, key and code, and none besides.
namespace mindahl::cli::contract_test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

const Words kCommands = {"fit",      "simulate",  "validate", "contact", "convert",
                         "tradeoff", "recommend", "plan",     "batch",   "track"};
// Columns, units and model are "as for `fit`".
const Words kLikeFit = {"batch", "track"};
const char* const kCommonSection = "What is known of the contact";
const char* const kOption = "(--[a-z][a-z0-9-]*)";

std::set<std::string> Difference(const std::set<std::string>& all,
                                 const std::set<std::string>& less) {
  std::set<std::string> rest;
  std::ranges::set_difference(all, less, std::inserter(rest, rest.end()));
  return rest;
}

std::set<std::string> OptionsOfHelp(const std::string& command) {
  std::set<std::string> options =
      Matches(RunCommand({command, "--help"}).out, "\n  (?:-[a-z],)?(--[a-z][a-z0-9-]*)");
  options.erase("--help");
  return options;
}

TEST(Contract, HasASectionForEveryCommandAndNoOther) {
  const std::string help = RunCommand({"--help"}).out;
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
  const std::set<std::string> of_all = {"--help", "--version", "--config"};
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

// --- keys

/// Paths of what has no members, as the contract writes them.
void CollectLeaves(const json& value, const std::string& path, std::set<std::string>& leaves) {
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      CollectLeaves(member, path.empty() ? key : path + "." + key, leaves);
    }
  } else if (value.is_array() && !value.empty()) {
    const bool of_ends = path.ends_with("ci95");
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::string place = of_ends                    ? "[" + std::to_string(i) + "]"
                                : value[i].is_structured() ? "[]"
                                                           : "";
      CollectLeaves(value[i], path + place, leaves);
    }
  } else {
    leaves.insert(path);
  }
}

std::string AsInTheContract(const std::string& leaf) {
  std::string path = std::regex_replace(leaf, std::regex("^parameters\\.[^.]+"), "parameters.NAME");
  path =
      std::regex_replace(path, std::regex("^correlation\\.[^.]+\\.[^.]+"), "correlation.NAME.NAME");
  path = std::regex_replace(path, std::regex("^(load_series\\.laws\\[\\]\\.quantities)\\.[^.]+"),
                            "$1.NAME");
  const std::regex quantity(
      "^contact\\..*\\.(value|standard_error|unit|from_fit|from_inputs|largest_input)$");
  return std::regex_replace(path, quantity, "contact.QUANTITY.$1");
}

/// The same file but for the force in one row.
std::string WithASpike(const std::string& path) {
  std::ifstream in(path);
  const std::string spiked = path + ".spiked.csv";
  std::ofstream out(spiked);
  std::string line;
  for (int row = 0; std::getline(in, line); ++row) {
    out << (row == 150 ? line.substr(0, line.rfind(',')) + ",4000" : line) << '\n';
  }
  return spiked;
}

struct Runs {
  std::set<std::string> leaves;
  std::set<std::string> codes;
};

/// Fits of many kinds: with every group of keys, and with several warnings.
Runs RunFits() {
  const TemporaryDirectory directory;
  const auto simulated = [&](const char* file, const Words& options) {
    const std::string path = (directory.path() / file).string();
    Words words = {"simulate", "--sigma", "4e7", "--slip-force", "40", "-o", path};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(RunCommand(words).status, cli::kDone);
    return path;
  };
  const Words bodies = {"--normal-load",      "50±1%", "--youngs-modulus-1", "210e9",
                        "--youngs-modulus-2", "210e9", "--poisson-1",        "0.3",
                        "--poisson-2",        "0.3",   "--radius-1",         "0.05",
                        "--radius-2",         "inf",   "--contact-radius",   "2.5e-4"};
  const auto with_bodies = [&](Words words) {
    words.insert(words.end(), bodies.begin(), bodies.end());
    return words;
  };
  const std::string partial =
      simulated("partial.csv", {"--lambda", "0.15", "--noise-force", "0.1"});
  const std::string coarse =
      simulated("coarse.csv", {"--lambda", "1.3", "--cycles", "2.5", "--samples-per-cycle", "23"});
  const std::string loop =
      simulated("loop.csv", {"--lambda", "1.3", "--cycles", "3", "--noise-force", "0.1"});
  Runs runs;
  for (const Words& words : std::vector<Words>{with_bodies({SampleRecord()}),
                                               with_bodies({partial}),
                                               {loop, "--model", "auto", "--starts", "5"},
                                               {loop, SampleRecord(), "--drift"},
                                               {WithASpike(loop)},
                                               {coarse},
                                               {loop, "--plateau-slope", "--rig-stiffness", "1e9"},
                                               with_bodies({loop, "--force-sign", "opposite"})}) {
    Words all = {"fit", "--json", "-"};
    all.insert(all.end(), words.begin(), words.end());
    const json fit = RunCommand(all).Json();
    CollectLeaves(fit, "", runs.leaves);
    for (const char* list : {"warnings", "notes"}) {
      for (const json& warning : fit.at(list)) runs.codes.insert(warning.at("code"));
    }
  }
  return runs;
}

TEST(Contract, DocumentsEveryKeyAndCodeOfAFit) {
  const Runs runs = RunFits();
  std::set<std::string> fields;
  for (const report::FieldDescription& field : report::DescribeFields()) fields.insert(field.path);
  for (const std::string& leaf : runs.leaves) {
    const std::string path = AsInTheContract(leaf);
    // A list that is empty, or all of a failed fit's, has a row of its own.
    EXPECT_TRUE(fields.contains(path) || path == "nulls" || path == "warnings" || path == "notes")
        << leaf << " has no row in the table of fields, and so none in docs/contract.md";
  }
  const std::set<std::string> documented =
      Matches(ContractSections().at("mindahl fit"), "\n\\| `([a-z_]+)` \\|");
  EXPECT_GE(runs.codes.size(), 4u) << "or this test sees hardly any code";
  EXPECT_TRUE(runs.codes.contains("glitches_left_out")) << "or it sees no note of a record";
  EXPECT_THAT(Difference(runs.codes, documented), IsEmpty());
}

TEST(Contract, DocumentsTheWarningsOfTheTranslation) {
  const std::set<std::string> documented =
      Matches(ContractSections().at("mindahl fit"), "\n\\| `([a-z_]+)` \\|");
  for (const char* code :
       {"contact_implausible", "contact_not_identified", "contact_redundant", "fit_failed"}) {
    EXPECT_TRUE(documented.contains(code)) << code;
  }
}

void CollectKeys(const json& value, std::set<std::string>& keys) {
  for (const auto& [key, member] : value.items()) {
    if (value.is_object()) keys.insert(key);
    if (member.is_structured()) CollectKeys(member, keys);
  }
}

TEST(Contract, DocumentsEveryKeyOfTheOtherCommands) {
  const TemporaryDirectory directory;
  const std::vector<Words> runs = {
      {"contact", "--friction", "0.3", "--normal-load", "50", "--youngs-modulus-1", "210e9",
       "--youngs-modulus-2", "210e9", "--poisson-1", "0.3", "--poisson-2", "0.3", "--radius-1",
       "0.05", "--radius-2", "inf"},
      {"validate", "--cases", "1"},
      {"convert", "--sigma", "4e7", "--slip-force", "40", "--amplitude", "1e-6", "--to", "iwan"},
      {"recommend", "--sigma", "4e7", "--slip-force", "40", "--lambda", "0.5", "--tolerance", "5%"},
      {"tradeoff", "--excitation", "micro"},
      {"plan", "--sigma", "4e7", "--slip-force", "40", "--force-noise", "0.4", "--want",
       "alpha=0.01"},
      {"batch", SampleRecord(), "--output", (directory.path() / "batch.csv").string()},
      {"track", SampleRecord(), "--output", (directory.path() / "track.csv").string()}};
  const auto sections = ContractSections();
  for (Words words : runs) {
    const std::string command = words.front();
    words.insert(words.end(), {"--json", "-"});
    std::set<std::string> keys;
    CollectKeys(RunCommand(words).Json(), keys);
    ASSERT_FALSE(keys.empty()) << command;
    std::set<std::string> named = Matches(sections.at("mindahl " + command), "`([a-z_0-9]+)`");
    // "the keys of a point of `tradeoff`"
    if (command == "recommend")
      named.merge(Matches(sections.at("mindahl tradeoff"), "`([a-z_]+)`"));
    if (command == "batch") {  // "all that `fit --json` says of it"
      std::set<std::string> of_fit;
      CollectKeys(RunCommand({"fit", SampleRecord(), "--json", "-"}).Json(), of_fit);
      keys = Difference(keys, of_fit);
    }
    EXPECT_THAT(Difference(keys, named), IsEmpty()) << command;
  }
}

}  // namespace
}  // namespace mindahl::cli::contract_test
