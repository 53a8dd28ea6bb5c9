#include "io/roles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/nearest_name.h"
#include "core/text.h"
#include "io/source.h"
#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

std::optional<Unit> ForceOrTorqueUnit(std::string_view symbol) {
  const std::optional<Unit> force = ForceUnit(symbol);
  return force ? force : TorqueUnit(symbol);
}

std::string ForceOrTorqueUnitSymbols() { return ForceUnitSymbols() + ", " + TorqueUnitSymbols(); }

/// Finds the unit of one quantity over another, "N/um" or "um/N".
std::optional<Unit> ResponseUnit(std::string_view symbol) {
  const std::size_t slash = symbol.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto find = [](std::string_view part) {
    const std::optional<Unit> force = ForceUnit(part);
    return force ? force : LengthUnit(part);
  };
  const std::optional<Unit> above = find(symbol.substr(0, slash));
  const std::optional<Unit> below = find(symbol.substr(slash + 1));
  const bool both = above && below;
  if (!both || ForceUnit(above->symbol).has_value() == ForceUnit(below->symbol).has_value()) {
    return std::nullopt;
  }
  return Unit{.symbol = std::string(symbol),
              .numerator = above->numerator * below->denominator,
              .denominator = above->denominator * below->numerator};
}

std::string ResponseUnitSymbols() { return "a force over a length or the inverse, as N/um, um/N"; }

constexpr std::array kRules = {
    RoleRules{Role::kDisplacement, "displacement", "--displacement", "m", LengthUnit,
              LengthUnitSymbols},
    RoleRules{Role::kForce, "force", "--force", "N", ForceUnit, ForceUnitSymbols},
    RoleRules{Role::kTime, "time", "--time", "s", TimeUnit, TimeUnitSymbols},
    RoleRules{Role::kNormalLoad, "normal load", "--normal-load-column", "N", ForceUnit,
              ForceUnitSymbols},
    RoleRules{Role::kResponse, "response", "--response", "N/m", ResponseUnit, ResponseUnitSymbols},
    RoleRules{Role::kOther, "covariate", "--covariate", "", nullptr, nullptr},
};
// A joint carries a torque, a twisted contact a normal load.
constexpr std::array kTorsionalRules = {
    RoleRules{Role::kDisplacement, "displacement", "--displacement", "rad", AngleUnit,
              AngleUnitSymbols},
    RoleRules{Role::kForce, "force", "--force", "N m", TorqueUnit, TorqueUnitSymbols},
    kRules[2],
    RoleRules{Role::kNormalLoad, "normal load", "--normal-load-column", "N", ForceOrTorqueUnit,
              ForceOrTorqueUnitSymbols},
};

// How a column's numbers behave.

std::span<const double> NumbersOf(const ColumnNames& names, std::size_t column) {
  return names.table().columns[column].values;
}

bool IsConstant(std::span<const double> values) {
  double first = std::numeric_limits<double>::quiet_NaN();
  for (const double value : values) {
    if (std::isnan(first)) first = value;
    if (!std::isnan(value) && value != first) return false;
  }
  return true;
}

/// Only grows, or only falls, as a clock or a counter does, of which many values may repeat.
bool IsMonotone(std::span<const double> values) {
  bool rises = false;
  bool falls = false;
  double last = std::numeric_limits<double>::quiet_NaN();
  for (const double value : values) {
    rises = rises || value > last;
    falls = falls || value < last;
    if (rises && falls) return false;
    if (!std::isnan(value)) last = value;
  }
  return rises || falls;
}

/// Both rises and falls by a good part of its range: noise does not, nor does a friction force
/// along a single stroke. Half the range is what one cycle from the middle has.
bool GoesToAndFro(std::span<const double> values) {
  constexpr double kGoodPart = 0.4;
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  double rise = 0.0;
  double fall = 0.0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
    rise = std::max(rise, value - least);
    fall = std::max(fall, greatest - value);
  }
  return greatest > least && std::min(rise, fall) > kGoodPart * (greatest - least);
}

