#include "robocell/motion/gripper_shape.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/assets/model_files.h"
#include "robocell/assets/resolve.h"
#include "robocell/assets/scene_models.h"
#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/gripper_group.h"
#include "robocell/robot/robot.h"
#include "robocell/robot/suction_gripper.h"
#include "robocell/scene/scene.h"

namespace robocell {
namespace {

constexpr int kRows = 41;
constexpr double kFullyOpenSeconds = 0.6;  // time to open fully
constexpr double kRowSeconds = 0.2;        // per step of closing
constexpr double kMostPadHalf = 0.02;      // a longer "pad" is a whole finger: its last part grips
constexpr double kTipPadHalf = 0.01;       // ... this far from its tip
constexpr size_t kMostKept = 32;
// Fingers are rarely mounted askew; millimetres of asymmetry should not turn the grasp frame.
constexpr double kAskew = 0.99;  // cosine to an axis of the TCP
// Jaws on a hinge: the direction in which they close turns, and should follow an axis of the TCP.
constexpr double kTurned = 0.85;  // cosine to the axis where the jaws meet an object
constexpr double kTurning =
    internal::Radians(5);  // turn between open and this gap; parallel fingers do not turn
// Assumed gap between the pads, m, at which jaws on a hinge hold an object: the width of small
// objects. It is not critical, because only the axis nearest to their closing direction counts.
constexpr double kHeldGap = 0.02;

SceneSpec RobotAlone(const RobotConfig& config, const SimOptions& options, double timestep) {
  SceneSpec spec{.name = "gripper of " + config.name,
                 .timestep = timestep,
                 .gravity = {0, 0, 0},
                 .add_floor = false,
                 .add_skybox = false,
                 .options = options};
  RobotSpec robot;
  robot.name = config.name;
  robot.config = config;
  robot.control_modes = config.used_modes();
  spec.robots.push_back(robot);
  return spec;
}

struct Bounds {
  Eigen::Vector3d lower = Eigen::Vector3d::Constant(1e9);
  Eigen::Vector3d upper = Eigen::Vector3d::Constant(-1e9);
};

// Returns the extent of geoms in a frame of the world.
Bounds ExtentOf(const Scene& scene, const std::vector<int>& geoms, const Pose& frame) {
  Bounds box;
  const Eigen::Matrix3d axes = frame.rotation();
  for (int i = 0; i < 3; ++i) {
    const double origin = axes.col(i).dot(frame.translation());
    for (const int g : geoms) {
      const Interval e = internal::GeomExtent(scene.model(), scene.data(), g, axes.col(i));
      box.lower[i] = std::min(box.lower[i], e.lower - origin);
      box.upper[i] = std::max(box.upper[i], e.upper - origin);
    }
  }
  return box;
}

// Returns the axis of a frame, or its opposite, that is nearest to a direction in it.
Eigen::Vector3d NearestAxis(const Eigen::Vector3d& direction) {
  Eigen::Index axis;
  direction.cwiseAbs().maxCoeff(&axis);
  return Eigen::Vector3d::Unit(axis) * (direction[axis] > 0 ? 1 : -1);
}

}  // namespace

// Looks at the cups of a suction gripper.
class CupSurvey {
 public:
  static GripperShape Run(const Scene& scene, const Robot& robot,
                          const internal::SuctionGripper& gripper) {
    const mjModel* m = scene.model();
    const mjData* d = scene.data();
    std::vector<int> faces, carried;  // geoms that stick, and all that hang on their bodies
    for (int g = 0; g < m->ngeom; ++g) {
      for (const int cup : gripper.cups()) {
        if (!internal::IsInSubtree(m, m->geom_bodyid[g], cup)) continue;
        carried.push_back(g);
        if (m->geom_bodyid[g] == cup && internal::IsCollisionGeom(m, g)) faces.push_back(g);
      }
    }
    if (faces.empty()) {
      throw ArgumentError(
          fmt::format("robot '{}' / group '{}': no geom of the bodies that stick collides, so "
                      "nothing sticks to "
                      "them. In the model, give one contype=\"1\" conaffinity=\"1\"",
                      robot.name(), gripper.name()));
    }
    const Pose tcp = robot.tcp_in_world();
    const int last = FindId(m, mjOBJ_JOINT, robot.joint_names().back());
    Eigen::Vector3d towards = -(tcp.inverse() * Eigen::Vector3d(d->xanchor + 3 * last));
    if (towards.norm() < kNoDistance) towards = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d approach = NearestAxis(towards);
    const Eigen::Vector3d across =
        std::abs(approach.y()) < 0.5 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
    Eigen::Matrix3d axes;
    axes << across.cross(approach), across, approach;
    GripperShape shape;
    shape.is_suction_ = true;
    shape.grasp_in_tcp_ = Pose(Eigen::Vector3d::Zero(), axes);
    const Pose frame = tcp * shape.grasp_in_tcp_;
    const Bounds box = ExtentOf(scene, faces, frame);
    shape.pad_half_width_ = (box.upper.x() - box.lower.x()) / 2;
    shape.pad_half_height_ = (box.upper.y() - box.lower.y()) / 2;
    const Eigen::Vector3d middle = (box.lower + box.upper) / 2;
    shape.rows_.push_back({.gap = 0,
                           .joints = {},
                           .pad = {middle.x(), middle.y(), box.upper.z()},
                           .tip = ExtentOf(scene, carried, frame).upper.z()});
    return shape;
  }

