#include "mindahl/io/record_reader.h"

#include "reading.h"
#include "support/measured.h"

namespace mindahl::io::record_reader_test {
namespace {

Strings Notes(const std::string& text, const RecordColumns& columns = {}) {
  const TemporaryDirectory directory;
  Strings notes = ReadRecord(directory.Write("loop.csv", text), columns).notes;
  for (std::string& note : notes) note = WithoutDirectory(note, directory);
  return notes;
}

// Names of columns, and the numbers of those of displacement, force, time and normal load.
const std::string kHeaders = R"headers(
displacement,force,time,normal load | 1 | 2 | 3 | 4
Time [s],Normal [uN],Position [mm],Friction [uN] | 3 | 4 | 1 | 2
time_s,displacement_m,force_N,velocity_m_s | 2 | 3 | 1 | 0
TIME,POSITION,TORQUE,CONTROL_TORQUE | 2 | 3 | 1 | 0
F (kN),x [um],a,b | 2 | 1 | 0 | 0
t,N,x,T | 3 | 4 | 1 | 2
t,x,F,T | 2 | 3 | 1 | 0
n,x,F,t | 2 | 3 | 4 | 0
F_N,F_t,delta,t | 3 | 2 | 4 | 1
x_mm,F_N,a,b | 1 | 2 | 0 | 0
F_N,F,x,t | 3 | 2 | 4 | 1
Time Stamp,normal-force,tangential_force,stroke | 4 | 3 | 1 | 2
friction force,force,disp_mm,x | 3 | 1 | 0 | 0
position,displacement,Q,c | 2 | 3 | 0 | 0
tangential displacement / mm,displacement / mm,Ft,fn | 1 | 3 | 0 | 4
δ,f,a,b | 1 | 2 | 0 | 0
Zeit,Weg,Kraft,Normalkraft | 2 | 3 | 1 | 4
Temps (s),Effort (N),Déplacement (mm),Charge normale (N) | 3 | 2 | 1 | 4
时间,位移(um),切向力(N),法向载荷(N) | 2 | 3 | 1 | 4
时间,位移(um),摩擦力(N),载荷(N) | 2 | 3 | 1 | 4
Tempo,Spostamento (um),Forza di attrito (N),Carico (N) | 2 | 3 | 1 | 4
Zeit,Auslenkung (um),Querkraft (N),Anpresskraft (N) | 2 | 3 | 1 | 4
時間,すべり量(um),摩擦力(N),垂直力(N) | 2 | 3 | 1 | 4
時間,変位(um),接線力(N),押付力(N) | 2 | 3 | 1 | 4
Tempo,Spostamento (um),Carico (N),a | 2 | 3 | 1 | 0
Time,Stroke,Friction force,Load cell | 2 | 3 | 1 | 0
)headers";

TEST(RecordReader, RecognizesEachQuantityByItsHeader) {
  for (const Strings& header : RowsOf(kHeaders)) {
    SCOPED_TRACE(header[0]);
    const RecordFile file = Read(header[0] + "\n1.5,2.5,3.5,4.5\n");
    EXPECT_EQ(file.displacement.index, std::stoul(header[1]));
    EXPECT_EQ(file.force.index, std::stoul(header[2]));
    EXPECT_EQ(file.time.index, std::stoul(header[3]));
    EXPECT_EQ(file.normal_load.index, std::stoul(header[4]));
    EXPECT_EQ(file.record.time.empty(), !file.time);
    EXPECT_EQ(file.record.normal_load.empty(), !file.normal_load);
  }
}

TEST(RecordReader, FindsChosenColumnByNumberNameCaseAndNameWithoutUnit) {
  const std::string text = "Pad [mm],pad,Cell [N],four\n1.5,2.5,3.5,4.5\n";
  for (const auto& [name, column] :
       {std::pair{"3", 3U}, {"pad", 2U}, {"PAD [MM]", 1U}, {"cell", 3U}}) {
    EXPECT_EQ(Read(text, Choose("4 [m]", std::string(name) + " [N]")).force.index, column) << name;
  }
  EXPECT_EQ(Read("f,F,x\n1.5,2.5,3.5\n", Choose("", "F")).force.index, 2u) << "the exact name";
  const RecordFile file = Read("1.5,2.5,3.5,4.5\n", Choose("", "", "4 [ms]", "3 [kN]"));
  EXPECT_EQ(file.record.time, (Numbers{4.5e-3}));
  EXPECT_EQ(file.record.normal_load, (Numbers{3500}));
  EXPECT_EQ(file.time.unit, "ms");
  EXPECT_EQ(file.normal_load.unit, "kN");
}

// Texts of a force of 2.5 kN, and the unit and the value [m] of the displacement.
const std::string kUnits = R"units(
x [mm],F (kN)¶1.5,2.5¶ | mm | 1.5e-3
x[um],F(kN)¶1.5,2.5¶ | um | 1.5e-6
x [µm],F [kN]¶1.5,2.5¶ | um | 1.5e-6
x [μm],F [kN]¶1.5,2.5¶ | um | 1.5e-6
x (μ m),F [10^3 N]¶1.5,2.5¶ | um | 1.5e-6
x (1e-6 m),F [kN]¶1.5,2.5¶ | um | 1.5e-6
x [10⁻³ m],F [kN]¶1.5,2.5¶ | mm | 1.5e-3
disp_mm,force_kN¶1.5,2.5¶ | mm | 1.5e-3
disp mm,force kN¶1.5,2.5¶ | mm | 1.5e-3
"Position, nm","Force, kN"¶1.5,2.5¶ | nm | 1.5e-9
x / mm,F/kN¶1.5,2.5¶ | mm | 1.5e-3
x,F¶[in],[kN]¶¶1.5,2.5¶ | in | 0.0381
x [mm],F¶,kN¶1.5,2.5¶ | mm | 1.5e-3
x [mm] F [kN]¶1.5 2.5¶ | mm | 1.5e-3
Zeit [s];Weg [mm];Kraft [kN]¶0,5;1,5;2,5¶ | mm | 1.5e-3
)units";

