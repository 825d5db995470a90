// For tests only: a model with one geom of every kind, about 10 cm large, and points on them.
#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/random_values.h"

namespace robocell::internal {

class ShapesModel {
 public:
  ShapesModel() {
    std::string vertices;
    Rng rng = Rng::Stream(5, "vertices");
    for (int k = 0; k < 60; ++k) {
      const Eigen::Vector3d v = 0.06 * RandomDirection(rng);
      for (int i = 0; i < 3; ++i) vertices += std::to_string(v[i]) + " ";
    }
    std::string heights;
    for (int k = 0; k < 36; ++k) heights += std::to_string(0.5 + 0.5 * std::sin(k)) + " ";
    const std::string path = folder_.Write("shapes", R"(
      <asset><mesh name="mesh" vertex=")" + vertices + R"("/>
        <hfield name="field" nrow="6" ncol="6" size="0.1 0.08 0.05 0.02" elevation=")" +
                                                         heights +
                                                         R"("/></asset>
      <worldbody>
        <geom name="ball" type="sphere" size="0.05" pos="0 0 1"/>
        <geom name="capsule" type="capsule" size="0.03 0.06" pos="1 0 1" euler="20 30 40"/>
        <geom name="box" type="box" size="0.03 0.05 0.07" pos="2 0 1" euler="20 30 40"/>
        <geom name="cylinder" type="cylinder" size="0.04 0.05" pos="3 0 1" euler="20 30 40"/>
        <geom name="ellipsoid" type="ellipsoid" size="0.03 0.05 0.07" pos="4 0 1" euler="20 30 40"/>
        <geom name="mesh" type="mesh" mesh="mesh" pos="5 0 1" euler="20 30 40"/>
        <geom name="field" type="hfield" hfield="field" pos="6 0 1"/>
      </worldbody>)");
    spec_.reset(mj_parseXML(path.c_str(), nullptr, nullptr, 0));
    model_ = Compile(spec_.get(), nullptr, "shapes");
    data_ = MakeData(model_.get());
    mj_forward(model_.get(), data_.get());
  }

  const mjModel* model() const { return model_.get(); }
  const mjData* data() const { return data_.get(); }
  int Geom(const std::string& name) const { return FindId(model(), mjOBJ_GEOM, name); }
  std::string Name(int geom) const { return ElementName(model(), mjOBJ_GEOM, geom); }

  // Returns points where rays from all sides meet a geom, in its frame.
  std::vector<Eigen::Vector3d> SurfacePoints(int geom, int rays, Rng& rng) const {
    std::vector<Eigen::Vector3d> points;
    const Eigen::Map<const Eigen::Vector3d> centre(data_->geom_xpos + 3 * geom);
    for (int k = 0; k < rays; ++k) {
      const Eigen::Vector3d aim = centre + RandomVector(rng, 0.05);
      const Eigen::Vector3d from = centre + 0.5 * RandomDirection(rng);
      const Eigen::Vector3d along = (aim - from).normalized();
      const double distance = RayToGeom(model(), data(), geom, from, along, nullptr);
      if (distance < 0) continue;
      const Eigen::Vector3d hit = from + distance * along - centre;
      Eigen::Vector3d local;
      mju_mulMatTVec3(local.data(), data_->geom_xmat + 9 * geom, hit.data());
      points.push_back(local);
    }
    return points;
  }

 private:
  ModelFolder folder_;
  SpecPtr spec_;
  ModelPtr model_;
  DataPtr data_;
};

}  // namespace robocell::internal
