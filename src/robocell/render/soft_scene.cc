#include "robocell/render/soft_scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <Eigen/Geometry>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/render/soft_kernel.h"

namespace robocell::internal {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

// An element with less alpha hides those behind it only partly, as in the engine.
constexpr float kOpaque = 0.995f;
// The sky is painted at this share of the far plane's distance.
constexpr float kSkyDistance = 0.7f;
constexpr size_t kMostRuns = size_t{1} << (31 - kSoftRunBits);

Affine3d PoseOf(const mjvGeom& geom) {
  using Rows = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  Affine3d pose;
  pose.linear() = Eigen::Map<const Rows>(geom.mat).cast<double>();
  pose.translation() = Eigen::Map<const Eigen::Vector3f>(geom.pos).cast<double>();
  return pose;
}

Affine3d Scaled(const Affine3d& pose, double x, double y, double z) {
  const auto size = [](double s) { return s == 0 ? 1e-9 : s; };  // flat ones have an inverse too
  return pose * Eigen::Scaling(size(x), size(y), size(z));
}

template <int kRows>
void Store(const Eigen::Matrix<double, 3, kRows>& m, float* rows) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < kRows; ++c) rows[kRows * r + c] = static_cast<float>(m(r, c));
  }
}

void Store(const Vector3d& v, float* to) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v[k]);
}

// Returns how far the element extends from its position, for sorting.
float Reach(const mjvGeom& g) {
  if (g.modelrbound > 0) return g.modelrbound;
  switch (g.type) {
    case mjGEOM_SPHERE:
      return g.size[0];
    case mjGEOM_CAPSULE:
      return g.size[0] + g.size[2];
    case mjGEOM_CYLINDER:
      return std::hypot(g.size[0], g.size[2]);
    case mjGEOM_ELLIPSOID:
      return std::max({g.size[0], g.size[1], g.size[2]});
    case mjGEOM_BOX:
      return std::hypot(g.size[0], g.size[1], g.size[2]);
    default:
      return 0;
  }
}

bool IsBehind(const Vector3d& eye, const mjvGeom& g) {
  return (eye[0] - g.pos[0]) * g.mat[2] + (eye[1] - g.pos[1]) * g.mat[5] +
             (eye[2] - g.pos[2]) * g.mat[8] <
         0;
}

// Returns true if no corner of the mesh's box is in front of a plane.
bool IsBelow(const SoftMesh& mesh, const Affine3d& in_world, const Vector3d& point,
             const Vector3d& normal) {
  for (int k = 0; k < 8; ++k) {
    const Vector3d corner(k & 1 ? mesh.low.x() : mesh.high.x(),
                          k & 2 ? mesh.low.y() : mesh.high.y(),
                          k & 4 ? mesh.low.z() : mesh.high.z());
    if ((in_world * corner - point).dot(normal) > 1e-6) return false;
  }
  return true;
}

// Returns true if all corners of the mesh's box are outside of one side of the view.
bool OutOfView(const SoftView& view, const SoftMesh& mesh, const Affine3d& to_view) {
  int outside[6] = {};
  for (int k = 0; k < 8; ++k) {
    const Vector3d corner(k & 1 ? mesh.low.x() : mesh.high.x(),
                          k & 2 ? mesh.low.y() : mesh.high.y(),
                          k & 4 ? mesh.low.z() : mesh.high.z());
    const Vector3d p = to_view * corner;
    const double depth = -p.z(), scale = view.orthographic ? 1 : depth;
    const double x = p.x() * view.fx, y = -p.y() * view.fy;
    outside[0] += depth < view.near;
    outside[1] += depth > view.far;
    outside[2] += x < (-1 - view.cx) * scale;
    outside[3] += x > (view.width - view.cx) * scale;
    outside[4] += y < (-1 - view.cy) * scale;
    outside[5] += y > (view.height - view.cy) * scale;
  }
  return std::any_of(outside, outside + 6, [](int n) { return n == 8; });
}

}  // namespace

