#include "robocell/spec/env_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/pinned_values.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

bool HasGroup(const RobotConfig& config, MoveGroupKind kind) {
  for (const auto& [name, group] : config.move_groups.entries()) {
    if (group->kind == kind) return true;
  }
  return false;
}

// Every key of `gripper_offsets: {lft: ...}` must be a robot.
void ValidateRobotKeys(const std::vector<std::string>& keys, std::string_view field,
                       const EnvConfig& env, Problems& problems) {
  Problems::Scope scope(problems, field);
  for (const std::string& key : keys) {
    if (!env.robots.contains(key))
      problems.AddAt(key, NoSuchName("", "robot", key, env.robots.keys()));
  }
}

// A part at a robot's attachment site requires the site.
void RequireAttachmentSite(const EnvConfig& env, const std::string& robot, const std::string& what,
                           Problems& problems) {
  const RobotConfig* config = env.robots.find(robot);
  if (!config || config->attachment_site) return;
  Problems::Scope list(problems, "robots");
  Problems::Scope item(problems, robot);
  problems.AddAt("attachment_site",
                 fmt::format("is not set, but {} is mounted there; name the site of the robot's "
                             "model that tools go to",
                             what));
}

void ValidateGrippers(const EnvConfig& env, Problems& problems) {
  for (const auto& [robot, gripper] : env.grippers.entries()) {
    RequireAttachmentSite(env, robot, "its gripper", problems);
    if (HasGroup(*gripper, MoveGroupKind::kGripper) && !HasGroup(*gripper, MoveGroupKind::kArm))
      continue;
    Problems::Scope list(problems, "grippers");
    Problems::Scope item(problems, robot);
    problems.AddAt("move_groups",
                   "a gripper's configuration has a group of kind gripper and none of kind arm; a "
                   "robot with arm and gripper goes into `robots`");
  }
  for (const std::string& robot : env.gripper_offsets.keys()) {
    if (!env.robots.contains(robot) || env.has_mounted_gripper(robot)) continue;
    Problems::Scope list(problems, "gripper_offsets");
    problems.AddAt(robot, env.grippers.contains(robot)
                              ? "the robot already has a gripper, which stays"
                              : "the robot has no gripper in `grippers`");
  }
}

// Robots without a pose overlap.
void ValidateStands(const EnvConfig& env, Problems& problems) {
  if (!env.alternative_combined_robot_mjcf.empty()) {
    if (!env.robot_to_shared_base_frame.empty())
      problems.AddAt("robot_to_shared_base_frame",
                     "the robots stand where alternative_combined_robot_mjcf has them; leave one "
                     "of the two out");
    return;
  }
  constexpr double kSame = 1e-6;  // m and rad
  const std::vector<std::string> names = env.robots.keys();
  for (size_t i = 0; i < names.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (!env.robot_in_shared_base(names[i]).is_close(env.robot_in_shared_base(names[j]), kSame,
                                                       kSame))
        continue;
      problems.AddAt("robot_to_shared_base_frame",
                     fmt::format("robots '{}' and '{}' stand at the same place; give each its pose "
                                 "in the shared base frame",
                                 names[j], names[i]));
      return;
    }
  }
}

// No step is longer than an arm or turns further than half a turn: such limits have other units. A
// joint may turn further, and a slide is not as long.
void ValidateUnitsOfStep(const EnvConfig& env, Problems& problems) {
  constexpr double kMostLength = 5, kMostJoint = 4 * internal::kPi;
  const std::vector<double>& limit = env.max_relative_movement;
  const bool joints = env.control_mode == ControlMode::kJoints;
  if (limit.size() != (joints ? 1 : 2)) return;
  const auto refuse = [&](double value, double most, const char* unit, const char* what) {
    if (!std::isfinite(value) || value <= most) return false;
    problems.AddAt("max_relative_movement",
                   fmt::format("{:g} {} is too much for {}: the numbers are in {}", value, unit,
                               what, joints ? "radians (metres for slides)" : "[metres, radians]"));
    return true;
  };
  if (joints) {
    refuse(limit[0], kMostJoint, "rad", "the step of a joint");
  } else if (!refuse(limit[0], kMostLength, "m", "the way of a step")) {
    refuse(limit[1], internal::kPi, "rad", "the turn of a step");
  }
}

// Requires one number for joints, two for poses, or none.
void ValidateLimitOfMode(const EnvConfig& env, const char* field, const std::vector<double>& limit,
                         Problems& problems) {
  const size_t count = limit.size();
  const bool joints = env.control_mode == ControlMode::kJoints;
  if (count == 0) return;
  if (count == (joints ? 1 : 2)) return;
  problems.AddAt(
      field, fmt::format("with control_mode {} it is {}; found {} {}", ToString(env.control_mode),
                         joints ? "one number, radians (metres for slides)"
                                : "two numbers, [metres, radians]",
                         count, count == 1 ? "number" : "numbers"));
}

