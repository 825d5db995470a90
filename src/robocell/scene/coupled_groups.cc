#include "robocell/scene/coupled_groups.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

constexpr double kHomeSlack = 1e-3;  // rad or m

// Drops the followers of one arm.
class ArmReducer {
 public:
  ArmReducer(const mjModel* m, RobotRecord& robot, std::string name, CompileLog& log)
      : robot_(robot),
        name_(std::move(name)),
        joints_(robot.config.move_groups.at(name_).joints.names),
        log_(log) {
    const std::vector<int> ids = JointIds(m, robot, robot.config.move_groups.at(name_).joints);
    if (std::find(ids.begin(), ids.end(), -1) == ids.end()) followers_ = FollowersAmong(m, ids);
  }

  void Run() {
    if (followers_.empty()) return;
    std::vector<std::string> texts;
    for (const ListedFollower& f : followers_)
      texts.push_back(fmt::format("'{}' follows '{}'", joints_[f.index], joints_[f.leader]));
    log_.Note(place(),
              fmt::format("arm '{}': {} by equality constraints, so that {} no joint of "
                          "its own in configurations and commands",
                          name_, ListNames(texts), texts.size() == 1 ? "it is" : "they are"));
    if (auto* home = Find(robot_.config.home)) {
      WarnOfContradictions(*home);
      Drop(*home);
    }
    if (auto* noise = Find(robot_.config.home_noise); noise && noise->size() > 1) Drop(*noise);
    Drop(robot_.config.move_groups.at(name_).joints.names);
  }

 private:
  std::string place() const { return "robot '" + robot_.name + "'"; }

  // Returns the values of this arm if there is one for each joint.
  std::vector<double>* Find(Map<std::vector<double>>& map) {
    if (!map.contains(name_)) return nullptr;
    std::vector<double>& values = map.at(name_);
    return values.size() == joints_.size() ? &values : nullptr;
  }

  template <class T>
  void Drop(std::vector<T>& values) const {
    for (auto f = followers_.rbegin(); f != followers_.rend(); ++f)
      values.erase(values.begin() + static_cast<std::ptrdiff_t>(f->index));
  }

  void WarnOfContradictions(const std::vector<double>& home) {
    for (const ListedFollower& f : followers_) {
      const double follows = f.of_leader.at(home[f.leader]);
      if (std::abs(home[f.index] - follows) <= kHomeSlack) continue;
      log_.Warn(place(),
                fmt::format("home.{}: '{}' is {:g}, but it follows '{}' and begins at {:g}", name_,
                            joints_[f.index], home[f.index], joints_[f.leader], follows),
                "home." + name_);
    }
  }

  RobotRecord& robot_;
  std::string name_;
  std::vector<std::string> joints_;  // before
  std::vector<ListedFollower> followers_;
  CompileLog& log_;
};

}  // namespace

void DropFollowers(const mjModel* m, std::vector<RobotRecord>& robots, CompileLog& log) {
  if (m->neq == 0) return;
  for (RobotRecord& robot : robots) {
    std::vector<std::string> arms;
    for (const auto& [name, group] : robot.config.move_groups.entries()) {
      if (group->kind == MoveGroupKind::kArm) arms.push_back(name);
    }
    for (const std::string& arm : arms) ArmReducer(m, robot, arm, log).Run();
  }
}

std::vector<int> JointIds(const mjModel* m, const RobotRecord& robot, const NameList& joints) {
  std::vector<int> ids;
  ids.reserve(joints.size());
  for (const std::string& joint : joints)
    ids.push_back(FindId(m, mjOBJ_JOINT, robot.prefix + joint));
  return ids;
}

void PlaceFollowers(const mjModel* m, const MoveGroupConfig& group, std::span<const int> joints,
                    double* qpos) {
  if (m->neq == 0 || group.kind != MoveGroupKind::kArm) return;
  if (std::find(joints.begin(), joints.end(), -1) != joints.end()) return;
  for (const JointFollower& f : FollowersOf(m, joints))
    qpos[m->jnt_qposadr[f.joint]] = f.of_leader.at(qpos[m->jnt_qposadr[joints[f.leader]]]);
}

}  // namespace robocell::internal
