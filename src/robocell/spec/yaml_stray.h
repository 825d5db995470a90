// Entries of a map that were meant as a part of the value before them: values after the comma of a
// list without brackets ({arm: 0, 0, 0}), and fields that were not indented below their name.
// Included by yaml*.cc and their tests only.
#pragma once

#include <string>
#include <vector>

namespace YAML {
class Node;
}

namespace robocell::internal::yaml {

// Checks the entries of one map in order.
class Stray {
 public:
  explicit Stray(const YAML::Node& map);

  // Returns true, and keeps the entry, if it is not an entry of the map but a part of the last one.
  // `strange`: the map has no such field.
  bool IsPartOfLast(const YAML::Node& key, const YAML::Node& value, bool strange);
  // Sets the last entry of the map; there were `problems` before it was read.
  void SetLast(const YAML::Node& key, const YAML::Node& value, size_t problems);

  // Return the index of the first problem of the last entry, and the report about it with all its
  // parts.
  size_t problems() const { return problems_; }
  std::string Text() const;

 private:
  struct Part {
    std::string name;
    int line = 0;  // first line: 1
  };
  bool in_braces_;
  std::string name_, value_;
  bool has_no_value_ = false, has_text_ = false;
  size_t problems_ = 0;
  std::vector<Part> parts_;
};

}  // namespace robocell::internal::yaml
