#include "robocell/task/start_sampler.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"
#include "robocell/motion/clearance.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/planar_motion.h"
#include "robocell/scene/scene_cache.h"
#include "robocell/scenes/free_floor.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/scenes/object_places.h"
#include "robocell/scenes/object_view.h"
#include "robocell/scenes/randomization.h"
#include "robocell/scenes/related_places.h"
#include "robocell/scenes/relations.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/scenes/settle.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/base_stances.h"
#include "robocell/task/door_swings.h"
#include "robocell/task/relation_task.h"
#include "robocell/task/run_arms.h"
#include "robocell/task/start_cameras.h"
#include "robocell/task/task_calls.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

// Tries of objects and base around each other. Where none of a few fits, hardly one of many does:
// the next attempt moves on from there.
constexpr int kArrangements = 8;
constexpr int kSupportDraws = 8;          // until one has room for the objects
constexpr int kPlaceTries = 60;           // for objects, until a base pose is free
constexpr int kSupportTries = 6;          // of these on one support, where the scene has several
constexpr double kMoved = 1e-6;           // metres, of a target that a task moves
constexpr double kSamePlace = 1e-9;       // rad and m, rounding of a pose
const Eigen::Vector3d kParked(20, 0, 1);  // where the robot waits while the objects settle

// Returns the position of an episode's base placement in a sequence that is even over any stretch,
// and over the first episodes of any number of scenes: the factor is prime.
uint64_t PlacementTurn(const SampleRequest& request) {
  return static_cast<uint64_t>(request.scene) * 7919 + static_cast<uint64_t>(request.episode);
}

// `floor`: its height, on which a planar base stays.
void AddParkedRobot(SceneSpec& spec, const RobotConfig& robot, double floor) {
  Eigen::Vector3d at = kParked;
  if (robot.base.kind == BaseKind::kPlanar) at.z() = floor;
  spec.robots.push_back({.name = robot.name,
                         .config = robot,
                         .prefix = "robot_0/",
                         .pos = ToVec3(at),
                         .control_modes = robot.used_modes()});
}

// Returns the first object of the task, or of its contents; "" without any. Its kind becomes the
// first of `kinds`, those of the contents.
std::string TargetOf(Task& task, const StartContents& contents, std::vector<std::string>& kinds) {
  internal::TaskCalls calls(task);
  const std::vector<std::string> observed = calls.Objects();
  if (observed.empty()) return contents.objects.empty() ? "" : contents.objects[0].name;
  const std::string& target = observed.front();
  for (size_t i = 0; i < contents.objects.size(); ++i) {
    if (contents.objects[i].name != target) continue;
    const auto own = kinds.begin() + static_cast<std::ptrdiff_t>(i);
    std::rotate(kinds.begin(), own, own + 1);
    return target;
  }
  kinds.insert(kinds.begin(), calls.KindOf(target));
  return target;
}

constexpr double kStorey = 2;  // metres; a floor farther below or above is another one

// `most_above`: metres between the place and the floor.
bool IsOnFloor(const Eigen::Vector3d& at, const std::vector<FloorArea>& floor, double most_above) {
  return std::ranges::any_of(floor, [&](const FloorArea& area) {
    const Eigen::Vector3d on = area.frame_to_world.inverse() * at;
    return std::abs(on.x()) <= area.half_x && std::abs(on.y()) <= area.half_y &&
           std::abs(on.z()) <= most_above;
  });
}

// Returns the doors that a task leaves as they are. A robot stands in the swing of one that it moves:
// the task looks for its stance.
std::vector<Articulation> DoorsLeftAlone(const std::vector<Articulation>& doors, const Task* task,
                                         const Scene& scene) {
  const auto* relations = dynamic_cast<const RelationTask*>(task);
  if (doors.empty() || !relations) return doors;
  std::set<std::string> moved;
  for (const RelationTask::Goal& goal : relations->goals()) {
    if (FindRelation(goal.stated.relation).subject == RelationSubject::kJoint)
      moved.insert(JointOpening::Of(scene, goal.stated.subject).joint());
  }
  std::vector<Articulation> others = doors;
  std::erase_if(others, [&](const Articulation& door) { return moved.contains(door.joint); });
  return others;
}

