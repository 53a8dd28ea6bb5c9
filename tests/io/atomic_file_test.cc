#include <sys/stat.h>

#include <thread>

#include "core/platform.h"
#include "mindahl/io/output_file.h"
#include "support/prelude.h"
#include "temporary_directory.h"

namespace mindahl::io::atomic_file_test {
namespace {

mode_t Permissions(const std::filesystem::path& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0);
  return status.st_mode & 07777;
}

TEST(OpenFile, OfANewNameFailsWhereOneIsThere) {
  // A file or a link that another put where a temporary one is to be written stays as it is.
  const TemporaryDirectory directory;
  const auto path = directory.Write("there", "as it was");
  int file = -1;
  EXPECT_EQ(OpenFile(path.string(), Opening::kNew, file), EEXIST);
  EXPECT_EQ(FileContent(path), "as it was");
  ASSERT_EQ(OpenFile((directory.path() / "new").string(), Opening::kNew, file), 0);
  EXPECT_EQ(CloseFile(file), 0);
}

TEST(AtomicFile, ReplacesTheContentByTextBytesAndNothing) {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "out";
  for (const std::string& content : {std::string("a\0b\r\n\xFF", 6), std::string("a long text"),
                                     std::string("short"), std::string()}) {
    WriteFileAtomically(path, content);
    EXPECT_EQ(FileContent(path), content);
    EXPECT_EQ(directory.FileCount(), 1u);
  }
}

TEST(AtomicFile, LeavesOldContentToReaderThatHasTheFileOpen) {
  const TemporaryDirectory directory;
  const auto path = directory.Write("out", "old");
  std::ifstream reader(path);
  WriteFileAtomically(path, "new");
  std::string content;
  reader >> content;
  EXPECT_EQ(content, "old");
}

TEST(AtomicFile, GivesANewFilePermissionsOfTheUmaskAndKeepsThoseOfAnother) {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "out";
  const mode_t old_mask = ::umask(027);
  WriteFileAtomically(path, "x");
  ::umask(old_mask);
  EXPECT_EQ(Permissions(path), 0640u);
  ::chmod(path.c_str(), 0604);
  WriteFileAtomically(path, "new");
  EXPECT_EQ(Permissions(path), 0604u);
}

TEST(AtomicFile, WritesThroughSymbolicLink) {
  const TemporaryDirectory directory;
  const auto path = directory.Write("out", "old");
  std::filesystem::create_symlink("out", directory.path() / "link");
  WriteFileAtomically(directory.path() / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(directory.path() / "link"));
  EXPECT_EQ(FileContent(path), "new");
}

TEST(AtomicFile, WritesStraightToPipeAndDevice) {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "pipe";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = FileContent(path); });
  WriteFileAtomically(path, "through the pipe");
  reader.join();
  EXPECT_EQ(read, "through the pipe");
  EXPECT_TRUE(std::filesystem::is_fifo(path));
  WriteFileAtomically("/dev/null", "x");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(AtomicFile, AppendsToRegularFileBehindDescriptor) {
  const TemporaryDirectory directory;
  const auto path = directory.Write("out", "begun ");
  std::FILE* const file = std::fopen(path.c_str(), "a");
  WriteFileAtomically("/dev/fd/" + std::to_string(::fileno(file)), "continued");
  std::fclose(file);
  EXPECT_EQ(FileContent(path), "begun continued");
}

TEST(AtomicFile, SaysWhyItCannotWrite) {
  const TemporaryDirectory directory;
  const auto refusal = [](const std::filesystem::path& path) {
    return MessageOf<InputError>([&] { WriteFileAtomically(path, "x"); });
  };
  const auto path = directory.path() / "none" / "x.csv";
  EXPECT_EQ(refusal(path), "cannot write '" + path.string() + "': No such file or directory");
  EXPECT_EQ(refusal(directory.path()),
            "cannot write '" + directory.path().string() + "': Is a directory");
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_EQ(refusal("/dev/full"), "cannot write '/dev/full': No space left on device");
}

}  // namespace
}  // namespace mindahl::io::atomic_file_test
