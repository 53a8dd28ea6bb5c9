#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "models/normalized_response.h"

// Compilers differ in how functions are built for several instruction sets. A function that is
// always inlined takes the set of its caller;
#define MINDAHL_INLINE_LAMBDA __attribute__((always_inline))
#define MINDAHL_INLINE inline MINDAHL_INLINE_LAMBDA
// of one that is built for each of these the program takes the processor's widest when it starts.
#if defined(__x86_64__) && defined(__gnu_linux__)
#define MINDAHL_FOR_INSTRUCTION_SETS \
  __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define MINDAHL_FOR_INSTRUCTION_SETS
#endif

namespace mindahl::models {
namespace {

constexpr std::size_t kBlock = 64;  // samples; their columns stay in the nearest cache
constexpr std::size_t kLanes = 8;   // doubles in the widest vector; divides kBlock
using Column = std::array<double, kBlock>;

constexpr std::uint64_t kExponentBias = std::uint64_t{1023} << 52;

/// ln 2 in two parts, the first of 33 bits: its products with whole numbers are exact.
constexpr double kLog2High = 6.93147180369123816490e-01;
constexpr double kLog2Low = 1.90821492927058770002e-10;

/// Selects by bits, not by a condition: compilers compute both branches in vectors anyway.
MINDAHL_INLINE double Choose(std::uint64_t all_ones, double one, double other) {
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(one) & all_ones) |
                               (std::bit_cast<std::uint64_t>(other) & ~all_ones));
}

/// Reduces z: log z = k·ln 2 + 2·atanh(s), |s| <= 0.1716. Where k = 0, z = 1 − w is taken from w.
struct Reduction {
  double k;
  double s;
};
MINDAHL_INLINE Reduction Reduce(double w, double z) {
  constexpr std::uint64_t kRootHalf = 0x3fe6a09e667f3bcd;
  constexpr std::uint64_t kIntegers = 0x4330000000000000;  // 2⁵²: its last bits count ones
  constexpr double kBiased = 4503599627370496.0 + 1023.0;
  const auto bits = std::bit_cast<std::uint64_t>(z);
  const std::uint64_t biased_k = (bits - kRootHalf + kExponentBias) >> 52;
  const double k = std::bit_cast<double>(biased_k | kIntegers) - kBiased;
  const double m = std::bit_cast<double>(bits - (biased_k << 52) + kExponentBias);
  const std::uint64_t is_near = 0 - (((biased_k ^ 1023) - 1) >> 63);  // k = 0
  return {k, Choose(is_near, -w, m - 1) / Choose(is_near, 2 - w, m + 1)};
}

/// Returns Σ cᵢxⁱ, even and odd powers side by side: half as long a chain of operations.
template <std::size_t kCount>
MINDAHL_INLINE double Polynomial(const std::array<double, kCount>& c, double x) {
  static_assert(kCount % 2 == 0);
  const double square = x * x;
  double even = c[kCount - 2];
  double odd = c[kCount - 1];
  for (std::size_t i = kCount - 2; i > 0; i -= 2) {
    even = even * square + c[i - 2];
    odd = odd * square + c[i - 1];
  }
  return even + x * odd;
}

/// Returns P = Σ xⁱ/(2i+3): 2·atanh(s) = 2s + 2s³·P(s²). For x <= 0.0295 the first term left out is
/// below ε/20 of P.
MINDAHL_INLINE double AtanhSeries(double x) {
  constexpr std::array kTerms = {1. / 3,  1. / 5,  1. / 7,  1. / 9,  1. / 11,
                                 1. / 13, 1. / 15, 1. / 17, 1. / 19, 1. / 21};
  return Polynomial(kTerms, x);
}

