#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "mindahl/identification/terms.h"
#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"
#include "support/histories.h"
#include "support/prelude.h"
#include "support/unit_scale.h"

// Every number of a fit's JSON follows the units of its record, as the contract states its unit.
// The factors are powers of two, which round nothing: what is scaled is the same but for its
// exponent.
namespace mindahl::request::units_test {
namespace {

using nlohmann::json;

/// Returns the unit that the schema states of a path; empty where it states none.
std::string StatedUnit(const std::string& path) {
  static const json kSchema =
      json::parse(std::ifstream(MINDAHL_SOURCE_DIR "/docs/schema/fit.json"));
  const json* node = &kSchema;
  std::istringstream names(path);
  for (std::string name; std::getline(names, name, '.') && node != nullptr;) {
    const json::json_pointer place = json::json_pointer("/properties") / name;
    node = node->contains(place) ? &(*node)[place] : nullptr;
  }
  if (node != nullptr && node->contains("unit")) return (*node)["unit"];
  // Members of cycles, of the other law and of models that are compared.
  static const std::map<std::string, std::string> kOfMembers = {
      {"amplitude", "m"}, {"peak_force", "N"}, {"half_gap", "N"}, {"energy", "J"},
      {"sigma", "N/m"},   {"slip_force", "N"}, {"rms", "N"},      {"held_out_rms", "N"}};
  const auto member = kOfMembers.find(path.substr(path.rfind('.') + 1));
  const bool is_member =
      path.starts_with("measured.") || path.starts_with("law.") || path.starts_with("compared");
  return !is_member || member == kOfMembers.end() ? "" : member->second;
}

struct Leaf {
  json value;
  std::string unit;
};

/// Lists the numbers, flags and codes; what is a sentence or the name of a unit is not compared.
void Collect(const json& value, const std::string& path, const std::string& own_unit,
             bool is_forced, std::map<std::string, Leaf>& leaves) {
  if (value.is_object()) {
    const std::string unit = value.contains("unit") && value["unit"].is_string()
                                 ? value["unit"].get<std::string>()
                                 : own_unit;
    for (const auto& [key, member] : value.items()) {
      static const std::set<std::string> kWords = {"message", "unit",    "label", "formula",
                                                   "version", "meaning", "text",  "files",
                                                   "units",   "boundary"};
      if (kWords.contains(key)) continue;
      Collect(member, path.empty() ? key : path + "." + key, unit, is_forced, leaves);
    }
  } else if (value.is_array()) {
    for (std::size_t k = 0; k < value.size(); ++k) {
      Collect(value[k], path + "[" + std::to_string(k) + "]", own_unit, is_forced, leaves);
    }
  } else {
    std::string unit = own_unit.empty() ? StatedUnit(path) : own_unit;
    if (unit == "response") unit = is_forced ? "m" : "N";
    if (unit == "response²") unit = is_forced ? "m²" : "N²";
    leaves[path] = {value, unit};
  }
}

std::map<std::string, Leaf> LeavesOf(const report::Report& report, bool is_forced) {
  std::map<std::string, Leaf> leaves;
  Collect(json::parse(report::ToJson(report)), "", "", is_forced, leaves);
  return leaves;
}

/// A loop beyond gross slip from rest, with noise, a normal load and a time in steps of 2⁻⁷ s.
loop::Record MeasuredLoop(std::uint64_t seed, double load = 1.0) {
  Generator generator(seed);
  loop::Record record;
  for (const double sine : testing::Sine(2.5, 64)) {
    record.displacement.push_back(2.4e-6 * sine);
    record.time.push_back(std::ldexp(static_cast<double>(record.time.size()), -7));
  }
  record.force =
      testing::Respond(testing::Model("mindlin-dahl"),
                       {4e7 * std::cbrt(load), 1.0 / 3, 40.0 * load}, record.displacement);
  for (double& force : record.force) force += 0.2 * testing::Normal(generator);
  return record;
}

io::RecordFile FileOf(loop::Record record, const UnitScale& scale) {
  const auto multiply = [](std::vector<double>& column, double factor) {
    for (double& value : column) value *= factor;
  };
  multiply(record.displacement, scale.length);
  multiply(record.force, scale.force);
  multiply(record.time, scale.time);
  multiply(record.normal_load, scale.force);
  io::RecordFile file;
  file.record = std::move(record);
  return file;
}

/// A question and the records that it is asked of, in some units.
struct Question {
  std::string name;
  std::function<FitRequest(const UnitScale&)> request;
  std::function<std::vector<loop::Record>()> records;
  bool is_forced = false;
};

void PrintTo(const Question& question, std::ostream* out) { *out << question.name; }

report::Report Ask(const Question& question, const UnitScale& scale) {
  FitRequest request = question.request(scale);
  std::vector<io::RecordFile> files;
  for (const loop::Record& record : question.records()) files.push_back(FileOf(record, scale));
  return FitRecords(request, std::move(files));
}

/// States the known inputs of a steel sphere on a plane, in the given units.
void DescribeContact(const UnitScale& scale, ContactOptions& contact) {
  const double pressure = scale.force / (scale.length * scale.length);
  for (contact::KnownBody* const body : {&contact.known.body_1, &contact.known.body_2}) {
    body->youngs_modulus = contact::UncertainValue{210e9 * pressure, 5e9 * pressure};
    body->poisson_ratio = contact::UncertainValue{0.3, 0.01};
  }
  contact.known.body_1.radius = contact::UncertainValue{0.02 * scale.length, 1e-4 * scale.length};
  contact.known.body_2.radius = contact::UncertainValue{std::numeric_limits<double>::infinity(), 0};
}

std::vector<Question> Questions() {
  const auto one = [] { return std::vector{MeasuredLoop(1)}; };
  const auto plain = [](FitRequest request) {
    return [request](const UnitScale&) { return request; };
  };
  FitRequest dahl;
  dahl.fit.model = models::FindFrictionModel("dahl");
  FitRequest forced;
  forced.fit.preparation.excitation = loop::Channel::kForce;
  FitRequest robust;
  robust.fit.loss = identification::Loss::kHuber;
  const FitRequest compared{.compare = true};
  std::vector<Question> questions = {
      {"plain", plain({}), one},
      {"dahl", plain(dahl), one},
      {"robust", plain(robust), one},
      {"compared", plain(compared), one},
      {"displacement_fitted", plain(forced), one, true},
      {"noise_given",
       [](const UnitScale& scale) {
         FitRequest request;
         request.fit.force_noise = 0.2 * scale.force;
         request.fit.preparation.displacement_noise = 5e-9 * scale.length;
         request.fit.fixed["sigma"] = 4.1e7 * scale.force / scale.length;
         request.fit.start["slip_force"] = 35 * scale.force;
         request.fit.preparation.reversal_gate = 1e-8 * scale.length;
         return request;
       },
       one},
      {"prior",
       [](const UnitScale& scale) {
         FitRequest request;
         request.fit.priors["slip_force"] = {41 * scale.force, 0.5 * scale.force};
         return request;
       },
       one},
      {"load_series",
       [](const UnitScale& scale) {
         FitRequest request;
         const std::vector<contact::UncertainValue> loads = {{60 * scale.force, 0.5 * scale.force},
                                                             {120 * scale.force, scale.force}};
         SetNormalLoads(request.contact, loads);
         DescribeContact(scale, request.contact);
         return request;
       },
       [] {
         return std::vector{MeasuredLoop(2, 0.75), MeasuredLoop(3, 1.5)};
       }},
      {"measured_load",
       [](const UnitScale& scale) {
         FitRequest request;
         DescribeContact(scale, request.contact);
         return request;
       },
       [] {
         loop::Record record = MeasuredLoop(4);
         for (std::size_t i = 0; i < record.size(); ++i) {
           record.normal_load.push_back(80 + 0.2 * std::sin(0.37 * static_cast<double>(i)));
         }
         return std::vector{record};
       }},
  };
  using Terms = std::vector<std::string>;
  for (const Terms& terms : std::vector<Terms>{{"viscous", "inertia", "force_drift"},
                                               {"plateau_slope"},
                                               {"slip_trend", "slip_position_quadratic"},
                                               {"slip_speed"},
                                               {"rig_stiffness"},
                                               {"lag"},
                                               {"backlash"},
                                               {"asymmetry"}}) {
    questions.push_back({terms[0], plain({.terms = terms}), one});
  }
  return questions;
}

class AnyQuestion : public ::testing::TestWithParam<Question> {};

TEST_P(AnyQuestion, IsAnsweredInTheUnitsOfTheRecord) {
  // Within what is thought plausible of a contact: E of 53 GPa.
  constexpr UnitScale kOther{.length = 4.0, .force = 4.0, .time = 0.25};
  constexpr double kRounding = 1e-9;
  const auto plain = LeavesOf(Ask(GetParam(), {}), GetParam().is_forced);
  const auto scaled = LeavesOf(Ask(GetParam(), kOther), GetParam().is_forced);
  ASSERT_GT(plain.size(), 100U);
  ASSERT_EQ(plain.size(), scaled.size());
  for (const auto& [path, leaf] : plain) {
    ASSERT_TRUE(scaled.contains(path)) << path;
    const json& other = scaled.at(path).value;
    if (!leaf.value.is_number_float() || !other.is_number_float()) {
      EXPECT_EQ(leaf.value, other) << path;
      continue;
    }
    const double expected = leaf.value.get<double>() * kOther.Of(leaf.unit);
    EXPECT_NEAR(other.get<double>(), expected, kRounding * std::abs(expected))
        << path << " [" << leaf.unit << "]";
  }
}

TEST_P(AnyQuestion, IsAnsweredAlikeWheneverTheRecordBegins) {
  Question later = GetParam();
  later.records = [records = GetParam().records] {
    std::vector<loop::Record> shifted = records();
    for (loop::Record& record : shifted) {
      for (double& time : record.time) time += 1024.0;  // whole steps: nothing is rounded
    }
    return shifted;
  };
  EXPECT_EQ(report::ToJson(Ask(GetParam(), {})), report::ToJson(Ask(later, {})));
}

INSTANTIATE_TEST_SUITE_P(, AnyQuestion, ::testing::ValuesIn(Questions()),
                         [](const auto& question) { return question.param.name; });

}  // namespace
}  // namespace mindahl::request::units_test
