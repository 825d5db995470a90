// Files that belong together, such as a model with its meshes and textures, identified by their
// content: the same files have the same hash wherever they are.
//
//   const FileSet arm = MakeFileSet("/m/arm/arm.xml", {"/m/arm/arm.xml", "/m/arm/assets/a.stl"});
//   arm.main;   // "arm.xml"; the other one is "assets/a.stl"
//   arm.hash;   // of names and contents
//
// Hashes of files are cached in the process as long as the system reports the same file (inode,
// size, times). Throws IoError for a file that cannot be read. Any thread.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/hash.h"

namespace robocell {

// Returns the SHA-256 of a file, cached.
std::string HashOfFile(const std::filesystem::path& path);
// Returns its fingerprint (hash.h), cached: faster, for files that nobody would forge.
std::string FingerprintOfFile(const std::filesystem::path& path);

// The hash functions for files and their names.
struct Hashing {
  std::string (*of_file)(const std::filesystem::path&) = HashOfFile;
  std::string (*of_text)(std::string_view) = Sha256;
};
inline constexpr Hashing kFingerprints = {FingerprintOfFile, Fingerprint};

struct FileSet {
  std::string main;  // the name of the file that names the others
  std::map<std::string, std::filesystem::path>
      files;         // files by name relative to the common folder
  std::string hash;  // hash of names and contents, hexadecimal
};

// `files` are absolute paths and include `main`.
FileSet MakeFileSet(const std::filesystem::path& main,
                    const std::vector<std::filesystem::path>& files, const Hashing& hashing = {});

// Name -> SHA-256.
using FileSums = std::map<std::string, std::string>;

// Computes the sums of all files in a folder. Throws IoError with entries that are neither files
// nor folders.
FileSums SumsOfFolder(const std::filesystem::path& folder);

// Returns one line each, in the format of `sha256sum`. Its own SHA-256 is the hash of the set.
std::string TextOf(const FileSums& sums);
// Parses the result of TextOf; unset for any other text.
std::optional<FileSums> ParseSums(const std::string& text);

}  // namespace robocell