/// True if at least half of the rows have a number.
bool IsNumeric(const ColumnNames& names, std::size_t column) {
  const std::span<const double> values = NumbersOf(names, column);
  const auto holes = std::ranges::count_if(values, [](double value) { return std::isnan(value); });
  return !values.empty() && 2 * holes <= std::ssize(values);
}

/// Evidence that a column has a role: 0 is none. A unit counts more than a word.
int EvidenceFor(const ColumnNames& names, std::size_t column, Role role) {
  constexpr int kUnit = 100;
  constexpr int kWord = 50;
  constexpr int kStep = 5;       // of a rank
  constexpr int kLesser = 30;    // what is commanded or raw
  constexpr int kContrary = 60;  // a unit of the role, but a word of another
  const Dimension dimension = names.DimensionOf(column);
  const NameEvidence evidence = EvidenceOf(names.split(column).name);
  const bool has_word = !evidence.word.empty();
  const bool is_named = has_word && evidence.role == role;
  const bool is_load = has_word && evidence.role == Role::kNormalLoad;
  // A force in newton, unless there is a better one.
  if (role == Role::kForce && evidence.word == "f n") return 1;
  if (has_word && !is_named && (role == Role::kNormalLoad || is_load)) return 0;
  const bool is_of_unit = MayHaveRole(dimension, role);
  const int word = kWord - kStep * evidence.rank -
                   std::min<int>(static_cast<int>(evidence.other_words), kStep - 1);
  int found = 0;
  if (is_of_unit) found = has_word && !is_named ? kUnit - kContrary : kUnit;
  if (role == Role::kNormalLoad && !is_named) return 0;
  if (role == Role::kTime && names.table().columns[column].is_clock && !is_of_unit) {
    found = is_named || !has_word ? kUnit - kStep : 0;
  }
  if (is_named) {
    const bool may_be = dimension == Dimension::kNone || is_of_unit || role == Role::kResponse;
    const bool is_needed = role == Role::kDisplacement || role == Role::kForce;
    found += may_be ? word : is_needed ? 1 : 0;
  }
  return found > kLesser && evidence.is_lesser ? found - kLesser : found;
}

enum class Kind { kAny, kLinear, kAngular };

/// Length and force, or angle and torque, by the unit or else the name.
Kind KindOf(const ColumnNames& names, const Expression& columns) {
  if (columns.terms.empty() && columns.unit.empty()) return Kind::kAny;
  Dimension dimension = DimensionOfUnit(columns.unit);
  const std::size_t column = columns.terms.empty() ? 0 : columns.terms.front().column;
  if (dimension == Dimension::kNone) dimension = names.DimensionOf(column);
  if (dimension == Dimension::kAngle || dimension == Dimension::kTorque) return Kind::kAngular;
  if (dimension == Dimension::kLength || dimension == Dimension::kForce) return Kind::kLinear;
  return EvidenceOf(names.split(column).name).is_angular ? Kind::kAngular : Kind::kAny;
}

Expression ColumnAlone(std::size_t column, const Expression& given) {
  Expression alone = given;
  alone.terms = {{column, 1.0}};
  return alone;
}

class RoleAssigner {
 public:
  RoleAssigner(const ColumnNames& names, std::vector<std::string>& notes)
      : names_(names), notes_(notes), taken_(names.table().columns.size()) {}

