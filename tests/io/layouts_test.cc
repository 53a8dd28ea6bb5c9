#include <filesystem>

#include "mindahl/io/record_reader.h"
#include "support/prelude.h"
#include "temporary_directory.h"

// Files as instruments and programs write them, each with a row or two that were written by hand.
namespace mindahl::io::layouts_test {
namespace {

using Numbers = std::vector<double>;

struct Layout {
  std::string name;
  std::string text;
  std::size_t displacement;  // number of the column
  std::size_t force;
  Numbers first;                      // row of the record: displacement [m], force [N]
  std::optional<double> last_time{};  // [s]
  bool is_torsional = false;
};

class LayoutTest : public ::testing::TestWithParam<Layout> {};

TEST_P(LayoutTest, IsReadWithoutAnOption) {
  const Layout& layout = GetParam();
  const TemporaryDirectory directory;
  const RecordFile file = ReadRecord(directory.Write("record.txt", layout.text));
  EXPECT_EQ(file.displacement.index, layout.displacement);
  EXPECT_EQ(file.force.index, layout.force);
  EXPECT_DOUBLE_EQ(file.record.displacement.front(), layout.first[0]);
  EXPECT_DOUBLE_EQ(file.record.force.front(), layout.first[1]);
  EXPECT_EQ(file.is_torsional, layout.is_torsional);
  EXPECT_EQ(file.time.has_value() || !file.record.time.empty(), layout.last_time.has_value());
  if (layout.last_time && !file.record.time.empty()) {
    EXPECT_NEAR(file.record.time.back(), *layout.last_time, 1e-9);
  }
}

const std::string kLabView =
    "LabVIEW Measurement\t\nDecimal_Separator\t,\nX_Columns\tOne\nTime\t10:11:12,5\n"
    "***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t3\t3\t\nY_Unit_"
    "Label\tMillimeters\tNewtons\t\n"
    "X0\t0,0\t0,0\t\nDelta_X\t0,01\t0,01\t\n***End_of_Header***\t\t\t\n";

INSTANTIATE_TEST_SUITE_P(
    , LayoutTest,
    ::testing::Values(
        Layout{"LabViewWithUnitsAndACommentThatRowsLack",
               kLabView + "X_Value\tDisplacement\tForce\tComment\n0,00\t1,5\t2,5\n0,01\t2,5\t3,5\n",
               2,
               3,
               {1.5e-3, 2.5},
               0.01},
        Layout{"LabViewWithoutTimes",
               kLabView + "X_Value\tDisplacement\tForce\tComment\n\t1,5\t2,5\n\t2,5\t3,5\n",
               2,
               3,
               {1.5e-3, 2.5},
               0.01},
        Layout{
            "BlocksThatRepeatTheirHeader",
            "MTS793|MPT|ENU\n\nCyclic Acquisition\t\t\tTime:\t1,5\tSec\nTime\tAxial Fuerza\tAxial "
            "Desplazamiento\nSec\tkgf\tmm\n0,5\t1\t2,5\n1\t2\t3\n\nCyclic "
            "Acquisition\t\t\tTime:\t9,5"
            "\tSec\nTime\tAxial Fuerza\tAxial Desplazamiento\nSec\tkgf\tmm\n7,5\t1\t2,5\n8\t2\t3\n",
            3,
            2,
            {2.5e-3, 9.80665},
            8.0},
        Layout{"CatmanWithADescriptionAbove",
               "catmanEasy 5.3.1\nDatum:\t12.03.2024 10:11:12\n\nZeit  1 - "
               "Standardmessrate\tMX840A CH 1 "
               "Weg\tMX840A CH 2 Kraft\ns\tmm\tkN\n0,0\t1,5\t2,5\n0,1\t2,5\t3,5\n",
               2,
               3,
               {1.5e-3, 2500},
               0.1},
        Layout{"DewesoftWithPathsOfChannels",
               "Time (s),AI 1/Displacement (mm),AI 2/Force (N)\n0,1.5,2.5\n0.1,2.5,3.5\n",
               2,
               3,
               {1.5e-3, 2.5},
               0.1},
        Layout{"TestXpertWithQuotesAndCompounds",
               "\"Pr\xC3\xBC"
               "fzeit\";\"Standardweg\";\"Standardkraft\"\n\"s\";\"mm\";\"N\"\n0,0;1,5;2,5\n"
               "0,1;2,5;3,5\n",
               2,
               3,
               {1.5e-3, 2.5},
               0.1},
        Layout{"BluehillWithResultsAbove",
               "\"Results Table 1\"\n\"Maximum Load "
               "(N)\",\"10.08\"\n\n\"Time\",\"Extension\",\"Load\"\n"
               "\"(s)\",\"(mm)\",\"(N)\"\n\"0\",\"1.5\",\"2.5\"\n\"0.1\",\"2.5\",\"3.5\"\n",
               2,
               3,
               {1.5e-3, 2.5},
               0.1},
        Layout{"PlotJugglerWithAJointThatRests",
               "__time,/js/j1/position,/js/j1/effort,/js/j2/position,/js/j2/effort\n"
               "1709633472.5,0,2.5,7,0\n1709633473,1,3,7,0\n1709633473.5,-1,-3,7,0\n"
               "1709633474,1,3,7,0\n",
               2,
               3,
               {0, 2.5},
               1.5},
        Layout{"RosTextWithStampsInNanosecondsAndNames",
               "%time,field.header.seq,field.header.frame_id,field.name0,field.position0,field."
               "effort0\n"
               "1709633472000000000,1,,joint1,1.5,2.5\n1709633473000000000,2,,joint1,2.5,3.5\n",
               5,
               6,
               {1.5, 2.5},
               1.0},
        Layout{"AbaqusReport",
               "\n             X                U:U1            RF:RF1     \n\n   0.              "
               "0.    "
               "   2.5\n  10.E-03       2.E-03      3.5\n  20.E-03      -2.E-03     -3.5\n"
               "  30.E-03       2.E-03      3.5\n",
               2,
               3,
               {0, 2.5}},
        Layout{"TestSuiteWithACounter",
               "\"MTS TestSuite\",\"5.9\"\n\n\"Time\",\"Axial Count\",\"Axial Force\",\"Axial "
               "Displacement\"\n\"sec\",\"cycles\",\"kN\",\"mm\"\n0,1,2.5,1.5\n0.1,1,3.5,2.5\n",
               4,
               3,
               {1.5e-3, 2500},
               0.1},
        Layout{"Chinese",
               "序号,时间（s）,位移（mm）,力（kN）\n1,0,1.5,2.5\n2,0.1,2.5,3.5\n",
               3,
               4,
               {1.5e-3, 2500},
               0.1},
        Layout{"Japanese",
               "時間[s],荷重[N],変位[μm]\n0,2.5,1.5\n0.1,3.5,2.5\n",
               3,
               2,
               {1.5e-6, 2.5},
               0.1},
        Layout{"GermanWithUnitsBehindIn",
               "Pr\xC3\xBC"
               "fer: M\nZeit in s;Weg in mm;Kraft in N\n0,0;1,5;2,5\n0,1;2,5;3,5\n",
               2,
               3,
               {1.5e-3, 2.5},
               0.1},
        Layout{"French",
               "Temps (s);Déplacement (mm);Effort normal (daN);Effort tangentiel (daN)\n"
               "0;1,5;5;2,5\n0,1;2,5;5;3,5\n",
               2,
               4,
               {1.5e-3, 25},
               0.1},
        Layout{"Spanish",
               "Tiempo [s],Desplazamiento [mm],Fuerza [N]\n0,1.5,2.5\n1,2,3\n",
               2,
               3,
               {1.5e-3, 2.5},
               1.0},
        Layout{"Portuguese",
               "Tempo;Deslocamento;Força\ns;mm;N\n0;1,5;2,5\n1;2;3\n",
               2,
               3,
               {1.5e-3, 2.5},
               1.0},
        Layout{"Italian", "Spostamento [mm];Forza [N]\n1,5;2,5\n2;3\n", 1, 2, {1.5e-3, 2.5}},
        Layout{"RobotWithAngleAndTorque",
               "timestamp,q,dq,tau\n0,1.5,0,2.5\n1,2,0,3\n",
               2,
               4,
               {1.5, 2.5},
               1.0,
               true},
        Layout{"SwitchWithStepsAndGrams",
               "Millis,Steps,Travel (mm),Scale raw,Scale "
               "(grams)\n0,0,1.5,1007,1000\n10,5,2,1008,1001\n",
               3,
               5,
               {1.5e-3, 9.80665},
               0.01},
        Layout{"ForceBeforeDisplacementByUnit",
               "Fh [kN],u [mm]\n2.5,1.5\n3,2\n",
               2,
               1,
               {1.5e-3, 2500}},
        Layout{"LabelsOfRows",
               "step_name,u [mm],Fh [kN]\nLS_0,1.5,2.5\nLS_1,2,3\n",
               2,
               3,
               {1.5e-3, 2500}},
        Layout{"CounterBeforeLoadAndDisplacement",
               "Machine_N_cycles,Machine_Load,Machine_Displacement\n1,2.5,1.5\n1,3,2\n2,2,1\n",
               3,
               2,
               {1.5, 2.5}},
        Layout{"BracketsWithoutAUnit",
               "t,pos (3),Load [23.8 N]\n0,1.5,2.5\n1,2,3\n",
               2,
               3,
               {1.5, 2.5},
               1.0},
        Layout{"SetpointsNextToValues",
               "Position Setpoint,Position Actual,Force Setpoint,Force "
               "Actual\nmm,mm,N,N\n9,1.5,9,2.5\n"
               "9,2,9,3\n",
               2,
               4,
               {1.5e-3, 2.5}},
        Layout{"StrengthOfOneForceAmongMany",
               "time_s,displacement_m,act1_force_lb,force_N\n0,1.5,7,2.5\n1,2,8,3\n",
               2,
               4,
               {1.5, 2.5},
               1.0},
        Layout{"DatesOfIso",
               "Date,Displacement [mm],Force "
               "[N]\n2024-03-05T23:59:59.5Z,1.5,2.5\n2024-03-06T00:00:01Z,2,3\n",
               2,
               3,
               {1.5e-3, 2.5},
               86401.0},
        Layout{"TimesOfDayPastMidnight",
               "Datum;Uhrzeit;Weg [mm];Kraft "
               "[N]\n05.03.2024;23:59:59,5;1,5;2,5\n06.03.2024;00:00:01;2;3\n",
               3,
               4,
               {1.5e-3, 2.5},
               86401.0},
        Layout{"StampsInMilliseconds",
               "timestamp_ms,disp_um,load_N\n1709633472000,1.5,2.5\n1709633473000,2,3\n",
               2,
               3,
               {1.5e-6, 2.5},
               1.0},
        Layout{"HoursMicronsAndDynes",
               "elapsed [h],disp_micron,load [dyn]\n0,1.5,2.5\n0.5,2,3\n",
               2,
               3,
               {1.5e-6, 2.5e-5},
               1800.0},
        Layout{"ExcelThatStatesItsDelimiter",
               "sep=;\nZeit [ms];Verschiebung [µm];Kraft [mN]\n0;1,5;2,5\n10;2;3\n",
               2,
               3,
               {1.5e-6, 2.5e-3},
               0.01},
        Layout{"HeaderBehindAMarkOfAComment",
               "# time [s] displacement [mm] force [N]\n0 1.5 2.5\n1 2 3\n",
               2,
               3,
               {1.5e-3, 2.5},
               1.0},
        Layout{"TimeWithoutAHeader", "0,1,5\n1,-1,-5\n2,1,5\n3,-1,-5\n", 2, 3, {1, 5}}),
    [](const auto& test) { return test.param.name; });

std::string Refusal(const std::string& text, const RecordColumns& columns = {}) {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.Write("record.txt", text);
  return MessageOf<InputError>([&] { ReadRecord(path, columns); });
}

TEST(Evidence, OfACounterUnderTheNameOfALoadIsRefusedWithTheColumns) {
  EXPECT_THAT(
      Refusal("x [mm],Load\n0,1\n1,2\n-1,3\n1,4\n"),
      HasSubstr("record.txt:2:2: 'Load' (column 2) only grows while 'x [mm]' (column 1) goes to "
                "and fro, as a clock or a counter does: choose the force with --force, by name "
                "or number: the columns are 'x [mm]' (1), 'Load' (2)"));
}

TEST(Evidence, OfARegisterWithASignBitIsRefused) {
  EXPECT_THAT(
      Refusal("Position [mm],Present Load\n0,3\n1,121\n-1,1025\n1,1100\n2,7\n"),
      HasSubstr("'Present Load' (column 2) holds no value between 121 and 1023, as a register "
                "whose bit 1024 is the sign of the force"));
}

TEST(Evidence, OfTwoColumnsThatMoveIsRefusedWithBoth) {
  EXPECT_THAT(
      Refusal("pos1,pos2,F\n0,0,1\n1,2,2\n-1,-2,-1\n1,2,1\n"),
      HasSubstr("'pos1' (column 1) and 'pos2' (column 2) may each be the displacement: give "
                "--displacement 1 or --displacement 2"));
}

TEST(Evidence, DoesNotOverruleWhoNamesAColumn) {
  const TemporaryDirectory directory;
  const auto path = directory.Write("record.txt", "x [mm],Load\n0,1\n1,2\n-1,3\n1,4\n");
  RecordColumns columns;
  columns.force = "Load";
  EXPECT_EQ(ReadRecord(path, columns).force.index, 2U);
}

TEST(Blocks, OfOtherColumnsAreRefusedWithTheirLine) {
  EXPECT_THAT(Refusal("t,x,F\ns,mm,N\n0,1,2\n1,2,3\nt,F,x\ns,N,mm\n2,3,2\n3,4,5\n"),
              HasSubstr("record.txt:5:1: 't' is not a number"));
}

TEST(Thousands, AreNotGuessed) {
  EXPECT_THAT(Refusal("x,F\n1,1,234\n2,1,235\n"),
              HasSubstr("leave out commas that separate thousands"));
  EXPECT_THAT(Refusal("x,F\n1,\"1,234\"\n2,7\n3,8\n"),
              HasSubstr("record.txt:2:2: '1,234' is not a number"));
}

TEST(Workbook, IsRefusedWithAWayToExportIt) {
  EXPECT_THAT(Refusal("PK\x03\x04workbook"), HasSubstr("save its sheet as CSV"));
}

TEST(MissingCells, AreLeftOutUpToOneInAHundred) {
  std::string text = "x,F,other\n";
  for (int row = 0; row < 200; ++row) {
    text += row == 7 ? "NaN,1," : std::to_string(row % 10) + "," + std::to_string(row % 7) + ",";
    text += row % 2 == 0 ? "\n" : "5\n";
  }
  const TemporaryDirectory directory;
  const RecordFile file = ReadRecord(directory.Write("record.txt", text));
  EXPECT_EQ(file.left_out.count, 1U);
  EXPECT_EQ(file.left_out.first_line, 9U);
  EXPECT_EQ(file.record.size(), 199U);
  EXPECT_THAT(Refusal("x,F\n0,1\n,2\n1,3\n"), HasSubstr("record.txt:3:1: '' is not a number"));
  RecordColumns skipping;
  skipping.skip_broken_rows = true;
  const auto path = directory.Write("few.txt", "x,F\n0,1\n,2\n1,3\n");
  EXPECT_EQ(ReadRecord(path, skipping).record.size(), 2U);
}

// --- Columns as an expression -------------------------------------------------------------------

RecordFile ReadColumns(const std::string& text, const std::string& displacement,
                       const std::string& force) {
  const TemporaryDirectory directory;
  return ReadRecord(directory.Write("record.txt", text),
                    {.displacement = displacement, .force = force, .time = "", .normal_load = ""});
}

TEST(Expression, AddsScalesAndShiftsColumns) {
  const std::string text =
      "lvdt1 [mm],lvdt2 [mm],cell1 [N],cell2 [kN],raw\n1,3,10,2,100\n2,5,20,3,200\n";
  EXPECT_EQ(ReadColumns(text, "lvdt2-lvdt1", "cell1").record.displacement, (Numbers{2e-3, 3e-3}));
  EXPECT_EQ(ReadColumns(text, "#2-#1", "3").record.displacement, (Numbers{2e-3, 3e-3}));
  EXPECT_EQ(ReadColumns(text, "1", "cell1+cell2").record.force, (Numbers{2010, 3020}))
      << "each in its own unit";
  EXPECT_EQ(ReadColumns(text, "1", "raw*0.5-10 [mN]").record.force, (Numbers{0.04, 0.09}));
  EXPECT_EQ(ReadColumns(text, "1", "-2*raw/4").record.force, (Numbers{-50, -100}));
  EXPECT_EQ(ReadColumns(text, "1", "-raw").record.force, (Numbers{-100, -200}));
  EXPECT_EQ(ReadColumns(text, "1", "raw [kN]").record.force, (Numbers{1e5, 2e5}));
  const RecordFile file = ReadColumns(text, "1 [um]", "cell1 - cell2");
  EXPECT_EQ(file.record.displacement, (Numbers{1e-6, 2e-6}));
  EXPECT_EQ(file.force.name, "cell1 - cell2");
  EXPECT_EQ(file.force.index, 3U);
  EXPECT_EQ(file.force.unit, "N");
}

TEST(Expression, IsANameFirst) {
  EXPECT_EQ(ReadColumns("x [m],a-b\n1,2\n2,3\n", "x", "a-b").record.force, (Numbers{2, 3}));
  EXPECT_EQ(ReadColumns("x [m],a-b,c\n1,2,5\n2,3,5\n", "x", "a-b+c").record.force, (Numbers{7, 8}));
}

TEST(Expression, RefusesWhatItCannotBe) {
  const std::string text = "x,F,G\n1,2,3\n2,3,4\n";
  const auto refusal = [&](const std::string& force) {
    return Refusal(text, {.displacement = "x", .force = force, .time = "", .normal_load = ""});
  };
  EXPECT_THAT(refusal("F*"), HasSubstr("--force F*: is incomplete"));
  EXPECT_THAT(refusal("F*G"), HasSubstr("multiplies columns"));
  EXPECT_THAT(refusal("2-3"), HasSubstr("or #3 for the third column"));
  EXPECT_THAT(refusal("F+H"), HasSubstr("no column is called 'H'"));
  EXPECT_THAT(refusal("9"), HasSubstr("there is no column 9"));
  EXPECT_THAT(refusal("F*0"), HasSubstr("a factor that is 0"));
}

TEST(SampleRate, StandsInForATime) {
  const TemporaryDirectory directory;
  RecordColumns columns;
  columns.sample_rate = 100.0;
  EXPECT_EQ(ReadRecord(directory.Write("record.txt", "x,F\n1,2\n2,3\n"), columns).record.time,
            (Numbers{0.0, 0.01}));
}

TEST(WithAnotherFile, JoinsColumnsRowByRowOrByTime) {
  const TemporaryDirectory directory;
  RecordColumns columns;
  columns.with = directory.Write("force.txt", "F [N]\n10\n20\n").string();
  EXPECT_EQ(ReadRecord(directory.Write("a.txt", "x [mm]\n1\n2\n"), columns).record.force,
            (Numbers{10, 20}));
  columns.with = directory.Write("timed.txt", "t [ms],F [N]\n0,10\n2000,30\n").string();
  const auto path = directory.Write("b.txt", "t [s],x [mm]\n0,1\n1,2\n2,3\n");
  EXPECT_EQ(ReadRecord(path, columns).record.force, (Numbers{10, 20, 30}));
}

}  // namespace
}  // namespace mindahl::io::layouts_test
