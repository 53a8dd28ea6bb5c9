#include <array>
#include <fstream>
#include <sstream>

#include "../support/histories.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/simplified_law.h"
#include "support/prelude.h"

namespace mindahl::models::history_table_test {
namespace {

/// What response.h promises. A force is a sum of at most 40 branches, each with a few roundings of
/// a number below 2Tc: 40·2·2⁻⁵³ = 9e-15, and as much again from the argument of φ.
constexpr double kTolerance = 5e-14;  // of Tc

struct HistoryCase {
  std::string name;
  BranchLaw law;
  std::vector<double> displacement;
  std::array<std::vector<long double>, 3> force;  // by column: masing, dahl, simplified
};

constexpr std::size_t kMasing = 0;
constexpr std::size_t kDahl = 1;
constexpr std::size_t kSimplified = 2;

std::vector<HistoryCase> ReadCases() {
  std::vector<HistoryCase> cases;
  std::ifstream in(MINDAHL_SOURCE_DIR "/tests/data/histories.csv");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    if (std::string word; line.starts_with("case")) {
      auto& [name, law, displacement, force] = cases.emplace_back();
      fields >> word >> name >> law.tangential_stiffness >> law.shape_exponent >> law.slip_force;
    } else {
      fields >> cases.back().displacement.emplace_back();
      for (auto& force : cases.back().force) fields >> force.emplace_back();
    }
  }
  return cases;
}

/// Largest error over Tc of forces against a column of the table.
double WorstError(const std::vector<double>& force, const HistoryCase& history,
                  std::size_t column) {
  long double worst = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    worst = std::max(worst, std::abs(force[i] - history.force[column][i]));
  }
  return static_cast<double>(worst / history.law.slip_force);
}

TEST(HistoryTable, HoldsTheForceOfEveryModel) {
  for (const auto& [name, column] : {std::pair{"mindlin-dahl", kMasing},
                                     {"mindlin", kMasing},
                                     {"jenkins", kMasing},
                                     {"dahl", kDahl}}) {
    const FrictionModel& model = Model(name);
    std::size_t compared = 0;
    for (const HistoryCase& history : ReadCases()) {
      if (model.shape_exponent && *model.shape_exponent != history.law.shape_exponent) continue;
      const std::vector<double> force = Respond(model, history.law, history.displacement);
      EXPECT_LE(WorstError(force, history, column), kTolerance)
          << name << ", " << history.name << ", alpha = " << history.law.shape_exponent;
      ++compared;
    }
    EXPECT_GE(compared, 11U);  // one exponent of every pattern at least
  }
}

TEST(HistoryTable, HoldsTheForceOfSimplifiedDahl) {
  for (const HistoryCase& history : ReadCases()) {
    std::vector<double> force(history.displacement.size());
    EvaluateSimplifiedDahl(history.law, history.displacement, {}, force);
    EXPECT_LE(WorstError(force, history, kSimplified), kTolerance)
        << history.name << ", alpha = " << history.law.shape_exponent;
  }
}

TEST(HistoryTable, HoldsEveryPatternForEveryShapeExponent) {
  constexpr std::size_t kPatterns = 11;
  constexpr std::size_t kShapeExponents = 7;
  EXPECT_EQ(ReadCases().size(), kPatterns * kShapeExponents);
}

}  // namespace
}  // namespace mindahl::models::history_table_test