TEST(RecordReader, ConvertsToSiFromTheUnitsOfTheHeader) {
  for (const Strings& row : RowsOf(kUnits)) {
    SCOPED_TRACE(row[0]);
    const RecordFile file = Read(row[0]);
    EXPECT_EQ(file.displacement.unit, row[1]);
    EXPECT_EQ(file.force.unit, "kN");
    EXPECT_EQ(file.record.displacement, (Numbers{std::stod(row[2])}));
    EXPECT_EQ(file.record.force, (Numbers{2500}));
    EXPECT_EQ(file.notes, Strings{});
  }
}

TEST(RecordReader, PutsChosenUnitAboveThatOfTheHeader) {
  const RecordFile file = Read("x [mm],F [furlong]\n1.5,2.5\n", Choose("[um]", "[mN]"));
  EXPECT_EQ(file.record.displacement, (Numbers{1.5e-6}));
  EXPECT_EQ(file.record.force, (Numbers{2.5e-3}));
}

TEST(RecordReader, ListsNoMoreThanTwentyColumns) {
  std::string header = "zz1";
  std::string row = "1";
  for (int column = 2; column <= 22; ++column) {
    header += fmt::format(",zz{}", column);
    row += ",1";
  }
  EXPECT_THAT(
      MessageOf<InputError>([&] { Read(header + '\n' + row + '\n'); }),
      AllOf(HasSubstr("'zz20' (column 20), … 22 in all: choose it with"), Not(HasSubstr("zz21"))));
}

TEST(RecordReader, NotesWhatItAssumes) {
  EXPECT_EQ(Notes("x,F\n1.5,2.5\n"),
            (Strings{"loop.csv: displacement 'x' (column 1) names no unit: taken as m; "
                     "--displacement '1 [m]' says so",
                     "loop.csv: force 'F' (column 2) names no unit: taken as N; "
                     "--force '2 [N]' says so"}));
  EXPECT_EQ(Notes("rate,200\ngain,3\nx [m],F [N]\n1.5,2.5\n"), Strings{});
  EXPECT_EQ(Notes("x [um],mu\n1.5,2.5\n", Choose("1 [mm]", "2 [N]")),
            (Strings{"loop.csv: displacement 'x [um]' (column 1) names um, and is taken in mm, as "
                     "--displacement says",
                     "loop.csv: force 'mu' (column 2) is a ratio, and is taken in N, as --force "
                     "says"}));
  EXPECT_EQ(Notes("x [um],F [mV]\n1.5,2.5\n", Choose("1 [µm]", "#2*3 [N]")), Strings{});
  EXPECT_EQ(Notes("millis,x [m],F [N]\n1,1.5,2.5\n"), Strings{});
}

