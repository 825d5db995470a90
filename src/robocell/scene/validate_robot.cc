#include "robocell/scene/validate_robot.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/drive_matrix.h"
#include "robocell/scene/element_lookup.h"
#include "robocell/scene/ft_sensor.h"
#include "robocell/scene/validate_keyframes.h"

namespace robocell::internal {
namespace {

// Checks one robot. Messages name the field, then the problem.
class RobotValidator {
 public:
  RobotValidator(const mjModel* model, const RobotRecord& robot, CompileLog& log)
      : model_(model), robot_(robot), log_(log), place_("robot '" + robot.name + "'") {}

  void Run() {
    for (const auto& [name, group] : robot_.config.move_groups.entries())
      ValidateGroup(name, *group);
    const auto& geoms = robot_.config.collision_geoms;
    for (size_t i = 0; i < geoms.size(); ++i)
      Element("collision_geoms", Item("collision_geoms", i), geoms[i], {mjOBJ_GEOM});
    for (size_t i = 0; i < robot_.config.ft_sensors.size(); ++i) ValidateFtSensor(i);
    for (const auto& [name, values] : robot_.config.home.entries()) ValidateHome(name, *values);
  }

 private:
  void Problem(const std::string& field, const std::string& message) {
    log_.Problem(place_, field + message, field);
  }

  static std::string Item(const std::string& field, size_t i) {
    return fmt::format("{}[{}]", field, i);
  }

  // Returns ids of the elements that a field names; reports each missing one and returns -1 for it.
  std::vector<int> Ids(mjtObj kind, const std::string& field, const NameList& names) {
    std::vector<int> ids;
    for (const std::string& name : names) {
      try {
        ids.push_back(FindElement(model_, robot_, kind, name));
      } catch (const NotFoundError& error) {
        log_.Problem(place_, WithoutPlace(error), Item(field, ids.size()));
        ids.push_back(-1);
      }
    }
    return ids;
  }

  // The message without "robot 'left': ", which the log puts in front.
  std::string WithoutPlace(const Error& error) const {
    const std::string text = error.what();
    return text.rfind(place_ + ": ", 0) == 0 ? text.substr(place_.size() + 2) : text;
  }

  // `shown` is the field in the message.
  void Element(const std::string& shown, const std::string& field, const ElementRef& ref,
               std::initializer_list<mjtObj> kinds) {
    try {
      FindElement(model_, robot_, ref, kinds);
    } catch (const NotFoundError& error) {
      log_.Problem(place_, shown + ": " + WithoutPlace(error), field);
    }
  }

  void ValidateFtSensor(size_t i) {
    try {
      const FtSensor sensor(model_, robot_, robot_.config.ft_sensors[i]);
    } catch (const Error& error) {
      log_.Problem(place_, WithoutPlace(error), Item("ft_sensors", i));
    }
  }

  void ValidateGroup(const std::string& name, const MoveGroupConfig& group) {
    const std::string field = "move_groups." + name;
    const std::vector<int> joints = Ids(mjOBJ_JOINT, field + ".joints", group.joints);
    const std::vector<int> actuators = Ids(mjOBJ_ACTUATOR, field + ".actuators", group.actuators);
    const std::string root = field + ".root", leaf = field + ".leaf", fingers = field + ".fingers";
    if (group.root) Element(root, root, *group.root, {mjOBJ_BODY, mjOBJ_SITE});
    if (group.leaf) Element(leaf, leaf, *group.leaf, {mjOBJ_SITE, mjOBJ_BODY});
    for (size_t i = 0; i < group.fingers.size(); ++i)
      Element(fingers, Item(fingers, i), group.fingers[i], {mjOBJ_GEOM, mjOBJ_BODY, mjOBJ_SITE});
    if (group.kind == MoveGroupKind::kArm) ValidateArm(field, group, joints, actuators);
    if (group.kind == MoveGroupKind::kGripper && group.ctrl)
      ValidateGripperCtrl(field, group, actuators);
  }

