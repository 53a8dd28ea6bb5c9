// Runs a target on its corpus and on pseudo-random mutations of it, the same on every machine: the
// regression test where there is no libFuzzer.
//
//   replay TARGET CORPUS MUTATIONS     all of them
//   replay TARGET FILE                 one input, as libFuzzer leaves it
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "fuzz/target.h"

namespace {

using Content = std::vector<std::uint8_t>;
namespace fs = std::filesystem;

Content ReadFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return Content(std::istreambuf_iterator<char>(file), {});
}

/// One of the changes that libFuzzer makes too.
void Mutate(Content& input, const std::vector<Content>& corpus, std::mt19937_64& random) {
  const auto below = [&random](std::size_t limit) { return limit == 0 ? 0 : random() % limit; };
  const std::size_t place = below(input.size());
  const auto at = input.begin() + static_cast<std::ptrdiff_t>(place);
  switch (below(6)) {
    case 0:  // flips a bit
      if (!input.empty()) *at ^= static_cast<std::uint8_t>(1U << below(8));
      return;
    case 1:  // replaces a byte by one that text has
      if (!input.empty())
        *at = static_cast<std::uint8_t>("0123456789.,-+eE;\t\n\"#= nif"[below(27)]);
      return;
    case 2:  // inserts any byte
      input.insert(at, static_cast<std::uint8_t>(below(256)));
      return;
    case 3:  // takes a piece out
      input.erase(at, at + static_cast<std::ptrdiff_t>(below(input.size() - place + 1)));
      return;
    case 4: {  // repeats a piece
      const Content piece(at, at + static_cast<std::ptrdiff_t>(below(input.size() - place + 1)));
      input.insert(input.begin() + static_cast<std::ptrdiff_t>(below(input.size())), piece.begin(),
                   piece.end());
      return;
    }
    default: {  // goes on as another input does
      const Content& other = corpus[below(corpus.size())];
      input.resize(place);
      input.insert(input.end(), other.begin() + static_cast<std::ptrdiff_t>(below(other.size())),
                   other.end());
    }
  }
}

// What is being run, for the handler.
const mindahl::fuzz::Target* running = nullptr;
Content input_of_run;

/// Leaves the input that crashes the program in the file crash_TARGET.
void LeaveInput(int signal) {
  std::array<char, 64> name{"crash_"};
  running->name.copy(name.data() + 6, name.size() - 7);
  const int file = ::open(name.data(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  (void)!::write(file, input_of_run.data(), input_of_run.size());
  ::raise(signal);
}

void Run(const mindahl::fuzz::Target& target, const Content& input) {
  running = &target;
  input_of_run.assign(input.begin(), input.begin() + static_cast<std::ptrdiff_t>(
                                                         std::min(input.size(), target.longest)));
  target.run(input_of_run);
}

}  // namespace

int main(int argc, char** argv) {
  using mindahl::fuzz::Require;
  Require(argc == 3 || argc == 4, "usage: replay TARGET FILE | replay TARGET CORPUS MUTATIONS");
  const mindahl::fuzz::Target& target = mindahl::fuzz::FindTarget(argv[1]);
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) {
    struct sigaction action {};
    action.sa_handler = &LeaveInput;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    ::sigaction(signal, &action, nullptr);
  }
  if (argc == 3) {
    Run(target, ReadFile(argv[2]));
    return 0;
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(argv[2])) files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<Content> corpus;
  for (const fs::path& file : files) corpus.push_back(ReadFile(file));
  Require(!corpus.empty(), "a target has a corpus");
  for (const Content& input : corpus) Run(target, input);
  std::mt19937_64 random(22);
  const std::size_t mutations = std::stoul(argv[3]);
  for (std::size_t i = 0; i < mutations; ++i) {
    Content input = corpus[random() % corpus.size()];
    for (std::size_t changes = 1 + random() % 8; changes > 0; --changes)
      Mutate(input, corpus, random);
    Run(target, input);
  }
  fmt::print("{} executions of {}\n", corpus.size() + mutations, target.name);
  return 0;
}
