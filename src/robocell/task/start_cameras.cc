#include "robocell/task/start_cameras.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <Eigen/Core>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/render/camera_model.h"
#include "robocell/render/stream_camera.h"
#include "robocell/scene/place_camera.h"
#include "robocell/scenes/visibility.h"
#include "robocell/spec/camera_spec.h"
#include "robocell/spec/start_camera.h"
#include "robocell/spec/types.h"
#include "robocell/task/base_placement.h"

namespace robocell::internal {
namespace {

constexpr const char* kGripper = "gripper";
constexpr const char* kRobot = "robot";

std::string FieldOf(const std::string& camera, const char* field) {
  return fmt::format("camera '{}', {}", camera, field);
}

// Returns the id of an element of the robot or, if it has none of this name, of the scene; -1
// without one.
int FindOf(const Scene& scene, const Robot& robot, mjtObj kind, const std::string& name) {
  const int id = FindId(scene.model(), kind, robot.prefix() + name);
  return id >= 0 ? id : FindId(scene.model(), kind, name);
}

// Returns the body that carries the TCP; -1 for a robot without an arm.
int BodyOfTcp(const Scene& scene, const Robot& robot) {
  const mjModel* m = scene.model();
  if (!robot.has_arm()) return -1;
  if (const int site = FindId(m, mjOBJ_SITE, robot.tcp_site()); site >= 0)
    return m->site_bodyid[site];
  const ChainTip& tip = robot.chain().tip();
  const int site = FindId(m, mjOBJ_SITE, tip.name);
  return site >= 0 ? m->site_bodyid[site] : FindId(m, mjOBJ_BODY, tip.name);
}

std::string Resolved(const StartCameras::ObjectOf& object_of, const std::string& name) {
  return object_of ? object_of(name) : name;
}

// Returns the middle of the box around some bodies, or the place of the first if none has a geom.
Eigen::Vector3d MiddleOf(const std::vector<bool>& bodies, const Scene& scene) {
  if (const std::optional<WorldBox> box = BoxOf(scene, bodies)) return 0.5 * (box->low + box->high);
  const auto first = std::ranges::find(bodies, true) - bodies.begin();
  return Eigen::Vector3d(scene.data()->xpos + 3 * first);
}

// Returns the middle of what a camera looks at.
Eigen::Vector3d MiddleOf(const NameList& names, const Scene& scene, const Robot& robot,
                         const StartCameras::ObjectOf& object_of, const std::string& place) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::string& name : names) {
    if (name == kGripper && robot.has_arm()) {
      sum += robot.tcp_in_world().translation();
      continue;
    }
    sum += MiddleOf(BodiesNamed(scene, robot, Resolved(object_of, name), place), scene);
  }
  return sum / static_cast<double>(names.size());
}

// Returns a random rotation vector of at most this angle.
Eigen::Vector3d RandomRotation(double degrees, Rng& rng) {
  Eigen::Vector3d axis(rng.Normal(), rng.Normal(), rng.Normal());
  if (axis.norm() < 1e-9) axis = Eigen::Vector3d::UnitX();
  return axis.normalized() * Radians(degrees) * rng.Uniform();
}

Eigen::Vector3d RandomOffset(const Vec3& most, Rng& rng) {
  Eigen::Vector3d offset;
  for (int i = 0; i < 3; ++i) offset[i] = rng.Uniform(-most[i], most[i]);
  return offset;
}

// Returns the vertical field of view of a camera of the models, degrees.
double LensOf(const mjModel* m, int id, const std::string& place) {
  if (m->cam_projection[id] == mjPROJ_ORTHOGRAPHIC)
    throw ArgumentError(place + ": the camera is orthographic, which is not taken over");
  const float* size = m->cam_sensorsize + 2 * id;
  if (!(size[1] > 0)) return m->cam_fovy[id];
  const float* lens = m->cam_intrinsic + 4 * id;
  const bool is_plain =
      std::abs(lens[0] - lens[1]) <= 1e-6F * lens[1] && lens[2] == 0 && lens[3] == 0;
  if (!is_plain) {
    throw ArgumentError(place +
                        ": the camera's lens has two focal lengths or a principal point beside "
                        "its centre, which is not taken over; give `fovy`");
  }
  return Degrees(2 * std::atan(0.5 * size[1] / lens[1]));
}

