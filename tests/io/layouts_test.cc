#include <fmt/format.h>

#include "reading.h"

// Files as instruments and programs write them, each with a row or two that were written by hand.
namespace mindahl::io::layouts_test {
namespace {

// A name, the columns of displacement and force, their first values [m], [N] or [rad], [N m], and
// the last time [s]; then the text.
const std::string kLayouts = R"layouts(
LabViewWithUnitsAndACommentThatRowsLack 2 3 1.5e-3 2.5 0.01 | LabVIEW Measurement→¶
  Decimal_Separator→,¶X_Columns→One¶Time→10:11:12,5¶***End_of_Header***→¶→¶Channels→2→→¶
  Samples→3→3→¶Y_Unit_Label→Millimeters→Newtons→¶X0→0,0→0,0→¶Delta_X→0,01→0,01→¶
  ***End_of_Header***→→→¶X_Value→Displacement→Force→Comment¶0,00→1,5→2,5¶0,01→2,5→3,5¶
LabViewWithoutTimes 2 3 1.5e-3 2.5 0.01 | X_Columns→No¶***End_of_Header***→¶Samples→3→3→¶
  Delta_X→0,01→0,01→¶***End_of_Header***→→→¶X_Value→Displacement [mm]→Force→Comment¶→1,5→2,5¶
  →2,5→3,5¶
BlocksThatRepeatTheirHeader 3 2 2.5e-3 9.80665 8.0 | MTS793|MPT|ENU¶¶
  Cyclic Acquisition→→→Time:→1,5→Sec¶Time→Axial Fuerza→Axial Desplazamiento¶Sec→kgf→mm¶0,5→1→2,5¶
  1→2→3¶¶Cyclic Acquisition→→→Time:→9,5→Sec¶Time→Axial Fuerza→Axial Desplazamiento¶Sec→kgf→mm¶
  7,5→1→2,5¶8→2→3¶
CatmanWithADescriptionAbove 2 3 1.5e-3 2500 0.1 | catmanEasy 5.3.1¶Datum:→12.03.2024 10:11:12¶¶
  Zeit  1 - Standardmessrate→MX840A CH 1 Weg→MX840A CH 2 Kraft¶s→mm→kN¶0,0→1,5→2,5¶0,1→2,5→3,5¶
DewesoftWithPathsOfChannels 2 3 1.5e-3 2.5 0.1 | Time (s),AI 1/Displacement (mm),AI 2/Force (N)¶
  0,1.5,2.5¶0.1,2.5,3.5¶
TestXpertWithQuotesAndCompounds 2 3 1.5e-3 2.5 0.1 | "Prüfzeit";"Standardweg";"Standardkraft"¶
  "s";"mm";"N"¶0,0;1,5;2,5¶0,1;2,5;3,5¶
BluehillWithResultsAbove 2 3 1.5e-3 2.5 0.1 | "Results Table 1"¶"Maximum Load (N)","10.08"¶¶
  "Time","Extension","Load"¶"(s)","(mm)","(N)"¶"0","1.5","2.5"¶"0.1","2.5","3.5"¶
PlotJugglerWithAJointThatRests 2 3 0 2.5 1.5 | 
  __time,/js/j1/position,/js/j1/effort,/js/j2/position,/js/j2/effort¶1709633472.5,0,2.5,7,0¶
  1709633473,1,3,7,0¶1709633473.5,-1,-3,7,0¶1709633474,1,3,7,0¶
RosTextWithStampsInNanosecondsAndNames 5 6 1.5 2.5 1.0 | 
  %time,field.header.seq,field.header.frame_id,field.name0,field.position0,field.effort0¶
  1709633472000000000,1,,joint1,1.5,2.5¶1709633473000000000,2,,joint1,2.5,3.5¶
RosTextWithStampsInTwoColumns 3 4 1.5 2.5 1.25 | 
  header.stamp.sec,header.stamp.nanosec,position,effort¶1709633472,0,1.5,2.5¶
  1709633473,250000000,2.5,3.5¶
UnitsInColumnsOfTheirOwn 3 5 1.5e-3 2.5 0.1 | Zeit;s;Disp;mm;Force;N¶0,0;s;1,5;mm;2,5;N¶
  0,1;s;2,5;mm;3,5;N¶
AbaqusReport 2 3 0 2.5 - | ¶             X                U:U1            RF:RF1     ¶¶
     0.              0.       2.5¶  10.E-03       2.E-03      3.5¶  20.E-03      -2.E-03     -3.5¶
    30.E-03       2.E-03      3.5¶
TestSuiteWithACounter 4 3 1.5e-3 2500 0.1 | "MTS TestSuite","5.9"¶¶
  "Time","Axial Count","Axial Force","Axial Displacement"¶"sec","cycles","kN","mm"¶0,1,2.5,1.5¶
  0.1,1,3.5,2.5¶
Chinese 3 4 1.5e-3 2500 0.1 | 序号,时间（s）,位移（mm）,力（kN）¶1,0,1.5,2.5¶2,0.1,2.5,3.5¶
Japanese 3 2 1.5e-6 2.5 0.1 | 時間[s],荷重[N],変位[μm]¶0,2.5,1.5¶0.1,3.5,2.5¶
GermanWithUnitsBehindIn 2 3 1.5e-3 2.5 0.1 | Prüfer: M¶Zeit in s;Weg in mm;Kraft in N¶0,0;1,5;2,5¶
  0,1;2,5;3,5¶
French 2 4 1.5e-3 25 0.1 | Temps (s);Déplacement (mm);Effort normal (daN);Effort tangentiel (daN)¶
  0;1,5;5;2,5¶0,1;2,5;5;3,5¶
Spanish 2 3 1.5e-3 2.5 1.0 | Tiempo [s],Desplazamiento [mm],Fuerza [N]¶0,1.5,2.5¶1,2,3¶
Portuguese 2 3 1.5e-3 2.5 1.0 | Tempo;Deslocamento;Força¶s;mm;N¶0;1,5;2,5¶1;2;3¶
Italian 1 2 1.5e-3 2.5 - | Spostamento [mm];Forza [N]¶1,5;2,5¶2;3¶
RobotWithAngleAndTorque 2 4 1.5 2.5 1.0 torsional | timestamp,q,dq,tau¶0,1.5,0,2.5¶1,2,0,3¶
SwitchWithStepsAndGrams 3 5 1.5e-3 9.80665 0.01 | 
  Millis,Steps,Travel (mm),Scale raw,Scale (grams)¶0,0,1.5,1007,1000¶10,5,2,1008,1001¶
ForceBeforeDisplacementByUnit 2 1 1.5e-3 2500 - | Fh [kN],u [mm]¶2.5,1.5¶3,2¶
LabelsOfRows 2 3 1.5e-3 2500 - | step_name,u [mm],Fh [kN]¶LS_0,1.5,2.5¶LS_1,2,3¶
CounterBeforeLoadAndDisplacement 3 2 1.5 2.5 - | 
  Machine_N_cycles,Machine_Load,Machine_Displacement¶1,2.5,1.5¶1,3,2¶2,2,1¶
BracketsWithoutAUnit 2 3 1.5 2.5 1.0 | t,pos (3),Load [23.8 N]¶0,1.5,2.5¶1,2,3¶
SetpointsNextToValues 2 4 1.5e-3 2.5 - | 
  Position Setpoint,Position Actual,Force Setpoint,Force Actual¶mm,mm,N,N¶9,1.5,9,2.5¶9,2,9,3¶
StrengthOfOneForceAmongMany 2 4 1.5 2.5 1.0 | time_s,displacement_m,act1_force_lb,force_N¶
  0,1.5,7,2.5¶1,2,8,3¶
DatesOfIso 2 3 1.5e-3 2.5 1.5 | Date,Displacement [mm],Force [N]¶
  2024-03-05T23:59:59.5Z,1.5,2.5¶2024-03-06T00:00:01Z,2,3¶
TimesOfDay 3 4 1.5e-3 2.5 1.5 | Datum;Uhrzeit;Weg [mm];Kraft [N]¶
  05.03.2024;22:59:59,5;1,5;2,5¶05.03.2024;23:00:01;2;3¶
StampsInMilliseconds 2 3 1.5e-6 2.5 1.0 | timestamp_ms,disp_um,load_N¶1709633472000,1.5,2.5¶
  1709633473000,2,3¶
HoursMicronsAndDynes 2 3 1.5e-6 2.5e-5 1800.0 | elapsed [h],disp_micron,load [dyn]¶0,1.5,2.5¶
  0.5,2,3¶
ExcelThatStatesItsDelimiter 2 3 1.5e-6 2.5e-3 0.01 | sep=;¶Zeit [ms];Verschiebung [µm];Kraft [mN]¶
  0;1,5;2,5¶10;2;3¶
UnitsBelowAHeaderBehindAMark 2 3 1.5e-3 2500 1.0 | # time,displacement,force¶s,mm,kN¶0,1.5,2.5¶1,2,3¶
HeaderBehindAMarkOfAComment 2 3 1.5e-3 2.5 1.0 | # time [s] displacement [mm] force [N]¶0 1.5 2.5¶
  1 2 3¶
TimeWithoutAHeader 2 3 1 5 - | 0,1,5¶1,-1,-5¶2,1,5¶3,-1,-5¶
Shimadzu 3 2 1.5e-3 2.5 0.1 | "Test Date","2024/03/05"¶"Time","Force","Stroke"¶"sec","N","mm"¶
  "0","2.5","1.5"¶"0.1","3","2"¶
Tribometer 4 2 1.5e-3 2.5 0.1 | Time [s]→Fx [N]→Fz [N]→Y [mm]→COF¶0→2.5→-50→1.5→0.05¶
  0.1→3→-50→2→0.06¶
Comsol 2 3 1.5e-3 2.5 0.1 | % Model:    a.mph¶% Time (s)    u (mm)    Fx (N)¶0    1.5    2.5¶
  0.1    2    3¶
WaveMatrix 3 4 1.5e-3 2500 0.1 | 
  Total Time (s),Total Cycles,Position(Linear:Digital Position) (mm),Load(Linear:Load) (kN)¶
  0,0,1.5,2.5¶0.1,0,2,3¶
Diadem 3 4 1.5e-3 2.5 0.1 | Channel names:→Time→Weg→Kraft¶Units:→s→mm→N¶Data:¶→0,0→1,5→2,5¶
  →0,1→2→3¶
Adams 2 3 1.5e-3 2.5 0.1 | Time→MARKER_1.Translational_Displacement.X→JOINT_1.Element_Force.X¶
  (sec)→(mm)→(newton)¶0→1.5→2.5¶0.1→2→3¶
PolishByUnitsAlone 2 3 1.5e-3 2.5 0.1 | Czas [s];Przemieszczenie [mm];Siła [N]¶0,0;1,5;2,5¶
  0,1;2;3¶
ScaleOfAnHx711 2 3 1.5e-3 9.80665 0.01 | ms,dist_mm,weight_g¶0,1.5,1000¶10,2,1001¶
TwoForcesAndDepths 4 5 1.5e-6 2.5e-6 0.1 | 
  Depth (nm)→Load (µN)→Time (s)→Lateral Displacement (µm)→Lateral Force (µN)¶100→500→0→1.5→2.5¶
  101→500→0.1→2→3¶
AbaqusWithLabelsOfPoints 2 3 0 2.5 - | ¶   X    U:U1 PI: P N: 1    RF:RF1 PI: P N: 1¶¶  0.  0.  2.5¶
    1.  2.  3.5¶  2.  -2.  -3.5¶  3.  2.  3.5¶
RobotWithActualValues 2 3 1.5 2.5 1.0 torsional | t,actual_q_0,actual_tau_0,actual_current¶0,1.5,2.5,1¶
  1,2,3,2¶
WideLettersAndBrackets 2 3 1.5e-3 2.5 1.0 | 時間（ｓ）,変位【ｍｍ】,荷重［Ｎ］¶0,1.5,2.5¶1,2,3¶
ServoWithGoals 2 4 1.5 2.5 1.0 | t,Present Position,Goal Position,Present Load¶0,1.5,9,2.5¶1,2,9,3¶
TypesBelowTheUnits 2 3 1.5e-3 2500 1.0 | Time,Displacement,Force¶[s],[mm],[kN]¶ACTUAL,ACTUAL,ACTUAL¶
  0,1.5,2.5¶1,2,3¶
UnitsAboveTheNames 2 3 1.5e-3 2500 1.0 | s;mm;kN¶Time;Displacement;Force¶0;1,5;2,5¶1;2;3¶
UnitsAboveNamesThatAreNoneKnown 2 3 1.5e-3 2500 1.0 | s;mm;kN¶a;b;c¶0;1,5;2,5¶1;2;3¶
ComsolWithBlanksInItsHeader 1 2 1.5e-3 2.5 - | % Date: Mar 5 2024¶% u (mm)   F (N)¶1.5    2.5¶2    3¶
CrossheadBesideAnExtensometer 2 3 1.5e-3 2.5 - | 
  Crosshead (mm),Extensometer (mm),Load (N)¶9,1.5,2.5¶8,1,1¶9,1.5,2.5¶
CounterCalledN 2 3 1.5e-3 2.5 - | N,u [mm],Q [N]¶0,1.5,2.5¶1,2,3¶2,1.5,2.5¶
ClampForceAndShearLoad 1 3 1.5e-3 2500 - | Displacement (mm),Clamp force (kN),Shear load (kN)¶1.5,5,2.5¶
  2,5,3¶
ExcelWithQuotedDecimalCommas 2 3 1.5e-3 2.5 0.5 | "Zeit [s]","Weg [mm]","Kraft [N]"¶
  "0,0","1,5","2,5"¶"0,5","-2","3,5"¶
RussianByUnitsAlone 2 3 1.5e-3 2500 1.0 | Время, с;Перемещение, мм;Сила, кН¶0;1,5;2,5¶1;2;3¶
)layouts";

TEST(Layouts, AreReadWithoutAnOption) {
  const std::vector<Strings> layouts = RowsOf(kLayouts);
  EXPECT_EQ(layouts.size(), 58U);
  for (const Strings& layout : layouts) {
    SCOPED_TRACE(layout[0]);
    std::vector<std::string> head;
    for (const std::string_view word : PartsOf(layout[0], ' ')) head.emplace_back(word);
    const RecordFile file = Read(layout[1]);
    EXPECT_EQ(file.displacement.index, std::stoul(head[1]));
    EXPECT_EQ(file.force.index, std::stoul(head[2]));
    EXPECT_DOUBLE_EQ(file.record.displacement.front(), std::stod(head[3]));
    EXPECT_DOUBLE_EQ(file.record.force.front(), std::stod(head[4]));
    EXPECT_EQ(file.is_torsional, head.back() == "torsional");
    ASSERT_EQ(file.record.time.empty(), head[5] == "-");
    if (head[5] != "-") {
      EXPECT_NEAR(file.record.time.back(), std::stod(head[5]), 1e-9);
    }
  }
}

// Names of displacement and force, and their units.
const std::string kUnitsInNames = R"names(
Displacement_mm_,Force_kN_ | mm | kN
Displacement..mm.,Force..N. | mm | N
Displacement__um_,F_N_ | um | N
disp.mm,force=kN | mm | kN
disp_mm1,force_kN_1 | mm | kN
pos_mm_filtered,CH1_force_mN_avg | mm | mN
disp-mm,force:kN | mm | kN
disp <mm>,force {kN} | mm | kN
Displacement@mm,Force|kN | mm | kN
angle.deg,Torque_N_m_ | deg | N m
Angle (deg),torque N.mm | deg | N mm
Winkel [rad],M_d [kgf.cm] | rad | kgf cm
Displacement (in mm),Force (unit: kN) | mm | kN
Weg in Mikrometer,Усилие: кгс | um | kgf
変位(㎜),荷重(牛顿) | mm | N
LVDT (mils),Load (pound) | mil | lbf
Temperature deg C [um],Force raw N | um | N
)names";