/// e^x − 1 = scale·part + (scale − 1)
struct Exponential {
  double scale;  // 2ⁿ
  double part;   // e^r − 1, |r| <= ½ ln 2
};
MINDAHL_INLINE Exponential Exponentiate(double x) {
  constexpr double kPerLog2 = 1.4426950408889634;
  constexpr double kRound = 6755399441055744.0;  // 1.5·2⁵²: adding it rounds to an integer
  constexpr double kLowest = -708.0;             // 2ⁿ is normal
  // A condition would be left out of the lanes that slip, where what follows would overflow.
  const double bounded = Choose(0 - static_cast<std::uint64_t>(x > kLowest), x, kLowest);
  const double shifted = bounded * kPerLog2 + kRound;
  const double n = shifted - kRound;
  const double r = (bounded - n * kLog2High) - n * kLog2Low;
  constexpr std::array kFactorials = {
      1. / 2,     1. / 6,      1. / 24,       1. / 120,       1. / 720,        1. / 5040,
      1. / 40320, 1. / 362880, 1. / 3628800., 1. / 39916800., 1. / 479001600., 1. / 6227020800.};
  const std::uint64_t scale = (std::bit_cast<std::uint64_t>(shifted) + 1023) << 52;
  return {std::bit_cast<double>(scale), r + r * r * Polynomial(kFactorials, r)};
}

/// Holds the constants of all samples of a run.
struct RunConstants {
  double origin;
  double rate;
  double beta;
  double per_beta = beta == 0 ? 0.0 : 1 / beta;  // for β = 0 it is not used
};

struct Sample {
  double sign;
  double y;
  double z;  // 1 where the contact slips
  double log_remaining;
  double series;  // P
  Reduction reduction;
  Exponential exponential;
  bool slips;
};

MINDAHL_INLINE Sample SampleAt(const RunConstants& run, double displacement) {
  Sample sample{};
  const double e = displacement - run.origin;
  sample.sign = std::copysign(1.0, e);
  sample.y = run.rate * std::abs(e);
  const double all = run.beta * sample.y;
  sample.slips = !(all < 1);
  const double w = sample.slips ? 0.0 : all;
  sample.z = 1 - w;
  sample.reduction = Reduce(w, sample.z);
  const auto [k, s] = sample.reduction;
  const double square = s * s;
  sample.series = AtanhSeries(square);
  const double cubic = s * square * sample.series;
  const double log_z = k * kLog2High + (k * kLog2Low + 2 * (s + cubic));
  // s = −w/(2−w): log(1−w)/w = −(1 − s)(1 + s²P), which makes nothing special of β = 0.
  const double near = -sample.y * ((1 - s) * (1 + square * sample.series));
  sample.log_remaining = k == 0 ? near : log_z * run.per_beta;
  sample.exponential = Exponentiate(sample.log_remaining);
  return sample;
}

/// Returns φ.
MINDAHL_INLINE double ForceOf(const Sample& sample) {
  const auto [scale, part] = sample.exponential;
  return sample.slips ? 1.0 : (1 - scale) - scale * part;
}

MINDAHL_INLINE double Clamp(double value, double limit) {
  const double below = value < limit ? value : limit;
  return below > -limit ? below : -limit;
}

/// Samples of one run and what becomes of them; beyond the last there is padding.
struct Block {
  Column displacement;
  Column t;
  Column log_rate;
  Column shape_exponent;
  Column unloaded;
};

/// Whole vectors only: what is left over would be done one by one.
template <typename AtSample>
MINDAHL_INLINE void ForEach(std::size_t count, AtSample&& at) {
  for (std::size_t begin = 0; begin < count; begin += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) at(begin + lane);
  }
}

MINDAHL_FOR_INSTRUCTION_SETS void EvaluateBlock(const ScaledBranch& branch, double shape_exponent,
                                                double limit, std::size_t count, Block& block) {
  const RunConstants run = {branch.origin, branch.rate, 1 - shape_exponent};
  const double start = branch.force;
  const double height = branch.height;
  ForEach(count, [&](std::size_t i) MINDAHL_INLINE_LAMBDA {
    const Sample sample = SampleAt(run, block.displacement[i]);
    block.t[i] = Clamp(start + sample.sign * (height * ForceOf(sample)), limit);
  });
}

