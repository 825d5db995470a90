#include "robocell/spec/scene_object.h"

#include "robocell/spec/validate.h"

namespace robocell {
namespace {

void ValidatePrimitive(const SceneObject& o, Problems& problems) {
  if (!o.size)
    problems.AddAt("size", "a primitive needs its half sizes, for example [0.02, 0.02, 0.02]");
  if (!o.rgba) problems.AddAt("rgba", "a primitive needs a colour, for example [1, 0.5, 0, 1]");
  if (!o.mass) problems.AddAt("mass", "a primitive needs its mass in kg");
  if (!o.friction)
    problems.AddAt("friction", "a primitive needs its friction, for example [0.8, 0.02, 0.001]");
  if (!o.size) return;
  const int used = *o.shape == Shape::kBox ? 3 : *o.shape == Shape::kCylinder ? 2 : 1;
  for (int i = 0; i < used; ++i) {
    if ((*o.size)[i] <= 0) {
      problems.AddAt("size", std::string("a ") + ToString(*o.shape) + " needs " +
                                 std::to_string(used) + " sizes above 0");
      break;
    }
  }
}

}  // namespace

void SceneObject::Validate(Problems& problems) const {
  ValidateNotEmpty(name, "name", "objects are looked up by name", problems);
  ValidateNamePart(name, "name", problems);
  ValidatePlacement(euler, quat, problems);
  if (shape && !mjcf_path.empty())
    problems.Add("has both a shape and an mjcf_path; keep one of them");
  if (!shape && mjcf_path.empty())
    problems.Add("needs a shape (box, sphere, cylinder) or an mjcf_path");
  if (shape) ValidatePrimitive(*this, problems);
  if (!shape && (size || mass || friction || rgba || condim)) {
    problems.Add(
        "size, rgba, mass, friction and condim describe a primitive; a model file has its own");
  }
}

std::string SceneObjectElementName(const std::string& object, const std::string& element) {
  return object + "_" + element;
}

}  // namespace robocell
