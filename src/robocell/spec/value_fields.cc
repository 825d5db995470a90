#include "robocell/spec/value_fields.h"

#include <algorithm>

namespace robocell {

ValueField* ValueFields::find(const std::string& name) {
  const auto found = std::ranges::find(fields_, name, &ValueField::name);
  return found == fields_.end() ? nullptr : &*found;
}

std::shared_ptr<KindFields> ValueFields::Clone() const {
  return std::make_shared<ValueFields>(*this);
}

std::vector<KindFieldRef> ValueFields::refs() {
  std::vector<KindFieldRef> refs;
  for (ValueField& field : fields_) {
    KindFieldRef& ref = refs.emplace_back();
    ref.name = field.name;
    ref.doc = field.doc;
    std::visit([&](auto& value) { ref.value = &value; }, field.value);
  }
  return refs;
}

}  // namespace robocell
