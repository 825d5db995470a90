// Entries of a map that were meant as a part of the value before them: what comes after the comma
// of a list without brackets ({arm: 0, 0, 0}), and fields that were not indented below their name.
// Included by yaml*.cc and their tests only.
#pragma once

#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace robocell::yaml {

// Looks at the entries of one map, in their order.
class Stray {
 public:
  explicit Stray(const YAML::Node& map) : in_braces_(map.Style() == YAML::EmitterStyle::Flow) {}

  // Whether this entry is no entry of the map but a part of the last one; it is kept then.
  // `strange`: the map has no use for such a name.
  bool IsPartOfLast(const YAML::Node& key, const YAML::Node& value, bool strange);
  // An entry of the map; there were `problems` before it was read.
  void SetLast(const YAML::Node& key, const YAML::Node& value, size_t problems);

  // Of the last entry with all that belongs to it.
  const YAML::Node& key() const { return key_; }
  size_t problems() const { return problems_; }
  std::string Text() const;

 private:
  bool in_braces_;
  YAML::Node key_, value_;
  size_t problems_ = 0;
  std::vector<YAML::Node> parts_;  // keys
};

}  // namespace robocell::yaml
