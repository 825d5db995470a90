// Private to assets: problems of a URDF as a whole: its tree, mimic joints, masses.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace robocell::internal {

struct Urdf;

// Collects problems, each with file and line.
class UrdfProblems {
 public:
  explicit UrdfProblems(std::filesystem::path file) : file_(std::move(file)) {}
  void Add(int line, const std::string& text);
  bool empty() const { return texts_.empty(); }
  // Throws SpecError with all of them, one per line, if there are any.
  void Throw() const;

 private:
  std::filesystem::path file_;
  std::vector<std::string> texts_;
};

// Sets the root, and adds a problem for every fault: repeated names, links that do not exist,
// several or no roots, circles, floating joints below others, mimic joints without an independent
// leader, moving links without mass or with an impossible inertia.
void ValidateUrdf(Urdf& urdf, UrdfProblems& problems);

}  // namespace robocell::internal
