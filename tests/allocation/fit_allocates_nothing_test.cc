
#include <atomic>
#include <cstdlib>
#include <new>

#include "identification/sample_loop.h"
#include "mindahl/identification/fit.h"
#include "support/prelude.h"

// What a fitter allocates from the free store once it is warm. Every allocation of the program goes
// through the operators here: the tests have an executable of their own.
namespace {

std::atomic<bool> counting = false;
std::atomic<std::size_t> allocations = 0;

void* Allocate(std::size_t bytes, std::size_t alignment) {
  if (counting) ++allocations;
  const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, whole == 0 ? alignment : whole);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) { return Allocate(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return Allocate(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace mindahl::identification::fit_allocates_nothing_test {
namespace {

using namespace loop;
using namespace models;

/// Samples so dense that σ times the longest step beside a reversal is lost in the noise: no
/// turning point between them is looked for. A(2π/N)²/2 of an amplitude A = 125 N, over 1 % of
/// 60 N: N > 160.
Record Loop(double cycles = 2.0) {
  const testing::History displacement = testing::Cycling(testing::Wave::kSine, kReach, cycles, 240);
  return testing::MakeRecord(displacement,
                             testing::Respond(testing::Model("mindlin-dahl"), kLaw, displacement));
}

/// Of the third fit: the first takes the memory, the second puts it in one piece.
std::size_t AllocationsOfAWarmFit(const std::vector<Record>& records, FitOptions options = {}) {
  const std::vector<RecordView> views(records.begin(), records.end());
  Fitter fitter(std::move(options));
  fitter.Fit(views, Depth::kEstimate);
  EXPECT_TRUE(fitter.Fit(views, Depth::kEstimate).converged);
  allocations = 0;
  counting = true;
  fitter.Fit(views, Depth::kEstimate);
  counting = false;
  return allocations;
}

Record Noisy(Record record) {
  Generator generator(3);
  return WithForceNoise(std::move(record), 0.01 * kLaw.slip_force, generator);
}

TEST(WarmFit, AllocatesNothingOnACleanRecord) { EXPECT_EQ(AllocationsOfAWarmFit({Loop()}), 0U); }

TEST(WarmFit, AllocatesNothingOnANoisyVirginRecord) {
  EXPECT_EQ(AllocationsOfAWarmFit({Noisy(Loop())}), 0U);
}

TEST(WarmFit, AllocatesNothingOnASteadyRecord) {
  const Record record = testing::From(Loop(3.0), 190);
  EXPECT_EQ(AllocationsOfAWarmFit({record}), 0U);
  EXPECT_EQ(AllocationsOfAWarmFit({Noisy(record)}), 0U);
}

TEST(WarmFit, AllocatesNothingOnTwoRecords) {
  // As steady contacts they would be fitted with α at its bound 0, where ceres::Solve takes over.
  FitOptions options;
  options.initial_state = InitialState::kVirgin;
  EXPECT_EQ(AllocationsOfAWarmFit({Noisy(Loop()), Noisy(Loop(3.0))}, options), 0U);
}

TEST(WarmFit, AllocatesNothingWithTermsAndFixedParameters) {
  Record record = Noisy(Loop());
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.time.push_back(0.01 * static_cast<double>(i));
  }
  FitOptions options;
  options.terms = {"force_drift", "plateau_slope"};
  EXPECT_EQ(AllocationsOfAWarmFit({record}, options), 0U);
  FitOptions held;
  held.fixed["alpha"] = kLaw.shape_exponent;
  EXPECT_EQ(AllocationsOfAWarmFit({record}, held), 0U);
}

TEST(WarmFit, IsCounted) {
  allocations = 0;
  counting = true;
  std::vector<double> one(3);
  counting = false;
  EXPECT_EQ(allocations, 1U) << one.size();
}

}  // namespace
}  // namespace mindahl::identification::fit_allocates_nothing_test
