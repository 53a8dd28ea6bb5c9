#include "mindahl/io/output_file.h"

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "core/platform.h"
#include "io/source.h"

namespace mindahl::io {

namespace {

[[noreturn]] void ThrowCannotWrite(const std::filesystem::path& path, int error) {
  Refuse("cannot write '{}': {}", path.string(), std::strerror(error));
}

}  // namespace

/// An open file, closed with it. `path` is the name the user knows it by, for messages.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path path) : path_(std::move(path)) {}
  OutputFile(std::filesystem::path path, Opening opening) : OutputFile(std::move(path)) {
    Require(OpenFile(path_.string(), opening, file_));
  }
  ~OutputFile() {
    if (file_ >= 0) CloseFile(file_);
  }
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  [[nodiscard]] int& file() { return file_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Passes an error on, if there is one.
  void Require(int error) const {
    if (error != 0) ThrowCannotWrite(path_, error);
  }
  void Write(std::string_view content) const { Require(WriteFile(file_, content)); }
  /// A full disk may show only here.
  void Close() { Require(CloseFile(std::exchange(file_, -1))); }
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
  // Once it is renamed there is nothing of that name.
  const auto remove = [](const std::string* temporary) {
    static_cast<void>(std::remove(temporary->c_str()));
  };
  std::unique_ptr<const std::string, decltype(remove)> temporary(&name, remove);
  OutputFile file(path);
  file.Require(OpenTemporary(name, file.file()));
  if (is_old) file.Require(CopyPermissions(target.string(), file.file()));
  file.Write(content);
  file.Require(WriteToDisk(file.file()));
  file.Require(NameTemporary(file.file(), name));
  file.Close();
  if (std::rename(name.c_str(), target.c_str()) != 0) ThrowCannotWrite(path, errno);
  file.WriteNameToDisk(target);
}

}  // namespace

void WriteFileAtomically(const std::filesystem::path& path, std::string_view content) {
  std::error_code error;
  const std::filesystem::file_status old = std::filesystem::status(path, error);
  const bool is_old = std::filesystem::exists(old);
  if (std::filesystem::is_directory(old)) ThrowCannotWrite(path, EISDIR);
  if (IsBelowDevOrProc(path) || (is_old && !std::filesystem::is_regular_file(old))) {
    OutputFile file(path, Opening::kExisting);
    file.Write(content);
    return file.Close();
  }
  const bool is_link = std::filesystem::is_symlink(path, error);
  const std::filesystem::path target = is_link && is_old ? std::filesystem::canonical(path) : path;
  ReplaceFile(target, is_old, content, path);
}

AppendedFile::AppendedFile(const std::filesystem::path& path, std::uintmax_t kept)
    : file_(std::make_unique<OutputFile>(path, Opening::kCreated)), size_(kept) {
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
  file_->Require(WriteToDisk(file_->file()));
  file_->Close();
  file_->WriteNameToDisk(file_->path());
}

}  // namespace mindahl::io
