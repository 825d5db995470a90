// ValueFields: the fields of a kind of task that has no C++ struct, such as one written in Python:
// names with values, whose types and defaults were registered.
//
//   auto fields = std::make_shared<ValueFields>(ValueFields({{"height", 0.05}}));
//   RegisterTask("stack", fields, kind);
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "robocell/spec/kind_fields.h"

namespace robocell {

struct ValueField {
  using Value = std::variant<bool, int64_t, double, std::string, std::vector<double>,
                             std::vector<std::string>>;
  std::string name;
  Value value;
  std::string doc = {};
};

class ValueFields final : public KindFields {
 public:
  // `type_name` is the owner of the fields in messages.
  explicit ValueFields(std::vector<ValueField> fields, std::string type_name = "task")
      : fields_(std::move(fields)), type_name_(std::move(type_name)) {}

  std::vector<ValueField>& list() { return fields_; }
  const std::vector<ValueField>& list() const { return fields_; }
  // Returns null for a name that is not one of the fields.
  ValueField* find(const std::string& name);

  std::shared_ptr<KindFields> Clone() const override;
  std::vector<KindFieldRef> refs() override;
  std::string type_name() const override { return type_name_; }
  void* value() override { return this; }
  const std::type_info& type() const override { return typeid(ValueFields); }

 private:
  std::vector<ValueField> fields_;
  std::string type_name_;
};

}  // namespace robocell
