#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace mindahl::loop {

/// Another quantity that was recorded, in a unit of its own.
struct Covariate {
  std::string name{};            ///< header of its column, or the column's number
  std::string unit{};            ///< unit in the file; empty where it has none
  std::vector<double> values{};  ///< one a sample
};

/// A measured or simulated hysteresis record in SI units, one entry a sample, in order of time.
struct Record {
  std::vector<double> displacement{};      ///< tangential displacement δ [m]
  std::vector<double> force{};             ///< tangential force T [N]
  std::vector<double> time{};              ///< [s]; empty when not recorded
  std::vector<double> normal_load{};       ///< N [N]; empty when not recorded
  std::vector<Covariate> covariates = {};  ///< other columns; may be empty

  [[nodiscard]] std::size_t size() const { return displacement.size(); }
};

/// The columns that a record may have, covariates aside.
inline constexpr std::array kRecordColumns = {&Record::displacement, &Record::force, &Record::time,
                                              &Record::normal_load};

/// A record somewhere in memory: what every stage takes. Columns as in Record.
struct RecordView {
  std::span<const double> displacement{};
  std::span<const double> force{};
  std::span<const double> time{};
  std::span<const double> normal_load{};
  std::span<const Covariate> covariates{};

  RecordView() = default;
  /// Views arrays of one size each; empty where not recorded.
  RecordView(std::span<const double> displacement_column, std::span<const double> force_column,
             std::span<const double> time_column = {},
             std::span<const double> normal_load_column = {})
      : displacement(displacement_column),
        force(force_column),
        time(time_column),
        normal_load(normal_load_column) {}
  /// Views a record, which must outlive the view.
  RecordView(const Record& record)  // NOLINT(google-explicit-constructor): every Record is one
      : RecordView(record.displacement, record.force, record.time, record.normal_load) {
    covariates = record.covariates;
  }

  [[nodiscard]] std::size_t size() const { return displacement.size(); }
};

/// @throws InvalidArgument when the lengths differ or a value is not finite (names the row).
void Validate(const RecordView& record);

/// One of the two channels of a loop.
enum class Channel { kDisplacement, kForce };

/// Returns the channel that responds where the other is imposed.
[[nodiscard]] constexpr Channel Other(Channel channel) {
  return channel == Channel::kForce ? Channel::kDisplacement : Channel::kForce;
}

}  // namespace mindahl::loop