// A text, the columns of displacement and force that are chosen, and what is said of loop.csv.
const std::string kFaults = R"faults(
t,x,F¶1,2,3¶ | y | - | : --displacement y: no column is called 'y' (for the displacement): the
   columns are 't' (column 1), 'x' (column 2), 'F' (column 3)
1,2,3¶ | y | - | : --displacement y: no column is called 'y' (for the displacement): the columns
   are column 1, column 2, column 3
t,x,F¶1,2,3¶ | - | 4 | : --force 4: no column is called '#4' (for the force): the
   columns are 't' (column 1), 'x' (column 2), 'F' (column 3)
t,x,F¶1,2,3¶ | - | 0 | : --force 0: no column is called '#0' (for the force): the
   columns are 't' (column 1), 'x' (column 2), 'F' (column 3)
t,x,F¶1,2,3¶ | x | 2 | : 'x' (column 2) is chosen for the force and for another quantity: choose
   two columns
¶x,d,F¶1,2,3¶ | - | - | :2: 'x' (column 1) and 'd' (column 2) may each be the displacement: choose
   one by its number, as --displacement 1
x,x,F¶1,2,3¶ | x | - | :1: 'x' (column 1) and 'x' (column 2) may each be the displacement: choose
   one by its number, as --displacement 1
x [mm],x [V],F¶1,2,3¶ | x | - | :1: 'x [mm]' (column 1) and 'x [V]' (column 2) may each be the
   displacement: choose one by its number, as --displacement 1
x¶1¶ | - | - | : no column for the force: the columns are 'x' (column 1): choose it with --force, by name
   or number
x,F¶1,2¶ | [furlong] | - | : the unit 'furlong' of 'x' (column 1) is not known for the displacement:
   must be one of m, mm, um, nm, cm, in, ft, mil, pm, as in --displacement '1 [m]', or with a factor
   '#1*0.001 [m]'
¶t,x [m],F [V]¶1,2,3¶ | - | - | :2:3: 'F [V]' (column 3) is in V, no force before it is
   multiplied by a gain: --force 'F*GAIN [N]' with its number for GAIN
t,x [m],lc_V¶1,2,3¶ | - | lc_V | :1:3: 'lc_V' (column 3) is in V, no force before it is multiplied by
   a gain: --force 'lc_V*GAIN [N]' with its number for GAIN
x [m],V,V [V]¶1,2,3¶ | - | 3 | :1:3: 'V [V]' (column 3) is in V, no force before it is multiplied by
   a gain: --force '#3*GAIN [N]' with its number for GAIN
t,x [m],F (N x10)¶1,2,3¶ | - | - | :1:3: the unit 'x10' of 'F (N x10)' (column 3) is not known
   for the force: must be one of N, mN, uN, kN, MN, lbf, kgf, kip, gf, daN, dyn, ozf, cN, as in
   --force '3 [N]', or with a factor '#3*0.001 [N]'
x [m],p [bar]¶1,2¶ | - | p | :1:2: the unit 'bar' of 'p [bar]' (column 2) is not known for the
   force: must be one of N, mN, uN, kN, MN, lbf, kgf, kip, gf, daN, dyn, ozf, cN, as in
   --force '2 [N]', or with a factor '#2*0.001 [N]'
¶t,x [m],Torque [Nm]¶1,2,3¶ | - | - | :2:2: the unit 'm' of 'x [m]' (column 2) is not known for the
   displacement: must be one of rad, mrad, deg, rev, as in --displacement '2 [rad]', or with a factor
   '#2*0.001 [rad]'
angle,F¶1,2¶ | - | [kN] | : the unit 'kN' of 'F' (column 2) is not known for the force: must be one of
   N m, N mm, as in --force '2 [N m]', or with a factor
   '#2*0.001 [N m]'
left,F¶3,0¶2,5¶1,-5¶ | - | - | :2:1: 'left' (column 1) only falls while 'F' (column 2) goes to
   and fro, as a clock or a counter does: choose the displacement with --displacement, by name or
   number: the columns are 'left' (column 1), 'F' (column 2)
time [ms],x [m],F [N]¶1,1,1¶2,2,2¶2,3,3¶# a restart¶0.5,4,4¶ | - | - | :6: has a time
   before that of the row above: sort the rows, split the file where a clock starts again, or give
   --sample-rate
