#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/contact_options.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::cli {

/// --model auto
inline constexpr std::string_view kAutomatic = "auto";

/// What the options of `fit` say of records, model and contact, as it was typed: the same for every
/// command that fits.
struct FitRequest {
  std::vector<std::string> files;
  io::RecordColumns columns;
  std::string time_window;
  std::string model = "mindlin-dahl";
  std::string initial_state = "auto";
  std::string force_sign = "auto";
  std::string offsets = "on";
  std::map<std::string_view, std::string> terms;  // what was asked of each, by its name
  std::vector<std::string> covariates;
  std::string load_window;
  std::string cycles;
  std::string samples;
  std::size_t skip_cycles = 0;
  std::string loss = "none";
  std::size_t starts = identification::FitOptions{}.starts;
  std::uint64_t seed = identification::FitOptions{}.seed;
  std::vector<std::string> fix;
  std::vector<std::string> start;
  std::vector<std::string> bound;
  std::optional<double> force_noise;
  std::optional<double> displacement_noise;
  std::optional<double> reversal_gate;
  ContactOptions contact;
};

/// Adds them to a command.
void AddFitOptions(CLI::App& command, FitRequest& request, NormalLoads loads);

/// Of these, which columns there are, and in what unit.
void AddColumnOptions(CLI::App& command, FitRequest& request);
/// And what is fitted to them.
void AddModelOptions(CLI::App& command, FitRequest& request);

/// @throws InputError naming the option that breaks a rule, or two that contradict each other
identification::FitOptions MakeFitOptions(const FitRequest& request);

/// The columns that are covariates, as the reader takes them.
std::vector<std::string> CovariateColumns(const FitRequest& request);

/// [s]; empty where every time counts
std::optional<identification::Interval> TimeWindow(const FitRequest& request);

}  // namespace mindahl::cli
