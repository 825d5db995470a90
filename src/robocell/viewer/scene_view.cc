#include "robocell/viewer/scene_view.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/guard.h"
#include "robocell/render/mjv_scene.h"
#include "robocell/render/video_recorder.h"

namespace robocell {
namespace {

constexpr int kOverlays = 30000;  // paths, contacts, frames

double DefaultFrameLength(const mjModel* m) {
  return std::clamp(0.08 * m->stat.extent, 0.02, 0.15);
}

void RequireFinite(const char* what, double value) {
  if (!std::isfinite(value))
    throw ArgumentError(fmt::format("viewer: {} must be finite, got {}", what, value));
}

// Adds an element to the list; nothing when the list is full.
mjvGeom* Add(mjvScene* list, int type, const std::array<float, 4>& rgba) {
  if (list->ngeom >= list->maxgeom) return nullptr;
  mjvGeom* geom = &list->geoms[list->ngeom++];
  mjv_initGeom(geom, type, nullptr, nullptr, nullptr, rgba.data());
  geom->category = mjCAT_DECOR;
  return geom;
}

void AddLine(mjvScene* list, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width,
             const std::array<float, 4>& rgba) {
  if (mjvGeom* geom = Add(list, mjGEOM_CAPSULE, rgba)) {
    mjv_connector(geom, mjGEOM_CAPSULE, width, from.data(), to.data());
    geom->emission = 0.6f;
  }
}

Pose PoseAt(const mjtNum* pos, const mjtNum* mat) {
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = mat[i];
  return Pose(Eigen::Vector3d(pos[0], pos[1], pos[2]), rotation);
}

std::string NameOf(const mjModel* m, int type, int id) {
  const char* name = mj_id2name(m, type, id);
  return name ? name : "";
}

}  // namespace

void RequireRobotOf(const Scene& scene, const Robot& robot) {
  if (robot.scene() == scene) return;
  throw ArgumentError(fmt::format(
      "viewer: robot '{}' belongs to another scene, '{}', than the viewer's, '{}'; open a viewer "
      "of its own for it",
      robot.name(), robot.scene().name(), scene.name()));
}

std::string Describe(const ViewElement& element) {
  switch (element.kind) {
    case ViewElement::kBody:
      return "body '" + element.name + "'";
    case ViewElement::kSite:
      return "site '" + element.name + "'";
    case ViewElement::kTcp:
      return "TCP of '" + element.name + "'";
    case ViewElement::kCamera:
      return "camera '" + element.name + "'";
  }
  return element.name;
}

struct SceneView::Drawing {
  explicit Drawing(const mjModel* model) : elements(model, kOverlays), list(*elements.get()) {
    mjv_defaultCamera(&camera);
    mjv_defaultPerturb(&perturb);
    mjv_defaultOption(&option);
    for (int i = 0; i < static_cast<int>(model->npair); ++i) {
      paired.insert(model->pair_geom1[i]);
      paired.insert(model->pair_geom2[i]);
    }
  }