  Roles Assign(const RecordColumns& columns) {
    Roles roles;
    roles.displacement = TakeGiven(columns.displacement, Role::kDisplacement);
    roles.force = TakeGiven(columns.force, Role::kForce);
    roles.time = TakeGiven(columns.time, Role::kTime);
    roles.normal_load = TakeGiven(columns.normal_load, Role::kNormalLoad);
    const bool finds_displacement = roles.displacement.terms.empty();
    const bool finds_force = roles.force.terms.empty();
    FindPair(roles);
    if (roles.time.terms.empty() && !columns.sample_rate) TakeFound(Role::kTime, roles.time);
    // A load that is fitted as a force of its own is not also the law's, unless it is asked to be.
    std::vector<bool> taken = taken_;
    for (const std::string& covariate : columns.covariates) {
      taken_[names_.Chosen(covariate, RulesOf(Role::kOther))] = true;
    }
    if (roles.normal_load.terms.empty()) TakeFound(Role::kNormalLoad, roles.normal_load);
    taken_ = std::move(taken);
    TakeLeft(roles);
    RequireConsistent(roles, finds_displacement, finds_force);
    return roles;
  }

 private:
  Expression TakeGiven(const std::string& text, Role role) {
    const RoleRules& rules = RulesOf(role);
    Expression given = names_.Read(text, rules);
    for (const Expression::Term& term : given.terms) {
      if (taken_[term.column]) {
        throw InputError(
            fmt::format("{}: {} is chosen for the {} and for another quantity: choose two columns",
                        names_.table().file, names_.Label(term.column), rules.name));
      }
      taken_[term.column] = true;
    }
    return given;
  }

  void Take(std::size_t column, Expression& role) {
    taken_[column] = true;
    role = ColumnAlone(column, role);
  }

  void TakeFound(Role role, Expression& found) {
    const std::optional<std::size_t> column = FindColumnOf(names_, role, taken_);
    if (column) return Take(*column, found);
    for (std::size_t text = 0; text < taken_.size() && role == Role::kTime; ++text) {
      const NameEvidence evidence = EvidenceOf(names_.split(text).name);
      if (evidence.word.empty() || evidence.role != role || IsNumeric(names_, text)) continue;
      notes_.push_back(fmt::format("{}: time {} holds no numbers: left out", names_.table().file,
                                   names_.Label(text)));
    }
    if (found.unit.empty()) return;
    const RoleRules& rules = RulesOf(role);
    throw InputError(fmt::format("{}: {} [{}]: no column is recognised as the {}: name it",
                                 names_.table().file, rules.option, found.unit, rules.name));
  }

  struct Candidate {
    std::size_t column;
    int evidence;
    Kind kind;
  };

