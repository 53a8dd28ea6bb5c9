#include "core/platform.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>

#ifdef __GLIBC__
#include <malloc.h>
#endif

extern char** environ;

namespace mindahl {

void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kMost = 1 << 30;  // [bytes]
  mallopt(M_MMAP_THRESHOLD, kMost);
  mallopt(M_TRIM_THRESHOLD, kMost);
#endif
}

void IgnoreFileSizeSignal() { std::signal(SIGXFSZ, SIG_IGN); }

int ProcessNumber() { return ::getpid(); }

int OpenFile(const std::string& name, Opening opening, int& file) {
  const int flags = opening == Opening::kNew        ? O_CREAT | O_EXCL
                    : opening == Opening::kExisting ? O_APPEND
                                                    : O_CREAT;
  file = ::open(name.c_str(), O_WRONLY | O_CLOEXEC | flags, 0666);
  return file < 0 ? errno : 0;
}

int WriteFile(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int EndFileAt(int file, std::uintmax_t size) {
  const auto end = static_cast<off_t>(size);
  return ::ftruncate(file, end) != 0 || ::lseek(file, end, SEEK_SET) != end ? errno : 0;
}

int WriteToDisk(int file) { return ::fsync(file) != 0 && errno != EINVAL ? errno : 0; }

int CloseFile(int file) { return ::close(file) != 0 ? errno : 0; }

int CopyPermissions(const std::string& from, int file) {
  struct stat status {};
  if (::stat(from.c_str(), &status) != 0) return errno;
  return ::fchmod(file, status.st_mode & 07777) != 0 ? errno : 0;
}

int RunProgram(std::vector<std::string> words, std::string_view input, ProgramOutput& written) {
  const auto close = [](std::FILE* file) { std::fclose(file); };
  std::array<std::unique_ptr<std::FILE, decltype(close)>, 3> streams;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  int error = 0;
  for (int stream = 0; stream < 3 && error == 0; ++stream) {
    auto& file = streams.at(static_cast<std::size_t>(stream));
    file.reset(std::tmpfile());
    if (!file) {
      error = errno;
    } else {
      posix_spawn_file_actions_adddup2(&actions, ::fileno(file.get()), stream);
    }
  }
  if (error == 0) error = WriteFile(::fileno(streams[0].get()), input);
  if (error == 0 && std::fseek(streams[0].get(), 0, SEEK_SET) != 0) error = errno;
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (error == 0) {
    error = ::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  }
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return error;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return errno;
  }
  written.succeeded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  const auto content = [](std::FILE* file) {
    std::string text;
    std::array<char, 4096> block{};
    if (std::fseek(file, 0, SEEK_SET) != 0) return text;
    while (const std::size_t size = std::fread(block.data(), 1, block.size(), file)) {
      text.append(block.data(), size);
    }
    return text;
  };
  written.output = content(streams[1].get());
  written.messages = content(streams[2].get());
  return 0;
}

}  // namespace mindahl
