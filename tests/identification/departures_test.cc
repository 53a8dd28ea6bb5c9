#include "identification/inference/departures.h"

#include <memory>
#include <numeric>

#include "identification/stages.h"
#include "support/prelude.h"

// Each column against records in which the contact departs so, by a little.
namespace mindahl::identification::departures_test {
namespace {

/// Above 1/2, so that the slope is continuous where slip begins.
constexpr double kShapeExponent = 0.6;
constexpr double kSlipForce = 40.0;
constexpr double kLength = 4.5e-6;                                 // [m], the motion's half range
constexpr BranchLaw kSlipping{4e7, kShapeExponent, kSlipForce};    // 1.8 of gross slip
constexpr BranchLaw kSticking{1.4e7, kShapeExponent, kSlipForce};  // 0.6 of it
constexpr double kDuration = 0.8;                                  // [s]
constexpr double kCentre = 2e-6;                                   // [m]
constexpr std::size_t kSamples = 1201;

/// Of the sizes below, the change of the force. Second order is some 1e-5 of the first then, and
/// rounding 1e-10.
constexpr double kSmall = 1e-6;

/// A motion with inner loops that lie apart, off centre, which begins on its way.
double MotionAt(double time, double duration) {
  const double phase = 2 * std::acos(-1.0) * (2.2 * time / duration + 0.03);
  return std::sin(phase) - 0.55 * std::sin(3 * phase) + 0.1 * std::sin(2 * phase);
}

struct Motion {
  History displacement;  // [m]
  std::vector<double> time;
};

/// @param uneven  of the step, by which samples are read before or after their time
Motion Move(double length, double duration, double uneven) {
  testing::Generator generator(3);
  Motion motion;
  double most = 0.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double step = duration / (kSamples - 1);
    const bool inside = i > 0 && i + 1 < kSamples;
    const double off = inside ? uneven * step * testing::Uniform(generator, -1, 1) : 0.0;
    motion.time.push_back(step * static_cast<double>(i) + off);
    motion.displacement.push_back(MotionAt(motion.time.back(), duration));
    most = std::max(most, std::abs(motion.displacement.back()));
  }
  for (double& x : motion.displacement) x = kCentre + x * length / most;
  return motion;
}

/// What the contact does: a model, its law and its past.
struct Contact {
  const FrictionModel* model;
  BranchLaw law;
  InitialState state;
  double unloaded;  // [m]

  /// @param at_rest  where it is unloaded
  [[nodiscard]] std::vector<double> Force(const History& displacement, double at_rest,
                                          const SeriesSpring& rig = {},
                                          double asymmetry = 0.0) const {
    return Respond(*model, law, displacement,
                   {.state = state, .unloaded_displacement = at_rest, .asymmetry = asymmetry}, rig);
  }
  [[nodiscard]] std::vector<double> Force(const History& displacement) const {
    return Force(displacement, unloaded);
  }
};

/// A record as it is when the contact departs by `size`.
struct Departed {
  const Contact& contact;
  const Motion& motion;
  double middle;  // [m] of the motion
  double whole;   // [s], of the first record
  double peak;    // [N], the largest force of all records

  [[nodiscard]] std::size_t size() const { return motion.displacement.size(); }

