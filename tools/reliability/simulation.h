#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/draws.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/excitation.h"
#include "truth.h"

/// What the kinds of corruption are made from: motions, forces of contacts, and noise.
namespace mindahl::reliability {

/// What a test does to the contact, from rest at 0.
struct Motion {
  std::vector<double> time;          ///< [s]
  std::vector<double> displacement;  ///< [m]
  std::size_t unseen = 0;            ///< samples before the record begins
};

/// Force [N] along a displacement [m] that begins with the contact unloaded at 0.
using Contact = std::function<void(std::span<const double> displacement, std::span<double> force)>;

/// The sine of a truth; of one that is not virgin after at least a cycle that is not recorded.
Motion Sine(const Truth& truth, Draws& draws);

/// Any waveform, recorded from its start. Amplitude, samples a cycle and frequency are the truth's.
Motion Wave(const Truth& truth, const models::ExcitationOptions& options);

/// The contact whose σ, α and Tc a fit should find: the closed form with Masing's rules.
Contact Masing(const models::BranchLaw& law);

/// A record without noise.
loop::Record Drive(const Motion& motion, const Contact& contact);

/// The truth's own contact, sine and sampling, without noise.
loop::Record Ideal(const Truth& truth, Draws& draws);

/// And with the truth's noise of the force.
loop::Record Measured(const Truth& truth, Draws& draws);

void AddNoise(loop::Record& record, const Truth& truth, Draws& draws);

/// These rows of a record, in this order.
loop::Record Rows(const loop::Record& record, std::span<const std::size_t> rows);

/// The rows [begin, end).
loop::Record Part(const loop::Record& record, std::size_t begin, std::size_t end);

/// Velocity over its largest magnitude, by central differences.
std::vector<double> Velocity(const loop::Record& record);

/// Rows at which the motion turns: a noise-free displacement's.
std::vector<std::size_t> Turns(const loop::Record& record);

/// Position of a row in its record, 0 … 1.
double Progress(const loop::Record& record, std::size_t row);

}  // namespace mindahl::reliability
