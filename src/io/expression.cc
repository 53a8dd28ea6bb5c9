#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "core/text.h"
#include "io/cells.h"
#include "io/roles.h"

namespace mindahl::io {
namespace {

/// Returns the column of a number from 1.
/// @param where  it stands, for the refusal of one that there is not
std::size_t Numbered(std::size_t number, std::size_t columns, const std::string& where) {
  if (number >= 1 && number <= columns) return number - 1;
  Refuse("{}: there is no column {}: the file has {} column{}", where, number, columns,
         columns == 1 ? "" : "s");
}

/// Returns the column that is called so in a sum, by its name or by # and its number.
std::size_t ColumnInSum(std::string_view name, const ColumnNames& names, Role role,
                        const std::string& where) {
  if (name.starts_with('#')) {
    if (const auto number = NumberIn<std::size_t>(Trimmed(name.substr(1)))) {
      return Numbered(*number, names.size(), where);
    }
  }
  if (const auto column = names.Named(name, role)) return *column;
  Refuse("{}: no column is called '{}' (for the {}): {}", where, name, RulesOf(role).name,
         names.Listing());
}

/// Reads a sum of products, each of numbers and at most one column.
Quantity ReadSum(std::string_view rest, const ColumnNames& names, Role role,
                 const std::string& where) {
  constexpr std::string_view kOperators = "+-*";
  const auto require = [&](bool is_sum) {
    if (is_sum) return;
    Refuse(
        "{}: must be a sum of columns with finite factors and an offset, like raw*0.0123-4.5 [N], "
        "with #3 for the third column",
        where);
  };
  const auto take = [&](std::size_t size) { rest = Trimmed(rest.substr(size)); };
  Quantity sum{.role = role};
  do {
    double factor = 1.0;
    for (; rest.starts_with('-') || rest.starts_with('+'); take(1)) {
      if (rest.front() == '-') factor = -factor;
    }
    std::optional<std::size_t> column;
    for (;; take(1)) {
      double number = 0.0;
      const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
      auto size = static_cast<std::size_t>(stop - rest.data());
      const std::string_view after = Trimmed(rest.substr(size));
      const bool ends = after.empty() || kOperators.find(after.front()) != after.npos;
      if (error == std::errc() && size > 0 && ends) {
        factor *= number;
        sum.is_scaled = true;
      } else {
        size = std::min(rest.find_first_of(kOperators), rest.size());
        const std::string_view name = Trimmed(rest.substr(0, size));
        require(!name.empty() && !column);
        column = ColumnInSum(name, names, role, where);
      }
      take(size);
      if (!rest.starts_with('*')) break;
    }
    require(std::isfinite(factor) && (!column || factor != 0));
    if (column) {
      sum.terms.push_back({*column, factor});
    } else {
      sum.offset += factor;
    }
  } while (!rest.empty());
  require(!sum.terms.empty());
  return sum;
}

}  // namespace

Quantity ColumnNames::Read(const std::string& given, Role role) const {
  std::string_view text = Trimmed(given);
  Quantity quantity{.role = role};
  if (text.empty()) return quantity;
  const std::string where = fmt::format("{}: {} {}", table_.file, RulesOf(role).option, given);
  if (!NumberIn<std::size_t>(text)) {
    if (const auto named = Named(text, role)) {
      quantity.terms = {{*named, 1.0}};
      return quantity;
    }
  }
  std::string unit;
  if (const std::size_t open = text.rfind('['); text.ends_with(']') && open != text.npos) {
    unit = Trimmed(text.substr(open + 1, text.size() - open - 2));
    text = Trimmed(text.substr(0, open));
  }
  if (const auto number = NumberIn<std::size_t>(text)) {
    quantity.terms = {{Numbered(*number, size(), where), 1.0}};
  } else if (!text.empty()) {
    quantity = ReadSum(text, *this, role, where);
  }
  quantity.given_unit = std::move(unit);
  return quantity;
}

}  // namespace mindahl::io
