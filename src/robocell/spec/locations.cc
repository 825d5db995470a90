#include "robocell/spec/locations.h"

#include <algorithm>
#include <cctype>

namespace robocell {

namespace {

// Returns true if an entry of a list or map that is not in the file was added to it later: the
// locations of the fields around it do not apply. A list whose entries have no locations of their
// own was written in another form.
bool IsAddedLater(const SourceMap& sources, const std::string& list, bool is_index) {
  if (!is_index) return sources.contains(list + std::string(kAnyKey));
  return !sources.contains(list) || sources.contains(list + "[0]");
}

// Returns the location of the path or of the nearest part around it; "" if there is none.
std::string NearestSource(const SourceMap& sources, std::string path) {
  for (bool is_around = false;; is_around = true) {
    if (is_around) {
      const auto file = sources.find(path + std::string(kOwnFile));
      if (file != sources.end()) return file->second;
    }
    if (const auto it = sources.find(path); it != sources.end()) return it->second;
    if (path.empty()) return "";
    const size_t cut = path.find_last_of(".[");
    const bool is_index = cut != std::string::npos && path[cut] == '[';
    path.resize(cut == std::string::npos ? 0 : cut);
    if (cut != std::string::npos && IsAddedLater(sources, path, is_index)) return "";
  }
}

}  // namespace

std::string JoinPath(std::string_view path, std::string_view below) {
  const bool dot = !path.empty() && !below.empty() && below.front() != '[';
  return std::string(path) + (dot ? "." : "") + std::string(below);
}

std::optional<std::string> Locations::Exactly(std::string_view path) const {
  if (!sources_) return std::nullopt;
  const auto it = sources_->find(JoinPath(base_, path));
  if (it == sources_->end()) return std::nullopt;
  return it->second;
}

std::string Locations::At(std::string_view path) const {
  return sources_ ? NearestSource(*sources_, JoinPath(base_, path)) : "";
}

Locations Locations::Below(std::string_view path) const {
  return Locations(sources_, JoinPath(base_, path));
}

namespace {

constexpr std::string_view kEnd = ": ";

// Removes ":12" from the end; returns false if there is no such suffix.
bool CutNumber(std::string_view& text) {
  const size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon + 1 == text.size()) return false;
  const std::string_view digits = text.substr(colon + 1);
  text = text.substr(0, colon);
  return std::all_of(digits.begin(), digits.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

}  // namespace

std::pair<std::string, std::string> SplitPlace(std::string_view message) {
  const size_t end = message.find(kEnd);
  std::string_view file = message.substr(0, std::min(end, message.size()));
  const std::string place(file);
  const bool found = end != std::string_view::npos && CutNumber(file) && CutNumber(file) &&
                     !file.empty() && file.find('\n') == std::string_view::npos;
  if (!found) return {"", std::string(message)};
  return {place, std::string(message.substr(end + kEnd.size()))};
}

std::string WithPlace(const std::string& place, const std::string& message) {
  if (place.empty() || !SplitPlace(message).first.empty()) return message;
  return place + ": " + message;
}

}  // namespace robocell
