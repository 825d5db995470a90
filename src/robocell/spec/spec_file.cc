#include "robocell/spec/spec_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/lfs_pointer.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"
#include "robocell/spec/yaml_hints.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

constexpr size_t kEnoughToTell = 1 << 16;  // bytes

size_t CharacterLength(std::string_view text, size_t i);

// Text that is not UTF-8 is not a spec. A character may be cut off at the end.
bool IsText(std::string_view text) {
  constexpr size_t kLongestCharacter = 4;
  for (size_t i = 0; i < text.size();) {
    const size_t length = CharacterLength(text, i);
    if (length == 0) return text.size() == kEnoughToTell && text.size() - i < kLongestCharacter;
    i += length;
  }
  return true;
}

bool MayBeOfType(const fs::path& file, const std::string& type) {
  std::ifstream stream(file, std::ios::binary);
  std::string text(kEnoughToTell, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return IsText(text) && !internal::yaml::IsOtherKindOfText(text, type);
}

// Returns the files that may be of the `type`: neither files of another type nor files without
// text.
std::vector<std::string> SpecFilesIn(const fs::path& folder, const std::string& type) {
  std::vector<std::string> names = FolderNamesIfAny(folder);
  std::erase_if(names, [&](const std::string& name) {
    const fs::path file = folder / name, ending = file.extension();
    const bool is_yaml = name.front() != '.' && (ending == ".yaml" || ending == ".yml");
    return !is_yaml || !internal::CanReadFile(file) || !MayBeOfType(file, type);
  });
  return names;
}

std::string Listing(const fs::path& folder, const std::string& kind,
                    const std::vector<std::string>& names) {
  std::error_code error;
  const std::string place = fs::absolute(folder, error).lexically_normal().string();
  if (names.empty()) return fmt::format(" There are no {}s in {}.", kind, place);
  return fmt::format(" In {}: {}.", place, ListNames(names, 8));
}

// Returns the number of bytes of the UTF-8 character at `i`; 0 if there is none.
size_t CharacterLength(std::string_view text, size_t i) {
  const auto byte = [&](size_t k) -> unsigned {
    return i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0u;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return first == 0 ? 0 : 1;
  const size_t length = first >= 0xC2 && first < 0xE0   ? 2
                        : first >= 0xE0 && first < 0xF0 ? 3
                        : first >= 0xF0 && first < 0xF5 ? 4
                                                        : 0;
  for (size_t k = 1; k < length; ++k) {
    if ((byte(k) & 0xC0) != 0x80) return 0;
  }
  const bool overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool beyond = (first == 0xED && byte(1) >= 0xA0) || (first == 0xF4 && byte(1) >= 0x90);
  return overlong || beyond ? 0 : length;
}

}  // namespace

std::string MissingSpecFile(const std::string& path, const std::string& type) {
  std::error_code error;
  if (internal::CanReadFile(path)) return "";
  const internal::yaml::FileKind kind = internal::yaml::FileKindOf(type);
  const std::string tail =
      fmt::format(" How to write {}: {}", internal::yaml::WithArticle(kind.what), kind.page);
  if (fs::is_directory(path, error)) {
    return fmt::format("'{}' is a folder; give {}.{}{}", path,
                       internal::yaml::WithArticle(kind.what),
                       Listing(path, kind.what, SpecFilesIn(path, type)), tail);
  }
  if (fs::exists(path, error)) {
    return fmt::format("'{}' is {}; give {}. What a pipe brings is written to a file first.{}",
                       path, internal::WhatIsAt(path), internal::yaml::WithArticle(kind.what),
                       tail);
  }
  const fs::path folder = fs::path(path).parent_path();
  const fs::path looked = folder.empty() ? fs::path(".") : folder;
  if (!fs::is_directory(looked, error)) {
    const std::string within =
        looked.is_relative() ? " in " + fs::current_path(error).string() : std::string();
    return fmt::format("no {} '{}': there is no folder '{}'{}.{}", kind.what, path, looked.string(),
                       within, tail);
  }
  const std::vector<std::string> names = SpecFilesIn(looked, type);
  const std::vector<std::string> near = NearestNames(fs::path(path).filename().string(), names, 1);
  std::string hint =
      near.empty() ? "" : fmt::format(" Did you mean '{}'?", (folder / near[0]).string());
  if (type == "RobotConfig" && folder.empty() && !fs::path(path).has_extension()) {
    hint += fmt::format(
        " If '{0}' is a built-in robot, give the path of its file, which `python3 -c \"import "
        "robocell; print(robocell.models.robot_file('{0}'))\"` prints (C++: BuiltinRobotFile).",
        path);
  }
  return fmt::format("no {} '{}'.{}{}{}", kind.what, path, Listing(looked, kind.what, names), hint,
                     tail);
}

std::string ReadSpecFile(const std::string& path, const std::string& type) {
  if (const std::string missing = MissingSpecFile(path, type); !missing.empty()) {
    throw IoError(missing);
  }
  std::error_code ignored;
  const uint64_t bytes = fs::file_size(path, ignored);
  if (!ignored && bytes > kMostSpecBytes) {
    const std::string what = internal::yaml::FileKindOf(type).what;
    throw IoError(
        fmt::format("'{}' has {} MiB; {} has a few kB, and 16 MiB are the most that is "
                    "read. Is it the right file?",
                    path, bytes >> 20, internal::yaml::WithArticle(what)));
  }
  if (const std::string pointer = internal::LfsPointerAdvice({path}); !pointer.empty()) {
    throw IoError(pointer);
  }
  return internal::ReadRealFile(path, kMostSpecBytes);
}

void RequireText(std::string_view text, const std::string& source) {
  size_t line = 1, line_start = 0;
  for (size_t i = 0; i < text.size();) {
    const size_t length = CharacterLength(text, i);
    if (length == 0) {
      const auto byte = static_cast<unsigned char>(text[i]);
      throw SpecError(fmt::format(
          "{}:{}:{}: byte {:#04x} at offset {} {}; a spec file is text in UTF-8. Is it the right "
          "file? If so, save it as UTF-8",
          source, line, i - line_start + 1, byte, i,
          byte == 0 ? "cannot stand in a text" : "is not UTF-8"));
    }
    if (text[i] == '\n') ++line, line_start = i + 1;
    i += length;
  }
}

}  // namespace robocell
