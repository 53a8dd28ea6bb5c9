#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/convert/conversion.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::request {

/// Laws that a conversion may start from.
inline constexpr std::array<std::string_view, 2> kLawsToConvert = {"masing", "dahl"};

/// Holds the law to convert and its target: docs/contract.md, `mindahl convert`.
struct ConversionRequest {
  models::BranchLaw law;
  std::string from = "masing";  ///< one of kLawsToConvert
  std::string to;               ///< name of one of convert::Targets()
  convert::ConversionOptions options;
  std::optional<double> least_amplitude;    ///< [m]; with the other, the options' range
  std::optional<double> largest_amplitude;  ///< [m]
  convert::NormalContact normal;
};

struct ConvertedContact {
  ConversionRequest request;
  convert::TargetRow target;
  convert::Conversion conversion = {};
  std::vector<convert::Parameter> parameters = {};
};

/// Converts a contact's steady loop to another law or program.
/// @throws InputError or InvalidArgument naming the option
ConvertedContact MakeConversion(const ConversionRequest& request);

/// Returns the JSON of schema mindahl.convert/1, as `mindahl convert --json` writes it.
std::string ToJson(const ConvertedContact& converted);

/// Returns the text that `mindahl convert` prints.
std::string ToText(const ConvertedContact& converted);

/// Returns the lines that the target reads.
/// @throws InputError for a discrete-element code without a normal load
std::vector<std::string> InputLines(const ConvertedContact& converted);

}  // namespace mindahl::request
