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

constexpr double kFloatEpsilon = std::numeric_limits<float>::epsilon();

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
    constexpr double kLargest = 1e37;
    constexpr double kSmallest = 1e-37;
    if (x > kLargest || x < kSmallest) return;
    const auto narrow = static_cast<float>(x);
    const accuracy::Exact narrowed = accuracy::EvaluateExactly(law, static_cast<double>(narrow));
    if (narrowed.force < static_cast<long double>(kSmallest)) return;
    table.Add("EvaluateForce", "float", "value", 8, law, x,
              accuracy::RelativeError(accuracy::VirginForce(law, narrow), narrowed.force));
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

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;

/// Solves A·x = b by Gaussian elimination with pivoting; A is a 3 × 3 normal matrix.
Vector Solve(Matrix a, Vector b) {
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < 3; ++i) {
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    }
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < 3; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < 3; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = 3; k-- > 0;) {
    for (std::size_t j = k + 1; j < 3; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

/// What rounding forces to float does to a fit of one steady cycle of 400 samples: the worst and
/// the standard error of ln σ, α and ln Tc over many slightly different amplitudes, to first order.
void PrintFitFloor() {
  constexpr std::size_t kSamples = 400;
  constexpr int kAmplitudes = 200;
  constexpr std::uint64_t kSeed = 20170648;
  const FrictionModel& model = *FindFrictionModel("mindlin-dahl");
  const BranchLaw law{4.839e8, 1.0 / 3.0 + 1e-3, 30.0};
  std::mt19937_64 generator(kSeed);
  fmt::print("| λ | T*/Tc | σ, relative | α | Tc, relative |\n|---|---|---|---|---|\n");
  for (const double lambda : {0.01, 0.03, 0.1, 0.3, 0.5, 0.8, 1.0, 1.2}) {
    Vector square{};
    double peak = 0.0;
    for (int i = 0; i < kAmplitudes; ++i) {
      const double jitter = 1 + 0.01 * static_cast<double>(generator() >> 11) * 0x1p-53;
      const Excitation drive =
          MakeExcitation({.amplitude = lambda * jitter * GrossSlipDisplacement(law),
                          .cycles = 1.0,
                          .samples_per_cycle = kSamples});
      const std::vector<float> narrow(drive.displacement.begin(), drive.displacement.end());
      const std::vector<double> x(narrow.begin(), narrow.end());
      const LoadingPath path =
          MakeLoadingPath(x, FindReversals(x, 0.0), model.memory, {.state = InitialState::kSteady});
      std::vector<float> narrow_force(x.size());
      std::vector<double> force(x.size());
      std::vector<double> gradient(x.size() * kGradientColumns);
      EvaluateForce(model, law, path, std::span<const float>(narrow), narrow_force);
      EvaluateForceAndGradient(model, law, path, x, force, gradient);
      Matrix normal{};
      Vector right{};
      for (std::size_t k = 0; k < x.size(); ++k) {
        const double error = static_cast<double>(narrow_force[k]) - force[k];
        const double* row = &gradient[k * kGradientColumns];
        for (std::size_t p = 0; p < 3; ++p) {
          right[p] += row[p] * error;
          for (std::size_t q = 0; q < 3; ++q) normal[p][q] += row[p] * row[q];
        }
      }
      const Vector change = Solve(normal, right);
      for (std::size_t p = 0; p < 3; ++p) square[p] += change[p] * change[p] / kAmplitudes;
      peak = *std::ranges::max_element(force) / law.slip_force;
    }
    fmt::print("| {:g} | {:.3g} | {:.1e} | {:.1e} | {:.1e} |\n", lambda, peak, std::sqrt(square[0]),
               std::sqrt(square[1]), std::sqrt(square[2]));
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
  fmt::print("Worst errors, in ε of the type ({:.2g} and {:.2g}):\n\n",
             std::numeric_limits<double>::epsilon(), kFloatEpsilon);
  table.Print();
  fmt::print("\nRoot mean square error of fitted parameters by forces in float:\n\n");
  PrintFitFloor();
  std::ofstream out(argv[1]);
  out << "# function,alpha,lambda,error in units of epsilon; written by tools/accuracy\n";
  table.Write(out);
  return out.flush() ? 0 : 1;
}
