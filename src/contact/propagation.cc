#include "contact/propagation.h"

#include <cmath>
#include <string_view>

namespace mindahl::contact {
namespace {

constexpr std::array<std::string_view, kSourceCount> kSourceNames = {"tangential stiffness",
                                                                     "slip force",
                                                                     "friction coefficient",
                                                                     "normal load",
                                                                     "Young's modulus of body 1",
                                                                     "Poisson ratio of body 1",
                                                                     "radius of body 1",
                                                                     "Young's modulus of body 2",
                                                                     "Poisson ratio of body 2",
                                                                     "radius of body 2",
                                                                     "contact radius",
                                                                     "tangential compliance"};

}  // namespace

Quantity Independent(const UncertainValue& source, Source place) {
  Quantity quantity{.value = source.value};
  quantity.change[place] = source.standard_error / source.value;
  return quantity;
}

Quantity Product(double value, std::initializer_list<Factor> factors, double root) {
  Quantity product{.value = value};
  for (const Factor& factor : factors) {
    for (std::size_t source = 0; source < kSourceCount; ++source) {
      product.change[source] += factor.power / root * factor.quantity.change[source];
    }
  }
  return product;
}

PropagatedValue Total(const Quantity& quantity, double correlation) {
  const double by_stiffness = quantity.change[kStiffness];
  const double by_slip_force = quantity.change[kSlipForce];
  // The square of the sum, with the correlation split so that nothing is subtracted under the root.
  // What the fit leaves open stays so: its correlation says nothing.
  const bool open = std::isinf(by_stiffness) || std::isinf(by_slip_force);
  const double fit =
      open ? std::hypot(by_stiffness, by_slip_force)
           : std::hypot(by_stiffness + correlation * by_slip_force,
                        std::sqrt((1.0 - correlation) * (1.0 + correlation)) * by_slip_force);
  double inputs = 0.0;
  double largest = 0.0;
  PropagatedValue total;
  for (std::size_t source = kSlipForce + 1; source < kSourceCount; ++source) {
    const double change = std::abs(quantity.change[source]);
    inputs = std::hypot(inputs, change);
    if (change <= largest) continue;
    largest = change;
    total.largest_input = kSourceNames[source];
  }
  total.value = quantity.value;
  total.fit_error = quantity.value * fit;
  total.input_error = quantity.value * inputs;
  total.standard_error = std::hypot(total.fit_error, total.input_error);
  return total;
}

}  // namespace mindahl::contact
