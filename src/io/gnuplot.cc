#include "io/gnuplot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "io/unfinished_output.h"
#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

/// A directory of its own.
std::string MakeScratchDirectory() {
  std::string pattern = (std::filesystem::temp_directory_path() / "mindahl-plot-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    throw InputError(
        fmt::format("cannot make the directory '{}': {}", pattern, std::strerror(errno)));
  }
  return pattern;
}

std::string Content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("cannot read '{}': {}", path, std::strerror(errno)));
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Runs `gnuplot -d script` and returns its wait status. Files rather than pipes take its output:
/// nothing can then block on a full pipe.
int SpawnAndWait(std::string script, const std::string& output, const std::string& messages) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), kFlags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, messages.c_str(), kFlags, 0600);
  std::string program = "gnuplot";
  std::string default_settings = "-d";
  const std::array<char*, 4> arguments = {program.data(), default_settings.data(), script.data(),
                                          nullptr};
  // Ends gnuplot where its file may not grow: it does not look at what its own writing returns.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults;
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGXFSZ);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  pid_t child = 0;
  const int error =
      ::posix_spawnp(&child, program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) {
    throw InputError("plots need gnuplot, which is not on PATH: install it (Debian: gnuplot-nox)");
  }
  if (error != 0) {
    throw InputError(fmt::format("cannot start gnuplot: {}", std::strerror(error)));
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) {
      throw std::runtime_error(fmt::format("cannot wait for gnuplot: {}", std::strerror(errno)));
    }
  }
  return status;
}

}  // namespace

std::string RunGnuplot(std::string_view script) {
  const TemporaryName scratch(MakeScratchDirectory());
  const TemporaryName script_name(scratch.name() + "/script.gp");
  const TemporaryName output_name(scratch.name() + "/output");
  const TemporaryName messages_name(scratch.name() + "/messages");
  const std::string& script_file = script_name.name();
  const std::string& output = output_name.name();
  const std::string& messages = messages_name.name();
  if (!(std::ofstream(script_file, std::ios::binary) << script).flush()) {
    throw InputError(fmt::format("cannot write '{}': is the disk full?", script_file));
  }
  const int status = SpawnAndWait(script_file, output, messages);
  std::string drawn = Content(output);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || drawn.empty()) {
    throw std::runtime_error(fmt::format("gnuplot failed: {}", Content(messages)));
  }
  return drawn;
}

}  // namespace mindahl::io
