// Private to scene: the keyframes of a part's own model, by the names of what they set. The scene
// drops the keys themselves, which would keep the other parts at their reference, and writes its
// own (scene_keys.h).
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "robocell/math/pose.h"

namespace robocell::internal {

// The values of one keyframe.
struct PartKey {
  std::string part, own_name;  // of a scene's preset: its robot or object, and its name there

  // Place of a value in its file, for messages.
  struct Source {
    std::string place;  // "robot 'left'"
    std::string field;  // of its spec: the one that names the file
    std::string file;
    std::string key;   // as the file calls the keyframe
    std::string name;  // as the file calls the joint or actuator
  };
  using Values = std::map<std::string, std::vector<double>>;

  Values qpos, qvel;                  // of a joint
  Values act, ctrl;                   // of an actuator
  std::map<std::string, Pose> mocap;  // of a body, in the pose that its file gives it
  std::map<std::string, Source> joint_sources, actuator_sources;

  // Values of a joint, actuator or body follow its new name.
  void Rename(mjtObj kind, const std::string& from, const std::string& to);
  // The same with a prefix on every name; entries that are there already win.
  void Merge(const PartKey& other, const std::string& prefix);
};

// All keyframes of a part, or of a scene.
struct PartKeys {
  PartKey home;  // says nothing when there is no keyframe of that name
  // The others, in the order in which they were found.
  std::vector<std::pair<std::string, PartKey>> presets;

  // Null when there is none.
  PartKey* Find(const std::string& name);
  void Remove(const std::string& name);
  std::vector<std::string> PresetNames() const;

  void Rename(mjtObj kind, const std::string& from, const std::string& to);
  // Those of what is mounted on a part. `home` joins `home`. A preset gets the prefix on its own
  // name too, and joins the one that is called so.
  void Merge(const PartKeys& other, const std::string& prefix);
  // Those of another part of the scene: a preset whose name is taken gets a number behind it.
  // Returns how these are called, by their own names.
  std::map<std::string, std::string> Adopt(const PartKeys& other, const std::string& prefix,
                                           const std::string& part);
};

// The joints in the order of qpos, and how many numbers each has there.
struct JointPositions {
  std::string name;
  int count = 1;
};
std::vector<JointPositions> PositionsInOrder(mjSpec* spec);

// A keyframe without a name is called `key1` when it is the second of its file. `place`, `field`
// and `file` are kept as the source of what is found. Where there are keyframes, joints (but free
// ones: the scene says where these stand) and actuators without a name get one, so that what is
// said of them is found.
PartKeys ReadKeys(mjSpec* spec, const std::string& place, const std::string& field,
                  const std::string& file);
void DropKeys(mjSpec* spec);

}  // namespace robocell::internal