void SoftScene::SetModel(const mjModel* model, const Visibility& visibility) {
  now_.Clear();  // instances point into the assets
  mirrored_.Clear();
  shadows_.Clear();
  own_.clear();
  own_.reserve(static_cast<size_t>(2 * (model->nskin + model->nflex) + 64));
  assets_ = SoftAssets(model, visibility);
}

void SoftScene::SetCamera(const CameraModel& camera) {
  view_.width = camera.width;
  view_.height = camera.height;
  view_.bottom = camera.height;
  view_.orthographic = camera.orthographic;
  view_.fx = static_cast<float>(camera.fx);
  view_.fy = static_cast<float>(camera.fy);
  view_.cx = static_cast<float>(camera.cx);
  view_.cy = static_cast<float>(camera.cy);
  view_.per_fx = 1 / view_.fx;
  view_.per_fy = 1 / view_.fy;
  view_.near = static_cast<float>(camera.near_m);
  view_.far = static_cast<float>(camera.far_m);
  view_.steps = 256;  // large images are drawn in coarser steps, so that numbers stay exact
  while (view_.steps * static_cast<float>(std::max(view_.width, view_.height)) > 0.5f * (1 << 20)) {
    view_.steps /= 2;
  }
  to_camera_.linear() = camera.camera_in_world.rotation();
  to_camera_.translation() = camera.camera_in_world.translation();
  to_camera_ = to_camera_.inverse(Eigen::Isometry);
  eye_ = camera.camera_in_world.translation();
}

void SoftScene::Update(const mjModel* model, const mjvScene& list, std::span<const int32_t> bodies,
                       const CameraModel& camera, const Effects& effects) {
  SetCamera(camera);
  now_.Clear();
  own_used_ = 0;
  with_shadows_ = effects.shadows;
  if (with_shadows_) shadows_.Begin(model, list, camera, effects.shadow_size);
  SetLights(list);
  sky_ = {};
  if (effects.sky) SetSky(model, list, camera);
  mirror_ = {};
  if (effects.reflections) FindMirror(list);
  for (int i = 0; i < list.ngeom; ++i) {
    const mjvGeom& geom = list.geoms[i];
    const size_t before = now_.instances.size();
    const bool known = geom.segid >= 0 && static_cast<size_t>(geom.segid) < bodies.size();
    AddElement(model, list, geom, known ? bodies[static_cast<size_t>(geom.segid)] : -1);
    if (i != mirror_.geom || now_.instances.size() == before) continue;
    mirror_.in_view = true;
    mirror_.first_id = now_.instances[before].first_id;
  }
  if (mirror_.in_view) AddMirrored(model, list);
}

void SoftScene::Elements::Clear() {
  instances.clear();
  instance_of_run.clear();
  opaque.clear();
  layers.clear();
  lights.clear();
  gains.clear();
}

// Finds the first element that reflects, like the engine, if its face is turned to the camera.
void SoftScene::FindMirror(const mjvScene& list) {
  for (int i = 0; i < list.ngeom; ++i) {
    const mjvGeom& geom = list.geoms[i];
    const bool plane = geom.type == mjGEOM_PLANE;
    if ((!plane && geom.type != mjGEOM_BOX) || geom.reflectance <= 0 || geom.rgba[3] < kOpaque ||
        (plane && IsBehind(eye_, geom))) {
      continue;
    }
    const Affine3d pose = PoseOf(geom);
    const Vector3d normal = pose.linear().col(2);
    const Vector3d point = pose.translation() + (plane ? 0.0 : geom.size[2]) * normal;
    if ((eye_ - point).dot(normal) <= 0) return;
    mirror_ = {.geom = i, .point = point, .normal = normal, .reflectance = geom.reflectance};
    return;
  }
}