// The root of a base on wheels may lie anywhere above the floor.
void PutOnFloor(const Robot& robot, double floor) {
  const internal::PlanarMotion* motion = internal::PlanarMotion::Of(robot.base());
  if (!motion || motion->drives_sideways()) return;
  Pose base = robot.base().pose();
  const Eigen::Vector3d at(base.translation().x(), base.translation().y(), floor);
  internal::PutBase(robot, Pose(at, base.quaternion()));
}

bool IsPlanar(const Robot& robot) { return robot.config().base.kind == BaseKind::kPlanar; }

// Returns the world poses of the objects that keep theirs.
std::vector<std::optional<Pose>> OwnPosesOf(const std::vector<SceneObject>& objects,
                                            const Scene& scene) {
  std::vector<std::optional<Pose>> poses;
  for (const SceneObject& object : objects) {
    poses.emplace_back();
    if (internal::KeepsPose(object))
      poses.back() = scene.body_pose(scene.compiled()->object(object.name).root_body);
  }
  return poses;
}

}  // namespace

SceneSpec StartSampler::MakeBaseScene(int scene_index) {
  return robocell::MakeBaseScene(run_, RequireSource(), scene_index);
}

StartSampler::StartSampler(RunConfig run)
    : run_(std::move(run)),
      kind_(FindTaskKind(run_.task.kind())),
      source_(MakeSceneSource(run_)),
      sizes_(std::make_unique<ObjectSizes>()) {
  kind_->Make(run_.task);  // its errors come before the first start
}
StartSampler::~StartSampler() = default;

SceneSource& StartSampler::RequireSource() const {
  if (source_) return *source_;
  throw Error("run '" + run_.run + "': its source of scenes is gone");
}

std::shared_ptr<Task> StartSampler::MakeTask() {
  return internal::CallHook(Hooks(), "the task's constructor",
                            [&] { return kind_->Make(run_.task); });
}

// While no start is under construction, a task is made to answer for its fields.
BaseRange StartSampler::base_range() {
  const std::shared_ptr<Task> task = task_ ? task_ : MakeTask();
  return BaseRangeOf(run_.start, SoundBaseRange(*task));
}

StartContents StartSampler::AddContents(const SampleRequest& request, SceneSpec& spec, Rng& rng) {
  task_ = MakeTask();
  const Task::KnownScene known = [&] { return AnnotationsOf(request.scene); };
  const std::string& kind = run_.task.kind();
  StartContents contents =
      PrepareContents(*task_,
                      {.known = known,
                       .kind = kind,
                       .turn = {static_cast<uint64_t>(run_.seed), request.scene, request.episode}},
                      spec, rng);
  RequireSound(contents, *task_, kind, *sizes_);
  return contents;
}

// Many scenes of a run may share a base, and a subclass may make a different one every time, or a
// different file of the same name.
Support StartSampler::FindSupportOf(const SceneSpec& base, int scene_index, Rng& rng) {
  if (const auto known = RequireSource().CheckedAnnotations(scene_index);
      known && !known->supports.empty())
    return known->supports[rng.UniformInt(known->supports.size())].face;
  const std::string key = SceneKey(base);
  const auto it = supports_.find(key);
  if (it != supports_.end()) return it->second;
  if (supports_.size() >= kMostScenes) supports_.clear();
  return supports_[key] = FindSupport(base);
}

BasePlacement StartSampler::ChooseBasePlacement(const SampleRequest& request, Rng& rng) {
  return SpreadBasePlacement(base_range(), static_cast<uint64_t>(run_.seed), PlacementTurn(request),
                             request.attempt, rng);
}

bool StartSampler::PlaceObjects(const Support& support, std::vector<SceneObject>& objects,
                                Rng& rng) {
  std::vector<ObjectSize> own_sizes;
  for (const SceneObject& object : objects) own_sizes.push_back(sizes_->Of(object));
  return internal::PlaceOn(support, own_sizes, objects, rng,
                           internal::FindOver(support, still_boxes_));
}