// True for what moves with the robot, or is the robot.
bool IsOfRobot(const Robot& robot, const std::string& name) {
  return name == kGripper || name == kRobot || name.starts_with(robot.prefix());
}

}  // namespace

std::vector<bool> BodiesNamed(const Scene& scene, const Robot& robot, const std::string& name,
                              const std::string& place) {
  const mjModel* m = scene.model();
  if (name == kGripper) {
    if (const int body = BodyOfTcp(scene, robot); body >= 0) return SubtreeMask(m, body);
    throw NotFoundError(
        fmt::format("{}: robot '{}' has no arm that carries a gripper; name one of "
                    "its bodies instead",
                    place, robot.name()));
  }
  if (name == kRobot) {
    if (robot.geom_ids().empty()) {
      throw NotFoundError(fmt::format(
          "{}: robot '{}' has no geoms that a camera could see; name an object or a body instead",
          place, robot.name()));
    }
    std::vector<bool> bodies(static_cast<size_t>(m->nbody));
    for (const int geom : robot.geom_ids()) bodies[m->geom_bodyid[geom]] = true;
    return bodies;
  }
  return BodiesOf(scene, name, place);
}

StartCameras::StartCameras(const RunConfig& run, const Scene& scene, const Robot& robot,
                           std::shared_ptr<BodyImages> images)
    : images_(std::move(images)) {
  for (const auto& [name, camera] : run.start.cameras.entries())
    mounted_.push_back(Mount(run, name, *camera, scene, robot));
}

StartCameras::Mounted StartCameras::Mount(const RunConfig& run, const std::string& name,
                                          const StartCamera& camera, const Scene& scene,
                                          const Robot& robot) const {
  const mjModel* m = scene.model();
  Mounted mounted{.name = name, .camera = camera, .body = "", .mount = {}, .pose = {}};
  const CameraConfig stream = StreamToSee(run.cameras, name);
  mounted.width = run.cameras.width(stream);
  mounted.height = run.cameras.height(stream);
  const auto on_body = [&](int body, const std::string& place) {
    if (body == 0) return;
    mounted.body = ElementName(m, mjOBJ_BODY, body);
    if (!mounted.body.empty()) return;
    throw ArgumentError(place + ": its body has no name; name the body with an edit of the robot");
  };
  if (camera.IsCopy()) {
    const std::string place = FieldOf(name, "camera");
    const std::string model_name = camera.camera.empty() ? name : camera.camera;
    std::string full;
    try {
      full = FindCameraName(scene, {.name = "", .camera = model_name});
    } catch (const NotFoundError& error) {
      throw NotFoundError(fmt::format(
          "camera '{}': {} A camera of its own needs a `pos` or `around`", name, error.what()));
    }
    if (full == name) {
      throw ArgumentError(fmt::format(
          "camera '{0}': the scene has a camera of this name; choose another name, and set "
          "`camera: {0}`",
          name));
    }
    const int id = RequireId(m, mjOBJ_CAMERA, full, place);
    if (m->cam_mode[id] != mjCAMLIGHT_FIXED) {
      throw ArgumentError(fmt::format(
          "{}: the camera '{}' follows a body (its mode), so it has no pose to take over", place,
          model_name));
    }
    on_body(m->cam_bodyid[id], place);
    mounted.pose = Pose::FromWxyz(m->cam_pos + 3 * id, m->cam_quat + 4 * id);
    mounted.fovy = camera.fovy ? *camera.fovy : LensOf(m, id, place);
    return mounted;
  }
  if (FindId(m, mjOBJ_CAMERA, name) >= 0) {
    throw ArgumentError(
        fmt::format("camera '{0}': the scene has a camera of this name; choose another one", name));
  }
  mounted.fovy = camera.fovy.value_or(StartCamera::kFovy);
  if (!camera.mount.empty()) {
    const std::string place = FieldOf(name, "mount");
    if (const int site = FindOf(scene, robot, mjOBJ_SITE, camera.mount); site >= 0) {
      on_body(m->site_bodyid[site], place);
      mounted.mount = Pose::FromWxyz(m->site_pos + 3 * site, m->site_quat + 4 * site);
    } else if (const int body = FindOf(scene, robot, mjOBJ_BODY, camera.mount); body >= 0) {
      on_body(body, place);
    } else {
      std::vector<std::string> known;
      for (const mjtObj kind : {mjOBJ_BODY, mjOBJ_SITE}) {
        for (const std::string& each : ElementNames(m, kind)) {
          if (!each.empty()) known.push_back(robot.OwnName(each));
        }
      }
      throw NotFoundError(NoSuchName(place, "body or site", camera.mount, known));
    }
  }
  if (!camera.pos) return mounted;
  const Eigen::Vector3d eye = ToEigen(*camera.pos);
  mounted.pose = camera.look_at ? LookAt(eye, ToEigen(*camera.look_at), ToEigen(camera.up))
                                : PlacementPose(*camera.pos, camera.euler, camera.quat);
  return mounted;
}

