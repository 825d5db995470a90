// ValueFields: the fields of a kind of task that has no C++ struct, such as one written in Python:
// names with values, whose types and defaults are those that were registered.
//
//   RegisterTaskFields("stack", std::make_shared<ValueFields>(ValueFields({{"height", 0.05}})));
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "robocell/spec/task_spec.h"

namespace robocell {

struct ValueField {
  using Value = std::variant<bool, int64_t, double, std::string, std::vector<double>,
                             std::vector<std::string>>;
  std::string name;
  Value value;
  std::string doc = {};
};

class ValueFields final : public TaskFields {
 public:
  explicit ValueFields(std::vector<ValueField> fields) : fields_(std::move(fields)) {}

  std::vector<ValueField>& list() { return fields_; }
  const std::vector<ValueField>& list() const { return fields_; }
  // Null for a name that is none of the fields'.
  ValueField* find(const std::string& name);

  std::shared_ptr<TaskFields> Clone() const override;
  std::vector<TaskFieldRef> refs() override;
  std::string type_name() const override { return "task"; }
  void* value() override { return this; }
  const std::type_info& type() const override { return typeid(ValueFields); }

 private:
  std::vector<ValueField> fields_;
};

}  // namespace robocell