TEST(Units, AreFoundInANameAndAssumedWithAMark) {
  for (const Strings& row : RowsOf(kUnitsInNames)) {
    SCOPED_TRACE(row[0]);
    const RecordFile file = Read(row[0] + "\n1,2\n2,3\n1,2\n");
    EXPECT_EQ(file.displacement.unit, row[1]);
    EXPECT_EQ(file.force.unit, row[2]);
    EXPECT_FALSE(file.displacement.has_no_unit || file.force.has_no_unit);
  }
  for (const char* names : {"Dispm,Force", "posMm,ForceN", "x_in,F"}) {
    EXPECT_TRUE(Read(names + std::string("\n1,2\n2,3\n1,2\n"), Choose("1", "2")).force.has_no_unit);
  }
}

// Names, the one that is refused, and its unit that is none.
const std::string kNoUnits = R"names(
displacement ×10⁻³ (mm),F [N] | 1 | mm ×10⁻³
displacement x1000 (mm),F [N] | 1 | mm x1000
Displacement [mm] x1000,F [N] | 1 | mm x1000
Displacement [mm] (x 0.001),F [N] | 1 | mm x 0.001
Displacement E-3 [mm],F [N] | 1 | mm e-3
x [mm],Force*10 | 2 | *10
Displacement (0.01 mm),F [N] | 1 | 0.01 mm
LVDT (5 mm),F [N] | 1 | 5 mm
x [mm],Force cell 5 kN | 2 | 5 kN
x [mm],Force (% FS) | 2 | % FS
x [&micro;m],F [N] | 1 | &micro;m
x [?m],F [N] | 1 | ?m
)names";