  std::vector<Candidate> CandidatesFor(Role role, const Expression& given) const {
    std::vector<Candidate> candidates;
    if (!given.terms.empty()) {
      return {{given.terms.front().column, 0, KindOf(names_, given)}};
    }
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      if (taken_[column] || !IsNumeric(names_, column)) continue;
      const int evidence = EvidenceFor(names_, column, role);
      if (evidence > 0) {
        candidates.push_back({column, evidence, KindOf(names_, ColumnAlone(column, given))});
      }
    }
    return candidates;
  }

  /// Takes the displacement and the force of the most evidence that go together.
  void FindPair(Roles& roles) {
    constexpr int kMismatch = 40;
    std::vector<Candidate> displacements = CandidatesFor(Role::kDisplacement, roles.displacement);
    std::vector<Candidate> forces = CandidatesFor(Role::kForce, roles.force);
    if (roles.displacement.terms.empty()) DropUnmoved(displacements, Role::kDisplacement);
    if (roles.force.terms.empty()) DropUnmoved(forces, Role::kForce);
    const auto evidence_of = [](const Candidate& a, const Candidate& b) {
      const bool differs = a.kind != b.kind && a.kind != Kind::kAny && b.kind != Kind::kAny;
      return a.column == b.column ? 0 : a.evidence + b.evidence - (differs ? kMismatch : 0);
    };
    const auto keep_best = [&](std::vector<Candidate>& kept, const std::vector<Candidate>& others) {
      std::vector<int> most;
      for (const Candidate& one : kept) {
        most.push_back(one.evidence);
        if (!others.empty()) most.back() = std::numeric_limits<int>::min();
        for (const Candidate& other : others) {
          most.back() = std::max(most.back(), evidence_of(one, other));
        }
      }
      std::vector<Candidate> best;
      for (std::size_t k = 0; k < kept.size(); ++k) {
        if (most[k] == *std::ranges::max_element(most)) best.push_back(kept[k]);
      }
      kept = std::move(best);
    };
    keep_best(displacements, forces);
    TakeOneOf(displacements, Role::kDisplacement, roles.displacement);
    std::erase_if(forces, [&](const Candidate& force) {
      return roles.force.terms.empty() && taken_[force.column];
    });
    if (!roles.displacement.terms.empty()) {
      displacements = {
          {roles.displacement.terms.front().column, 0, KindOf(names_, roles.displacement)}};
    }
    keep_best(forces, displacements);
    TakeOneOf(forces, Role::kForce, roles.force);
  }

  /// Leaves out columns that stay or only grow where others go to and fro, and says so where they
  /// have as much evidence as these.
  void DropUnmoved(std::vector<Candidate>& candidates, Role role) {
    std::vector<Candidate> moving;
    std::vector<std::size_t> all;
    int most_of_unmoved = 0;
    int most = 0;
    for (const Candidate& candidate : candidates) {
      const bool moves = GoesToAndFro(NumbersOf(names_, candidate.column));
      if (moves) moving.push_back(candidate);
      int& greatest = moves ? most : most_of_unmoved;
      greatest = std::max(greatest, candidate.evidence);
      all.push_back(candidate.column);
    }
    if (moving.empty() || moving.size() == candidates.size()) return;
    if (most_of_unmoved >= most) {
      notes_.push_back(fmt::format("{}: {} may each be the {}: one that goes to and fro is taken",
                                   names_.table().file, names_.Labels(all), RulesOf(role).name));
    }
    candidates = std::move(moving);
  }

  void TakeOneOf(const std::vector<Candidate>& candidates, Role role, Expression& taken) {
    if (!taken.terms.empty() || candidates.empty()) return;
    if (candidates.size() == 1) return Take(candidates.front().column, taken);
    std::vector<std::size_t> columns(candidates.size());
    std::ranges::transform(candidates, columns.begin(), &Candidate::column);
    ThrowAmbiguous(names_, RulesOf(role), columns);
  }

  /// Gives what no name or unit decides to the columns that are left, if they are as many.
  void TakeLeft(Roles& roles) {
    std::vector<std::pair<Role, Expression*>> missing;
    if (roles.displacement.terms.empty())
      missing.emplace_back(Role::kDisplacement, &roles.displacement);
    if (roles.force.terms.empty()) missing.emplace_back(Role::kForce, &roles.force);
    if (missing.empty()) return;
    std::vector<std::size_t> left;
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const bool is_unknown = names_.DimensionOf(column) == Dimension::kNone &&
                              EvidenceOf(names_.split(column).name).word.empty();
      const bool is_clock = names_.table().columns[column].is_clock;
      if (!taken_[column] && is_unknown && !is_clock && IsNumeric(names_, column))
        left.push_back(column);
    }
    std::string why;
    if (left.size() > missing.size()) {
      std::erase_if(left, [&](std::size_t column) {
        return IsConstant(NumbersOf(names_, column)) || IsMonotone(NumbersOf(names_, column));
      });
      why = ", of those that neither stay nor only grow";
    }
    if (left.size() != missing.size()) ThrowNoColumn(missing.front().first);
    for (std::size_t k = 0; k < left.size(); ++k) {
      Take(left[k], *missing[k].second);
      notes_.push_back(
          fmt::format("{}: no column name is recognised as {}: taken from {}, {}{}",
                      names_.table().file, RulesOf(missing[k].first).name, names_.Label(left[k]),
                      left.size() == 1 ? "the only one left" : "the two left in their order", why));
    }
  }

  [[noreturn]] void ThrowNoColumn(Role role) const {
    const RoleRules& rules = RulesOf(role);
    const std::size_t columns = names_.table().columns.size();
    for (std::size_t column = 0; column < columns; ++column) {
      if (EvidenceFor(names_, column, role) <= 0 || IsNumeric(names_, column)) continue;
      throw InputError(fmt::format(
          "{}: {} holds no numbers: the {} needs one in every row, or name another column with {}",
          names_.table().file, names_.Label(column), rules.name, rules.option));
    }
    throw InputError(fmt::format(
        "{}: no column for the {}: {}", names_.table().file, rules.name,
        columns == 1
            ? "the file has 1 column"
            : fmt::format("{}: name the column of the displacement with --displacement and "
                          "that of the force with --force, by name or number",
                          names_.Listing())));
  }

  /// Refuses a column that no unit decides, but whose numbers are those of a clock or a counter.
  void RequireConsistent(Roles& roles, bool finds_displacement, bool finds_force) const {
    constexpr int kUnit = 100;
    constexpr int kWord = 1;
    const auto column_of = [](const Expression& role) { return role.terms.front().column; };
    const auto refuse = [&](std::size_t column, std::size_t other, Role role) {
      const std::span<const double> values = NumbersOf(names_, column);
      if (!IsMonotone(values) || !GoesToAndFro(NumbersOf(names_, other))) return;
      const auto last = std::find_if(values.rbegin(), values.rend(),
                                     [](double value) { return !std::isnan(value); });
      throw InputError(fmt::format(
          "{}:{}:{}: {} only {} while {} goes to and fro, as a clock or a counter does: choose the "
          "{} with {}, by name or number: {}",
          names_.table().file, names_.table().lines.front(), column + 1, names_.Label(column),
          *last > values.front() ? "grows" : "falls", names_.Label(other), RulesOf(role).name,
          RulesOf(role).option, names_.Listing()));
    };
    const std::size_t displacement = column_of(roles.displacement);
    const std::size_t force = column_of(roles.force);
    if (finds_displacement && roles.displacement.unit.empty() &&
        EvidenceFor(names_, displacement, Role::kDisplacement) < kWord) {
      refuse(displacement, force, Role::kDisplacement);
    }
    if (finds_force && roles.force.unit.empty() &&
        EvidenceFor(names_, force, Role::kForce) < kUnit) {
      refuse(force, displacement, Role::kForce);
    }
    const Kind of_displacement = KindOf(names_, roles.displacement);
    const Kind of_force = KindOf(names_, roles.force);
    const bool is_angular = of_displacement == Kind::kAngular || of_force == Kind::kAngular;
    if (is_angular && (of_displacement == Kind::kLinear || of_force == Kind::kLinear)) {
      const auto unit = [&](const Expression& role, const char* implied) {
        const std::string stated =
            role.unit.empty() ? names_.UnitOf(column_of(role), "") : role.unit;
        return stated.empty() ? std::string(implied) : stated;
      };
      throw InputError(fmt::format(
          "{}: {} in {} and {} in {} do not match: a torque needs an angle, a force a length; "
          "choose other columns, or give their units, as in --force '{} [N]'",
          names_.table().file, names_.Label(displacement), unit(roles.displacement, "rad"),
          names_.Label(force), unit(roles.force, "N m"), force + 1));
    }
    roles.is_torsional = is_angular;
  }

  const ColumnNames& names_;
  std::vector<std::string>& notes_;
  std::vector<bool> taken_;
};

}  // namespace

