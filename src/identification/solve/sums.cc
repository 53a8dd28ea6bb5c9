#include "identification/solve/sums.h"

#include <cstddef>
#include <cstring>

#include "core/instruction_sets.h"

namespace mindahl::identification {
namespace {

template <typename Vector>
MINDAHL_INLINE void Load(const double* from, Vector& to) {
  std::memcpy(&to, from, sizeof to);
}
template <typename Vector>
MINDAHL_INLINE void Store(const Vector& from, double* to) {
  std::memcpy(to, &from, sizeof from);
}
template <typename Vector>
MINDAHL_INLINE void AddProduct(const double* a, const double* b, Vector& sum) {
  Vector left;
  Vector right;
  Load(a, left);
  Load(b, right);
  sum += left * right;
}

/// Four sums side by side: one would wait for itself.
template <std::size_t kLanes>
MINDAHL_INLINE double DotOf(const double* a, const double* b, std::size_t size) {
  Lanes<kLanes> first{};
  Lanes<kLanes> second{};
  Lanes<kLanes> third{};
  Lanes<kLanes> fourth{};
  std::size_t i = 0;
  for (; i + 4 * kLanes <= size; i += 4 * kLanes) {
    AddProduct(a + i, b + i, first);
    AddProduct(a + i + kLanes, b + i + kLanes, second);
    AddProduct(a + i + 2 * kLanes, b + i + 2 * kLanes, third);
    AddProduct(a + i + 3 * kLanes, b + i + 3 * kLanes, fourth);
  }
  for (; i + kLanes <= size; i += kLanes) AddProduct(a + i, b + i, first);
  first = (first + second) + (third + fourth);
  double sum = 0.0;
  for (std::size_t k = 0; k < kLanes; ++k) sum += first[k];
  for (; i < size; ++i) sum += a[i] * b[i];
  return sum;
}

template <std::size_t kLanes>
MINDAHL_INLINE void AddMultipleOf(double* to, double factor, const double* of, std::size_t size) {
  std::size_t i = 0;
  for (; i + kLanes <= size; i += kLanes) {
    Lanes<kLanes> sum;
    Lanes<kLanes> term;
    Load(to + i, sum);
    Load(of + i, term);
    Store(sum + factor * term, to + i);
  }
  for (; i < size; ++i) to[i] += factor * of[i];
}

template <std::size_t kLanes>
MINDAHL_INLINE void WeighOf(double* column, double factor, const double* weight, std::size_t size) {
  std::size_t i = 0;
  for (; i + kLanes <= size; i += kLanes) {
    Lanes<kLanes> values;
    Lanes<kLanes> weights;
    Load(column + i, values);
    Load(weight + i, weights);
    Store(values * (factor * weights), column + i);
  }
  for (; i < size; ++i) column[i] *= factor * weight[i];
}

template <std::size_t kLanes>
MINDAHL_INLINE void SubtractOf(double factor, const double* a, const double* b, double* residual,
                               std::size_t size) {
  std::size_t i = 0;
  for (; i + kLanes <= size; i += kLanes) {
    Lanes<kLanes> minuend;
    Lanes<kLanes> subtrahend;
    Load(a + i, minuend);
    Load(b + i, subtrahend);
    Store(factor * minuend - subtrahend, residual + i);
  }
  for (; i < size; ++i) residual[i] = factor * a[i] - b[i];
}

struct Sums {
  double (*dot)(const double*, const double*, std::size_t);
  void (*add_multiple)(double*, double, const double*, std::size_t);
  void (*weigh)(double*, double, const double*, std::size_t);
  void (*subtract)(double, const double*, const double*, double*, std::size_t);
};

// Attributes are no expressions.
// NOLINTBEGIN(bugprone-macro-parentheses)
#define MINDAHL_SUMS(name, lanes, target)                                                          \
  target double Dot##name(const double* a, const double* b, std::size_t size) {                    \
    return DotOf<lanes>(a, b, size);                                                               \
  }                                                                                                \
  target void AddMultiple##name(double* to, double factor, const double* of, std::size_t size) {   \
    AddMultipleOf<lanes>(to, factor, of, size);                                                    \
  }                                                                                                \
  target void Weigh##name(double* column, double factor, const double* weight, std::size_t size) { \
    WeighOf<lanes>(column, factor, weight, size);                                                  \
  }                                                                                                \
  target void Subtract##name(double factor, const double* a, const double* b, double* residual,    \
                             std::size_t size) {                                                   \
    SubtractOf<lanes>(factor, a, b, residual, size);                                               \
  }                                                                                                \
  constexpr Sums k##name{Dot##name, AddMultiple##name, Weigh##name, Subtract##name};

MINDAHL_SUMS(Baseline, 2, )
#if defined(__x86_64__)
MINDAHL_SUMS(Avx2, 4, MINDAHL_TARGET_AVX2)
MINDAHL_SUMS(Avx512, 8, MINDAHL_TARGET_AVX512)
#endif
#undef MINDAHL_SUMS
// NOLINTEND(bugprone-macro-parentheses)

const Sums& Widest() {
  static const Sums& widest = []() -> const Sums& {
#if defined(__x86_64__)
    if (HasAvx512()) return kAvx512;
    if (HasAvx2()) return kAvx2;
#endif
    return kBaseline;
  }();
  return widest;
}

}  // namespace

double Dot(std::span<const double> a, std::span<const double> b) {
  return Widest().dot(a.data(), b.data(), a.size());
}

void AddMultiple(std::span<double> to, double factor, std::span<const double> of) {
  Widest().add_multiple(to.data(), factor, of.data(), to.size());
}

double TakeOut(std::span<double> column, std::span<const double> unit) {
  const double share = Dot(unit, column);
  AddMultiple(column, -share, unit);
  return share;
}

void Weigh(std::span<double> column, double factor, std::span<const double> weight) {
  Widest().weigh(column.data(), factor, weight.data(), column.size());
}

void Subtract(double factor, std::span<const double> a, std::span<const double> b,
              std::span<double> residual) {
  Widest().subtract(factor, a.data(), b.data(), residual.data(), residual.size());
}

}  // namespace mindahl::identification
