// Writes tests/data/branch_law.csv: the branch law, its derivatives and integrals, to 25 digits.
//   make_branch_law_table FILE
// Plain closed forms at so many digits that no cancellation matters; nothing of the library is
// used.

#include <cmath>
#include <cstdio>
#include <fstream>
#include <ios>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "exact_branch_law.h"

namespace {

using Real = reference::Digits500;

constexpr const char* kHeader =
    R"(# The branch law in units of Tc and Tc/sigma; written by tools/reference/make_branch_law_table.
# b = 1-alpha, z = max(1-b y, 0), u = z^(1/b) (exp(-y) for alpha = 1), f = 1-u
# slope = f'(y) = u^alpha; work = int_0^y f = y - (1-u^(2-alpha))/(2-alpha) (y - ln(1+y) for alpha = 2)
# per_log_stiffness = y f'; per_shape = df/dalpha = -u (y/z + ln u)/b (-u y^2/2 for alpha = 1); per_log_slip_force = f - y f'
# loop_energy = 8 work - 4 y f.  Slope and derivatives at z = 0 are those of gross slip, 0.
# Precision: Boost.Multiprecision cpp_bin_float, 500 digits; alpha and y are exact doubles (17 digits), the rest has 25.
# alpha,y,f,u,slope,work,per_log_stiffness,per_shape,per_log_slip_force,loop_energy
)";

std::vector<double> Displacements(double alpha) {
  // λ = y(1−α) below α = 1, where gross slip is at λ = 1; y itself from there on.
  const double unit = alpha < 1 ? 1 / (1 - alpha) : 1.0;
  std::vector<double> result;
  for (int decade = -18; decade <= 12; ++decade) result.push_back(unit * std::pow(10.0, decade));
  for (const double lambda : {0.03, 0.2, 0.3, 0.45, 0.5, 0.55, 0.7, 0.9, 0.999, 1.001, 2.0, 5.0}) {
    result.push_back(unit * lambda);
  }
  result.push_back(std::nextafter(unit, 0.0));
  result.push_back(std::nextafter(unit, std::numeric_limits<double>::infinity()));
  if (unit > 1e3) {  // λ starts far up for α → 1 from below
    for (int decade = -18; decade <= 3; decade += 3) result.push_back(std::pow(10.0, decade));
  }
  if (unit != 1.0) {  // and around the elastic limit
    for (const double y : {0.03, 0.3, 0.499, 0.501, 0.75, 0.999, std::nextafter(1.0, 0.0), 1.0,
                           std::nextafter(1.0, 2.0), 1.001, 3.0, 30.0, 300.0}) {
      result.push_back(y);
    }
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_branch_law_table FILE\n";
    return 2;
  }
  std::ofstream out(argv[1]);
  out << kHeader;
  const auto digits = [](const Real& value) {
    // Beyond any double's range: what rounding at 500 digits leaves of an exact zero.
    return abs(value) < Real("1e-450") ? "0" : value.str(24, std::ios_base::scientific);
  };
  const auto text = [](double value) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.17g", value);
    return std::string(buffer);
  };
  for (const double alpha : {0.0, 1e-300, 1e-16, 1e-8, 0.1, 1.0 / 3.0, 0.5, 1 - 1e-8, 1 - 1e-15,
                             1.0, 1 + 1e-15, 1 + 1e-8, 2.0, 10.0, 100.0}) {
    for (const double y : Displacements(alpha)) {
      const auto row = reference::EvaluateNormalized(Real(alpha), Real(y));
      out << text(alpha) << ',' << text(y) << ',' << digits(row.force) << ','
          << digits(row.remaining) << ',' << digits(row.slope) << ',' << digits(row.work) << ','
          << digits(row.per_log_stiffness) << ',' << digits(row.per_shape) << ','
          << digits(row.per_log_slip_force) << ',' << digits(row.loop_energy) << '\n';
    }
  }
  return out.flush() ? 0 : 1;
}
