// Checks the groups of a robot's configuration against the body tree of its model.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <optional>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/coupled_groups.h"
#include "robocell/scene/element_lookup.h"
#include "robocell/scene/finger_bodies.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/scene/label_unnamed.h"
#include "robocell/scene/validate_robot.h"

namespace robocell::internal {
namespace {

// The groups of one robot.
class GroupValidator {
 public:
  GroupValidator(const mjModel* model, const mjData* data, const RobotRecord& robot,
                 CompileLog& log)
      : m_(model), d_(data), robot_(robot), log_(log) {}

  void Run() {
    for (const auto& [name, group] : robot_.config.move_groups.entries()) {
      const std::string field = "move_groups." + name;
      if (group->kind == MoveGroupKind::kArm) ValidateJoints(field, *group);
      if (group->kind == MoveGroupKind::kGripper) ValidateGripper(field, *group);
    }
  }

 private:
  void Problem(const std::string& field, const std::string& message) {
    log_.Problem("robot '" + robot_.name + "'", field + ": " + message, field);
  }

  // Returns the element's body; unset if there is no such element.
  std::optional<int> BodyOfRef(const ElementRef& ref, std::initializer_list<mjtObj> kinds) const {
    try {
      const ElementId element = FindElement(m_, robot_, ref, kinds);
      return BodyOf(m_, element.kind, element.id);
    } catch (const NotFoundError&) {
      return std::nullopt;
    }
  }

  std::optional<int> BodyOfJoint(const std::string& name) const {
    const int joint = FindId(m_, mjOBJ_JOINT, robot_.prefix + name);
    return joint < 0 ? std::nullopt : std::optional(m_->jnt_bodyid[joint]);
  }

  // Returns the body at the arm's end: its leaf, else the robot's tool point, else its last joint.
  std::optional<int> LeafBody(const MoveGroupConfig& group) const {
    if (group.leaf) return BodyOfRef(*group.leaf, {mjOBJ_SITE, mjOBJ_BODY});
    for (const auto& site : {robot_.tcp_site, robot_.attachment_site}) {
      const int id = site ? FindId(m_, mjOBJ_SITE, *site) : -1;
      if (id >= 0) return m_->site_bodyid[id];
    }
    return group.joints.empty() ? std::nullopt : BodyOfJoint(group.joints.names.back());
  }

  std::string WithoutPrefix(const std::string& name) const {
    return name.starts_with(robot_.prefix) ? name.substr(robot_.prefix.size()) : name;
  }

  // Returns the joints between the robot's root and a body, in order; unset if the body does not
  // hang on the root.
  std::optional<std::vector<std::string>> JointsTo(int body) const {
    const int root = FindId(m_, mjOBJ_BODY, robot_.root_body);
    if (root < 0 || !IsInSubtree(m_, body, root)) return std::nullopt;
    std::vector<std::string> joints;
    for (; body != root; body = m_->body_parentid[body]) {
      for (int k = m_->body_jntnum[body] - 1; k >= 0; --k) {
        joints.push_back(WithoutPrefix(ElementName(m_, mjOBJ_JOINT, m_->body_jntadr[body] + k)));
      }
    }
    std::reverse(joints.begin(), joints.end());
    return joints;
  }

  void ValidateJoints(const std::string& field, const MoveGroupConfig& group) {
    for (const std::string& joint : group.joints) {
      if (!BodyOfJoint(joint)) return;
    }
    const std::optional<int> leaf = LeafBody(group);
    if (!leaf) return;
    auto joints = JointsTo(*leaf);
    if (!joints) return;
    const std::string coupled = DropFollowers(&*joints);
    if (*joints == group.joints.names) return;
    if (const std::string carrier = JointOfTheRoot(group); !carrier.empty()) {
      return Problem(
          field + ".joints",
          fmt::format(
              "'{0}' moves the root body '{1}' itself, and an arm begins behind the root. Put "
              "a body without joints around '{1}' in the model, or give '{0}' a separate group: "
              "{{kind: generic, joints: [{0}], actuators: [NAME]}}",
              carrier, WithoutPrefix(robot_.root_body)));
    }
    if (joints->empty()) {
      return Problem(
          field + (group.leaf ? ".leaf" : ".joints"),
          fmt::format("there is no joint between '{}' and the arm's leaf, so nothing "
                      "moves; {}",
                      WithoutPrefix(robot_.root_body), HowToNameALeaf(group.joints.names.back())));
    }
    if (const std::string ball = BallAmong(*joints); !ball.empty()) {
      return Problem(
          field + (group.leaf ? ".leaf" : ".joints"),
          fmt::format("'{}' between '{}' and the arm's leaf is neither a hinge nor a slide, "
                      "and an arm has only those: name a `leaf` before it, or put "
                      "hinges in its place in the model",
                      ball, WithoutPrefix(robot_.root_body)));
    }
    if (const std::string finger = JointOfAnotherGroup(*joints, group); !finger.empty()) {
      return Problem(
          field + ".leaf",
          fmt::format("{} hangs on '{}' too, a joint of group '{}', and the arm lists "
                      "{}; {}",
                      Describe(*group.leaf), finger, GroupWith(finger),
                      ListNames(group.joints.names), HowToNameALeaf(group.joints.names.back())));
    }
    Problem(field + ".joints",
            fmt::format("lists {}, but the joints from '{}' to the arm's leaf are {}; list "
                        "those, in this order{}{}{}{}",
                        ListNames(group.joints.names), WithoutPrefix(robot_.root_body),
                        ListNames(*joints), group.leaf ? "" : ", or name its `leaf`",
                        HowToNameFirst(*joints), HowToBeginBehind(*joints, group.joints.names),
                        coupled));
  }

