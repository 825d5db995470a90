#include "robocell/robot/gripper_range.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/step.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/measurement_cache.h"
#include "robocell/robot/move_group.h"
#include "robocell/robot/swing_cure.h"
#include "robocell/scene/servo_stability.h"

namespace robocell::internal {
namespace {

constexpr double kLeastSeconds = 1.0;
constexpr double kMostSeconds = 20.0;
constexpr double kWindowSeconds = 0.25;
constexpr double kStill = 2.5e-4;  // metres within a window: a millimetre a second
constexpr double kSteady = 0.97;   // share of the distance moved within the window before
constexpr const char* kContext = "measuring a gripper";

ModelPtr AloneWithoutGravity(const mjModel* model, int robot_body) {
  ModelPtr alone = CopyModel(model);
  mjModel* m = alone.get();
  std::fill_n(m->opt.gravity, 3, 0.0);
  const std::vector<bool> inside = SubtreeMask(m, robot_body);
  for (int g = 0; g < m->ngeom; ++g) {
    if (!inside[m->geom_bodyid[g]]) m->geom_contype[g] = m->geom_conaffinity[g] = 0;
  }
  return alone;
}

DataPtr DataAtHome(const mjModel* m, int home_key) {
  DataPtr data = MakeData(m);
  mjData* d = data.get();
  if (home_key >= 0) Guarded(kContext, d, [&] { mj_resetDataKeyframe(m, d, home_key); });
  return data;
}

void Advance(const mjModel* m, mjData* d, double seconds) {
  const int steps = std::max(1, static_cast<int>(std::ceil(seconds / m->opt.timestep)));
  const StepResult result = Step(m, d, steps, kContext);
  if (!result.ok()) throw EngineError(std::string(kContext) + ": " + result.message);
  Guarded(kContext, d, [&] { mj_kinematics(m, d); });
}

// Returns the distances that the fingers pass within a window, in which they may swing.
Interval Passed(const mjModel* m, mjData* d, const FingerPair& pair) {
  constexpr int kLooks = 10;
  const auto distance = [&] { return FingerDistance(m, d, pair.fingers[0], pair.fingers[1]); };
  Interval passed{distance(), distance()};
  for (int i = 0; i < kLooks; ++i) {
    Advance(m, d, kWindowSeconds / kLooks);
    passed.lower = std::min(passed.lower, distance());
    passed.upper = std::max(passed.upper, distance());
  }
  return passed;
}

bool HasFriction(const mjModel* m, int hand) {
  const std::vector<bool> inside = SubtreeMask(m, hand);
  for (int dof = 0; dof < m->nv; ++dof) {
    if (inside[m->dof_bodyid[dof]] && m->dof_frictionloss[dof] > 0) return true;
  }
  return false;
}

// Returns sentences that name a cure if joints of the hand oscillate; "" if they do not, if nothing
// helps, or if gains are so high that they diverge, which others report.
std::string WhyTheySwing(const mjModel* m, const mjData* d, const GripperParts& parts,
                         std::string_view prefix) {
  if (!UnstableServos(m, parts.robot_body, prefix).empty()) return "";
  SwingTrial trial{.model = m, .start = d, .prefix = prefix};
  const std::vector<bool> inside = SubtreeMask(m, parts.pair.hand);
  for (int j = 0; j < m->njnt; ++j) {
    const bool single = m->jnt_type[j] == mjJNT_HINGE || m->jnt_type[j] == mjJNT_SLIDE;
    if (single && inside[m->jnt_bodyid[j]]) trial.joints.push_back(j);
  }
  const std::vector<int> swinging = SwingingJoints(trial);
  if (swinging.empty()) return "";
  const SwingCure cure = FindSwingCure(trial);
  if (!cure.found()) return "";
  std::string name = ElementName(m, mjOBJ_JOINT, swinging.front());
  if (name.starts_with(prefix)) name.erase(0, prefix.size());
  return fmt::format(
      "Joint '{}' oscillates: what drives it is too stiff for the inertia that it moves at a "
      "timestep of {:g} s. {}.",
      name, m->opt.timestep, cure.Text());
}

// Fingers held by dry friction creep on steadily, because friction is soft in the engine. This
// counts as rest, or the measurement would wait until they reach a position that friction keeps
// them from.
double SettledDistance(const mjModel* m, mjData* d, const GripperParts& parts,
                       const std::vector<double>& ctrl, std::string_view prefix) {
  const auto width = [](const Interval& passed) { return passed.upper - passed.lower; };
  const bool may_creep = HasFriction(m, parts.pair.hand);
  for (size_t i = 0; i < ctrl.size(); ++i) {
    if (!std::isnan(ctrl[i])) d->ctrl[parts.ctrl_addresses[i]] = ctrl[i];
  }
  const double end = d->time + kMostSeconds;
  Advance(m, d, kLeastSeconds - 2 * kWindowSeconds);
  double before = width(Passed(m, d, parts.pair));
  for (;;) {
    const Interval passed = Passed(m, d, parts.pair);
    const bool creeps = may_creep && width(passed) > kSteady * before;
    if (width(passed) <= kStill || creeps)
      return FingerDistance(m, d, parts.pair.fingers[0], parts.pair.fingers[1]);
    if (d->time >= end) {
      std::string why = WhyTheySwing(m, d, parts, prefix);
      if (why.empty()) {
        why =
            "Are the gripper's gains, damping and contacts right, or is its joint too slow for "
            "its actuator?";
      }
      throw ArgumentError(fmt::format(
          "the fingers do not come to rest: {} s after control {} they go between {:.4f} and "
          "{:.4f} m in a quarter of a second. {}",
          kMostSeconds, CtrlText(ctrl), passed.lower, passed.upper, why));
    }
    before = width(passed);
  }
}

RobotRecord RecordOf(const Scene& scene, const GripperParts& parts) {
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    if (FindId(scene.model(), mjOBJ_BODY, robot.base_body) == parts.robot_body) return robot;
  }
  return {};
}

// Calls look(model, data, distance) when the fingers have settled at the first end and at the
// second. `model` is one AloneWithoutGravity.
template <class Look>
void LookAtEnds(const ModelPtr& model, const Scene& scene, const GripperParts& parts,
                const std::array<std::vector<double>, 2>& ctrl, const Look& look) {
  const DataPtr data = DataAtHome(model.get(), scene.compiled()->home_key());
  const std::string prefix = RecordOf(scene, parts).prefix;
  for (const std::vector<double>& values : ctrl) {
    const double distance = SettledDistance(model.get(), data.get(), parts, values, prefix);
    look(model.get(), data.get(), distance);
  }
}

template <class Look>
void LookAtEnds(const Scene& scene, const GripperParts& parts,
                const std::array<std::vector<double>, 2>& ctrl, const Look& look) {
  LookAtEnds(AloneWithoutGravity(scene.model(), parts.robot_body), scene, parts, ctrl, look);
}

// The distance of each pair of geoms of the two fingers; negative for overlaps.
using GeomDistances = std::map<std::array<int, 2>, double>;

GeomDistances DistancesOfGeoms(const mjModel* m, mjData* d, const FingerPair& pair) {
  GeomDistances distances;
  for (const int g : pair.fingers[0].geoms) {
    for (const int h : pair.fingers[1].geoms) {
      double distance = 0;
      Guarded(kContext, d, [&] { distance = mj_geomDistance(m, d, g, h, 1, nullptr); });
      distances[{g, h}] = distance;
    }
  }
  return distances;
}

// Detects fingers that may touch but have passed through each other: contacts are soft, and cannot
// stop fingers that cross within a few timesteps.
class PassedFingers {
 public:
  // The state `to` was simulated from `from` (nq) under the controls `ctrl`.
  PassedFingers(const mjModel* m, const GripperParts& parts, std::span<const mjtNum> from,
                std::span<const mjtNum> to, const std::vector<double>& ctrl)
      : m_(m),
        parts_(parts),
        ctrl_(ctrl),
        from_(from.begin(), from.end()),
        to_(to.begin(), to.end()),
        data_(MakeData(m)) {}

