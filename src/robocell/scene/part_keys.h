// Private to scene: the keyframes of a part's own model, by the names of the elements that they
// set. The scene drops the keys themselves, which would keep the other parts at their reference,
// and writes its own (scene_keys.h).
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "robocell/math/pose.h"

namespace robocell::internal {

// The part of a free joint's pose in a keyframe that counts when the scene places the part.
// kWhole: the pose, as from the origin of the file's world. kHeightAndTilt: without its horizontal
// position and heading, for robots that stand where the scene says. kNone: nothing, for objects,
// which the scene places like those without a keyframe.
enum class FreeKeys { kWhole, kHeightAndTilt, kNone };

// The values of one keyframe.
struct PartKey {
  std::string part, own_name;  // robot or object of a scene's preset, and its name there

  // Place of a value in its file, for messages.
  struct Source {
    std::string place;  // "robot 'left'"
    std::string field;  // field of the spec that names the file
    std::string file;
    std::string key;   // keyframe's name in the file
    std::string name;  // joint's or actuator's name in the file
  };
  using Values = std::map<std::string, std::vector<double>>;

  Values qpos, qvel;                  // values by joint
  Values act, ctrl;                   // values by actuator
  std::map<std::string, Pose> mocap;  // poses by body, relative to those in the file
  std::map<std::string, Source> joint_sources, actuator_sources;

  // Moves the values of a joint, actuator or body to its new name.
  void Rename(mjtObj kind, const std::string& from, const std::string& to);
  // Places its free joints (FreeKeys).
  void PlaceFree(const Pose& world, FreeKeys kept);
  // Adds the values of another key with a prefix on every name; existing entries take precedence.
  void Merge(const PartKey& other, const std::string& prefix);
};

// All keyframes of a part, or of a scene.
struct PartKeys {
  PartKey home;  // empty if there is no keyframe of that name
  // The others, in order.
  std::vector<std::pair<std::string, PartKey>> presets;

  // Returns null if there is none.
  PartKey* Find(const std::string& name);
  void Remove(const std::string& name);
  std::vector<std::string> PresetNames() const;

  void Rename(mjtObj kind, const std::string& from, const std::string& to);
  // Moves the free joints of a part, whose keys are in its file's world, to where the scene puts
  // that world. Their velocities turn along.
  void PlaceFree(const Pose& world, FreeKeys kept);
  // Adds those of a tool mounted on a part. `home` joins `home`. A preset gets the prefix on its
  // own name too, and joins an existing one of that name.
  void Merge(const PartKeys& other, const std::string& prefix);
  // Adds those of another part of the scene: a preset whose name is taken gets a number. Returns
  // the new names by the old ones.
  std::map<std::string, std::string> Adopt(const PartKeys& other, const std::string& prefix,
                                           const std::string& part);
};

// The joints in the order of qpos, and the number of values of each.
struct JointPositions {
  std::string name;
  int count = 1;
};
std::vector<JointPositions> PositionsInOrder(mjSpec* spec);

// A keyframe without a name is called `key1` if it is the second of its file. `place`, `field` and
// `file` are stored as the source of the values. If there are keyframes, unnamed joints and
// actuators get names, so that their values can be assigned.
PartKeys ReadKeys(mjSpec* spec, const std::string& place, const std::string& field,
                  const std::string& file);
void DropKeys(mjSpec* spec);

}  // namespace robocell::internal
