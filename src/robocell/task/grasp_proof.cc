#include "robocell/task/grasp_proof.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/move_group.h"
#include "robocell/scene/scene.h"
#include "robocell/task/grasped_body.h"

namespace robocell {
namespace {

constexpr double kFrozen = 1e5;      // kg m^2 of each arm joint: it hardly moves
constexpr double kCloseSpeed = 0.2;  // m/s between the fingers: faster ones pass through thin walls
constexpr double kTick = 0.01;       // s between commands
constexpr double kSqueezeSeconds = 0.3;

// The robot has the name of its configuration, whatever the object is called.
std::string ObjectName(const Robot& robot) {
  return robot.config().name == "object" ? "other_object" : "object";
}

SceneSpec HandAndObject(const Robot& robot, const SceneObject& object) {
  const Scene scene = robot.scene();
  SceneSpec spec{.name = "proof of grasps",
                 .timestep = scene.timestep(),
                 .gravity = {0, 0, 0},
                 .add_floor = false,
                 .add_skybox = false,
                 .options = scene.spec().options,
                 .source_dir = scene.spec().source_dir};
  RobotSpec own;
  own.name = robot.config().name;
  own.config = robot.config();
  own.control_modes = robot.config().used_modes();
  spec.robots.push_back(own);
  SceneObject alone = object;
  alone.name = ObjectName(robot);
  alone.attach_to = {};
  alone.parked = {};
  alone.pos = Vec3{10, 0, 0};
  spec.objects.push_back(alone);
  return spec;
}

const SceneObject& FreeObject(const Scene& scene, const std::string& body) {
  const internal::GraspedBody grasped = internal::FindGraspedBody(scene, body);
  std::vector<std::string> free;
  for (const ObjectRecord& record : scene.compiled()->objects()) {
    if (!record.free_joint) continue;
    free.push_back(record.name);
    if (record.root_body != grasped.name) continue;
    for (const SceneObject& object : scene.spec().objects)
      if (object.name == record.name) return object;
  }
  std::string names;
  for (const std::string& name : free) names += (names.empty() ? "" : ", ") + name;
  throw ArgumentError(
      fmt::format("proving grasps of '{}': only objects that move freely can be "
                  "shaken. Free objects of the scene: {}",
                  body, names.empty() ? "none" : names));
}

class Shaker {
 public:
  Shaker(const Robot& robot, const SceneObject& object, const ShakeOptions& options)
      : options_(options),
        scene_(Scene::Build(HandAndObject(robot, object))),
        robot_(Robot::Of(scene_, robot.config().name)),
        body_(scene_.compiled()->object(ObjectName(robot)).root_body),
        shape_(GripperShape::Of(robot.config(), scene_.spec().options, scene_.timestep())) {
    mjModel* m = scene_.mutable_model();
    const std::string place = "robot '" + robot.name() + "'";
    for (const std::string& joint : robot_.joint_names()) {
      const int dof = m->jnt_dofadr[RequireId(m, mjOBJ_JOINT, joint, place)];
      m->dof_armature[dof] = m->dof_damping[dof] = kFrozen;
    }
  }

  GraspProof Prove(const Grasp& grasp) {
    if (!Start(grasp)) return Failed("the simulation diverged");
    GripperGroup& gripper = robot_.gripper();
    double opening = OpeningOf(grasp.opening);
    const double range = std::max(shape_->open_gap() - shape_->closed_gap(), 1e-3);
    while (opening > 0) {
      opening = shape_->is_suction() ? 0 : std::max(0.0, opening - kCloseSpeed * kTick / range);
      gripper.SetOpening(opening);
      if (!Run(kTick)) return Failed("the simulation diverged");
    }
    if (!Run(kSqueezeSeconds)) return Failed("the simulation diverged");
    if (!gripper.is_grasping(body_)) return Failed("the hand closed on nothing");
    const Pose held = InHand();
    GraspProof proof;
    for (int side = 0; side < 6; ++side) {
      mjtNum* gravity = scene_.mutable_model()->opt.gravity;
      std::fill_n(gravity, 3, 0);
      gravity[side / 2] = side % 2 == 0 ? options_.acceleration : -options_.acceleration;
      if (!Run(options_.seconds)) return Failed("the simulation diverged");
      const Pose now = InHand();
      proof.slip = std::max(proof.slip, (now.translation() - held.translation()).norm());
      proof.turn = std::max(proof.turn, AngleBetween(now.quaternion(), held.quaternion()));
    }
    if (proof.slip > options_.most_slip)
      proof.failure = fmt::format("the object slipped by {:.2g} m", proof.slip);
    else if (proof.turn > options_.most_turn)
      proof.failure = fmt::format("the object turned by {:.2g} rad", proof.turn);
    else if (!gripper.is_grasping(body_))
      proof.failure = "the object slipped";
    proof.held = proof.failure.empty();
    return proof;
  }