const RoleRules& RulesOf(Role role, bool is_torsional) {
  const auto place = static_cast<std::size_t>(role);
  return is_torsional ? kTorsionalRules.at(place) : kRules.at(place);
}

ColumnNames::ColumnNames(const CsvTable& table) : table_(table) {
  split_.reserve(table.columns.size());
  for (const TableColumn& column : table.columns) split_.push_back(SplitColumnName(column.name));
}

std::optional<std::size_t> ColumnNames::Named(std::string_view name, const RoleRules& rules) const {
  const std::string lower = LowerCase(name);
  const auto matches = [&](std::size_t column, int strictness) {
    const std::string& full = table_.columns[column].name;
    if (full.empty()) return false;
    if (strictness == 0) return full == name;
    return LowerCase(strictness == 1 ? full : split_[column].name) == lower;
  };
  for (int strictness = 0; strictness < 3; ++strictness) {
    std::vector<std::size_t> found;
    found.reserve(split_.size());
    for (std::size_t column = 0; column < split_.size(); ++column) {
      if (matches(column, strictness)) found.push_back(column);
    }
    if (found.size() > 1) ThrowAmbiguous(*this, rules, found);
    if (found.size() == 1) return found.front();
  }
  return std::nullopt;
}

std::string ColumnNames::Unknown(std::string_view name, const RoleRules& rules) const {
  std::vector<std::string> known;
  known.reserve(split_.size());
  for (const ColumnName& column : split_) known.push_back(ForMessage(column.name));
  return fmt::format("no column is called '{}' (for the {}){} {}", name, rules.name,
                     DidYouMean(name, known), Listing());
}

