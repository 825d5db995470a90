#include "robocell/expert/hand_meetings.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include "robocell/base/units.h"
#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/math/rotation.h"
#include "robocell/robot/arm_ik.h"
#include "robocell/task/remembered_grasps.h"

namespace robocell::internal {
namespace {

// Few points with all directions of each: many points would leave the best ones, in the middle.
const GraspOptions kAllOver = {.samples = 200, .most = 2000};
constexpr double kLeastApart = 0.045;   // m between the TCPs of both grasps
constexpr double kFarApart = 0.12;      // m; farther is not better
constexpr size_t kMostTaken = 80;       // grasps of the second hand that are tried
constexpr int kMostOfPlace = 8;         // postures of one pose of the object that are checked
constexpr int kMeetRestarts = 8;        // of inverse kinematics
constexpr double kPlaceStep = 0.08;     // m between places
constexpr int kPlaceYaws = 12;          // turns of the object about the vertical
constexpr double kPlaceTilt = kPi / 4;  // rad between its tilts
constexpr double kTiltCost = 1;         // of one tilt, in steps between places

std::vector<double> JoinedPostures(const JointVector& first, const JointVector& second) {
  std::vector<double> both(first.begin(), first.end());
  both.insert(both.end(), second.begin(), second.end());
  return both;
}

JointVector PresentOf(const Robot& robot) {
  return JointVector(std::span<const double>(robot.arm().joint_pos()));
}

// Returns postures with these TCPs in the world; unset (empty) where the arm has none.
std::vector<JointVector> SolvePoses(const Robot& robot, std::vector<Pose> tcps) {
  const Pose world_in_base = robot.base_in_world().inverse();
  for (Pose& tcp : tcps) tcp = world_in_base * tcp;
  const IkOptions ik = ForArm(robot, {.max_restarts = kMeetRestarts});
  const JointVector seed = PresentOf(robot);
  const IkBatchResult solved = IkBatch(robot.chain(), tcps, seed, {.ik = ik});
  std::vector<JointVector> postures(tcps.size());
  for (int i = 0; i < solved.size; ++i)
    if (solved.success[static_cast<size_t>(i)] != 0)
      postures[static_cast<size_t>(i)] = JointVector(solved.row(i));
  return postures;
}

}  // namespace

HandMeetings::HandMeetings(const Robot& giver, const Robot& taker, const std::string& body,
                           const Eigen::Vector3d& middle)
    : giver_(giver),
      taker_(taker),
      middle_(middle),
      grasps_(RememberedGrasps(taker, body, kAllOver).grasps) {}

// Returns the grasps of the taker that leave room for the giver's hand, best first.
std::vector<Grasp> HandMeetings::GraspsBeside(const Pose& tcp_in_object) const {
  const auto apart = [&](const Grasp& grasp) {
    return (grasp.tcp_in_body.translation() - tcp_in_object.translation()).norm();
  };
  std::vector<Grasp> grasps = grasps_;
  std::erase_if(grasps, [&](const Grasp& grasp) { return apart(grasp) < kLeastApart; });
  std::ranges::stable_sort(grasps, {}, [&](const Grasp& grasp) {
    return -grasp.score - 10 * std::min(apart(grasp), kFarApart);
  });
  if (grasps.size() > kMostTaken) grasps.resize(kMostTaken);
  return grasps;
}

// Returns poses of the object around the middle, the nearest and most level ones first: turned about
// the vertical, and tilted about level axes.
std::vector<Pose> HandMeetings::Places(const Pose& object) const {
  const Quaternion base = giver_.base_in_world().quaternion();
  const double height = std::max(middle_.z(), object.translation().z());
  std::vector<std::pair<double, Pose>> places;
  for (int forward = -1; forward <= 2; ++forward) {
    for (int aside = -1; aside <= 1; ++aside) {
      for (int up = 0; up <= 2; ++up) {
        const Eigen::Vector3d step(forward, aside, up);
        const Eigen::Vector3d place =
            Eigen::Vector3d(middle_.x(), middle_.y(), height) + Rotate(base, kPlaceStep * step);
        for (int tilt = 0; tilt <= 2; ++tilt) {
          for (int axis = 0; axis < (tilt == 0 ? 1 : 4); ++axis) {
            for (int yaw = 0; yaw < kPlaceYaws; ++yaw) {
              const Pose turned = Pose::FromRpy({0, 0, 0}, {0, 0, kPi / 2 * axis}) *
                                  Pose::FromRpy({0, 0, 0}, {kPlaceTilt * tilt, 0, 0}) *
                                  Pose::FromRpy({0, 0, 0}, {0, 0, 2 * kPi * yaw / kPlaceYaws}) *
                                  Pose(Eigen::Vector3d::Zero(), object.quaternion());
              places.emplace_back(step.norm() + kTiltCost * tilt, Pose(place) * turned);
            }
          }
        }
      }
    }
  }
  std::ranges::stable_sort(places, {}, [](const auto& place) { return place.first; });
  std::vector<Pose> poses;
  for (auto& [cost, pose] : places) poses.push_back(pose);
  return poses;
}

bool HandMeetings::Find(const Pose& object, const Pose& tcp_in_object, const MotionPlanner& away,
                        const MotionPlanner& near, int most,
                        const std::function<bool(const HandMeeting&)>& use) const {
  const std::vector<Grasp> grasps = GraspsBeside(tcp_in_object);
  if (grasps.empty()) return false;
  const std::vector<Pose> places = Places(object);
  std::vector<Pose> held;
  for (const Pose& place : places) held.push_back(place * tcp_in_object);
  const std::vector<JointVector> givers = SolvePoses(giver_, std::move(held));
  const Pose world_in_base = taker_.base_in_world().inverse();
  const IkOptions near_ik = ForArm(taker_, {.max_restarts = 0});
  int checked = 0;
  for (size_t p = 0; p < places.size(); ++p) {
    if (givers[p].empty()) continue;
    std::vector<Pose> befores;
    for (const Grasp& grasp : grasps) befores.push_back(places[p] * grasp.before());
    const std::vector<JointVector> takers = SolvePoses(taker_, std::move(befores));
    for (size_t g = 0, of_place = 0; g < grasps.size() && of_place < kMostOfPlace; ++g) {
      if (takers[g].empty()) continue;
      IkOptions ik = near_ik;
      ik.seed = takers[g];
      const IkResult taken =
          Ik(taker_.chain(), world_in_base * places[p] * grasps[g].tcp_in_body, ik);
      if (!taken.success) continue;
      if (++checked > most) return false;
      ++of_place;
      if (!near.IsFree(JoinedPostures(givers[p], taken.q)) ||
          !away.IsFree(JoinedPostures(givers[p], takers[g])))
        continue;
      if (use({places[p], givers[p], takers[g], taken.q, grasps[g]})) return true;
    }
  }
  return false;
}

}  // namespace robocell::internal
