#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace mindahl::report {

/// A value of a report, which may be a list or have members. What is missing says why.
struct Value {
  /// Not there at all: has no key.
  struct Absent {};
  /// Could not be computed.
  struct Null {
    std::string why;
  };
  struct Member;
  using Array = std::vector<Value>;
  using Object = std::vector<Member>;

  std::variant<Absent, Null, bool, std::int64_t, std::uint64_t, double, std::string, Array, Object>
      content;
};

struct Value::Member {
  std::string key;
  Value value;
};

// A number that is missing or not finite is a null, for which the row of the table has the reason.
[[nodiscard]] Value Number(std::optional<double> number);
[[nodiscard]] Value Count(std::size_t count);
[[nodiscard]] Value Integer(int number);
[[nodiscard]] Value Flag(bool flag);
[[nodiscard]] Value Text(std::string_view text);
[[nodiscard]] Value Missing(std::string why = {});

/// Puts a value where a path leads, making the members and lists on the way:
/// "parameters.alpha.ci95[1]". The places of a list are filled in their order.
void Place(Value::Object& object, std::string_view path, Value value);

/// A null of a report.
struct NullPlace {
  std::string path;
  std::string why;
};

/// Returns every null, in order.
[[nodiscard]] std::vector<NullPlace> CollectNulls(const Value::Object& object);

}  // namespace mindahl::report