TEST(Units, ThatAreNoneAreRefusedWithARemedy) {
  for (const Strings& row : RowsOf(kNoUnits)) {
    SCOPED_TRACE(row[0]);
    const std::string said = Refusal(row[0] + "\n1,2\n2,3\n1,2\n");
    EXPECT_THAT(said, StartsWith("loop.csv:1:" + row[1] + ": the unit '" + row[2] + "' of '"));
    EXPECT_THAT(said, HasSubstr("or with a factor '#" + row[1] + "*0.001 ["));
  }
  for (const char* names :
       {"x [mm],Force %", "angle [rad],torque_percent", "x [mm],Normalized force"}) {
    EXPECT_THAT(Refusal(names + std::string("\n1,2\n2,3\n1,2\n")),
                HasSubstr("before it is multiplied by"));
  }
  for (const char* names : {"AI 1/10 Force [N],x10 [mm]", "Force X 2 [N],x [mm] 2",
                            "Kraft/AVE [N],Laser/Weg [mm]", "Load [23.8 N],x [mm] 10 Hz"}) {
    EXPECT_EQ(Read(names + std::string("\n1,2\n2,3\n1,2\n")).force.unit, "N") << names;
  }
}

TEST(Units, OfVoltsAreSeenBehindAName) {
  for (const char* name : {"lc_V", "cell 2 V", "Force_mV"}) {
    EXPECT_THAT(Refusal("x [mm]," + std::string(name) + "\n1,2\n2,3\n1,2\n", Choose("1", "2")),
                HasSubstr("V, no force before it is multiplied by a gain"))
        << name;
  }
  EXPECT_TRUE(Read("x [mm],F_V\n1,2\n2,3\n1,2\n").force.has_no_unit);  // vertical
}