  // Returns "" if they did not; else a description and the edits that help.
  std::string Text(const RobotRecord& robot) {
    const auto geoms = DeepestPair();
    if (!geoms) return "";
    const auto own = [&](mjtObj kind, int id) {
      const std::string name = ElementName(m_, kind, id);
      return name.starts_with(robot.prefix) ? name.substr(robot.prefix.size()) : name;
    };
    const std::vector<int> joints = Joints();
    const double damping = EnoughDamping(*geoms, joints);
    std::vector<std::string> edits;
    for (const int joint : joints) {
      const double present = m_->dof_damping[m_->jnt_dofadr[joint]];
      edits.push_back(fmt::format("{{joint: '{}', damping: {}}}", own(mjOBJ_JOINT, joint),
                                  RoundedGain(2 * std::max(damping, present))));
    }
    return fmt::format(
        "robot '{}': '{}' and '{}' pass through each other on the way to control {}: they are too "
        "light and "
        "too "
        "fast for their contact to stop them with a timestep of {:g} s, so the measured "
        "distance is wrong. Slow them down with damping, in their model or by edits: [{}], or use "
        "a smaller timestep",
        robot.name, own(mjOBJ_BODY, m_->geom_bodyid[(*geoms)[0]]),
        own(mjOBJ_BODY, m_->geom_bodyid[(*geoms)[1]]), CtrlText(ctrl_), m_->opt.timestep,
        fmt::join(edits, ", "));
  }

