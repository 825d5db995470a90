// XXH3 (128 bits) of bytes and files, as 32 lower-case hexadecimal digits: whether something is
// what it was, many times quicker than SHA-256. For a user's own files only: whoever wants to can
// make two files with the same fingerprint, so what others have to trust is known by its SHA-256
// (hash.h).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace robocell {

std::string Fingerprint(std::string_view bytes);

// Reads the file in blocks; its size does not matter. IoError when it cannot be read.
std::string FingerprintFile(const std::filesystem::path& path);

}  // namespace robocell
