

#include "mindahl/campaign/cycle_fit.h"
#include "support/prelude.h"

namespace mindahl::campaign::cycle_table_test {
namespace {

CycleFit Filled() {
  CycleFit fit;
  fit.number = 17;
  fit.first_line = 3402;
  fit.samples = 201;
  double next = 0.1;
  for (std::optional<double>* value : {&fit.start_time,
                                       &fit.amplitude,
                                       &fit.peak_force,
                                       &fit.sliding_amplitude,
                                       &fit.half_gap,
                                       &fit.energy,
                                       &fit.energy_ratio,
                                       &fit.energy_friction_coefficient,
                                       &fit.slope_after_reversal,
                                       &fit.normal_load,
                                       &fit.sigma.value,
                                       &fit.sigma.standard_error,
                                       &fit.alpha.value,
                                       &fit.alpha.standard_error,
                                       &fit.slip_force.value,
                                       &fit.slip_force.standard_error,
                                       &fit.force_offset.value,
                                       &fit.force_offset.standard_error,
                                       &fit.rms,
                                       &fit.friction_coefficient}) {
    *value = next /= 3;  // no round number of decimals
  }
  fit.slips_grossly = true;
  fit.flags = {"glitches", "alpha_open"};
  fit.checksum = 0xfedcba9876543210U;
  return fit;
}

std::string WithoutEnd(const std::string& row) { return row.substr(0, row.size() - 1); }

TEST(CycleTable, ReadsBackEveryDigitItWrote) {
  const std::string row = CycleTableRow(Filled(), 1.0 / 3.0);
  const CycleTableEntry entry = ReadCycleTableRow(WithoutEnd(row));
  EXPECT_EQ(CycleTableRow(entry.fit, entry.accumulated_energy), row);
  EXPECT_EQ(entry.accumulated_energy, 1.0 / 3.0);
  EXPECT_EQ(entry.fit.force_offset.standard_error, Filled().force_offset.standard_error);
  EXPECT_EQ(entry.fit.flags, Filled().flags);
}

TEST(CycleTable, LeavesUnknownCellsEmpty) {
  CycleFit fit;
  fit.number = 3;
  const std::string row = CycleTableRow(fit, 0.0);
  EXPECT_TRUE(row.starts_with("3,0,0,,,")) << row;
  EXPECT_TRUE(row.ends_with(",0,,0000000000000000\n")) << row;
  EXPECT_EQ(CycleTableRow(ReadCycleTableRow(WithoutEnd(row)).fit, 0.0), row);
}

TEST(CycleTable, HasAsManyNamesAsCells) {
  for (const bool is_torsional : {false, true}) {
    const std::string header = CycleTableHeader(is_torsional);
    EXPECT_EQ(std::ranges::count(header, ','),
              std::ranges::count(CycleTableRow(Filled(), 0.0), ','));
    EXPECT_EQ(header.back(), '\n');
  }
}

TEST(CycleTable, NamesTheUnitsOfTheRecord) {
  EXPECT_NE(CycleTableHeader(false).find("sigma [N/m]"), std::string::npos);
  EXPECT_NE(CycleTableHeader(true).find("sigma [N m/rad]"), std::string::npos);
  EXPECT_NE(CycleTableHeader(true).find("amplitude [rad]"), std::string::npos);
}

TEST(CycleTable, RefusesMalformedRow) {
  EXPECT_THROW(ReadCycleTableRow("1,2,3"), InputError);
  std::string row = WithoutEnd(CycleTableRow(Filled(), 1.0));
  row.replace(row.find("201"), 3, "2x1");
  EXPECT_THROW(ReadCycleTableRow(row), InputError);
}

}  // namespace
}  // namespace mindahl::campaign::cycle_table_test