TEST(Layouts, WithQuotedThousandsHaveNoDecimalCommas) {
  EXPECT_THAT(Refusal("x [mm],F [N]\n\"1,234\",\"5\"\n\"2,345\",\"6\"\n"),
              HasSubstr("without separators of thousands"));
}

TEST(Load, IsLeftOutWhereNoneIsAskedFor) {
  const std::string text = "x [mm],F [N],Normal load [N]\n0,1,50\n1,3,51\n0,-1,52\n";
  EXPECT_EQ(Read(text).record.normal_load.size(), 3U);
  RecordColumns columns;
  columns.normal_load = "none";
  EXPECT_TRUE(Read(text, columns).record.normal_load.empty());
}

TEST(Load, ThatIsNegativeIsTakenAsItsMagnitudeHoweverItIsFound) {
  const char* text = "Normal force [N],F [N],x [mm]\n-50,1,1\n-51,2,2\n-50,1,1\n";
  for (const char* named : {"", "Normal force", "1 [N]"}) {
    RecordColumns columns;
    columns.normal_load = named;
    const RecordFile file = Read(text, columns);
    EXPECT_EQ(file.record.normal_load, (Numbers{50, 51, 50})) << named;
    EXPECT_THAT(file.notes.back(), HasSubstr("is negative throughout: its magnitude is taken"));
  }
  RecordColumns scaled;  // a factor says the sign
  scaled.normal_load = "#1*2 [N]";
  EXPECT_EQ(Read(text, scaled).record.normal_load, (Numbers{-100, -102, -100}));
}

