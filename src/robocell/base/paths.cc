#include "robocell/base/paths.h"

#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <deque>
#include <string>
#include <system_error>

#include "robocell/base/error.h"
#include "robocell/base/io_error.h"

namespace robocell::internal {
namespace fs = std::filesystem;
namespace {

constexpr int kMostLinks = 40;  // the limit of Linux

// A NUL would truncate a message.
std::string Shown(std::string_view path) {
  std::string shown(path);
  for (size_t at; (at = shown.find('\0')) != std::string::npos;) shown.replace(at, 1, "\\0");
  return shown;
}

[[noreturn]] void Refuse(const fs::path& root, std::string_view relative, std::string_view reason) {
  throw ArgumentError(fmt::format("path '{}' {}; it must lead to a place inside '{}'",
                                  Shown(relative), reason, root.native()));
}

bool IsInside(const fs::path& path, const fs::path& root) {
  return std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first == root.end();
}

// Returns where `path`, an absolute one, leads when all links are followed. Unlike
// std::filesystem::weakly_canonical it follows links whose target does not exist. "" if there are
// too many links.
fs::path FollowLinks(const fs::path& path) {
  std::deque<fs::path> rest(path.begin(), path.end());
  fs::path current;
  int links = 0;
  while (!rest.empty()) {
    const fs::path part = rest.front();
    rest.pop_front();
    if (part.empty() || part == ".") continue;
    if (part == "..") {
      current = current.parent_path();
      continue;
    }
    std::error_code error;
    const fs::path target = fs::read_symlink(current / part, error);
    if (error) {  // not a link
      current /= part;
      continue;
    }
    if (++links > kMostLinks) return {};
    if (target.is_absolute()) current.clear();
    rest.insert(rest.begin(), target.begin(), target.end());
  }
  return current;
}

fs::path Absolute(const fs::path& path) {
  std::error_code error;
  fs::path absolute = fs::absolute(path, error);
  if (error) ThrowIoError("find", path, error.value());
  return absolute;
}

std::string_view FileNameProblem(std::string_view name) {
  if (name.empty()) return "is empty";
  if (name == "." || name == "..") return "means a folder";
  if (name.size() > 255) return "is longer than 255 bytes";
  for (const char c : name) {
    if (c == '/') return "contains '/'";
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return "contains a control character";
  }
  return "";
}

}  // namespace

fs::path ConfinedPath(const fs::path& root, std::string_view relative) {
  if (relative.empty()) Refuse(root, relative, "is empty");
  if (relative.size() >= PATH_MAX) {  // no system call accepts it, and its links take long
    Refuse(root, "...",
           fmt::format("has {} bytes, more than the {} of a path", relative.size(), PATH_MAX - 1));
  }
  if (relative.find('\0') != std::string_view::npos) Refuse(root, relative, "contains a NUL byte");
  const fs::path path(relative);
  if (path.is_absolute()) Refuse(root, relative, "is absolute");
  for (const fs::path& part : path) {
    if (part == "..") Refuse(root, relative, "contains '..'");
  }
  const fs::path place = FollowLinks(Absolute(root / path));
  if (place.empty()) Refuse(root, relative, "goes through too many symbolic links");
  if (!IsInside(place, FollowLinks(Absolute(root)))) {
    Refuse(root, relative, fmt::format("leads to '{}' through a symbolic link", place.native()));
  }
  return root / path.lexically_normal();
}

void RequireNoNul(std::string_view what, std::string_view path) {
  if (path.find('\0') == std::string_view::npos) return;
  throw ArgumentError(
      fmt::format("{} '{}' contains a NUL byte, where the system would end it; remove that byte",
                  what, Shown(path)));
}

bool ValidFileName(std::string_view name) { return FileNameProblem(name).empty(); }

void RequireFileName(std::string_view what, std::string_view name) {
  const std::string_view problem = FileNameProblem(name);
  if (problem.empty()) return;
  throw ArgumentError(fmt::format("{} name '{}' {}, but it becomes a file name", what,
                                  name.substr(0, name.find('\0')), problem));
}

namespace {

// Independent of the locale's letters.
bool IsPlain(char c) {
  const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  const bool digit = c >= '0' && c <= '9';
  return letter || digit || std::string_view("_@%+=:,./-").find(c) != std::string_view::npos;
}

}  // namespace

std::string ShellWord(std::string_view text) {
  if (!text.empty() && std::all_of(text.begin(), text.end(), IsPlain)) return std::string(text);
  std::string word = "'";
  for (const char c : text) {
    if (c == '\'') {
      word += "'\"'\"'";
    } else {
      word += c;
    }
  }
  return word + "'";
}

}  // namespace robocell::internal
