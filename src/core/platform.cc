#include "core/platform.h"

#include <fcntl.h>
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

std::optional<std::string> OutputOf(const std::string& command, std::string_view input) {
  const auto close = [](std::FILE* file) { std::fclose(file); };
  const std::unique_ptr<std::FILE, decltype(close)> in(std::tmpfile()), out(std::tmpfile());
  if (!in || !out || WriteFile(::fileno(in.get()), input) != 0) return std::nullopt;
  const std::string redirected = command + " </dev/fd/" + std::to_string(::fileno(in.get())) +
                                 " >/dev/fd/" + std::to_string(::fileno(out.get())) +
                                 " 2>/dev/null";
  if (std::system(redirected.c_str()) != 0) return std::nullopt;
  std::string text;
  std::array<char, 4096> block{};
  while (const std::size_t size = std::fread(block.data(), 1, block.size(), out.get())) {
    text.append(block.data(), size);
  }
  return text;
}

}  // namespace mindahl