TEST(Evidence, ThatIsMissingOrContradictsIsRefusedWithTheColumns) {
  EXPECT_THAT(
      Refusal("x [mm],Load\n0,1\n1,2\n-1,3\n1,4\n"),
      StartsWith("loop.csv:2:2: 'Load' (column 2) only grows while 'x [mm]' (column 1) goes "
                 "to and fro, as a clock or a counter does: choose the force with --force, "
                 "by name or number: the columns are 'x [mm]' (column 1), 'Load' (column 2)"));
  EXPECT_THAT(Refusal("Position [mm],Present Load\n0,3\n1,121\n-1,1025\n1,1100\n2,7\n"),
              HasSubstr("'Present Load' (column 2) holds no value between 121 and 1023, as a "
                        "register whose bit 1024 is the sign of the force"));
  EXPECT_EQ(Read("x [mm],Load\n0,1\n1,2\n-1,3\n1,4\n", Choose("", "Load")).force.index, 2U)
      << "whoever names a column is believed";
}

TEST(Evidence, OfACoefficientOfFrictionIsNoneOfAForce) {
  const std::string rows = ",Load [N]\n0,0.1,50\n1,0.3,50\n-1,-0.3,50\n1,0.3,50\n";
  for (const char* name : {"Coefficient of friction", "mu", "μ [-]", "COF", "Reibwert", "摩擦系数",
                           "Coeficiente de fricción", "Q/P", "Friction"}) {
    const std::string text = "x [mm]," + (name + rows);
    EXPECT_THAT(
        Refusal(text, Choose("1", "2")),
        AllOf(StartsWith(fmt::format("loop.csv:1:2: '{}' (column 2) is a ratio, no force", name)),
              HasSubstr("*LOAD [N]' with its number for LOAD")));
    EXPECT_EQ(Read(text, Choose("1", "#2*50 [N]")).record.force.front(), 5.0);
    EXPECT_EQ(Read(text, Choose("1", "2 [N]")).record.force.front(), 0.1);
    EXPECT_EQ(Refusal(text), Refusal(text, Choose("1", "2"))) << "a load is no friction force";
    EXPECT_EQ(Read(text, Choose("1", "3")).force.index, 3U) << "whoever names a column is believed";
  }
  for (const char* names :
       {"Load [N],Friction,x [mm]", "荷重(N),f,変位(mm)", "Last,Reibungszahl,Weg"}) {
    EXPECT_THAT(Refusal(names + std::string("\n50,0.1,0\n51,0.3,1\n50,-0.3,0\n")),
                HasSubstr("is a ratio, no force"))
        << names;
  }
  EXPECT_EQ(Read("t,x,F,mu\ns,mm,N,-\n0,1,2,0.1\n1,2,3,0.2\n").record.covariates.front().unit, "-");
  EXPECT_EQ(Read("x [mm],mu,Load [N]\n0,0.1,9\n1,0.3,-9\n0,0.1,9\n").force.index, 3U);
  EXPECT_THAT(Refusal("x [mm],mu\n0,0.1\n1,0.3\n"), HasSubstr("--force 'mu*LOAD [N]'"));
}