// An object's mass only matters if it can move.
void ValidateVariedMass(const EnvObject& object, const ObjectVariation& range, Problems& problems) {
  const ObjectVariation plain;
  if (!object.fixed.value_or(false) || range.mass == plain.mass) return;
  problems.AddAt("mass",
                 "changes nothing of an object that is `fixed: true`; leave it out, or let the "
                 "object move with `fixed: false`");
}

void ValidateVariations(const EnvConfig& env, Problems& problems) {
  std::vector<std::string> known = env.root_frame_objects.keys();
  for (const std::string& id : env.world_frame_objects.keys()) known.push_back(id);
  Problems::Scope scope(problems, "variations");
  for (const auto& [id, range] : env.variations.entries()) {
    Problems::Scope entry(problems, id);
    const EnvObject* object = env.root_frame_objects.find(id);
    if (!object) object = env.world_frame_objects.find(id);
    if (object)
      ValidateVariedMass(*object, *range, problems);
    else
      problems.Add(NoSuchName("", "object", id, known));
  }
}

// What an environment, whose scene is compiled once, randomises.
void ValidateRandomize(const EnvConfig& env, Problems& problems) {
  if (!env.randomize) return;
  Problems::Scope scope(problems, "randomize");
  if (!env.variations.empty()) {
    problems.Add(
        "both this and `variations` change masses, frictions and colours; write {dynamics: {ID: "
        "{mass: {scale: {uniform: [0.8, 1.2]}}}}} here, and leave `variations` out");
  }
  if (env.randomize->clutter) {
    problems.AddAt("clutter",
                   "is for runs, which compile the scene of each start; an environment compiles "
                   "its scene once: add objects to root_frame_objects");
  }
  const std::optional<double> delay = internal::LongestDelay(*env.randomize);
  if (!delay) return;
  const char* field =
      env.randomize->pinned.contains("action_delay") ? "pinned.action_delay" : "action_delay";
  if (!env.sim.async_control && (*delay > 0 || env.randomize->action_delay)) {
    problems.AddAt(field,
                   "needs steps of a fixed time: set `sim: {async_control: true}`, or leave it "
                   "out");
  } else if (env.sim.frequency > 0 && *delay > 1 / env.sim.frequency + 1e-9) {
    problems.AddAt(field,
                   fmt::format("can be {:g} s, and a step takes {:g} s: the delay is at most that",
                               *delay, 1 / env.sim.frequency));
  }
}

// An environment's objects, which have one id each and stand in the right frame: adds a problem for
// an id that is used twice (which decides between frames), that is a robot's name, or whose
// elements would have names that begin like those of a robot or gripper.
constexpr const char* kObjectFrames =
    "world_frame_objects stay in the room, root_frame_objects move with the rig, "
    "robot_frame_objects follow a robot's wrist";