 private:
  static constexpr int kParts = 50;             // parts of the straight line between the two states
  static constexpr double kThrough = 1e-3;      // metres deeper than at both of its ends
  static constexpr double kContactTime = 0.02;  // s; the engine's default for contacts

  bool MayTouch(int g, int h) const {
    const int a = std::min(m_->geom_bodyid[g], m_->geom_bodyid[h]);
    const int b = std::max(m_->geom_bodyid[g], m_->geom_bodyid[h]);
    const int *first = m_->exclude_signature, *end = first + m_->nexclude;
    return ((m_->geom_contype[g] & m_->geom_conaffinity[h]) != 0 ||
            (m_->geom_contype[h] & m_->geom_conaffinity[g]) != 0) &&
           std::find(first, end, (a << 16) + b) == end;
  }

  // Returns distances at a share of the line.
  GeomDistances At(double share) {
    std::vector<mjtNum> displacement(static_cast<size_t>(m_->nv));
    mj_differentiatePos(m_, displacement.data(), 1, from_.data(), to_.data());
    std::copy(from_.begin(), from_.end(), data_->qpos);
    mj_integratePos(m_, data_->qpos, displacement.data(), share);
    Guarded(kContext, data_.get(), [&] { mj_kinematics(m_, data_.get()); });
    return DistancesOfGeoms(m_, data_.get(), parts_.pair);
  }

  std::optional<std::array<int, 2>> DeepestPair() {
    const GeomDistances first = At(0), last = At(1);
    std::optional<std::array<int, 2>> deepest;
    double depth = -kThrough;
    for (int i = 1; i < kParts; ++i) {
      for (const auto& [geoms, distance] : At(static_cast<double>(i) / kParts)) {
        const double at_ends = std::min({first.at(geoms), last.at(geoms), 0.0});
        if (distance - at_ends >= depth || !MayTouch(geoms[0], geoms[1])) continue;
        depth = distance - at_ends;
        deepest = geoms;
      }
    }
    return deepest;
  }

  // Returns the joints that move the fingers.
  std::vector<int> Joints() const {
    std::vector<int> joints;
    for (const Finger& finger : parts_.pair.fingers) {
      int body = finger.body;
      while (body > 0 && body != parts_.pair.hand && m_->body_jntnum[body] == 0)
        body = m_->body_parentid[body];
      if (body > 0 && body != parts_.pair.hand) joints.push_back(m_->body_jntadr[body]);
    }
    return joints;
  }

