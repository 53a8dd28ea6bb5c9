
#include <fstream>

#include "io/source.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

namespace mindahl::io::digest_test {
namespace {

std::optional<std::string> DigestOf(const std::string& content) {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "file";
  std::ofstream(path, std::ios::binary) << content;
  return Sha256OfFile(path);
}

// Examples of NIST's, FIPS 180-4.
TEST(Sha256, IsThatOfTheStandard) {
  EXPECT_EQ(DigestOf(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(DigestOf("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(DigestOf(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, IsEmptyIfNotARegularFile) {
  const TemporaryDirectory directory;
  EXPECT_EQ(Sha256OfFile(directory.path()), std::nullopt);
  EXPECT_EQ(Sha256OfFile(directory.path() / "absent"), std::nullopt);
  EXPECT_EQ(Sha256OfFile("/dev/null"), std::nullopt);
}

}  // namespace
}  // namespace mindahl::io::digest_test