void SoftScene::AddMirrored(const mjModel* model, const mjvScene& list) {
  const Affine3d to_camera = to_camera_;
  const Vector3d &n = mirror_.normal, &p = mirror_.point;
  Affine3d across = Affine3d::Identity();
  across.linear() -= 2 * n * n.transpose();
  across.translation() = 2 * p.dot(n) * n;
  std::swap(now_, mirrored_);
  const bool shadows = std::exchange(with_shadows_, false);
  to_camera_ = to_camera * across;
  mirroring_ = true;
  now_.Clear();
  SetLights(list);
  for (int i = 0; i < list.ngeom; ++i) {
    if (i != mirror_.geom) AddElement(model, list, list.geoms[i], -1);
  }
  mirroring_ = false;
  to_camera_ = to_camera;
  with_shadows_ = shadows;
  std::swap(now_, mirrored_);
}

bool SoftScene::DrawReflection(SoftThreads* threads, SoftReflection* reflection) {
  if (!mirror_.in_view) return false;
  SoftBuffer& buffer = reflection->buffer;
  FitBuffer(view_, &buffer);
  threads->InBands(buffer.rows, [&](SoftRows rows, int band) {
    ClearRows(view_, rows, &buffer);
    const SoftView view = RowsOf(view_, rows);
    for (const int i : mirrored_.opaque) {
      DrawInstance(view, mirrored_.instances[i], threads->scratch(band), &buffer);
    }
  });
  reflection->picture = PictureOf(mirrored_);
  reflection->first_id = mirror_.first_id;
  reflection->triangles = 2;  // all of a plane; the upper face of a box
  return true;
}

void SoftScene::DrawShadows(SoftThreads* threads) {
  if (with_shadows_) shadows_.Draw(threads);
}

void SoftScene::AddMarkers(const mjModel* model, const mjvScene& list, int first) {
  for (int i = first; i < list.ngeom; ++i) AddElement(model, list, list.geoms[i], -1);
}

SoftPicture SoftScene::Picture() const {
  SoftPicture picture = PictureOf(now_);
  picture.sky = sky_;
  return picture;
}

SoftPicture SoftScene::PictureOf(const Elements& elements) const {
  SoftPicture picture;
  picture.view = &view_;
  picture.instances = elements.instances.data();
  picture.instance_of_run = elements.instance_of_run.data();
  picture.lights = elements.lights.data();
  picture.light_count = static_cast<int>(elements.lights.size());
  picture.gains = elements.gains.data();
  return picture;
}

void SoftScene::SetLights(const mjvScene& list) {
  now_.lights.clear();
  now_.lights.reserve(mjMAXLIGHT);
  ambient_ = list.nlight > 0 ? 0.0f : 0.3f;
  for (int i = 0; i < std::min<int>(list.nlight, mjMAXLIGHT); ++i) {
    const mjvLight& from = list.lights[i];
    if (from.type == mjLIGHT_IMAGE) continue;
    SoftLight& light = now_.lights.emplace_back();
    light.directional = from.type == mjLIGHT_DIRECTIONAL;
    const Vector3d along = Eigen::Map<const Eigen::Vector3f>(from.dir).cast<double>().normalized();
    Store(Vector3d(to_camera_.linear() * (light.directional ? -along : along)), light.direction);
    const Vector3d at = Eigen::Map<const Eigen::Vector3f>(from.pos).cast<double>();
    Store(Vector3d(to_camera_ * at), light.position);
    std::copy_n(from.attenuation, 3, light.attenuation);
    if (from.type == mjLIGHT_SPOT && from.cutoff < 180) {
      light.cutoff_cosine = std::cos(from.cutoff * std::numbers::pi_v<float> / 180);
      light.exponent = from.exponent;
    }
    std::copy_n(from.ambient, 3, light.ambient);
    std::copy_n(from.diffuse, 3, light.diffuse);
    std::copy_n(from.specular, 3, light.specular);
    if (with_shadows_) light.shadow = shadows_.Of(i);
    light.everywhere = light.directional && !light.shadow;
    light.shines = std::any_of(from.specular, from.specular + 3, [](float s) { return s > 0; });
  }
}

