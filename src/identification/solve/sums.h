#pragma once

#include <span>

/// Computes sums over columns of samples, built for several instruction sets of which the widest
/// that the processor has is chosen at the first call; they differ in roundings only.
namespace mindahl::identification {

/// Σ aᵢbᵢ, of equal sizes.
double Dot(std::span<const double> a, std::span<const double> b);

/// to += factor·of, of equal sizes.
void AddMultiple(std::span<double> to, double factor, std::span<const double> of);

/// Frees a column of what a unit vector has of it.
/// @returns their product before
double TakeOut(std::span<double> column, std::span<const double> unit);

/// column *= factor·weight, sample by sample, of equal sizes.
void Weigh(std::span<double> column, double factor, std::span<const double> weight);

/// residual = factor·a − b, of equal sizes.
void Subtract(double factor, std::span<const double> a, std::span<const double> b,
              std::span<double> residual);

}  // namespace mindahl::identification