 private:
  static GraspProof Failed(const std::string& why) { return {.held = false, .failure = why}; }

  double OpeningOf(double gap) const {
    const double range = shape_->open_gap() - shape_->closed_gap();
    return shape_->is_suction() || range <= 0
               ? 1
               : std::clamp((gap - shape_->closed_gap()) / range, 0.0, 1.0);
  }

  // Puts the object between the open fingers.
  bool Start(const Grasp& grasp) {
    mjModel* m = scene_.mutable_model();
    std::fill_n(m->opt.gravity, 3, 0);
    scene_.Reset();
    std::vector<double> joints(shape_->joint_names().size());
    shape_->JointsAt(grasp.opening, joints);
    for (size_t i = 0; i < joints.size(); ++i) {
      const int joint = FindId(m, mjOBJ_JOINT, robot_.prefix() + shape_->joint_names()[i]);
      scene_.data()->qpos[m->jnt_qposadr[joint]] = joints[i];
    }
    scene_.Forward();
    robot_.gripper().SetOpening(OpeningOf(grasp.opening));
    scene_.SetBodyPose(body_, robot_.tcp_in_world() * grasp.tcp_in_body.inverse());
    return Run(kTick);
  }

  bool Run(double seconds) {
    const int steps = std::max(1, static_cast<int>(std::lround(seconds / scene_.timestep())));
    const bool ok = scene_.StepN(steps).ok();
    scene_.SyncPoses();
    return ok;
  }

  Pose InHand() const { return robot_.tcp_in_world().inverse() * scene_.body_pose(body_); }

  ShakeOptions options_;
  Scene scene_;
  Robot robot_;
  std::string body_;
  std::shared_ptr<const GripperShape> shape_;
};

void RequireShakeOptions(const ShakeOptions& options, const std::string& body) {
  const auto require = [&](bool ok, const char* field, const char* rule) {
    if (!ok)
      throw ArgumentError(fmt::format("proving grasps of '{}': {} must be {}", body, field, rule));
  };
  require(options.acceleration >= 0 && options.acceleration <= 1000, "acceleration",
          "from 0 to 1000 m/s^2");
  require(options.seconds > 0 && options.seconds <= 60, "seconds", "above 0 and at most 60");
  require(options.most_slip >= 0, "most_slip", "at least 0");
  require(options.most_turn >= 0, "most_turn", "at least 0");
}

}  // namespace

std::vector<GraspProof> ProveGrasps(const Robot& robot, const GraspSet& grasps,
                                    const ShakeOptions& options) {
  RequireShakeOptions(options, grasps.body);
  for (const Grasp& grasp : grasps.grasps) {
    if (grasp.kind != GraspKind::kPush && grasp.kind != GraspKind::kHook) continue;
    throw ArgumentError(
        fmt::format("proving grasps of '{}': a grasp of kind '{}' does not hold "
                    "anything; leave these out",
                    grasps.body, ToString(grasp.kind)));
  }
  Shaker shaker(robot, FreeObject(robot.scene(), grasps.body), options);
  std::vector<GraspProof> proofs;
  for (const Grasp& grasp : grasps.grasps) proofs.push_back(shaker.Prove(grasp));
  return proofs;
}

GraspSet KeepProven(const GraspSet& grasps, const std::vector<GraspProof>& proofs) {
  GraspSet kept{.robot = grasps.robot, .body = grasps.body, .grasps = {}};
  for (size_t i = 0; i < std::min(proofs.size(), grasps.grasps.size()); ++i)
    if (proofs[i].held) kept.grasps.push_back(grasps.grasps[i]);
  return kept;
}

}  // namespace robocell
