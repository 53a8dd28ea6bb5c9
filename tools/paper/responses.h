#pragma once

#include <vector>

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"

/// What Peyret et al. (2017) §3 apply to which models, with their equations corrected
/// (docs/theory.md §3). Mindlin's forces come from contact/, Dahl's from models/: two codes that
/// share nothing.
namespace mindahl::paper {

/// The contact of the paper's §3: a = 0.0027 m, G* = 4.42e-11 1/Pa, μ = 0.3, N = 100 N.
inline constexpr contact::MindlinContact kContact = {
    .contact_radius = 0.0027, .tangential_compliance = 4.42e-11, .slip_force = 0.3 * 100};
/// The σ [N/m] that the paper prints beside it; 8a/G* is 1 % more.
inline constexpr double kPrintedStiffness = 4.839e8;

inline constexpr double kMicroSlip = 0.8;  ///< λ of fig. 3a, in units of δc
inline constexpr double kMacroSlip = 1.2;  ///< λ of fig. 3b
inline constexpr std::size_t kSamplesPerCycle = 1000;

/// Dahl's parameters of the contact, eq. 21: σ = 8a/G*.
models::BranchLaw ExactLaw();
/// The same with the printed σ.
models::BranchLaw PrintedLaw();

/// Eq. 22, 1 Hz, with the corrected δc of eq. 23.
models::Excitation Sine(double lambda, double cycles);

/// Fig. 7. The paper gives no parameters; these go from micro- to macro-slip in the middle of the
/// fourth of five cycles.
inline constexpr double kGrowingCycles = 5.0;
inline constexpr double kLastEnvelope = 2.0;  ///< in units of δc
inline constexpr double kGrowth = 10.0;       ///< last over first envelope
models::Excitation GrowingSine(std::size_t samples_per_cycle = kSamplesPerCycle);

// Each takes the amplitude δ* of the loop from the envelope at each sample, as the paper does, and
// returns T [N] at each sample.

/// Eq. 13 up to the first reversal, then eqs 14 and 15, by the sign of the last step.
std::vector<double> MindlinForce(const models::Excitation& excitation);
/// Eq. 26 up to the first reversal, then eq. 27, each step in closed form at its own T*. T* is
/// Mindlin's whatever the law's σ: with another one, the branches refer to a force not reached.
std::vector<double> FullDahlForce(const models::BranchLaw& law,
                                  const models::Excitation& excitation);
/// Eq. 27 from the start.
std::vector<double> SimplifiedDahlForce(const models::BranchLaw& law,
                                        const models::Excitation& excitation);

// These remember the reversals instead (docs/theory.md §5) and ask for no envelope.

/// The library's model of that name.
std::vector<double> RememberingForce(const char* model, const models::Excitation& excitation);
/// The same for extremes that never shrink, from contact/: the loop of the last extreme as far as
/// its mirror image, the virgin curve beyond.
std::vector<double> RememberingMindlinForce(const models::Excitation& excitation);

/// 100·(T − reference)/T*, T* = T₀(δ*) [%]. The paper's percentage is presumably of the reference
/// itself, which is zero twice a cycle; T* keeps the error finite and of one scale.
std::vector<double> PercentOfPeak(const models::Excitation& excitation,
                                  const std::vector<double>& force,
                                  const std::vector<double>& reference);

/// Largest magnitude in each whole cycle.
std::vector<double> WorstByCycle(const std::vector<double>& error,
                                 std::size_t samples_per_cycle = kSamplesPerCycle);

}  // namespace mindahl::paper