  /// The force as it is made of time, displacement and what the contact gives.
  template <typename Function>
  std::vector<double> Made(Function function) const {
    std::vector<double> force = contact.Force(motion.displacement);
    const double from = (motion.time.front() + motion.time.back()) / 2;
    for (std::size_t i = 0; i < size(); ++i) {
      force[i] =
          function(force[i], (motion.displacement[i] - middle) / kLength, motion.time[i] - from);
    }
    return force;
  }
  /// The force where the contact sees another displacement than the record has.
  template <typename Function>
  std::vector<double> Seen(Function function) const {
    History displacement;
    for (const double x : motion.displacement) displacement.push_back(function(x));
    return contact.Force(displacement, function(contact.unloaded));
  }
};

using Simulate = std::function<std::vector<double>(const Departed&, double size)>;

/// Half waves between the ends of each stroke.
Simulate Bulged(int half_waves) {
  return [half_waves](const Departed& departed, double size) {
    const History& x = departed.motion.displacement;
    const std::vector<double> force = departed.contact.Force(x);
    std::vector<double> bulged = force;
    const auto turns = [&](std::size_t i) {
      return i + 1 == x.size() || (x[i + 1] - x[i]) * (x[i] - x[i - 1]) < 0;
    };
    for (std::size_t begin = 0, end = 1; end < x.size(); ++end) {
      if (!turns(end)) continue;
      const double change = force[end] - force[begin];
      for (std::size_t i = begin + 1; i <= end; ++i) {
        const double progress = (force[i] - force[begin]) / change;
        bulged[i] += size * change * std::sin(half_waves * std::acos(-1.0) * progress);
      }
      begin = end;
    }
    return bulged;
  };
}

/// Length of the motion's unit [m].
double ScaleOf(const Motion& motion) {
  return (motion.displacement.front() - kCentre) /
         MotionAt(motion.time.front(), motion.time.back());
}

/// The force between samples, from fifty times as many.
std::vector<double> Late(const Departed& departed, double lag) {
  constexpr std::size_t kLast = 50 * (kSamples - 1);
  const double duration = departed.motion.time.back();
  const double scale = ScaleOf(departed.motion);
  History fine;
  for (std::size_t i = 0; i <= kLast; ++i) {
    const double time = duration * static_cast<double>(i) / kLast;
    fine.push_back(kCentre + scale * MotionAt(time, duration));
  }
  const std::vector<double> force = departed.contact.Force(fine);
  std::vector<double> late;
  for (const double time : departed.motion.time) {
    const double place = std::clamp(time - lag, 0.0, duration) / duration * kLast;
    const std::size_t i = std::min(static_cast<std::size_t>(place), kLast - 1);
    late.push_back(std::lerp(force[i], force[i + 1], place - static_cast<double>(i)));
  }
  return late;
}

/// Read as often before its time as after it: a window with the variance of the size.
std::vector<double> Averaged(const Departed& departed, double variance) {
  std::vector<double> mean = Late(departed, std::sqrt(variance));
  const std::vector<double> early = Late(departed, -std::sqrt(variance));
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = (mean[i] + early[i]) / 2;
  return mean;
}

double Differentiated(double time, double duration, int order) {
  const double step = 1e-4 * duration;
  const auto at = [&](int k) { return MotionAt(time + k * step, duration); };
  return order == 1 ? (at(1) - at(-1)) / (2 * step) : (at(1) - 2 * at(0) + at(-1)) / (step * step);
}

/// C or m times a derivative of the motion, which is known.
Simulate WithDerivative(int order) {
  return [order](const Departed& departed, double size) {
    const Motion& motion = departed.motion;
    const double duration = motion.time.back();
    const double scale = ScaleOf(motion);
    std::vector<double> force = departed.contact.Force(motion.displacement);
    for (std::size_t i = 0; i < force.size(); ++i) {
      force[i] += size * scale * Differentiated(motion.time[i], duration, order);
    }
    return force;
  };
}

/// Tc·size times a power of the speed, in half ranges of the motion a half duration of the first
/// record.
Simulate WithSpeed(double power) {
  const Simulate with_velocity = WithDerivative(1);
  return [power, with_velocity](const Departed& departed, double size) {
    std::vector<double> force = departed.contact.Force(departed.motion.displacement);
    const std::vector<double> with = with_velocity(departed, 1.0);
    for (std::size_t i = 0; i < force.size(); ++i) {
      const double speed = (with[i] - force[i]) * (kDuration / 2) / kLength;
      force[i] += size * kSlipForce * std::copysign(std::pow(std::abs(speed), power), speed);
    }
    return force;
  };
}

/// A motion that loses `gap` at each reversal.
std::vector<double> WithGap(const Departed& departed, double gap) {
  const History& drive = departed.motion.displacement;
  const double first = drive.front() > departed.contact.unloaded ? 1.0 : -1.0;
  const double other = departed.contact.state == InitialState::kVirgin ? first : 1.0;
  History contact;
  double at = drive.front();
  for (const double x : drive) {
    at = std::clamp(at, std::min(x, x + other * gap), std::max(x, x + other * gap));
    contact.push_back(at);
  }
  return departed.contact.Force(contact);
}

struct Case {
  std::string_view code;
  std::size_t column;  // of this departure
  double unit;         // of the size, in SI: what makes a change of the force's order
  Simulate simulate;
  double tolerance = 1e-3;
};

/// Differences of the motion err by the square of a step of 0.035 of its third harmonic, where
/// steps are uneven by their difference: a fifth of that.
constexpr double kDifferences = 0.02;

/// A second difference over two steps to either side errs by the square of 0.07 of the motion's
/// third harmonic, and the force after a reversal has three times as high ones in it.
constexpr double kSecondDifferences = 0.05;

std::vector<Case> Cases() {
  const auto made = [](auto function) -> Simulate {
    return [function](const Departed& departed, double size) {
      return departed.Made([&](double force, double x, double time) {
        return function(departed, size, force, x, time);
      });
    };
  };
  const auto of_position = [&](int power) {
    return made([power](auto&, double size, double force, double x, double) {
      return force + size * kSlipForce * std::pow(x, power);
    });
  };
  const auto of_slip_force = [&](int power, bool alike) {
    return made([power, alike](auto&, double size, double force, double x, double) {
      return force + (alike ? std::abs(force) : force) * size * std::pow(x, power);
    });
  };
  const auto seen = [](int power) -> Simulate {
    return [power](const Departed& departed, double size) {
      return departed.Seen([&](double x) {
        const double share = (x - departed.middle) / kLength;
        return x + size * kLength * std::pow(share, power);
      });
    };
  };
  return {
      {"channel_lag", 0, kDuration, Late, kDifferences},
      {"viscous_force", 0, kSlipForce / kLength * kDuration, WithDerivative(1), kDifferences},
      {"plateau_slope", 0, 1, of_position(1)},
      {"force_drift", 0, kSlipForce / kDuration,
       made([](auto&, double size, double force, double, double time) {
         return force + size * time;
       })},
      {"shape_of_law", 0, 1, Bulged(1)},
      {"shape_of_law", 1, 1, Bulged(2)},
      {"shape_of_law", 2, 1, Bulged(3)},
      {"guide_friction", 0, kSlipForce,
       [](const Departed& departed, double size) {
         std::vector<double> force = departed.contact.Force(departed.motion.displacement);
         const History& x = departed.motion.displacement;
         for (std::size_t i = 0; i < force.size(); ++i) {
           const bool up = i == 0 ? x[1] > x[0] : x[i] > x[i - 1];
           force[i] += up ? size : -size;
         }
         return force;
       }},
      {"rig_in_series", 0, kLength / kSlipForce,
       [](const Departed& departed, double size) {
         return departed.contact.Force(departed.motion.displacement, departed.contact.unloaded,
                                       {size > 0 ? 1 / size : HUGE_VAL});
       }},
      {"backlash", 0, kLength, WithGap},
      {"displacement_sensor", 0, 1, seen(2)},
      {"displacement_sensor", 1, 1, seen(3)},
      {"inertia", 0, kSlipForce / kLength * kDuration * kDuration, WithDerivative(2),
       2 * kDifferences},
      {"unequal_directions", 0, 1, made([](auto&, double size, double force, double, double) {
         return force > 0 ? (1 + size) * force : (1 - size) * force;
       })},
      {"unequal_directions", 1, 1,
       [](const Departed& departed, double size) {
         return departed.contact.Force(departed.motion.displacement, departed.contact.unloaded, {},
                                       size);
       }},
      {"running_in", 0, 1,
       made([](const Departed& departed, double size, double force, double, double time) {
         return force * (1 + size * time / departed.whole);
       })},
      {"force_saturates", 0, 1,
       made([](const Departed& departed, double size, double force, double, double) {
         const double from = 0.9 * departed.peak;
         const double beyond = std::max(std::abs(force) - from, 0.0);
         return std::copysign(std::abs(force) - size * beyond, force);
       })},
      {"force_saturates", 1, 1, made([](auto&, double size, double force, double, double) {
         return force + size * kSlipForce * std::pow(force / kSlipForce, 3);
       })},
      {"slip_position", 0, 1, of_slip_force(1, false)},
      {"slip_position", 1, 1, of_slip_force(1, true)},
      {"force_of_position", 0, 1, of_position(2)},
      {"force_of_position", 1, 1, of_position(3)},
      {"smoothing", 0, kDuration * kDuration, Averaged, kSecondDifferences},
      {"displacement_sensor_drift", 0, kLength / kDuration,
       [](const Departed& departed, double size) {
         const std::vector<double>& time = departed.motion.time;
         History contact = departed.motion.displacement;
         for (std::size_t i = 0; i < contact.size(); ++i) {
           contact[i] += size * (time[i] - (time.front() + time.back()) / 2);
         }
         return departed.contact.Force(contact);
       }},
      {"speed_power", 0, 1, WithSpeed(0.5), kDifferences},
      {"speed_power", 1, 1, WithSpeed(1.0), kDifferences},
      {"slip_position_quadratic", 0, 1, of_slip_force(1, false)},
      {"slip_position_quadratic", 1, 1, of_slip_force(2, false)},
      {"slip_position_quadratic", 2, 1, of_slip_force(1, true)},
      {"slip_position_quadratic", 3, 1, of_slip_force(2, true)},
      {"clock_drift", 0, kDuration,
       [](const Departed& departed, double size) {
         std::vector<double> force = Late(departed, size / 2);
         const std::vector<double> early = Late(departed, -size / 2);
         const double from = (departed.motion.time.front() + departed.motion.time.back()) / 2;
         for (std::size_t i = 0; i < force.size(); ++i) {
           const double late = 0.5 + (departed.motion.time[i] - from) / departed.whole;
           force[i] = late * force[i] + (1 - late) * early[i];
         }
         return force;
       },
       kDifferences},
      {"clock_drift", 1, kDuration,
       [](const Departed& departed, double size) { return Late(departed, size / 2); },
       kDifferences},
  };
}

/// θ of the truth.
std::vector<double> TrueTheta(const Stages& stages, const Contact& contact) {
  const Parameters& parameters = stages.problem.parameters;
  std::vector<double> theta;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const std::string_view name = parameters[p].term->name;
    const double value = name == "sigma"                 ? contact.law.tangential_stiffness
                         : name == "alpha"               ? kShapeExponent
                         : name == "slip_force"          ? kSlipForce
                         : name == "rig_stiffness"       ? 1e9
                         : name == "displacement_offset" ? contact.unloaded
                                                         : 0.0;
    theta.push_back(parameters[p].absent ? parameters[p].theta : parameters[p].ToTheta(value));
  }
  return theta;
}

