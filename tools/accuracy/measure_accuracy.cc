// Measures the rounding errors of the models over the box of docs/accuracy.md: prints its tables as
// markdown and writes the points of its plot.
//   measure_accuracy FILE.csv

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "measurements.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/excitation.h"

namespace {

using namespace mindahl;
using namespace mindahl::loop;
using namespace mindahl::models;

constexpr std::array<const char*, 4> kRegions = {"λ < 10⁻⁶", "10⁻⁶ … 0.9", "0.9 … 1.1", "> 1.1"};

/// λ = x/δc for α < 1, y from there on.
double Lambda(const BranchLaw& law, double x) {
  const double y = law.tangential_stiffness * x / law.slip_force;
  return law.shape_exponent < 1 ? (1 - law.shape_exponent) * y : y;
}

std::size_t RegionOf(double lambda) {
  return lambda < 1e-6 ? 0 : lambda < 0.9 ? 1 : lambda <= 1.1 ? 2 : 3;
}

struct Row {
  std::string type, scale;
  double bound = 0.0;
  std::array<double, kRegions.size()> worst{};
};

/// What is plotted: the worst error by function, α and λ, over all scales.
using Plot = std::map<std::string, std::map<double, std::map<double, double>>>;

class Table {
 public:
  void Add(const std::string& function, const std::string& type, const std::string& scale,
           double bound, const BranchLaw& law, double x, double error) {
    const double lambda = Lambda(law, x);
    auto [entry, is_new] = rows_.try_emplace(function + type, Row{type, scale, bound, {}});
    if (is_new) order_.emplace_back(function, function + type);
    double& worst = entry->second.worst[RegionOf(lambda)];
    worst = std::max(worst, error);
    // Ten points a decade, coarse enough for all scales to meet.
    const double rounded = std::pow(10.0, std::round(10 * std::log10(lambda)) / 10);
    double& plotted = plot_[function + ' ' + type][law.shape_exponent][rounded];
    plotted = std::max(plotted, error);
  }

  void Print() const {
    fmt::print("| function | type | error relative to | {} | bound |\n",
               fmt::join(kRegions, " | "));
    fmt::print("|---|---|---|{}---|\n", "---|---|---|---|");
    for (const auto& [function, key] : order_) {
      const Row& row = rows_.at(key);
      fmt::print("| {} | {} | {} |", function, row.type, row.scale);
      for (const double worst : row.worst) fmt::print(" {:.2g} |", worst);
      fmt::print(" {:g} |\n", row.bound);
    }
  }

  void Write(std::ostream& out) const {
    for (const auto& [function, by_alpha] : plot_) {
      for (const auto& [alpha, by_lambda] : by_alpha) {
        for (const auto& [lambda, error] : by_lambda) {
          out << fmt::format("{},{:.17g},{:.4g},{:.3g}\n", function, alpha, lambda, error);
        }
      }
    }
  }

 private:
  std::map<std::string, Row> rows_;
  std::vector<std::pair<std::string, std::string>> order_;
  Plot plot_;
};

void MeasureBox(Table& table) {
  const auto measurements = accuracy::Measurements();
  accuracy::ForEveryPoint([&](const BranchLaw& law, double x) {
    const accuracy::Exact exact = accuracy::EvaluateExactly(law, x);
    for (const auto& measurement : measurements) {
      table.Add(measurement.function, "double", measurement.scale, measurement.bound, law, x,
                measurement.error(law, x, exact));
    }
  });
}

void MeasureDahlLoops(Table& table) {
  const FrictionModel& dahl = *FindFrictionModel("dahl");
  const reference::Scale& scale = reference::kBoxScales[1];
  for (const double alpha : reference::kBoxShapeExponents) {
    const BranchLaw law{scale.stiffness, alpha, scale.slip_force};
    for (const double x : reference::BoxDisplacements(scale, alpha)) {
      const accuracy::ExactDahlLoop exact = accuracy::EvaluateDahlExactly(law, x);
      table.Add("SteadyPeakForce, Dahl", "double", "value", 16, law, x,
                accuracy::RelativeError(SteadyPeakForce(dahl, law, x), exact.peak));
      const double y = law.tangential_stiffness * x / law.slip_force;
      const bool onset = alpha < 0.05 && std::abs(y - 1) < 0.1;
      const double error = accuracy::ErrorInEpsilons(SteadyLoopEnergy(dahl, law, x), exact.energy,
                                                     onset ? 4 * x * exact.peak : exact.energy);
      table.Add("SteadyLoopEnergy, Dahl", "double", "value/(1 + α/16)", 16, law, x,
                error / (1 + alpha / 16));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: measure_accuracy FILE.csv\n";
    return 2;
  }
  Table table;
  MeasureBox(table);
  MeasureDahlLoops(table);
  fmt::print("Worst errors, in ε = {:.2g}:\n\n", std::numeric_limits<double>::epsilon());
  table.Print();
  std::ofstream out(argv[1]);
  out << "# function,alpha,lambda,error in units of epsilon; written by tools/accuracy\n";
  table.Write(out);
  return out.flush() ? 0 : 1;
}
