// The layout of an environment's action and observation in flat vectors: pure data made from the
// configuration and its robots, the same for every copy of the environment. The schemas define each
// number; parts and ranges are views of them. Features and signals keep their shape in the schema;
// vectors have their numbers in row-major order.
//
// An action has for each robot its command and, with a gripper, one number more. An observation has
// for each robot the TCP in the shared base frame (tquat: x y z, quaternion xyzw; xyzrpy: x y z,
// roll pitch yaw), its joints, and with a gripper its opening, followed by the task's objects and
// signals. Units: metres, radians, openings 0 (closed) to 1 (open).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robocell/data/feature_schema.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/env_config.h"
#include "robocell/task/task.h"

namespace robocell {

class FeatureSource;
namespace internal {
class ChosenFeatures;
}

// A part of a flat vector.
struct VectorPart {
  int begin = 0;
  int size = 0;
};

struct RobotLayout {
  std::string robot;
  std::string command;  // name of its action: joints, xyzrpy or tquat
  bool has_gripper = false;
  VectorPart action;
  int gripper_action = -1;
  VectorPart tquat, xyzrpy, joints;
  int gripper = -1;
};

// An observed object: its pose in the shared base frame, as tquat.
struct ObjectLayout {
  std::string object;
  VectorPart tquat;
};

// A signal that the task adds.
struct SignalLayout {
  std::string name;
  VectorPart part;
  std::vector<int64_t> shape;  // shape of the signal, row-major
};

// A feature that the configuration adds to the observation (EnvConfig::features).
struct FeatureLayout {
  std::string key;  // "tcp_height", "robots/left/sensors/touch"
  VectorPart part;
  std::vector<int64_t> shape;
};

// The limits of every number of a vector.
struct VectorRange {
  std::vector<double> lower, upper;
  int size() const { return static_cast<int>(lower.size()); }
};

struct EnvLayout {
  std::vector<RobotLayout> robots;
  std::vector<ObjectLayout> objects;
  std::vector<SignalLayout> signals;
  VectorPart all_signals;  // one after another
  std::vector<FeatureLayout> features;
  VectorPart all_features;  // one after another
  // The features in the order of the vectors: `observation/left/tquat`, `action/left/joints`. The
  // rest of a name is the path in the dictionaries of Python, joined by "/".
  FeatureSchema observed, commanded;
  std::vector<std::vector<std::string>> observed_paths, commanded_paths;
  VectorRange action, observation;
};

// The range of observed joints extends by this much beyond the limits, which give way a little in
// the engine: rad or m.
inline constexpr double kJointSlack = 0.5;

// `robots` are those of the configuration, in its order, in a scene at its start; `task` is null
// without one, and `signals` are its declared signals, as "task/<name>"; `chosen` are the features
// of the configuration.
EnvLayout MakeEnvLayout(const EnvConfig& config, const std::vector<Robot>& robots, const Task* task,
                        const FeatureSource& signals, const internal::ChosenFeatures& chosen);

// Returns the name of number i of the observation: "left.joints[2]", "objects.cube.tquat[0]",
// "task.goal[1]".
std::string NameOfObservation(const EnvLayout& layout, int i);

// Returns the joint positions that may be commanded to an arm: its limits, +-2 pi for hinges
// without limits. Throws ArgumentError for a slide without limits.
std::vector<Interval> CommandLimits(const Robot& robot);

}  // namespace robocell
