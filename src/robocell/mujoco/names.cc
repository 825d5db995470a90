#include "robocell/mujoco/names.h"

#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/tree.h"

namespace robocell {
namespace {

std::vector<std::string> NamedOnly(std::vector<std::string> names) {
  std::erase(names, "");
  return names;
}

}  // namespace

const char* KindName(mjtObj kind) {
  if (kind == mjOBJ_XBODY) return "body";
  if (kind == mjOBJ_KEY) return "keyframe";
  const char* name = mju_type2Str(kind);
  return name && *name ? name : "element";
}

int ElementCount(const mjModel* model, mjtObj kind) {
  switch (kind) {
    case mjOBJ_BODY:
    case mjOBJ_XBODY:
      return static_cast<int>(model->nbody);
    case mjOBJ_JOINT:
      return static_cast<int>(model->njnt);
    case mjOBJ_DOF:
      return static_cast<int>(model->nv);
    case mjOBJ_GEOM:
      return static_cast<int>(model->ngeom);
    case mjOBJ_SITE:
      return static_cast<int>(model->nsite);
    case mjOBJ_CAMERA:
      return static_cast<int>(model->ncam);
    case mjOBJ_LIGHT:
      return static_cast<int>(model->nlight);
    case mjOBJ_FLEX:
      return static_cast<int>(model->nflex);
    case mjOBJ_MESH:
      return static_cast<int>(model->nmesh);
    case mjOBJ_SKIN:
      return static_cast<int>(model->nskin);
    case mjOBJ_HFIELD:
      return static_cast<int>(model->nhfield);
    case mjOBJ_TEXTURE:
      return static_cast<int>(model->ntex);
    case mjOBJ_MATERIAL:
      return static_cast<int>(model->nmat);
    case mjOBJ_PAIR:
      return static_cast<int>(model->npair);
    case mjOBJ_EXCLUDE:
      return static_cast<int>(model->nexclude);
    case mjOBJ_EQUALITY:
      return static_cast<int>(model->neq);
    case mjOBJ_TENDON:
      return static_cast<int>(model->ntendon);
    case mjOBJ_ACTUATOR:
      return static_cast<int>(model->nactuator);
    case mjOBJ_SENSOR:
      return static_cast<int>(model->nsensor);
    case mjOBJ_NUMERIC:
      return static_cast<int>(model->nnumeric);
    case mjOBJ_TEXT:
      return static_cast<int>(model->ntext);
    case mjOBJ_TUPLE:
      return static_cast<int>(model->ntuple);
    case mjOBJ_KEY:
      return static_cast<int>(model->nkey);
    case mjOBJ_PLUGIN:
      return static_cast<int>(model->nplugin);
    default:
      return 0;
  }
}

std::string ElementName(const mjModel* model, mjtObj kind, int id) {
  const char* name = mj_id2name(model, kind, id);
  return name ? name : "";
}

std::vector<std::string> ElementNames(const mjModel* model, mjtObj kind) {
  std::vector<std::string> names(ElementCount(model, kind));
  for (size_t id = 0; id < names.size(); ++id)
    names[id] = ElementName(model, kind, static_cast<int>(id));
  return names;
}

int FindId(const mjModel* model, mjtObj kind, std::string_view name) {
  if (name.empty()) return -1;
  return mj_name2id(model, kind, std::string(name).c_str());
}

int RequireId(const mjModel* model, mjtObj kind, std::string_view name, std::string_view place) {
  const int id = FindId(model, kind, name);
  if (id < 0) {
    throw NotFoundError(
        NoSuchName(place, KindName(kind), name, NamedOnly(ElementNames(model, kind))));
  }
  return id;
}

std::string Describe(const mjModel* model, mjtObj kind, int id) {
  const std::string name = ElementName(model, kind, id);
  if (!name.empty()) return std::string(KindName(kind)) + " '" + name + "'";
  const int body =
      kind == mjOBJ_BODY || kind == mjOBJ_XBODY ? -1 : internal::BodyOf(model, kind, id);
  std::string out = std::string(KindName(kind)) + " " + std::to_string(id) + " (unnamed";
  if (body >= 0) out += ", of " + Describe(model, mjOBJ_BODY, body);
  return out + ")";
}

}  // namespace robocell
