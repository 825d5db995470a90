#include "robocell/spec/yaml_stray.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace robocell::internal::yaml {
namespace {

bool IsNumber(const YAML::Node& key) {
  double number = 0;
  return YAML::convert<double>::decode(key, number);
}

// Returns true if no `:` follows the key: its null is then at its end, except for a blank.
bool IsWithoutColon(const YAML::Node& key, const YAML::Node& null) {
  return null.Mark().pos <= key.Mark().pos + static_cast<int>(key.Scalar().size()) + 1;
}

}  // namespace

Stray::Stray(const YAML::Node& map) : in_braces_(map.Style() == YAML::EmitterStyle::Flow) {}

bool Stray::IsPartOfLast(const YAML::Node& key, const YAML::Node& value, bool strange) {
  const bool after_comma = in_braces_ && has_text_ && value.IsNull() &&
                           (IsNumber(key) || (strange && IsWithoutColon(key, value)));
  const bool not_indented = !in_braces_ && has_no_value_ && strange;
  if (!after_comma && !not_indented) return false;
  parts_.push_back({key.Scalar(), key.Mark().line + 1});
  return true;
}

void Stray::SetLast(const YAML::Node& key, const YAML::Node& value, size_t problems) {
  name_ = key.Scalar();
  has_no_value_ = value.IsNull();
  has_text_ = value.IsScalar();
  value_ = has_text_ ? value.Scalar() : "";
  problems_ = problems;
  parts_.clear();
}

std::string Stray::Text() const {
  if (!in_braces_) {
    return fmt::format(
        "nothing belongs to it: `{}` of line {} begins in the same column; what belongs to `{}` is "
        "indented further than it",
        parts_.front().name, parts_.front().line, name_);
  }
  std::string items = value_;
  for (const Part& part : parts_) items += ", " + part.name;
  return fmt::format(
      "it ends at the comma, and what follows has no name; if a list was meant, write {}: [{}]",
      name_, items);
}

}  // namespace robocell::internal::yaml