std::shared_ptr<const SceneAnnotations> StartSampler::AnnotationsOf(int scene_index) {
  if (auto known = RequireSource().CheckedAnnotations(scene_index))
    return std::make_shared<const SceneAnnotations>(*std::move(known));
  const SceneSpec base = MakeBaseScene(scene_index);
  const std::string key = SceneKey(base);
  if (const auto it = annotations_.find(key); it != annotations_.end()) return it->second;
  if (annotations_.size() >= kMostScenes) annotations_.clear();
  return annotations_[key] = std::make_shared<const SceneAnnotations>(DeriveAnnotations(base));
}

std::shared_ptr<internal::StartCameras> StartSampler::CamerasOf(const SceneSpec& base) {
  if (run_.start.cameras.empty()) return nullptr;
  const std::string key = SceneKey(base);
  if (const auto it = cameras_.find(key); it != cameras_.end()) return it->second;
  if (cameras_.size() >= kMostScenes) cameras_.clear();
  if (!images_) images_ = std::make_shared<BodyImages>();
  SceneSpec spec = base;
  AddParkedRobot(spec, run_.robot.config, 0);
  const Scene probe = Scene::Build(spec);
  return cameras_[key] = std::make_shared<internal::StartCameras>(
             run_, probe, Robot::Of(probe, run_.robot.config.name), images_);
}

std::optional<Refusal> StartSampler::PutObjects(
    const Support& support, const std::optional<internal::RelatedPlaces>& related,
    std::vector<SceneObject>& objects, Rng& rng) {
  const Refusal no_room =
      Refusal{Refusal::kNoFreePlace,
              "the objects do not fit beside each other and what stands on their support or hangs "
              "low above it"}
          .MadeBy(Refusal::kObjectsStage);
  if (!related) {
    if (PlaceObjects(support, objects, rng)) return std::nullopt;
    return no_room;
  }
  std::vector<SceneObject> loose;
  for (size_t i = 0; i < objects.size(); ++i) {
    if (!related->IsRelated(i)) loose.push_back(objects[i]);
  }
  if (!PlaceObjects(support, loose, rng)) return no_room;
  std::vector<ObjectSize> own_sizes;
  for (size_t i = 0, next = 0; i < objects.size(); ++i) {
    own_sizes.push_back(sizes_->Of(objects[i]));
    if (!related->IsRelated(i)) objects[i] = loose[next++];
  }
  if (const auto why_not = related->Put(support, own_sizes, objects, rng))
    return Refusal{Refusal::kNoFreePlace, *why_not}.MadeBy(Refusal::kObjectsStage);
  return std::nullopt;
}

std::optional<Pose> StartSampler::ProposeBasePose(const Robot& robot, const Support& support,
                                                  const Pose& target,
                                                  const BasePlacement& placement, Rng& rng) {
  std::vector<Pose> bases =
      internal::BasesAround(robot, support, target, placement, run_.start, rng);
  const double most_above = IsPlanar(robot) ? internal::kMostFloorStep : kStorey;
  std::erase_if(bases, [&](const Pose& base) {
    const Eigen::Vector3d& at = base.translation();
    const bool is_near_rejected = std::ranges::any_of(rejected_bases_, [&](const auto& rejected) {
      return (at.head<2>() - rejected).norm() < run_.start.base_separation;
    });
    return is_near_rejected || (!free_floor_.empty() && !IsOnFloor(at, free_floor_, most_above));
  });
  if (bases.empty()) return std::nullopt;
  robot.scene().SyncPoses();
  internal::BaseStances stances(robot, run_.start.base_clearance,
                                DoorsLeftAlone(doors_, task_.get(), robot.scene()));
  const std::vector<bool> free = stances.AreFree(bases);
  std::vector<Pose> stances_left;
  for (size_t i = 0; i < bases.size(); ++i)
    if (free[i]) stances_left.push_back(bases[i]);
  if (stances_left.empty()) return std::nullopt;
  return stances_left[rng.UniformInt(stances_left.size())];
}

