#include "robocell/mujoco/finite.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace robocell {
namespace {

struct NumberField {
  const char* name;  // as MJCF has it
  mjtObj kind;
  const mjtNum* numbers;
  mjtSize rows;
  int per_row;
  const int* owners = nullptr;  // of the rows, unless they are the elements
};

std::string ProblemIn(const mjModel* m, const NumberField& field) {
  const auto finite = [](mjtNum number) { return std::isfinite(number); };
  const mjtNum* end = field.numbers + field.rows * field.per_row;
  const mjtNum* bad = std::find_if_not(field.numbers, end, finite);
  if (bad == end) return "";
  const auto row = static_cast<int>((bad - field.numbers) / field.per_row);
  const int id = field.owners ? field.owners[row] : row;
  const char* name = mj_id2name(m, field.kind, id);
  const std::span<const mjtNum> numbers(field.numbers + row * field.per_row, field.per_row);
  return fmt::format(
      "Error: {} is {}; it must be finite. Correct it there\nElement name '{}', id {}", field.name,
      fmt::join(numbers, " "), name ? name : "", id);
}

}  // namespace

std::string NonFiniteElement(const mjModel* m) {
  const NumberField fields[] = {
      {"pos", mjOBJ_BODY, m->body_pos, m->nbody, 3},
      {"the orientation", mjOBJ_BODY, m->body_quat, m->nbody, 4},
      {"mass", mjOBJ_BODY, m->body_mass, m->nbody, 1},
      {"the pos of its inertia", mjOBJ_BODY, m->body_ipos, m->nbody, 3},
      {"the orientation of its inertia", mjOBJ_BODY, m->body_iquat, m->nbody, 4},
      {"its inertia", mjOBJ_BODY, m->body_inertia, m->nbody, 3},
      {"gravcomp", mjOBJ_BODY, m->body_gravcomp, m->nbody, 1},
      {"pos", mjOBJ_JOINT, m->jnt_pos, m->njnt, 3},
      {"axis", mjOBJ_JOINT, m->jnt_axis, m->njnt, 3},
      {"stiffness", mjOBJ_JOINT, m->jnt_stiffness, m->njnt, 1},
      {"damping", mjOBJ_JOINT, m->dof_damping, m->nv, 1, m->dof_jntid},
      {"armature", mjOBJ_JOINT, m->dof_armature, m->nv, 1, m->dof_jntid},
      {"frictionloss", mjOBJ_JOINT, m->dof_frictionloss, m->nv, 1, m->dof_jntid},
      {"size", mjOBJ_GEOM, m->geom_size, m->ngeom, 3},
      {"pos", mjOBJ_GEOM, m->geom_pos, m->ngeom, 3},
      {"the orientation", mjOBJ_GEOM, m->geom_quat, m->ngeom, 4},
      {"friction", mjOBJ_GEOM, m->geom_friction, m->ngeom, 3},
      {"margin", mjOBJ_GEOM, m->geom_margin, m->ngeom, 1},
      {"pos", mjOBJ_SITE, m->site_pos, m->nsite, 3},
      {"the orientation", mjOBJ_SITE, m->site_quat, m->nsite, 4},
      {"size", mjOBJ_SITE, m->site_size, m->nsite, 3},
      {"pos", mjOBJ_CAMERA, m->cam_pos, m->ncam, 3},
      {"the orientation", mjOBJ_CAMERA, m->cam_quat, m->ncam, 4},
      {"stiffness", mjOBJ_TENDON, m->tendon_stiffness, m->ntendon, 1},
      {"damping", mjOBJ_TENDON, m->tendon_damping, m->ntendon, 1},
      {"its gain", mjOBJ_ACTUATOR, m->actuator_gainprm, m->nactuator, mjNGAIN},
      {"its bias", mjOBJ_ACTUATOR, m->actuator_biasprm, m->nactuator, mjNBIAS},
  };
  for (const NumberField& field : fields) {
    if (std::string problem = ProblemIn(m, field); !problem.empty()) return problem;
  }
  return "";
}

}  // namespace robocell
