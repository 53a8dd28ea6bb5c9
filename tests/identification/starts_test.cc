#include "recovery/recovered.h"
#include "support/prelude.h"

// The search of a fit begins where looks over the plane of the law are lowest.
namespace mindahl::identification::starts_test {
namespace {

using loop::Record;

struct LateRecord {
  double lambda;
  double cycles;
  std::size_t lost;  // samples before the record begins, 200 a cycle
  std::string_view model;
};

TEST(Starts, OfARecordToldToBeVirginLeadToTheLeastMinimum) {
  // The record begins when the contact already slips: where it was unloaded is none of its samples,
  // and looks from elsewhere are lower than those that lead to the minimum.
  constexpr models::BranchLaw kMindlin{4e7, 1.0 / 3, 40.0};
  for (const LateRecord& late :
       {LateRecord{7.8, 1.25, 55, "mindlin"}, LateRecord{3.6, 2.5, 55, "mindlin"},
        LateRecord{6.2, 1.5, 55, "mindlin"}, LateRecord{7.0, 1.25, 55, "mindlin-dahl"},
        LateRecord{8.9, 2.5, 3, "dahl"}}) {
    const double reach = late.lambda * GrossSlipDisplacement(kMindlin);
    const History displacement = Cycling(Wave::kSine, reach, late.cycles, 200);
    Generator generator(7);
    Record record = WithForceNoise(testing::LoopOf(kMindlin, displacement), 0.05, generator);
    record = Shifted(From(std::move(record), late.lost), reach, 0.0);
    FitOptions options;
    options.model = models::FindFrictionModel(late.model);
    options.initial_state = models::InitialState::kVirgin;
    const double rms = FitOne(record, options).residuals.rms;
    options.start = {{"sigma", kMindlin.tangential_stiffness},
                     {"alpha", kMindlin.shape_exponent},
                     {"slip_force", kMindlin.slip_force},
                     {"displacement_offset", reach}};
    EXPECT_LE(rms, (1 + 1e-6) * FitOne(record, options).residuals.rms)
        << late.lambda << " " << late.model;
  }
}

}  // namespace
}  // namespace mindahl::identification::starts_test
