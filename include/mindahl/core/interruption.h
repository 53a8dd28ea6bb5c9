#pragma once

#include <functional>

namespace mindahl {

/// While an instance lives, fits on this thread call the function at most 20 times per second; an
/// exception that it throws aborts the fit and reaches the caller.
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