MINDAHL_FOR_INSTRUCTION_SETS void DifferentiateBlock(const ScaledBranch& branch,
                                                     const BranchGradient& start,
                                                     double shape_exponent, double limit,
                                                     std::size_t count, Block& block) {
  const RunConstants run = {branch.origin, branch.rate, 1 - shape_exponent};
  const double force_start = branch.force;
  const double height = branch.height;
  // data() calls no inline function of Eigen: clang does not emit these for target clones.
  const double force_rate = start.force.data()[kRate];
  const double force_shape = start.force.data()[kShape];
  const double force_unloaded = start.force.data()[kUnloaded];
  const double height_rate = start.height.data()[kRate];
  const double height_shape = start.height.data()[kShape];
  const double height_unloaded = start.height.data()[kUnloaded];
  const double elastic_rate = height * start.log_rate.data()[kRate];
  const double elastic_shape = height * start.log_rate.data()[kShape];
  const double elastic_unloaded = height * start.log_rate.data()[kUnloaded];
  const double slope_unloaded = start.origin_per_unloaded * height * branch.rate;
  ForEach(count, [&](std::size_t i) MINDAHL_INLINE_LAMBDA {
    const Sample sample = SampleAt(run, block.displacement[i]);
    const auto [k, s] = sample.reduction;
    const auto [scale, part] = sample.exponential;
    const double phi = ForceOf(sample);
    const double remaining = scale + scale * part;
    const double per_z = 1 / sample.z;
    const double slope = sample.slips ? 0.0 : remaining * per_z;
    const double elastic = sample.y * slope;
    // (w/(1−w) + log1p(−w))/w² = ½(1−s)²·[1/(1+s) + s·P], and 1/(1+s) = (1 + 1/z)/2
    const double less = 1 - s;
    const double curvature = 0.5 * less * less * (0.5 * (1 + per_z) + s * sample.series);
    const double near = remaining * sample.y * (sample.y * curvature);
    const double far = (elastic + remaining * sample.log_remaining) * run.per_beta;
    const double by_shape = sample.slips ? 0.0 : k == 0 ? near : far;
    block.t[i] = Clamp(force_start + sample.sign * (height * phi), limit);
    block.log_rate[i] = force_rate + sample.sign * (height_rate * phi + elastic_rate * elastic);
    block.shape_exponent[i] =
        force_shape +
        sample.sign * (height_shape * phi + elastic_shape * elastic - height * by_shape);
    block.unloaded[i] = force_unloaded - slope_unloaded * slope +
                        sample.sign * (height_unloaded * phi + elastic_unloaded * elastic);
  });
}

/// Fills in the samples from `begin` on; the last is repeated where whole vectors ask for more.
std::size_t Fill(std::span<const double> displacement, std::size_t begin, Block& block) {
  const std::size_t count = std::min(kBlock, displacement.size() - begin);
  std::copy_n(&displacement[begin], count, block.displacement.begin());
  for (std::size_t i = count; i % kLanes != 0; ++i) {
    block.displacement[i] = block.displacement[count - 1];
  }
  return count;
}

void Keep(const Column& column, std::size_t begin, std::size_t count, std::span<double> to) {
  if (!to.empty()) std::copy_n(column.begin(), count, &to[begin]);
}

}  // namespace

void EvaluateGeneralRun(const ScaledBranch& branch, double shape_exponent, double limit,
                        std::span<const double> displacement, std::span<double> t) {
  Block block;
  for (std::size_t begin = 0; begin < displacement.size(); begin += kBlock) {
    const std::size_t count = Fill(displacement, begin, block);
    EvaluateBlock(branch, shape_exponent, limit, count, block);
    Keep(block.t, begin, count, t);
  }
}

void DifferentiateGeneralRun(const ScaledBranch& branch, const BranchGradient& branch_gradient,
                             double shape_exponent, double limit,
                             std::span<const double> displacement, std::span<double> t,
                             const NormalizedGradient& gradient) {
  Block block;
  for (std::size_t begin = 0; begin < displacement.size(); begin += kBlock) {
    const std::size_t count = Fill(displacement, begin, block);
    DifferentiateBlock(branch, branch_gradient, shape_exponent, limit, count, block);
    Keep(block.t, begin, count, t);
    Keep(block.log_rate, begin, count, gradient[kRate]);
    Keep(block.shape_exponent, begin, count, gradient[kShape]);
    Keep(block.unloaded, begin, count, gradient[kUnloaded]);
  }
}

}  // namespace mindahl::models
