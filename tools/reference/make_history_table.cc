// Writes tests/data/histories.csv: the force along displacement histories, to 30 digits.
//   make_history_table FILE
// The method is in exact_history.h; nothing of the library is used.

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <ios>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "exact_history.h"

namespace {

using Real = boost::multiprecision::cpp_bin_float_100;
using History = std::vector<double>;

constexpr std::uint64_t kSeed = 20170648;
constexpr std::size_t kSamples = 40;

constexpr const char* kHeader =
    R"(# Tangential force along displacement histories; written by tools/reference/make_history_table.
# masing: T = sgn(e0) f(|e0|) + sum 2 sgn(e[k+1]-e[k]) f(|e[k+1]-e[k]|/2) over the dominant extrema e, found by
#   searching the whole past of every sample; f(x) = Tc (1 - [1-(1-alpha) sigma x/Tc]^(1/(1-alpha))).
# dahl: dT/dx = sigma (1-sT/Tc)^alpha, s = sgn(dx), integrated in v = 1-sT/Tc from sample to sample.
# simplified: dT/dx = sigma (1-(T*+sT)/(2Tc))^alpha, T* = f(max|displacement|), likewise.
# The contact is unloaded at displacement 0. Precision: Boost.Multiprecision cpp_bin_float_100 (100 digits);
# displacement and parameters are exact doubles (17 digits), forces are given to 30. Histories drawn with
# std::mt19937_64, seed 20170648.
# A line "case,name,sigma [N/m],alpha,Tc [N],samples" starts a case; its samples follow.
# displacement [m],masing [N],dahl [N],simplified [N]
)";

/// A pattern of displacements in units of Tc/σ.
struct Pattern {
  std::string name;
  std::function<History(std::mt19937_64&)> draw;
};

double Uniform(std::mt19937_64& generator, double low, double high) {
  // Not std::uniform_real_distribution, whose result is the library's choice.
  return low + (high - low) * static_cast<double>(generator() >> 11) * 0x1p-53;
}

History Walk(std::mt19937_64& generator, double step) {
  History history;
  double at = 0.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    history.push_back(at += Uniform(generator, -step, step));
  }
  return history;
}

History White(std::mt19937_64& generator, double reach) {
  History history;
  for (std::size_t i = 0; i < kSamples; ++i) history.push_back(Uniform(generator, -reach, reach));
  return history;
}

/// Reversals between ever narrower (shrink < 1) or wider limits about `centre`, two samples a
/// branch.
History Spiral(double first, double shrink, double centre) {
  History history;
  double previous = 0.0;
  double reach = first;
  for (std::size_t i = 0; i < kSamples / 2; ++i) {
    const double extreme = centre + reach;
    history.push_back(previous + 0.625 * (extreme - previous));
    history.push_back(extreme);
    previous = extreme;
    reach *= -shrink;
  }
  return history;
}

std::vector<Pattern> Patterns() {
  return {
      {"walk-micro", [](auto& g) { return Walk(g, 0.25); }},
      {"walk-macro", [](auto& g) { return Walk(g, 1.5); }},
      {"white-micro", [](auto& g) { return White(g, 0.6); }},
      {"white-macro", [](auto& g) { return White(g, 4.0); }},
      {"spiral-in", [](auto&) { return Spiral(1.4, 0.83, 0.0); }},
      {"spiral-out-downward", [](auto&) { return Spiral(-0.02, 1.3, 0.0); }},
      {"spiral-off-centre", [](auto&) { return Spiral(-1.1, 0.9, 0.35); }},
      {"dwells",
       [](auto& g) {
         History history;
         for (const double at : White(g, 1.2)) {
           const std::size_t repeats = 1 + g() % 3;
           for (std::size_t i = 0; i < repeats && history.size() < kSamples; ++i) {
             history.push_back(at);
           }
         }
         return history;
       }},
      // Extremes met again bit for bit, inside one another, and the virgin curve rejoined exactly.
      {"closing-loops",
       [](auto&) {
         return History{0.5,   1.0,  0.25, -0.5, 0.25, 0.75, 0.0,   0.75, 0.5,   0.75,
                        1.0,   0.0,  1.0,  1.25, 0.5,  -1.0, -1.25, -1.5, -0.25, -1.5,
                        -1.25, -1.5, 0.0,  0.5,  0.25, 0.5,  1.0,   1.5,  1.75,  -1.75,
                        -2.0,  2.0,  -1.0, 1.0,  -1.0, 1.0,  0.75,  -1.0, -2.0,  -2.5};
       }},
      {"first-row-beyond-next",
       [](auto&) {
         History history{-0.875};
         for (const double at : {-0.25, 0.125, -0.375, 0.5, -0.5, 0.875, 1.0, 0.25, -1.0, -1.5}) {
           history.push_back(at);
         }
         return history;
       }},
      {"unequal-reversals",
       [](auto& g) {
         History history;
         for (std::size_t i = 0; i < kSamples / 2; ++i) {
           history.push_back(Uniform(g, -0.3, 0.1));
           history.push_back(Uniform(g, 0.2, 2.0));
         }
         return history;
       }},
  };
}

struct Scale {
  double stiffness;
  double slip_force;
};

void WriteCase(std::ostream& out, const std::string& name, const History& history,
               const Scale& scale, double exponent) {
  const reference::Law<Real> law{Real(scale.stiffness), Real(exponent), Real(scale.slip_force)};
  const auto text = [](double value) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.17g", value);
    return std::string(buffer);
  };
  out << "case," << name << ',' << text(scale.stiffness) << ',' << text(exponent) << ','
      << text(scale.slip_force) << ',' << history.size() << '\n';

  const double limit = scale.slip_force / scale.stiffness;
  Real largest = 0;
  for (const double at : history) largest = std::max(largest, Real(abs(Real(at * limit))));
  const Real peak = reference::Backbone(law, largest);

  std::vector<Real> past;
  Real previous = 0;
  Real dahl = 0;
  Real simplified = 0;
  for (const double at : history) {
    const double displacement = at * limit;
    const Real step = Real(displacement) - previous;
    past.push_back(Real(displacement));
    if (step != 0) {
      dahl = reference::DahlStep(law, dahl, step);
      simplified = reference::SimplifiedDahlStep(law, peak, simplified, step);
    }
    previous = displacement;
    constexpr std::streamsize kDigits = 30;
    const auto digits = [](const Real& value) {
      return value.str(kDigits - 1, std::ios_base::scientific);
    };
    out << text(displacement) << ',' << digits(reference::MasingForce(law, past)) << ','
        << digits(dahl) << ',' << digits(simplified) << '\n';
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_history_table FILE\n";
    return 2;
  }
  std::ofstream out(argv[1]);
  out << kHeader;
  // From the paper's contact to an atomic, a tectonic and a unit one.
  const std::vector<Scale> scales = {{4.839e8, 30.0}, {1.0, 1e-15}, {3e13, 1e12}, {1.0, 1.0}};
  const std::vector<double> exponents = {0.0, 0.1, 1.0 / 3.0, 0.5, 1.0, 2.0, 5.0};
  std::mt19937_64 generator(kSeed);
  std::size_t number = 0;
  for (const Pattern& pattern : Patterns()) {
    for (const double exponent : exponents) {
      WriteCase(out, pattern.name, pattern.draw(generator), scales[number++ % scales.size()],
                exponent);
    }
  }
  return out.flush() ? 0 : 1;
}