void SoftScene::SetSky(const mjModel* model, const mjvScene& list, const CameraModel& camera) {
  sky_.texture = assets_.Sky();
  if (!sky_.texture) return;
  sky_.radius = kSkyDistance * static_cast<float>(camera.far_m);
  const Eigen::Matrix3d axes = to_camera_.linear().transpose();
  Store<3>(axes, sky_.from_view);
  if (!list.flags[mjRND_HAZE]) return;
  for (int i = 0; i < list.ngeom; ++i) {
    const mjvGeom& geom = list.geoms[i];
    if (geom.type != mjGEOM_PLANE || geom.size[0] != 0 || geom.size[1] != 0) continue;
    const Affine3d plane = PoseOf(geom);
    sky_.elevation = static_cast<float>((eye_ - plane.translation()).dot(plane.linear().col(2)));
    Store<3>(Eigen::Matrix3d(plane.linear().transpose() * axes), sky_.to_plane);
    sky_.haze = model->vis.map.haze;
    std::copy_n(model->vis.rgba.haze, 3, sky_.haze_rgb);
    // The densest part of the engine's cone: its slope is seen at 45 degrees there.
    const double alpha = std::atan2(1.0, static_cast<double>(sky_.haze));
    const double beta = 0.75 * std::numbers::pi - alpha;
    sky_.haze_height =
        static_cast<float>(std::numbers::sqrt2 / 2 * sky_.haze * std::sin(alpha) / std::sin(beta));
    return;  // the first one only
  }
}

SoftMaterial SoftScene::MaterialOf(const mjvGeom& geom, bool behind) const {
  SoftMaterial m;
  std::copy_n(geom.rgba, 4, m.rgba);
  if (behind) m.rgba[3] *= 0.3f;
  m.emission = geom.emission;
  m.specular = geom.specular;
  m.shininess = 128 * geom.shininess;
  m.shines = geom.specular > 0;
  // Skips highlights where no light's reflection exceeds half a step of colour.
  float brightest = 0;
  for (const SoftLight& light : now_.lights) {
    for (const float part : light.specular) brightest = std::max(brightest, part);
  }
  const float halvings = std::log2(std::max(512 * m.specular * brightest, 1.0f));
  m.least_shine = m.shininess > 0 ? std::exp2(-2 * halvings / m.shininess) : 0;
  m.texture = assets_.TextureOf(geom);
  if (!m.texture) return m;
  const bool uniform = assets_.TextureIsUniform(geom);
  if (geom.texcoord) {
    if (m.texture->cube) return m;
    m.mapping = SoftMapping::kMesh;
    assets_.TextureRepeat(geom, m.scale);
  } else if (m.texture->cube) {
    m.mapping = SoftMapping::kCube;
    for (int k = 0; k < 3; ++k) m.scale[k] = uniform ? geom.size[k] : 1;
  } else {
    m.mapping = SoftMapping::kPlanar;
    float repeat[2];
    assets_.TextureRepeat(geom, repeat);
    for (int k = 0; k < 2; ++k) {
      if (geom.size[k] <= 0) continue;
      // Assets and planes are not drawn at unit size.
      if (geom.dataid >= 0) repeat[k] /= std::max(1e-15f, geom.size[k]);
      if (uniform) repeat[k] *= geom.size[k];
    }
    m.scale[0] = 0.5f * repeat[0];
    m.scale[1] = -0.5f * repeat[1];
    m.offset[0] = m.offset[1] = -0.5f;
  }
  return m;
}

