#pragma once

#include <cstddef>
#include <variant>
#include <vector>

#include "mindahl/models/backbone.h"
#include "mindahl/models/load_zone.h"
#include "mindahl/models/variable_load.h"

namespace mindahl::models {

/// The contact before its first step: T = 0.
struct InitialLoading {
  double normal_load = 0.0;            ///< N₀ [N], finite, >= 0; 0 for bodies yet to touch
  double unloaded_displacement = 0.0;  ///< δ₀ [m], within ±1e307
};

/// A contact under a varying normal load that is moved step by step: the law of
/// EvaluateForceUnderLoad, which is a loop over Move, for loops in which the next displacement and
/// load follow from this force.
///
/// Exact for steps that are straight in (δ, δc(N)): variable_load.h and docs/theory.md §11 say what
/// it solves. A state is a value. Copies go on by themselves, and an assignment to a state that is
/// there reuses its memory; Peek tries a step without either.
class LoadedContactState {
 public:
  /// @throws InvalidArgument for an invalid law, load or displacement
  explicit LoadedContactState(const LoadDependentLaw& law, const InitialLoading& initial = {});

  /// Moves on to δ and N and returns the force there. At N = 0 the contact is lifted off: T = 0,
  /// and nothing is remembered.
  /// @param displacement  δ [m], within ±1e307
  /// @param normal_load   N [N], finite, >= 0
  /// @returns T [N]; |T| <= μN
  /// @throws InvalidArgument, the state being left as it was, for a displacement or a load out of
  ///   range
  /// Error as of EvaluateForceUnderLoad. Cost: amortised one branch law and, where N changes, one
  /// power. Memory: 40 bytes a remembered zone, and nothing else is allocated. At constant N zones
  /// are as many as the nesting is deep; each step on which N rises without slip may add one, until
  /// slip or a falling load covers it.
  double Move(double displacement, double normal_load);

  /// Returns or throws what Move(δ, N) would, without moving.
  [[nodiscard]] double Peek(double displacement, double normal_load) const;

  /// Returns T [N] after the last step.
  [[nodiscard]] double Force() const { return force_; }

  /// Returns δ [m].
  [[nodiscard]] double Displacement() const { return displacement_; }

  /// Returns N [N].
  [[nodiscard]] double NormalLoad() const { return rim_.normal_load; }

  /// Returns to the contact before its first step; keeps the memory that was reserved.
  void Reset();

  /// Makes room for so many zones, after which Move allocates nothing before they are more.
  void Reserve(std::size_t zones) { zones_.reserve(zones); }

  /// Zones that are remembered.
  [[nodiscard]] std::size_t RememberedZones() const { return zones_.size(); }

 private:
  using Zone = LoadZone<double>;

  /// The rim under a load.
  struct Rim {
    double normal_load = 0.0;
    LoadRim<double> at;
  };

  class TrialZones;

  [[nodiscard]] Rim RimUnder(double normal_load) const;
  template <typename Zones>
  [[nodiscard]] double StepTo(Zones& zones, const Rim& rim, double displacement) const;

  LoadDependentLaw law_;
  InitialLoading initial_;
  double reference_slip_displacement_;
  std::variant<backbone::JenkinsShape<double>, backbone::MindlinShape<double>,
               backbone::GeneralShape<double>>
      shape_;
  /// Cover 0 <= h < δc, innermost first; the elements at the rim carry nothing, so that δ need not
  /// be kept with them.
  std::vector<Zone> zones_;
  Rim rim_;
  double displacement_ = 0.0;
  double force_ = 0.0;
};

}  // namespace mindahl::models
