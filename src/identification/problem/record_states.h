#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "mindahl/models/loading_path.h"

namespace mindahl::identification {

/// The initial state of each record of a fit: the same of all, or one a record. Of one state for
/// all nothing is allocated.
class RecordStates {
 public:
  RecordStates(models::InitialState all) : all_(all) {}
  /// @param of_records  not empty
  explicit RecordStates(std::vector<models::InitialState> of_records)
      : all_(of_records.front()), of_records_(std::move(of_records)) {
    if (std::ranges::count(of_records_, all_) == std::ranges::ssize(of_records_)) {
      of_records_.clear();
    }
  }

  [[nodiscard]] models::InitialState Of(std::size_t record) const {
    return of_records_.empty() ? all_ : of_records_[record];
  }
  [[nodiscard]] bool AreAll(models::InitialState state) const {
    return of_records_.empty() && all_ == state;
  }
  [[nodiscard]] bool Any(models::InitialState state) const {
    return of_records_.empty() ? all_ == state : true;  // both are among states that differ
  }
  friend bool operator==(const RecordStates&, const RecordStates&) = default;

 private:
  models::InitialState all_;
  std::vector<models::InitialState> of_records_;  // empty where they are all the same
};

}  // namespace mindahl::identification
