#include "robocell/task/pick_sampler.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/motion/clearance.h"
#include "robocell/motion/robot_outline.h"
#include "robocell/scene/scene_cache.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/object_places.h"
#include "robocell/scenes/settle.h"
#include "robocell/task/grasp_motion.h"
#include "robocell/task/pick_task.h"

namespace robocell {
namespace {

// Of objects and base around each other. Where none of a few fits hardly one of many does: the next
// attempt moves on from there.
constexpr int kArrangements = 8;
constexpr int kPlaceTries = 60;  // of objects, until a base pose is clear of the support
constexpr int kMostDistractors = 2;
constexpr size_t kMostSupports = 64;       // that are remembered
constexpr double kBaseClearance = 0.01;    // metres between the robot and everything else
constexpr double kFacingNoise = 0.35;      // rad
constexpr int kBearings = 72;              // directions that a base pose is looked for in
constexpr const char* kTarget = "target";  // its name in the scene
const Eigen::Vector3d kParked(20, 0, 1);   // where the robot waits while the objects settle

// Where the base's placement of an episode stands in a sequence that is even over any stretch, and
// over the first episodes of any number of scenes: the factor is prime.
uint64_t PlacementTurn(const SampleRequest& request) {
  return static_cast<uint64_t>(request.scene) * 7919 + static_cast<uint64_t>(request.episode);
}

// Sets a pointer until it goes out of scope.
template <class T>
class Lent {
 public:
  Lent(T*& slot, T* value) : slot_(slot) { slot_ = value; }
  ~Lent() { slot_ = nullptr; }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;