class EnvObjectValidator {
 public:
  EnvObjectValidator(const EnvConfig& env, Problems& problems) : env_(env), problems_(problems) {}

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
    problems_.AddAt(
        id, fmt::format("is in {} too; keep one of them ({})", known->second, kObjectFrames));
  }

  void ValidateNotOfARobot(const std::string& id) {
    for (const std::string& robot : env_.robots.keys()) {
      if (id == robot) {
        problems_.AddAt(id, fmt::format("is the name of a robot. What follows its wrist goes into "
                                        "robot_frame_objects: {{{}: {{id: ...}}}} ({})",
                                        robot, kObjectFrames));
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

bool IsStreamed(const EnvConfig& env, const std::string& camera) {
  for (const CameraConfig& stream : env.cameras.streams) {
    if (stream.camera == camera) return true;
  }
  return false;
}

// Returns "stream 'a' takes images of 'wirst'. Did you mean 'wrist'?" for a stream whose camera is
// spelt almost like this one; "" if there is none.
std::string StreamNear(const EnvConfig& env, const std::string& camera) {
  for (const CameraConfig& stream : env.cameras.streams) {
    if (const std::string meant = DidYouMean(stream.camera, {camera}); !meant.empty())
      return fmt::format("stream '{}' takes images of '{}'.{}", stream.name, stream.camera, meant);
  }
  return "";
}

void ValidateCameraAdds(const EnvConfig& env, Problems& problems) {
  for (const auto& [name, camera] : env.camera_adds.entries()) {
    if (!camera->robot_name.empty() && camera->attachment_site.empty())
      RequireAttachmentSite(env, camera->robot_name, "camera '" + name + "'", problems);
    Problems::Scope list(problems, "camera_adds");
    ValidateNamePart(name, name, problems);
    Problems::Scope item(problems, name);
    if (!camera->robot_name.empty() && !env.robots.contains(camera->robot_name)) {
      problems.AddAt("robot_name",
                     NoSuchName("", "robot", camera->robot_name, env.robots.keys()) +
                         " Unset, the camera belongs to the rig, and its offset is in the root "
                         "frame");
    }
    // A camera model may be there for its housing alone.
    if (camera->xml_path.empty() && !IsStreamed(env, name)) {
      const std::string misspelt = StreamNear(env, name);
      problems.Add(misspelt.empty()
                       ? fmt::format("no stream takes images of this camera; add {{name: {0}, "
                                     "camera: {0}}} to cameras.streams, or leave the camera out",
                                     name)
                       : fmt::format("no stream takes images of this camera, and {}", misspelt));
    }
  }
}

}  // namespace

StepLimit EnvConfig::step_limit() const {
  const bool joints = control_mode == ControlMode::kJoints;
  if (!max_relative_movement.empty()) {
    return joints ? StepLimit{0, max_relative_movement[0]}
                  : StepLimit{max_relative_movement[0], max_relative_movement[1]};
  }
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (relative_to == RelativeTo::kNone) return {kNone, kNone};
  return {0.5, (joints ? 5 : 90) * internal::kPi / 180};
}

StepLimit EnvConfig::target_lead() const {
  if (max_target_lead.empty()) return {0.02, 0.1};
  StepLimit lead{max_target_lead.front(), max_target_lead.back()};
  if (control_mode == ControlMode::kJoints) return lead;
  // Rotations that are half a turn apart have no direction: with the next action a target must stay
  // nearer than that, or nothing bounds it any more.
  constexpr double kLeastLead = 0.1, kUsualStep = internal::kPi / 2;
  const double limit = step_limit().rotation;
  const double step = std::isfinite(limit) ? limit : kUsualStep;
  lead.rotation = std::min(lead.rotation, std::max(kLeastLead, internal::kPi - step));
  return lead;
}

bool EnvConfig::has_mounted_gripper(const std::string& robot) const {
  const RobotConfig* config = robots.find(robot);
  return config && grippers.contains(robot) && !HasGroup(*config, MoveGroupKind::kGripper);
}

bool EnvConfig::has_added_floor() const { return add_floor.value_or(scene == "empty_world"); }

Pose EnvConfig::robot_in_shared_base(const std::string& robot) const {
  const Pose* pose = robot_to_shared_base_frame.find(robot);
  return pose ? *pose : Pose();
}

namespace {

// A list of one number may be written as that number: its problems are then named without an index.
void NameSingleNumber(const std::vector<double>& list, const char* field, Problems& problems) {
  if (list.size() != 1) return;
  const std::string path = JoinPath(problems.path(), field), entry = path + "[0]";
  problems.Amend(0, [&](Problem& problem) {
    if (problem.path == entry) problem.path = path;
  });
}

}  // namespace

void EnvConfig::Validate(Problems& problems) const {
  ValidateRandomize(*this, problems);
  NameSingleNumber(max_relative_movement, "max_relative_movement", problems);
  NameSingleNumber(max_target_lead, "max_target_lead", problems);
  ValidateNotEmpty(name, "name", "environments are named in messages", problems);
  ValidateNotEmpty(scene, "scene", "the base scene, for example empty_world", problems);
  if (robots.empty())
    problems.AddAt("robots", "an environment needs a robot, for example {robot: xarm7.yaml}");
  for (const std::string& robot : robots.keys()) {
    ValidateNamePart(robot, "robots", problems);
    ValidateNotEmpty(robot, "robots", "a name for each robot, found ''", problems);
  }
  for (const char* taken : {"features", "frames", "objects", "task"}) {
    if (robots.contains(taken))
      problems.AddAt("robots", fmt::format("'{}' is a part of observations; give the robot another "
                                           "name",
                                           taken));
  }
  ValidateRobotKeys(grippers.keys(), "grippers", *this, problems);
  ValidateRobotKeys(gripper_offsets.keys(), "gripper_offsets", *this, problems);
  ValidateRobotKeys(robot_to_shared_base_frame.keys(), "robot_to_shared_base_frame", *this,
                    problems);
  ValidateRobotKeys(robot_frame_objects.keys(), "robot_frame_objects", *this, problems);
  for (const std::string& robot : robot_frame_objects.keys())
    RequireAttachmentSite(*this, robot, "an object of robot_frame_objects", problems);
  ValidateGrippers(*this, problems);
  ValidateStands(*this, problems);
  ValidateLimitOfMode(*this, "max_relative_movement", max_relative_movement, problems);
  ValidateUnitsOfStep(*this, problems);
  ValidateLimitOfMode(*this, "max_target_lead", max_target_lead, problems);
  if (task) task->rules()->ValidateEnv(*this, problems);
  ValidateVariations(*this, problems);
  EnvObjectValidator(*this, problems).ValidateAll();
  ValidateCameraAdds(*this, problems);
}

}  // namespace robocell
