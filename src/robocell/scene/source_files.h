// Private to scene: the files that the models of a scene are read from, and whether they are
// unchanged when it is compiled again after an object was added or removed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "robocell/spec/scene_spec.h"

namespace robocell {

class SourceFiles {
 public:
  SourceFiles() = default;
  // Stores their present state. The compiler logs missing files.
  explicit SourceFiles(const SceneSpec& spec);

  // Returns the first file of both whose time or size differs, "" if there is none.
  std::string Difference(const SourceFiles& other) const;

 private:
  struct Stamp {
    std::filesystem::file_time_type time;
    uintmax_t size = 0;
    bool operator==(const Stamp&) const = default;
  };
  std::map<std::filesystem::path, Stamp> stamps_;
};

}  // namespace robocell