x,F¶furlong,N¶1,2¶ | - | - | :1:1: the unit 'furlong' of 'x' (column 1) is not known for the
   displacement: must be one of m, mm, um, nm, cm, in, ft, mil, pm, as in
   --displacement '1 [m]', or with a factor '#1*0.001 [m]'
x / m/s,F¶1,2¶ | - | - | :1:1: the unit 'm/s' of 'x / m/s' (column 1) is not known for the
   displacement: must be one of m, mm, um, nm, cm, in, ft, mil, pm, as in
   --displacement '1 [m]', or with a factor '#1*0.001 [m]'
x [mm],F¶um,N¶1,2¶ | - | - | :1:1: the unit 'mm or um' of 'x [mm]' (column 1) is not known for the
   displacement: must be one of m, mm, um, nm, cm, in, ft, mil, pm, as in
   --displacement '1 [m]', or with a factor '#1*0.001 [m]'
x [m],F [kN]¶1,2¶1,1e307¶ | - | - | :3: has a number that is too large in SI units
x [m],F [N]¶1,2¶3,off¶ | - | - | :3:2: 'off' is not a number: write one like -1.5e-3, without
   separators of thousands, or remove the row
x [m],F [N]¶1,2¶3,off¶4,5,6¶ | - | - | :3:2: 'off' is not a number: write one like -1.5e-3, without
   separators of thousands, or remove the row
x [m],F [N]¶1,2¶# the unit of neither¶a,b,c¶3,off¶ | - | - | :4:1: 'a' is not a number: write one
   like -1.5e-3, without separators of thousands, or remove the row
time,x [m],F [N]¶1,2,3¶nan,2,3¶ | - | - | :3:1: 'nan' is not a number: write one like -1.5e-3,
   without separators of thousands, or remove the row; 1 of 2 rows are so: --broken-rows skip leaves them out
)faults";

TEST(RecordReader, RefusesWhatItCannotReadInOneLine) {
  for (const Strings& fault : RowsOf(kFaults)) {
    SCOPED_TRACE(fault[0]);
    EXPECT_EQ(Refusal(fault[0], Choose(fault[1], fault[2])), "loop.csv" + fault[3]);
  }
}

TEST(RecordReader, TakesASingleStrokeForOne) {
  // A noisy force along one stroke wavers, it does not go back by half its range.
  const Numbers stroke = {0, 1, 2, 3, 4};
  EXPECT_EQ(Read("0,0\n1,3\n2,2.5\n3,5\n4,4.6\n").record.displacement, stroke);
  EXPECT_THAT(Refusal("x,F\n0,0\n1,3\n2,-2\n3,5\n4,0\n"), HasSubstr("'x' (column 1) only grows"));
  // With a unit, or chosen, it may be whatever it is.
  EXPECT_THAT(Read("x [m],F\n0,0\n1,3\n2,-2\n3,5\n4,0\n").record.displacement, stroke);
  EXPECT_EQ(Read("0,0\n1,3\n2,-2\n3,5\n4,0\n", Choose("1")).record.displacement, stroke);
}

// Half a turn and 2 N m, the units chosen, and those that are found.
const std::string kTorques = R"torques(
angle [deg],torque [N m]¶180,2¶ | - | - | deg | N m
angle_deg,torque_Nm¶180,2¶ | - | - | deg | N m
rotation / rev,T [N·m]¶0.5,2¶ | - | - | rev | N m
rotation,torque¶deg,Nmm¶180,2000¶ | - | - | deg | N mm
twist [°],torque¶180,2¶ | - | - | deg | N m
angle,torque [kN m]¶3.141592653589793,0.002¶ | - | - | rad | kN m
180,2¶ | [deg] | [Nm] | deg | N m
)torques";

TEST(RecordReader, ReadsATorqueAgainstAnAngle) {
  for (const Strings& torque : RowsOf(kTorques)) {
    SCOPED_TRACE(torque[0]);
    const RecordFile file = Read(torque[0], Choose(torque[1], torque[2]));
    EXPECT_TRUE(file.is_torsional);
    EXPECT_DOUBLE_EQ(file.record.displacement[0], std::numbers::pi);
    EXPECT_DOUBLE_EQ(file.record.force[0], 2.0);
    EXPECT_EQ(file.displacement.unit, torque[3]);
    EXPECT_EQ(file.force.unit, torque[4]);
  }
  EXPECT_THROW(Read("x [mm],torque\n1,2\n"), InputError) << "a force that is called so";
  EXPECT_EQ(Read("x,F,F_rad\n1,2,3\n").force.index, 2u) << "a radial force is no angle";
  EXPECT_EQ(Read("x,Fx_rad\n1,2\n", Choose("", "Fx_rad")).force.unit, "N");
}

