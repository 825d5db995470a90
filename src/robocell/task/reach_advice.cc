#include "robocell/task/reach_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "robocell/base/units.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/motion/vertical_line.h"
#include "robocell/robot/robot.h"
#include "robocell/robot/task_space.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/grasp_motion.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/run_arms.h"

namespace robocell::internal {
namespace {

constexpr double kGrid = 0.05;           // metres between the places that are tried
constexpr int kMostPlaces = 20;          // cells in each direction: large robots get a coarser grid
constexpr int kTurns = 4;                // turns of the gripper around the vertical, in half a turn
constexpr int kRestarts = 40;            // as the experts: what they would not find is not advised
constexpr double kTolerance = 1e-3;      // m and rad
constexpr double kRounding = 1e-9;       // m
constexpr double kTypicalGap = 0.04;     // metres between the fingers
constexpr double kTypicalHeight = 0.03;  // height of an object's centre above its support

struct BasePlace {
  double distance, offset;  // base_distance and base_height_offset
  bool grasp = false, pregrasp = false, lift = false;
};

Robot OnlyRobot(const RunConfig& run) {
  SceneSpec spec{.name = run.run,
                 .timestep = run.rates.timestep().value(),
                 .add_floor = false,
                 .add_skybox = false,
                 .options = run.options};
  const RobotConfig& config = run.robot.config;
  spec.robots.push_back(
      {.name = config.name, .config = config, .control_modes = config.used_modes()});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return Robot::Of(scene, FirstArmOfRun(run));
}

class Search {
 public:
  explicit Search(const RunConfig& run)
      : robot_(OnlyRobot(run)),
        task_(TaskSpaceOf(robot_)),
        shape_(GripperShape::Of(robot_.config(), run.options, robot_.scene().timestep())),
        lift_height_(PickRunOf(run.task).value_or(PickRun{}).lift_height),
        requested_(BaseRangeOf(run.start, {})),
        motion_(GraspMotionsToLift(lift_height_)) {
    const double reach = robot_.reach(), step = std::max(kGrid, reach / kMostPlaces);
    step_ = step;
    const double up = BaseUp();
    for (double distance = step; distance <= reach; distance += step) {
      for (double height = -reach; height <= reach; height += step)
        places_.push_back({distance, step * std::round((height - up) / step)});
    }
  }

  ReachAdvice Advice() {
    const std::vector<BasePlace> all = Usable();
    if (!all.empty()) {
      return Where(ReachedPart::kAll, "a grasp from above, pregrasp and lift included, is in reach",
                   all);
    }
    const auto unlifted = Those([](const BasePlace& p) { return p.pregrasp; });
    if (!unlifted.empty()) {
      return Where(ReachedPart::kPregrasp,
                   fmt::format("no place of the base lets the arm lift by {:.2f} m "
                               "(task.lift_height, {:g} m, and what a grasp slips): give less. "
                               "Without the lift a grasp from above is in reach",
                               motion_.lift, lift_height_),
                   unlifted);
    }
    const auto grasped = Those([](const BasePlace& p) { return p.grasp; });
    if (!grasped.empty()) {
      return Where(ReachedPart::kGrasp,
                   fmt::format("no place of the base lets the arm come from {:.2f} m above, which "
                               "it does before a grasp. The grasp alone is in reach",
                               motion_.above),
                   grasped);
    }
    return {.text =
                "at no place around the robot does its gripper point straight down within the "
                "joints' ranges, and objects are grasped from above: look at the ranges, at the "
                "order of the arm's joints and at the fingers (robocell check)",
            .reached = ReachedPart::kNothing};
  }

 private:
  // Returns the height of the base frame above the bottom of the robot's pedestal.
  double BaseUp() const {
    return (robot_.base().pose().inverse() * robot_.base_in_world()).translation().z();
  }

  // Returns the places from which all of a pick is in reach. What follows a grasp counts only where
  // the part before it is in reach: searching for joint values that do not exist takes longest.
  std::vector<BasePlace> Usable() {
    Try(0, &BasePlace::grasp, [](const BasePlace&) { return true; });
    Try(motion_.above, &BasePlace::pregrasp, [](const BasePlace& p) { return p.grasp; });
    Try(motion_.lift, &BasePlace::lift, [](const BasePlace& p) { return p.pregrasp; });
    return Those([](const BasePlace& p) { return p.lift; });
  }

