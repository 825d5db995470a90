// Tests whether the arms, with the controllers that runs use, stay at home and follow a small step
// of each joint. A file and its model can be correct and the servos still be too weak, too slow or
// blocked. Takes a few seconds for each joint that does not follow, and less for the others.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/diagnose/trials.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/arm_group.h"
#include "robocell/robot/arrival.h"
#include "robocell/robot/joint_resistance.h"
#include "robocell/robot/swing_cure.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/spec/problems.h"

namespace robocell::internal {
namespace {

constexpr double kHoldSeconds = 1.0;
// A drift of a hinge and of a slide up to these is tolerated, or the robot's arrival_tolerance.
constexpr double kHeldRad = 0.01, kHeldMetres = 0.001;
constexpr double kRampSeconds = 0.5, kFollowSeconds = 2.5;  // duration of a step
constexpr double kLastSeconds = 1;            // end of the step, in which it must not swing
constexpr double kTurn = 0.1, kShift = 0.05;  // a step of a hinge, of a slide
constexpr double kShareOfRange = 0.25;        // largest step
constexpr double kShareMissing = 0.2;         // tolerated share of a step
constexpr double kRestSpeed = 0.05;           // rad/s or m/s
constexpr double kStaySeconds = 0.1;          // time at its target; a swing is shorter
constexpr double kSaturated = 0.98;           // share of a servo's largest force
constexpr double kSlow = 0.4;                 // a servo's time constant, seconds
constexpr double kHopeless = 5;               // a time constant that no force helps
constexpr double kTypingError = 100;          // a servo's own time constant, seconds
constexpr double kExplains = 0.5;             // share of the missing motion that a cause explains
constexpr double kUndamped = 0.1;             // damping ratio: with less, a joint swings freely

// The reason why a joint is not where it should be, and what to do about it.
struct Cause {
  std::string why, remedy;
  std::string field;            // field of the robot's file
  bool in_warnings = false;     // the scene's
  std::string edit = "";        // appended to the remedy with those of others; "" for none
  std::string first_edit = "";  // one of those that the remedy itself names
};

struct Miss {
  std::string joint, how;  // "drifts by 0.2 rad"
  double amount = 0;
  Cause cause;
};

std::vector<double> HeldWithin(const Robot& robot, const ArmGroup& arm) {
  std::vector<double> tolerances = ArrivalTolerances(robot, arm.name());
  const mjModel* m = robot.scene().model();
  for (size_t i = 0; i < tolerances.size(); ++i) {
    const int joint = FindId(m, mjOBJ_JOINT, arm.joint_names()[i]);
    const bool slide = m->jnt_type[joint] == mjJNT_SLIDE;
    tolerances[i] = std::max(tolerances[i], slide ? kHeldMetres : kHeldRad);
  }
  return tolerances;
}

// One arm.
class ArmTrial {
 public:
  ArmTrial(Robot& robot, ArmGroup& arm, bool beside_warnings, Findings& findings)
      : robot_(robot),
        arm_(arm),
        scene_(robot.scene()),
        beside_warnings_(beside_warnings),
        findings_(findings) {
    for (const std::string& name : arm.joint_names())
      joints_.push_back(FindId(model(), mjOBJ_JOINT, name));
    tolerances_ = HeldWithin(robot, arm);
    arrived_ = ArrivalTolerances(robot, arm.name());
  }

  void Run() {
    scene_.Reset();
    home_ = arm_.joint_pos();
    if (Holds() && TakesPositions()) Follows();
  }

 private:
  const mjModel* model() const { return scene_.model(); }
  const mjData* data() const { return scene_.data(); }
  const RobotConfig& config() const { return robot_.config(); }
  std::string Field() const { return "move_groups." + arm_.name(); }
  bool IsSlide(size_t i) const { return *Unit(i) == 'm'; }
  // `stiffness` and `damping` set all servos of a robot. With one joint that is what it needs; a
  // value for one of several makes others too stiff, too slow or too weak.
  bool HasOneJoint() const { return joints_.size() == 1; }
  const char* Unit(size_t i) const {
    return model()->jnt_type[joints_[i]] == mjJNT_SLIDE ? "m" : "rad";
  }
  const char* ForceUnit(size_t i) const {
    return model()->jnt_type[joints_[i]] == mjJNT_SLIDE ? "N" : "N m";
  }
  std::string JointName(size_t i) const { return WithoutPrefix(arm_.joint_names()[i]); }
  std::string WithoutPrefix(const std::string& name) const {
    return name.starts_with(robot_.prefix()) ? name.substr(robot_.prefix().size()) : name;
  }

