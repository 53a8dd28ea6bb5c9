#include "mindahl/io/digest.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <memory>
#include <system_error>
#include <vector>

#include "io/input_file.h"
#include "mindahl/core/error.h"

namespace mindahl::io {

std::optional<std::string> Sha256OfFile(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  const InputFile file = OpenInput(path);
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(),
                                                                        &EVP_MD_CTX_free);
  bool works = context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  constexpr std::size_t kPiece = 1 << 16;
  std::vector<char> piece(kPiece);
  for (std::size_t count = kPiece; works && count == kPiece;) {
    count = std::fread(piece.data(), 1, kPiece, file.get());
    works = EVP_DigestUpdate(context.get(), piece.data(), count) == 1;
  }
  if (std::ferror(file.get()) != 0) ThrowCannotRead(path.string());
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  works = works && EVP_DigestFinal_ex(context.get(), digest.data(), &size) == 1;
  if (!works) {
    throw InputError(
        fmt::format("cannot read '{}': libcrypto gives no SHA-256 of it, for want of "
                    "memory or by its configuration",
                    path.string()));
  }
  std::string text;
  for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

}  // namespace mindahl::io
