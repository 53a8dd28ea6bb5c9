#include "reading.h"

// Tables of a stiffness or compliance over the amplitude, in SI whatever their units are.
namespace mindahl::io::sweep_reader_test {
namespace {

SweepFile ReadTable(const std::string& text, const RecordColumns& columns = {},
                    const std::string& response = {}) {
  const TemporaryDirectory directory;
  return ReadSweep(directory.Write("sweep.csv", text), columns, response);
}

TEST(ReadSweep, TakesAForceOverALengthForAStiffness) {
  const SweepFile sweep =
      ReadTable("displacement amplitude [mm],stiffness [kN/mm]\n2,0.5\n4,0.25\n");
  EXPECT_EQ(sweep.amplitude, (Numbers{2e-3, 4e-3}));
  EXPECT_EQ(sweep.response, (Numbers{5e5, 2.5e5}));
  EXPECT_FALSE(sweep.over_force);
  EXPECT_FALSE(sweep.is_compliance);
}

TEST(ReadSweep, TakesALengthOverAForceForACompliance) {
  const SweepFile sweep = ReadTable("force [kN],k [mm/kN]\n1,2\n3,4\n");
  EXPECT_EQ(sweep.amplitude, (Numbers{1e3, 3e3}));
  EXPECT_EQ(sweep.response, (Numbers{2e-6, 4e-6}));
  EXPECT_TRUE(sweep.over_force);
  EXPECT_TRUE(sweep.is_compliance);
}

TEST(ReadSweep, GoesByTheNameWhereNoUnitIsStated) {
  EXPECT_TRUE(ReadTable("force,compliance\n1,2\n").is_compliance);
  EXPECT_FALSE(ReadTable("force,stiffness\n1,2\n").is_compliance);
  EXPECT_TRUE(ReadTable("force,stiffness\n1,2\n", {}, "[m/N]").is_compliance);
}

TEST(ReadSweep, DoesNotTakeTheResponseForTheAmplitude) {
  const SweepFile sweep = ReadTable("displacement [mm],force [N/mm]\n2,500\n", {}, "force");
  EXPECT_EQ(sweep.amplitude, (Numbers{2e-3}));
  EXPECT_EQ(sweep.response, (Numbers{5e5}));
  EXPECT_FALSE(sweep.over_force);
}

TEST(ReadSweep, RefusesAResponseThatIsNotPositiveByItsPlace) {
  EXPECT_NE(MessageOf<InputError>([] {
              ReadTable("x [m],k [N/m]\n1,2\n1,0\n");
            }).find("sweep.csv:3:2: 0 in SI units must be > 0"),
            std::string::npos);
}

}  // namespace
}  // namespace mindahl::io::sweep_reader_test
