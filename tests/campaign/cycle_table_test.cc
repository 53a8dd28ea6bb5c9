

#include "mindahl/campaign/cycle_fit.h"
#include "support/prelude.h"

namespace mindahl::campaign::cycle_table_test {
namespace {

/// A fit whose numbers are given in the order of the columns.
CycleFit Filled(const std::function<double()>& next) {
  CycleFit fit;
  fit.number = 17;
  fit.first_line = 3402;
  fit.samples = 201;
  for (std::optional<double>& number : fit.numbers) number = next();
  fit.slips_grossly = true;
  fit.flags = {"glitches", "alpha_open"};
  fit.checksum = 0xfedcba9876543210U;
  return fit;
}

/// Numbers that have no round number of decimals.
CycleFit Filled() {
  double next = 0.1;
  return Filled([&] { return next /= 3; });
}

std::string WithoutEnd(const std::string& row) { return row.substr(0, row.size() - 1); }

TEST(CycleTable, ReadsBackEveryDigitItWrote) {
  const std::string row = CycleTableRow(Filled(), 1.0 / 3.0);
  const CycleFit fit = ReadCycleTableRow(WithoutEnd(row));
  EXPECT_EQ(CycleTableRow(fit, 1.0 / 3.0), row);
  EXPECT_EQ(fit["force_offset_error"], Filled()["force_offset_error"]);
  EXPECT_EQ(fit.flags, Filled().flags);
}

TEST(CycleTable, LeavesUnknownCellsEmpty) {
  CycleFit fit;
  fit.number = 3;
  const std::string row = CycleTableRow(fit, 0.0);
  EXPECT_TRUE(row.starts_with("3,0,0,,,")) << row;
  EXPECT_TRUE(row.ends_with(",0,,0000000000000000\n")) << row;
  EXPECT_EQ(CycleTableRow(ReadCycleTableRow(WithoutEnd(row)), 0.0), row);
}

TEST(CycleTable, RefusesMalformedRow) {
  EXPECT_THROW(ReadCycleTableRow("1,2,3"), InputError);
  std::string row = WithoutEnd(CycleTableRow(Filled(), 1.0));
  row.replace(row.find("201"), 3, "2x1");
  EXPECT_THROW(ReadCycleTableRow(row), InputError);
}

TEST(CycleTable, HasEachNumberInItsColumn) {
  EXPECT_EQ(CycleTableHeader(false),
            "cycle,first_line,samples,start_time [s],amplitude [m],peak_force [N],"
            "sliding_amplitude [m],half_gap [N],energy [J],energy_ratio,"
            "energy_friction_coefficient,normal_load [N],sigma [N/m],"
            "sigma_error [N/m],alpha,alpha_error,slip_force [N],slip_force_error [N],"
            "force_offset [N],force_offset_error [N],rms [N],friction_coefficient,"
            "contact_radius [m],slip_regime,accumulated_energy [J],flags,checksum\n");
  EXPECT_EQ(CycleTableHeader(true),
            "cycle,first_line,samples,start_time [s],amplitude [rad],peak_force [N m],"
            "sliding_amplitude [rad],half_gap [N m],energy [J],energy_ratio,"
            "energy_friction_coefficient,normal_load [N m],"
            "sigma [N m/rad],sigma_error [N m/rad],alpha,alpha_error,slip_force [N m],"
            "slip_force_error [N m],force_offset [N m],force_offset_error [N m],rms [N m],"
            "friction_coefficient,slip_regime,accumulated_energy [J],flags,"
            "checksum\n");
  double next = 0.5;
  CycleFit fit = Filled([&] { return next += 1; });
  EXPECT_EQ(CycleTableRow(fit, 21.5),
            "17,3402,201,1.5,2.5,3.5,4.5,5.5,6.5,7.5,8.5,9.5,10.5,11.5,12.5,13.5,14.5,15.5,"
            "16.5,17.5,18.5,19.5,20.5,gross,21.5,glitches alpha_open,fedcba9876543210\n");
  EXPECT_EQ(CycleTableRow(fit, 21.5, /*is_torsional=*/true),
            "17,3402,201,1.5,2.5,3.5,4.5,5.5,6.5,7.5,8.5,9.5,10.5,11.5,12.5,13.5,14.5,15.5,"
            "16.5,17.5,18.5,19.5,gross,21.5,glitches alpha_open,fedcba9876543210\n");
  fit.slips_grossly = false;
  EXPECT_NE(CycleTableRow(fit, 21.5).find(",partial,"), std::string::npos);
  EXPECT_FALSE(*ReadCycleTableRow(WithoutEnd(CycleTableRow(fit, 21.5))).slips_grossly);
  EXPECT_TRUE(*ReadCycleTableRow(WithoutEnd(CycleTableRow(Filled(), 21.5))).slips_grossly);
  EXPECT_EQ(ReadCycleTableRow(WithoutEnd(CycleTableRow(fit, 21.5))).checksum, fit.checksum);
}

}  // namespace
}  // namespace mindahl::campaign::cycle_table_test