  // Leaves out the joints that follow others of the list, and returns a sentence about them.
  std::string DropFollowers(std::vector<std::string>* joints) const {
    const std::vector<int> ids = JointIds(m_, robot_, *joints);
    if (std::find(ids.begin(), ids.end(), -1) != ids.end()) return "";
    const std::vector<ListedFollower> followers = FollowersAmong(m_, ids);
    const std::vector<std::string> texts = DescribeFollowers(followers, *joints);
    for (auto f = followers.rbegin(); f != followers.rend(); ++f)
      joints->erase(joints->begin() + static_cast<std::ptrdiff_t>(f->index));
    if (texts.empty()) return "";
    return fmt::format(". By equality constraints {}, without a place of its own in the list",
                       ListNames(texts));
  }

  // Returns the group that lists a joint; "" if there is none.
  std::string GroupWith(const std::string& joint) const {
    for (const auto& [name, group] : robot_.config.move_groups.entries()) {
      const std::vector<std::string>& names = group->joints.names;
      if (std::find(names.begin(), names.end(), joint) != names.end()) return name;
    }
    return "";
  }

  // Returns the first joint inwards from the leaf that belongs to another group, for an arm whose
  // leaf is farther out than its joints, on a finger.
  std::string JointOfAnotherGroup(const std::vector<std::string>& joints,
                                  const MoveGroupConfig& group) const {
    const std::vector<std::string>& listed = group.joints.names;
    if (!group.leaf || listed.empty() || listed.size() >= joints.size()) return "";
    if (!std::equal(listed.begin(), listed.end(), joints.begin())) return "";
    for (size_t i = listed.size(); i < joints.size(); ++i) {
      if (!GroupWith(joints[i]).empty()) return joints[i];
    }
    return "";
  }

  // Advises about an arm that hangs on a waist with a group of its own: "" unless it lists the
  // rest.
  std::string HowToBeginBehind(const std::vector<std::string>& joints,
                               const std::vector<std::string>& listed) const {
    if (listed.empty() || listed.size() >= joints.size()) return "";
    const auto begin = joints.end() - static_cast<std::ptrdiff_t>(listed.size());
    if (!std::equal(begin, joints.end(), listed.begin())) return "";
    const std::string& last = *std::prev(begin);
    const std::optional<int> body = BodyOfJoint(last);
    if (!body || body == BodyOfJoint(listed.front())) return "";
    const std::string name = WithoutPrefix(ElementName(m_, mjOBJ_BODY, *body));
    if (name.empty()) return "";
    return fmt::format(
        ". Or, if '{}' has a separate group (a waist that two arms hang on, a lift): "
        "`root_body: {}` at the top level of the robot file; the arms begin behind it",
        last, name);
  }

  // Returns elements that only the last joint of an arm moves, sites first.
  std::string HowToNameALeaf(const std::string& last) const {
    const int carrier = BodyOfJoint(last).value();
    const std::vector<std::string> sites = CarriedBy(carrier, mjOBJ_SITE);
    const std::vector<std::string> bodies = CarriedBy(carrier, mjOBJ_BODY);
    return fmt::format(
        "name as `leaf` what the last joint, '{}', carries, for example {{{}}}. {}"
        "Bodies there: {}",
        last, sites.empty() ? "body: " + bodies.front() : "site: " + sites.back(),
        sites.empty() ? "" : "Sites there: " + ListNames(sites) + ". ", ListNames(bodies));
  }

