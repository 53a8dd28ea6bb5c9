#pragma once

#include <functional>

namespace mindahl {

/// Calls a function twenty times a second, or less often, from the fits of this thread, as long as
/// the object lives. What the function throws ends the fit, and leaves it as an exception.
class Interruptible {
 public:
  explicit Interruptible(std::function<void()> ask);
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  std::function<void()> before_;
};

/// Calls the function of this thread's Interruptible, if it is time to.
void AskWhetherToGoOn();

}  // namespace mindahl
