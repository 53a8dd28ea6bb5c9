#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mindahl::io {

/// Holds a quantity as a linear function of columns: the sum of weight·column, and an offset.
struct Expression {
  struct Term {
    std::size_t column;  ///< from 0
    double weight;
  };
  std::vector<Term> terms;  ///< none where only a unit is given
  double offset = -0.0;     ///< to which adding -0 makes -0
  std::string unit;         // "" where none is given
  bool is_scaled = false;   ///< a factor or an offset is given

  /// True if it is a column as it is.
  [[nodiscard]] bool is_plain() const {
    return terms.size() == 1 && !is_scaled && terms.front().weight == 1.0;
  }
};

/// Returns the column, from 0, of a name; empty where there is none.
using FindColumn = std::function<std::optional<std::size_t>(std::string_view)>;

/// Returns what is said of a name that no column has.
using DescribeUnknown = std::function<std::string(std::string_view)>;

/// Reads what an option says of a column: a name or a number from 1, "Fx", "3"; with a unit in
/// brackets, "3 [kN]", or that alone, "[kN]"; a sum of columns with factors and an offset,
/// "raw*0.0123-4.5 [N]", "cell1+cell2", "#4-#3". A text that is a name as a whole is that column;
/// in a sum, a column is called by number behind '#'.
/// @param columns  their number
/// @param where    begins every message: "a.csv: --force raw*"
/// @throws InputError
Expression ReadExpression(std::string_view text, std::size_t columns, const FindColumn& find,
                          const std::string& where, const DescribeUnknown& unknown);

}  // namespace mindahl::io
