#pragma once

#include <optional>
#include <vector>

#include "identification/problem/scaled_records.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/terms.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"

/// The motion of a contact: where it turns, and where it is elsewhere than the displacement at the
/// time of the force: T_file(t) = T(δ(t − lag)) of a force that is read late, and behind a gap.
namespace mindahl::identification {

/// Returns where the motion of a record turns: at its outermost samples, or between samples where
/// the record is said to (ScaledRecord::turns_between) and five samples show a turn: of a smooth
/// motion at the extremum of the polynomial through them, of a sharp one where its lines meet.
std::vector<models::Turn> TurnsOf(const ScaledRecord& record);

/// Lets records turn between samples, but for those of an imposed force or of readings with noise.
/// @returns how far beyond a sample any turns [half range]
double TurnBetweenSamples(ScaledRecords& data);

/// Returns the longest lag that is looked for, either way [mean cycles]: ten samples, as the delay
/// of a filter is one of samples, but at least 0.05 and at most 0.2.
double LongestLag(std::size_t samples, std::size_t reversals);

/// Makes samples whose displacement lies beyond the record's ends under any lag that the options
/// allow not count; they still make history.
/// @throws InvalidArgument where nothing is left of a record, or only some have a time that goes on
void LeaveOutBeyondLags(const FitOptions& options, loop::PreparedRecords& records);

/// A path of a contact along its record.
struct ContactPath {
  std::vector<double> displacement;  // of every sample; empty: that of the record
  models::LoadingPath path;
};

/// Locates the contact of a record. A gap has two sides, with a path each:
///   T = max(F(δ − g/2), 0) + min(F(δ + g/2), 0)
/// first that which bears forces above zero, then that which bears those below.
struct Motion {
  double amount = 0.0;  // by which it is moved
  models::InitialContact initial;
  std::vector<ContactPath> paths;
};

/// Locates a contact; reuses the memory of `motion`.
/// @param turns     of the record's motion; of a lag those of the whole record
/// @param moved_by  the lag or the backlash; empty where the contact is at the displacement
/// @param amount    a lag in the record's scaled time, or the width of a gap
void Locate(const ScaledRecord& record, std::span<const models::Turn> turns,
            std::optional<TermId> moved_by, double amount, models::Memory memory,
            const models::InitialContact& initial, Motion& motion);

}  // namespace mindahl::identification
