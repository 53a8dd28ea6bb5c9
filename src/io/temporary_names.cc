#include "io/temporary_names.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <utility>

#include "mindahl/io/atomic_file.h"

namespace mindahl::io {
namespace {

// Holds the names that a signal handler may read. It does not remove more than these at once.
constexpr std::size_t kMostNames = 32;
std::array<std::atomic<const char*>, kMostNames> registered_names{};
static_assert(std::atomic<const char*>::is_always_lock_free);

void ReplaceName(const char* old_name, const char* new_name) {
  for (std::atomic<const char*>& slot : registered_names) {
    const char* expected = old_name;
    if (slot.compare_exchange_strong(expected, new_name)) return;
  }
}

// At most one object of DeferredSignals is of use at a time.
std::atomic<bool> is_deferred = false;
std::atomic<int> noted_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

void RemoveAndRaise(int signal);

/// Handles the signal once, without restarting what waits for input.
void Handle(int signal) {
  struct sigaction action {};
  action.sa_handler = &RemoveAndRaise;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  ::sigaction(signal, &action, nullptr);
}

/// Interrupts every second what waits for input, and began to just after a signal was noted.
void Interrupt(int /*signal*/) {
  if (noted_signal != 0) ::alarm(1);
}

/// Only what POSIX allows in a handler. The signal is at its default again (SA_RESETHAND) and ends
/// the program as soon as it is no longer blocked, on return.
void RemoveAndRaise(int signal) {
  if (is_deferred.exchange(false)) {
    noted_signal = signal;
    Handle(signal);
    struct sigaction action {};
    action.sa_handler = &Interrupt;
    ::sigaction(SIGALRM, &action, nullptr);
    ::alarm(1);
    return;
  }
  RemoveTemporaryFiles();
  ::raise(signal);
}

}  // namespace

TemporaryName::TemporaryName(std::string name) : name_(std::move(name)) {
  ReplaceName(nullptr, name_.c_str());
}

TemporaryName::~TemporaryName() {
  if (kept_) return;
  if (::unlink(name_.c_str()) != 0) ::rmdir(name_.c_str());
  ReplaceName(name_.c_str(), nullptr);
}

void TemporaryName::Keep() {
  kept_ = true;
  ReplaceName(name_.c_str(), nullptr);
}

void RemoveTemporaryFiles() {
  for (const std::atomic<const char*>& slot : registered_names) {
    if (const char* const name = slot.load()) ::unlink(name);
  }
  for (const std::atomic<const char*>& slot : registered_names) {
    if (const char* const name = slot.load()) ::rmdir(name);
  }
}

void RemoveTemporaryFilesOnSignals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    // The program may have been started to ignore the signal, as by nohup.
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    Handle(signal);
  }
}

DeferredSignals::DeferredSignals() { is_deferred = true; }
DeferredSignals::~DeferredSignals() { is_deferred = false; }

int DeferredSignals::noted() const { return noted_signal; }

void RaiseNotedSignal() {
  const int signal = noted_signal.exchange(0);
  if (signal == 0) return;
  std::signal(signal, SIG_DFL);
  ::raise(signal);
}

}  // namespace mindahl::io