void StartCameras::AddTo(SceneSpec& spec) const {
  for (const Mounted& mounted : mounted_) {
    const Pose pose =
        mounted.camera.around.empty() ? mounted.mount * mounted.pose : LookAt({1, 0, 1}, {0, 0, 0});
    spec.cameras.push_back({.name = mounted.name,
                            .pos = ToVec3(pose.translation()),
                            .fovy = mounted.fovy,
                            .quat = pose.quaternion(),
                            .attach_to = mounted.body.empty() ? World() : Body(mounted.body)});
  }
}

void StartCameras::Draw(const Mounted& mounted, Scene& scene, const Robot& robot,
                        const ObjectOf& object_of, Rng& rng) const {
  const StartCamera& camera = mounted.camera;
  Pose pose = mounted.pose;
  const double most = camera.look_at_noise;
  if (!camera.around.empty()) {
    const Eigen::Vector3d middle =
        MiddleOf(camera.around, scene, robot, object_of, FieldOf(mounted.name, "around"));
    const Eigen::Vector3d away = middle - robot.base_in_world().translation();
    const double azimuth =
        std::atan2(away.y(), away.x()) + Radians(rng.Uniform(camera.azimuth[0], camera.azimuth[1]));
    const double distance = rng.Uniform(camera.distance[0], camera.distance[1]);
    const double height = rng.Uniform(camera.height[0], camera.height[1]);
    pose = LookAt(middle + Eigen::Vector3d(distance * std::cos(azimuth),
                                           distance * std::sin(azimuth), height),
                  middle + RandomOffset({most, most, most}, rng));
  } else if (camera.look_at && most > 0) {
    pose = LookAt(ToEigen(*camera.pos),
                  ToEigen(*camera.look_at) + RandomOffset({most, most, most}, rng),
                  ToEigen(camera.up));
  }
  const Eigen::Vector3d offset = RandomOffset(camera.pos_noise, rng);
  const Eigen::Vector3d turn = RandomRotation(camera.rotation_noise, rng);
  const double fovy = mounted.fovy + rng.Uniform(-camera.fovy_noise, camera.fovy_noise);
  PlaceCamera(scene, mounted.name, mounted.mount * pose * Pose::FromRotvec(offset, turn),
              std::clamp(fovy, 1.0, 179.0));
}

std::optional<Refusal> StartCameras::Place(Scene& scene, const Robot& robot,
                                           const ObjectOf& object_of, const Rng& rng) {
  for (const Mounted& mounted : mounted_) {
    Rng draws = rng.Fork(mounted.name);
    const int tries =
        mounted.camera.IsRandom() && !mounted.camera.sees.empty() ? mounted.camera.tries : 1;
    std::optional<Refusal> refusal;
    for (int t = 0; t < tries; ++t) {
      Draw(mounted, scene, robot, object_of, draws);
      scene.SyncPoses();
      refusal = CheckSight(mounted, scene, robot, object_of);
      if (!refusal) break;
    }
    if (refusal) return refusal;
  }
  return std::nullopt;
}

