#include "mindahl/identification/sweep.h"

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <random>

#include "support/prelude.h"

// Stiffness against amplitude: the closed forms, and what is fitted to them.
namespace mindahl::identification::sweep_test {
namespace {

constexpr double kSigma = 4e7;       // [N/m]
constexpr double kSlipForce = 60.0;  // [N]

std::vector<double> Forces(double least, double greatest, int points) {
  std::vector<double> forces;
  for (int i = 0; i < points; ++i) forces.push_back(least + (greatest - least) * i / (points - 1));
  return forces;
}

std::vector<double> Responses(const SweepOptions& options, double alpha,
                              const std::vector<double>& amplitudes) {
  std::vector<double> responses;
  for (const double amplitude : amplitudes) {
    const double k = SweepStiffnessAt(options, kSigma, alpha, kSlipForce, amplitude);
    responses.push_back(options.is_compliance ? 1.0 / k : k);
  }
  return responses;
}

// --- Closed forms -------------------------------------------------------------------------------

// δ(F) = ∫ dT/(σ(1 − T/Tc)^α) by quadrature.
TEST(SweepStiffness, IsTheForceOverTheIntegralOfTheLaw) {
  constexpr double kQuadrature = 1e-10;
  for (const double alpha : {0.0, 0.1, 1.0 / 3.0, 0.99999999, 1.0, 1.5, 3.0}) {
    for (const double tau : {1e-6, 0.1, 0.5, 0.95}) {
      const double force = tau * kSlipForce;
      const auto compliance = [&](double at) {
        return 1.0 / (kSigma * std::pow(1.0 - at / kSlipForce, alpha));
      };
      const double displacement = boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
          compliance, 0.0, force, 15, 1e-13);
      const SweepOptions secant{.over_force = true};
      EXPECT_NEAR(SweepStiffnessAt(secant, kSigma, alpha, kSlipForce, force) / kSigma,
                  force / displacement / kSigma, kQuadrature)
          << alpha << " " << tau;
      EXPECT_NEAR(SweepStiffnessAt({}, kSigma, alpha, kSlipForce, displacement) / kSigma,
                  force / displacement / kSigma, kQuadrature);
      const double slope = std::pow(1.0 - tau, alpha);
      for (const bool over_force : {true, false}) {
        const SweepOptions tangent{.stiffness = SweepStiffness::kTangent, .over_force = over_force};
        EXPECT_NEAR(SweepStiffnessAt(tangent, kSigma, alpha, kSlipForce,
                                     over_force ? force : displacement) /
                        kSigma,
                    slope, kQuadrature)
            << alpha << " " << tau;
      }
    }
  }
}

TEST(SweepStiffness, IsThatOfCoulombSlipBeyondTheBackbone) {
  const double far = 10 * kSlipForce / kSigma;
  for (const double alpha : {0.0, 1.0 / 3.0}) {
    EXPECT_DOUBLE_EQ(SweepStiffnessAt({}, kSigma, alpha, kSlipForce, far), kSlipForce / far);
    EXPECT_EQ(
        SweepStiffnessAt({.stiffness = SweepStiffness::kTangent}, kSigma, alpha, kSlipForce, far),
        0.0);
  }
}

// --- Fits ---------------------------------------------------------------------------------------

TEST(FitSweep, FindsTheLawOfExactResponses) {
  constexpr double kDigits = 1e-6;
  for (const double alpha : {0.1, 1.0 / 3.0, 0.8}) {
    for (const SweepStiffness stiffness : {SweepStiffness::kSecant, SweepStiffness::kTangent}) {
      for (const bool over_force : {true, false}) {
        for (const bool is_compliance : {true, false}) {
          const SweepOptions options{
              .stiffness = stiffness, .over_force = over_force, .is_compliance = is_compliance};
          std::vector<double> amplitudes = Forces(3.0, 55.0, 15);
          if (!over_force) {
            for (double& amplitude : amplitudes) {
              amplitude /=
                  SweepStiffnessAt({.over_force = true}, kSigma, alpha, kSlipForce, amplitude);
            }
          }
          const SweepFit fit = FitSweep(amplitudes, Responses(options, alpha, amplitudes), options);
          EXPECT_TRUE(fit.converged) << fit.message;
          EXPECT_EQ(fit.degrees_of_freedom, amplitudes.size() - 3);
          EXPECT_NEAR(fit.parameter("sigma").value, kSigma, kDigits * kSigma);
          EXPECT_NEAR(fit.parameter("alpha").value, alpha, kDigits);
          EXPECT_NEAR(fit.parameter("slip_force").value, kSlipForce, kDigits * kSlipForce);
        }
      }
    }
  }
}

/// Adds normal noise to responses.
std::vector<double> Noisy(std::vector<double> responses, double noise, unsigned seed) {
  std::mt19937_64 engine(seed);
  // Box and Muller, for the same numbers with every standard library.
  const auto uniform = [&] {
    return (static_cast<double>(engine() >> 11) + 0.5) / 9007199254740992.0;
  };
  for (double& response : responses) {
    response += noise * std::sqrt(-2 * std::log(uniform())) * std::cos(2 * M_PI * uniform());
  }
  return responses;
}

TEST(FitSweep, IntervalsContainTheTruthAsOftenAsStated) {
  const SweepOptions options{.over_force = true};
  const std::vector<double> forces = Forces(4.0, 54.0, 20);
  const std::vector<double> exact = Responses(options, 1.0 / 3.0, forces);
  constexpr int kSweeps = 200;
  const std::array<double, 3> truth = {kSigma, 1.0 / 3.0, kSlipForce};
  std::array<int, 3> covered{};
  int correlated = 0;
  for (unsigned seed = 1; seed <= kSweeps; ++seed) {
    const SweepFit fit = FitSweep(forces, Noisy(exact, 0.005 * kSigma, seed), options);
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const ParameterEstimate& parameter = fit.parameters[k];
      covered[k] += parameter.lower95.value_or(0.0) <= truth[k] &&
                            truth[k] <= parameter.upper95.value_or(1e300)
                        ? 1
                        : 0;
    }
    correlated += fit.correlation_p_value < 0.01 ? 1 : 0;
  }
  // Of 200 at 95 %: 190 ± 3.1; four standard deviations.
  for (const int count : covered) EXPECT_NEAR(count, 190, 12.4);
  // Of 200 at 1 %: 2 ± 1.4, and fitted residuals are less correlated; four standard deviations.
  EXPECT_LE(correlated, 8);
}