  // Returns false if the simulation diverges.
  bool Step() {
    robot_.Update();
    const StepResult result = scene_.Step();
    if (!result.ok()) diverged_ = result.message;
    return result.ok();
  }

  bool Diverged(const char* while_doing) {
    findings_.WarnAbout(Field(), fmt::format("the simulation diverges while the arm {}: {}",
                                             while_doing, diverged_));
    return false;
  }

  bool Holds() {
    touching_ = Touching();
    const int steps = static_cast<int>(std::ceil(kHoldSeconds / scene_.timestep()));
    for (int k = 0; k < steps; ++k) {
      if (!Step()) return Diverged("holds still");
    }
    std::vector<Miss> misses;
    bool slides = false;
    const std::vector<double> now = arm_.joint_pos();
    const std::vector<int> swinging = Swinging();
    for (size_t i = 0; i < home_.size(); ++i) {
      const double drift = std::abs(now[i] - home_[i]);
      if (std::ranges::find(swinging, joints_[i]) != swinging.end()) {
        slides = slides || IsSlide(i);
        misses.push_back({JointName(i), "oscillates", HUGE_VAL, Oscillation(i)});
        continue;
      }
      if (drift <= tolerances_[i]) continue;
      slides = slides || IsSlide(i);
      misses.push_back({JointName(i), fmt::format("drifts by {:.3g} {}", drift, Unit(i)), drift,
                        Why(i, home_[i], touching_[i])});
    }
    const bool holds = misses.empty();
    if (beside_warnings_)
      std::erase_if(misses, [](const Miss& miss) { return miss.cause.in_warnings; });
    std::stable_sort(misses.begin(), misses.end(),
                     [](const Miss& a, const Miss& b) { return a.amount > b.amount; });
    NoteMisses(
        misses,
        fmt::format(" in {:g} s while it should hold home (up to {:g} rad{} is tolerated)",
                    kHoldSeconds, std::max(config().arrival_tolerance, kHeldRad),
                    slides ? fmt::format(", {:g} m of slides",
                                         std::max(config().slide_arrival_tolerance(), kHeldMetres))
                           : ""));
    return holds;
  }

  // Returns false for a controller of torques or velocities, which takes no positions, and for one
  // of poses, which may choose others.
  bool TakesPositions() const {
    const TargetKind kind = robot_.controller(arm_.name()).target_kind();
    return kind == TargetKind::kJointPositions || kind == TargetKind::kJointSteps;
  }

  void Follows() {
    std::vector<Miss> misses;
    for (size_t i = 0; i < home_.size(); ++i) {
      const std::optional<Miss> miss = TryJoint(i);
      if (!diverged_.empty()) return void(Diverged("takes a small step"));
      if (miss) misses.push_back(*miss);
    }
    NoteMisses(misses,
               fmt::format(" when it is sent there from home and given {:g} s", kFollowSeconds));
  }

  // Unset if the joint follows in one direction: the other may be blocked.
  std::optional<Miss> TryJoint(size_t i) {
    if (const std::optional<Miss> stuck = Stuck(i)) return stuck;
    if (const std::optional<Miss> creeping = Creeps(i)) return creeping;
    const Interval limits = arm_.joint_pos_limits()[i];
    const double up = limits.upper - home_[i], down = home_[i] - limits.lower;
    const double most = *Unit(i) == 'm' ? kShift : kTurn;
    const double step = std::min(most, kShareOfRange * (limits.upper - limits.lower));
    std::optional<Miss> first;
    for (const double sign : {up >= down ? 1.0 : -1.0, up >= down ? -1.0 : 1.0}) {
      const double room = sign > 0 ? up : down;
      if (room < step / 2 || step <= 0) continue;
      const std::optional<Miss> miss = TryStep(i, sign * std::min(step, room));
      if (!miss || !diverged_.empty()) return std::nullopt;
      if (!first) first = miss;
    }
    return first;
  }

