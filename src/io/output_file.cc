#include "mindahl/io/output_file.h"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include "core/platform.h"
#include "io/source.h"

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

/// Only what POSIX allows in a handler. The signal is at its default again and ends
/// the program as soon as it is no longer blocked, on return.
void RemoveAndRaise(int signal) {
  RemoveTemporaryFiles();
  std::raise(signal);
}

/// A file that goes with this object unless it is kept; and with the program, when
/// RemoveTemporaryFilesOnSignals() was called and a signal ends it.
class TemporaryName {
 public:
  /// Before the file is made: a signal may come in between.
  explicit TemporaryName(const char* name) : name_(name) { ReplaceName(nullptr, name_); }
  ~TemporaryName() {
    if (!kept_) RemoveName(name_);
    ReplaceName(name_, nullptr);
  }
  TemporaryName(const TemporaryName&) = delete;
  TemporaryName& operator=(const TemporaryName&) = delete;

  void Keep() {
    kept_ = true;
    ReplaceName(name_, nullptr);
  }

 private:
  const char* name_;
  bool kept_ = false;
};

[[noreturn]] void ThrowCannotWrite(const std::filesystem::path& path, int error) {
  Refuse("cannot write '{}': {}", path.string(), std::strerror(error));
}

}  // namespace

void RemoveTemporaryFiles() {
  for (const std::atomic<const char*>& slot : registered_names) {
    if (const char* const name = slot.load()) RemoveName(name);
  }
}

void RemoveTemporaryFilesOnSignals() { HandleEndingSignals(&RemoveAndRaise); }

/// An open file, closed with it. `path` is the name the user knows it by, for messages.
class OutputFile {
 public:
  OutputFile(const std::string& name, Opening opening, std::filesystem::path path)
      : path_(std::move(path)) {
    Require(OpenFile(name, opening, file_));
  }
  ~OutputFile() {
    if (file_ >= 0) CloseFile(file_);
  }
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  [[nodiscard]] int file() const { return file_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Passes an error on, if there is one.
  void Require(int error) const {
    if (error != 0) ThrowCannotWrite(path_, error);
  }
  void Write(std::string_view content) const { Require(WriteFile(file_, content)); }
  /// A full disk may show only here.
  void Close() { Require(CloseFile(std::exchange(file_, -1))); }
  /// Waits until the file of that name is on the disk, and closes it.
  void Finish() {
    Require(WriteToDisk(file_));
    Close();
  }
  void WriteNameToDisk(const std::filesystem::path& target) const {
    const std::filesystem::path parent = target.parent_path();
    Require(WriteDirectoryToDisk(parent.empty() ? "." : parent.string()));
  }

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

namespace {

/// /dev/stdout may lead to a regular file, which the shell opened and must not be replaced.
bool IsBelowDevOrProc(const std::filesystem::path& path) {
  const std::string name = path.lexically_normal().string();
  return name.starts_with("/dev/") || name.starts_with("/proc/");
}

/// @param is_old  it is there, and its permissions stay
void ReplaceFile(const std::filesystem::path& target, bool is_old, std::string_view content,
                 const std::filesystem::path& path) {
  static std::atomic<unsigned> counter = 0;
  const std::string name =
      (target.parent_path() /
       fmt::format(".{}.{}.{}.tmp", target.filename().string(), ProcessNumber(), counter++))
          .string();
  TemporaryName temporary(name.c_str());
  OutputFile file(name, Opening::kNew, path);
  if (is_old) file.Require(CopyPermissions(target.string(), file.file()));
  file.Write(content);
  file.Finish();
  if (std::rename(name.c_str(), target.c_str()) != 0) ThrowCannotWrite(path, errno);
  temporary.Keep();
  file.WriteNameToDisk(target);
}

}  // namespace

void WriteFileAtomically(const std::filesystem::path& path, std::string_view content) {
  std::error_code error;
  const std::filesystem::file_status old = std::filesystem::status(path, error);
  const bool is_old = std::filesystem::exists(old);
  if (std::filesystem::is_directory(old)) ThrowCannotWrite(path, EISDIR);
  if (IsBelowDevOrProc(path) || (is_old && !std::filesystem::is_regular_file(old))) {
    OutputFile file(path.string(), Opening::kExisting, path);
    file.Write(content);
    file.Close();
    return;
  }
  const bool is_link = std::filesystem::is_symlink(path, error);
  const std::filesystem::path target = is_link && is_old ? std::filesystem::canonical(path) : path;
  ReplaceFile(target, is_old, content, path);
}

AppendedFile::AppendedFile(const std::filesystem::path& path, std::uintmax_t kept)
    : file_(std::make_unique<OutputFile>(path.string(), Opening::kCreated, path)), size_(kept) {
  file_->Require(EndFileAt(file_->file(), kept));
}
AppendedFile::~AppendedFile() = default;

void AppendedFile::Append(std::string_view block) {
  const int error = WriteFile(file_->file(), block);
  if (error != 0) EndFileAt(file_->file(), size_);
  file_->Require(error);
  size_ += block.size();
}

void AppendedFile::Finish() {
  file_->Finish();
  file_->WriteNameToDisk(file_->path());
}

}  // namespace mindahl::io
