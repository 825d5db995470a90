#include "robocell/expert/augment_expert.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_solutions.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/motion/vertical_line.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/task_space.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/relation_task.h"
#include "robocell/task/run_arms.h"
#include "robocell/task/task_calls.h"

namespace robocell::internal {
namespace {

constexpr double kFreeSpeed = 1.2, kLoadedSpeed = 0.8;  // of the fastest joint, rad/s (m/s)
constexpr double kLeastSeconds = 0.15, kLeastCarrySeconds = 0.3, kMostCarrySeconds = 6;
constexpr double kClearances[] = {0.01, 0.003, 0.001};  // m, of moves
constexpr int kIterations = 4000;
constexpr double kMostOpenSeconds = 1, kOpeningReached = 0.15;
constexpr double kLeastHoldSeconds = 0.5;
// Largest motion of a joint from one target to the next, rad (m): a solution farther away is on
// another branch.
constexpr double kMostStep = 0.35;
constexpr size_t kMostReplays = 8;  // ways of following a segment from which the planner chooses
constexpr int kRestarts = 60;       // of inverse kinematics, for the first pose of a segment
constexpr size_t kMostTried = 12;   // sources for one start
constexpr size_t kNearest = 3;      // the nearest sources, of which each may be the first
constexpr double kMetresPerRadian = 0.2;           // to compare displacements
constexpr double kMissed = 0.05, kSlipped = 0.03;  // m that a held object is off its place

std::vector<double> ValuesOf(const JointVector& q) { return {q.begin(), q.end()}; }

// Returns a vector of a ball of that radius, evenly distributed.
Eigen::Vector3d DrawInBall(double radius, Rng& rng) {
  for (;;) {
    const double x = rng.Uniform(-1, 1), y = rng.Uniform(-1, 1), z = rng.Uniform(-1, 1);
    const Eigen::Vector3d v(x, y, z);
    if (v.squaredNorm() <= 1) return radius * v;
  }
}

std::string HandBodyOf(const Robot& robot) {
  const ChainTip& tip = robot.chain().tip();
  if (tip.kind == ChainTip::Kind::kBody) return tip.name;
  const mjModel* m = robot.scene().model();
  return ElementName(m, mjOBJ_BODY, m->site_bodyid[FindId(m, mjOBJ_SITE, tip.name)]);
}

}  // namespace

AugmentExpert::AugmentExpert(const RunConfig& run, const EpisodeStart& start,
                             Demonstrations sources)
    : run_(run),
      task_(start.task),
      object_kind_(start.object_kinds.empty() ? "" : start.object_kinds.front()),
      sources_(std::move(sources)),
      tick_(run.rates.policy_period()) {}

void AugmentExpert::Begin(const Scene& scene, Rng& rng) {
  robot_ = Robot::Of(scene, internal::FirstArmOfRun(run_));
  arm_.emplace(*robot_, tick_);
  target_ = arm_->target();
  segment_ = 0;
  finished_ = false;
  failure_.clear();
  scene.SyncPoses();
  demo_ = ChooseSource(scene, rng);
  if (demo_) Enter(Phase::kOpen);
}

// Returns the body of the scene for which a name of the source stands; "" if there is none.
std::string AugmentExpert::BodyOf(const Scene& scene, const std::string& name) const {
  TaskCalls task(*task_);
  const std::vector<std::string> known = task.Objects();
  const std::string object =
      std::ranges::find(known, name) == known.end() ? name : task.ObjectOf(name);
  for (const ObjectRecord& record : scene.compiled()->objects()) {
    if (record.name == object) return record.root_body;
  }
  return FindId(scene.model(), mjOBJ_BODY, name) >= 0 ? name : "";
}

// Returns what a segment refers to: what the goal relates the held object to, if it says so.
std::string AugmentExpert::ReferenceOf(const Demonstration& demo,
                                       const DemoSegment& segment) const {
  const auto* relations = dynamic_cast<const RelationTask*>(task_.get());
  if (!relations || segment.held.empty()) return segment.reference;
  for (const RelationTask::Goal& goal : relations->goals()) {
    if (goal.stated.subject != segment.held) continue;
    if (demo.bodies.contains(goal.stated.reference)) return goal.stated.reference;
    if (goal.stated.reference.empty() && !goal.stated.numbers.empty() &&
        FindRelation(goal.stated.relation).reference == RelationReference::kOrNumbers)
      return "";
  }
  return segment.reference;
}

bool AugmentExpert::Fits(const Scene& scene, const Demonstration& demo) const {
  std::set<std::string> handled;  // bodies
  for (const DemoSegment& segment : demo.segments) {
    for (const std::string& name : {ReferenceOf(demo, segment), segment.held}) {
      if (name.empty()) continue;
      const std::string body = BodyOf(scene, name);
      if (body.empty()) return false;
      handled.insert(body);
    }
  }
  const auto* relations = dynamic_cast<const RelationTask*>(task_.get());
  if (!relations) return true;
  return std::ranges::all_of(relations->goals(), [&](const RelationTask::Goal& goal) {
    const std::string& subject = goal.stated.subject;
    if (FindRelation(goal.stated.relation).subject != RelationSubject::kJoint)
      return handled.contains(BodyOf(scene, subject));
    const int body = JointOpening::Of(scene, subject).body_id();
    return handled.contains(ElementName(scene.model(), mjOBJ_BODY, body));
  });
}

// Returns the sources with all that the goal names, of the same kind of object if there are any.
std::vector<const Demonstration*> AugmentExpert::FittingSources(const Scene& scene) const {
  std::vector<const Demonstration*> fitting;
  for (const Demonstration& demo : *sources_) {
    if (Fits(scene, demo)) fitting.push_back(&demo);
  }
  const auto of_other_kind = [&](const Demonstration* demo) {
    return demo->object_kind != object_kind_;
  };
  if (!std::ranges::all_of(fitting, of_other_kind)) std::erase_if(fitting, of_other_kind);
  return fitting;
}

// Returns the motion of the segment's reference from the source to the present scene, in the world.
Pose AugmentExpert::Displacement(const Scene& scene, const Demonstration& demo,
                                 const DemoSegment& segment) const {
  const std::string reference = ReferenceOf(demo, segment);
  if (reference.empty()) return scene.root_frame_to_world() * demo.root_in_world.inverse();
  return scene.body_pose(BodyOf(scene, reference)) *
         demo.bodies.at(reference)[static_cast<size_t>(segment.first)].inverse();
}

// Returns how far from the source's place the robot has to work, m and radians as metres.
double AugmentExpert::DistanceOf(const Scene& scene, const Demonstration& demo) const {
  double distance = 0;
  for (const DemoSegment& segment : demo.segments) {
    const Pose moved = robot_->base_in_world().inverse() * Displacement(scene, demo, segment) *
                       demo.target_in_world[static_cast<size_t>(segment.first)];
    const Pose there = demo.base_in_world[static_cast<size_t>(segment.first)].inverse() *
                       demo.target_in_world[static_cast<size_t>(segment.first)];
    distance += (moved.translation() - there.translation()).norm() +
                kMetresPerRadian * (there.inverse() * moved).angle();
  }
  return distance;
}

std::vector<Pose> AugmentExpert::Targets(const Demonstration& demo, const DemoSegment& segment,
                                         const Pose& displacement, const Pose& in_tcp) const {
  const double rows = segment.end - segment.first;
  const int ticks = std::max(1, static_cast<int>(std::lround(rows * demo.tick / tick_)));
  std::vector<Pose> targets;
  for (int tick = 0; tick < ticks; ++tick) {
    const double at =
        std::min(segment.first + tick * tick_ / demo.tick, static_cast<double>(segment.end - 1));
    const auto row = static_cast<size_t>(at);
    Pose tcp = demo.target_in_world[row];
    const double part = at - std::floor(at);
    if (part > 1e-9 && row + 1 < demo.target_in_world.size())
      tcp = tcp.interpolate(demo.target_in_world[row + 1], part);
    targets.push_back(displacement * tcp * in_tcp);
  }
  return targets;
}

// Returns joint motions through these poses, one for each way of reaching the first one.
std::vector<JointPath> AugmentExpert::Follow(const std::vector<Pose>& tcp_in_world) const {
  const Chain& chain = robot_->chain();
  const TaskSpace task = TaskSpaceOf(*robot_);
  const Pose world_in_base = robot_->base_in_world().inverse();
  const Pose first = world_in_base * tcp_in_world.front();
  std::vector<JointVector> starts;
  if (!task.is_partial(chain)) {
    for (const IkResult& ik :
         IkSolutions(chain, first,
                     {.tolerance = kLineIkTolerance, .seed = target_, .max_restarts = kRestarts}))
      starts.push_back(ik.q);
  }
  if (starts.empty()) {
    const IkResult ik = task.SolveWithin(chain, first, target_, kMostTilt);
    if (ik.success) starts.push_back(ik.q);
  }
  std::vector<JointPath> paths;
  for (const JointVector& start : starts) {
    JointPath path = {start};
    for (size_t i = 1; i < tcp_in_world.size(); ++i) {
      const Pose target = world_in_base * tcp_in_world[i];
      IkResult ik = Ik(chain, target,
                       {.tolerance = kLineIkTolerance, .seed = path.back(), .max_restarts = 0});
      if (!ik.success) ik = task.SolveWithin(chain, target, path.back(), kMostTilt);
      if (!ik.success || JointDistance(ik.q, path.back()) > kMostStep) break;
      path.push_back(ik.q);
    }
    if (path.size() == tcp_in_world.size()) paths.push_back(std::move(path));
    if (paths.size() >= kMostReplays) break;
  }
  return paths;
}

// Returns true if the arm can follow the segments whose objects no earlier segment moves.
bool AugmentExpert::CanFollow(const Scene& scene, const Demonstration& demo) const {
  std::set<std::string> moved;
  for (const DemoSegment& segment : demo.segments) {
    const std::string reference = ReferenceOf(demo, segment);
    if (!moved.contains(reference) &&
        Follow(Targets(demo, segment, Displacement(scene, demo, segment), {})).empty())
      return false;
    moved.insert(segment.held.empty() ? reference : segment.held);
  }
  return true;
}

const Demonstration* AugmentExpert::ChooseSource(const Scene& scene, Rng& rng) {
  std::vector<const Demonstration*> sources = FittingSources(scene);
  if (sources.empty()) {
    GiveUp("no source episode has what this start has");
    return nullptr;
  }
  std::vector<std::pair<double, const Demonstration*>> by_distance;
  for (const Demonstration* demo : sources)
    by_distance.emplace_back(DistanceOf(scene, *demo), demo);
  std::ranges::stable_sort(by_distance, {}, &std::pair<double, const Demonstration*>::first);
  const size_t near = std::min(kNearest, by_distance.size());
  std::swap(by_distance[0], by_distance[rng.UniformInt(near)]);
  for (size_t i = 0; i < std::min(kMostTried, by_distance.size()); ++i) {
    if (CanFollow(scene, *by_distance[i].second)) return by_distance[i].second;
  }
  GiveUp("the arm can follow no source episode here");
  return nullptr;
}

void AugmentExpert::Enter(Phase phase) {
  phase_ = phase;
  ticks_ = 0;
  if (phase == Phase::kOpen && !demo_->opening.empty())
    opening_ = demo_->opening[static_cast<size_t>(segment().first)];
}

void AugmentExpert::EnterNext() {
  if (++segment_ < demo_->segments.size()) return Enter(Phase::kOpen);
  --segment_;  // the phase of its last row goes on
  Enter(Phase::kHold);
}

// Plans the next segment and the move to it.
void AugmentExpert::Plan(const Scene& scene, Rng& rng) {
  scene.SyncPoses();
  const DemoSegment& next = segment();
  const auto row = static_cast<size_t>(next.first);
  const AugmentConfig& options = *run_.augment;
  const Eigen::Vector3d off = DrawInBall(options.translation_noise, rng);
  const Eigen::Vector3d turned = DrawInBall(options.rotation_noise, rng);
  Pose in_tcp = Pose::FromRotvec(off, turned);
  if (!next.held.empty()) {
    const Pose in_source = demo_->tcp_in_world[row].inverse() * demo_->bodies.at(next.held)[row];
    held_in_tcp_ = robot_->tcp_in_world().inverse() * scene.body_pose(BodyOf(scene, next.held));
    if ((held_in_tcp_.translation() - in_source.translation()).norm() > kMissed)
      return GiveUp("the object was not grasped");
    in_tcp = in_source * held_in_tcp_.inverse() * in_tcp;
  }
  const std::vector<JointPath> replays =
      Follow(Targets(*demo_, next, Displacement(scene, *demo_, next), in_tcp));
  if (replays.empty()) return GiveUp("the arm cannot follow the source here");
  if (!PlanMove(scene, replays, rng)) return GiveUp("no free path to the next part");
  Enter(Phase::kMove);
}

bool AugmentExpert::PlanMove(const Scene& scene, const std::vector<JointPath>& replays, Rng& rng) {
  std::vector<MotionGoal> goals;
  for (const JointPath& replay : replays)
    goals.push_back(MotionGoal::Joints(ValuesOf(replay.front())));
  MotionOptions options;
  const bool carries = !segment().held.empty();
  if (carries) options.attached = {{BodyOf(scene, segment().held), HandBodyOf(*robot_)}};
  const uint64_t seed = rng.NextBits();
  for (const double clearance : kClearances) {
    options.clearance = clearance;
    MotionPlanner planner(*robot_, options);
    planner.Update();
    const MotionResult found =
        planner.PlanFrom(ValuesOf(target_), goals, {.seed = seed, .iterations = kIterations});
    if (!found.success) continue;
    replay_ = replays[static_cast<size_t>(found.goal)];
    arm_.emplace(*robot_, tick_);
    arm_->Begin();
    for (size_t i = 1; i < found.path.size(); ++i) {
      const JointVector from{std::span<const double>(found.path[i - 1])};
      const JointVector to{std::span<const double>(found.path[i])};
      const double least =
          carries ? arm_->GentleSeconds({from, to}, kLeastCarrySeconds, kMostCarrySeconds)
                  : kLeastSeconds;
      arm_->AddLeg({to}, carries ? kLoadedSpeed : kFreeSpeed, least);
    }
    return true;
  }
  return false;
}

// Returns true if the held object is no longer where it was in the hand.
bool AugmentExpert::HasLost(const Scene& scene) const {
  if (segment().held.empty()) return false;
  const Pose now =
      robot_->tcp_in_world().inverse() * scene.body_pose(BodyOf(scene, segment().held));
  return (now.translation() - held_in_tcp_.translation()).norm() > kSlipped;
}

void AugmentExpert::Advance(const Scene& scene, Rng& rng) {
  switch (phase_) {
    case Phase::kOpen: {
      const bool waits = robot_->has_gripper() && segment().held.empty() &&
                         std::abs(robot_->gripper().opening() - opening_) > kOpeningReached;
      if (waits && ticks_ * tick_ < kMostOpenSeconds) return;
      return Plan(scene, rng);
    }
    case Phase::kMove:
      if (arm_->Blocked()) return GiveUp("the arm is blocked");
      if (!arm_->Settled()) return;
      if (HasLost(scene)) return GiveUp("the object slipped");
      return Enter(Phase::kReplay);
    case Phase::kReplay:
      if (ticks_ >= static_cast<int>(replay_.size())) EnterNext();
      return;
    case Phase::kHold: {
      const double rest = (demo_->rows() - segment().end) * demo_->tick;
      if (ticks_ * tick_ >= std::max(kLeastHoldSeconds, rest)) finished_ = true;
      return;
    }
  }
}

// Returns the row of the source that a tick of a replay repeats.
int AugmentExpert::RowAt(int tick) const {
  const int row = segment().first + static_cast<int>(tick * tick_ / demo_->tick + 1e-9);
  return std::min(row, segment().end - 1);
}

Action AugmentExpert::Act(const Scene& scene, Rng& rng) {
  if (!finished_) Advance(scene, rng);
  if (!finished_) {
    if (phase_ == Phase::kMove) target_ = arm_->Next();
    if (phase_ == Phase::kReplay) {
      target_ = replay_[static_cast<size_t>(ticks_)];
      if (!demo_->opening.empty()) opening_ = demo_->opening[static_cast<size_t>(RowAt(ticks_))];
    }
    ++ticks_;
  }
  RobotAction action;
  action[robot_->arm().name()] = GroupCommand::Joints(ValuesOf(target_));
  if (robot_->has_gripper() && demo_ && !demo_->opening.empty())
    action[robot_->gripper().name()] = GroupCommand::Opening(opening_);
  return {{robot_->name(), std::move(action)}};
}

int AugmentExpert::phase() const {
  if (!demo_ || phase_ == Phase::kOpen || phase_ == Phase::kMove) return 0;
  if (demo_->phase.empty()) return 1;
  const int row = phase_ == Phase::kReplay ? RowAt(ticks_) : segment().end - 1;
  return 1 + demo_->phase[static_cast<size_t>(row)];
}

std::vector<std::string> AugmentExpert::phase_names() const {
  std::vector<std::string> names = {"move"};
  if (!demo_ || demo_->phase.empty())
    names.emplace_back("replay");
  else
    names.insert(names.end(), demo_->phases.begin(), demo_->phases.end());
  return names;
}

std::string AugmentExpert::results_json() const {
  if (!demo_) return "{}";
  nlohmann::json segments = nlohmann::json::array();
  for (const DemoSegment& each : demo_->segments) {
    segments.push_back({{"rows", {each.first, each.end}},
                        {"reference", ReferenceOf(*demo_, each)},
                        {"held", each.held}});
  }
  return nlohmann::json{{"augmented",
                         {{"source", demo_->episode},
                          {"segments_from", HasSegmentLabels(*demo_) ? "labels" : "gripper"},
                          {"segments", std::move(segments)}}}}
      .dump();
}

void AugmentExpert::GiveUp(const std::string& why) {
  failure_ = why;
  finished_ = true;
}

std::shared_ptr<Expert> MakeAugmentExpert(const RunConfig& run, const EpisodeStart& start,
                                          Demonstrations sources) {
  return std::make_shared<AugmentExpert>(run, start, std::move(sources));
}

}  // namespace robocell::internal