 private:
  static constexpr double kNoDistance = 1e-6;  // m between the last joint and the TCP
};

// Closes the gripper in a scene of its own and records its shape.
class GripperSweep {
 public:
  GripperSweep(Scene scene, Robot robot) : scene_(std::move(scene)), robot_(std::move(robot)) {
    gripper_ = dynamic_cast<internal::ActuatedGripper*>(&robot_.gripper());
    if (!gripper_) {
      throw ArgumentError(
          fmt::format("robot '{}': planning a grasp needs a gripper with fingers moved by "
                      "actuators, or suction "
                      "cups, not a group of another kind",
                      robot_.name()));
    }
    const mjModel* m = scene_.model();
    hand_ = gripper_->hand_body();
    for (int g = 0; g < m->ngeom; ++g) {
      if (internal::IsInSubtree(m, m->geom_bodyid[g], hand_)) hand_geoms_.push_back(g);
    }
    const std::vector<std::string>& arm = robot_.joint_names();
    for (int j = 0; j < m->njnt; ++j) {
      const std::string name = ElementName(m, mjOBJ_JOINT, j);
      const bool single = m->jnt_type[j] == mjJNT_HINGE || m->jnt_type[j] == mjJNT_SLIDE;
      const bool of_arm = std::find(arm.begin(), arm.end(), name) != arm.end();
      if (single && !of_arm && internal::IsInSubtree(m, m->jnt_bodyid[j], hand_))
        joints_.push_back(j);
    }
  }

  GripperShape Run() {
    GripperShape shape;
    for (const int j : joints_)
      shape.joint_names_.push_back(ElementName(scene_.model(), mjOBJ_JOINT, j));
    MoveTo(1, kFullyOpenSeconds);
    const Eigen::Vector3d open = Closing();
    Close(SnapToAxis(open, kAskew), shape);
    if (AngleBetween(open, meeting_.closing) > kTurning) {
      MoveTo(1, kFullyOpenSeconds);
      Close(SnapToAxis(meeting_.closing, kTurned), shape);
    }
    std::sort(shape.rows_.begin(), shape.rows_.end(),
              [](const auto& x, const auto& y) { return x.gap < y.gap; });
    return shape;
  }

 private:
  void MoveTo(double opening, double seconds) {
    gripper_->SetOpening(opening);
    const int steps = static_cast<int>(std::lround(seconds / scene_.timestep()));
    if (const StepResult result = scene_.StepN(steps); !result.ok()) {
      throw DivergedError(fmt::format(
          "robot '{}': its gripper is unstable at a timestep of {} s: moving it to opening {:.2f} "
          "on nothing {}. Give a smaller timestep (rates.sim_ms), or its joints damping or "
          "armature",
          robot_.name(), scene_.timestep(), opening, result.message));
    }
    scene_.SyncPoses();
  }

