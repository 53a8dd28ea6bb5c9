#pragma once

#include <algorithm>
#include <cstddef>
#include <variant>
#include <vector>

#include "mindahl/models/backbone.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

namespace mindahl::models {

struct ContactStateOptions {
  double unloaded_displacement = 0.0;  ///< δ₀ [m], within ±1e100: T = 0 there
  SeriesSpring rig = {};               ///< in series; δ is then that of spring and contact
};

/// A contact that is moved step by step and keeps the memory of its friction law: for programs in
/// which the next displacement follows from this force, as in discrete elements and control.
///   T = Tc·(t₀ + span·v·sgn(e)·φ(k|e|)),  e = δ − origin of the present branch
/// as EvaluateForce of response.h, from which it differs in no bit where the compiler fuses no
/// multiplication with an addition: every change of direction is a reversal. No step size enters;
/// a step however long is exact for a motion that does not turn within it. A state is a value,
/// whose copies go on by themselves.
class ContactState {
 public:
  /// Makes the virgin contact: T = 0 at δ₀, nothing to remember.
  /// @param model  any of FrictionModels(), or another that outlives the state and its copies
  /// @param law    its α is used as it stands, also for a model that prescribes one
  /// @throws InvalidArgument for an invalid law, option or spring (as EvaluateForce)
  ContactState(const FrictionModel& model, const BranchLaw& law,
               const ContactStateOptions& options = {});

  /// Moves on to δ and returns the force there.
  /// @param displacement  δ [m], within ±1e100; the present one is no step
  /// @returns T [N]; |T| <= Tc
  /// @throws InvalidArgument, the state being left as it was, for a displacement that is NaN or out
  ///   of range, and for a branch 1e100 times stiffer than the spring
  /// Error as of EvaluateForce. Cost: 1.1 times a sample of EvaluateForce, 2 times where that is
  /// vectorised (bench/contact_state_bench.cc). Memory: 32 bytes an extreme that is remembered.
  double Move(double displacement) {
    if (!course_.HoldsTo(displacement)) Turn(displacement);
    displacement_ = displacement;
    course_.ahead = course_.direction * displacement;
    force_over_slip_ = course_.ForceAt(displacement);
    return Force();
  }

  /// Returns or throws what Move(δ) would, without moving. Costs as much as Move; but each Peek
  /// that would close n loops examines all n again.
  [[nodiscard]] double Peek(double displacement) const {
    if (course_.HoldsTo(displacement)) return Force(course_.ForceAt(displacement));
    return Force(Enter(displacement).ForceAt(displacement));
  }

  /// Returns T [N] at the present displacement.
  [[nodiscard]] double Force() const { return Force(force_over_slip_); }

  /// Returns δ [m].
  [[nodiscard]] double Displacement() const { return displacement_; }

  /// Returns dT/dδ [N/m] onward in the direction of the last motion, for a further iteration or an
  /// implicit step; σ before any. The stiffness against that direction is that of a new branch. At
  /// a corner (α = 0 at slip) that of the slipping side; infinite where Dahl's σ·2^α overflows.
  /// Error below 16 ε of the stiffness with which the branch starts, to what a change of δ by 4 ε
  /// would make. Cost: as of Move.
  [[nodiscard]] double TangentStiffness() const;

  /// Returns to the virgin contact at δ₀.
  void Reset();

  /// Extremes that are remembered: the depth of nesting.
  [[nodiscard]] std::size_t RememberedExtremes() const { return suspended_.size(); }

 private:
  using Jenkins = backbone::JenkinsShape;
  using Mindlin = backbone::MindlinShape;

  /// φ on a branch; behind a spring each branch has its own.
  struct Shape {
    std::variant<Jenkins, Mindlin, backbone::GeneralShape<double>, backbone::InSeries> kind;

    [[nodiscard]] double Force(double y) const {
      if (std::holds_alternative<Jenkins>(kind)) return Jenkins{}.Force(y);
      if (std::holds_alternative<Mindlin>(kind)) return Mindlin{}.Force(y);
      return TranscendentalForce(y);
    }
    [[nodiscard]] double TranscendentalForce(double y) const;
  };

  /// A branch as it is run in one direction s, in which sgn(e) = s.
  struct Course {
    ScaledBranch branch;
    Shape shape{};
    double direction = 0.0;  // s = ±1; 0 before any motion
    double start = 0.0;      // s·origin
    double ahead = 0.0;      // s·δ, of the present displacement
    double end = 0.0;        // s times the displacement before which the branch holds
    double rise = 0.0;       // s·height
    std::size_t open = 1;    // branches, with this one

    /// True if a displacement is neither a reversal, nor beyond the end, nor NaN.
    [[nodiscard]] bool HoldsTo(double displacement) const {
      const double there = direction * displacement;
      return there >= ahead && there < end;
    }
    /// Returns y.
    [[nodiscard]] double Reduced(double displacement) const {
      return branch.rate * (direction * displacement - start);
    }
    [[nodiscard]] double ForceAt(double displacement) const {
      return branch.force + rise * shape.Force(Reduced(displacement));
    }
  };

  [[nodiscard]] double Force(double force_over_slip) const {
    return law_.slip_force * std::clamp(force_over_slip, -1.0, 1.0);
  }

  [[nodiscard]] ScaledBranch Open(const Branch& branch, double origin_force) const;
  [[nodiscard]] Shape ShapeOn(const ScaledBranch& branch) const;
  [[nodiscard]] Course Enter(double displacement) const;
  void Turn(double displacement);

  const FrictionModel* model_;
  BranchLaw law_;
  double unloaded_displacement_;
  SeriesSpring rig_;
  Course course_;
  double displacement_ = 0.0;
  double force_over_slip_ = 0.0;
  std::vector<ScaledBranch> suspended_;  // the open branches below the present one, oldest first
};

}  // namespace mindahl::models
