// The columns of a recorded episode, read from the simulation row by row: everything but the
// images. See docs/data.md for the list. Row i holds the state before action i; the action and its
// outcome are added to the same row.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "robocell/data/episode_schema.h"
#include "robocell/data/episode_writer.h"
#include "robocell/mujoco/warnings.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell {

// Position xyz (m) and quaternion xyzw.
std::array<double, 7> PoseRow(const Pose& pose);

// What one robot contributes to a row.
class RobotColumns {
 public:
  RobotColumns(EpisodeSchema& schema, Robot robot);
  // State: joints of every group, TCP and base pose, opening of the gripper.
  void PutState(EpisodeWriter& writer);
  // After the action was applied: the targets it set, absolute and relative, and the arm's as pose
  // and twist.
  void PutAction(EpisodeWriter& writer);

 private:
  struct GroupColumns {
    std::string name;
    std::shared_ptr<MoveGroup> group;  // the one that the columns were made for
    MoveGroupKind kind;
    ColumnId qpos, qvel, target, action, action_rel;
    std::vector<double> q, v, before;
  };
  void AddGroup(EpisodeSchema& schema, const std::string& name);
  // Error when the robot's groups are no longer those that the columns were made for.
  void RequireSameGroups() const;
  void PutArmAction(EpisodeWriter& writer, const Controller& port);

  Robot robot_;
  std::vector<GroupColumns> groups_;
  ColumnId base_pose_, tcp_pose_, tcp_in_base_, action_pose_, action_twist_, opening_;
  bool has_arm_ = false, has_gripper_ = false;
  Pose tcp_before_;
};

// What an action led to.
struct RowOutcome {
  double reward = 0;
  bool success = false;
  bool terminated = false, truncated = false;
  bool ik_failed = false;  // a pose command had no solution: its group kept its target
};

// What the scene contributes: time, object poses, outcome of the action.
class SceneColumns {
 public:
  SceneColumns(EpisodeSchema& schema, Scene scene, std::vector<std::string> objects,
               std::vector<std::string> phases);
  // Engine warnings since this object was made: those of the start's making are not the episode's.
  EngineWarnings warnings() const { return ReadWarnings(scene_.data()) - warnings_before_; }
  void PutState(EpisodeWriter& writer, int phase);
  void PutOutcome(EpisodeWriter& writer, const RowOutcome& outcome);
  // The control table: one row per control tick, what acts on the engine.
  void PutControl(EpisodeWriter& writer, const mjModel* model, const mjData* data);

 private:
  Scene scene_;
  std::vector<std::string> objects_, phases_;
  std::vector<ColumnId> object_poses_;
  ColumnId time_, phase_, reward_, success_, terminated_, truncated_, ik_failed_, warnings_;
  EngineWarnings warnings_before_;
  TableId control_;
  ColumnId control_time_, control_ctrl_;
};

}  // namespace robocell
