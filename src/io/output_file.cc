#include "mindahl/io/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <optional>
#include <string>
#include <utility>

#include "io/unfinished_output.h"

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

namespace {

/// An open file, closed with it. `path` is the name the user knows it by, for messages.
class OutputFile {
 public:
  OutputFile(const std::string& name, int flags, const std::filesystem::path& path)
      : path_(path), descriptor_(::open(name.c_str(), O_WRONLY | O_CLOEXEC | flags, 0666)) {
    if (descriptor_ < 0) ThrowCannotWrite(path_, errno);
  }
  ~OutputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void SetPermissions(mode_t mode) {
    if (::fchmod(descriptor_, mode & 07777) != 0) ThrowCannotWrite(path_, errno);
  }

  void Write(std::string_view content) {
    while (!content.empty()) {
      const ssize_t written = ::write(descriptor_, content.data(), content.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) ThrowCannotWrite(path_, errno);
      content.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  /// Forces all written bytes to the disk.
  void Synchronise() { WriteToDisk(descriptor_, path_); }

  /// A full disk may show only here.
  void Close() {
    if (::close(std::exchange(descriptor_, -1)) != 0) ThrowCannotWrite(path_, errno);
  }

 private:
  const std::filesystem::path& path_;
  int descriptor_;
};

std::optional<struct stat> Status(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return status;
}

/// /dev/stdout may lead to a regular file, which the shell opened and must not be replaced.
bool IsBelowDevOrProc(const std::filesystem::path& path) {
  const std::string name = path.lexically_normal().string();
  return name.starts_with("/dev/") || name.starts_with("/proc/");
}

void ReplaceFile(const std::filesystem::path& target, const std::optional<struct stat>& old,
                 std::string_view content, const std::filesystem::path& path) {
  static std::atomic<unsigned> counter = 0;
  const std::string name =
      (target.parent_path() /
       fmt::format(".{}.{}.{}.tmp", target.filename().string(), ::getpid(), counter++))
          .string();
  TemporaryName temporary(name);
  OutputFile file(name, O_CREAT | O_EXCL, path);
  if (old) file.SetPermissions(old->st_mode);
  file.Write(content);
  file.Synchronise();
  file.Close();
  if (::rename(name.c_str(), target.c_str()) != 0) ThrowCannotWrite(path, errno);
  temporary.Keep();
  WriteNameToDisk(target, path);
}

}  // namespace

void WriteFileAtomically(const std::filesystem::path& path, std::string_view content) {
  const std::optional<struct stat> old = Status(path);
  if (old && S_ISDIR(old->st_mode)) ThrowCannotWrite(path, EISDIR);
  if (IsBelowDevOrProc(path) || (old && !S_ISREG(old->st_mode))) {
    OutputFile file(path.string(), O_APPEND, path);
    file.Write(content);
    file.Close();
    return;
  }
  std::error_code error;
  const bool is_link = std::filesystem::is_symlink(path, error);
  const std::filesystem::path target = is_link && old ? std::filesystem::canonical(path) : path;
  ReplaceFile(target, old, content, path);
}

AppendedFile::AppendedFile(std::filesystem::path path, std::uintmax_t kept)
    : path_(std::move(path)),
      descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666)),
      size_(kept) {
  if (descriptor_ < 0) ThrowCannotWrite(path_, errno);
  const auto end = static_cast<off_t>(kept);
  if (::ftruncate(descriptor_, end) != 0 || ::lseek(descriptor_, end, SEEK_SET) != end) {
    const int error = errno;
    ::close(descriptor_);
    ThrowCannotWrite(path_, error);
  }
}

AppendedFile::~AppendedFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void AppendedFile::Append(std::string_view block) {
  std::string_view rest = block;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int error = errno;
      const auto end = static_cast<off_t>(size_);
      if (::ftruncate(descriptor_, end) == 0) ::lseek(descriptor_, end, SEEK_SET);
      ThrowCannotWrite(path_, error);
    }
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  size_ += block.size();
}

void AppendedFile::Finish() {
  WriteToDisk(descriptor_, path_);
  if (::close(std::exchange(descriptor_, -1)) != 0) ThrowCannotWrite(path_, errno);
  WriteNameToDisk(path_, path_);
}

}  // namespace mindahl::io