  std::optional<Miss> TryStep(size_t i, double step) {
    scene_.Reset();
    const double size = std::abs(step);
    const double enough = std::max(std::min(tolerances_[i], size / 2), kShareMissing * size);
    std::vector<double> q = home_, now = home_;
    const int steps = static_cast<int>(std::ceil(kFollowSeconds / scene_.timestep()));
    const int stay = static_cast<int>(std::ceil(kStaySeconds / scene_.timestep()));
    int there = 0;                                      // and at rest, steps in a row
    Interval errors{HUGE_VAL, -HUGE_VAL}, speeds = {};  // values of the last seconds
    for (int k = 0; k < steps; ++k) {
      const double part = std::min(1.0, k * scene_.timestep() / kRampSeconds);
      q[i] = home_[i] + part * step;
      robot_.Apply({{arm_.name(), GroupCommand::Joints(q)}});
      if (!Step()) return std::nullopt;
      arm_.GetJointPos(now);
      if (part < 1) continue;
      const double error = now[i] - q[i];
      const double speed = data()->qvel[model()->jnt_dofadr[joints_[i]]];
      there = std::abs(error) <= enough && std::abs(speed) <= kRestSpeed ? there + 1 : 0;
      if (there >= stay) return std::nullopt;
      if (k * scene_.timestep() < kFollowSeconds - kLastSeconds) continue;
      errors = {std::min(errors.lower, error), std::max(errors.upper, error)};
      speeds = {std::min(speeds.lower, speed), std::max(speeds.upper, speed)};
    }
    if (speeds.lower < -kRestSpeed && speeds.upper > kRestSpeed) return Swings(i, errors);
    if (std::abs(now[i] - q[i]) <= enough) return std::nullopt;
    const double moved = (now[i] - home_[i]) * (step > 0 ? 1 : -1);
    return Miss{JointName(i), fmt::format("moves {:.3g} of {:.3g} {}", moved + 0.0, size, Unit(i)),
                size - moved, Why(i, q[i], Touching()[i])};
  }

  // Friction is soft in the engine: a joint creeps on against more of it than its servo pushes with.
  std::optional<Miss> Stuck(size_t i) const {
    const int servo = ServoOf(i);
    const double friction = model()->dof_frictionloss[model()->jnt_dofadr[joints_[i]]];
    const std::optional<double> most = servo < 0 ? std::nullopt : MostForce(i, servo);
    if (!most || friction < *most) return std::nullopt;
    return Miss{
        JointName(i), "only creeps", friction,
        Cause{fmt::format(": its frictionloss of {:.3g} is more than the {:.3g} {} that its "
                          "servo '{}' may push with",
                          friction, *most, ForceUnit(i), ServoName(servo)),
              fmt::format("Lower the frictionloss of the joint in the model, or give the "
                          "servo more force ({})",
                          config().force_limit ? "`force_limit`" : "forcerange"),
              Field()}};
  }

  // Near its target a servo pushes with less than the friction of its joint, which is soft in the
  // engine: the joint creeps the rest of each motion, with the time constant of the friction's slope
  // over the servo's stiffness. Unset if it arrives in time.
  std::optional<Miss> Creeps(size_t i) const {
    const int servo = ServoOf(i), dof = model()->jnt_dofadr[joints_[i]];
    const double friction = model()->dof_frictionloss[dof];
    if (servo < 0 || friction <= 0) return std::nullopt;
    const double stiffness = StiffnessOf(servo), tolerance = arrived_[i];
    const double rest = std::min(friction / stiffness, IsSlide(i) ? kShift : kTurn);
    if (rest <= tolerance) return std::nullopt;
    const double gear = Gear(model(), servo);
    const double damping =
        Resistance(i) - model()->actuator_biasprm[mjNBIAS * servo + 2] * gear * gear;
    const double seconds = damping / stiffness * std::log(rest / tolerance);
    if (seconds <= kFollowSeconds) return std::nullopt;
    const double most = stiffness * tolerance;  // friction that it still overcomes there
    return Miss{
        JointName(i),
        fmt::format("creeps over the last {:.3g} {} for {:.2g} s", rest, Unit(i), seconds), rest,
        Cause{.why = fmt::format(
                  ": its frictionloss of {:.3g} is more than its servo '{}' pushes with when "
                  "it is {:g} {} away (arrival_tolerance), {:.3g} {} at {:g} {}/{}",
                  friction, ServoName(servo), tolerance, Unit(i), most, ForceUnit(i), stiffness,
                  ForceUnit(i), Unit(i)),
              .remedy = "Give its servo a larger kp, or lower the frictionloss of the joint",
              .field = Field(),
              .edit = JointEdit(i, "frictionloss", most / 2)}};
  }

