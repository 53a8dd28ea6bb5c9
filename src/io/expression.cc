#include <fmt/format.h>

#include <cmath>
#include <system_error>
#include <utility>

#include "core/from_chars.h"
#include "core/nearest_name.h"
#include "io/cells.h"
#include "io/roles.h"

namespace mindahl::io {
namespace {

constexpr std::string_view kOperators = "+-*";

/// Returns the column of a number from 1.
/// @param where  it stands, for the refusal of one that there is not
std::size_t Numbered(std::size_t number, std::size_t columns, const std::string& where) {
  if (number >= 1 && number <= columns) return number - 1;
  Refuse("{}: there is no column {}: the file has {} column{}", where, number, columns,
         columns == 1 ? "" : "s");
}

/// Reads a sum of products, each of numbers and at most one column.
class ExpressionReader {
 public:
  ExpressionReader(std::string_view text, const ColumnNames& names, Role role, std::string where)
      : rest_(text), names_(names), role_(role), where_(std::move(where)) {}

  Quantity Read() {
    Quantity sum{.role = role_};
    do {
      double factor = 1.0;
      for (; rest_.starts_with('-') || rest_.starts_with('+'); Take(1)) {
        if (rest_.front() == '-') factor = -factor;
      }
      std::optional<std::size_t> column;
      for (;; Take(1)) {
        if (const auto found = TakeColumn()) {
          if (column) ThrowNoSum();
          column = found;
        } else {
          factor *= TakeNumber();
          sum.is_scaled = true;
        }
        if (!rest_.starts_with('*')) break;
      }
      if (!std::isfinite(factor) || (column && factor == 0)) ThrowNoSum();
      if (column) {
        sum.terms.push_back({*column, factor});
      } else {
        sum.offset += factor;
      }
    } while (!rest_.empty());
    if (sum.terms.empty()) ThrowNoSum();
    return sum;
  }

 private:
  [[noreturn]] void ThrowNoSum() const {
    Refuse(
        "{}: must be a sum of columns with finite factors and an offset, like raw*0.0123-4.5 [N], "
        "with #3 for the third column",
        where_);
  }
  void Take(std::size_t size) { rest_ = Trimmed(rest_.substr(size)); }

  /// Takes the name before the next operator, or # and a number.
  std::optional<std::size_t> TakeColumn() {
    const std::size_t end = std::min(rest_.find_first_of(kOperators), rest_.size());
    const std::string_view name = Trimmed(rest_.substr(0, end));
    const auto number =
        name.starts_with('#') ? NumberIn<std::size_t>(Trimmed(name.substr(1))) : std::nullopt;
    const auto column = number ? std::optional(Numbered(*number, names_.size(), where_))
                               : names_.Named(name, role_);
    if (column) Take(end);
    return column;
  }

  double TakeNumber() {
    double value = 0.0;
    const auto [stop, error] = FromChars(rest_.data(), rest_.data() + rest_.size(), value);
    const auto size = static_cast<std::size_t>(stop - rest_.data());
    const std::string_view after = Trimmed(rest_.substr(size));
    const bool ends = after.empty() || kOperators.find(after.front()) != std::string_view::npos;
    if (error != std::errc() || size == 0 || !std::isfinite(value) || !ends) {
      const std::string_view name = Trimmed(rest_.substr(0, rest_.find_first_of(kOperators)));
      if (name.empty()) ThrowNoSum();
      std::vector<std::string> known;
      known.reserve(names_.size());
      for (std::size_t column = 0; column < names_.size(); ++column) {
        known.push_back(ForMessage(names_[column].name));
      }
      Refuse("{}: no column is called '{}' (for the {}){} {}", where_, name, RulesOf(role_).name,
             DidYouMean(name, known), names_.Listing());
    }
    Take(size);
    return value;
  }

  std::string_view rest_;
  const ColumnNames& names_;
  Role role_;
  std::string where_;
};

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
    quantity = ExpressionReader(text, *this, role, where).Read();
  }
  quantity.given_unit = std::move(unit);
  return quantity;
}

}  // namespace mindahl::io
