#include "apart.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <system_error>
#include <vector>

namespace mindahl::reliability {
namespace {

constexpr int kAnswered = 0;
constexpr int kThrew = 1;

struct Child {
  std::size_t piece = 0;
  pid_t process = 0;
  int pipe = -1;
  std::string text;
};

[[noreturn]] void ThrowErrno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

void WriteAll(int pipe, const std::string& text) {
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t more = write(pipe, text.data() + written, text.size() - written);
    if (more <= 0) _exit(kThrew);
    written += static_cast<std::size_t>(more);
  }
}

[[noreturn]] void Work(int pipe, std::size_t piece, unsigned seconds,
                       const std::function<std::string(std::size_t)>& work) {
  const rlimit time{seconds, seconds + 1};
  setrlimit(RLIMIT_CPU, &time);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  try {
    WriteAll(pipe, work(piece));
    _exit(kAnswered);
  } catch (const std::exception& fault) {
    WriteAll(pipe, fault.what());
    _exit(kThrew);
  }
}

Child Start(std::size_t piece, const ApartOptions& options,
            const std::function<std::string(std::size_t)>& work) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) ThrowErrno("pipe");
  const pid_t process = fork();
  if (process < 0) ThrowErrno("fork");
  if (process == 0) {
    close(ends[0]);
    Work(ends[1], piece, options.seconds, work);
  }
  close(ends[1]);
  return {piece, process, ends[0], {}};
}

/// Reads what has come; is there more to come?
bool Read(Child& child) {
  std::array<char, 4096> buffer{};
  const ssize_t got = read(child.pipe, buffer.data(), buffer.size());
  if (got > 0) child.text.append(buffer.data(), static_cast<std::size_t>(got));
  return got > 0 || (got < 0 && errno == EINTR);
}

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

Ending Collect(Child& child, const ApartOptions& options) {
  close(child.pipe);
  int status = 0;
  rusage usage{};
  while (wait4(child.process, &status, 0, &usage) < 0) {
    if (errno != EINTR) ThrowErrno("wait4");
  }
  Ending ending;
  ending.seconds = Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kAnswered) {
    ending.answer = std::move(child.text);
  } else if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)) {
    ending.fault = fmt::format("not done after {} s", options.seconds);
  } else if (WIFSIGNALED(status)) {
    ending.fault = fmt::format("ended the program: {}", strsignal(WTERMSIG(status)));
  } else {
    ending.fault = child.text.empty() ? "ended the program" : std::move(child.text);
  }
  return ending;
}

}  // namespace

void RunApart(std::size_t pieces, const ApartOptions& options,
              const std::function<std::string(std::size_t)>& work,
              const std::function<void(std::size_t, const Ending&)>& ended) {
  std::vector<Child> running;
  std::size_t next = 0;
  while (next < pieces || !running.empty()) {
    while (next < pieces && running.size() < options.at_once) {
      running.push_back(Start(next++, options, work));
    }
    std::vector<pollfd> waiting;
    for (const Child& child : running) waiting.push_back({child.pipe, POLLIN, 0});
    if (poll(waiting.data(), waiting.size(), -1) < 0 && errno != EINTR) ThrowErrno("poll");
    std::vector<Child> still;
    for (std::size_t k = 0; k < running.size(); ++k) {
      if (waiting[k].revents == 0 || Read(running[k])) {
        still.push_back(std::move(running[k]));
      } else {
        const std::size_t piece = running[k].piece;
        ended(piece, Collect(running[k], options));
      }
    }
    running = std::move(still);
  }
}

}  // namespace mindahl::reliability
