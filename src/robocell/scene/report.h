// Private to scene: what was found while a scene is compiled. Problems are collected and thrown
// together, warnings are kept with the compiled scene.
#pragma once

#include <string>
#include <vector>

namespace robocell {

class Report {
 public:
  // `place` is the part of the scene, such as "robot 'left'"; it may be empty.
  void Problem(const std::string& place, const std::string& message);
  // A problem of the kind "there is no element of this name".
  void Missing(const std::string& place, const std::string& message);
  void Warn(const std::string& place, const std::string& message);

  bool ok() const { return problems_.empty(); }
  // Throws unless ok: NotFoundError when all that is wrong are missing elements, else SpecError.
  // One problem: "scene 'pick' / robot 'left': message"; several: one line each.
  void Throw(const std::string& scene) const;
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Entry {
    std::string place, message;
  };
  std::vector<Entry> problems_;
  bool only_missing_ = true;
  std::vector<std::string> warnings_;
};

}  // namespace robocell