  mjvCamera camera;
  mjvPerturb perturb;
  mjvOption option;
  internal::MjvScene elements;
  mjvScene& list;
  std::set<int> paired;  // geoms of explicit pairs
  // The forces of the program on the held body, during a step.
  std::array<mjtNum, 6> own_force{};
  int forced = -1;
};

SceneView::SceneView(const Scene& scene, std::vector<Robot> robots)
    : scene_(scene), robots_(std::move(robots)) {
  for (const Robot& robot : robots_) RequireRobotOf(scene_, robot);
  for (Robot& robot : RobotsOf(scene_)) {
    const bool known = std::any_of(robots_.begin(), robots_.end(),
                                   [&](const Robot& r) { return r.name() == robot.name(); });
    if (!known) robots_.push_back(std::move(robot));
  }
  free_ = InitialView(scene_.model());
  frame_length_ = DefaultFrameLength(scene_.model());
  Follow();
  UseCamera("");
}

SceneView::~SceneView() = default;

mjvScene* SceneView::list() { return &drawing_->list; }

bool SceneView::Follow() {
  if (drawing_ && generation_ == scene_.generation()) return false;
  const mjModel* model = scene_.model();
  auto next = std::make_unique<Drawing>(model);
  if (drawing_) {
    KeepFreeCamera();
    next->camera = drawing_->camera;
  }
  generation_ = scene_.generation();
  drawing_ = std::move(next);
  const std::string selected = std::exchange(selected_, "");
  if (mj_name2id(model, mjOBJ_BODY, selected.c_str()) > 0) SelectBody(selected);
  FindCamera();
  Update(aspect_);  // the mouse acts on what is seen
  return true;
}

// --- camera --------------------------------------------------------------------------------------

std::vector<std::string> SceneView::camera_names() const {
  std::vector<std::string> names = RecorderCameras(scene_.model());
  names.erase(std::remove(names.begin(), names.end(), kCurrentCamera), names.end());
  return names;
}

// Notes the view of the mouse before another camera is used.
void SceneView::KeepFreeCamera() {
  const mjvCamera& c = drawing_->camera;
  if (c.type != mjCAMERA_FREE) return;
  free_.lookat = {c.lookat[0], c.lookat[1], c.lookat[2]};
  free_.distance = c.distance;
  free_.azimuth = c.azimuth;
  free_.elevation = c.elevation;
}

void SceneView::FindCamera() {
  const mjModel* model = scene_.model();
  mjvCamera& c = drawing_->camera;
  if (c.type == mjCAMERA_TRACKING) {
    c.trackbodyid = mj_name2id(model, mjOBJ_BODY, tracked_.c_str());
    if (c.trackbodyid <= 0) UseCamera("");
  } else if (c.type == mjCAMERA_FIXED) {
    c.fixedcamid = mj_name2id(model, mjOBJ_CAMERA, camera_name_.c_str());
    if (c.fixedcamid < 0) UseCamera("");
  }
}

void SceneView::UseModelCamera(const std::string& name, int id) {
  KeepFreeCamera();
  drawing_->camera.type = mjCAMERA_FIXED;
  drawing_->camera.fixedcamid = id;
  camera_name_ = name;
}

void SceneView::UseCamera(std::string_view name) {
  const std::string wanted(name);
  const mjModel* model = scene_.model();
  if (const int id = mj_name2id(model, mjOBJ_CAMERA, wanted.c_str()); !wanted.empty() && id >= 0)
    return UseModelCamera(wanted, id);
  if (wanted.empty() || wanted == kFreeCamera)
    return SetFreeCamera(free_.distance, free_.azimuth, free_.elevation, free_.lookat);
  if (wanted == kTrackingCamera) {
    std::string body = !selected_.empty() ? selected_ : tracked_;
    if (mj_name2id(model, mjOBJ_BODY, body.c_str()) <= 0) {
      body = NameOf(model, mjOBJ_BODY, model->nbody > 1 ? 1 : 0);
      if (!robots_.empty() && !robots_.front().body_ids().empty())
        body = NameOf(model, mjOBJ_BODY, robots_.front().body_ids().front());
    }
    KeepFreeCamera();
    return SetTrackingCamera(body, free_.distance, free_.azimuth, free_.elevation);
  }
  throw NotFoundError(NoSuchName("viewer", "camera", wanted, camera_names()));
}

void SceneView::SetFreeCamera(double distance, double azimuth, double elevation,
                              const Eigen::Vector3d& lookat) {
  RequireView(OrbitCamera{
      .lookat = lookat, .distance = distance, .azimuth = azimuth, .elevation = elevation});
  free_.lookat = lookat;
  free_.distance = distance;
  free_.azimuth = azimuth;
  free_.elevation = elevation;
  mjvCamera& c = drawing_->camera;
  c.type = mjCAMERA_FREE;
  c.fixedcamid = c.trackbodyid = -1;
  for (int i = 0; i < 3; ++i) c.lookat[i] = lookat[i];
  c.distance = distance;
  c.azimuth = azimuth;
  c.elevation = elevation;
  camera_name_ = kFreeCamera;
}

void SceneView::SetTrackingCamera(std::string_view body, double distance, double azimuth,
                                  double elevation) {
  const std::string name(body);
  const int id = mj_name2id(scene_.model(), mjOBJ_BODY, name.c_str());
  if (id < 0) {
    throw NotFoundError(NoSuchName("viewer: tracking camera", "body", name, scene_.body_names()));
  }
  RequireView(OrbitCamera{.distance = distance, .azimuth = azimuth, .elevation = elevation});
  KeepFreeCamera();
  mjvCamera& c = drawing_->camera;
  c.type = mjCAMERA_TRACKING;
  c.trackbodyid = id;
  c.fixedcamid = -1;
  c.distance = distance;
  c.azimuth = azimuth;
  c.elevation = elevation;
  tracked_ = name;
  camera_name_ = kTrackingCamera;
}

void SceneView::MoveCamera(int action, double dx, double dy) {
  mjvCamera& c = drawing_->camera;
  if (c.type == mjCAMERA_FIXED) {  // continue from there, looking at what the camera looks at
    scene_.SyncPoses();
    const Pose at = PoseAt(scene_.data()->cam_xpos + 3 * static_cast<ptrdiff_t>(c.fixedcamid),
                           scene_.data()->cam_xmat + 9 * static_cast<ptrdiff_t>(c.fixedcamid));
    const Eigen::Vector3d forward = -at.rotation().col(2);
    const double degrees = 180 / std::numbers::pi;
    SetFreeCamera(free_.distance, degrees * std::atan2(forward.y(), forward.x()),
                  degrees * std::asin(std::clamp(forward.z(), -1., 1.)),
                  at.translation() + free_.distance * forward);
  }
  mjv_moveCamera(scene_.model(), action, dx, dy, &c);
  KeepFreeCamera();
}

CameraView SceneView::view() const {
  const mjvCamera& c = drawing_->camera;
  const double fovy = scene_.model()->vis.global.fovy;
  switch (c.type) {
    case mjCAMERA_FIXED:
      return ModelCamera{c.fixedcamid};
    case mjCAMERA_TRACKING:
      return TrackingCamera{.body = c.trackbodyid,
                            .distance = c.distance,
                            .azimuth = c.azimuth,
                            .elevation = c.elevation,
                            .fovy = fovy};
    default:
      return OrbitCamera{.lookat = {c.lookat[0], c.lookat[1], c.lookat[2]},
                         .distance = c.distance,
                         .azimuth = c.azimuth,
                         .elevation = c.elevation,
                         .fovy = fovy};
  }
}

// --- overlays ------------------------------------------------------------------------------------

const Robot* SceneView::FindRobot(const std::string& name) const {
  const auto found = std::find_if(robots_.begin(), robots_.end(), [&](const Robot& robot) {
    return robot.name() == name && robot.has_arm();
  });
  return found == robots_.end() ? nullptr : &*found;
}

std::vector<std::string> SceneView::elements(ViewElement::Kind kind) const {
  std::vector<std::string> names;
  if (kind == ViewElement::kTcp) {
    for (const Robot& robot : robots_) {
      if (robot.has_arm()) names.push_back(robot.name());
    }
    return names;
  }
  const mjModel* m = scene_.model();
  const auto add = [&](mjtSize count, int type) {
    for (int id = 0; id < static_cast<int>(count); ++id) {
      if (std::string name = NameOf(m, type, id); !name.empty()) names.push_back(std::move(name));
    }
  };
  if (kind == ViewElement::kBody) add(m->nbody, mjOBJ_BODY);
  if (kind == ViewElement::kSite) add(m->nsite, mjOBJ_SITE);
  if (kind == ViewElement::kCamera) add(m->ncam, mjOBJ_CAMERA);
  return names;
}

std::optional<Pose> SceneView::pose(const ViewElement& element) const {
  if (element.kind == ViewElement::kTcp) {
    const Robot* robot = FindRobot(element.name);
    return robot ? std::optional(robot->tcp_in_world()) : std::nullopt;
  }
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  const int type = element.kind == ViewElement::kBody   ? mjOBJ_BODY
                   : element.kind == ViewElement::kSite ? mjOBJ_SITE
                                                        : mjOBJ_CAMERA;
  const int id = mj_name2id(m, type, element.name.c_str());
  if (id < 0) return std::nullopt;
  scene_.SyncPoses();
  const ptrdiff_t p = 3 * static_cast<ptrdiff_t>(id), r = 9 * static_cast<ptrdiff_t>(id);
  if (type == mjOBJ_BODY) return PoseAt(d->xpos + p, d->xmat + r);
  if (type == mjOBJ_SITE) return PoseAt(d->site_xpos + p, d->site_xmat + r);
  return PoseAt(d->cam_xpos + p, d->cam_xmat + r);
}

namespace {

void RequireElement(const SceneView& view, const ViewElement& element) {
  if (view.pose(element)) return;
  static constexpr std::array<const char*, 4> kKinds = {"body", "site", "robot", "camera"};
  throw NotFoundError(NoSuchName("viewer", kKinds[static_cast<size_t>(element.kind)], element.name,
                                 view.elements(element.kind)));
}

}  // namespace

void SceneView::ShowFrame(const ViewElement& element, bool shown) {
  if (!shown) {
    frames_.erase(element);
    return;
  }
  RequireElement(*this, element);
  frames_.insert(element);
}

void SceneView::TracePoint(const ViewElement& element, bool traced) {
  if (!traced) {
    traced_.erase(element);
    traces.Drop(Describe(element));
    return;
  }
  RequireElement(*this, element);
  traced_.insert(element);
  ExtendTraces();
}

void SceneView::ExtendTraces() {
  for (const ViewElement& element : traced_) {
    if (const auto at = pose(element))
      traces.Extend(Describe(element), scene_.time(), at->translation());
  }
}

void SceneView::set_frame_length(double metres) {
  RequireFinite("the length of frames", metres);
  if (metres <= 0)
    throw ArgumentError(fmt::format("viewer: frames need a length above 0 m, got {}", metres));
  frame_length_ = metres;
}

// --- selection -----------------------------------------------------------------------------------

void SceneView::SelectBody(std::string_view name) {
  mjvPerturb& held = drawing_->perturb;
  Release();
  selected_.clear();
  held.select = 0;
  if (name.empty()) return;
  const std::string body(name);
  const int id = mj_name2id(scene_.model(), mjOBJ_BODY, body.c_str());
  if (id < 0) {
    throw NotFoundError(NoSuchName("viewer: selection", "body", body, scene_.body_names()));
  }
  selected_ = body;
  held.select = id;
  held.skinselect = held.flexselect = -1;
  mju_zero3(held.localpos);
}

std::string SceneView::Select(double x, double y, double aspect) {
  scene_.SyncPoses();
  const mjModel* m = scene_.model();
  mjData* d = scene_.data();
  mjtNum point[3];
  int geom = -1, flex = -1, skin = -1, body = -1;
  internal::Guarded("viewer: selecting a body", d, [&] {
    body = mjv_select(m, d, &drawing_->option, aspect, x, y, &drawing_->list, point, &geom, &flex,
                      &skin);
  });
  if (body <= 0) {  // nothing, or a part of the world
    SelectBody("");
    return "";
  }
  const std::string name = NameOf(m, mjOBJ_BODY, body);
  Release();
  selected_ = name;
  mjvPerturb& held = drawing_->perturb;
  held.select = body;
  held.flexselect = flex;
  held.skinselect = skin;
  mjtNum local[3];
  mju_sub3(local, point, d->xpos + 3 * static_cast<ptrdiff_t>(body));
  mju_mulMatTVec3(held.localpos, d->xmat + 9 * static_cast<ptrdiff_t>(body), local);
  return name;
}

bool SceneView::holds() const { return drawing_->perturb.active != 0; }

bool SceneView::Hold(bool rotate) {
  mjvPerturb& held = drawing_->perturb;
  if (held.select <= 0) return false;
  scene_.SyncPoses();
  internal::Guarded("viewer: holding a body", scene_.data(), [&] {
    mjv_initPerturb(scene_.model(), scene_.data(), &drawing_->list, &held);
  });
  held.active = rotate ? mjPERT_ROTATE : mjPERT_TRANSLATE;
  return true;
}

void SceneView::MoveHeld(int action, double dx, double dy) {
  if (!holds()) return;
  internal::Guarded("viewer: moving a body", scene_.data(), [&] {
    mjv_movePerturb(scene_.model(), scene_.data(), action, dx, dy, &drawing_->list,
                    &drawing_->perturb);
  });
}

void SceneView::Release() { drawing_->perturb.active = 0; }

void SceneView::ApplyForce(bool paused) {
  drawing_->forced = -1;
  if (!holds() || generation_ != scene_.generation()) return;
  const mjModel* m = scene_.model();
  mjData* d = scene_.data();
  const mjvPerturb& held = drawing_->perturb;
  const int body = held.select;
  const bool mocap = m->body_mocapid[body] >= 0;
  const bool free = m->body_jntnum[body] == 1 && m->jnt_type[m->body_jntadr[body]] == mjJNT_FREE;
  if (mocap || (paused && free)) {
    const Eigen::Vector3d at(held.refpos[0], held.refpos[1], held.refpos[2]);
    const Quaternion turn{held.refquat[1], held.refquat[2], held.refquat[3], held.refquat[0]};
    scene_.SetBodyPose(selected_, Pose(at, turn));
    return;
  }
  if (paused) return;
  mjtNum* force = d->xfrc_applied + 6 * static_cast<ptrdiff_t>(body);
  std::copy_n(force, 6, drawing_->own_force.begin());
  drawing_->forced = body;
  internal::Guarded("viewer: pulling a body", d, [&] { mjv_applyPerturbForce(m, d, &held); });
  for (int i = 0; i < 6; ++i) force[i] += drawing_->own_force[static_cast<size_t>(i)];
}

void SceneView::EndForce() {
  if (drawing_->forced < 0 || generation_ != scene_.generation()) return;
  mjtNum* force = scene_.data()->xfrc_applied + 6 * static_cast<ptrdiff_t>(drawing_->forced);
  std::copy_n(drawing_->own_force.begin(), 6, force);
  drawing_->forced = -1;
}

// --- drawing -------------------------------------------------------------------------------------

void SceneView::Update(double aspect) {
  Follow();
  scene_.SyncPoses();
  aspect_ = aspect;
  const mjModel* m = scene_.model();
  mjData* d = scene_.data();
  Drawing& now = *drawing_;
  mjtByte* shows = now.option.flags;
  shows[mjVIS_CONTACTPOINT] = shows[mjVIS_CONTACTFORCE] = flags.contacts;
  shows[mjVIS_JOINT] = flags.joints;
  shows[mjVIS_TRANSPARENT] = flags.transparent;
  shows[mjVIS_PERTFORCE] = shows[mjVIS_PERTOBJ] = 1;
  for (int i = 0; i < mjNGROUP; ++i)
    now.option.geomgroup[i] = flags.collision_geoms || i < 3 ? 1 : 0;
  now.list.flags[mjRND_SHADOW] = flags.shadows;
  internal::Guarded("viewer: preparing a picture", d, [&] {
    mjv_updateScene(m, d, &now.option, &now.perturb, &now.camera, mjCAT_ALL, &now.list);
  });
  now.elements.LetPlanesCastNoShadow();
  if (flags.collision_geoms) KeepColliding();
  AddOverlays();
}

// Leaves the geoms that can collide, also by a pair of their own.
void SceneView::KeepColliding() {
  const mjModel* m = scene_.model();
  mjvScene& list = drawing_->list;
  const auto collides = [&](int geom) {
    return m->geom_contype[geom] != 0 || m->geom_conaffinity[geom] != 0 ||
           drawing_->paired.contains(geom);
  };
  int kept = 0;
  for (int i = 0; i < list.ngeom; ++i) {
    const mjvGeom& geom = list.geoms[i];
    if (geom.objtype == mjOBJ_GEOM && geom.category != mjCAT_DECOR && !collides(geom.objid))
      continue;
    if (kept != i) list.geoms[kept] = geom;
    ++kept;
  }
  list.ngeom = kept;
}

void SceneView::AddOverlays() {
  mjvScene* list = &drawing_->list;
  std::vector<Marker> markers;
  for (const ViewElement& element : frames_) {
    if (const auto at = pose(element))
      AddFrame(markers, *at, frame_length_, flags.labels ? element.name : std::string());
  }
  markers.insert(markers.end(), markers_.begin(), markers_.end());
  for (const Marker& marker : markers) drawing_->elements.Add(marker);
  const double width = 0.03 * frame_length_;
  for (const TraceSegment& segment : traces.segments())
    AddLine(list, segment.from, segment.to, width, segment.rgba);
  AddPaths();
}

// Where the paths have more points than the list has room, all are drawn with fewer points.
void SceneView::AddPaths() {
  mjvScene* list = &drawing_->list;
  const double width = 0.03 * frame_length_;
  size_t points = 0;
  for (const auto& [name, path] : traces.paths()) points += path.size();
  const size_t room = static_cast<size_t>(list->maxgeom - list->ngeom);
  const size_t paths = traces.paths().size();  // each has one line more at its end
  const size_t stride = points <= room || room <= paths ? 1 : 1 + points / (room - paths);
  for (const auto& [name, path] : traces.paths()) {
    for (size_t i = 0; i + 1 < path.size(); i += stride) {
      const size_t next = std::min(i + stride, path.size() - 1);
      AddLine(list, path[i].position, path[next].position, width, TraceLines::kColour);
    }
  }
}

std::optional<Eigen::Vector2d> SceneView::Project(const Eigen::Vector3d& point) const {
  const mjvGLCamera eye = mjv_averageCamera(&drawing_->list.camera[0], &drawing_->list.camera[1]);
  const Eigen::Vector3d pos(eye.pos[0], eye.pos[1], eye.pos[2]);
  const Eigen::Vector3d forward(eye.forward[0], eye.forward[1], eye.forward[2]);
  const Eigen::Vector3d up(eye.up[0], eye.up[1], eye.up[2]);
  const Eigen::Vector3d offset = point - pos;
  const double depth = forward.dot(offset);
  if (depth <= 0) return std::nullopt;
  const double scale = eye.orthographic ? 1 : depth / eye.frustum_near;
  const double half = 0.5 * (eye.frustum_top - eye.frustum_bottom) * scale;
  const double middle = 0.5 * (eye.frustum_top + eye.frustum_bottom) * scale;
  return Eigen::Vector2d(0.5 + forward.cross(up).dot(offset) / (2 * half * aspect_),
                         0.5 + (up.dot(offset) - middle) / (2 * half));
}

Eigen::Vector3d SceneView::Unproject(const Eigen::Vector2d& place,
                                     const Eigen::Vector3d& point) const {
  const mjvGLCamera eye = mjv_averageCamera(&drawing_->list.camera[0], &drawing_->list.camera[1]);
  const Eigen::Vector3d pos(eye.pos[0], eye.pos[1], eye.pos[2]);
  const Eigen::Vector3d forward(eye.forward[0], eye.forward[1], eye.forward[2]);
  const Eigen::Vector3d up(eye.up[0], eye.up[1], eye.up[2]);
  const double depth = forward.dot(point - pos);
  const double scale = eye.orthographic ? 1 : depth / eye.frustum_near;
  const double half = 0.5 * (eye.frustum_top - eye.frustum_bottom) * scale;
  const double middle = 0.5 * (eye.frustum_top + eye.frustum_bottom) * scale;
  return pos + depth * forward + (2 * half * aspect_ * (place.x() - 0.5)) * forward.cross(up) +
         (middle + 2 * half * (place.y() - 0.5)) * up;
}

}  // namespace robocell
