#include "robocell/scene/compile_log.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/spec/locations.h"

namespace robocell::internal {
namespace {

std::string Line(const std::string& place, const std::string& message) {
  return place.empty() ? message : place + ": " + message;
}

// Returns "left.yaml" for "left.yaml:7:12"; "" without a line.
std::string FileOf(const std::string& source) {
  const size_t column = source.rfind(':');
  if (column == std::string::npos || column == 0) return "";
  const size_t line = source.rfind(':', column - 1);
  return line == std::string::npos ? "" : source.substr(0, line);
}

}  // namespace

bool CompileLog::Described::CouldHave(std::string_view field) const {
  const std::string_view name = field.substr(0, field.find_first_of(".["));
  return name.empty() || fields.empty() ||
         std::find(fields.begin(), fields.end(), name) != fields.end();
}

void CompileLog::Locate(const std::string& place, Locations locations,
                        std::vector<std::string> fields) {
  locations_[place].push_back({std::move(locations), std::move(fields)});
}

std::string CompileLog::SourceOf(const std::string& place, std::string_view field) const {
  const auto found = locations_.find(place);
  if (found == locations_.end()) return "";
  for (const Described& in : found->second) {
    if (const auto source = in.locations.Exactly(field)) return *source;
  }
  std::string source;
  for (const Described& in : found->second) {
    const std::string at = in.CouldHave(field) ? in.locations.At(field) : "";
    if (!at.empty()) source = at;
  }
  return source;
}

void CompileLog::Problem(const std::string& place, const std::string& message,
                         std::string_view field) {
  only_missing_ = false;
  problems_.push_back({place, message, SourceOf(place, field)});
}

void CompileLog::Thrown(const std::string& place, const std::string& text, std::string_view field) {
  only_missing_ = false;
  const auto [source, message] = SplitPlace(text);
  const bool placed = !place.empty() && message.starts_with(place);
  problems_.push_back(
      {placed ? "" : place, message, source.empty() ? SourceOf(place, field) : source});
}

void CompileLog::Missing(const std::string& place, const std::string& message,
                         std::string_view field) {
  problems_.push_back({place, message, SourceOf(place, field)});
}

void CompileLog::Warn(const std::string& place, const std::string& message,
                      std::string_view field) {
  WarnAt(field.empty() ? "" : SourceOf(place, field), place, message);
}

void CompileLog::WarnAt(const std::string& source, const std::string& place,
                        const std::string& message) {
  warnings_.push_back(Line(source, Line(place, message)));
}

void CompileLog::Note(const std::string& place, const std::string& message) {
  notes_.push_back(Line(place, message));
}

std::string CompileLog::Subject(const std::string& scene) const {
  const std::string file = FileOf(problems_[0].source);
  const auto there = [&](const Entry& entry) { return FileOf(entry.source) == file; };
  const bool all = !file.empty() && std::all_of(problems_.begin(), problems_.end(), there);
  return all ? file : "scene '" + scene + "'";
}

void CompileLog::Throw(const std::string& scene) const {
  if (ok()) return;
  std::string text;
  if (problems_.size() == 1) {
    const Entry& only = problems_[0];
    const std::string line = Line(only.place, only.message);
    text = !only.source.empty() ? only.source + ": " + line
           : only.place.empty() ? fmt::format("scene '{}': {}", scene, line)
                                : fmt::format("scene '{}' / {}", scene, line);
  } else {
    text = fmt::format("{} has {} problems:", Subject(scene), problems_.size());
    for (const Entry& entry : problems_) {
      text += "\n  " + Line(entry.source, Line(entry.place, entry.message));
    }
  }
  if (only_missing_) throw NotFoundError(text);
  throw SpecError(text);
}

}  // namespace robocell::internal
