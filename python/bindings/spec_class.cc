#include "spec_class.h"

#include <deque>

namespace robocell::python {

const char* KeepText(std::string text) {
  static std::deque<std::string> texts;
  return texts.emplace_back(std::move(text)).c_str();
}

std::string InitSignature(const std::vector<Field>& fields) {
  std::string out = "def __init__(self, *";
  for (const Field& field : fields) {
    out += fmt::format(", {}: {} = ...", field.name, field.set_type);
  }
  return out + ") -> None";
}

std::string ReprOf(const std::vector<Field>& fields, const char* type, void* spec,
                   const void* plain, nb::handle self) {
  std::string out;
  for (const Field& field : fields) {
    if (field.equal(spec, plain)) continue;
    nb::object value = field.get(spec, self);
    if (nb::hasattr(value, "tolist")) value = value.attr("tolist")();
    out += fmt::format("{}{}={}", out.empty() ? "" : ", ", field.name, nb::repr(value).c_str());
  }
  return fmt::format("{}({})", type, out);
}

nb::object AllocateLike(nb::handle self) { return nb::inst_alloc(self.type()); }

void CopyAttributes(nb::handle from, nb::handle to) {
  if (!nb::hasattr(from, "__dict__")) return;
  nb::object attributes = to.attr("__dict__");
  attributes.attr("update")(from.attr("__dict__"));
}

}  // namespace robocell::python
