#include "mindahl/io/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <optional>
#include <string>
#include <utility>

#include "io/temporary_names.h"
#include "io/to_disk.h"
#include "io/write_fault.h"

namespace mindahl::io {
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

}  // namespace mindahl::io
