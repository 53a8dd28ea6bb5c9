#pragma once

namespace mindahl {

// Distributions of test statistics, in double precision: relative errors of some 1e-14. Compiled
// once, as the templates behind them take seconds in every source that uses them.

/// Returns Φ⁻¹((1 + confidence)/2), within which a normal law lies with this probability.
double NormalQuantile(double confidence);

/// Returns the half width of a two-sided interval of this confidence in standard errors (Student).
double StudentQuantile(double degrees_of_freedom, double confidence);
/// P(|t(ν)| > |t|)
double PValueOfT(double t, double degrees_of_freedom);

/// P(F(k, ν) > f)
double PValueOfF(double f, double numerator_degrees, double degrees_of_freedom);
/// Returns the f whose PValueOfF() is this.
double QuantileOfF(double p_value, double numerator_degrees, double degrees_of_freedom);

/// P(χ²(k) > x)
double PValueOfChiSquared(double x, double degrees_of_freedom);

}  // namespace mindahl