std::optional<Refusal> StartCameras::Check(const Scene& scene, const Robot& robot,
                                           const ObjectOf& object_of) {
  for (const Mounted& mounted : mounted_) {
    if (auto refusal = CheckSight(mounted, scene, robot, object_of)) return refusal;
  }
  return std::nullopt;
}

std::optional<Refusal> StartCameras::CheckWithoutRobot(const Scene& scene, const Robot& robot,
                                                       const ObjectOf& object_of) {
  for (const Mounted& mounted : mounted_) {
    const auto is_of_robot = [&](const auto& sight) {
      return IsOfRobot(robot, sight.first) ||
             FindId(scene.model(), mjOBJ_BODY, robot.prefix() + sight.first) >= 0;
    };
    if (mounted.camera.IsRandom() || !mounted.body.empty() ||
        std::ranges::any_of(mounted.camera.sees.entries(), is_of_robot))
      continue;
    if (auto refusal = CheckSight(mounted, scene, robot, object_of)) return refusal;
  }
  return std::nullopt;
}

void StartCameras::RequireNames(const Scene& scene, const Robot& robot, const ObjectOf& object_of,
                                std::span<const std::string> others) const {
  for (const Mounted& mounted : mounted_) {
    const auto require = [&](const std::string& name, const char* field) {
      if (std::ranges::find(others, name) != others.end()) return;
      BodiesNamed(scene, robot, Resolved(object_of, name), FieldOf(mounted.name, field));
    };
    for (const std::string& name : mounted.camera.around) require(name, "around");
    for (const auto& [name, sight] : mounted.camera.sees.entries()) {
      require(name, "sees");
      for (const std::string& other : sight->not_hidden_by) require(other, "sees");
    }
  }
}

std::optional<Refusal> StartCameras::CheckSight(const Mounted& mounted, const Scene& scene,
                                                const Robot& robot, const ObjectOf& object_of) {
  const std::string place = FieldOf(mounted.name, "sees");
  const auto refuse = [&](const std::string& what) {
    return Refusal{Refusal::kCameraConstraint, fmt::format("camera '{}' {}", mounted.name, what)};
  };
  const auto bodies_of = [&](const std::string& name) {
    return BodiesNamed(scene, robot, Resolved(object_of, name), place);
  };
  const CameraView view = NamedCamera(scene.model(), mounted.name, "scene '" + scene.name() + "'");
  for (const auto& [name, sight] : mounted.camera.sees.entries()) {
    const std::vector<bool> bodies = bodies_of(name);
    if (sight->share > 0 || !sight->not_hidden_by.empty()) {
      const CameraModel camera =
          ComputeCamera(scene.model(), scene.data(), view, mounted.width, mounted.height);
      const SightOfBodies seen = SightOf(scene, bodies, camera);
      if (seen.share < sight->share) {
        return refuse(fmt::format("sees {:.0f} % of '{}', and its share is {:.0f} %",
                                  100 * seen.share, name, 100 * sight->share));
      }
      for (const std::string& other : sight->not_hidden_by) {
        const std::vector<bool> others = bodies_of(other);
        for (size_t body = 0; body < others.size(); ++body) {
          if (others[body] && seen.hidden_by[body] > 0)
            return refuse(fmt::format("sees '{}' in front of '{}'", other, name));
        }
      }
    }
    if (sight->pixels == 0) continue;
    const std::span<const int32_t> ids = images_->Draw(scene, view, mounted.width, mounted.height);
    const auto pixels =
        std::ranges::count_if(ids, [&](int32_t id) { return id >= 0 && bodies[id]; });
    if (pixels < sight->pixels) {
      return refuse(fmt::format("sees {} of '{}', and needs {}", Counted(pixels, "pixel"), name,
                                sight->pixels));
    }
  }
  return std::nullopt;
}

}  // namespace robocell::internal