TEST(RecordReader, ReadsOfAnAxialAndATorsionalPairTheOneWhoseMotionGoesToAndFro) {
  // Both loads go to and fro; the angle rests, or the stroke.
  const std::string header = "stroke [mm],force [N],angle [deg],torque [N m]\n";
  const RecordFile axial = Read(header + "0,0,5,0\n1,1,5,1\n-1,-1,6,-1\n0,0,6,0\n");
  EXPECT_EQ(std::pair(axial.displacement.index, axial.force.index), std::pair(1UL, 2UL));
  const RecordFile torsional = Read(header + "5,0,0,0\n5,1,1,1\n6,-1,-1,-1\n6,0,0,0\n");
  EXPECT_EQ(std::pair(torsional.displacement.index, torsional.force.index), std::pair(3UL, 4UL));
  EXPECT_TRUE(torsional.is_torsional);
}

TEST(RecordReader, ReadsALoadOfAJointInNewtonOrAsATorque) {
  for (const auto& [load, value] : {std::pair("load [kN]", 3000.0), {"load [N mm]", 0.003}}) {
    const RecordFile file = Read(std::string("angle [rad],torque [N m],") + load + "\n1,2,3\n",
                                 Choose("", "", "", "load"));
    EXPECT_TRUE(file.is_torsional);
    EXPECT_DOUBLE_EQ(file.record.normal_load[0], value);
  }
  EXPECT_THAT(Refusal("x [mm],F [N],load [N m]\n1,2,3\n", Choose("", "", "", "load")),
              HasSubstr("the unit 'N m' of 'load [N m]' (column 3) is not known for the normal"));
}

TEST(Covariates, ThatAreChosenComeFirstAndAreCalledAsTheyWereChosen) {
  RecordColumns columns;
  columns.covariates = {"p", "3"};
  const RecordFile file = Read("x [m],F [N],q [K],p [bar],s\n0,0,1,5,7\n1,2,3,6,7\n", columns);
  ASSERT_EQ(file.record.covariates.size(), 2U);
  EXPECT_EQ(file.record.covariates[0].name, "p");
  EXPECT_EQ(file.record.covariates[0].unit, "bar");
  EXPECT_EQ(file.record.covariates[0].values, (Numbers{5, 6}));
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
    const TemporaryDirectory directory;
    const auto path = directory.Write("loop.csv", text);
    return WithoutDirectory(MessageOf<InputError>([&] { ReadRecord(path, columns); }), directory);
  };
  EXPECT_EQ(refusal({"q"}),
            "loop.csv: --covariate q: no column is called 'q' (for the covariate): the columns are "
            "'x [m]' (column 1), 'F [N]' (column 2), 'p' (column 3)");
  EXPECT_EQ(refusal({"p", "3"}),
            "loop.csv: 'p' (column 3) is used already: choose another column for the covariate");
  EXPECT_EQ(
      refusal({"F"}),
      "loop.csv: 'F [N]' (column 2) is used already: choose another column for the covariate");
}

TEST(ImposedDisplacement, IsTheFirstOrTheOneThatIsChosenInItsUnit) {
  const auto column = [](const std::string& text, const std::string& choice = {}) {
    const TemporaryDirectory directory;
    return ImposedDisplacement(directory.Write("path.csv", text), choice);
  };
  EXPECT_EQ(column("displacement\n0.1\n0.1\n-0.30000000000000004\n0\n"),
            (Numbers{0.1, 0.1, -0.30000000000000004, 0}));
  EXPECT_EQ(column("1e-6\n-1e-6"), (Numbers{1e-6, -1e-6})) << "without a header";
  EXPECT_EQ(column("command,displacement,remark\n0.5,1,go\n0.25,2,\n"), (Numbers{0.5, 0.25}));
  EXPECT_EQ(column("x [um]\n3\n-7\n"), (Numbers{3e-6, -7e-6}));
  EXPECT_EQ(column("a,b\n1,3\n2,-7\n", "b [mm]"), (Numbers{3e-3, -7e-3}));
  const std::string timed = "t [s],x [mm],F [N],normal [kN]\n0,2,7,1\n1,4,8,2\n";
  EXPECT_EQ(column(timed), (Numbers{2e-3, 4e-3})) << "past a time";
  EXPECT_EQ(column("force [N],x [m]\n1,2\n"), (Numbers{2})) << "past a force";
  EXPECT_THROW(column("force [N],remark\n1,2\n"), InputError);
}

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

