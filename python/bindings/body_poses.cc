#include "body_poses.h"

namespace robocell::python {

namespace {

constexpr const char* kExpected = "a dict of names of bodies to poses";

// Returns the items of a mapping as pairs. Lists have no items(), but count as mappings in Python's
// C API.
nb::list ItemsOf(nb::handle value, const FieldPath& path) {
  if (!PyMapping_Check(value.ptr()) || !nb::hasattr(value, "items"))
    ThrowType(path, kExpected, value);
  nb::object items = nb::steal(PyMapping_Items(value.ptr()));
  if (!items.is_valid()) throw nb::python_error();
  return nb::cast<nb::list>(items);
}

}  // namespace

BodyPoses ToBodyPoses(nb::handle value, const FieldPath& path) {
  BodyPoses poses;
  for (const nb::handle pair : ItemsOf(value, path)) {
    std::pair<nb::object, nb::object> entry;
    if (!nb::try_cast(pair, entry)) ThrowType(path, kExpected, value);
    const auto& [key, item] = entry;
    const std::string name = ToKey(key, path);
    const Pose* pose = nullptr;
    const bool is_frame = nb::hasattr(item, "M") && nb::hasattr(item, "p");
    if (!is_frame && !(nb::try_cast(item, pose) && pose))
      ThrowType(FieldPath(path, name), "a Pose", item);
    poses.emplace_back(name, is_frame ? nb::cast<Pose>(nb::type<Pose>()(item)) : *pose);
  }
  return poses;
}

nb::dict ToDict(const BodyPoses& poses) {
  nb::dict out;
  for (const auto& [name, pose] : poses) out[name.c_str()] = nb::cast(pose);
  return out;
}

}  // namespace robocell::python