  // Returns a damping with which they cross at most half of their thickness while a contact builds
  // up its force.
  double EnoughDamping(const std::array<int, 2>& geoms, const std::vector<int>& joints) {
    mjData* d = data_.get();
    std::copy(from_.begin(), from_.end(), d->qpos);
    for (size_t i = 0; i < ctrl_.size(); ++i) {
      if (!std::isnan(ctrl_[i])) d->ctrl[parts_.ctrl_addresses[i]] = ctrl_[i];
    }
    Guarded(kContext, d, [&] { mj_forward(m_, d); });
    double half_thickness = HUGE_VAL;
    for (const int g : geoms) {
      const mjtNum* half = m_->geom_aabb + 6 * g + 3;
      half_thickness = std::min<double>(half_thickness, *std::min_element(half, half + 3));
    }
    double most = 0;
    for (const int joint : joints) {
      double lever = 1;  // no lever for a slide
      if (m_->jnt_type[joint] == mjJNT_HINGE)
        lever = mju_dist3(d->xanchor + 3 * joint, d->geom_xpos + 3 * geoms[0]);
      most = std::max(most, lever * std::abs(d->qfrc_actuator[m_->jnt_dofadr[joint]]));
    }
    return most * kContactTime / half_thickness;
  }

  const mjModel* m_;
  const GripperParts& parts_;
  const std::vector<double>& ctrl_;
  std::vector<mjtNum> from_, to_;
  const DataPtr data_;
};

// Adds the pairs of touching bodies, one of which the hand's fingers move.
void AddTouching(const mjModel* m, const mjData* d, int hand, const std::string& prefix,
                 std::vector<std::string>& pairs) {
  const auto own = [&](int body) {
    const std::string name = ElementName(m, mjOBJ_BODY, body);
    return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
  };
  const std::vector<bool> inside = SubtreeMask(m, hand);
  const auto moves = [&](int body) { return body != hand && inside[body]; };
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (contact.exclude != 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    const int a = m->geom_bodyid[contact.geom[0]], b = m->geom_bodyid[contact.geom[1]];
    if (!moves(a) && !moves(b)) continue;
    const std::string pair = fmt::format("'{}' and '{}'", own(a), own(b));
    if (std::find(pairs.begin(), pairs.end(), pair) == pairs.end()) pairs.push_back(pair);
  }
}

// Measurements are kept as numbers.
std::vector<double> Packed(const SettledFingers& settled) {
  const FlatDistance flat = settled.flat.value_or(FlatDistance{});
  const PressedFingers pressed = settled.pressed.value_or(PressedFingers{});
  std::vector<double> out = {settled.distances[0],
                             settled.distances[1],
                             settled.flat ? 1.0 : 0.0,
                             flat.distance,
                             flat.share,
                             flat.points_follow ? 1.0 : 0.0,
                             settled.pressed ? 1.0 : 0.0,
                             static_cast<double>(pressed.geoms[0]),
                             static_cast<double>(pressed.geoms[1]),
                             pressed.depth};
  for (const auto& point : flat.points) out.insert(out.end(), point.begin(), point.end());
  out.insert(out.end(), settled.pushed.begin(), settled.pushed.end());
  return out;
}

SettledFingers Unpacked(const std::vector<double>& from) {
  constexpr size_t kPoints = 10, kForces = 16;
  SettledFingers out{.distances = {from[0], from[1]}};
  if (from[2] != 0) {
    out.flat = FlatDistance{from[3], from[4], from[5] != 0};
    for (size_t i = 0; i < 6; ++i) out.flat->points[i / 3][i % 3] = from[kPoints + i];
  }
  if (from[6] != 0)
    out.pressed = PressedFingers{{static_cast<int>(from[7]), static_cast<int>(from[8])}, from[9]};
  out.pushed.assign(from.begin() + kForces, from.end());
  return out;
}

std::string FingerName(const Finger& finger) {
  return fmt::format("sites {} body {} geoms {}", fmt::join(finger.sites, " "), finger.body,
                     fmt::join(finger.geoms, " "));
}

}  // namespace

std::vector<int> ActuatorsOf(const mjModel* m, const GripperParts& parts) {
  std::vector<int> actuators;
  for (const int address : parts.ctrl_addresses) {
    for (int a = 0; a < m->nactuator; ++a) {
      if (m->actuator_ctrlnum[a] > 0 && m->actuator_ctrladr[a] == address) actuators.push_back(a);
    }
  }
  return actuators;
}