void SoftScene::AddElement(const mjModel* model, const mjvScene& list, const mjvGeom& geom,
                           int body) {
  const bool behind = geom.type == mjGEOM_PLANE && IsBehind(eye_, geom);
  SoftMaterial material = MaterialOf(geom, behind);
  for (int k = 0; k < 3 && mirroring_; ++k) material.rgba[k] *= mirror_.reflectance;
  const auto first = static_cast<int>(now_.instances.size());
  body_ = body;
  bends_ = false;
  casts_ = geom.castshadow != 0 && geom.category != mjCAT_DECOR;
  if (geom.type == mjGEOM_SKIN) {
    AddSkin(model, list, geom, material);
  } else if (geom.type == mjGEOM_FLEX) {
    AddFlex(list, geom, material);
  } else {
    AddShapes(geom, material, behind);
  }
  const auto end = static_cast<int>(now_.instances.size());
  if (first == end) return;
  if (geom.rgba[3] >= kOpaque && !behind) {
    for (int i = first; i < end; ++i) now_.opaque.push_back(i);
    return;
  }
  Layer layer{first, end, material.rgba[3], 1e10f};
  if (geom.type != mjGEOM_PLANE) {
    const Vector3d at = Eigen::Map<const Eigen::Vector3f>(geom.pos).cast<double>();
    layer.distance = static_cast<float>((at - eye_).norm()) - Reach(geom);
  }
  // The list is short and nearly in order: inserts in place.
  const auto place =
      std::upper_bound(now_.layers.begin(), now_.layers.end(), layer,
                       [](const Layer& a, const Layer& b) { return a.distance < b.distance; });
  now_.layers.insert(place, layer);
}

void SoftScene::AddMesh(const SoftMesh* mesh, const Affine3d& in_world,
                        const SoftMaterial& material, SoftSide side) {
  if (!mesh || mesh->triangles == 0) return;
  if (with_shadows_ && casts_) shadows_.AddCaster(mesh, in_world, bends_);
  const Affine3d to_view = to_camera_ * in_world;
  if (OutOfView(view_, *mesh, to_view)) return;
  if (mirroring_ && IsBelow(*mesh, in_world, mirror_.point, mirror_.normal)) return;
  SoftInstance instance;
  instance.mesh = mesh;
  instance.side = side;
  instance.material = material;
  instance.body = body_;
  Store<4>(to_view.affine(), instance.to_view);
  const Affine3d to_mesh = to_view.inverse(Eigen::Affine);
  Store<4>(to_mesh.affine(), instance.to_mesh);
  Store(view_.orthographic ? Vector3d(to_mesh.linear().col(2)) : Vector3d(to_mesh.translation()),
        instance.eye);
  instance.eye[3] = view_.orthographic ? 0 : 1;
  if (mirroring_) {  // mirrored triangles turn round on the image, but show the same faces
    for (float& part : instance.eye) part = -part;
    if (side != SoftSide::kBoth) {
      instance.side = side == SoftSide::kFront ? SoftSide::kBack : SoftSide::kFront;
    }
  }
  instance.first_id = static_cast<uint32_t>(now_.instance_of_run.size()) << kSoftRunBits;
  const size_t runs = (static_cast<size_t>(mesh->triangles) >> kSoftRunBits) + 1;
  if (now_.instance_of_run.size() + runs >= kMostRuns) {
    throw Error("the scene has too many elements for the renderer 'soft'; draw it with 'gl'");
  }
  now_.instance_of_run.insert(now_.instance_of_run.end(), runs,
                              static_cast<int32_t>(now_.instances.size()));
  now_.instances.push_back(instance);
  AddGains();
}

void SoftScene::AddGains() {
  SoftInstance& instance = now_.instances.back();
  const SoftMaterial& material = instance.material;
  for (int c = 0; c < 3; ++c) instance.own[c] = (material.emission + ambient_) * material.rgba[c];
  for (const SoftLight& light : now_.lights) {
    SoftGain& gain = now_.gains.emplace_back();
    gain.shines = material.shines && light.shines;
    for (int c = 0; c < 3; ++c) {
      gain.ambient[c] = light.ambient[c] * material.rgba[c];
      gain.diffuse[c] = light.diffuse[c] * material.rgba[c];
      gain.specular[c] = light.specular[c] * material.specular;
      if (light.everywhere) instance.own[c] += gain.ambient[c];
    }
  }
}

