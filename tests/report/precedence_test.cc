
#include <regex>
#include <set>

#include "mindahl/identification/finding.h"
#include "support/contract.h"
#include "support/prelude.h"

// The table of precedence of docs/identification.md beside the registry of findings, which decides.
namespace mindahl::report::precedence_test {
namespace {

using identification::FindingRow;
using identification::Identifiability;

/// Returns the codes between backticks of the table's row of one precedence.
std::set<std::string> CodesOfRow(int precedence) {
  const std::string page = testing::PageText("docs/identification.md");
  const std::size_t begin = page.find("\n| " + std::to_string(precedence) + " | ");
  if (begin == std::string::npos) return {};
  const std::string row = page.substr(begin, page.find('\n', begin + 1) - begin);
  const std::regex code("`([a-z_]+)`");
  std::set<std::string> codes;
  for (std::sregex_iterator match(row.begin(), row.end(), code), end; match != end; ++match) {
    codes.insert((*match)[1]);
  }
  return codes;
}

std::set<std::string> CodesWithVerdict(Identifiability verdict) {
  std::set<std::string> codes;
  for (const FindingRow& row : identification::kFindings) {
    // It names the verdict of the whole fit, of which it follows.
    if (row.verdict == verdict && row.code != "model_inadequate") codes.emplace(row.code);
  }
  return codes;
}

TEST(Precedence, RowsOfThePageAreTheRegistrys) {
  std::set<std::string> not_identifiable = CodesOfRow(2);
  not_identifiable.merge(CodesOfRow(3));
  EXPECT_EQ(not_identifiable, CodesWithVerdict(Identifiability::kNotIdentifiable));
  EXPECT_EQ(CodesOfRow(4), CodesWithVerdict(Identifiability::kBoundedBelow));
  EXPECT_EQ(CodesOfRow(5), CodesWithVerdict(Identifiability::kExtrapolated));
}

TEST(Precedence, IsTheOrderOfTheVerdicts) {
  using enum Identifiability;
  EXPECT_GT(kNotIdentifiable, kBoundedBelow);
  EXPECT_GT(kBoundedBelow, kExtrapolated);
  EXPECT_GT(kExtrapolated, kEffective);
  EXPECT_GT(kEffective, kIdentifiable);
}

TEST(Precedence, EveryFindingStandsInTheContract) {
  const std::string contract = testing::PageText("docs/contract.md");
  for (const FindingRow& row : identification::kFindings) {
    EXPECT_THAT(contract, ::testing::HasSubstr("| `" + std::string(row.code) + "` |")) << row.code;
  }
}

}  // namespace
}  // namespace mindahl::report::precedence_test