std::optional<Refusal> StartSampler::ValidateBasePose(Scene& scene, Robot& robot,
                                                      const std::string& target_body) {
  const int body = FindId(scene.model(), mjOBJ_BODY, target_body);
  const bool is_fixed = body > 0 && scene.model()->body_weldid[body] == 0;
  std::vector<Robot> arms;
  if (robot.name() == run_.robot.config.name) {
    for (const std::string& arm : internal::ArmsOfRun(run_, scene))
      arms.push_back(Robot::Of(scene, arm));
  }
  if (arms.size() < 2) arms = {robot};
  std::optional<Refusal> too_far;
  for (const Robot& acting : arms) {  // one arm is enough
    auto refusal = is_fixed ? ValidateBaseReachOfPart(acting, target_body)
                            : ValidateBaseReach(acting, scene.body_pose(target_body));
    const bool is_near = !refusal;
    if (!too_far || is_near) too_far = std::move(refusal);
    if (is_near) break;
  }
  if (too_far) return too_far;
  if (auto refusal = ValidateBaseClearance(scene, robot, run_.start.base_clearance)) return refusal;
  return internal::ValidateDoorSwings(scene, robot, DoorsLeftAlone(doors_, task_.get(), scene),
                                      run_.start.base_clearance);
}

std::optional<Refusal> StartSampler::ValidateCameras(Scene& scene, const std::string& target_body) {
  return ValidateVisibility(scene, target_body, run_);
}

struct StartSampler::Setup {
  std::shared_ptr<Task> task;
  std::vector<SceneObject> contents;           // objects as they were added
  std::vector<std::optional<Pose>> own_poses;  // world poses of those that keep theirs
  std::vector<SceneObject> objects;            // objects at their placements
  std::optional<internal::RelatedPlaces> related;
  Scene scene;
  Robot robot;
  std::string target;  // first of the task's objects; "" for a task without any
  std::string target_body;
  Support support;  // that of this arrangement
  StopRequest stop;
  std::shared_ptr<internal::StartCameras> cameras;  // null without `start.cameras`
  RefusalCounts redrawn = {};
  int arrangements = 0;
  SceneSpec base_scene = {};  // without the task's objects
  int scene_index = 0;

  // Resolves names that the task gives to objects.
  std::string ObjectOf(const std::string& name) const {
    const std::vector<std::string> named = internal::TaskCalls(*task).Objects();
    if (std::ranges::find(named, name) == named.end()) return name;
    return internal::TaskCalls(*task).ObjectOf(name);
  }
  internal::StartCameras::ObjectOf object_of() const {
    return [this](const std::string& name) { return ObjectOf(name); };
  }

  // Returns true if a body is an object with a relative placement.
  bool IsRelated(const std::string& body) const {
    for (size_t i = 0; related && i < contents.size(); ++i) {
      if (related->IsRelated(i) && scene.compiled()->object(contents[i].name).root_body == body)
        return true;
    }
    return false;
  }
  // Returns true if an object lies where the sampler drew its place.
  bool IsWhereDrawn(size_t i) const {
    if (own_poses[i]) return false;
    const std::string& body = scene.compiled()->object(objects[i].name).root_body;
    return scene.body_pose(body).is_close(objects[i].pose(), kSamePlace, kSamePlace);
  }
  // Returns where the target lies before the task moves it: in its place that was drawn, its own, or
  // that of the scene.
  Pose PlacedTarget() const {
    for (size_t i = 0; i < objects.size(); ++i) {
      if (objects[i].name == target) return own_poses[i].value_or(objects[i].pose());
    }
    return Target();
  }
  // Returns the pose beside which the robot stands.
  Pose Target() const {
    return target_body.empty() ? support.frame_to_world : scene.body_pose(target_body);
  }
};

