// Collects all problems of a spec, so that they are reported together.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/spec/locations.h"

namespace robocell {

struct Problem {
  std::string path;  // "robots[0].pos"; "" for the whole
  std::string message;
  std::string source;  // "file.yaml:12:5" if it came from a file
};

// Returns a label for messages: "object 'red_cube'", or "" without a name.
inline std::string LabelOf(std::string_view kind, const std::string& name) {
  return name.empty() ? "" : std::string(kind) + " '" + name + "'";
}

// The label of an entry of a list, for types that have one.
template <class T>
std::string LabelOf(const T& entry) {
  if constexpr (requires { entry.Label(); }) return entry.Label();
  return "";
}

class Problems {
 public:
  // Appends to the path during its lifetime.
  class Scope {
   public:
    Scope(Problems& problems, std::string_view key);
    Scope(Problems& problems, size_t index);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Problems& problems_;
    size_t length_;
  };

  // `locations`: those of the checked spec.
  explicit Problems(Locations locations = {}) : locations_(std::move(locations)) {}

  // Adds a problem at the current path, or at `field` below it. A message that begins with its own
  // place, from an exception of a part, keeps that place instead.
  void Add(const std::string& message);
  void AddAt(std::string_view field, const std::string& message);
  void AddFromSource(const std::string& source, const std::string& message);
  void AddProblem(Problem problem) { list_.push_back(std::move(problem)); }
  // Adds the problems that were found in the value at the current path.
  void AppendBelow(const Problems& other);

  // Gives the entry at `index` of the list at the current path a label: messages then say
  // "object 'red_cube' (objects[1]).mass", not "objects[1].mass". It may come after the entry's
  // problems. An empty label changes nothing.
  void NameEntry(size_t index, const std::string& label);
  // Returns a problem's path as messages show it, with the labels of the entries on it.
  std::string Shown(const std::string& path) const;

  // Calls f(Problem&) for the problems from number `first` on.
  template <class F>
  void Amend(size_t first, F&& f) {
    for (size_t i = first; i < list_.size(); ++i) f(list_[i]);
  }

  // Removes the problems from number `count` on.
  void Truncate(size_t count) { list_.resize(std::min(count, list_.size())); }

  bool empty() const { return list_.empty(); }
  const std::vector<Problem>& list() const { return list_; }
  const std::string& path() const { return path_; }

  // Returns "<what> is not valid, 2 problems:\n  file:1:2: path: message\n  ..." or, for one
  // problem, a single line.
  std::string Text(std::string_view what) const;
  // Throws SpecError with that text unless empty.
  void Throw(std::string_view what) const;

 private:
  Locations locations_;
  std::string path_;
  std::vector<Problem> list_;
  std::map<std::string, std::string> labels_;  // path of an entry -> its label
};

// Returns one text for each problem, "file.yaml:1:2: path: message": for warnings, which are listed
// instead of thrown.
inline std::vector<std::string> LinesOf(const Problems& problems) {
  std::vector<std::string> lines;
  for (const Problem& problem : problems.list()) {
    std::string& line = lines.emplace_back();
    if (!problem.source.empty()) line += problem.source + ": ";
    if (!problem.path.empty()) line += problems.Shown(problem.path) + ": ";
    line += problem.message;
  }
  return lines;
}

}  // namespace robocell
