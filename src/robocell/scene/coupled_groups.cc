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

// The joints of one group that follow others of it.
class FollowersOfGroup {
 public:
  FollowersOfGroup(const mjModel* m, RobotRecord& robot, std::string name, CompileLog& log)
      : robot_(robot),
        name_(std::move(name)),
        joints_(robot.config.move_groups.at(name_).joints.names),
        log_(log) {
    const std::vector<int> ids = JointIds(m, robot, robot.config.move_groups.at(name_).joints);
    if (std::find(ids.begin(), ids.end(), -1) == ids.end()) followers_ = FollowersAmong(m, ids);
  }

  // Warns of a home that contradicts them.
  void ValidateHome() {
    const std::vector<double>* home = Find(robot_.config.home);
    if (!home) return;
    for (const ListedFollower& f : followers_) {
      const double follows = f.of_leader.at(home->at(f.leader));
      if (std::abs(home->at(f.index) - follows) <= kHomeSlack) continue;
      log_.Warn(place(),
                fmt::format("home.{}: '{}' is {:g}, but it follows '{}' and begins at {:g}", name_,
                            joints_[f.index], home->at(f.index), joints_[f.leader], follows),
                "home." + name_);
    }
  }

  // Leaves them out of an arm.
  void Drop() {
    if (followers_.empty()) return;
    const std::vector<std::string> texts = DescribeFollowers(followers_, joints_);
    log_.Note(place(),
              fmt::format("arm '{}': {} by equality constraints, so that {} no joint of "
                          "its own in configurations and commands",
                          name_, ListNames(texts), texts.size() == 1 ? "it is" : "they are"));
    if (auto* home = Find(robot_.config.home)) Drop(*home);
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
    std::vector<std::string> names;
    for (const auto& [name, group] : robot.config.move_groups.entries()) names.push_back(name);
    for (const std::string& name : names) {
      FollowersOfGroup followers(m, robot, name, log);
      followers.ValidateHome();
      if (robot.config.move_groups.at(name).kind == MoveGroupKind::kArm) followers.Drop();
    }
  }
}

std::vector<int> JointIds(const mjModel* m, const RobotRecord& robot, const NameList& joints) {
  std::vector<int> ids;
  ids.reserve(joints.size());
  for (const std::string& joint : joints)
    ids.push_back(FindId(m, mjOBJ_JOINT, robot.prefix + joint));
  return ids;
}

std::vector<std::string> DescribeFollowers(const std::vector<ListedFollower>& followers,
                                           const NameList& joints) {
  std::vector<std::string> texts;
  for (const ListedFollower& f : followers)
    texts.push_back(fmt::format("'{}' follows '{}'", joints[f.index], joints[f.leader]));
  return texts;
}

}  // namespace robocell::internal