TEST(Evidence, OfALoadThatKeepsItsSignBesideAForceThatDoesNotIsOfANormalLoad) {
  for (const char* force : {"Fx [N]", "Ft [N]", "Q [N]", "Force [N]"}) {
    const std::string names = fmt::format("x [mm],{},Load [N]\n", force);
    const RecordFile pressed = Read(names + "0,1,50.1\n1,2,49.8\n-1,-3,50.2\n1,2,49.9\n");
    EXPECT_EQ(pressed.force.index, 2U) << force;
    EXPECT_EQ(pressed.normal_load.index, 3U) << force;
    const RecordFile pulled = Read(names + "0,1,5\n1,2,9\n-1,3,-7\n1,2,9\n");
    EXPECT_EQ(pulled.normal_load.index, 0U) << force;
  }
}

TEST(Layouts, ThatAreNoneAreRefusedWithARemedy) {
  EXPECT_THAT(Refusal("t,x,F\ns,mm,N\n0,1,2\n1,2,3\nt,F,x\ns,N,mm\n2,3,2\n3,4,5\n"),
              HasSubstr("loop.csv:5:1: 't' is not a number"));
  EXPECT_THAT(Refusal("\"\",Load,Extension\n1,10,7\nTime,Load,Extension\n0,2,1\n1,3,2\n"),
              HasSubstr("loop.csv:3:1: 'Time' is not a number"));
  EXPECT_THAT(Refusal("x,F\n1,1,234\n2,1,235\n"), HasSubstr("remove commas within numbers"));
  EXPECT_THAT(Refusal("x;F\n1;1,234.5\n2;1,300.5\n"),
              HasSubstr("loop.csv:2:2: '1,234.5' is not a number"));
  const std::string wave = "0,1,2\n1,2,3\n2,1,2\n3,2,3\n";
  EXPECT_THAT(Refusal("Source,CH1,CH2\nSecond,Volt,Volt\n" + wave),
              HasSubstr("no column for the displacement: the columns are"));
  EXPECT_THAT(Refusal("X,XYData-1,RF:RF1\n" + wave),
              HasSubstr("'X' (column 1) only grows while 'RF:RF1' (column 3) goes to and fro"));
  EXPECT_THAT(Refusal("t,ay [g],V [V]\n" + wave),
              HasSubstr("no column for the displacement: the columns are"));
  EXPECT_THAT(Refusal("PK\x03\x04workbook"), HasSubstr("save its sheet as CSV"));
}

