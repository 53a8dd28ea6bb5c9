#include "report/fields.h"

#include <set>

#include "support/contract.h"
#include "support/prelude.h"

// The table of a report's fields, as the contract has it.
namespace mindahl::report::fields_test {
namespace {

std::string Row(const report::FieldDescription& field) {
  return "| `" + field.path + "` | " + field.unit + " | " + field.label + " |\n";
}

TEST(Fields, StandInTheContractWithUnitAndMeaning) {
  const std::string contract = testing::PageText("docs/contract.md");
  for (const report::FieldDescription& field : report::DescribeFields()) {
    EXPECT_NE(contract.find(Row(field)), std::string::npos)
        << "docs/contract.md lacks " << Row(field);
  }
}

TEST(Fields, AreAllThatTheContractPromises) {
  std::set<std::string> rows;
  for (const report::FieldDescription& field : report::DescribeFields()) rows.insert(Row(field));
  const std::string section = testing::ContractSections().at("mindahl fit");
  const std::string json = section.substr(section.find("### JSON"));
  const std::set<std::string> promised = testing::Matches(json, "(\\| `[^\n]*\\|\n)");
  EXPECT_EQ(promised, rows);
}

TEST(Fields, HaveAPathOfTheirOwnAndAMeaning) {
  std::set<std::string> paths;
  for (const report::FieldDescription& field : report::DescribeFields()) {
    EXPECT_TRUE(paths.insert(field.path).second) << field.path;
    EXPECT_FALSE(field.label.empty()) << field.path;
  }
}

}  // namespace
}  // namespace mindahl::report::fields_test
