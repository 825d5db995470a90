// Private to scene: the problems and remarks found while a scene is compiled. Problems are
// collected and thrown together, warnings and notes are kept with the compiled scene.
//
// A problem has a place, the affected part of the scene ("robot 'left'"; may be empty), and a
// field, the path of the value in the spec of that part ("move_groups.arm.joints[2]"; empty for the
// part as a whole). Parts that came from a file are located once, with Locate; their problems then
// begin with file:line:column.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/spec/locations.h"

namespace robocell::internal {

class CompileLog {
 public:
  // Sets where the spec of `place` stands in its file. May be called again for a part that several
  // files describe: a field is looked up in all of them, and a field in none of them belongs to the
  // last file that could have it: with the names of `fields`, one whose path begins with such a
  // name.
  void Locate(const std::string& place, Locations locations, std::vector<std::string> fields = {});

  void Problem(const std::string& place, const std::string& message, std::string_view field = "");
  // Adds the text of an exception that was thrown while `place` was processed; the text may begin
  // with the place or one within it.
  void Thrown(const std::string& place, const std::string& text, std::string_view field = "");
  // Adds a problem of the kind "there is no element of this name".
  void Missing(const std::string& place, const std::string& message, std::string_view field = "");
  // Adds a warning for the user's attention: a part does not get a setting that it specifies. With
  // a field, it begins with file:line:column where known.
  void Warn(const std::string& place, const std::string& message, std::string_view field = "");
  // Adds the same for a place in another file, "arm.xml:12".
  void WarnAt(const std::string& source, const std::string& place, const std::string& message);
  // Adds a remark that needs no change.
  void Note(const std::string& place, const std::string& message);

  // Returns the place of a field of a located part, "left.yaml:7:12"; "" if unknown.
  std::string SourceOf(const std::string& place, std::string_view field) const;

  bool ok() const { return problems_.empty(); }
  size_t problem_count() const { return problems_.size(); }
  // Throws unless ok: NotFoundError if all problems are missing elements, else SpecError. One
  // problem: "scene 'pick' / robot 'left': message"; several: one line each. With locations,
  // "left.yaml:7:12: robot 'left': message".
  void Throw(const std::string& scene) const;
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct Entry {
    std::string place, message, source;
  };
  struct Described {
    bool CouldHave(std::string_view field) const;
    Locations locations;
    std::vector<std::string> fields;  // empty: any
  };
  // Returns "scene 'pick'", or the common file of all problems.
  std::string Subject(const std::string& scene) const;

  std::map<std::string, std::vector<Described>> locations_;
  std::vector<Entry> problems_;
  bool only_missing_ = true;
  std::vector<std::string> warnings_, notes_;
};

}  // namespace robocell::internal