TEST(Numbers, HaveNoDecimalCommaBetweenCommas) {
  EXPECT_THAT(Refusal("x [mm],F [N]\n1,2\n2,\"2,345\"\n"),
              HasSubstr("loop.csv:3:2: '2,345' is not a number: write one like -1.5e-3, without "
                        "separators of thousands"));
}

TEST(MissingCells, AreLeftOutUpToOneInAHundred) {
  std::string text = "x,F,other\n";
  for (int row = 0; row < 200; ++row) {
    text += row == 7 ? "NaN,1," : std::to_string(row % 10) + "," + std::to_string(row % 7) + ",";
    text += row % 2 == 0 ? "\n" : "5\n";
  }
  const RecordFile file = Read(text);
  EXPECT_EQ(file.left_out.count, 1U);
  EXPECT_THAT(file.notes.back(), AllOf(HasSubstr("1 row is left out"), HasSubstr("loop.csv:9:1")));
  EXPECT_EQ(file.record.size(), 199U);
  const std::string few = "x,F\n0,1\n,2\n1,3\n";
  EXPECT_THAT(Refusal(few), HasSubstr("loop.csv:3:1: '' is not a number"));
  EXPECT_EQ(Read(few, kSkipping).record.size(), 2U);
}

TEST(Expression, AddsScalesAndShiftsColumns) {
  const std::string text =
      "lvdt1 [mm],lvdt2 [mm],cell1 [N],cell2 [kN],raw\n1,3,10,2,100\n2,5,20,3,200\n";
  for (const char* columns : {"lvdt2-lvdt1", "#2-#1"}) {
    EXPECT_EQ(Read(text, Choose(columns, "cell1")).record.displacement, (Numbers{2e-3, 3e-3}));
  }
  for (const auto& [columns, force] : {std::pair("cell1+raw [kN]", Numbers{110e3, 220e3}),
                                       {"raw*0.5-10 [mN]", {0.04, 0.09}},
                                       {"-2*raw*0.25", {-50, -100}},
                                       {"-raw", {-100, -200}},
                                       {"raw [kN]", {1e5, 2e5}}}) {
    EXPECT_EQ(Read(text, Choose("1", columns)).record.force, force) << columns;
  }
  EXPECT_THAT(Refusal(text, Choose("1", "cell1+cell2")), HasSubstr("the unit 'N and kN' of"));
  const RecordFile file = Read(text, Choose("1 [um]", "cell1 - raw [N]"));
  EXPECT_EQ(file.record.displacement, (Numbers{1e-6, 2e-6}));
  EXPECT_EQ(file.force.name, "cell1 - raw [N]");
  EXPECT_EQ(file.force.index, 3U);
  EXPECT_EQ(file.force.unit, "N");
}