  void ValidateArm(const std::string& field, const MoveGroupConfig& group,
                   const std::vector<int>& joints, const std::vector<int>& actuators) {
    const bool in_matrix = ValidateMatrix(field, joints, actuators);
    for (size_t i = 0; i < joints.size(); ++i) {
      if (joints[i] < 0) continue;
      if (model_->jnt_type[joints[i]] != mjJNT_HINGE &&
          model_->jnt_type[joints[i]] != mjJNT_SLIDE) {
        Problem(field, fmt::format(": joint '{}' is neither a hinge nor a slide; an arm has joints "
                                   "of one degree of freedom",
                                   group.joints[i]));
      }
      if (i < actuators.size() && actuators[i] >= 0 && !in_matrix)
        ValidateDrives(field, group, i, joints[i], actuators[i]);
    }
  }

  // Returns true if the actuators move the arm through tendons or followers of its joints. Reports
  // those that leave some of it unmoved.
  bool ValidateMatrix(const std::string& field, const std::vector<int>& joints,
                      const std::vector<int>& actuators) {
    for (const std::vector<int>* ids : {&joints, &actuators}) {
      if (ids->empty() || std::find(ids->begin(), ids->end(), -1) != ids->end()) return false;
    }
    std::vector<int> free = joints;
    const std::vector<ListedFollower> followers = FollowersAmong(model_, joints);
    for (auto f = followers.rbegin(); f != followers.rend(); ++f)
      free.erase(free.begin() + static_cast<std::ptrdiff_t>(f->index));
    const bool on_tendons = std::any_of(actuators.begin(), actuators.end(), [&](int a) {
      return model_->actuator_trntype[a] == mjTRN_TENDON;
    });
    if (!on_tendons) return false;
    const std::string why = WhyNoMatrixDrive(model_, free, actuators);
    if (!why.empty()) Problem(field + ".actuators", ": " + why);
    return true;
  }

  void ValidateDrives(const std::string& field, const MoveGroupConfig& group, size_t i, int joint,
                      int actuator) {
    const int driven = model_->actuator_trnid[2 * actuator];
    const bool on_joint = ActsOnJoint(model_, actuator);
    if (on_joint && driven == joint) return;
    const std::string what =
        on_joint ? "joint '" +
                       ElementName(model_, mjOBJ_JOINT, driven).substr(robot_.prefix.size()) + "'"
                 : "no single joint";
    Problem(field, fmt::format(": actuator '{}' drives {}, but is listed for joint '{}'; list the "
                               "actuators in the order of the joints",
                               group.actuators[i], what, group.joints[i]));
  }

  void ValidateGripperCtrl(const std::string& field, const MoveGroupConfig& group,
                           const std::vector<int>& actuators) {
    for (size_t i = 0; i < actuators.size(); ++i) {
      if (actuators[i] < 0) continue;
      const int input = model_->actuator_ctrladr[actuators[i]];
      if (!model_->actuator_ctrllimited[input]) continue;
      const mjtNum* range = model_->actuator_ctrlrange + 2 * input;
      for (const double value : {group.ctrl->open, group.ctrl->closed}) {
        if (value < range[0] - kLimitSlack || value > range[1] + kLimitSlack) {
          Problem(field + ".ctrl",
                  fmt::format(": {} is outside the range {} to {} of actuator '{}'", value,
                              range[0], range[1], group.actuators[i]));
        }
      }
    }
  }

  void ValidateHome(const std::string& name, const std::vector<double>& values) {
    const MoveGroupConfig* group = robot_.config.move_groups.find(name);
    if (!group) return;
    for (size_t i = 0; i < values.size() && i < group->joints.size(); ++i) {
      const int joint = FindId(model_, mjOBJ_JOINT, robot_.prefix + group->joints[i]);
      if (joint < 0) continue;
      if (const auto wrong = OutsideLimits(model_, joint, values[i], group->joints[i]))
        Problem("home." + name, ": " + *wrong);
    }
  }

  const mjModel* model_;
  const RobotRecord& robot_;
  CompileLog& log_;
  std::string place_;
};

}  // namespace

DataPtr AtReference(const mjModel* model) {
  DataPtr data = MakeData(model);
  Guarded("looking at a model at its reference", data.get(), [&] {
    mj_kinematics(model, data.get());
    mj_comPos(model, data.get());
    mj_flex(model, data.get());
    mj_tendon(model, data.get());
    mj_transmission(model, data.get());
  });
  return data;
}

void ValidateRobot(const mjModel* model, const RobotRecord& robot, CompileLog& log) {
  RobotValidator(model, robot, log).Run();
}

}  // namespace robocell::internal
