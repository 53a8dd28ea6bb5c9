#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "models/normalized_response.h"

/// Holds T/Tc and its derivatives with respect to ln κ, α, δ₀ and ln c: what one evaluation of a
/// model with its gradient writes, which is the floor of any fit.
struct GradientBuffers {
  explicit GradientBuffers(std::size_t samples) : t(samples), columns(4 * samples) {}

  [[nodiscard]] mindahl::models::NormalizedGradient gradient() {
    return {Column(0), Column(1), Column(2), Column(3)};
  }

  std::vector<double> t;
  std::vector<double> columns;

 private:
  [[nodiscard]] std::span<double> Column(std::size_t index) {
    return std::span(columns).subspan(index * t.size(), t.size());
  }
};