// Finds what stands in the scene beside the start's objects and the robot.
void StartSampler::FindStillBoxes(const Setup& setup) {
  const mjModel* m = setup.scene.model();
  const mjData* d = setup.scene.data();
  std::vector<std::string> own;
  for (const SceneObject& object : setup.contents)
    own.push_back(setup.scene.compiled()->object(object.name).root_body);
  const std::vector<bool> ignored = internal::MovedBodies(setup.scene, own);
  still_boxes_.clear();
  for (int g = 0; g < m->ngeom; ++g) {
    if (m->geom_type[g] == mjGEOM_PLANE || !internal::IsCollisionGeom(m, g) ||
        ignored[static_cast<size_t>(m->geom_bodyid[g])])
      continue;
    still_boxes_.push_back(internal::StillBoxOf(m, d, g));
  }
}

// Returns the height of the lowest free floor of a scene: above it, roofs and landings may be free too.
double StartSampler::FloorHeight(int scene_index) {
  if (run_.robot.config.base.kind != BaseKind::kPlanar) return 0;
  const std::shared_ptr<const SceneAnnotations> known = AnnotationsOf(scene_index);
  double lowest = std::numeric_limits<double>::infinity();
  for (const FloorArea& area : known->free_floor)
    lowest = std::min(lowest, area.frame_to_world.translation().z());
  return std::isfinite(lowest) ? lowest : 0;
}

std::optional<Refusal> StartSampler::ArrangeOnce(Setup& setup, const BasePlacement& placement,
                                                 Rng& rng) {
  const auto put = [&](const BodyPoses& moved) {
    for (size_t i = 0; i < setup.objects.size(); ++i) {
      const ObjectRecord& record = setup.scene.compiled()->object(setup.objects[i].name);
      if (setup.own_poses[i] && !record.free_joint) continue;
      setup.scene.SetBodyPose(record.root_body,
                              setup.own_poses[i].value_or(setup.objects[i].pose()));
    }
    internal::TaskCalls(*setup.task).Put(setup.scene, moved);
  };
  std::optional<Pose> base;
  BodyPoses moved;
  Pose target;
  std::optional<Refusal> no_room;
  for (int t = 0; t < kPlaceTries && !base && !(t > 0 && ShouldStop(setup.stop)); ++t) {
    // What one support has no room for, for objects or for a robot beside it, may fit on another.
    if (t > 0 && t % kSupportTries == 0)
      setup.support = FindSupportOf(setup.base_scene, setup.scene_index, rng);
    setup.objects = setup.contents;
    no_room = PutObjects(setup.support, setup.related, setup.objects, rng);
    if (no_room) {
      t += kSupportTries - 1 - t % kSupportTries;  // each try of theirs is many
      continue;
    }
    moved = internal::TaskCalls(*setup.task).Starts(rng);
    std::erase_if(moved, [&](const auto& body) { return setup.IsRelated(body.first); });
    target = setup.PlacedTarget();
    for (const auto& [body, pose] : moved) {
      if (body == setup.target_body) target = pose;
    }
    put(moved);
    base = ProposeBasePose(setup.robot, setup.support, target, placement, rng);
  }
  if (no_room) return no_room;
  if (!base) {
    return Refusal{Refusal::kBaseInCollision,
                   fmt::format("{:.2f} m from the target and {:.2f} m above it the robot overlaps "
                               "the support or something else{} wherever the target lies",
                               placement.distance, placement.height,
                               free_floor_.empty() ? "" : ", or is beside the free floor,")}
        .MadeBy(Refusal::kBaseStage);
  }
  internal::PutBase(setup.robot, *base);
  setup.scene.Forward();
  if (auto refusal = internal::TaskCalls(*setup.task).Arrange(setup.scene, rng))
    return std::move(*refusal).MadeBy(Refusal::kTaskStage);
  if (auto refusal = ValidateDistance(setup, target))
    return std::move(*refusal).MadeBy(Refusal::kBaseStage);
  if (auto refusal = ValidateWithoutRobot(setup))
    return std::move(*refusal).MadeBy(Refusal::kCamerasStage);
  auto refusal = ValidatePlaced(setup, rng.Fork("cameras").Fork(setup.arrangements++));
  // Mostly the base touches the scene, which stays, while the objects are placed anew.
  if (refusal && refusal->stage == Refusal::kBaseStage &&
      refusal->reason != Refusal::kNoReachableBasePose)
    rejected_bases_.emplace_back(base->translation().head<2>());
  return refusal;
}