  // The direction from finger to finger, TCP axes, where the gap is nearest to that of a held
  // object.
  struct Meeting {
    double off = std::numeric_limits<double>::infinity();
    Eigen::Vector3d closing = Eigen::Vector3d::Zero();
  };

  // Records the rows of a sweep that begins open, in the frame that closes along `closing`.
  void Close(const Eigen::Vector3d& closing, GripperShape& shape) {
    shape.grasp_in_tcp_ = frame_ = GraspFrame(closing);
    const Eigen::Vector3d a = HalfPad(0), b = HalfPad(1);
    shape.pad_half_width_ = std::min(a.x(), b.x());
    shape.pad_half_height_ = std::min(a.z(), b.z());
    shape.rows_.clear();
    meeting_ = {};
    for (int k = 0; k < kRows; ++k) {
      if (k > 0) MoveTo(1 - k / (kRows - 1.0), kRowSeconds);
      shape.rows_.push_back(Measure());
      const double off = std::abs(shape.rows_.back().gap - kHeldGap);
      if (off < meeting_.off) meeting_ = {off, Closing()};
    }
  }

  Eigen::Vector3d Closing() const {
    return (PadCentre(0, Pose()) - PadCentre(1, Pose())).normalized();
  }

  static double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }

  // Returns the pad of a finger in a frame at the TCP.
  Bounds PadBox(int finger, const Pose& frame_in_tcp) const {
    const internal::Finger& f = gripper_->finger(finger);
    const Pose world = robot_.tcp_in_world() * frame_in_tcp;
    if (!f.sites.empty()) {
      Bounds box;
      for (const int site : f.sites) {
        const Eigen::Vector3d at =
            world.inverse() * Eigen::Vector3d(scene_.data()->site_xpos + 3 * site);
        box.lower = box.lower.cwiseMin(at);
        box.upper = box.upper.cwiseMax(at);
      }
      return {box.lower.array() - kTipPadHalf, box.upper.array() + kTipPadHalf};
    }
    Bounds box = ExtentOf(scene_, f.geoms, world);
    if (box.upper.z() - box.lower.z() > 2 * kMostPadHalf)
      box.lower.z() = box.upper.z() - 2 * kTipPadHalf;
    return box;
  }

  Eigen::Vector3d PadCentre(int finger, const Pose& frame_in_tcp) const {
    const Bounds box = PadBox(finger, frame_in_tcp);
    return (box.lower + box.upper) / 2;
  }
  Eigen::Vector3d HalfPad(int finger) const {
    const Bounds box = PadBox(finger, frame_);
    return (box.upper - box.lower) / 2;
  }

  // Returns the axis of the TCP that points from the wrist to the pads, perpendicular to the
  // direction from finger to finger.
  Pose GraspFrame(const Eigen::Vector3d& closing) const {
    const Eigen::Vector3d a = PadCentre(0, Pose()), b = PadCentre(1, Pose());
    const mjModel* m = scene_.model();
    const int last = FindId(m, mjOBJ_JOINT, robot_.joint_names().back());
    const Eigen::Vector3d wrist =
        robot_.tcp_in_world().inverse() * Eigen::Vector3d(scene_.data()->xanchor + 3 * last);
    const Eigen::Vector3d towards = (a + b) / 2 - wrist;
    Eigen::Vector3d approach = Eigen::Vector3d::UnitZ();
    double best = -1e9;
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i % 3) * (i < 3 ? 1 : -1);
      const Eigen::Vector3d across = axis - axis.dot(closing) * closing;
      if (across.norm() < 0.7 || across.dot(towards) <= best) continue;
      best = across.dot(towards);
      approach = across.normalized();
    }
    Eigen::Matrix3d axes;
    axes << closing.cross(approach), closing, approach;
    return Pose(Eigen::Vector3d::Zero(), axes);
  }

  // Returns the axis of the TCP that is near enough to a direction, else the direction.
  static Eigen::Vector3d SnapToAxis(const Eigen::Vector3d& direction, double cosine) {
    const Eigen::Vector3d axis = NearestAxis(direction);
    return axis.dot(direction) < cosine ? direction : axis;
  }

  GripperShape::Row Measure() const {
    GripperShape::Row row{.gap = gripper_->inter_finger_dist(), .joints = {}};
    for (const int j : joints_)
      row.joints.push_back(scene_.data()->qpos[scene_.model()->jnt_qposadr[j]]);
    const Eigen::Vector3d first = PadCentre(0, frame_), second = PadCentre(1, frame_);
    row.pad = (first + second) / 2;
    row.across = std::abs(first.y() - second.y());
    const Pose world = robot_.tcp_in_world() * frame_;
    const Eigen::Vector3d approach = world.rotation().col(2);
    row.tip = -1e9;
    for (const int g : hand_geoms_) {
      const double end = internal::GeomExtent(scene_.model(), scene_.data(), g, approach).upper;
      row.tip = std::max(row.tip, end - approach.dot(world.translation()));
    }
    return row;
  }

  Scene scene_;
  Robot robot_;
  internal::ActuatedGripper* gripper_ = nullptr;
  int hand_ = 0;
  std::vector<int> hand_geoms_, joints_;
  Pose frame_;
  Meeting meeting_;
};

