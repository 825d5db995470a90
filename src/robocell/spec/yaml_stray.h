// Entries of a map that were meant as a part of the value before them: what comes after the comma
// of a list without brackets ({arm: 0, 0, 0}), and fields that were not indented below their name.
// Included by yaml*.cc and their tests only.
#pragma once

#include <string>
#include <vector>

namespace YAML {
class Node;
}

namespace robocell::internal::yaml {

// Looks at the entries of one map, in their order.
class Stray {
 public:
  explicit Stray(const YAML::Node& map);

  // Returns true if this entry is no entry of the map but a part of the last one; it is kept then.
  // `strange`: the map has no use for such a name.
  bool IsPartOfLast(const YAML::Node& key, const YAML::Node& value, bool strange);
  // An entry of the map; there were `problems` before it was read.
  void SetLast(const YAML::Node& key, const YAML::Node& value, size_t problems);

  // Of the last entry: its problems begin there, and what to say of it with all its parts.
  size_t problems() const { return problems_; }
  std::string Text() const;

 private:
  struct Part {
    std::string name;
    int line = 0;  // from 1
  };
  bool in_braces_;
  std::string name_, value_;
  bool has_no_value_ = false, has_text_ = false;
  size_t problems_ = 0;
  std::vector<Part> parts_;
};

}  // namespace robocell::internal::yaml