 private:
  T*& slot_;
};

}  // namespace

SceneSpec PickTaskSampler::MakeBaseScene(int scene_index) {
  SceneSpec spec;
  spec.name = run_.run;
  spec.timestep = run_.rates.timestep().value();
  spec.options = run_.options;
  if (run_.scenes.kind() == SceneSourceKind::kFiles) {
    const std::string& file = run_.scenes.files.at(static_cast<size_t>(scene_index));
    spec.base = assets::Resolve(file, run_.scenes.root.value_or(run_.source_dir));
  } else {
    spec.base = "tabletop";
    spec.add_floor = true;
    spec.add_skybox = true;
  }
  return spec;
}

// What is the same in one call of Sample, and costs a look at the disk each time.
struct PickTaskSampler::Measured {
  ObjectSizes sizes;
  std::shared_ptr<const GripperShape> shape;
};

PickTaskSampler::PickTaskSampler(RunConfig run) : run_(std::move(run)) {}
PickTaskSampler::~PickTaskSampler() = default;

// Many scenes of a run may have the same base, and a subclass may make another one every time, or
// another file of the same name.
Support PickTaskSampler::SupportOf(const SceneSpec& base) {
  const std::string key = SceneKey(base);
  const auto it = supports_.find(key);
  if (it != supports_.end()) return it->second;
  if (supports_.size() >= kMostSupports) supports_.clear();
  return supports_[key] = FindSupport(base);
}

// Of K kinds every one comes once in any K episodes of a scene that follow each other from a
// multiple of K on, and once in the same episode of K such scenes: a Latin square of scenes and
// episodes, however many of both a run has. Its order is drawn anew for each square: base
// placements take turns too, and with one order for all each kind would only ever be seen from its
// own part of the range.
std::string PickTaskSampler::KindOfTurn(std::vector<std::string> kinds,
                                        const SampleRequest& request) const {
  const size_t count = kinds.size();
  const auto scene = static_cast<size_t>(request.scene);
  const auto episode = static_cast<size_t>(request.episode);
  Rng rng = Rng::Stream(static_cast<uint64_t>(run_.seed), "kinds of a square", scene / count,
                        episode / count);
  rng.Shuffle(kinds);
  return kinds[(scene % count + episode % count) % count];
}

std::vector<std::string> PickTaskSampler::ChooseKinds(const SampleRequest& request, Rng& rng) {
  const std::vector<std::string> all = ObjectKinds();
  const std::vector<std::string>& allowed =
      run_.task.objects.empty() ? all : run_.task.objects.names;
  std::vector<std::string> kinds = {KindOfTurn(allowed, request)};
  // Other kinds only: "pick up the mug" has to mean one object.
  std::vector<std::string> others = allowed;
  std::erase(others, kinds.front());
  rng.Shuffle(others);
  const size_t distractors = std::min<size_t>(rng.UniformInt(kMostDistractors + 1), others.size());
  kinds.insert(kinds.end(), others.begin(),
               others.begin() + static_cast<std::ptrdiff_t>(distractors));
  return kinds;
}

BasePlacement PickTaskSampler::ChooseBasePlacement(const SampleRequest& request, Rng& rng) {
  return SpreadBasePlacement(run_.task, static_cast<uint64_t>(run_.seed), PlacementTurn(request),
                             request.attempt, rng);
}

bool PickTaskSampler::PlaceObjects(const Support& support, std::vector<SceneObject>& objects,
                                   Rng& rng) {
  ObjectSizes own;
  ObjectSizes& known = measured_ ? measured_->sizes : own;
  std::vector<ObjectSize> sizes;
  for (const SceneObject& object : objects) sizes.push_back(known.Of(object));
  return PlaceOn(support, sizes, objects, rng);
}

std::optional<Pose> PickTaskSampler::ProposeBasePose(const Robot& robot, const Support& support,
                                                     const Pose& target,
                                                     const BasePlacement& placement, Rng& rng) {
  const RobotOutline outline(robot);
  const double first = rng.Uniform(-kPi, kPi);
  const double turn = kPi + rng.Uniform(-kFacingNoise, kFacingNoise);
  std::vector<Pose> clear;
  for (int i = 0; i < kBearings; ++i) {
    const double bearing = first + 2 * kPi * i / kBearings;
    const Eigen::Vector3d offset(placement.distance * std::cos(bearing),
                                 placement.distance * std::sin(bearing), placement.height);
    const Pose base = Pose::FromRpy(target.translation() + offset, {0, 0, bearing + turn});
    if (outline.IsClearOf(support.box(), base, kBaseClearance)) clear.push_back(base);
  }
  if (clear.empty()) return std::nullopt;
  return clear[rng.UniformInt(clear.size())];
}

std::optional<Refusal> PickTaskSampler::CheckBasePose(Scene& scene, Robot& robot,
                                                      const std::string& target_body) {
  const Eigen::Vector3d target = scene.body_pose(target_body).translation();
  const double distance = (target - robot.base_in_world().translation()).norm();
  if (distance > kReachShare * robot.reach()) {
    return Refusal{Refusal::kNoReachableBasePose,
                   fmt::format("{:.2f} m away, reach is {:.2f} m", distance, robot.reach())};
  }
  const Clearance nearest = RobotClearance(scene, robot, kBaseClearance);
  if (nearest.distance < kBaseClearance) {
    return Refusal{Refusal::kBaseInCollision,
                   fmt::format("{} is {:.3f} m from {}", nearest.robot_geom, nearest.distance,
                               nearest.other_geom)};
  }
  return CheckGrasps(scene, robot, target_body);
}

// The PickPlanner's question, but for the path. A robot with a gripper of the user's own kind comes
// with an expert of its own, which knows better.
std::optional<Refusal> PickTaskSampler::CheckGrasps(const Scene& scene, const Robot& robot,
                                                    const std::string& target_body) const {
  if (!robot.has_gripper() || !GripperShape::Supports(robot.gripper())) return std::nullopt;
  std::shared_ptr<const GripperShape> shape = measured_ ? measured_->shape : nullptr;
  if (!shape) shape = GripperShape::Of(robot.config(), run_.options, scene.timestep());
  if (measured_) measured_->shape = shape;
  PlanningScene planning(scene, robot, target_body, std::move(shape));
  std::vector<GraspCandidate> candidates =
      FindGrasps(planning.model(), planning.data(), planning.target_body(), planning.shape(),
                 robot.tcp_in_world());
  if (candidates.empty())
    return Refusal{Refusal::kNoGrasp,
                   "the object is too large, too small or too flat for the gripper: " +
                       SizesForGrasp(planning.model(), planning.data(), planning.target_body(),
                                     planning.shape())};
  const std::vector<double> home = robot.arm().joint_pos();
  GraspMotions motions(planning, std::move(candidates), JointVector(std::span<const double>(home)),
                       GraspMotionOptionsOf(run_.task));
  if (motions.Next()) return std::nullopt;
  return Refusal{
      motions.MostCollide() ? Refusal::kGraspsInCollision : Refusal::kNoReachableBasePose,
      "grasps: " + motions.Reasons()};
}

struct PickTaskSampler::Setup {
  std::vector<SceneObject> objects;
  Scene scene;
  Robot robot;
  std::string target_body;
  StopCheck stop;
  RefusalCounts redrawn = {};
};

std::optional<Refusal> PickTaskSampler::ArrangeOnce(Setup& setup, const Support& support,
                                                    const BasePlacement& placement, Rng& rng) {
  std::optional<Pose> base;
  for (int t = 0; t < kPlaceTries && !base; ++t) {
    if (!PlaceObjects(support, setup.objects, rng))
      return Refusal{Refusal::kNoFreePlace, "the objects do not fit beside each other"};
    base = ProposeBasePose(setup.robot, support, setup.objects.front().pose(), placement, rng);
  }
  if (!base) {
    return Refusal{Refusal::kBaseInCollision,
                   fmt::format("{:.2f} m from the target and {:.2f} m above it the robot overlaps "
                               "the support wherever the target lies",
                               placement.distance, placement.height)};
  }
  for (const SceneObject& object : setup.objects) {
    setup.scene.SetBodyPose(setup.scene.compiled()->object(object.name).root_body, object.pose());
  }
  setup.robot.base().SetPose(*base);
  setup.scene.Forward();
  return CheckBasePose(setup.scene, setup.robot, setup.target_body);
}

// Draws places for the objects and for the base until both fit, and counts those that do not.
// Nothing is stepped, so many are tried quickly.
std::optional<Refusal> PickTaskSampler::Arrange(Setup& setup, const Support& support,
                                                const BasePlacement& placement, Rng& rng) {
  std::optional<Refusal> refusal = ArrangeOnce(setup, support, placement, rng);
  for (int t = 1; t < kArrangements && refusal && !ShouldStop(setup.stop); ++t) {
    if (refusal->reason == Refusal::kNoGrasp) break;  // no base pose changes that
    ++setup.redrawn[refusal->reason];
    refusal = ArrangeOnce(setup, support, placement, rng);
  }
  return refusal;
}

// From the built scene to the start state.
std::optional<Refusal> PickTaskSampler::Prepare(Setup& setup, const Support& support,
                                                const BasePlacement& placement, Rng& rng) {
  if (auto refusal = Arrange(setup, support, placement, rng)) return refusal;
  if (auto why_not = Settle(setup.scene, {&setup.robot, 1}, setup.target_body,
                            {.sim_steps = run_.rates.sim_steps(), .stop = setup.stop}))
    return Refusal{Refusal::kUnsettled, *why_not};
  if (auto refusal = CheckBasePose(setup.scene, setup.robot, setup.target_body)) return refusal;
  setup.scene.data()->time = 0;
  setup.scene.Forward();
  return std::nullopt;
}

std::shared_ptr<Task> PickTaskSampler::MakeTask(const std::string& target, const std::string& kind,
                                                const std::vector<std::string>& objects) {
  return std::make_shared<PickTask>(target, kind, objects, run_.task.lift_height);
}

SampleResult PickTaskSampler::Sample(const SampleRequest& request, Rng& rng) {
  Measured measured;
  const Lent lent(measured_, &measured);
  SceneSpec spec = MakeBaseScene(request.scene);
  const Support support = SupportOf(spec);
  const std::vector<std::string> kinds = ChooseKinds(request, rng);
  const BasePlacement placement = ChooseBasePlacement(request, rng);
  std::vector<std::string> names;
  std::vector<SceneObject> objects;
  for (size_t i = 0; i < kinds.size(); ++i) {
    names.push_back(i == 0 ? kTarget : fmt::format("object_{}", i));
    objects.push_back(MakeCatalogueObject(kinds[i], names.back(), rng));
  }
  if (!PlaceObjects(support, objects, rng)) {
    return {.start = {},
            .refusal = {.reason = Refusal::kNoFreePlace,
                        .detail = "the objects do not fit beside each other",
                        .object_kind = kinds[0]}};
  }
  for (const SceneObject& object : objects) spec.objects.push_back(object);
  spec.robots.push_back({.name = run_.robot.config.name,
                         .config = run_.robot.config,
                         .prefix = "robot_0/",
                         .pos = ToVec3(kParked),
                         .control_modes = run_.robot.config.used_modes()});

  Scene scene = Scene::Build(spec);
  scene.Reset({.seed = rng.Fork("home").NextBits()});
  Setup setup{objects, scene, Robot::Of(scene, run_.robot.config.name),
              scene.compiled()->object(kTarget).root_body, request.stop};
  if (auto refusal = Prepare(setup, support, placement, rng)) {
    refusal->redrawn = setup.redrawn;
    refusal->object_kind = kinds[0];
    return {.start = {}, .refusal = *refusal};
  }
  return {.start = EpisodeStart{.scene = scene,
                                .task = MakeTask(kTarget, kinds[0], names),
                                .target_object = kTarget,
                                .object_kinds = kinds,
                                .base_in_world = setup.robot.base().pose(),
                                .redrawn = setup.redrawn},
          .refusal = {}};
}

std::unique_ptr<TaskSampler> MakePickSampler(const RunConfig& run) {
  return std::make_unique<PickTaskSampler>(run);
}

}  // namespace robocell