void SoftScene::AddShapes(const mjvGeom& g, const SoftMaterial& material, bool behind) {
  const SoftShapes& shapes = assets_.shapes();
  const Affine3d pose = PoseOf(g);
  const double x = g.size[0], y = g.size[1], z = g.size[2];
  const auto lifted = [](const Affine3d& at, double up) {
    return at * Eigen::Translation3d(0, 0, up);
  };
  switch (g.type) {
    case mjGEOM_PLANE: {
      const SoftSide side = behind ? SoftSide::kBack : SoftSide::kFront;
      if (g.dataid >= 0) return AddMesh(assets_.Plane(g.dataid), pose, material, side);
      return AddMesh(&shapes.plane, Scaled(pose, x, y, 1), material, side);
    }
    case mjGEOM_HFIELD:
      return AddMesh(assets_.HeightField(g.dataid), pose, material);
    case mjGEOM_SPHERE:
    case mjGEOM_ELLIPSOID:
      return AddMesh(&shapes.sphere, Scaled(pose, x, y, z), material);
    case mjGEOM_CAPSULE: {
      AddMesh(&shapes.open_cylinder, Scaled(pose, x, y, z), material);
      const double radius = 0.5 * (x + y);
      if (radius == 0) return;
      const Affine3d end = Scaled(pose, x, y, radius);
      AddMesh(&shapes.upper_half, lifted(end, z / radius - 1), material);
      return AddMesh(&shapes.lower_half, lifted(end, 1 - z / radius), material);
    }
    case mjGEOM_CYLINDER:
      return AddMesh(&shapes.cylinder, Scaled(pose, x, y, z), material);
    case mjGEOM_BOX:
      return AddMesh(&shapes.box, Scaled(pose, x, y, z), material);
    case mjGEOM_MESH:
    case mjGEOM_SDF:
      return AddMesh(assets_.Mesh(g.dataid), pose, material);
    case mjGEOM_ARROW:
    case mjGEOM_ARROW1: {
      const Affine3d shaft = lifted(Scaled(pose, x, y, z / 6), 1);
      AddMesh(&shapes.cylinder, shaft, material);
      const double wedge = g.type == mjGEOM_ARROW ? 1.75 : 1;
      return AddMesh(&shapes.cone, Scaled(lifted(shaft, 1), wedge, wedge, 1), material);
    }
    case mjGEOM_ARROW2: {
      const Affine3d shaft = Scaled(pose, x, y, z / 3);
      AddMesh(&shapes.open_cylinder, shaft, material);
      const Affine3d wide = Scaled(shaft, 1.75, 1.75, 0.5);
      AddMesh(&shapes.cone, lifted(wide, 2), material);
      const Eigen::AngleAxisd over(std::numbers::pi, Vector3d::UnitX());
      return AddMesh(&shapes.cone, lifted(wide, -2) * over, material);
    }
    case mjGEOM_TRIANGLE:
      return AddMesh(&shapes.triangle, Scaled(pose, x, y, 1), material, SoftSide::kBoth);
    default:
      return;  // lines and labels
  }
}

SoftMesh* SoftScene::NextOwnMesh() {
  if (own_used_ == own_.capacity()) return nullptr;  // instances point into it
  if (own_used_ == own_.size()) own_.emplace_back();
  return &own_[own_used_++];
}

