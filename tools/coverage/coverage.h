#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/identification/fit.h"
#include "mindahl/models/branch_law.h"

/// How often 95 % intervals cover the truth, over seeded loops of known contacts.
namespace mindahl::coverage {

enum class Noise {
  kWhite,           ///< of the force
  kAutoregressive,  ///< of the force, AR(1) with ρ = 0.9
  kMovingAverage,   ///< of the force, the mean of five white values in a row
  kDisplacement,    ///< of both channels
  kQuantised,       ///< the displacement by an encoder, the force white
  kAnswer,          ///< white, of the displacement that answers an imposed force, which is exact
};

/// What the record has beside the contact, and the fit a term for.
enum class Beside {
  kNothing,
  kLag,        ///< the force is read 1.5 samples after the displacement
  kViscous,    ///< C·dδ/dt, up to 5 % of Tc
  kCovariate,  ///< C times a column that wanders, up to 20 % of Tc
  kBacklash,   ///< a gap of a tenth of the amplitude, crossed at zero force
};

/// Fits a row: 0.7 % of counting error at 95 %.
inline constexpr std::size_t kLoops = 1000;

/// One row of the table: a contact, its drive and its noise.
struct Scenario {
  std::string name;
  double shape_exponent = 1.0 / 3;
  double lambda = 1.2;  ///< amplitude over the gross-slip displacement
  std::size_t cycles = 3;
  std::size_t samples_per_cycle = 200;
  /// Points of the motion from one reading to the next: of more than one the contact turns, and a
  /// late force is, where the motion has it and not where a reading is. Of kLag and kNothing.
  std::size_t steps_a_reading = 1;
  Noise noise = Noise::kWhite;
  double force_noise = 0.01;        ///< of T*
  double displacement_noise = 0.0;  ///< of the amplitude; the encoder's step where quantised
  bool noise_is_known = true;       ///< is the fit told that of the displacement?
  Beside beside = Beside::kNothing;
  std::size_t dwell = 1;          ///< samples at which the drive rests, with one reading
  double lowest_coverage = 0.90;  ///< what is promised, over kLoops
  double highest_coverage = 1.0;
  /// Normal loads over their mean, a record each, of one contact with σ ∝ N^load_exponent; each is
  /// driven to λ at its own load.
  std::vector<double> loads = {1.0};
  double load_exponent = 1.0 / 3;
  bool noise_follows_load = false;  ///< of the force, of each record's own T*
  bool first_is_virgin = false;     ///< of the records; the others have no first cycle
  bool finds_state = false;         ///< is the initial state left to the fit?
  double rig = 0.0;                 ///< stiffness in series over σ, which is fitted; 0: rigid
  std::string prior = {};           ///< parameter whose prior is drawn about the truth
  double prior_uncertainty = 0.0;   ///< standard, of that over the true value
  double asymmetry = 0.0;   ///< of the slip forces in the two senses, for which the fit has a term
  double load_swing = 0.0;  ///< of the load about its mean, at twice the drive's frequency
  double peak_share = 0.0;  ///< T*/Tc where the force is imposed, in the place of λ
  bool is_steady = false;   ///< without its first cycle
  bool fits_force = false;  ///< of an imposed force all the same
  std::string model = "mindlin-dahl";

  /// The fourth parameter whose intervals are counted; empty of three.
  [[nodiscard]] std::string_view FourthParameter() const {
    if (asymmetry != 0) return "asymmetry";
    if (rig > 0) return "rig_stiffness";
    if (beside == Beside::kLag) return "lag";
    if (beside == Beside::kBacklash) return "backlash";
    return loads.size() > 1 && !first_is_virgin ? "load_exponent" : "";
  }
};

/// The scenarios of docs/coverage.md.
std::vector<Scenario> Scenarios();

/// Of σ, α, Tc and, of several loads, load_exponent, of slip forces that differ, asymmetry, of a
/// rig its stiffness, or a lag, in this order.
struct Coverage {
  static constexpr std::size_t kParameters = 4;
  std::size_t loops = 0;
  std::size_t parameters = kParameters;       ///< how many of them the fit has
  std::array<double, kParameters> covered{};  ///< share of the intervals that cover the truth
  std::array<double, kParameters>
      error_ratio{};                             ///< root mean square stated error over the scatter
  std::array<double, kParameters> efficiency{};  ///< Cramér–Rao bound over the scatter, squared
  std::array<double, kParameters> bias{};        ///< mean error over the scatter
  double doubted = 0.0;   ///< fraction of the fits whose model is not called adequate
  double rejected = 0.0;  ///< fraction of those whose chance that noise looks so is below 5 %
};

/// @param loops  seeds first, first + 1, …
Coverage Measure(const Scenario& scenario, std::size_t loops, std::uint64_t first_seed = 1);

}  // namespace mindahl::coverage
