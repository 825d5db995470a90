// Private to scene: the files that the models of a scene are read from, and whether they are still
// as they were when it is compiled again, with an object more or less.
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
  // As they are now. What cannot be found is the compiler's to log.
  explicit SourceFiles(const SceneSpec& spec);

  // The first of both whose time or size differs, "" when there is none.
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