void SoftScene::AddSkin(const mjModel* m, const mjvScene& list, const mjvGeom& geom,
                        const SoftMaterial& material) {
  SoftMesh* mesh = NextOwnMesh();
  if (!mesh) return;
  const int skin = geom.objid, first = list.skinvertadr[skin], texture = m->skin_texcoordadr[skin];
  for (int v = 0; v < list.skinvertnum[skin]; ++v) {
    builder_.Vertex(Eigen::Map<const Eigen::Vector3f>(list.skinvert + 3 * (first + v)));
  }
  for (int f = 0; f < list.skinfacenum[skin]; ++f) {
    const int* face = m->skin_face + 3 * (m->skin_faceadr[skin] + f);
    SoftCorner corners[3];
    for (int k = 0; k < 3; ++k) {
      corners[k] = {face[k],
                    Eigen::Map<const Eigen::Vector3f>(list.skinnormal + 3 * (first + face[k]))};
      if (texture >= 0) {
        corners[k].texture =
            Eigen::Map<const Eigen::Vector2f>(m->skin_texcoord + 2 * (texture + face[k]));
      }
    }
    builder_.Triangle(corners[0], corners[1], corners[2]);
  }
  builder_.Build(mesh, texture >= 0);
  bends_ = true;
  SoftMaterial own = material;
  if (own.mapping == SoftMapping::kMesh && mesh->texture.empty()) own.mapping = SoftMapping::kNone;
  AddMesh(mesh, Affine3d::Identity(), own);
}

void SoftScene::AddFlex(const mjvScene& list, const mjvGeom& geom, const SoftMaterial& material) {
  const int flex = geom.objid;
  const float radius = geom.size[0];
  SoftMaterial plain = material;
  plain.mapping = SoftMapping::kNone;
  const bool skinned = list.flexskinopt && list.flexfaceused[flex] > 0;
  const float* vertices = list.flexvert + 3 * list.flexvertadr[flex];
  const auto vertex = [&](int v) {
    return Vector3d(Eigen::Map<const Eigen::Vector3f>(vertices + 3 * v).cast<double>());
  };
  if (radius > 0 && list.flexvertopt && !skinned) {
    for (int v = 0; v < list.flexvertnum[flex]; ++v) {
      const Affine3d at(Eigen::Translation3d(vertex(v)));
      AddMesh(&assets_.shapes().sphere, Scaled(at, radius, radius, radius), plain);
    }
  }
  if (radius > 0 && list.flexedgeopt && !skinned) {
    for (int e = list.flexedgeadr[flex]; e < list.flexedgeadr[flex] + list.flexedgenum[flex]; ++e) {
      const Vector3d a = vertex(list.flexedge[2 * e]), b = vertex(list.flexedge[2 * e + 1]);
      const Affine3d middle(Eigen::Translation3d(0.5 * (a + b)));
      const Vector3d along = b - a;
      double to_along[4];  // Eigen's decomposes a matrix: seconds to compile
      mju_quatZ2Vec(to_along, along.data());
      const Eigen::Quaterniond turn(to_along[0], to_along[1], to_along[2], to_along[3]);
      AddMesh(&assets_.shapes().open_cylinder,
              Scaled(middle * turn, radius, radius, 0.5 * (b - a).norm()), plain);
    }
  }
  if (list.flexfaceused[flex] <= 0) return;
  SoftMesh* mesh = NextOwnMesh();
  if (!mesh) return;
  const bool sliced = geom.dataid >= 0;  // true for slices by material
  const int begin = sliced ? static_cast<int>(geom.size[1]) : 0;
  const int end = sliced ? begin + static_cast<int>(geom.size[2]) : list.flexfaceused[flex];
  const bool textured = material.mapping == SoftMapping::kMesh;
  for (int f = list.flexfaceadr[flex] + begin; f < list.flexfaceadr[flex] + end; ++f) {
    SoftCorner corners[3];
    for (int k = 0; k < 3; ++k) {
      corners[k] = {
          builder_.Vertex(Eigen::Map<const Eigen::Vector3f>(list.flexface + 9 * f + 3 * k)),
          Eigen::Map<const Eigen::Vector3f>(list.flexnormal + 9 * f + 3 * k)};
      if (textured) {
        corners[k].texture = Eigen::Map<const Eigen::Vector2f>(list.flextexcoord + 6 * f + 2 * k);
      }
    }
    builder_.Triangle(corners[0], corners[1], corners[2]);
  }
  builder_.Build(mesh, textured);
  bends_ = true;
  AddMesh(mesh, Affine3d::Identity(), material);
}

}  // namespace robocell::internal
