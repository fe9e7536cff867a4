// SPDX-License-Identifier: AGPL-3.0-or-later
// Implements the hash functions of file.h. They are in a separate file so that a program that does not use them starts
// without OpenSSL.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <vector>

#include <openssl/evp.h>

#include "core/base/error.h"
#include "core/base/file.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) { EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr); }
  void add(const void* bytes, std::size_t size) { EVP_DigestUpdate(context_.get(), bytes, size); }
  std::string hex() {
    unsigned char digest[32];
    EVP_DigestFinal_ex(context_.get(), digest, nullptr);
    std::string text;
    for (unsigned char byte : digest) {
      text += "0123456789abcdef"[byte >> 4];
      text += "0123456789abcdef"[byte & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};
}  // namespace

std::array<std::uint8_t, 32> sha256(const void* bytes, std::size_t size) {
  std::array<std::uint8_t, 32> digest;
  EVP_Digest(bytes, size, digest.data(), nullptr, EVP_sha256(), nullptr);
  return digest;
}

std::string sha256_of_bytes(const void* bytes, std::size_t size) {
  Sha256 hash;
  hash.add(bytes, size);
  return hash.hex();
}

std::string sha256_of_file(const Path& path) {
  Sha256 hash;
  std::error_code unreadable;
  if (fs::is_directory(path, unreadable)) {
    std::vector<Path> files;
    for (const auto& entry : fs::directory_iterator(path))
      if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const Path& file : files) {
      const std::string one = sha256_of_file(file);
      hash.add(one.data(), one.size());
    }
    return hash.hex();
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error("the file cannot be opened", path.string(), std::strerror(errno));
  if (!fs::is_regular_file(path, unreadable))
    throw Error("this is not a regular file", path.string(), "name a file on disk");
  std::vector<char> block(1 << 16);
  while (in.read(block.data(), std::ssize(block)) || in.gcount() > 0) hash.add(block.data(), in.gcount());
  return hash.hex();
}

}  // namespace limber
