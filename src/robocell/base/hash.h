// Hashes of bytes and files: SHA-256, as 64 lower-case hexadecimal digits (what `sha256sum`
// prints), and XXH3; SipHash of names.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace robocell {

std::string Sha256(std::string_view bytes);

// Reads a file of any size in blocks. Throws IoError if it cannot be read.
std::string Sha256File(const std::filesystem::path& path);

// Hashes data that arrives in pieces.
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

// Returns XXH3 (128 bits) of bytes and files, as 32 lower-case hexadecimal digits: detects changes
// many times faster than SHA-256. Only for a user's own files: two files with the same fingerprint
// can be made on purpose, so data that others have to trust is identified by its SHA-256 instead.
std::string Fingerprint(std::string_view bytes);

// Reads a file of any size in blocks. Throws IoError if it cannot be read.
std::string FingerprintFile(const std::filesystem::path& path);

// Two little-endian words, low word first.
using Hash128 = std::array<uint64_t, 2>;

// SipHash-2-4 with a 128-bit key and result: turns the names of random streams into seeds
// (base/rng.h). Not for files.
// J.-P. Aumasson and D. J. Bernstein, "SipHash: a fast short-input PRF", 2012; 128-bit variant of
// the reference code (github.com/veorq/SipHash). Same result on every machine.
Hash128 SipHash128(const Hash128& key, std::string_view bytes);

}  // namespace robocell