std::shared_ptr<const GripperShape> GripperShape::Of(const RobotConfig& config,
                                                     const SimOptions& options, double timestep) {
  struct Known {
    SceneSpec spec;
    std::string content;  // of the models' files, which may change
    std::shared_ptr<const GripperShape> shape;
  };
  static std::mutex mutex;
  static std::vector<Known> all_known;
  const SceneSpec spec = RobotAlone(config, options, timestep);
  std::string content;
  internal::ForEachModel(spec, [&](const std::string& name, const std::string& directory) {
    content += internal::ModelFileSet(assets::Resolve(name, directory)).hash + "\n";
  });
  {
    const std::lock_guard lock(mutex);
    for (const Known& known : all_known) {
      if (known.content == content && known.spec == spec) return known.shape;
    }
  }
  Scene scene = Scene::Build(spec);
  scene.Reset();
  Robot robot = Robot::Of(scene, config.name);
  const auto* cups = dynamic_cast<const internal::SuctionGripper*>(&robot.gripper());
  auto shape = std::make_shared<const GripperShape>(cups ? CupSurvey::Run(scene, robot, *cups)
                                                         : GripperSweep(scene, robot).Run());
  const std::lock_guard lock(mutex);
  if (all_known.size() >= kMostKept) all_known.clear();
  all_known.push_back({spec, content, shape});
  return shape;
}

bool GripperShape::Supports(const GripperGroup& gripper) {
  return dynamic_cast<const internal::ActuatedGripper*>(&gripper) != nullptr ||
         dynamic_cast<const internal::SuctionGripper*>(&gripper) != nullptr;
}

GripperShape::Place GripperShape::Find(double gap) const {
  const auto above = std::upper_bound(rows_.begin(), rows_.end(), gap,
                                      [](double g, const Row& row) { return g < row.gap; });
  if (above == rows_.begin()) return {0, 0};
  const size_t below = static_cast<size_t>(above - rows_.begin()) - 1;
  if (above == rows_.end()) return {below, 0};
  return {below, (gap - rows_[below].gap) / (above->gap - rows_[below].gap)};
}

void GripperShape::JointsAt(double gap, std::span<double> out) const {
  const Place at = Find(gap);
  const Row& low = rows_[at.below];
  const Row& high = rows_[std::min(at.below + 1, rows_.size() - 1)];
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = low.joints[i] + at.part * (high.joints[i] - low.joints[i]);
}

Eigen::Vector3d GripperShape::PadAt(double gap) const {
  const Place at = Find(gap);
  const Row& high = rows_[std::min(at.below + 1, rows_.size() - 1)];
  return rows_[at.below].pad + at.part * (high.pad - rows_[at.below].pad);
}

double GripperShape::AcrossAt(double gap) const {
  const Place at = Find(gap);
  const Row& high = rows_[std::min(at.below + 1, rows_.size() - 1)];
  return rows_[at.below].across + at.part * (high.across - rows_[at.below].across);
}

double GripperShape::TipAt(double gap) const {
  double tip = rows_.back().tip;
  for (const Row& row : rows_) {
    if (row.gap >= gap - 1e-3) tip = std::max(tip, row.tip);
  }
  return tip;
}

}  // namespace robocell
