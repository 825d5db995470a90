// Hashes of bytes and files: SHA-256, as 64 lower-case hexadecimal digits (what `sha256sum` prints),
// and XXH3; SipHash of names.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace robocell {

std::string Sha256(std::string_view bytes);

// Reads the file in blocks; its size does not matter. IoError when it cannot be read.
std::string Sha256File(const std::filesystem::path& path);

// The hash of what is handed over piece by piece.
class Sha256Stream {
 public:
  Sha256Stream();
  ~Sha256Stream();
  Sha256Stream(Sha256Stream&&) noexcept;
  Sha256Stream& operator=(Sha256Stream&&) noexcept;

  void Update(std::string_view bytes);
  // Returns the hash of all bytes so far; more may follow.
  std::string Hex() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// XXH3 (128 bits) of bytes and files, as 32 lower-case hexadecimal digits: whether something is
// what it was, many times quicker than SHA-256. For a user's own files only: whoever wants to can
// make two files with the same fingerprint, so what others have to trust is known by its SHA-256
// instead.
std::string Fingerprint(std::string_view bytes);

// Reads the file in blocks; its size does not matter. IoError when it cannot be read.
std::string FingerprintFile(const std::filesystem::path& path);

// Two little-endian words, low word first.
using Hash128 = std::array<uint64_t, 2>;

// SipHash-2-4 with a 128-bit key and result: turns the names of random streams into seeds
// (base/rng.h). Not for files.
// J.-P. Aumasson and D. J. Bernstein, "SipHash: a fast short-input PRF", 2012; 128-bit variant of
// the reference code (github.com/veorq/SipHash). Same result on every machine.
Hash128 SipHash128(const Hash128& key, std::string_view bytes);

}  // namespace robocell