  // Returns the resistance to a slow motion per speed, N m s/rad or N s/m.
  double Resistance(size_t i) const {
    constexpr double kSlowly = 1e-6;  // rad/s or m/s
    const std::vector<int> joint = {joints_[i]};
    const double q = home_[i], speed = kSlowly, back = -kSlowly;
    double ahead = 0, behind = 0;
    AddJointResistance(model(), joint, {&q, 1}, {&speed, 1}, {&ahead, 1});
    AddJointResistance(model(), joint, {&q, 1}, {&back, 1}, {&behind, 1});
    return (ahead - behind) / (2 * kSlowly);
  }

  // Returns N/m or N m/rad of the joint.
  double StiffnessOf(int servo) const {
    const double gear = Gear(model(), servo);
    return -model()->actuator_biasprm[mjNBIAS * servo + 1] * gear * gear;
  }

  std::string JointEdit(size_t i, const char* field, double value) const {
    return fmt::format("{{joint: '{}', {}: {:g}}}", JointName(i), field, Rounded(value));
  }

  // Adds an edit that gives a servo the stiffness or damping `value` of its joint.
  void AddGain(const char* gain, int servo, double value, Cause& cause) const {
    const double gear = Gear(model(), servo);
    cause.edit = fmt::format("{{actuator: '{}', {}: {:g}}}", ServoName(servo), gain,
                             Rounded(value / (gear * gear)));
  }

  SwingTrial FromHere() const {
    return {.model = model(), .start = data(), .joints = joints_, .prefix = robot_.prefix()};
  }

  // Returns the joints that oscillate on their servos, which hold constant controls.
  std::vector<int> Swinging() const {
    for (size_t i = 0; i < joints_.size(); ++i) {
      if (ServoOf(i) < 0 || robot_.controller(arm_.name()).mode() != CtrlMode::kPosition) return {};
    }
    return SwingingJoints(FromHere());
  }

  // A servo that pushes its joint past the target in every timestep.
  Cause Oscillation(size_t i) const {
    const int servo = ServoOf(i);
    const mjtNum* bias = model()->actuator_biasprm + mjNBIAS * servo;
    if (!cure_) cure_ = FindSwingCure(FromHere());
    return {
        fmt::format(": its servo '{}' (kp {:.3g}, kv {:.3g}) is too strong for the {:.2g} {} that "
                    "the joint moves at a timestep of {:g} s",
                    ServoName(servo), -bias[1], -bias[2],
                    model()->dof_M0[model()->jnt_dofadr[joints_[i]]], IsSlide(i) ? "kg" : "kg m2",
                    model()->opt.timestep),
        cure_->Text(),
        Field(),
        false,
        "",
        cure_->edits.empty() ? "" : cure_->edits.front()};
  }

  // Returns the damping of a joint and its servo as a share of the critical one.
  double DampingRatio(size_t i, int servo) const {
    const double inertia = model()->dof_M0[model()->jnt_dofadr[joints_[i]]];
    const double gear = Gear(model(), servo);
    const double damping =
        Resistance(i) - model()->actuator_biasprm[mjNBIAS * servo + 2] * gear * gear;
    return damping / (2 * std::sqrt(std::max(StiffnessOf(servo) * inertia, 1e-12)));
  }

  // It passes its target again and again.
  Miss Swings(size_t i, const Interval& error) const {
    const double most = (error.upper - error.lower) / 2;
    const int own = ServoOf(i);
    if (own >= 0 && DampingRatio(i, own) > kUndamped) {
      return Miss{JointName(i),
                  fmt::format("oscillates by {:.3g} {} around its target", most, Unit(i)), most,
                  Oscillation(i)};
    }
    Cause cause{": nothing damps it",
                config().damping ? fmt::format("Raise `damping` ({:g} is set)", *config().damping)
                : HasOneJoint()  ? fmt::format("Give its servo damping (`damping`, {} s/{})",
                                               ForceUnit(i), Unit(i))
                                 : std::string("Give its servo damping"),
                config().damping ? "damping" : Field()};
    const int servo = ServoOf(i);
    if (!HasOneJoint() && servo >= 0) {
      const double inertia = model()->dof_M0[model()->jnt_dofadr[joints_[i]]];
      AddGain("kv", servo, 2 * std::sqrt(std::max(StiffnessOf(servo) * inertia, 0.0)), cause);
      if (config().damping) cause.remedy += ", or leave it out and give each servo its own";
    }
    return Miss{JointName(i),
                fmt::format("still swings by {:.3g} {} around its target", most, Unit(i)), most,
                std::move(cause)};
  }

