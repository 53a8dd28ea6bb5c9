#include "mindahl/io/record_reader.h"

#include <cstdlib>
#include <filesystem>

#include "support/prelude.h"
#include "temporary_directory.h"

namespace mindahl::io::record_reader_test {
namespace {

using Strings = std::vector<std::string>;
using Numbers = std::vector<double>;

struct Choice {
  std::string column, unit;
  [[nodiscard]] std::string Text() const {
    return unit.empty() ? column : column + "[" + unit + "]";
  }
};

RecordColumns Choose(const Choice& displacement, const Choice& force = {}, const Choice& time = {},
                     const Choice& normal_load = {}) {
  return {displacement.Text(), force.Text(), time.Text(), normal_load.Text()};
}

RecordFile Read(const std::string& text, const RecordColumns& columns = {}) {
  const TemporaryDirectory directory;
  return ReadRecord(directory.Write("loop.csv", text), columns);
}

/// Without the directory, so that a table can hold the whole message.
std::string WithoutDirectory(std::string message, const std::filesystem::path& directory) {
  const std::string prefix = directory.string() + "/";
  for (std::size_t at = message.find(prefix); at != std::string::npos; at = message.find(prefix)) {
    message.erase(at, prefix.size());
  }
  return message;
}

std::string Refusal(const std::string& text, const RecordColumns& columns = {}) {
  const TemporaryDirectory directory;
  const auto path = directory.Write("loop.csv", text);
  return WithoutDirectory(MessageOf<InputError>([&] { ReadRecord(path, columns); }),
                          directory.path());
}

Strings Notes(const std::string& text, const RecordColumns& columns = {}) {
  const TemporaryDirectory directory;
  Strings notes = ReadRecord(directory.Write("loop.csv", text), columns).notes;
  for (std::string& note : notes) note = WithoutDirectory(note, directory.path());
  return notes;
}

// --- Which column is which -----------------------------------------------------------------------

struct Header {
  std::string names;  ///< of the columns 1, 2, 3, 4, comma-separated
  std::size_t displacement;
  std::size_t force;
  std::size_t time = 0;  ///< 0: absent
  std::size_t normal_load = 0;
};

void PrintTo(const Header& header, std::ostream* out) { *out << header.names; }

class RecognizedHeader : public ::testing::TestWithParam<Header> {};

TEST_P(RecognizedHeader, GivesEachQuantityItsColumn) {
  const Header& header = GetParam();
  const RecordFile file = Read(header.names + "\n1.5,2.5,3.5,4.5\n");
  EXPECT_EQ(file.displacement.index, header.displacement);
  EXPECT_EQ(file.force.index, header.force);
  EXPECT_EQ(file.time ? file.time->index : 0, header.time);
  EXPECT_EQ(file.normal_load ? file.normal_load->index : 0, header.normal_load);
  EXPECT_EQ(file.record.time.empty(), header.time == 0);
  EXPECT_EQ(file.record.normal_load.empty(), header.normal_load == 0);
}

INSTANTIATE_TEST_SUITE_P(
    , RecognizedHeader,
    ::testing::Values(
        Header{"displacement,force,time,normal load", 1, 2, 3, 4},
        Header{"Time [s],Normal [uN],Position [mm],Friction [uN]", 3, 4, 1, 2},
        Header{"time_s,displacement_m,force_N,velocity_m_s", 2, 3, 1},
        Header{"TIME,POSITION,TORQUE,CONTROL_TORQUE", 2, 3, 1}, Header{"F (kN),x [um],a,b", 2, 1},
        Header{"t,N,x,T", 3, 4, 1, 2}, Header{"t,x,F,T", 2, 3, 1}, Header{"n,x,F,t", 2, 3, 4},
        Header{"F_N,F_t,delta,t", 3, 2, 4, 1}, Header{"x_mm,F_N,a,b", 1, 2},
        Header{"F_N,F,x,t", 3, 2, 4, 1},
        Header{"Time Stamp,normal-force,tangential_force,stroke", 4, 3, 1, 2},
        Header{"friction force,force,disp_mm,x", 3, 1}, Header{"position,displacement,Q,c", 2, 3},
        Header{"tangential displacement / mm,displacement / mm,Ft,fn", 1, 3, 0, 4},
        Header{"δ,f,a,b", 1, 2}, Header{"Zeit,Weg,Kraft,Normalkraft", 2, 3, 1, 4},
        Header{"Temps (s),Effort (N),Déplacement (mm),Charge normale (N)", 3, 2, 1, 4}));

TEST(RecordReader, TakesTheOnlyColumnLeftForTheForce) {
  const RecordFile file = Read("load,extension\n1.5,2.5\n");
  EXPECT_EQ(file.displacement.index, 2u);
  EXPECT_EQ(file.force.index, 1u);
}

TEST(RecordReader, FindsChosenColumnByNumberNameCaseAndNameWithoutUnit) {
  const std::string text = "Pad [mm],pad,Cell [N],four\n1.5,2.5,3.5,4.5\n";
  const auto force_column = [&](const std::string& name) {
    return Read(text, Choose({"4", "m"}, {name, "N"})).force.index;
  };
  EXPECT_EQ(force_column("3"), 3u);
  EXPECT_EQ(force_column("pad"), 2u);
  EXPECT_EQ(force_column("PAD [MM]"), 1u);
  EXPECT_EQ(force_column("cell"), 3u);
}

TEST(RecordReader, PrefersExactNameToAnotherCase) {
  EXPECT_EQ(Read("f,F,x\n1.5,2.5,3.5\n", Choose({}, {"F", ""})).force.index, 2u);
}

TEST(RecordReader, ReadsTimeAndNormalLoadThatAreAskedFor) {
  const RecordFile file = Read("1.5,2.5,3.5,4.5\n", Choose({}, {}, {"4", "ms"}, {"3", "kN"}));
  EXPECT_EQ(file.record.time, (Numbers{4.5e-3}));
  EXPECT_EQ(file.record.normal_load, (Numbers{3500}));
  EXPECT_EQ(file.time->unit, "ms");
  EXPECT_EQ(file.normal_load->unit, "kN");
}

TEST(RecordReader, LeavesOutUnaskedTimeWithoutNumbersWithNote) {
  const std::string text = "time,x [m],F [N]\nfirst,1.5,2.5\nsecond,3.5,4.5\n";
  EXPECT_FALSE(Read(text).time);
  EXPECT_EQ(Notes(text), (Strings{"loop.csv: time 'time' (column 1) holds no numbers: left out"}));
}

// --- Units ---------------------------------------------------------------------------------------

struct UnitHeader {
  std::string text;
  std::string unit;     ///< of the displacement
  double displacement;  ///< [m]
};

void PrintTo(const UnitHeader& header, std::ostream* out) { *out << header.text; }

class HeaderWithUnits : public ::testing::TestWithParam<UnitHeader> {};

TEST_P(HeaderWithUnits, ConvertsToSi) {
  const RecordFile file = Read(GetParam().text);
  EXPECT_EQ(file.displacement.unit, GetParam().unit);
  EXPECT_EQ(file.force.unit, "kN");
  EXPECT_EQ(file.record.displacement, (Numbers{GetParam().displacement}));
  EXPECT_EQ(file.record.force, (Numbers{2500}));
  EXPECT_EQ(file.notes, Strings{});
}

INSTANTIATE_TEST_SUITE_P(
    , HeaderWithUnits,
    ::testing::Values(UnitHeader{"x [mm],F (kN)\n1.5,2.5\n", "mm", 1.5e-3},
                      UnitHeader{"x[um],F(kN)\n1.5,2.5\n", "um", 1.5e-6},
                      UnitHeader{"x [\u00b5m],F [kN]\n1.5,2.5\n", "um", 1.5e-6},
                      UnitHeader{"x [\u03bcm],F [kN]\n1.5,2.5\n", "um", 1.5e-6},
                      UnitHeader{"disp_mm,force_kN\n1.5,2.5\n", "mm", 1.5e-3},
                      UnitHeader{"disp mm,force kN\n1.5,2.5\n", "mm", 1.5e-3},
                      UnitHeader{"\"Position, nm\",\"Force, kN\"\n1.5,2.5\n", "nm", 1.5e-9},
                      UnitHeader{"x / mm,F/kN\n1.5,2.5\n", "mm", 1.5e-3},
                      UnitHeader{"x,F\nmm,kN\n1.5,2.5\n", "mm", 1.5e-3},
                      UnitHeader{"x,F\n[in],[kN]\n\n1.5,2.5\n", "in", 0.0381},
                      UnitHeader{"x [mm],F\n,kN\n1.5,2.5\n", "mm", 1.5e-3},
                      UnitHeader{"x [mm] F [kN]\n1.5 2.5\n", "mm", 1.5e-3},
                      UnitHeader{"Zeit [s];Weg [mm];Kraft [kN]\n0,5;1,5;2,5\n", "mm", 1.5e-3}));

TEST(RecordReader, PutsChosenUnitAboveThatOfTheHeader) {
  const RecordFile file = Read("x [mm],F [furlong]\n1.5,2.5\n", Choose({"", "um"}, {"", "mN"}));
  EXPECT_EQ(file.record.displacement, (Numbers{1.5e-6}));
  EXPECT_EQ(file.record.force, (Numbers{2.5e-3}));
}

TEST(RecordReader, TakesSiWithNoteWhenNoUnitIsNamed) {
  EXPECT_EQ(Notes("x,F\n1.5,2.5\n"),
            (Strings{"loop.csv: displacement 'x' (column 1) names no unit: taken as m; "
                     "--displacement '1 [m]' says so",
                     "loop.csv: force 'F' (column 2) names no unit: taken as N; "
                     "--force '2 [N]' says so"}));
}

TEST(RecordReader, NotesSkippedPreamble) {
  EXPECT_EQ(Notes("rate,200\ngain,3\nx [m],F [N]\n1.5,2.5\n"),
            (Strings{"loop.csv:3: 2 rows above the header skipped"}));
}

// --- Broken files and choices, and what is said of each ------------------------------------------

struct Fault {
  std::string name;
  std::string text;
  RecordColumns columns;
  std::string message;
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class RecordFault : public ::testing::TestWithParam<Fault> {};

TEST_P(RecordFault, IsReportedInOneLine) {
  EXPECT_EQ(Refusal(GetParam().text, GetParam().columns), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    , RecordFault,
    ::testing::Values(
        Fault{"UnknownName", "t,x,F\n1,2,3\n", Choose({"y", ""}),
              "loop.csv: --displacement y: no column is called 'y' (for the displacement): the "
              "columns are 't' (1), "
              "'x' (2), 'F' (3)"},
        Fault{"NameInFileWithoutHeader", "1,2,3\n", Choose({"y", ""}),
              "loop.csv: --displacement y: no column is called 'y' (for the displacement): the "
              "file names none of "
              "its 3 columns: choose by number"},
        Fault{"NumberTooLarge", "t,x,F\n1,2,3\n", Choose({}, {"4", ""}),
              "loop.csv: --force 4: there is no column 4: the file has 3 columns"},
        Fault{"NumberZero", "t,x,F\n1,2,3\n", Choose({}, {"0", ""}),
              "loop.csv: --force 0: there is no column 0: the file has 3 columns"},
        Fault{"SameColumnTwice", "t,x,F\n1,2,3\n", Choose({"x", ""}, {"2", ""}),
              "loop.csv: 'x' (column 2) is chosen for the force and for another quantity: choose "
              "two columns"},
        Fault{"AmbiguousNames", "\nx,d,F\n1,2,3\n", Choose({}),
              "loop.csv:2: 'x' (column 1) and 'd' (column 2) may each be the displacement: give "
              "--displacement 1 or --displacement 2"},
        Fault{"RepeatedName", "x,x,F\n1,2,3\n", Choose({"x", ""}),
              "loop.csv:1: 'x' (column 1) and 'x' (column 2) may each be the displacement: give "
              "--displacement 1 or --displacement 2"},
        Fault{"NameInTwoUnits", "x [mm],x [V],F\n1,2,3\n", Choose({"x", ""}),
              "loop.csv:1: 'x [mm]' (column 1) and 'x [V]' (column 2) may each be the "
              "displacement: give --displacement 1 or --displacement 2"},
        Fault{"OneColumn", "x\n1\n", Choose({}),
              "loop.csv: no column for the force: the file has 1 column"},
        Fault{"UnknownChosenUnit", "x,F\n1,2\n", Choose({"", "furlong"}),
              "loop.csv: the displacement unit 'furlong' is not known: must be one of m, mm, um, "
              "nm, cm, in, ft, mil, pm"},
        Fault{
            "UnknownUnitInHeader", "\nt,x [m],F [V]\n1,2,3\n", Choose({}),
            "loop.csv:2:3: the unit 'V' of 'F [V]' (column 3) is not known for the force: must be "
            "one of N, mN, uN, kN, MN, lbf, kgf, kip, gf, daN, dyn, or choose the unit with "
            "--force '3 [N]'"},
        Fault{"PressureInHeader", "x [m],p [bar]\n1,2\n", Choose({}, {"p", ""}),
              "loop.csv:1:2: 'p [bar]' (column 2) is a pressure, in bar, and no force: choose "
              "another column; pressure times area is an additional force, for which there is "
              "--covariate"},
        Fault{"PressureAsAChosenUnit", "x [m],F\n1,2\n", Choose({}, {"", "MPa"}),
              "loop.csv: 'F' (column 2) is a pressure, in MPa, and no force: choose another "
              "column; pressure times area is an additional force, for which there is --covariate"},
        Fault{"TorqueAgainstALength", "\nt,x [m],Torque [Nm]\n1,2,3\n", Choose({}),
              "loop.csv: 'x [m]' (column 2) in m and 'Torque [Nm]' (column 3) in Nm do not match: "
              "a torque needs an angle, a force a length; choose other columns, or give their "
              "units, as "
              "in --force '3 [N]'"},
        Fault{"ForceAgainstAnAngle", "angle,F\n1,2\n", Choose({}, {"", "kN"}),
              "loop.csv: 'angle' (column 1) in rad and 'F' (column 2) in kN do not match: a torque "
              "needs an angle, a force a length; choose other columns, or give their units, as in "
              "--force '2 [N]'"},
        Fault{"CountdownUnderAnUnknownName", "left,F\n3,0\n2,5\n1,-5\n", Choose({}),
              "loop.csv:2:1: 'left' (column 1) only falls while 'F' (column 2) goes to and fro, as "
              "a clock or a counter does: choose the displacement with --displacement, by name or "
              "number: the columns are 'left' (1), 'F' (2)"},
        Fault{"TimeBeforeThatOfTheRowAbove",
              "time [ms],x [m],F [N]\n1,1,1\n2,2,2\n2,3,3\n# a restart\n0.5,4,4\n", Choose({}),
              "loop.csv:6:1: time = 0.5 ms is before the 2 ms of the row above: times must not "
              "fall; sort the rows, split the file where a clock starts again, or rename the "
              "column if it holds no time"},
        Fault{"UnknownUnitInUnitsRow", "x,F\nfurlong,N\n1,2\n", Choose({}),
              "loop.csv:1:1: the unit 'furlong' of 'x' (column 1) is not known for the "
              "displacement: must be one of m, mm, um, nm, cm, in, ft, mil, pm, or choose the unit "
              "with "
              "--displacement '1 [m]'"},
        Fault{"UnknownUnitBehindSlash", "x / m/s,F\n1,2\n", Choose({}),
              "loop.csv:1:1: the unit 'm/s' of 'x / m/s' (column 1) is not known for the "
              "displacement: must be one of m, mm, um, nm, cm, in, ft, mil, pm, or choose the unit "
              "with "
              "--displacement '1 [m]'"},
        Fault{"TwoUnits", "x [mm],F\num,N\n1,2\n", Choose({}),
              "loop.csv:1: 'x [mm]' (column 1) has the unit 'mm' in its name and 'um' below it: "
              "choose its unit with --displacement '1 [mm]'"},
        Fault{"OverflowInSi", "x [m],F [kN]\n1,2\n1,1e307\n", Choose({}),
              "loop.csv:3:2: force = 1e+307 kN is too large: must be below 1.8e308 in SI units"},
        Fault{"NotANumber", "x [m],F [N]\n1,2\n3,off\n", Choose({}),
              "loop.csv:3:2: 'off' is not a number: write it like -1.5e-3, or remove the row"},
        Fault{"TimeBrokenInOneRow", "time,x [m],F [N]\n1,2,3\nnan,2,3\n", Choose({}),
              "loop.csv:3:1: 'nan' is not a number: fill in the cell or remove the row; 1 of 2 "
              "rows are so: --broken-rows skip leaves them out"}),
    [](const auto& test) { return test.param.name; });

TEST(RecordReader, TakesASingleStrokeForOne) {
  // A noisy force along one stroke wavers, it does not go back by half its range.
  const Numbers stroke = {0, 1, 2, 3, 4};
  EXPECT_EQ(Read("0,0\n1,3\n2,2.5\n3,5\n4,4.6\n").record.displacement, stroke);
  // By name it may be whatever it is.
  EXPECT_EQ(Read("x,F\n0,0\n1,3\n2,-2\n3,5\n4,0\n").record.displacement, stroke);
  EXPECT_EQ(Read("0,0\n1,3\n2,-2\n3,5\n4,0\n", Choose({"1", ""})).record.displacement, stroke);
}

TEST(RecordReader, ReadsATorqueAgainstAnAngle) {
  struct Case {
    const char* text;
    RecordColumns columns;
    const char* angle_unit;
    const char* torque_unit;
  };
  for (const Case& c : {Case{"angle [deg],torque [N m]\n180,2\n", {}, "deg", "N m"},
                        Case{"angle_deg,torque_Nm\n180,2\n", {}, "deg", "N m"},
                        Case{"rotation / rev,T [N·m]\n0.5,2\n", {}, "rev", "N m"},
                        Case{"rotation,torque\ndeg,Nmm\n180,2000\n", {}, "deg", "N mm"},
                        Case{"twist [°],torque\n180,2\n", {}, "deg", "N m"},
                        Case{"angle,torque [kN m]\n3.141592653589793,0.002\n", {}, "rad", "kN m"},
                        Case{"180,2\n", Choose({"", "deg"}, {"", "Nm"}), "deg", "N m"}}) {
    SCOPED_TRACE(c.text);
    const RecordFile file = Read(c.text, c.columns);
    EXPECT_TRUE(file.is_torsional);
    EXPECT_DOUBLE_EQ(file.record.displacement[0], std::numbers::pi);
    EXPECT_DOUBLE_EQ(file.record.force[0], 2.0);
    EXPECT_EQ(file.displacement.unit, c.angle_unit);
    EXPECT_EQ(file.force.unit, c.torque_unit);
  }
  EXPECT_THROW(Read("x [mm],torque\n1,2\n"), InputError) << "a force that is called so";
}

TEST(RecordReader, DoesNotTakeARadialForceForAnAngle) {
  EXPECT_EQ(Read("x,F,F_rad\n1,2,3\n").force.index, 2u);
  EXPECT_EQ(Read("x,Fx_rad\n1,2\n", Choose({}, {"Fx_rad", ""})).force.unit, "N");
}

TEST(RecordReader, KnowsTheLineOfEverySample) {
  EXPECT_EQ(Read("x,F\n1,2\n# a remark\n3,4\n").lines, (std::vector<std::size_t>{2, 4}));
}

// --- Displacement paths --------------------------------------------------------------------------

Numbers ReadPath(const std::string& text, const std::string& choice = {}) {
  const TemporaryDirectory directory;
  return ReadDisplacementPath(directory.Write("path.csv", text), choice);
}

TEST(ForcePath, IsTheFirstColumnWithItsUnitAndTheLinesOfTheFile) {
  const TemporaryDirectory directory;
  const ForcePath path =
      ReadForcePath(directory.Write("f.csv", "# a remark\nF [kN],x\n1,2\n\n3,4\n"));
  EXPECT_EQ(path.force, (Numbers{1000, 3000}));
  EXPECT_EQ(path.lines, (std::vector<std::size_t>{3, 5}));
}

TEST(ForcePath, OfARecordWithTimeFirstIsItsForce) {
  const TemporaryDirectory directory;
  const auto file = directory.Write("f.csv", "t [s],x [m],F [N]\n0,5,7\n1,6,8\n");
  EXPECT_EQ(ReadForcePath(file).force, (Numbers{7, 8}));
  EXPECT_EQ(ReadForcePath(file, "[mN]").force, (Numbers{0.007, 0.008}));
}

// --- Columns beside the loop ---------------------------------------------------------------------

TEST(Covariates, ThatAreChosenComeFirstAndAreCalledAsTheyWereChosen) {
  RecordColumns columns;
  columns.covariates = {"p", "3"};
  const RecordFile file = Read("x [m],F [N],q [K],p [bar],s\n0,0,1,5,7\n1,2,3,6,7\n", columns);
  ASSERT_EQ(file.record.covariates.size(), 2U);
  EXPECT_EQ(file.record.covariates[0].name, "p");
  EXPECT_EQ(file.record.covariates[0].unit, "bar");
  EXPECT_EQ(file.record.covariates[0].values, (Numbers{5, 6}));
  EXPECT_EQ(file.covariates[0].index, 4U);
  EXPECT_EQ(file.record.covariates[1].name, "3");
  EXPECT_EQ(file.record.covariates[1].values, (Numbers{1, 3}));
}

TEST(Covariates, OfOtherColumnsAreThoseOfNumbersThatChange) {
  // A constant, a word, a time and a load are none; of two called alike each has its number.
  const RecordFile file =
      Read("t [s],x [m],F [N],c,w,N [N],p [bar],a,a\n0,0,0,7,u,5,1,2,3\n1,1,2,7,v,6,2,4,4\n");
  Strings names;
  for (const loop::Covariate& covariate : file.record.covariates) names.push_back(covariate.name);
  EXPECT_EQ(names, (Strings{"p", "8", "9"}));
  std::string header = "x [m],F [N]";
  std::string one = "\n0,0";
  std::string two = "\n1,2";
  for (int i = 0; i < 20; ++i) {
    header += ",c" + std::to_string(i);
    one += ",1";
    two += ",2";
  }
  EXPECT_EQ(Read(header + one + two + "\n").record.covariates.size(), kMostOtherColumns);
}

TEST(Covariates, ThatCannotBeAreRefusedByName) {
  const std::string text = "x [m],F [N],p\n0,0,1\n1,2,2\n";
  const auto refusal = [&](const Strings& choices) {
    RecordColumns columns;
    columns.covariates = choices;
    return Refusal(text, columns);
  };
  EXPECT_EQ(refusal({"q"}),
            "loop.csv: --covariate q: no column is called 'q' (for the covariate): the columns are "
            "'x [m]' (1), "
            "'F [N]' (2), 'p' (3)");
  EXPECT_EQ(refusal({"4"}),
            "loop.csv: --covariate 4: there is no column 4: the file has 3 columns");
  EXPECT_EQ(refusal({"p", "3"}),
            "loop.csv: 'p' (column 3) is chosen twice as a covariate: choose it once");
  EXPECT_EQ(refusal({"F"}),
            "loop.csv: 'F [N]' (column 2) is the force already: choose another column for the "
            "covariate");
}

TEST(DisplacementPath, KeepsEveryRowInOrderAndEveryDigit) {
  EXPECT_EQ(ReadPath("displacement\n0.1\n0.1\n-0.30000000000000004\n0\n"),
            (Numbers{0.1, 0.1, -0.30000000000000004, 0}));
}

TEST(DisplacementPath, ReadsFileWithoutHeader) {
  EXPECT_EQ(ReadPath("1e-6\n-1e-6"), (Numbers{1e-6, -1e-6}));
}

TEST(DisplacementPath, TakesTheColumnOfARecognisedNameElseTheFirst) {
  EXPECT_EQ(ReadPath("command,displacement,remark\n0.5,1,go\n0.25,2,\n"), (Numbers{1, 2}));
  EXPECT_EQ(ReadPath("force [N],x [m]\n1,2\n"), (Numbers{2}));
  EXPECT_EQ(ReadPath("command,remark\n0.5,go\n0.25,\n"), (Numbers{0.5, 0.25}));
}

TEST(DisplacementPath, ConvertsUnitOfHeader) {
  EXPECT_EQ(ReadPath("x [um]\n3\n-7\n"), (Numbers{3e-6, -7e-6}));
}

TEST(DisplacementPath, ConvertsChosenColumnAndUnit) {
  EXPECT_EQ(ReadPath("a,b\n1,3\n2,-7\n", "b [mm]"), (Numbers{3e-3, -7e-3}));
}

TEST(DisplacementPath, RefusesFirstColumnThatIsNoLength) {
  EXPECT_THROW(ReadPath("force [N],remark\n1,2\n"), InputError);
}

TEST(DisplacementPath, PassesOverATimeToADisplacementOfARecognisedName) {
  EXPECT_EQ(ReadPath("time [s],displacement [mm],force [N]\n1,2,3\n2,4,5\n"),
            (Numbers{2e-3, 4e-3}));
}

TEST(LoadedPath, HasLoadAndDisplacementInTheirUnits) {
  const TemporaryDirectory directory;
  const LoadedPath path =
      ReadLoadedPath(directory.Write("loop.csv", "x [um],normal [kN]\n1,2\n3,4\n"), {}, "normal");
  EXPECT_EQ(path.displacement, (Numbers{1e-6, 3e-6}));
  EXPECT_EQ(path.normal_load, (Numbers{2e3, 4e3}));
}

// --- Measured records, read in place -------------------------------------------------------------

class MeasuredRecord : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const directory = std::getenv("MINDAHL_MEASURED_DIR");
    directory_ = directory != nullptr ? directory : MINDAHL_SOURCE_DIR "/../shared/measured";
    if (!std::filesystem::is_directory(directory_)) {
      GTEST_SKIP() << "no measured records in " << directory_ << ": set MINDAHL_MEASURED_DIR";
    }
  }
  std::filesystem::path directory_;
};

TEST_F(MeasuredRecord, TribometerIsReadByItsHeader) {
  const RecordFile file = ReadRecord(directory_ / "tribometer/test_data_2.txt");
  ASSERT_EQ(file.record.size(), 42579u);
  EXPECT_EQ(file.record.displacement.front(), -110.0355 / 1e3);
  EXPECT_EQ(file.record.force.front(), 242.2 / 1e6);
  EXPECT_EQ(file.record.time.back(), 213.784);
  EXPECT_EQ(file.record.normal_load.back(), 6432.7 / 1e6);
  EXPECT_EQ(file.notes, Strings{});
}

TEST_F(MeasuredRecord, SealIsReadByColumnNumbers) {
  const RecordFile file = ReadRecord(directory_ / "seals/O-ring257_3bar.csv",
                                     Choose({"5", "mm"}, {"7", "N"}, {"1", "ms"}));
  ASSERT_EQ(file.record.size(), 6340u);
  EXPECT_EQ(file.record.displacement[1], 1.724 / 1e3);
  EXPECT_EQ(file.record.force.front(), 154.659);
  EXPECT_EQ(file.record.time.back(), 65697.0 / 1e3);
}

TEST_F(MeasuredRecord, CycloidalGearboxIsReadByItsHeader) {
  const RecordFile file =
      ReadRecord(directory_ / "cycloidal/2024-07-12__16-46-43__torqueramp__conic_4pre1.csv");
  ASSERT_EQ(file.record.size(), 36033u);
  EXPECT_EQ(file.record.displacement.front(), 0.0178680419921875);
  EXPECT_EQ(file.record.force.back(), 0.3937549889087677);
  EXPECT_EQ(file.record.time.back(), 80.5);
}

TEST_F(MeasuredRecord, BandBrakeIsReadByItsHeader) {
  const RecordFile file = ReadRecord(directory_ / "band_brake/dataset-1_0.5Hz70lbtension.csv");
  ASSERT_EQ(file.record.size(), 18433u);
  EXPECT_EQ(file.record.displacement.front(), -0.00195971641);
  EXPECT_EQ(file.record.force.back(), -810.21973);
  EXPECT_EQ(file.record.time[1], 0.0009765625);
  EXPECT_EQ(file.notes, Strings{});
}

}  // namespace
}  // namespace mindahl::io::record_reader_test
