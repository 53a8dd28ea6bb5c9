#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/convert/conversion.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::request {

/// Holds the law to convert and its target: docs/contract.md, `mindahl convert`.
struct ConversionRequest {
  std::string fit = {};  ///< file of `mindahl fit --json`: law and amplitude, unless given
  std::optional<double> sigma = {};       ///< [N/m]
  std::optional<double> alpha = {};       ///< [-]; default 1/3
  std::optional<double> slip_force = {};  ///< [N]
  std::optional<double> amplitude = {};   ///< X [m] of the contact's steady loop
  std::string from = {};                  ///< "masing", "dahl" or "": that of the fit, else masing
  std::string to = {};                    ///< name of one of convert::Targets()
  convert::ConversionOptions options = {};
  convert::NormalContact normal = {};
};

/// A contact written for a target; of the request law and amplitude are known.
struct ConvertedContact {
  models::BranchLaw law;
  std::string from;
  convert::TargetRow target;
  convert::ConversionOptions options = {};
  convert::NormalContact normal = {};
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

/// Returns the lines that the target reads, with the error at the amplitude as a comment where it
/// has comments.
/// @throws InputError for a discrete-element code without a normal load
std::vector<std::string> InputLines(const ConvertedContact& converted);

}  // namespace mindahl::request