  // Adds one text for all joints with the same remedy.
  void NoteMisses(std::vector<Miss> misses, const std::string& when) {
    while (!misses.empty()) {
      const Miss worst = misses.front();
      std::string others;
      std::vector<std::string> edits;
      std::erase_if(misses, [&](const Miss& miss) {
        const bool same = miss.cause.remedy == worst.cause.remedy;
        if (same && miss.joint != worst.joint)
          others += fmt::format("{}'{}' {}", others.empty() ? "" : ", ", miss.joint, miss.how);
        if (same && !miss.cause.edit.empty()) edits.push_back(miss.cause.edit);
        return same;
      });
      const std::string edit =
          edits.empty() ? "" : fmt::format(" (edits: [{}])", fmt::join(edits, ", "));
      findings_.WarnAbout(
          worst.cause.field,
          fmt::format("joint '{}' {}{}{}{}. {}{}", worst.joint, worst.how, when, worst.cause.why,
                      others.empty() ? "" : "; likewise " + others, worst.cause.remedy, edit),
          worst.cause.first_edit);
    }
  }

  // Returns, for each joint, the contacts of the bodies that it moves, "'hand' and 'floor'"; "" for
  // none.
  std::vector<std::string> Touching() const {
    std::vector<std::string> out(joints_.size());
    for (const Contact& contact : scene_.contacts()) {
      if (contact.distance > 0) continue;
      const int a = FindId(model(), mjOBJ_BODY, contact.body1),
                b = FindId(model(), mjOBJ_BODY, contact.body2);
      for (size_t i = 0; i < joints_.size(); ++i) {
        const int moved = model()->jnt_bodyid[joints_[i]];
        if (IsInSubtree(model(), a, moved) == IsInSubtree(model(), b, moved)) continue;
        out[i] = fmt::format("'{}' and '{}'", WithoutPrefix(contact.body1),
                             WithoutPrefix(contact.body2));
      }
    }
    return out;
  }

  // Returns the position servo of a joint; -1 if something else drives it.
  int ServoOf(size_t i) const {
    for (const std::string& name : arm_.actuator_names()) {
      const int a = FindId(model(), mjOBJ_ACTUATOR, name);
      if (ActsOnJoint(model(), a) && model()->actuator_trnid[2 * a] == joints_[i] &&
          IsPositionServo(model(), a))
        return a;
    }
    return -1;
  }

  // Returns the largest force of a servo on a joint; unset without a limit.
  std::optional<double> MostForce(size_t i, int servo) const {
    std::optional<double> most;
    const auto limit = [&](const mjtNum* range) {
      const double larger = std::max(std::abs(range[0]), std::abs(range[1]));
      most = std::min(most.value_or(larger), larger);
    };
    const double gear = std::abs(Gear(model(), servo));
    if (model()->actuator_forcelimited[servo]) limit(model()->actuator_forcerange + 2 * servo);
    if (most) *most *= gear;
    if (model()->jnt_actfrclimited[joints_[i]]) limit(model()->jnt_actfrcrange + 2 * joints_[i]);
    return most;
  }

  // Returns the reason why it is not at `wanted`.
  Cause Why(size_t i, double wanted, const std::string& touching) const {
    if (!touching.empty()) {
      return {fmt::format(": {} touch", touching),
              "Exclude the pair in the model if they may overlap, or choose another `home`",
              Field()};
    }
    const int servo = ServoOf(i);
    if (servo < 0) return {"", "Look at its controller", Field()};
    const double off = std::abs(wanted - data()->qpos[model()->jnt_qposadr[joints_[i]]]);
    if (const std::optional<Cause> cut = CutOff(i, servo, wanted, off)) return *cut;
    if (const std::optional<Cause> slow = Sluggish(i, servo)) return *slow;
    const double gravity = GravityAtHome(i);
    const std::optional<double> most = MostForce(i, servo);
    if (most && Force(i) >= kSaturated * *most) return TooWeak(i, servo, *most, gravity);
    return TooSoft(i, servo, gravity, off);
  }

  double Force(size_t i) const {
    return std::abs(data()->qfrc_actuator[model()->jnt_dofadr[joints_[i]]]);
  }

  std::string ServoName(int servo) const {
    return WithoutPrefix(ElementName(model(), mjOBJ_ACTUATOR, servo));
  }

