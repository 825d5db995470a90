#include "robocell/spec/validate_env_objects.h"

#include <fmt/format.h>

#include <map>

#include "robocell/spec/validate.h"

namespace robocell::internal {
namespace {

constexpr const char* kFrames =
    "world_frame_objects stay in the room, root_frame_objects move with the rig, "
    "robot_frame_objects follow a robot's wrist";

class ObjectValidator {
 public:
  ObjectValidator(const EnvConfig& env, Problems& problems) : env_(env), problems_(problems) {}

  void ValidateAll() {
    ValidateFrame("world_frame_objects", env_.world_frame_objects);
    ValidateFrame("root_frame_objects", env_.root_frame_objects);
    for (const auto& [robot, objects] : env_.robot_frame_objects.entries()) {
      ValidateFrame("robot_frame_objects." + robot, *objects);
    }
  }

 private:
  void ValidateFrame(const std::string& field, const Map<EnvObject>& objects) {
    Problems::Scope scope(problems_, field);
    for (const std::string& id : objects.keys()) {
      ValidateNamePart(id, id, problems_);
      ValidateOnce(field, id);
      ValidateNotOfARobot(id);
      if (env_.camera_adds.contains(id)) {
        problems_.AddAt(id, "is also the name of a camera in camera_adds; give one another name");
      }
    }
  }

  void ValidateOnce(const std::string& field, const std::string& id) {
    const auto [known, is_new] = field_of_.emplace(id, field);
    if (is_new) return;
    problems_.AddAt(id, fmt::format("is in {} too; keep one of them ({})", known->second, kFrames));
  }

  void ValidateNotOfARobot(const std::string& id) {
    for (const std::string& robot : env_.robots.keys()) {
      if (id == robot) {
        problems_.AddAt(id, fmt::format("is the name of a robot. What follows its wrist goes into "
                                        "robot_frame_objects: {{{}: {{id: ...}}}} ({})",
                                        robot, kFrames));
      } else if (id == "robot" + robot || id == "gripper" + robot) {
        problems_.AddAt(id, fmt::format("names of its elements would begin with '{}_', as those "
                                        "of robot '{}' do; choose another id",
                                        id, robot));
      }
    }
  }

  const EnvConfig& env_;
  Problems& problems_;
  std::map<std::string, std::string> field_of_;
};

}  // namespace

void ValidateEnvObjects(const EnvConfig& env, Problems& problems) {
  ObjectValidator(env, problems).ValidateAll();
}

}  // namespace robocell::internal