std::vector<std::string> TouchingFingers(const Scene& scene, const GripperParts& parts,
                                         const std::array<std::vector<double>, 2>& ctrl) {
  std::vector<std::string> pairs;
  const std::string prefix = RecordOf(scene, parts).prefix;
  LookAtEnds(scene, parts, ctrl, [&](const mjModel* m, const mjData* d, double) {
    AddTouching(m, d, parts.pair.hand, prefix, pairs);
  });
  return pairs;
}

std::optional<std::array<int, 2>> OverlapOfFingers(const Scene& scene, const GripperParts& parts,
                                                   const std::array<std::vector<double>, 2>& ctrl) {
  GeomDistances farthest;  // distances at the farther one of the two ends
  LookAtEnds(scene, parts, ctrl, [&](const mjModel* m, mjData* d, double) {
    for (const auto& [geoms, distance] : DistancesOfGeoms(m, d, parts.pair)) {
      const auto [at, is_new] = farthest.try_emplace(geoms, distance);
      if (!is_new) at->second = std::max(at->second, distance);
    }
  });
  const auto deepest =
      std::min_element(farthest.begin(), farthest.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  if (deepest == farthest.end() || deepest->second > 0) return std::nullopt;
  return deepest->first;
}

std::string CtrlText(const std::vector<double>& ctrl) {
  if (ctrl.size() == 1) return fmt::format("{}", ctrl[0]);
  return fmt::format("[{}]", fmt::join(ctrl, ", "));
}

SettledFingers SettleFingers(const Scene& scene, const GripperParts& parts,
                             const std::array<std::vector<double>, 2>& ctrl) {
  const std::string what = fmt::format(
      "fingers of body {}: {}, {}; controls {}: {}, {}", parts.robot_body,
      FingerName(parts.pair.fingers[0]), FingerName(parts.pair.fingers[1]),
      fmt::join(parts.ctrl_addresses, " "), fmt::join(ctrl[0], " "), fmt::join(ctrl[1], " "));
  const auto measure = [&](const ModelPtr& model) -> MeasuredValues {
    SettledFingers settled;
    std::vector<mjtNum> before;
    std::string passed;
    LookAtEnds(model, scene, parts, ctrl, [&](const mjModel* m, const mjData* d, double distance) {
      const std::span<const mjtNum> now(d->qpos, static_cast<size_t>(m->nq));
      if (before.empty()) {
        settled.distances[0] = distance;
        before.assign(now.begin(), now.end());
        return;
      }
      settled.distances[1] = distance;
      passed = PassedFingers(m, parts, before, now, ctrl[1]).Text(RecordOf(scene, parts));
      if (!passed.empty()) LogWarn(passed);
      settled.flat = FindFlatDistance(m, parts.pair, before, now);
      settled.pressed = FindPressedFingers(m, d, parts.pair,
                                           std::abs(settled.distances[1] - settled.distances[0]));
      for (const int a : ActuatorsOf(m, parts)) settled.pushed.push_back(d->actuator_force[a]);
    });
    return {Packed(settled), passed.empty()};
  };
  return Unpacked(CachedMeasurement(scene.compiled(), what, [&] {
    const ModelPtr model = AloneWithoutGravity(scene.model(), parts.robot_body);
    const std::string start =
        fmt::format("{}; hand {}; prefix '{}'; keyframe {}", what, parts.pair.hand,
                    RecordOf(scene, parts).prefix, scene.compiled()->home_key());
    return MeasurementOfEqualModels(model.get(), start, [&] { return measure(model); });
  }));
}

std::array<double, 2> SettledJointValues(const Scene& scene, const GripperParts& parts,
                                         const std::array<std::vector<double>, 2>& ctrl,
                                         int joint) {
  std::vector<double> values;
  LookAtEnds(scene, parts, ctrl, [&](const mjModel* m, const mjData* d, double) {
    values.push_back(d->qpos[m->jnt_qposadr[joint]]);
  });
  return {values[0], values[1]};
}

}  // namespace robocell::internal