// Checks what the robot cannot change before its base is checked, once the task has put its objects:
// a start in which something else hides the object costs little then.
std::optional<Refusal> StartSampler::ValidateWithoutRobot(Setup& setup) {
  if (!setup.cameras) return std::nullopt;
  const Pose base = setup.robot.base().pose();
  internal::PutBase(setup.robot, Pose(Eigen::Vector3d(kParked.x(), kParked.y(),
                                                      IsPlanar(setup.robot) ? base.translation().z()
                                                                            : kParked.z())));
  setup.scene.Forward();
  auto refusal = setup.cameras->CheckWithoutRobot(setup.scene, setup.robot, setup.object_of());
  internal::PutBase(setup.robot, base);
  setup.scene.Forward();
  return refusal;
}

// A task that moves its target again may take it out of the range that it required.
std::optional<Refusal> StartSampler::ValidateDistance(const Setup& setup,
                                                      const Pose& proposed_for) {
  const Pose target = setup.Target();
  if ((target.translation() - proposed_for.translation()).norm() < kMoved) return std::nullopt;
  return ValidateBaseDistance(setup.robot, target, base_range());
}

std::optional<Refusal> StartSampler::ValidateStartCameras(Setup& setup,
                                                          const std::optional<Rng>& camera_draws) {
  if (!setup.cameras) return std::nullopt;
  setup.scene.SyncPoses();
  return camera_draws
             ? setup.cameras->Place(setup.scene, setup.robot, setup.object_of(), *camera_draws)
             : setup.cameras->Check(setup.scene, setup.robot, setup.object_of());
}

// Checks the conditions that hold both before and after settling.
std::optional<Refusal> StartSampler::ValidatePlaced(Setup& setup,
                                                    const std::optional<Rng>& camera_draws) {
  const auto check_task = [&]() -> std::optional<Refusal> {
    if (auto refusal = internal::TaskCalls(*setup.task).CheckStart(setup.scene))
      return std::move(*refusal).MadeBy(Refusal::kTaskStage);
    return std::nullopt;
  };
  const auto check_cameras = [&]() -> std::optional<Refusal> {
    if (auto refusal = ValidateStartCameras(setup, camera_draws))
      return std::move(*refusal).MadeBy(Refusal::kCamerasStage);
    return std::nullopt;
  };
  if (setup.target_body.empty()) {
    auto refusal = ValidateBaseClearance(setup.scene, setup.robot, run_.start.base_clearance);
    if (!refusal)
      refusal = internal::ValidateDoorSwings(setup.scene, setup.robot,
                                             DoorsLeftAlone(doors_, setup.task.get(), setup.scene),
                                             run_.start.base_clearance);
    if (refusal) return std::move(*refusal).MadeBy(Refusal::kBaseStage);
    if (auto by_task = check_task()) return by_task;
    return check_cameras();
  }
  if (auto refusal = ValidateBasePose(setup.scene, setup.robot, setup.target_body))
    return std::move(*refusal).MadeBy(Refusal::kBaseStage);
  if (auto refusal = check_task()) return refusal;
  if (auto refusal = check_cameras()) return refusal;
  if (auto refusal = ValidateCameras(setup.scene, setup.target_body))
    return std::move(*refusal).MadeBy(Refusal::kCamerasStage);
  return std::nullopt;
}