Expression ColumnNames::Read(const std::string& text, const RoleRules& rules) const {
  return ReadExpression(
      text, split_.size(), [&](std::string_view name) { return Named(name, rules); },
      fmt::format("{}: {} {}", table_.file, rules.option, text),
      [&](std::string_view name) { return Unknown(name, rules); });
}

std::size_t ColumnNames::Chosen(const std::string& text, const RoleRules& rules) const {
  const Expression chosen = Read(text, rules);
  if (!chosen.is_plain()) {
    throw InputError(fmt::format("{}: {} {}: must be one column", table_.file, rules.option, text));
  }
  return chosen.terms.front().column;
}

bool ColumnNames::StatesOneUnit(std::size_t column) const {
  const std::string_view of_row = WithoutBrackets(table_.columns[column].unit);
  return split_[column].unit.empty() || of_row.empty() || split_[column].unit == of_row;
}

std::string ColumnNames::UnitOf(std::size_t column, std::string_view option) const {
  const std::string of_row(WithoutBrackets(table_.columns[column].unit));
  if (!StatesOneUnit(column)) {
    throw InputError(fmt::format(
        "{}: {} has the unit '{}' in its name and '{}' below it: choose its unit{}", Header(),
        Label(column), split_[column].unit, of_row,
        option.empty()
            ? ""
            : fmt::format(" with {} '{} [{}]'", option, column + 1, split_[column].unit)));
  }
  return split_[column].unit.empty() ? of_row : split_[column].unit;
}

Dimension ColumnNames::DimensionOf(std::size_t column) const {
  if (split_[column].dimension != Dimension::kNone) return split_[column].dimension;
  return DimensionOfUnit(WithoutBrackets(table_.columns[column].unit));
}

std::string ColumnNames::NameOf(std::size_t column) const {
  const auto same = [&](const ColumnName& other) { return other.name == split_[column].name; };
  const bool is_named = !split_[column].name.empty() && std::ranges::count_if(split_, same) == 1;
  return is_named ? split_[column].name : std::to_string(column + 1);
}

std::string ColumnNames::Label(std::size_t column) const {
  const std::string& name = table_.columns[column].name;
  if (table_.header_line == 0 || name.empty()) return fmt::format("column {}", column + 1);
  return fmt::format("'{}' (column {})", ForMessage(name), column + 1);
}

std::string ColumnNames::Labels(const std::vector<std::size_t>& columns) const {
  std::string labels;
  for (const std::size_t column : columns) {
    labels += fmt::format("{}{}", labels.empty() ? "" : " and ", Label(column));
  }
  return labels;
}

std::string ColumnNames::Listing() const {
  if (std::ranges::all_of(table_.columns, [](auto& column) { return column.name.empty(); })) {
    return fmt::format("the file names none of its {} columns: choose by number", split_.size());
  }
  std::string listing = "the columns are ";
  for (std::size_t column = 0; column < split_.size(); ++column) {
    listing += fmt::format("{}'{}' ({})", column == 0 ? "" : ", ",
                           ForMessage(table_.columns[column].name), column + 1);
  }
  return listing;
}