  // Returns the cause if the servo's ctrlrange ends far enough before `wanted` to explain it.
  std::optional<Cause> CutOff(size_t i, int servo, double wanted, double off) const {
    const int input = model()->actuator_ctrladr[servo];
    if (!model()->actuator_ctrllimited[input]) return std::nullopt;
    const double gear = Gear(model(), servo);
    const std::optional<double> ctrl = FreeRestingCtrl(model(), servo, gear * wanted);
    if (!ctrl) return std::nullopt;
    const mjtNum* range = model()->actuator_ctrlrange + 2 * input;
    const double cut = std::abs(*ctrl - std::clamp(*ctrl, range[0], range[1]));
    const double per_ctrl = -model()->actuator_gainprm[mjNGAIN * servo] /
                            (model()->actuator_biasprm[mjNBIAS * servo + 1] * gear);
    const double missing = cut * std::abs(per_ctrl);
    if (missing < kExplains * off) return std::nullopt;
    const std::string name = ServoName(servo);
    const mjtNum* limits = model()->jnt_range + 2 * joints_[i];
    const bool in_warnings = model()->jnt_limited[joints_[i]] && wanted == home_[i] &&
                             missing > kServoSlack * (limits[1] - limits[0]);
    return Cause{
        fmt::format(": to be at {:.4g} {} its servo '{}' needs the control {:.4g}, but its "
                    "ctrlrange is [{:g}, {:g}]",
                    wanted, Unit(i), name, *ctrl, range[0], range[1]),
        fmt::format("Widen it (edits: [{{actuator: '{}', ctrlrange: [LOWER, UPPER]}}]) or choose "
                    "another `home`",
                    name),
        Field(), in_warnings};
  }

  double GravityAtHome(size_t i) const {
    if (!arm_.has_chain()) return 0;
    std::vector<double> torques(home_.size());
    arm_.GravityTorques(home_, torques);
    return std::abs(torques[i]);
  }

  bool compensated() const { return config().gravcomp.value_or(false); }

  // When even with all that its servo may push the joint would take too long: no larger force within
  // reason helps against a damping or an armature that is a typing error.
  std::optional<Cause> Sluggish(size_t i, int servo) const {
    const int dof = model()->jnt_dofadr[joints_[i]];
    const double gear = Gear(model(), servo);
    const double stiffness = StiffnessOf(servo);
    const double passive = model()->dof_damping[dof], armature = model()->dof_armature[dof];
    const double own = -model()->actuator_biasprm[mjNBIAS * servo + 2] * gear * gear;
    if (own > kTypingError * stiffness && !config().damping) {
      Cause cause{fmt::format(": the kv of its servo '{}', {:.3g}, is too large for its stiffness "
                              "of {:g} {}/{}, so that it takes {:.3g} s",
                              ServoName(servo), own / (gear * gear), stiffness, ForceUnit(i),
                              Unit(i), own / stiffness),
                  fmt::format("Lower it in the model to {:g}",
                              Rounded(kSlow / 4 * stiffness / (gear * gear))),
                  Field()};
      AddGain("kv", servo, kSlow / 4 * stiffness, cause);
      return cause;
    }
    if (passive > kHopeless * stiffness) {
      return Cause{
          .why = fmt::format(": its damping of {:.3g} is too large for its servo's stiffness of "
                             "{:g} {}/{}, so that it takes {:.3g} s",
                             passive, stiffness, ForceUnit(i), Unit(i), passive / stiffness),
          .remedy = "Lower the damping of the joint",
          .field = Field(),
          .edit = JointEdit(i, "damping", kSlow / 4 * stiffness)};
    }
    if (armature > kHopeless * kHopeless * stiffness) {
      return Cause{
          .why = fmt::format(": its armature of {:.3g} is too large for its servo's stiffness of "
                             "{:g} {}/{}, so that it swings once in {:.3g} s",
                             armature, stiffness, ForceUnit(i), Unit(i),
                             2 * kPi * std::sqrt(armature / stiffness)),
          .remedy = "Lower the armature of the joint",
          .field = Field(),
          .edit = JointEdit(i, "armature", 0.1)};
    }
    return std::nullopt;
  }