TEST(Expression, IsANameFirst) {
  EXPECT_EQ(Read("x [m],a-b\n1,2\n2,3\n", Choose("x", "a-b")).record.force, (Numbers{2, 3}));
  EXPECT_EQ(Read("x [m],a-b,c\n1,2,5\n2,3,5\n", Choose("x", "#2+c")).record.force, (Numbers{7, 8}));
}

TEST(Expression, RefusesWhatItCannotBe) {
  for (const auto& [force, said] : {std::pair("F*", "--force F*: must be a sum of columns"),
                                    {"F*G", "must be a sum of columns"},
                                    {"2-3", "with #3 for the third column"},
                                    {"#4-#3", "no column is called '#4'"},
                                    {"F+H", "no column is called 'H'"},
                                    {"F*0", "must be a sum of columns"},
                                    {"(F-2)/4", "no column is called '(F'"},
                                    {"(F-2)/4", "; a formula must be a sum of columns"},
                                    {"F-G", "--force 'F*GAIN [N]' with its number for GAIN"}}) {
    EXPECT_THAT(Refusal("x [V],F [V],G [V]\n1,2,3\n2,3,4\n", Choose("x [m]", force)),
                HasSubstr(said));
  }
}

TEST(SampleRate, StandsInForATime) {
  RecordColumns columns;
  columns.sample_rate = 100.0;
  EXPECT_EQ(Read("x,F\n1,2\n2,3\n", columns).record.time, (Numbers{0.0, 0.01}));
  columns.skip_broken_rows = true;
  EXPECT_EQ(Read("x,F\n1,2\n2,3,4\n3,4\n", columns).record.time, (Numbers{0.0, 0.02}))
      << "a row that is left out takes its time";
  columns.time = "x";
  EXPECT_THAT(Refusal("x,F\n1,2\n", columns), HasSubstr("and --time excludes it"));
}

TEST(WithAnotherFile, JoinsColumnsOfTheSameTimes) {
  const TemporaryDirectory directory;
  RecordColumns columns;
  columns.with = directory.Write("force.txt", "F [N]\n10\n20\n").string();
  EXPECT_EQ(Read("x [mm]\n1\n2\n", columns).record.force, (Numbers{10, 20}));
  const auto three = directory.Write("b.txt", "x [mm]\n0\n1\n2\n");
  EXPECT_THAT(MessageOf<InputError>([&] { ReadRecord(three, columns); }),
              HasSubstr("b.txt has 3 rows and"));
  columns.with = directory.Write("timed.txt", "t [s],F [N]\n0,10\n1,20\n").string();
  EXPECT_EQ(Read("t [s],x [mm]\n0,1\n1,2\n", columns).record.force, (Numbers{10, 20}));
  const auto later = directory.Write("c.txt", "t [s],x [mm]\n0.5,1\n1.5,2\n");
  EXPECT_THAT(MessageOf<InputError>([&] { ReadRecord(later, columns); }),
              HasSubstr("have different times"));
}

}  // namespace
}  // namespace mindahl::io::layouts_test