  std::vector<std::string> CarriedBy(int carrier, mjtObj kind) const {
    std::vector<std::string> names;
    for (const std::string& name : RobotElementNames(m_, robot_, kind)) {
      const int id = FindId(m_, kind, robot_.prefix + name);
      if (m_->body_weldid[BodyOf(m_, kind, id)] == m_->body_weldid[carrier]) names.push_back(name);
    }
    return names;
  }

  // Returns the first of them with more than one degree of freedom.
  std::string BallAmong(const std::vector<std::string>& joints) const {
    for (const std::string& joint : joints) {
      const int id = FindId(m_, mjOBJ_JOINT, robot_.prefix + joint);
      if (id >= 0 && m_->jnt_type[id] != mjJNT_HINGE && m_->jnt_type[id] != mjJNT_SLIDE)
        return joint;
    }
    return "";
  }

  // Returns the first listed joint that belongs to the root body itself.
  std::string JointOfTheRoot(const MoveGroupConfig& group) const {
    const int root = FindId(m_, mjOBJ_BODY, robot_.root_body);
    for (const std::string& joint : group.joints) {
      if (BodyOfJoint(joint) == root) return joint;
    }
    return "";
  }

  static std::string HowToNameFirst(const std::vector<std::string>& joints) {
    for (const std::string& joint : joints) {
      if (std::string how = HowToNameJoint(joint); !how.empty()) return how;
    }
    return "";
  }

  // Returns the degrees of freedom of the bodies for which `chosen` is true.
  template <class Chosen>
  std::vector<bool> Dofs(const Chosen& chosen) const {
    std::vector<bool> dofs(static_cast<size_t>(m_->nv));
    for (int i = 0; i < m_->nv; ++i) dofs[i] = chosen(m_->dof_bodyid[i]);
    return dofs;
  }

  void ValidateGripper(const std::string& field, const MoveGroupConfig& group) {
    const std::vector<int> fingers = FingerBodies(m_, robot_, group);
    if (fingers.empty()) return;
    const std::string named = group.fingers.empty() ? ".joints" : ".fingers";
    if (std::ranges::all_of(fingers, [&](int finger) { return finger == fingers[0]; })) {
      // For two parts of one body the gripper reports it.
      if (group.fingers.size() != 2 || group.fingers[0] != group.fingers[1]) return;
      return Problem(field + named, fmt::format("both fingers are {}; name one body of each finger",
                                                Describe(group.fingers[0])));
    }
    ValidateGripperActuators(field + ".actuators", group, HandOf(m_, fingers));
  }

  void ValidateGripperActuators(const std::string& field, const MoveGroupConfig& group, int hand) {
    const std::vector<bool> carrying = Dofs([&](int body) { return IsInSubtree(m_, hand, body); });
    std::vector<bool> others = Dofs([&](int body) { return !IsInSubtree(m_, hand, body); });
    const std::vector<bool> driving = DofsThatDriveFingers(m_, hand);
    for (size_t dof = 0; dof < others.size(); ++dof) others[dof] = others[dof] || driving[dof];
    for (size_t i = 0; i < group.actuators.size(); ++i) {
      const std::string& name = group.actuators.names[i];
      const int actuator = FindId(m_, mjOBJ_ACTUATOR, robot_.prefix + name);
      if (actuator < 0 || !ActsOn(m_, d_, actuator, carrying) || ActsOn(m_, d_, actuator, others))
        continue;
      Problem(fmt::format("{}[{}]", field, i),
              fmt::format("'{}' moves the whole hand, not a finger. {}", name, OfFingers(hand)));
    }
  }

  std::string OfFingers(int hand) const {
    const std::vector<bool> inside =
        Dofs([&](int body) { return body != hand && IsInSubtree(m_, body, hand); });
    std::vector<std::string> names;
    for (const std::string& name : RobotElementNames(m_, robot_, mjOBJ_ACTUATOR)) {
      if (ActsOn(m_, d_, FindId(m_, mjOBJ_ACTUATOR, robot_.prefix + name), inside))
        names.push_back(name);
    }
    if (names.empty()) return "No actuator of the model moves one: are the `fingers` right?";
    return "The actuators that move its fingers: " + ListNames(names);
  }

  const mjModel* m_;
  const mjData* d_;
  const RobotRecord& robot_;
  CompileLog& log_;
};

}  // namespace

void ValidateGroups(const mjModel* model, const mjData* reference,
                    const std::vector<RobotRecord>& robots, CompileLog& log) {
  for (const RobotRecord& robot : robots) GroupValidator(model, reference, robot, log).Run();
}

}  // namespace robocell::internal
