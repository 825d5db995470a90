#include "robocell/render/view_cull.h"

#include <algorithm>
#include <array>
#include <Eigen/Geometry>

namespace robocell::internal {
namespace {

// The drawn corners are rounded to single precision: geoms this close to the view stay, metres.
constexpr double kMargin = 1e-3;

// A plane of the view: the points p inside, in the camera's axes, have normal . p + offset > 0.
struct Plane {
  Eigen::Vector3d normal;
  double offset;
};

// Returns the four edges of the image, half a pixel beyond the centres of its outermost pixels,
// then the clip planes. The camera looks along -z.
std::array<Plane, 6> PlanesOf(const CameraModel& camera) {
  const double left = -(camera.cx + 0.5) / camera.fx,
               right = (camera.width - 0.5 - camera.cx) / camera.fx;
  const double top = (camera.cy + 0.5) / camera.fy,
               bottom = -(camera.height - 0.5 - camera.cy) / camera.fy;
  std::array<Plane, 6> planes = {{{{1, 0, 0}, -left},
                                  {{-1, 0, 0}, right},
                                  {{0, 1, 0}, -bottom},
                                  {{0, -1, 0}, top},
                                  {{0, 0, -1}, -camera.near_m},
                                  {{0, 0, 1}, camera.far_m}}};
  if (camera.orthographic) return planes;
  for (int i = 0; i < 4; ++i) {  // the edges are those at a distance of one metre
    planes[i] = {planes[i].normal - planes[i].offset * Eigen::Vector3d::UnitZ(), 0};
  }
  return planes;
}

}  // namespace

ViewCull::ViewCull(const mjModel* model) {
  for (int mesh = 0; mesh < model->nmesh; ++mesh) meshes_.push_back(MeshBox(model, mesh));
}

ViewCull::Box ViewCull::MeshBox(const mjModel* model, int mesh) {
  const float* corners = model->mesh_vert + 3 * model->mesh_vertadr[mesh];
  const Eigen::Map<const Eigen::Matrix3Xf> all(corners, 3, model->mesh_vertnum[mesh]);
  if (all.cols() == 0) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  const Eigen::Vector3d least = all.rowwise().minCoeff().cast<double>();
  const Eigen::Vector3d most = all.rowwise().maxCoeff().cast<double>();
  return {0.5 * (least + most), 0.5 * (most - least)};
}

void ViewCull::DropUnseen(const CameraModel& camera, mjvScene* scene) const {
  mjvGeom* end = std::remove_if(scene->geoms, scene->geoms + scene->ngeom,
                                [&](const mjvGeom& geom) { return !MayBeSeen(camera, geom); });
  scene->ngeom = static_cast<int>(end - scene->geoms);
}

bool ViewCull::BoxOf(const mjvGeom& geom, Box& box) const {
  if (geom.objtype != mjOBJ_GEOM) return false;
  const Eigen::Vector3d size(geom.size[0], geom.size[1], geom.size[2]);
  switch (geom.type) {
    case mjGEOM_SPHERE:
    case mjGEOM_ELLIPSOID:
    case mjGEOM_CYLINDER:
    case mjGEOM_BOX:
      box = {Eigen::Vector3d::Zero(), size};
      return true;
    case mjGEOM_CAPSULE:
      box = {Eigen::Vector3d::Zero(), size + size[0] * Eigen::Vector3d::UnitZ()};
      return true;
    case mjGEOM_MESH: {
      const size_t mesh = static_cast<size_t>(geom.dataid) / 2;  // mesh of its faces or its hull
      if (geom.dataid < 0 || mesh >= meshes_.size()) return false;
      box = meshes_[mesh];
      return true;
    }
    default:
      return false;
  }
}

bool ViewCull::MayBeSeen(const CameraModel& camera, const mjvGeom& geom) const {
  Box box;
  if (!BoxOf(geom, box)) return true;
  using RowMajor = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  const Eigen::Matrix3d axes = Eigen::Map<const RowMajor>(geom.mat).cast<double>();
  const Eigen::Vector3d origin = Eigen::Map<const Eigen::Vector3f>(geom.pos).cast<double>();
  const Eigen::Matrix3d to_camera = camera.camera_in_world.rotation().transpose();
  const Eigen::Matrix3d turned = to_camera * axes;
  const Eigen::Vector3d centre =
      to_camera * (origin - camera.camera_in_world.translation()) + turned * box.centre;
  const auto planes = PlanesOf(camera);
  return std::all_of(planes.begin(), planes.end(), [&](const Plane& plane) {
    const double reach = (turned.transpose() * plane.normal).cwiseAbs().dot(box.half);
    return plane.normal.dot(centre) + plane.offset + reach > -kMargin * plane.normal.norm();
  });
}

}  // namespace robocell::internal