  Cause TooWeak(size_t i, int servo, double most, double gravity) const {
    Cause cause{fmt::format(": its servo '{}' pushes with all it may, {:.3g} {}", ServoName(servo),
                            most, ForceUnit(i)),
                "", config().force_limit ? "force_limit" : Field()};
    if (gravity > most / 2) cause.why += fmt::format(", and gravity needs {:.3g} at home", gravity);
    cause.remedy = config().force_limit
                       ? fmt::format("Raise `force_limit` ({:g} is set)", *config().force_limit)
                       : "Give the servos larger forces (edits: [{actuator: NAME, forcerange: [-F, "
                         "F]}], or `force_limit` for all)";
    if (gravity > most / 2 && !compensated()) cause.remedy += ", or set `gravcomp: true`";
    return cause;
  }

  // Returns gravity or damping if they explain it; else only the measurement.
  Cause TooSoft(size_t i, int servo, double gravity, double off) const {
    const int dof = model()->jnt_dofadr[joints_[i]];
    const mjtNum* bias = model()->actuator_biasprm + mjNBIAS * servo;
    const double gear = Gear(model(), servo);
    const double stiffness = StiffnessOf(servo);
    const double damping = -bias[2] * gear * gear + model()->dof_damping[dof];
    double enough = 0;  // unknown
    Cause cause{
        fmt::format(": its servo's stiffness is {:g} {}/{}", stiffness, ForceUnit(i), Unit(i)), "",
        config().stiffness ? "stiffness" : Field()};
    if (gravity >= kExplains * off * stiffness) {
      enough = Rounded(2 * std::max(stiffness, gravity / tolerances_[i]));
      cause.why += fmt::format(", and gravity pulls with {:.3g} {} at home ({:g} would do)",
                               gravity, ForceUnit(i), enough);
      if (!compensated()) cause.remedy = "Set `gravcomp: true` or ";
    } else if (damping > kSlow * stiffness &&
               damping * std::abs(data()->qvel[dof]) >= kExplains * off * stiffness) {
      enough = Rounded(2 * damping / kSlow);
      cause.why +=
          fmt::format(" against a damping of {:g}, so that it takes {:g} s ({:g} would do)",
                      Rounded(damping), Rounded(damping / stiffness), enough);
      if (config().damping)
        cause.remedy = fmt::format("Lower `damping` ({:g} is set) or ", *config().damping);
    } else {
      cause.why += fmt::format(", it pushes with {:.3g} {} and the joint is still {:.3g} {} away",
                               Force(i), ForceUnit(i), off, Unit(i));
      cause.remedy =
          "Check what blocks it (its limits, spring, frictionloss, equality constraints, margins "
          "of "
          "geoms, other actuators) or ";
    }
    const std::string raise = cause.remedy.empty() ? "Raise" : "raise";
    if (config().stiffness) {
      cause.remedy += fmt::format("{} `stiffness` ({:g} is set)", raise, *config().stiffness);
      if (!HasOneJoint()) cause.remedy += ", or leave it out and give each servo its own";
    } else if (HasOneJoint()) {
      cause.remedy += fmt::format("{} the servos' stiffness (`stiffness`, {}/{})", raise,
                                  ForceUnit(i), Unit(i));
    } else {
      cause.remedy += fmt::format("{} the stiffness of its servo", raise);
    }
    if (!HasOneJoint() && enough > 0) AddGain("kp", servo, enough, cause);
    return cause;
  }

  // Rounds to two digits.
  static double Rounded(double value) {
    if (value <= 0) return 0;
    const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
    return std::round(value / unit) * unit;
  }

  Robot& robot_;
  ArmGroup& arm_;
  Scene scene_;
  bool beside_warnings_;
  Findings& findings_;
  std::vector<int> joints_;
  std::vector<double> tolerances_;  // tolerance of each joint in the trial, rad or m
  std::vector<double> arrived_;     // within which a step of an environment has arrived
  std::vector<double> home_;
  std::vector<std::string> touching_;
  std::string diverged_;
  mutable std::optional<SwingCure> cure_;  // found once
};

}  // namespace

void TryArms(Robot& robot, const TrialOptions& options, Findings& findings) {
  for (const std::string& name : robot.group_names()) {
    auto* arm = dynamic_cast<ArmGroup*>(&robot.group(name));
    if (!arm) continue;
    try {
      robot.controller(name);
    } catch (const NotFoundError&) {
      continue;  // reported as invalid (robot/validate_config.h)
    }
    ArmTrial(robot, *arm, options.beside_warnings, findings).Run();
  }
}

}  // namespace robocell::internal