/// The motion begins near 1.8e-6 m, downward: a contact that was unloaded below has turned there.
constexpr double kAhead = 2.4e-6;
constexpr double kBehind = -3e-7;

struct Setting {
  const char* name;
  const char* model;
  InitialState state;
  BranchLaw law = kSlipping;
  double unloaded = kAhead;
  double uneven = 0.0;
  bool two_records = false;
  int sense = 1;
};

class ColumnOfDeparture : public ::testing::TestWithParam<Setting> {};

/// Returns the code of each column.
std::vector<std::string_view> CodesOf(const DepartureColumns& columns) {
  std::vector<std::string_view> of(static_cast<std::size_t>(columns.columns.cols()));
  for (const OmittedTerm& term : columns.terms) {
    for (const Eigen::Index place : term.places) {
      of[static_cast<std::size_t>(place)] = term.code;
    }
  }
  return of;
}

double Middle(const Motion& motion) {
  const auto [lowest, highest] = std::ranges::minmax(motion.displacement);
  return lowest + (highest - lowest) / 2;
}

TEST_P(ColumnOfDeparture, IsDerivativeOfForceByTermSize) {
  const Setting& setting = GetParam();
  const Contact contact{&Model(setting.model), setting.law, setting.state, setting.unloaded};
  std::vector<Motion> motions = {Move(kLength, kDuration, setting.uneven)};
  if (setting.two_records) motions.push_back(Move(0.7 * kLength, 2.5 * kDuration, setting.uneven));
  // The motion's half range is what is made to be kLength.
  double half = 0.0;
  for (Motion& motion : motions) {
    const auto [lowest, highest] = std::ranges::minmax(motion.displacement);
    half = std::max(half, (highest - lowest) / 2);
  }
  for (Motion& motion : motions) {
    for (double& x : motion.displacement) x = kCentre + (x - kCentre) * kLength / half;
  }
  double peak = 0.0;
  for (const Motion& motion : motions) {
    for (const double force : contact.Force(motion.displacement)) {
      peak = std::max(peak, std::abs(force));
    }
  }
  std::vector<Departed> departed;
  std::vector<Record> records;
  for (const Motion& motion : motions) {
    departed.push_back({contact, motion, Middle(motion), motions.front().time.back(), peak});
    Record& record = records.emplace_back();
    record.displacement = motion.displacement;
    record.time = motion.time;
    for (const double force : contact.Force(motion.displacement)) {
      record.force.push_back(setting.sense * force);
    }
  }
  Stages stages(records, {.model = contact.model, .preparation = {.force_sense = setting.sense}},
                setting.state);
  ASSERT_NEAR(stages.data.length / kLength, 1, 1e-9);
  const std::vector<double> theta = TrueTheta(stages, contact);
  const DepartureColumns columns = ColumnsOfDepartures(stages.problem, theta, {}, 100);
  Response response(stages.problem);
  std::vector<Case> cases = Cases();
  // Of a contact that had slipped before an asymmetry is an offset, and Dahl's own has none.
  const bool tells_asymmetry =
      setting.state == InitialState::kVirgin && contact.model->memory == Memory::kReturnPoint;
  std::erase_if(cases, [&](const Case& tested) {
    return tested.code == "unequal_directions" && tested.column == 1 && !tells_asymmetry;
  });
  const std::vector<std::string_view> of = CodesOf(columns);
  ASSERT_EQ(of.size(), cases.size());

  std::size_t c = 0;
  for (const Case& tested : cases) {
    SCOPED_TRACE(std::string(tested.code) + ", column " + std::to_string(tested.column));
    ASSERT_EQ(of[c], tested.code);
    ASSERT_TRUE(tested.column == 0 || of[c - tested.column] == of[c]);
    // A drift is the file's, everything else is in the sense of the displacement.
    const double sense = tested.code == "force_drift" ? setting.sense : 1;
    const double size = kSmall * tested.unit;
    std::vector<double> expected;
    std::vector<double> found;
    Eigen::Index row = 0;
    for (std::size_t r = 0; r < records.size(); ++r) {
      const std::vector<double> with = tested.simulate(departed[r], size);
      const std::vector<double> without = tested.simulate(departed[r], 0.0);
      const LoadingPath& path = response.MotionOf(r, theta).paths.front().path;
      for (std::size_t i = 0; i < with.size(); ++i, ++row) {
        // Next to a reversal, and where a loop closes, differences see both branches, and a gap or
        // a lag is not yet over: the force is not of first order in them there.
        const auto is_near = [&](std::size_t sample) {
          return std::max(i, sample) - std::min(i, sample) <= 3;
        };
        const bool turns =
            std::ranges::any_of(path.runs, [&](const auto& run) { return is_near(run.begin); });
        if (turns || i + 3 >= with.size()) continue;
        expected.push_back((with[i] - without[i]) / kSmall);
        found.push_back(sense * columns.columns(row, static_cast<Eigen::Index>(c)));
      }
    }
    // A column is in a unit of its own, of its own sign.
    const double unit = std::inner_product(found.begin(), found.end(), expected.begin(), 0.0) /
                        std::inner_product(found.begin(), found.end(), found.begin(), 0.0);
    EXPECT_GT(tested.code == "force_drift" ? std::abs(unit) : unit, 0.0);
    double largest = 0.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      largest = std::max(largest, std::abs(expected[i]));
      worst = std::max(worst, std::abs(unit * found[i] - expected[i]));
    }
    EXPECT_GT(largest, 0.01 * kSlipForce) << "the case needs it";
    // Dahl's own law keeps no loop: what a rig makes of the ends of a record is not what went
    // before it.
    const bool is_of_before = tested.code == "rig_in_series" &&
                              setting.state == InitialState::kSteady &&
                              contact.model->memory == Memory::kNone;
    EXPECT_LT(worst / largest, is_of_before ? 0.15 : tested.tolerance);
    ++c;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, ColumnOfDeparture,
    ::testing::Values(
        Setting{"AVirginContact", "mindlin-dahl", InitialState::kVirgin},
        Setting{"AVirginContactThatSticks", "mindlin-dahl", InitialState::kVirgin, kSticking},
        Setting{"AContactThatTurnedAtTheFirstSample", "mindlin-dahl", InitialState::kVirgin,
                kSticking, kBehind},
        Setting{"ASteadyLoop", "mindlin-dahl", InitialState::kSteady},
        Setting{"ASteadyLoopThatSticks", "mindlin-dahl", InitialState::kSteady, kSticking},
        Setting{"DahlsLaw", "dahl", InitialState::kVirgin, kSticking, kBehind},
        Setting{"DahlsSteadyLoop", "dahl", InitialState::kSteady, kSticking},
        Setting{.name = "UnevenSteps",
                .model = "mindlin-dahl",
                .state = InitialState::kVirgin,
                .uneven = 0.2},
        Setting{.name = "TwoRecords",
                .model = "mindlin-dahl",
                .state = InitialState::kVirgin,
                .two_records = true},
        Setting{.name = "TheOtherSense",
                .model = "mindlin-dahl",
                .state = InitialState::kSteady,
                .sense = -1}),
    [](const auto& setting) { return std::string(setting.param.name); });

