#include "robocell/spec/yaml_stray.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace robocell::yaml {

bool Stray::IsPartOfLast(const YAML::Node& key, const YAML::Node& value, bool strange) {
  if (!key_.IsScalar()) return false;  // nothing came before
  const bool after_comma = in_braces_ && value.IsNull() && value_.IsScalar();
  const bool not_indented = !in_braces_ && value_.IsNull() && strange;
  if (!after_comma && !not_indented) return false;
  parts_.push_back(key);
  return true;
}

void Stray::SetLast(const YAML::Node& key, const YAML::Node& value, size_t problems) {
  key_.reset(key);
  value_.reset(value);
  problems_ = problems;
  parts_.clear();
}

std::string Stray::Text() const {
  const std::string& name = key_.Scalar();
  if (!in_braces_) {
    return fmt::format(
        "nothing belongs to it: `{}` of line {} begins in the same column; what belongs to `{}` is "
        "indented further than it",
        parts_.front().Scalar(), parts_.front().Mark().line + 1, name);
  }
  std::vector<std::string> items = {value_.Scalar()};
  for (const YAML::Node& part : parts_) items.push_back(part.Scalar());
  return fmt::format(
      "it ends at the comma, and what follows has no name; if a list was meant, write {}: [{}]",
      name, fmt::join(items, ", "));
}

}  // namespace robocell::yaml