// Draws places for the objects and the base until both fit, and counts the rejected ones. Nothing
// is stepped, so many tries are cheap.
std::optional<Refusal> StartSampler::Arrange(Setup& setup, const BasePlacement& placement,
                                             Rng& rng) {
  std::optional<Refusal> refusal = ArrangeOnce(setup, placement, rng);
  for (int t = 1; t < kArrangements && refusal && !ShouldStop(setup.stop); ++t) {
    if (refusal->holds_everywhere) break;
    ++setup.redrawn[refusal->counted_as()];
    setup.support = FindSupportOf(setup.base_scene, setup.scene_index, rng);
    refusal = ArrangeOnce(setup, placement, rng);
  }
  return refusal;
}

// Returns the objects that have to come to rest: those that the task names, and all others but
// those that the task itself put somewhere, with a pose, in Starts or in Arrange.
std::vector<std::string> StartSampler::RestingObjects(const Setup& setup) {
  std::set<std::string> put_by_task;
  for (size_t i = 0; i < setup.objects.size(); ++i) {
    if (!setup.IsWhereDrawn(i)) put_by_task.insert(setup.objects[i].name);
  }
  for (const std::string& name : internal::TaskCalls(*setup.task).RestingObjects(setup.scene))
    put_by_task.erase(name);
  std::vector<std::string> resting = setup.scene.object_names();
  std::erase_if(resting, [&](const std::string& name) { return put_by_task.contains(name); });
  return resting;
}

// Turns the built scene into the start state.
std::optional<Refusal> StartSampler::PrepareStart(Setup& setup, const BasePlacement& placement,
                                                  Rng& rng) {
  if (auto refusal = Arrange(setup, placement, rng)) return refusal;
  const std::vector<std::string> resting = RestingObjects(setup);
  const bool target_rests = std::ranges::find(resting, setup.target) != resting.end();
  const std::string unsettled = internal::Settle(
      setup.scene, {&setup.robot, 1}, target_rests ? setup.target_body : "",
      {.sim_steps = run_.rates.sim_steps(), .resting = resting, .stop = setup.stop});
  if (!unsettled.empty())
    return Refusal{Refusal::kUnsettled, unsettled}.MadeBy(Refusal::kSettlingStage);
  if (setup.related) {
    if (const auto why_not = setup.related->WhyNotKept(setup.scene, setup.objects))
      return Refusal{Refusal::kUnsettled, *why_not}.MadeBy(Refusal::kSettlingStage);
  }
  if (auto refusal = ValidatePlaced(setup, std::nullopt)) return refusal;
  if (auto refusal = BeginElsewhere(setup, rng)) return refusal;
  setup.scene.data()->time = 0;
  setup.scene.Forward();
  return std::nullopt;
}

// Lets a robot begin away from its work. What cameras have to see, they see from there.
std::optional<Refusal> StartSampler::BeginElsewhere(Setup& setup, Rng& rng) {
  const Pose before = setup.robot.base().pose();
  if (auto refusal = MoveBase(setup.robot, setup.scene_index, rng))
    return std::move(*refusal).MadeBy(Refusal::kBaseStage);
  if (setup.robot.base().pose() == before) return std::nullopt;
  setup.scene.Forward();
  auto refusal = ValidateStartCameras(setup, rng.Fork("cameras").Fork(setup.arrangements++));
  if (!refusal && !setup.target_body.empty())
    refusal = ValidateCameras(setup.scene, setup.target_body);
  if (refusal) return std::move(*refusal).MadeBy(Refusal::kCamerasStage);
  return std::nullopt;
}

RandomizedValues StartSampler::AddClutter(const SampleRequest& request, StartContents& contents,
                                          const Rng& rng) const {
  if (!run_.randomize || !run_.randomize->clutter) return {};
  const bool is_of_scene = run_.randomize->every == RandomizeEvery::kScene;
  internal::Clutter clutter = internal::DrawClutter(
      *run_.randomize, contents.kinds,
      is_of_scene ? Rng::Stream(static_cast<uint64_t>(run_.seed), "clutter", request.scene)
                  : rng.Fork("clutter"));
  AppendTo(contents, {.objects = std::move(clutter.objects), .kinds = std::move(clutter.kinds)});
  return std::move(clutter.values);
}