  template <class Wanted>
  std::vector<BasePlace> Those(const Wanted& wanted) const {
    std::vector<BasePlace> out;
    std::copy_if(places_.begin(), places_.end(), std::back_inserter(out), wanted);
    return out;
  }

  // Returns the TCP for a grasp of an object `distance` in front of the base and `offset` below its
  // bottom.
  Pose Tcp(const BasePlace& place, int turn, double above) const {
    const Pose& bottom = robot_.base().pose();
    const Eigen::Vector3d object =
        bottom * Eigen::Vector3d(place.distance, 0, kTypicalHeight - place.offset + above);
    const Pose grasp = Pose::FromRpy(object, {kPi, 0, bottom.rpy().z() + turn * kPi / kTurns}) *
                       Pose(Eigen::Vector3d(-shape_->PadAt(kTypicalGap)), Quaternion{0, 0, 0, 1});
    return robot_.base_in_world().inverse() * grasp * shape_->grasp_in_tcp().inverse();
  }

  // Sets `reached` of the wanted places from which the arm reaches `above` a grasp.
  template <class Wanted>
  void Try(double above, bool BasePlace::*reached, const Wanted& wanted) {
    std::vector<Pose> targets;
    std::vector<BasePlace*> places;
    for (BasePlace& place : places_) {
      if (!wanted(place)) continue;
      places.push_back(&place);
      for (int turn = 0; turn < kTurns; ++turn) targets.push_back(Tcp(place, turn, above));
    }
    if (targets.empty()) return;
    IkBatchOptions options;
    options.ik.tolerance = kTolerance;
    options.ik.max_restarts = kRestarts;
    const std::vector<double> home = robot_.arm().joint_pos();
    const IkBatchResult result = IkBatch(robot_.chain(), targets, home, options);
    for (int b = 0; b < result.size; ++b) {
      const size_t i = static_cast<size_t>(b);
      bool& is_reached = places[i / kTurns]->*reached;
      if (is_reached) continue;
      is_reached = result.success[b] ||
                   task_.SolveWithin(robot_.chain(), targets[i], home, kMostTilt).success;
    }
  }

  // Returns the height with the most distances in reach, of equal ones the nearest to the run's. The
  // run's own height is kept where it has at least half as many.
  double BestOffset(const std::vector<BasePlace>& places) const {
    double best = 0, own = 0;
    int most = 0, of_own = 0;
    for (const BasePlace& place : places) {
      const auto same = [&](const BasePlace& p) { return p.offset == place.offset; };
      const int count = static_cast<int>(std::count_if(places.begin(), places.end(), same));
      const double off = std::abs(place.offset - requested_.height_offset);
      const bool nearer = off < std::abs(best - requested_.height_offset);
      if (count > most || (count == most && nearer)) best = place.offset, most = count;
      if (off <= step_ / 2 + kRounding) own = place.offset, of_own = count;
    }
    return 2 * of_own >= most && of_own > 0 ? own : best;
  }

  // Describes the height with the most distances in reach, these distances, and the configured
  // values.
  ReachAdvice Where(ReachedPart reached, const std::string& what,
                    const std::vector<BasePlace>& places) const {
    const double best = BestOffset(places);
    double low = 0, high = 0;
    bool first = true;
    for (const BasePlace& place : places) {
      if (place.offset != best) continue;
      low = first ? place.distance : std::min(low, place.distance);
      high = first ? place.distance : std::max(high, place.distance);
      first = false;
    }
    const std::string text = fmt::format(
        "{} with start.base_height_offset {:.2f} and base_distance {:.2f} ... {:.2f} m, for "
        "example "
        "(collisions aside); the run says {:g}, with noise {:g} ... {:g}, and {:g} ... {:g}",
        what, best, low, high, requested_.height_offset, requested_.height_noise[0],
        requested_.height_noise[1], requested_.distance[0], requested_.distance[1]);
    return {.text = text, .reached = reached, .height_offset = best, .distance = {low, high}};
  }

  Robot robot_;
  TaskSpace task_;
  std::shared_ptr<const GripperShape> shape_;
  double lift_height_;
  BaseRange requested_;
  GraspMotionOptions motion_;
  double step_ = 0;  // between the places that are tried, m
  std::vector<BasePlace> places_;
};

}  // namespace

ReachAdvice AdviseReach(const RunConfig& run) { return Search(run).Advice(); }

}  // namespace robocell::internal