std::string ColumnNames::Header() const {
  return fmt::format("{}:{}", table_.file, table_.header_line);
}

void ThrowAmbiguous(const ColumnNames& names, const RoleRules& rules,
                    const std::vector<std::size_t>& columns) {
  std::string choices;
  for (const std::size_t column : columns) {
    choices += fmt::format("{}{} {}", choices.empty() ? "" : " or ", rules.option, column + 1);
  }
  throw InputError(fmt::format("{}: {} may each be the {}: give {}", names.Header(),
                               names.Labels(columns), rules.name, choices));
}

Unit FindUnit(const ColumnNames& names, const RoleRules& rules, Expression& columns,
              std::vector<std::string>& notes) {
  const std::size_t first = columns.terms.front().column;
  const std::string& file = names.table().file;
  const auto throw_pressure = [&](const std::string& where, std::string_view unit) {
    throw InputError(fmt::format(
        "{}: {} is a pressure, in {}, and no {}: choose another column; pressure times area is an "
        "additional force, for which there is --covariate",
        where, names.Label(first), unit, rules.name));
  };
  if (!columns.unit.empty()) {
    if (const auto unit = rules.find_unit(columns.unit)) return *unit;
    if (IsPressureUnit(columns.unit)) throw_pressure(file, columns.unit);
    throw InputError(fmt::format("{}: the {} unit '{}' is not known: must be one of {}", file,
                                 rules.name, ForMessage(columns.unit), rules.unit_symbols()));
  }
  const std::string stated = names.UnitOf(first, rules.option);
  const std::optional<Unit> unit = rules.find_unit(stated);
  for (Expression::Term& term : columns.terms) {
    const std::string other = names.UnitOf(term.column, rules.option);
    if (other == stated) continue;
    const std::optional<Unit> of_other = rules.find_unit(other);
    if (!unit || !of_other) {
      throw InputError(fmt::format(
          "{}: {} and {} are not in units of one quantity: give the unit of "
          "the sum in brackets, as in {} '… [{}]'",
          file, names.Label(first), names.Label(term.column), rules.option, rules.si_unit));
    }
    term.weight *= of_other->ToSi(1.0) / unit->ToSi(1.0);
  }
  if (unit) return *unit;
  const Unit si{.symbol = std::string(rules.si_unit)};
  if (columns.is_scaled && !stated.empty()) return si;
  if (stated.empty()) {
    if (rules.role != Role::kTime || columns.terms.size() > 1) {
      notes.push_back(fmt::format("{}: {} {} names no unit: taken as {}; {} '{} [{}]' says so",
                                  file, rules.name, names.Label(first), rules.si_unit, rules.option,
                                  first + 1, rules.si_unit));
    }
    return si;
  }
  const std::string where = fmt::format("{}:{}", names.Header(), first + 1);
  if (IsPressureUnit(stated)) throw_pressure(where, stated);
  throw InputError(fmt::format(
      "{}: the unit '{}' of {} is not known for the {}: must be one of {}, or choose the unit with "
      "{} '{} [{}]'",
      where, ForMessage(stated), names.Label(first), rules.name, rules.unit_symbols(), rules.option,
      first + 1, rules.si_unit));
}

Roles AssignRoles(const ColumnNames& names, const RecordColumns& columns,
                  std::vector<std::string>& notes) {
  return RoleAssigner(names, notes).Assign(columns);
}

std::optional<std::size_t> FindColumnOf(const ColumnNames& names, Role role,
                                        const std::vector<bool>& taken) {
  std::optional<std::size_t> best;
  int most = 0;
  for (std::size_t column = 0; column < taken.size(); ++column) {
    if (taken[column] || !IsNumeric(names, column)) continue;
    const int evidence = EvidenceFor(names, column, role);
    if (evidence <= most) continue;
    most = evidence;
    best = column;
  }
  return best;
}

}  // namespace mindahl::io
