#include "keyframe_choice.h"

#include <string>
#include <utility>

#include "bindings.h"
#include "number_like.h"

namespace robocell::python {
namespace {

bool ToPartKeyframe(nb::handle value, PartKeyframe& out) {
  if (PyUnicode_Check(value.ptr())) {
    out = nb::cast<std::string>(value);
    return true;
  }
  if (IsBool(value) || PyIndex_Check(value.ptr()) == 0) return false;
  const nb::object whole = nb::steal(PyNumber_Index(value.ptr()));
  int number = 0;
  if (!whole.is_valid() || !nb::try_cast(whole, number)) {
    PyErr_Clear();
    return false;
  }
  out = number;
  return true;
}

}  // namespace

bool ToKeyframe(nb::handle value, KeyframeChoice& out) {
  if (PartKeyframe key; ToPartKeyframe(value, key)) {
    std::visit([&](auto& kept) { out = std::move(kept); }, key);
    return true;
  }
  if (PyMapping_Check(value.ptr()) == 0 || !nb::hasattr(value, "items")) return false;
  PartKeyframes keys;
  for (const nb::handle item : nb::iter(value.attr("items")())) {
    std::string part;
    if (!nb::try_cast(item[0], part) || !ToPartKeyframe(item[1], keys[part])) return false;
  }
  out = std::move(keys);
  return true;
}

}  // namespace robocell::python
