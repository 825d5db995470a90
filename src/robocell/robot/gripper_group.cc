#include "robocell/robot/gripper_group.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/hand_pose.h"
#include "robocell/robot/measurement_cache.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/element_lookup.h"
#include "robocell/scene/servo_stability.h"

namespace robocell::internal {
namespace {

constexpr double kOpenFrom = 0.9;      // opening above which a gripper counts as open
constexpr double kLeastTravel = 1e-4;  // metres; fingers that move less do not move
constexpr double kJammed = 0.8;     // share of the travel; differences of slow fingers are smaller
constexpr double kMeetsFrom = 0.2;  // share of the travel from closed; earlier is not checked
constexpr double kSluggish = 1;     // s; no gripper needs longer to move by 1 - 1/e of its way
constexpr double kParted = 0.02;    // share of the travel from which on fingers are separate
constexpr double kSqueeze = 0.05;   // the openings in which fingers that met are pressed together

// Returns true if a geom of the finger's side touches a geom on a body that `accept` accepts.
template <class Accept>
bool Touches(const mjModel* m, const mjData* d, const Finger& finger, const Accept& accept) {
  const auto on_side = [&](int geom) {
    return std::find(finger.side.begin(), finger.side.end(), geom) != finger.side.end();
  };
  for (int c = 0; c < d->ncon; ++c) {
    const mjContact& contact = d->contact[c];
    if (contact.exclude != 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    for (int i = 0; i < 2; ++i) {
      if (on_side(contact.geom[i]) && accept(m->geom_bodyid[contact.geom[1 - i]])) return true;
    }
  }
  return false;
}

std::vector<double> ValuesOf(const std::vector<GripperCtrl>& ends, double GripperCtrl::*end) {
  std::vector<double> values;
  for (const GripperCtrl& ctrl : ends) values.push_back(ctrl.*end);
  return values;
}

// Suggests what `fingers`, or without joints `joints`, may be.
std::string FingerHint(const mjModel* m, const RobotRecord& robot, const std::vector<int>& joints) {
  if (joints.empty()) {
    std::set<std::string> taken;
    for (const auto& [name, group] : robot.config.move_groups.entries())
      taken.insert(group->joints.begin(), group->joints.end());
    std::vector<std::string> names = RobotElementNames(m, robot, mjOBJ_JOINT);
    std::erase_if(names, [&](const std::string& name) { return taken.contains(name); });
    return names.empty() ? "No joint is left for them" : "Its joints may be: " + ListNames(names);
  }
  std::set<int> bodies;
  for (const int joint : joints) {
    const int body = m->jnt_bodyid[joint];
    bodies.insert({m->body_parentid[body], body});
  }
  std::vector<std::string> names;
  for (const int body : bodies) {
    const std::string name = ElementName(m, mjOBJ_BODY, body);
    if (name.starts_with(robot.prefix)) names.push_back(name.substr(robot.prefix.size()));
  }
  return "Bodies that move at its joints, and those that carry them: " + ListNames(names);
}

// The largest mesh of a finger, m; those drawn in millimetres are a thousand times too large.
constexpr double kLargestMesh = 2;

// Returns the name of an element in the robot's own file.
std::string NameInFile(const mjModel* m, const RobotRecord& robot, mjtObj kind, int id) {
  const std::string name = ElementName(m, kind, id);
  return name.starts_with(robot.prefix) ? name.substr(robot.prefix.size()) : name;
}

// Hints that the mesh of a finger is too large to be in metres; "" if none is.
std::string MillimetresHint(const mjModel* m, const RobotRecord& robot, const FingerPair& pair) {
  for (const Finger& finger : pair.fingers) {
    for (const int g : finger.geoms) {
      const mjtNum* half = m->geom_aabb + 6 * static_cast<ptrdiff_t>(g) + 3;
      const double size = 2 * *std::max_element(half, half + 3);
      if (m->geom_type[g] != mjGEOM_MESH || size <= kLargestMesh) continue;
      return fmt::format(
          "The mesh '{}' of '{}' is {:.3g} m large. Is it drawn in millimetres? Then give its "
          "<mesh> scale=\"0.001 0.001 0.001\"",
          NameInFile(m, robot, mjOBJ_MESH, m->geom_dataid[g]),
          NameInFile(m, robot, mjOBJ_BODY, m->geom_bodyid[g]), size);
    }
  }
  return "";
}

// Returns "geom 'pad' of 'left_finger'".
std::string GeomOfBody(const mjModel* m, const RobotRecord& robot, int geom) {
  const std::string name = NameInFile(m, robot, mjOBJ_GEOM, geom);
  if (name.empty()) return Describe(m, mjOBJ_GEOM, geom);  // includes its body
  return fmt::format("geom '{}' of '{}'", name,
                     NameInFile(m, robot, mjOBJ_BODY, m->geom_bodyid[geom]));
}

void Swap(GripperCtrl& ctrl) { std::swap(ctrl.open, ctrl.closed); }

double At(const GripperCtrl& ctrl, double share) {
  return ctrl.closed + (ctrl.open - ctrl.closed) * share;
}

// Returns the gains that a simulation of these robots cannot follow, from the scene's warnings with
// their places; "" for none.
std::string WhyUnstable(const Scene& scene) {
  std::string why;
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    const int base = FindId(scene.model(), mjOBJ_BODY, robot.base_body);
    for (const UnstableServo& servo : UnstableServos(scene.model(), base, robot.prefix)) {
      const std::vector<std::string>& warnings = scene.compiled()->warnings();
      const auto found = std::ranges::find_if(warnings, [&](const std::string& warning) {
        return warning.find(servo.too_high) != std::string::npos;
      });
      why += why.empty() ? " The simulation cannot follow a gain: " : "; ";
      why += found == warnings.end() ? servo.text() : *found;
    }
    for (const std::string& spring : UnstableSprings(scene.model(), base, robot.prefix))
      why += fmt::format(" Robot '{}': {}", robot.name, spring);
  }
  return why;
}

// The fingers do not come together.
class NoClosing : public ArgumentError {
 public:
  using ArgumentError::ArgumentError;
};

}  // namespace

ActuatedGripper::ActuatedGripper(const Scene& scene, GroupNames names, MoveGroupConfig config)
    : JointGroupOf(scene, std::move(names), MoveGroupKind::kGripper), config_(std::move(config)) {
  if (nu() == 0) {
    throw ArgumentError(core().place() +
                        ": a gripper needs the actuator that moves it, in `actuators`");
  }
  if (config_.ctrl) configured_.assign(static_cast<size_t>(nu()), *config_.ctrl);
  if (!config_.poses.empty()) {
    closing_pose_ = config_.closing_pose_name();
    UsePoses();
  }
  ResolveFingers();
}

void ActuatedGripper::SetClosingPose(const std::string& name) {
  if (config_.poses.empty()) return GripperGroup::SetClosingPose(name);
  const std::string pose = name.empty() ? config_.closing_pose_name() : name;
  if (pose == closing_pose_) return;
  if (!config_.poses.contains(pose))
    throw NotFoundError(NoSuchName(core().place(), "pose", pose, config_.poses.keys()));
  if (pose == MoveGroupConfig::kOpenPose) {
    throw ArgumentError(
        fmt::format("{}: the hand cannot close towards its pose 'open'; its others: {}",
                    core().place(), ListNames(config_.poses.keys())));
  }
  const std::string before = std::exchange(closing_pose_, pose);
  try {
    UsePoses();
    if (is_other_pose()) Measured();  // here, so that reading the opening takes no trial
  } catch (...) {
    closing_pose_ = before;
    UsePoses();
    throw;
  }
}

void ActuatedGripper::UsePoses() {
  core().Bind();
  const std::vector<double> open = CtrlOfPose(core(), config_, MoveGroupConfig::kOpenPose);
  const std::vector<double> closed = CtrlOfPose(core(), config_, closing_pose_);
  if (open == closed) {
    Fail("poses", fmt::format("the controls of 'open' and '{}' are the same, {}", closing_pose_,
                              CtrlText(open)));
  }
  configured_.clear();
  for (size_t i = 0; i < open.size(); ++i) configured_.push_back({open[i], closed[i]});
}

void ActuatedGripper::Fail(const char* field, const std::string& message) const {
  FailAtField(core(), field, message);
}

void ActuatedGripper::FailToClose(const char* field, const std::string& message) const {
  if (!is_other_pose()) Fail(field, message);
  try {
    Fail(field, message);
  } catch (const ArgumentError& error) {
    throw NoClosing(error.what());  // Measured() catches it
  }
}

const GripperParts& ActuatedGripper::Parts() const {
  core().Bind();
  if (generation_ != core().scene().generation()) ResolveFingers();
  return parts_;
}

void ActuatedGripper::ResolveFingers() const {
  const mjModel* m = core().model();
  const RobotRecord& robot = core().scene().compiled()->robot(core().names().robot);
  const std::vector<int>& joints = core().joint_ids();
  std::vector<ElementId> ends;
  for (const ElementRef& finger : config_.fingers)
    ends.push_back(FindElement(m, robot, finger, {mjOBJ_GEOM, mjOBJ_BODY, mjOBJ_SITE}));
  if (ends.empty() && joints.size() == 2) {
    for (const int tip : FingertipBodies(m, m->jnt_bodyid[joints[0]], m->jnt_bodyid[joints[1]]))
      ends.push_back({mjOBJ_BODY, tip});
  }
  if (ends.size() < 2) {
    Fail("fingers",
         fmt::format(
             "which are its fingers? Name two geoms, bodies or sites in `fingers` (they "
             "can be guessed only for a gripper with two joints; this one has {}). {}",
             joints.empty() ? "none: list them in `joints`" : fmt::format("{}", joints.size()),
             FingerHint(m, robot, joints)));
  }
  parts_ = {RequireId(m, mjOBJ_BODY, robot.base_body, core().place()), core().ctrl_addresses(),
            MakeFingers(m, ends, core().place())};
  pairs_.clear();
  for (size_t i = 1; i < ends.size(); ++i)
    pairs_.push_back(MakeFingers(m, ends[0], ends[i], core().place()));
  generation_ = core().scene().generation();
}

const GripperRange& ActuatedGripper::Measured() const {
  if (const auto known = measured_.find(closing_pose_); known != measured_.end())
    return known->second;
  if (is_other_pose()) {
    try {
      return measured_[closing_pose_] = Measure();
    } catch (const NoClosing&) {  // a pose that points or waves
    } catch (const ArgumentError& error) {
      CachedMeasurement(
          core().scene().compiled(), core().place() + " / pose " + closing_pose_, [&] {
            LogWarn(fmt::format("{}; openings towards pose '{}' are the commanded ones",
                                error.what(), closing_pose_));
            return std::vector<double>{};
          });
    }
    return measured_[closing_pose_] = {.ctrl = configured_};
  }
  const GripperRange& measured = measured_[closing_pose_] = Measure();
  const std::string what = "warnings of " + core().place();
  CachedMeasurement(core().scene().compiled(), what, [&] {  // once for a model
    for (const std::string& doubt : Doubts(measured)) LogWarn(core().place() + ": " + doubt);
    return std::vector<double>{};
  });
  return measured;
}

std::vector<std::string> ActuatedGripper::Doubts(const GripperRange& range) const {
  std::vector<std::string> doubts;
  const CompiledScene& compiled = *core().scene().compiled();
  const RobotRecord& robot = compiled.robot(core().names().robot);
  if (range.flat) doubts.push_back(HowToFollow(compiled, robot, Parts().pair, *range.flat));
  if (range.pressed) {
    doubts.push_back(HowToPressLess(core().model(), robot, *range.pressed,
                                    ActuatorsOf(core().model(), Parts()), range.pushed));
  }
  return doubts;
}

// The error of a model that diverges, or does not come to rest, names the gripper's owner.
SettledFingers ActuatedGripper::Settled(const FingerPair& pair,
                                        const std::array<std::vector<double>, 2>& ctrl) const {
  try {
    return SettleFingers(core().scene(), {Parts().robot_body, Parts().ctrl_addresses, pair}, ctrl);
  } catch (const EngineError& error) {
    throw EngineError(core().place() + ": " + error.what() + "." + WhyUnstable(core().scene()));
  } catch (const ArgumentError& error) {
    std::string sluggish = WhySluggish();
    if (!sluggish.empty()) sluggish.insert(0, 1, ' ');
    Fail("fingers", error.what() + WhyUnstable(core().scene()) + sluggish + WhyNoOpening());
  }
}

// Names an actuator whose control is a speed; "" if there is none.
std::string ActuatedGripper::WhyNoOpening() const {
  const mjModel* m = core().model();
  for (const std::string& name : actuator_names()) {
    if (ActuatorForceKind(m, RequireId(m, mjOBJ_ACTUATOR, name, "")) != CtrlMode::kVelocity)
      continue;
    return fmt::format(
        " Its actuator '{}' is a velocity servo: its control is a speed, which holds no opening. "
        "Drive the fingers with a position servo or a motor",
        name);
  }
  return "";
}

std::vector<GripperCtrl> ActuatedGripper::Ends() const {
  if (has_own_ends()) return configured_;
  std::vector<GripperCtrl> ends;
  for (const Interval& limits : ctrl_limits()) {
    if (!std::isfinite(limits.lower) || !std::isfinite(limits.upper)) {
      Fail(
          "ctrl",
          fmt::format("actuator '{}' has no control range; give `ctrl: {{open: ..., closed: ...}}`",
                      actuator_names()[std::min(ends.size(), actuator_names().size() - 1)]));
    }
    ends.push_back({limits.upper, limits.lower});
  }
  if (ends.size() > 1) Orient(ends);
  return ends;
}

void ActuatedGripper::Orient(std::vector<GripperCtrl>& ends) const {
  const mjModel* m = core().model();
  const int key = core().scene().compiled()->home_key();
  std::vector<double> home;
  for (const int a : Parts().ctrl_addresses)
    home.push_back(key >= 0 ? m->key_ctrl[key * m->nu + a] : 0.0);
  std::vector<size_t> idle;
  std::optional<bool> first_swapped;
  for (size_t i = 0; i < ends.size(); ++i) {
    std::array<std::vector<double>, 2> alone = {home, home};
    alone[0][i] = ends[i].open;
    alone[1][i] = ends[i].closed;
    double opens = 0;  // m, by how much the first end is farther open
    for (const FingerPair& pair : pairs_) {
      const auto [at_open, at_closed] = Settled(pair, alone).distances;
      if (std::abs(at_open - at_closed) > std::abs(opens)) opens = at_open - at_closed;
    }
    if (std::abs(opens) < kLeastTravel) {
      idle.push_back(i);
      continue;
    }
    if (opens < 0) Swap(ends[i]);
    if (!first_swapped) first_swapped = opens < 0;
  }
  if (!first_swapped.value_or(false)) return;
  for (const size_t i : idle) Swap(ends[i]);
}

// Both controls give this distance.
std::string ActuatedGripper::WhyTheyStay(const std::array<std::vector<double>, 2>& ctrl,
                                         double distance) const {
  const mjModel* m = core().model();
  const FingerPair& pair = Parts().pair;
  const CompiledScene& compiled = *core().scene().compiled();
  const RobotRecord& robot = compiled.robot(core().names().robot);
  if (std::string hint = MillimetresHint(m, robot, pair); !hint.empty()) return hint;
  if (const auto jaw = FindJaw(m, pair)) return HowToNameTips(compiled, robot, pair, *jaw);
  const auto geoms = distance > 0 ? std::nullopt : OverlapOfFingers(core().scene(), Parts(), ctrl);
  if (!geoms) return WhyTheyJam(ctrl);
  return fmt::format(
      "{} and {} overlap open and closed: name as `fingers` one geom of each finger that does not, "
      "of those that grasp",
      GeomOfBody(m, robot, (*geoms)[0]), GeomOfBody(m, robot, (*geoms)[1]));
}

std::string ActuatedGripper::WhyTheyJam(const std::array<std::vector<double>, 2>& ctrl) const {
  if (std::string sluggish = WhySluggish(); !sluggish.empty()) return sluggish;
  const std::vector<std::string> touching = TouchingFingers(core().scene(), Parts(), ctrl);
  if (touching.empty()) return "Nothing touches them: is the actuator too weak to move them?";
  return fmt::format(
      "Meanwhile {} touch. Do they overlap or catch on each other (exclude in the model the pairs "
      "that may overlap, or choose another `home`), or is the actuator too weak to move the "
      "fingers?",
      ListNames(touching, 6));
}

std::string ActuatedGripper::WhySluggish() const {
  const mjModel* m = core().model();
  const RobotRecord& robot = core().scene().compiled()->robot(core().names().robot);
  for (const std::string& name : actuator_names()) {
    const int a = RequireId(m, mjOBJ_ACTUATOR, name, "");
    if (!IsPositionServo(m, a)) continue;
    const double kp = -m->actuator_biasprm[mjNBIAS * a + 1];
    const double kv = -m->actuator_biasprm[mjNBIAS * a + 2];
    if (kp <= 0 || kv <= kSluggish * kp) continue;
    return fmt::format(
        "The kv of its servo '{0}', {1:.3g}, is too large for its kp of {2:g}, so that it takes "
        "{3:.3g} s. Lower it in the model, or by edits: [{{actuator: '{0}', kv: {4}}}]",
        name.starts_with(robot.prefix) ? name.substr(robot.prefix.size()) : name, kv, kp, kv / kp,
        RoundedGain(kp / 10));
  }
  return "";
}

GripperRange ActuatedGripper::Measure() const {
  std::vector<GripperCtrl> ends = Ends();
  const std::vector<double> open = ValuesOf(ends, &GripperCtrl::open);
  const std::vector<double> closed = ValuesOf(ends, &GripperCtrl::closed);
  const SettledFingers closing = Settled({open, closed});
  const auto [at_open, at_closed] = closing.distances;
  // Measures in reverse order, so that the first starts from home and the second after it.
  const SettledFingers opening = Settled({closed, open});
  const auto [closed_first, open_after] = opening.distances;
  const auto ends_of_travel = std::minmax({at_open, at_closed, closed_first, open_after});
  const double travel = ends_of_travel.second - ends_of_travel.first;
  if (travel < kLeastTravel) {
    FailToClose("fingers",
                fmt::format("the finger distance stays at {:.4f} m between control {} and {}; "
                            "are `fingers` and `ctrl` right? {}",
                            at_open, CtrlText(open), CtrlText(closed),
                            WhyTheyStay({open, closed}, at_open)));
  }
  const auto jams = [&](const std::vector<double>& ctrl, double from_home, double later,
                        const std::vector<double>& other) {
    if (std::abs(from_home - later) < kJammed * travel) return;
    Fail("fingers",
         fmt::format(
             "the fingers do not come back: control {} brings them {:.4f} m apart from home, and "
             "leaves them {:.4f} m apart after control {}. {}",
             CtrlText(ctrl), from_home, later, CtrlText(other), WhyTheyJam({other, ctrl})));
  };
  jams(open, at_open, open_after, closed);
  jams(closed, closed_first, at_closed, open);
  GripperRange range{.ctrl = ends, .distance = {at_closed, at_open}};
  const SettledFingers& closes = at_open > at_closed ? closing : opening;
  range.flat = closes.flat;
  range.pressed = closes.pressed;
  range.pushed = closes.pushed;
  if (at_open <= at_closed && !has_own_ends()) {
    std::for_each(range.ctrl.begin(), range.ctrl.end(), Swap);
    std::swap(range.distance.closed, range.distance.open);
  }
  if (range.distance.open > range.distance.closed) {
    range.meets = MeetingShare(range.ctrl, range.distance);
    return range;
  }
  if (!config_.poses.empty()) {
    FailToClose("poses",
                fmt::format("the fingers are {:.4f} m apart in pose 'open' and {:.4f} m in pose "
                            "'{}', which does not close them. Are `fingers` those that meet in it?",
                            at_open, at_closed, closing_pose_));
  }
  Fail("ctrl", fmt::format("the fingers are {:.4f} m apart at ctrl.open = {} and {:.4f} m at "
                           "ctrl.closed = {}; open and closed are swapped",
                           at_open, config_.ctrl->open, at_closed, config_.ctrl->closed));
}

GripperJointRange ActuatedGripper::MeasureJoint() const {
  const std::vector<GripperCtrl> ends = has_own_ends() ? configured_ : Measure().ctrl;
  const auto [open, closed] =
      SettledJointValues(core().scene(), Parts(),
                         {ValuesOf(ends, &GripperCtrl::open), ValuesOf(ends, &GripperCtrl::closed)},
                         core().joint_ids()[0]);
  return {open, closed};
}

double ActuatedGripper::MeetingShare(const std::vector<GripperCtrl>& ends,
                                     const GripperDistance& distance) const {
  const std::vector<double> open = ValuesOf(ends, &GripperCtrl::open);
  const double parted = distance.closed + kParted * (distance.open - distance.closed);
  const auto together = [&](double share) {
    std::vector<double> ctrl;
    for (const GripperCtrl& end : ends) ctrl.push_back(At(end, share));
    return Settled({open, ctrl}).distances[1] <= parted;
  };
  if (!together(kMeetsFrom)) return 0;
  double least = kMeetsFrom, most = 1;
  for (int i = 0; i < 7; ++i) {
    const double share = (least + most) / 2;
    (together(share) ? least : most) = share;
  }
  return least;
}

double ActuatedGripper::inter_finger_dist() const {
  const FingerPair& pair = Parts().pair;
  core().scene().SyncPoses();
  return FingerDistance(core().model(), core().data(), pair.fingers[0], pair.fingers[1]);
}

Interval ActuatedGripper::inter_finger_dist_range() const {
  return {Distances().closed, Distances().open};
}

double ActuatedGripper::opening() const {
  if (config_.joint_range) {
    const auto& [open, closed] = *config_.joint_range;
    return std::clamp((joint_pos()[0] - closed) / (open - closed), 0.0, 1.0);
  }
  const GripperDistance& d = Distances();
  if (d.open <= d.closed) return CommandedShare();
  return std::clamp((inter_finger_dist() - d.closed) / (d.open - d.closed), 0.0, 1.0);
}

double ActuatedGripper::CommandedShare() const {
  double along = 0, whole = 0;
  for (size_t i = 0; i < configured_.size(); ++i) {
    const double travel = configured_[i].open - configured_[i].closed;
    along += travel * (core().data()->ctrl[core().ctrl_addresses()[i]] - configured_[i].closed);
    whole += travel * travel;
  }
  return std::clamp(along / whole, 0.0, 1.0);
}

double ActuatedGripper::CheckedOpening(double opening) const {
  if (!std::isfinite(opening)) {
    throw ArgumentError(fmt::format("{}: opening cannot be {}; it goes from 0 (closed) to 1 (open)",
                                    core().place(), opening));
  }
  return std::clamp(opening, 0.0, 1.0);
}

double ActuatedGripper::ShareFor(double opening) const {
  const double meets = has_own_ends() ? 0 : Measured().meets;
  if (meets == 0) return opening;
  const auto apart = [&](double o) { return meets + (1 - meets) * o; };
  return opening >= kSqueeze ? apart(opening) : apart(kSqueeze) * opening / kSqueeze;
}

double ActuatedGripper::ctrl_for_opening(double opening) const {
  return At(CtrlEnds()[0], ShareFor(CheckedOpening(opening)));
}

void ActuatedGripper::CtrlForOpening(double opening, std::span<double> ctrl) const {
  const double share = ShareFor(CheckedOpening(opening));
  const std::vector<GripperCtrl>& ends = CtrlEnds();
  for (size_t i = 0; i < ctrl.size(); ++i) ctrl[i] = At(ends[i], share);
}

void ActuatedGripper::SetOpening(double opening) {
  core().Bind();
  const double checked =
      CheckedOpening(beyond_.Clamp(opening, {0, 1}, [&] { return core().place() + ": opening"; }));
  const std::vector<GripperCtrl>& ends = CtrlEnds();
  const std::vector<int>& addresses = core().ctrl_addresses();
  const double share = ShareFor(checked);
  for (size_t i = 0; i < addresses.size(); ++i)
    core().data()->ctrl[addresses[i]] = At(ends[i], share);
}

bool ActuatedGripper::is_open() const { return opening() >= kOpenFrom; }

bool ActuatedGripper::is_grasping(const std::string& body) const {
  const FingerPair& pair = Parts().pair;
  if (body.empty()) return IsGraspingAnything();
  const mjModel* m = core().model();
  const mjData* d = core().data();
  const int wanted = RequireId(m, mjOBJ_BODY, body, core().place());
  const auto is_wanted = [&](int touched) { return IsInSubtree(m, touched, wanted); };
  return Touches(m, d, pair.fingers[0], is_wanted) && Touches(m, d, pair.fingers[1], is_wanted);
}

// Returns true if both fingers touch parts of one movable body outside the robot.
bool ActuatedGripper::IsGraspingAnything() const {
  const mjModel* m = core().model();
  const mjData* d = core().data();
  const auto can_be_held = [&](int body) {
    return m->body_weldid[body] != 0 && !IsInSubtree(m, body, parts_.robot_body);
  };
  return Touches(m, d, parts_.pair.fingers[0], [&](int touched) {
    if (!can_be_held(touched)) return false;
    return Touches(m, d, parts_.pair.fingers[1], [&](int other) {
      return can_be_held(other) && m->body_rootid[other] == m->body_rootid[touched];
    });
  });
}

}  // namespace robocell::internal