struct Named {
  std::string name;
  Numbers values;
};

RecordFile OfColumns(const std::vector<Named>& columns) {
  std::vector<CsvColumn> spans;
  for (const auto& [name, values] : columns) spans.push_back({name, values});
  return RecordOf(spans, "frame");
}

std::string Said(const std::vector<Named>& columns) {
  return MessageOf<InputError>([&] { OfColumns(columns); });
}

TEST(ColumnsInMemory, AreReadByNamesAndUnitsAsAFileIs) {
  const RecordFile file =
      OfColumns({{"F (kN)", {1, 2, 3}}, {"temp", {20, 21, 22}}, {"x [um]", {0, 1, 0}}});
  EXPECT_EQ(file.record.force, (Numbers{1000, 2000, 3000}));
  EXPECT_EQ(file.record.displacement, (Numbers{0, 1e-6, 0}));
  EXPECT_EQ(file.displacement.index, 3U);
  ASSERT_EQ(file.record.covariates.size(), 1U);
  EXPECT_EQ(file.record.covariates.front().name, "temp");
  EXPECT_EQ(file.lines, (std::vector<std::size_t>{1, 2, 3}));
}

TEST(ColumnsInMemory, AreRefusedWhereANumberARowOrAColumnIsMissing) {
  EXPECT_EQ(Said({{"x [m]", {0, 1, 2}}, {"F [N]", {0, kMissing, 2}}}),
            "frame:2:2: holds no number; 1 of 3 rows are so: --broken-rows skip leaves them out");
  EXPECT_EQ(Said({{"x", {0, 1}}, {"F", {0}}}),
            "frame: 'x' has 2 rows and 'F' 1: give as many of both");
  EXPECT_EQ(Said({}), "frame: there is no column");
  EXPECT_EQ(Said({{"x", {}}}), "frame: there is no row");
}

TEST(MeasuredRecords, AreReadByTheirHeaders) {
  struct Measured {
    std::string file;
    std::size_t rows;
    double displacement, force;  // the first [m], [N] or [rad], [N m]
    double last_time;            // [s]; < 0 without one
    RecordColumns columns = {};
  };
  for (const Measured& measured :
       {Measured{"tribometer/test_data_2.txt", 42579, -110.0355 / 1e3, 242.2 / 1e6, 213.784},
        Measured{"seals/O-ring257_3bar.csv", 6340, 0, 154.659, 65697.0 / 1e3,
                 Choose("5 [mm]", "7 [N]", "1 [ms]")},
        Measured{"cycloidal/2024-07-12__16-46-43__torqueramp__conic_4pre1.csv", 36033,
                 0.0178680419921875, -0.103896364569664, 80.5},
        Measured{"band_brake/dataset-1_0.5Hz70lbtension.csv", 18433, -0.00195971641, -806.666097,
                 18},
        Measured{"mts_blocks/sampledatafiletype2.dat", 510, -0.15401678 / 1e3, -8.9147396 * 9.80665,
                 100.10043},
        Measured{"coupons/HEM320C-LP8_Specimen_1_processed_data.csv", 8434,
                 -2.62209996435558e-05 / 1e3, -0.0402993224561214 * 1e3, 422.864609280001},
        Measured{"fatigue/khalooei_002.csv", 30893, 0.587726769, 2.668515137, -1}}) {
    SCOPED_TRACE(measured.file);
    const std::string path = testing::MeasuredPath(measured.file);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const RecordFile file = ReadBothWays(path, measured.columns);
    ASSERT_EQ(file.record.size(), measured.rows);
    EXPECT_DOUBLE_EQ(file.record.displacement.front(), measured.displacement);
    EXPECT_DOUBLE_EQ(file.record.force.front(), measured.force);
    if (measured.last_time >= 0) {
      EXPECT_DOUBLE_EQ(file.record.time.back(), measured.last_time);
    }
  }
}

}  // namespace
}  // namespace mindahl::io::record_reader_test
