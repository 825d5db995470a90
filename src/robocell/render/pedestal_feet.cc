#include "robocell/render/pedestal_feet.h"

#include <algorithm>
#include <string>

#include "robocell/mujoco/names.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {
namespace {

constexpr float kUpright = 0.999f;  // cosine
constexpr double kUnder = 1e-4;     // metres below the box, where the ray begins

bool IsPedestal(const mjModel* m, int geom) {
  const std::string name = ElementName(m, mjOBJ_GEOM, geom);
  if (m->geom_type[geom] != mjGEOM_BOX || !name.ends_with("pedestal")) return false;
  const std::string prefix = name.substr(0, name.size() - std::string("pedestal").size());
  const std::string body = ElementName(m, mjOBJ_BODY, m->geom_bodyid[geom]);
  return std::ranges::any_of(EnumNames<BaseKind>::kNames, [&](const auto& kind) {
    return body == prefix + kind.second + "_base";
  });
}

}  // namespace

PedestalFeet::PedestalFeet(const mjModel* model) {
  for (int g = 0; g < model->ngeom; ++g) {
    if (IsPedestal(model, g)) pedestals_.push_back(g);
  }
}

void PedestalFeet::ReachDown(const mjModel* model, const mjData* data, const mjvOption& option,
                             mjvScene* scene) const {
  if (pedestals_.empty()) return;
  for (int i = 0; i < scene->ngeom; ++i) {
    mjvGeom& geom = scene->geoms[i];
    if (geom.objtype != mjOBJ_GEOM || geom.mat[8] < kUpright ||
        std::ranges::find(pedestals_, geom.objid) == pedestals_.end())
      continue;
    const mjtNum down[3] = {0, 0, -1};
    const mjtNum from[3] = {geom.pos[0], geom.pos[1], geom.pos[2] - geom.size[2] - kUnder};
    int hit = -1;
    const mjtNum gap = mj_ray(model, data, from, down, option.geomgroup, 1,
                              model->geom_bodyid[geom.objid], &hit, nullptr);
    if (gap <= 0) continue;
    const float half = 0.5f * static_cast<float>(gap + kUnder);
    geom.size[2] += half;
    geom.pos[2] -= half;
  }
}

}  // namespace robocell::internal
