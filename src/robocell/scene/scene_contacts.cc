// Contacts of a Scene.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/scene_state.h"

namespace robocell {
namespace {

std::string GeomName(const mjModel* model, int geom) {
  std::string name = ElementName(model, mjOBJ_GEOM, geom);
  if (!name.empty()) return name;
  const int body = model->geom_bodyid[geom];
  return fmt::format("{}/geom#{}", ElementName(model, mjOBJ_BODY, body),
                     geom - model->body_geomadr[body]);
}

Eigen::Vector3d ForceOnSecond(const mjModel* model, const mjData* data, int contact) {
  mjtNum wrench[6];
  mj_contactForce(model, data, contact, wrench);
  const mjtNum* frame =
      data->contact[contact].frame;  // rows are the contact's axes, the first the normal
  Eigen::Vector3d force;
  for (int i = 0; i < 3; ++i)
    force[i] = frame[i] * wrench[0] + frame[3 + i] * wrench[1] + frame[6 + i] * wrench[2];
  return force;
}

}  // namespace

std::vector<Contact> Scene::contacts(const std::string& of) const {
  State& s = open();
  const mjModel* model = s.model();
  const mjData* data = s.data.data;
  const int top = of.empty() ? -1 : RequireId(model, mjOBJ_BODY, of, s.context);
  std::vector<Contact> out;
  for (int i = 0; i < data->ncon; ++i) {
    const mjContact& c = data->contact[i];
    if (c.exclude != 0 || c.geom[0] < 0 || c.geom[1] < 0) continue;
    const int body1 = model->geom_bodyid[c.geom[0]], body2 = model->geom_bodyid[c.geom[1]];
    if (top >= 0 && !internal::IsInSubtree(model, body1, top) &&
        !internal::IsInSubtree(model, body2, top))
      continue;
    out.push_back({GeomName(model, c.geom[0]),
                   GeomName(model, c.geom[1]),
                   ElementName(model, mjOBJ_BODY, body1),
                   ElementName(model, mjOBJ_BODY, body2),
                   c.dist,
                   {c.pos[0], c.pos[1], c.pos[2]},
                   ForceOnSecond(model, data, i)});
  }
  return out;
}

}  // namespace robocell