SampleResult StartSampler::Sample(const SampleRequest& request, Rng& rng) {
  // A hook that raises ends the start too.
  const std::shared_ptr<void> forget(nullptr, [this](void*) { task_.reset(); });
  sizes_ = std::make_unique<ObjectSizes>();
  SceneSpec spec = MakeBaseScene(request.scene);
  const SceneSpec base_scene = spec;
  still_boxes_.clear();
  const std::optional<SceneAnnotations> known = RequireSource().CheckedAnnotations(request.scene);
  free_floor_ = known ? known->free_floor : std::vector<FloorArea>();
  rejected_bases_.clear();
  const std::shared_ptr<internal::StartCameras> cameras = CamerasOf(spec);
  const size_t own = spec.objects.size();
  StartContents contents = AddContents(request, spec, rng);
  const StartContents placed = TakePlaced(spec, own);
  const size_t before = own - placed.objects.size();
  AppendTo(contents, placed);
  std::vector<std::string> kinds = contents.kinds;
  const std::string first = kinds.empty() ? "" : kinds.front();
  RandomizedValues clutter = AddClutter(request, contents, rng);
  const BasePlacement placement = ChooseBasePlacement(request, rng);
  RequireFinite(placement);
  const std::optional<internal::RelatedPlaces> related =
      RelationsOf(spec, before, request.scene, contents);
  std::vector<SceneObject> objects;
  Support support;
  std::optional<Refusal> no_room;
  Rng support_rng = rng.Fork("support");
  for (int draw = 0; draw < kSupportDraws && (draw == 0 || no_room); ++draw) {
    support = FindSupportOf(base_scene, request.scene, support_rng);
    objects = contents.objects;
    no_room = PutObjects(support, related, objects, rng);
  }
  if (no_room) {
    no_room->object_kind = first;
    return {.start = {}, .refusal = *std::move(no_room)};
  }
  ReplaceObjects(spec, before, objects);
  AddParkedRobot(spec, run_.robot.config, FloorHeight(request.scene));
  if (cameras) cameras->AddTo(spec);
  Scene scene = BuildPrepared(spec, before, *task_, request.scene_data);
  scene.Reset({.seed = rng.Fork("home").NextBits()});
  const std::shared_ptr<Task> task = task_;
  internal::TaskCalls(*task).Bind(scene, {.place = "run '" + run_.run + "'",
                                          .robots = internal::ArmsOfRun(run_, scene),
                                          .is_run = true});
  internal::TaskCalls(*task).RequireObjects(scene, contents.objects);
  const std::string target = TargetOf(*task, contents, kinds);
  Setup setup{task,
              contents.objects,
              OwnPosesOf(contents.objects, scene),
              std::move(objects),
              related,
              scene,
              Robot::Of(scene, internal::FirstArmOfRun(run_)),
              target,
              target.empty() ? "" : scene.compiled()->object(target).root_body,
              support,
              request.stop,
              cameras};
  setup.base_scene = base_scene;
  setup.scene_index = request.scene;
  if (IsPlanar(setup.robot)) PutOnFloor(setup.robot, FloorHeight(request.scene));
  scene.SyncPoses();
  FindStillBoxes(setup);
  doors_ = known && !run_.start.base_blocks_doors ? internal::DoorsOf(*known, scene)
                                                  : std::vector<Articulation>();
  if (cameras) cameras->RequireNames(scene, setup.robot, setup.object_of());
  if (auto refusal = PrepareStart(setup, placement, rng)) {
    refusal->redrawn = setup.redrawn;
    refusal->object_kind = kinds.empty() ? "" : kinds.front();
    return {.start = {}, .refusal = *refusal};
  }
  return {.start = EpisodeStart{.scene = scene,
                                .task = task,
                                .target_object = target,
                                .object_kinds = kinds,
                                .base_in_world = setup.robot.base().pose(),
                                .redrawn = setup.redrawn,
                                .is_bound = true,
                                .randomized = std::move(clutter)},
          .refusal = {}};
}

}  // namespace robocell
