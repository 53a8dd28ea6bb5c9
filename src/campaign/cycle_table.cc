#include "mindahl/campaign/cycle_table.h"

#include <fmt/compile.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <charconv>
#include <iterator>
#include <optional>
#include <system_error>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/report/units.h"

namespace mindahl::campaign {
namespace {

using OptionalNumber = std::optional<double>;

constexpr std::array kNumbers = {
    CycleNumber{"start_time", "s", [](CycleFit& fit) -> OptionalNumber& { return fit.start_time; }},
    CycleNumber{"amplitude", "m", [](CycleFit& fit) -> OptionalNumber& { return fit.amplitude; }},
    CycleNumber{"peak_force", "N", [](CycleFit& fit) -> OptionalNumber& { return fit.peak_force; }},
    CycleNumber{"sliding_amplitude", "m",
                [](CycleFit& fit) -> OptionalNumber& { return fit.sliding_amplitude; }},
    CycleNumber{"half_gap", "N", [](CycleFit& fit) -> OptionalNumber& { return fit.half_gap; }},
    CycleNumber{"energy", "J", [](CycleFit& fit) -> OptionalNumber& { return fit.energy; }},
    CycleNumber{"energy_ratio", "",
                [](CycleFit& fit) -> OptionalNumber& { return fit.energy_ratio; }},
    CycleNumber{"energy_friction_coefficient", "",
                [](CycleFit& fit) -> OptionalNumber& { return fit.energy_friction_coefficient; }},
    CycleNumber{"slope_after_reversal", "N/m",
                [](CycleFit& fit) -> OptionalNumber& { return fit.slope_after_reversal; }},
    CycleNumber{"normal_load", "N",
                [](CycleFit& fit) -> OptionalNumber& { return fit.normal_load; }},
    CycleNumber{"sigma", "N/m", [](CycleFit& fit) -> OptionalNumber& { return fit.sigma.value; }},
    CycleNumber{"sigma_error", "N/m",
                [](CycleFit& fit) -> OptionalNumber& { return fit.sigma.standard_error; }},
    CycleNumber{"alpha", "", [](CycleFit& fit) -> OptionalNumber& { return fit.alpha.value; }},
    CycleNumber{"alpha_error", "",
                [](CycleFit& fit) -> OptionalNumber& { return fit.alpha.standard_error; }},
    CycleNumber{"slip_force", "N",
                [](CycleFit& fit) -> OptionalNumber& { return fit.slip_force.value; }},
    CycleNumber{"slip_force_error", "N",
                [](CycleFit& fit) -> OptionalNumber& { return fit.slip_force.standard_error; }},
    CycleNumber{"force_offset", "N",
                [](CycleFit& fit) -> OptionalNumber& { return fit.force_offset.value; }},
    CycleNumber{"force_offset_error", "N",
                [](CycleFit& fit) -> OptionalNumber& { return fit.force_offset.standard_error; }},
    CycleNumber{"rms", "N", [](CycleFit& fit) -> OptionalNumber& { return fit.rms; }},
    CycleNumber{"friction_coefficient", "",
                [](CycleFit& fit) -> OptionalNumber& { return fit.friction_coefficient; }},
};

constexpr std::string_view kPartial = "partial";
constexpr std::string_view kGross = "gross";

// cycle, first_line, samples; the numbers; slip_regime, accumulated_energy, flags, checksum.
constexpr std::size_t kColumns = 3 + kNumbers.size() + 4;

std::vector<std::string_view> CellsOf(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

template <typename Value>
Value CellValue(std::string_view cell) {
  Value value{};
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size()) {
    throw InputError(fmt::format("'{}' is not a number", cell));
  }
  return value;
}

}  // namespace

std::span<const CycleNumber> CycleNumbers() { return kNumbers; }

std::string CycleTableHeader(bool is_torsional) {
  const report::Units& units = is_torsional ? report::kUnitsOfTorque : report::kUnitsOfForce;
  std::string header = "cycle,first_line,samples";
  for (const CycleNumber& column : kNumbers) {
    header += fmt::format(",{}", column.name);
    if (!column.unit.empty()) header += fmt::format(" [{}]", report::UnitIn(units, column.unit));
  }
  return header + ",slip_regime,accumulated_energy [J],flags,checksum\n";
}

std::string CycleTableRow(const CycleFit& fit, double accumulated_energy) {
  CycleFit values = fit;
  fmt::memory_buffer row;
  const auto end = std::back_inserter(row);
  fmt::format_to(end, "{},{},{}", fit.number, fit.first_line, fit.samples);
  for (const CycleNumber& column : kNumbers) {
    row.push_back(',');
    if (const OptionalNumber& number = column.of(values))
      fmt::format_to(end, FMT_COMPILE("{}"), *number);
  }
  const std::string_view regime = !fit.slips_grossly ? "" : *fit.slips_grossly ? kGross : kPartial;
  fmt::format_to(end, ",{},{},{},{:016x}\n", regime, accumulated_energy, fmt::join(fit.flags, " "),
                 fit.checksum);
  return fmt::to_string(row);
}

CycleTableEntry ReadCycleTableRow(std::string_view line) {
  const std::vector<std::string_view> cells = CellsOf(line);
  if (cells.size() != kColumns) {
    throw InputError(fmt::format("has {} cells of {}", cells.size(), kColumns));
  }
  CycleTableEntry entry;
  entry.fit.number = CellValue<std::size_t>(cells[0]);
  entry.fit.first_line = CellValue<std::size_t>(cells[1]);
  entry.fit.samples = CellValue<std::size_t>(cells[2]);
  for (std::size_t k = 0; k < kNumbers.size(); ++k) {
    if (!cells[3 + k].empty()) kNumbers[k].of(entry.fit) = CellValue<double>(cells[3 + k]);
  }
  const std::string_view regime = cells[kColumns - 4];
  if (!regime.empty()) entry.fit.slips_grossly = regime == kGross;
  entry.accumulated_energy = CellValue<double>(cells[kColumns - 3]);
  std::string_view flags = cells[kColumns - 2];
  while (!flags.empty()) {
    const std::size_t blank = std::min(flags.find(' '), flags.size());
    entry.fit.flags.emplace_back(flags.substr(0, blank));
    flags.remove_prefix(std::min(blank + 1, flags.size()));
  }
  const std::string_view checksum = cells[kColumns - 1];
  const auto [end, error] =
      std::from_chars(checksum.data(), checksum.data() + checksum.size(), entry.fit.checksum, 16);
  if (error != std::errc() || end != checksum.data() + checksum.size()) {
    throw InputError(fmt::format("'{}' is no checksum", checksum));
  }
  return entry;
}

}  // namespace mindahl::campaign