/// A loop whose extremes lie on samples, with what a record may have beside force and displacement.
Record Complete() {
  Record record;
  record.displacement = testing::Cycling(testing::Wave::kSine, kLength, 2.0, 80);
  record.force = testing::Respond(Model("mindlin-dahl"), kSticking, record.displacement);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.time.push_back(static_cast<double>(i));
  }
  return record;
}

DepartureColumns ColumnsOf(Stages& stages) {
  const Contact contact{&Model("mindlin-dahl"), kSticking, InitialState::kVirgin, 0.0};
  return ColumnsOfDepartures(stages.problem, TrueTheta(stages, contact), {}, 100);
}

bool Has(const DepartureColumns& columns, std::string_view code) {
  return std::ranges::any_of(columns.terms,
                             [&](const OmittedTerm& term) { return term.code == code; });
}

TEST(Departures, SkipsTermsThatAreFitted) {
  Stages stages(Complete(),
                {.terms = {"viscous", "force_drift", "plateau_slope", "rig_stiffness"}});
  const DepartureColumns columns = ColumnsOf(stages);
  for (const std::string_view code :
       {"viscous_force", "force_drift", "plateau_slope", "rig_in_series"}) {
    EXPECT_FALSE(Has(columns, code)) << code;
  }
  EXPECT_TRUE(Has(columns, "channel_lag"));
}

}  // namespace
}  // namespace mindahl::identification::departures_test