TEST(FitSweep, SaysWhatASweepFarFromSlipDoesNotDetermine) {
  const SweepOptions options{.over_force = true};
  const std::vector<double> forces = Forces(0.3, 6.0, 12);  // a tenth of Tc
  const SweepFit fit =
      FitSweep(forces, Noisy(Responses(options, 1.0 / 3.0, forces), 0.005 * kSigma, 7), options);
  EXPECT_EQ(fit.parameter("sigma").identifiability, Identifiability::kIdentifiable);
  EXPECT_EQ(fit.parameter("slip_force").identifiability, Identifiability::kBoundedBelow);
  EXPECT_NE(fit.parameter("alpha").identifiability, Identifiability::kIdentifiable);
  const SweepFit held = FitSweep(forces, Responses(options, 1.0 / 3.0, forces),
                                 {.over_force = true, .fixed = {{"alpha", 1.0 / 3.0}}});
  EXPECT_EQ(held.parameter("alpha").status, ParameterStatus::kFixed);
  EXPECT_EQ(held.parameter("slip_force").identifiability, Identifiability::kIdentifiable);
}

TEST(FitSweep, SeesThatASecantIsNoTangent) {
  const std::vector<double> forces = Forces(4.0, 59.0, 30);
  const std::vector<double> secants =
      Noisy(Responses({.over_force = true}, 1.0 / 3.0, forces), 1e-3 * kSigma, 3);
  EXPECT_GT(FitSweep(forces, secants, {.over_force = true}).correlation_p_value, 0.01);
  const SweepFit tangent =
      FitSweep(forces, secants, {.stiffness = SweepStiffness::kTangent, .over_force = true});
  EXPECT_LT(tangent.correlation_p_value, 0.01);
}

TEST(FitSweep, RefusesWhatIsNoSweep) {
  EXPECT_THROW(FitSweep(std::vector{1.0, 2.0}, std::vector{1.0}), InvalidArgument);
  EXPECT_THROW(FitSweep(std::vector{1.0, 2.0, 3.0}, std::vector{1.0, 1.0, 1.0}), InvalidArgument)
      << "three points for three parameters";
  EXPECT_THROW(FitSweep(std::vector{1.0, 2.0, 0.0, 4.0}, std::vector{1.0, 1.0, 1.0, 1.0}),
               InvalidArgument);
  EXPECT_THROW(FitSweep(std::vector{1.0, 2.0, 3.0, 4.0}, std::vector{1.0, 1.0, 1.0, 1.0},
                        {.fixed = {{"rig_stiffness", 1.0}}}),
               InvalidArgument);
}

}  // namespace
}  // namespace mindahl::identification::sweep_test
