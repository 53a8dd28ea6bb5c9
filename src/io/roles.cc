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

constexpr std::array kRules = {
    RoleRules{Role::kDisplacement, "displacement", "--displacement", "m", LengthUnit,
              LengthUnitSymbols},
    RoleRules{Role::kForce, "force", "--force", "N", ForceUnit, ForceUnitSymbols},
    RoleRules{Role::kTime, "time", "--time", "s", TimeUnit, TimeUnitSymbols},
    RoleRules{Role::kNormalLoad, "normal load", "--normal-load-column", "N", ForceUnit,
              ForceUnitSymbols},
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

/// Returns how a column's numbers behave.
ColumnNames::Column ObservedIn(std::span<const double> values) {
  constexpr double kGoodPart = 0.4;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double least = kInfinity;
  double greatest = -kInfinity;
  double rise = 0.0;
  double fall = 0.0;
  bool rises = false;
  bool falls = false;
  std::size_t holes = 0;
  double last = std::numeric_limits<double>::quiet_NaN();
  for (const double value : values) {
    if (std::isnan(value)) {
      ++holes;
      continue;
    }
    rises = rises || value > last;
    falls = falls || value < last;
    last = value;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
    rise = std::max(rise, value - least);
    fall = std::max(fall, greatest - value);
  }
  return {
      .name = {},
      .is_numeric = !values.empty() && 2 * holes <= values.size(),
      .is_constant = !rises && !falls,
      .is_monotone = rises != falls,
      .goes_to_and_fro = greatest > least && std::min(rise, fall) > kGoodPart * (greatest - least)};
}

/// Refuses columns, "'x' (column 1) and 'd' (column 2) may each be the displacement: give …".
[[noreturn]] void ThrowAmbiguous(const ColumnNames& names, const RoleRules& rules,
                                 const std::vector<std::size_t>& columns) {
  std::string choices;
  for (const std::size_t column : columns) {
    choices += fmt::format("{}{} {}", choices.empty() ? "" : " or ", rules.option, column + 1);
  }
  throw InputError(fmt::format("{}: {} may each be the {}: give {}", names.Header(),
                               names.Labels(columns), rules.name, choices));
}

/// Evidence that a column has a role: 0 is none. A unit counts more than a word.
int EvidenceFor(const ColumnNames::Column& column, Role role) {
  constexpr int kUnit = 100;
  constexpr int kWord = 50;
  constexpr int kStep = 5;       // of a rank
  constexpr int kLesser = 30;    // what is commanded or raw
  constexpr int kContrary = 60;  // a unit of the role, but a word of another
  const NameEvidence& evidence = column.name.evidence;
  const bool has_word = !evidence.word.empty();
  const bool is_named = has_word && evidence.role == role;
  // A force in newton, unless there is a better one.
  if (role == Role::kForce && evidence.word == "f n") return 1;
  // A normal load is one by its name alone.
  const bool is_load = has_word && evidence.role == Role::kNormalLoad;
  if (!is_named && (role == Role::kNormalLoad || is_load)) return 0;
  const bool is_of_unit = MayHaveRole(column.dimension, role);
  int found = 0;
  if (is_of_unit) found = has_word && !is_named ? kUnit - kContrary : kUnit;
  if (role == Role::kTime && column.is_clock && !is_of_unit) {
    found = is_named || !has_word ? kUnit - kStep : 0;
  }
  if (is_named) {
    const bool may_be = column.dimension == Dimension::kNone || is_of_unit;
    const bool is_needed = role == Role::kDisplacement || role == Role::kForce;
    const int others = std::min<int>(static_cast<int>(evidence.other_words), kStep - 1);
    found += may_be ? kWord - kStep * evidence.rank - others : is_needed ? 1 : 0;
  }
  return found > kLesser && evidence.is_lesser ? found - kLesser : found;
}

enum class Kind { kAny, kLinear, kAngular };

/// Length and force, or angle and torque, by the unit or else the name.
Kind KindOf(const ColumnNames& names, std::size_t column, std::string_view unit) {
  const Dimension dimension = unit.empty() ? names[column].dimension : DimensionOfUnit(unit);
  if (dimension == Dimension::kAngle || dimension == Dimension::kTorque) return Kind::kAngular;
  if (dimension == Dimension::kLength || dimension == Dimension::kForce) return Kind::kLinear;
  return names[column].name.evidence.is_angular ? Kind::kAngular : Kind::kAny;
}

class RoleAssigner {
 public:
  RoleAssigner(const ColumnNames& names, std::vector<std::string>& notes)
      : names_(names), notes_(notes), taken_(names.size()) {}

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
    const std::size_t displacement = roles.displacement.terms.front().column;
    const std::size_t force = roles.force.terms.front().column;
    // A word is enough for a displacement that only grows, a force needs its unit.
    if (finds_displacement && roles.displacement.unit.empty()) {
      RequireMoving(displacement, force, Role::kDisplacement, 1);
    }
    if (finds_force && roles.force.unit.empty()) {
      RequireMoving(force, displacement, Role::kForce, 100);
    }
    roles.is_torsional = RequireOneKind(roles);
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
    role.terms = {{column, 1.0}};
  }

  void TakeFound(Role role, Expression& found) {
    const std::optional<std::size_t> column = FindColumnOf(names_, role, taken_);
    if (column) return Take(*column, found);
    for (std::size_t text = 0; text < taken_.size() && role == Role::kTime; ++text) {
      const NameEvidence& evidence = names_[text].name.evidence;
      if (evidence.word.empty() || evidence.role != role || names_[text].is_numeric) continue;
      notes_.push_back(fmt::format("{}: time {} holds no numbers: left out", names_.table().file,
                                   names_.Label(text)));
    }
    if (found.unit.empty()) return;
    const RoleRules& rules = RulesOf(role);
    throw InputError(fmt::format("{}: {} [{}]: no column is recognised as the {}: name it",
                                 names_.table().file, rules.option, found.unit, rules.name));
  }

  struct Candidate {
    std::optional<std::size_t> column;
    int evidence = 0;
    Kind kind = Kind::kAny;
  };

  /// Returns the columns that may have a role: the one that is given, else those with evidence; of
  /// these, those that go to and fro, if any does. There is always one, perhaps without a column.
  std::vector<Candidate> CandidatesFor(Role role, const Expression& given) {
    if (!given.terms.empty()) {
      const std::size_t column = given.terms.front().column;
      return {{column, 0, KindOf(names_, column, given.unit)}};
    }
    std::vector<Candidate> moving;
    std::vector<Candidate> unmoved;
    std::vector<std::size_t> all;
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const int evidence = EvidenceFor(names_[column], role);
      if (taken_[column] || !names_[column].is_numeric || evidence <= 0) continue;
      all.push_back(column);
      (names_[column].goes_to_and_fro ? moving : unmoved)
          .push_back({column, evidence, KindOf(names_, column, given.unit)});
    }
    if (all.empty()) return {Candidate{}};
    if (moving.empty()) return unmoved;
    const auto most = [](const std::vector<Candidate>& of) {
      return of.empty() ? 0 : std::ranges::max(of, {}, &Candidate::evidence).evidence;
    };
    if (most(unmoved) >= most(moving)) {
      notes_.push_back(fmt::format("{}: {} may each be the {}: one that goes to and fro is taken",
                                   names_.table().file, names_.Labels(all), RulesOf(role).name));
    }
    return moving;
  }

  /// Takes the displacement and the force of the most evidence that go together.
  void FindPair(Roles& roles) {
    constexpr int kMismatch = 40;
    const auto displacements = CandidatesFor(Role::kDisplacement, roles.displacement);
    const auto forces = CandidatesFor(Role::kForce, roles.force);
    int most = std::numeric_limits<int>::min();
    std::vector<std::pair<std::optional<std::size_t>, std::optional<std::size_t>>> best;
    for (const Candidate& x : displacements) {
      for (const Candidate& f : forces) {
        if (x.column && x.column == f.column) continue;
        const bool differs = x.kind != f.kind && x.kind != Kind::kAny && f.kind != Kind::kAny;
        const int evidence = x.evidence + f.evidence - (differs ? kMismatch : 0);
        if (evidence < most) continue;
        if (evidence > most) best.clear();
        most = evidence;
        best.emplace_back(x.column, f.column);
      }
    }
    if (best.empty()) best = {{displacements.front().column, std::nullopt}};
    for (const Role role : {Role::kDisplacement, Role::kForce}) {
      std::vector<std::size_t> columns;
      for (const auto& [displacement, force] : best) {
        const auto& column = role == Role::kForce ? force : displacement;
        if (column && std::ranges::find(columns, *column) == columns.end()) {
          columns.push_back(*column);
        }
      }
      Expression& taken = role == Role::kForce ? roles.force : roles.displacement;
      if (!taken.terms.empty() || columns.empty()) continue;
      if (columns.size() > 1) ThrowAmbiguous(names_, RulesOf(role), columns);
      Take(columns.front(), taken);
    }
  }

  /// Gives what no name or unit decides to the columns that are left, if they are as many.
  void TakeLeft(Roles& roles) {
    std::vector<std::pair<Role, Expression*>> missing;
    if (roles.displacement.terms.empty()) {
      missing.emplace_back(Role::kDisplacement, &roles.displacement);
    }
    if (roles.force.terms.empty()) missing.emplace_back(Role::kForce, &roles.force);
    if (missing.empty()) return;
    std::vector<std::size_t> left;
    for (std::size_t column = 0; column < taken_.size(); ++column) {
      const ColumnNames::Column& of = names_[column];
      const bool is_unknown = of.dimension == Dimension::kNone && of.name.evidence.word.empty();
      if (!taken_[column] && is_unknown && !of.is_clock && of.is_numeric) left.push_back(column);
    }
    std::string why;
    if (left.size() > missing.size()) {
      std::erase_if(left, [&](std::size_t column) {
        return names_[column].is_constant || names_[column].is_monotone;
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
    for (std::size_t column = 0; column < names_.size(); ++column) {
      if (EvidenceFor(names_[column], role) <= 0 || names_[column].is_numeric) continue;
      const TableColumn& of = names_.table().columns[column];
      if (!of.values.empty() && !of.fault.empty()) throw InputError(of.fault);
      throw InputError(fmt::format(
          "{}: {} holds no numbers: the {} needs one in every row, or name another column with {}",
          names_.table().file, names_.Label(column), rules.name, rules.option));
    }
    throw InputError(fmt::format(
        "{}: no column for the {}: {}", names_.table().file, rules.name,
        names_.size() == 1
            ? "the file has 1 column"
            : fmt::format("{}: name the column of the displacement with --displacement and "
                          "that of the force with --force, by name or number",
                          names_.Listing())));
  }

  /// Refuses a column of little evidence whose numbers are those of a clock or a counter.
  /// @param other  goes to and fro
  void RequireMoving(std::size_t column, std::size_t other, Role role, int least_evidence) const {
    if (EvidenceFor(names_[column], role) >= least_evidence || !names_[column].is_monotone ||
        !names_[other].goes_to_and_fro) {
      return;
    }
    const std::vector<double>& values = names_.table().columns[column].values;
    const auto last = std::find_if(values.rbegin(), values.rend(),
                                   [](double value) { return !std::isnan(value); });
    throw InputError(fmt::format(
        "{}:{}:{}: {} only {} while {} goes to and fro, as a clock or a counter does: choose the "
        "{} with {}, by name or number: {}",
        names_.table().file, names_.table().lines.front(), column + 1, names_.Label(column),
        *last > values.front() ? "grows" : "falls", names_.Label(other), RulesOf(role).name,
        RulesOf(role).option, names_.Listing()));
  }

  /// @returns true for an angle and a torque
  bool RequireOneKind(const Roles& roles) const {
    const std::size_t displacement = roles.displacement.terms.front().column;
    const std::size_t force = roles.force.terms.front().column;
    const Kind of_displacement = KindOf(names_, displacement, roles.displacement.unit);
    const Kind of_force = KindOf(names_, force, roles.force.unit);
    const bool is_angular = of_displacement == Kind::kAngular || of_force == Kind::kAngular;
    if (!is_angular || (of_displacement != Kind::kLinear && of_force != Kind::kLinear)) {
      return is_angular;
    }
    const auto unit = [&](const Expression& role, const char* implied) {
      const std::string stated =
          role.unit.empty() ? names_.UnitOf(role.terms.front().column, "") : role.unit;
      return stated.empty() ? std::string(implied) : stated;
    };
    throw InputError(fmt::format(
        "{}: {} in {} and {} in {} do not match: a torque needs an angle, a force a length; "
        "choose other columns, or give their units, as in --force '{} [N]'",
        names_.table().file, names_.Label(displacement), unit(roles.displacement, "rad"),
        names_.Label(force), unit(roles.force, "N m"), force + 1));
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
  columns_.reserve(table.columns.size());
  for (const TableColumn& column : table.columns) {
    columns_.push_back(ObservedIn(column.values));
    Column& added = columns_.back();
    added.name = SplitColumnName(column.name);
    added.dimension = DimensionOfUnit(added.name.unit.empty() ? WithoutBrackets(column.unit)
                                                              : std::string_view(added.name.unit));
    added.is_clock = column.is_clock;
  }
}

std::optional<std::size_t> ColumnNames::Named(std::string_view name, const RoleRules& rules) const {
  const std::string lower = LowerCase(name);
  const auto matches = [&](std::size_t column, int strictness) {
    const std::string& full = table_.columns[column].name;
    if (full.empty()) return false;
    if (strictness == 0) return full == name;
    return LowerCase(strictness == 1 ? full : columns_[column].name.name) == lower;
  };
  for (int strictness = 0; strictness < 3; ++strictness) {
    std::vector<std::size_t> found;
    found.reserve(size());
    for (std::size_t column = 0; column < size(); ++column) {
      if (matches(column, strictness)) found.push_back(column);
    }
    if (found.size() > 1) ThrowAmbiguous(*this, rules, found);
    if (found.size() == 1) return found.front();
  }
  return std::nullopt;
}

Expression ColumnNames::Read(const std::string& text, const RoleRules& rules) const {
  const auto unknown = [&](std::string_view name) {
    std::vector<std::string> known;
    known.reserve(size());
    for (const Column& column : columns_) known.push_back(ForMessage(column.name.name));
    return fmt::format("no column is called '{}' (for the {}){} {}", name, rules.name,
                       DidYouMean(name, known), Listing());
  };
  return ReadExpression(
      text, size(), [&](std::string_view name) { return Named(name, rules); },
      fmt::format("{}: {} {}", table_.file, rules.option, text), unknown);
}

std::size_t ColumnNames::Chosen(const std::string& text, const RoleRules& rules) const {
  const Expression chosen = Read(text, rules);
  if (!chosen.is_plain()) {
    throw InputError(fmt::format("{}: {} {}: must be one column", table_.file, rules.option, text));
  }
  return chosen.terms.front().column;
}

bool ColumnNames::StatesOneUnit(std::size_t column) const {
  const std::string& unit = columns_[column].name.unit;
  const std::string_view of_row = WithoutBrackets(table_.columns[column].unit);
  return unit.empty() || of_row.empty() || unit == of_row;
}

std::string ColumnNames::UnitOf(std::size_t column, std::string_view option) const {
  const std::string& unit = columns_[column].name.unit;
  const std::string of_row(WithoutBrackets(table_.columns[column].unit));
  if (StatesOneUnit(column)) return unit.empty() ? of_row : unit;
  throw InputError(fmt::format(
      "{}: {} has the unit '{}' in its name and '{}' below it: choose its unit{}", Header(),
      Label(column), unit, of_row,
      option.empty() ? "" : fmt::format(" with {} '{} [{}]'", option, column + 1, unit)));
}

std::string ColumnNames::NameOf(std::size_t column) const {
  const std::string& name = columns_[column].name.name;
  const auto same = [&](const Column& other) { return other.name.name == name; };
  return !name.empty() && std::ranges::count_if(columns_, same) == 1 ? name
                                                                     : std::to_string(column + 1);
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
    return fmt::format("the file names none of its {} columns: choose by number", size());
  }
  std::string listing;
  for (std::size_t column = 0; column < size(); ++column) {
    listing += fmt::format("{}'{}' ({})", column == 0 ? "the columns are " : ", ",
                           ForMessage(table_.columns[column].name), column + 1);
  }
  return listing;
}

std::string ColumnNames::Header() const {
  return fmt::format("{}:{}", table_.file, table_.header_line);
}

Unit FindUnit(const ColumnNames& names, const RoleRules& rules, const Expression& columns,
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
  for (const Expression::Term& term : columns.terms) {
    if (names.UnitOf(term.column, rules.option) == stated) continue;
    throw InputError(fmt::format(
        "{}: {} and {} are not in one unit: scale them, and give the unit of the sum in brackets, "
        "as "
        "in {} '… [{}]'",
        file, names.Label(first), names.Label(term.column), rules.option, rules.si_unit));
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
    if (taken[column] || !names[column].is_numeric) continue;
    const int evidence = EvidenceFor(names[column], role);
    if (evidence <= most) continue;
    most = evidence;
    best = column;
  }
  return best;
}

}  // namespace mindahl::io
