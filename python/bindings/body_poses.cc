#include "body_poses.h"

namespace robocell::python {

BodyPoses ToBodyPoses(nb::handle value, const FieldPath& path) {
  nb::dict given;
  if (!nb::try_cast(value, given)) ThrowType(path, "a dict of names of bodies to poses", value);
  BodyPoses poses;
  for (const auto& [key, item] : given) {
    const std::string name = ToText(key, path);
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
