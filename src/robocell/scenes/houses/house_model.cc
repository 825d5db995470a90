#include "robocell/scenes/houses/house_model.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scenes/houses/house_textures.h"
#include "robocell/spec/types.h"

namespace robocell::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFloorThickness = 0.1, kFrame = 0.05, kLeafThickness = 0.04, kLeafGap = 0.01;
constexpr double kTimestep = 0.002;
constexpr int kSettleSteps = 200, kMostLooks = 8;  // a look every kSettleSteps
constexpr double kRest = 0.003, kRestTurn = 0.05;  // m/s and rad/s of an object at rest
constexpr double kMostDrift = 0.03;                // metres, while it settles
constexpr double kMostPenetration = 0.0008;        // metres

const char* ClassName(PartClass part_class) {
  switch (part_class) {
    case PartClass::kStructure:
      return "__STRUCTURAL_MJT__";
    case PartClass::kWall:
      return "__STRUCTURAL_WALL_MJT__";
    case PartClass::kArticulated:
      return "__ARTICULABLE_DYNAMIC_MJT__";
    case PartClass::kObject:
      return "__DYNAMIC_MJT__";
    case PartClass::kVisual:
      break;
  }
  return "__VISUAL_MJT__";
}

mjtGeom TypeOf(PartShape shape) {
  switch (shape) {
    case PartShape::kBox:
      return mjGEOM_BOX;
    case PartShape::kCylinder:
      return mjGEOM_CYLINDER;
    case PartShape::kSphere:
      return mjGEOM_SPHERE;
    case PartShape::kCapsule:
      return mjGEOM_CAPSULE;
    case PartShape::kEllipsoid:
      break;
  }
  return mjGEOM_ELLIPSOID;
}

void SetQuat(double quat[4], double yaw) {
  const double axis[3] = {0, 0, 1};
  mju_axisAngle2Quat(quat, axis, yaw);
}

// Writes a house into a spec.
class Writer {
 public:
  Writer(const FurnishedHouse& house, const std::string& name, const std::filesystem::path& folder,
         bool ceiling)
      : house_(house), ceiling_(ceiling), spec_(MakeSpec()) {
    mjs_setString(spec_->modelname, name.c_str());
    mjs_setString(spec_->modelfiledir, folder.string().c_str());
    mjs_setString(spec_->compiler.texturedir, kTextureFolder);
    mjs_setString(spec_->compiler.meshdir, kTextureFolder);
    spec_->option.timestep = kTimestep;
    world_ = mjs_findBody(spec_.get(), "world");
    AddClasses();
    AddLook();
  }

  SpecPtr Done() {
    AddRooms();
    AddWalls();
    for (const HousePiece& piece : house_.pieces) AddBody(world_, piece.thing.body);
    for (const HousePiece& object : house_.objects) AddBody(world_, object.thing.body);
    AddSlotSites();
    return std::move(spec_);
  }

 private:
  // The masks of contacts are those of the original houses: structure and articulated parts do not
  // touch each other, objects and robots touch both.
  void AddClasses() {
    const auto add = [&](PartClass part_class, int contype, int conaffinity) {
      mjsDefault* added = mjs_addDefault(spec_.get(), ClassName(part_class), nullptr);
      added->geom->contype = contype;
      added->geom->conaffinity = conaffinity;
      added->geom->friction[0] = 0.9;
      added->geom->friction[1] = 0.02;
      added->geom->friction[2] = 0.001;
      return added;
    };
    add(PartClass::kStructure, 8, 15);
    add(PartClass::kWall, 8, 15);
    add(PartClass::kArticulated, 0, 7);
    add(PartClass::kVisual, 0, 0);
    mjsDefault* object = add(PartClass::kObject, 15, 15);
    object->geom->condim = 6;
    object->geom->friction[2] = 0.002;
  }
  void AddLook() {
    for (const HouseTexture& texture : HouseTextures()) {
      mjsTexture* added = mjs_addTexture(spec_.get(), nullptr);
      mjs_setName(added->element, texture.name.c_str());
      added->type = mjTEXTURE_2D;
      mjs_setString(added->file, (texture.name + ".png").c_str());
    }
    mjsTexture* sky = mjs_addTexture(spec_.get(), nullptr);
    mjs_setName(sky->element, "sky");
    sky->type = mjTEXTURE_SKYBOX;
    sky->builtin = mjBUILTIN_GRADIENT;
    sky->width = 64;
    sky->height = 384;
    const double high[3] = {0.62, 0.76, 0.92}, low[3] = {0.93, 0.95, 0.97};
    std::copy_n(high, 3, sky->rgb1);
    std::copy_n(low, 3, sky->rgb2);
    for (const HouseMaterial& material : HouseMaterials()) {
      mjsMaterial* added = mjs_addMaterial(spec_.get(), nullptr);
      mjs_setName(added->element, material.name);
      std::copy_n(material.rgba, 4, added->rgba);
      added->specular = material.specular;
      added->shininess = material.shininess;
      added->emission = material.emission;
      if (*material.texture == 0) continue;
      mjs_setInStringVec(added->textures, mjTEXROLE_RGB, material.texture);
      added->texuniform = 1;
      added->texrepeat[0] = added->texrepeat[1] = material.repeat;
    }
    mjVisual& visual = spec_->visual;
    for (int i = 0; i < 3; ++i) {
      visual.headlight.ambient[i] = 0.4F;
      visual.headlight.diffuse[i] = 0.14F;
      visual.headlight.specular[i] = 0.05F;
    }
    visual.quality.shadowsize = 2048;
    visual.map.znear = 0.01F;
  }

  static Vector3d Position(const Vector2d& at, double z) { return {at.x(), at.y(), z}; }

  mjsGeom* AddPart(mjsBody* body, const HousePart& part, PartClass part_class) {
    mjsDefault* of_class = mjs_findDefault(spec_.get(), ClassName(part_class));
    mjsGeom* geom = mjs_addGeom(body, of_class);
    if (!part.name.empty()) mjs_setName(geom->element, part.name.c_str());
    geom->type = TypeOf(part.shape);
    std::copy_n(part.pos.data(), 3, geom->pos);
    std::copy_n(part.half.data(), 3, geom->size);
    if (!part.axis.isApprox(Vector3d::UnitZ()))
      mju_quatZ2Vec(geom->quat, part.axis.data());
    else
      SetQuat(geom->quat, part.yaw);
    mjs_setString(geom->material, part.material.c_str());
    geom->density = part_class == PartClass::kVisual ? 0 : part.density;
    return geom;
  }
  mjsBody* AddNamedBody(mjsBody* parent, const std::string& name, const Vector3d& pos, double yaw) {
    mjsBody* body = mjs_addBody(parent, nullptr);
    mjs_setName(body->element, name.c_str());
    std::copy_n(pos.data(), 3, body->pos);
    SetQuat(body->quat, yaw);
    return body;
  }
  void AddBody(mjsBody* parent, const HouseBody& body) {
    mjsBody* added = AddNamedBody(parent, body.name, body.pos, body.yaw);
    if (body.is_free) {
      mjsJoint* joint = mjs_addFreeJoint(added);
      mjs_setName(joint->element, (body.name + "_joint").c_str());
    }
    if (body.joint) {
      mjsJoint* joint = mjs_addJoint(added, nullptr);
      mjs_setName(joint->element, body.joint->name.c_str());
      joint->type = body.joint->is_slide ? mjJNT_SLIDE : mjJNT_HINGE;
      std::copy_n(body.joint->axis.data(), 3, joint->axis);
      joint->range[0] = 0;
      joint->range[1] = body.joint->range;
      joint->limited = mjLIMITED_TRUE;
      joint->damping[0] = body.joint->damping;
      joint->frictionloss = body.joint->friction;
      joint->armature = 0.005;
    }
    for (const HousePart& part : body.parts) {
      const bool moves = body.joint && part.part_class == PartClass::kStructure;
      AddPart(added, part, moves ? PartClass::kArticulated : part.part_class);
    }
    for (const HouseBody& child : body.children) AddBody(added, child);
  }

  void AddRooms() {
    static constexpr std::array kFloors = {std::pair{RoomKind::kKitchen, "floor_tile"},
                                           std::pair{RoomKind::kLiving, "floor_wood"},
                                           std::pair{RoomKind::kBedroom, "floor_wood"},
                                           std::pair{RoomKind::kOffice, "floor_carpet"},
                                           std::pair{RoomKind::kWorkshop, "floor_concrete"},
                                           std::pair{RoomKind::kWarehouse, "floor_concrete"}};
    for (const PlanRoom& room : house_.plan.rooms) {
      const char* material = "floor_wood";
      for (const auto& [kind, name] : kFloors) {
        if (kind == room.kind) material = name;
      }
      const Vector2d middle = room.outer.center(), half = room.outer.sizes() / 2;
      mjsBody* body = AddNamedBody(world_, room.name, Position(middle, 0), 0);
      HousePart floor =
          Box({0, 0, -kFloorThickness / 2}, {half.x(), half.y(), kFloorThickness / 2}, material);
      floor.name = room.name + "_floor";
      AddPart(body, floor, PartClass::kStructure);
      if (ceiling_) {
        HousePart ceiling = Box({0, 0, kWallHeight + 0.05}, {half.x(), half.y(), 0.05}, "ceiling");
        ceiling.name = room.name + "_ceiling";
        AddPart(body, ceiling, PartClass::kStructure)->castshadow = 0;
      }
      AddLight(room.name + "_light", middle);
    }
  }
  void AddLight(const std::string& name, const Vector2d& middle) {
    mjsLight* light = mjs_addLight(world_, nullptr);
    mjs_setName(light->element, name.c_str());
    const double pos[3] = {middle.x(), middle.y(), kWallHeight - 0.06}, down[3] = {0, 0, -1};
    std::copy_n(pos, 3, light->pos);
    std::copy_n(down, 3, light->dir);
    light->type = mjLIGHT_SPOT;
    light->castshadow = 1;
    light->cutoff = 80;  // walls are lit up to their upper part, where the light fades
    light->exponent = 1.5F;
    const float attenuation[3] = {0.7F, 0.05F, 0.03F};
    const float diffuse[3] = {0.6F, 0.58F, 0.55F};
    std::copy_n(attenuation, 3, light->attenuation);
    std::copy_n(diffuse, 3, light->diffuse);
    for (float& value : light->specular) value = 0.12F;
    for (float& value : light->ambient) value = 0;
  }

  // A part of a wall, from one distance to another and from one height to another.
  void AddWallPart(mjsBody* body, double from, double to, double low, double high,
                   double half_thickness, const std::string& material, const std::string& name) {
    if (to - from < 1e-4 || high - low < 1e-4) return;
    const double half = (to - from) / 2;
    HousePart part = Box({(from + to) / 2, 0, (low + high) / 2},
                         {half, half_thickness, (high - low) / 2}, material);
    part.name = name;
    AddPart(body, part, PartClass::kWall);
  }
  // The frame of a wall has its x along the wall and starts where the wall starts.
  void AddWalls() {
    int number = 0;
    for (const PlanWall& wall : house_.plan.walls) {
      const std::string name =
          fmt::format("wall_{}_0_{}", ++number, std::max(wall.below, wall.above) + 1);
      const double yaw = wall.along_x ? 0 : kPi / 2;
      mjsBody* body = AddNamedBody(world_, name, Position(wall.start, 0), yaw);
      // Walls reach over their ends, so that corners are closed.
      double at = -kWallThickness / 2;
      int part = 0;
      const auto next = [&] { return fmt::format("{}_part_{}", name, part++); };
      const double half = kWallThickness / 2;
      std::vector<PlanOpening> openings = wall.openings;
      std::ranges::sort(openings, {}, &PlanOpening::at);
      for (const PlanOpening& opening : openings) {
        const double from = opening.at - opening.width / 2, to = opening.at + opening.width / 2;
        AddWallPart(body, at, from, 0, kWallHeight, half, "wall", next());
        const double head = opening.is_door ? kDoorHeight : kWindowHead;
        AddWallPart(body, from, to, head, kWallHeight, half, "wall", next());
        if (opening.is_door)
          AddDoor(wall, opening);
        else
          AddWindow(body, opening, name, next);
        at = to;
      }
      AddWallPart(body, at, wall.length + kWallThickness / 2, 0, kWallHeight, half, "wall", next());
    }
  }
  template <class Next>
  void AddWindow(mjsBody* body, const PlanOpening& opening, const std::string& name, Next&& next) {
    const double from = opening.at - opening.width / 2, to = opening.at + opening.width / 2;
    const double half = kWallThickness / 2;
    AddWallPart(body, from, to, 0, kWindowSill, half, "wall", next());
    const double slim = 0.03;
    AddWallPart(body, from, from + kFrame, kWindowSill, kWindowHead, slim, "frame", next());
    AddWallPart(body, to - kFrame, to, kWindowSill, kWindowHead, slim, "frame", next());
    AddWallPart(body, from + kFrame, to - kFrame, kWindowSill, kWindowSill + kFrame, slim, "frame",
                next());
    AddWallPart(body, from + kFrame, to - kFrame, kWindowHead - kFrame, kWindowHead, slim, "frame",
                next());
    AddWallPart(body, opening.at - kFrame / 2, opening.at + kFrame / 2, kWindowSill + kFrame,
                kWindowHead - kFrame, slim, "frame", next());
    const std::string panes[2] = {name + "_pane_left", name + "_pane_right"};
    AddWallPart(body, from + kFrame, opening.at - kFrame / 2, kWindowSill + kFrame,
                kWindowHead - kFrame, 0.005, "glass", panes[0]);
    AddWallPart(body, opening.at + kFrame / 2, to - kFrame, kWindowSill + kFrame,
                kWindowHead - kFrame, 0.005, "glass", panes[1]);
  }
  void AddDoor(const PlanWall& wall, const PlanOpening& opening) {
    const std::string& name = opening.name;
    const double yaw = wall.along_x ? 0 : kPi / 2;
    mjsBody* frame = AddNamedBody(world_, name, Position(wall.at(opening.at), 0), yaw);
    // Above a wall along y lies smaller x in the wall's own frame: its y points to -x.
    const double side = (opening.opens_up ? 1 : -1) * (wall.along_x ? 1 : -1);
    const double hinge = opening.hinge_at_start ? -1 : 1;
    const double width = opening.width - 2 * kLeafGap, height = kDoorHeight - 2 * kLeafGap;
    const double inner = kWallThickness / 2 - kLeafThickness;  // of the leaf's nearer face
    mjsBody* leaf = AddNamedBody(
        frame, name + "_leaf",
        {hinge * width / 2, side * (inner + kLeafThickness / 2), kLeafGap + height / 2}, 0);
    mjsJoint* joint = mjs_addJoint(leaf, nullptr);
    mjs_setName(joint->element, (name + "_hinge").c_str());
    joint->type = mjJNT_HINGE;
    const double axis[3] = {0, 0, -hinge * side};
    std::copy_n(axis, 3, joint->axis);
    joint->pos[1] = side * kLeafThickness / 2;
    joint->range[1] = 1.6;
    joint->limited = mjLIMITED_TRUE;
    joint->damping[0] = 0.6;
    joint->frictionloss = 0.4;
    joint->armature = 0.02;
    const auto add = [&](HousePart part, const std::string& suffix) {
      part.name = name + suffix;
      part.density = 250;
      AddPart(leaf, part, PartClass::kArticulated);
    };
    add(Box({-hinge * width / 2, 0, 0}, {width / 2, kLeafThickness / 2, height / 2}, "door"),
        "_panel");
    const double x = -hinge * (width - 0.07), z = 1.02 - kLeafGap - height / 2;
    for (const double face : {-1.0, 1.0}) {
      const std::string suffix = face < 0 ? "_handle_back" : "_handle_front";
      add(Capsule({x, face * (kLeafThickness / 2 + 0.02), z}, 0.009, 0.02, "steel",
                  Vector3d::UnitY()),
          suffix + "_neck");
      add(Capsule({x + hinge * 0.05, face * (kLeafThickness / 2 + 0.045), z}, 0.01, 0.05, "steel",
                  Vector3d::UnitX()),
          suffix);
    }
  }
  void AddSlotSites() {
    std::map<std::string, int> counts;
    for (const FilledSlot& slot : house_.slots) {
      mjsBody* body = mjs_findBody(spec_.get(), slot.body.c_str());
      mjsSite* site = mjs_addSite(body, nullptr);
      mjs_setName(site->element, SlotSiteName(slot, counts[slot.body]++).c_str());
      site->type = mjGEOM_BOX;
      site->group = 4;
      const HouseSlot& space = slot.slot;
      const double size[3] = {space.half_x, space.half_y, space.height / 2};
      std::copy_n(size, 3, site->size);
      const Vector3d middle = space.pos + Vector3d(0, 0, space.height / 2);
      std::copy_n(middle.data(), 3, site->pos);
      const float rgba[4] = {0.2F, 0.6F, 1, 0.2F};
      std::copy_n(rgba, 4, site->rgba);
    }
  }

  const FurnishedHouse& house_;
  bool ceiling_;
  SpecPtr spec_;
  mjsBody* world_;
};

// Returns the objects that do not rest in their slots, by their numbers; `settled` gets the poses of
// all.
std::set<size_t> Unsettled(const FurnishedHouse& house, const mjModel* m, const mjData* d,
                           std::vector<Pose>& settled) {
  std::set<size_t> bad;
  std::vector<int> bodies;
  std::vector<int> object_of(static_cast<size_t>(m->nbody), -1);
  for (size_t i = 0; i < house.objects.size(); ++i) {
    const HouseBody& object = house.objects[i].thing.body;
    const int body = FindId(m, mjOBJ_BODY, object.name);
    object_of[static_cast<size_t>(body)] = static_cast<int>(i);
    const mjtNum* pos = d->xpos + 3 * body;
    settled.push_back(Pose::FromTranslationAndMatrix(pos, d->xmat + 9 * body));
    const mjtNum* v = d->qvel + m->body_dofadr[body];
    const double drift = (Vector3d(pos) - object.pos).norm();
    if (!(drift < kMostDrift) || !(mju_norm3(v) < kRest) || !(mju_norm3(v + 3) < kRestTurn))
      bad.insert(i);
  }
  for (int c = 0; c < d->ncon; ++c) {
    if (d->contact[c].dist > -kMostPenetration) continue;
    for (const int geom : d->contact[c].geom) {
      const int object = geom < 0 ? -1 : object_of[static_cast<size_t>(m->geom_bodyid[geom])];
      if (object >= 0) bad.insert(static_cast<size_t>(object));
    }
  }
  return bad;
}

// Writes rest poses into the spec's bodies.
void SetPoses(mjSpec* spec, const FurnishedHouse& house, const std::vector<Pose>& poses) {
  for (size_t i = 0; i < poses.size(); ++i) {
    mjsBody* body = mjs_findBody(spec, house.objects[i].thing.body.name.c_str());
    const Vector3d at = poses[i].translation();
    const Vec4 quat = poses[i].quaternion();  // xyzw
    std::copy_n(at.data(), 3, body->pos);
    body->quat[0] = quat[3];
    std::copy_n(quat.data(), 3, body->quat + 1);
  }
}

}  // namespace

std::string SlotSiteName(const FilledSlot& slot, int number) {
  return fmt::format("{}_{}_{}", slot.body, slot.slot.is_container ? "container" : "support",
                     number);
}

SettledHouse SettleHouse(FurnishedHouse house, const std::string& name,
                         const std::filesystem::path& folder) {
  const std::string context = "house '" + name + "'";
  SettledHouse out;
  std::vector<Pose> poses;
  // Each round removes an object at least.
  for (bool is_settled = false; !is_settled;) {
    const SpecPtr spec = Writer(house, name, folder, false).Done();
    const ModelPtr model = Compile(spec.get(), nullptr, context);
    const DataPtr data = MakeData(model.get());
    std::set<size_t> bad;
    for (int look = 0; look < kMostLooks; ++look) {
      Guarded(context, data.get(), [&] {
        for (int i = 0; i < kSettleSteps; ++i) mj_step(model.get(), data.get());
        mj_forward(model.get(), data.get());
      });
      poses.clear();
      bad = Unsettled(house, model.get(), data.get(), poses);
      if (bad.empty()) break;
    }
    is_settled = bad.empty();
    out.removed += static_cast<int>(bad.size());
    RemoveObjects(house, {bad.begin(), bad.end()});
  }
  for (const bool ceiling : {false, true}) {
    const SpecPtr spec = Writer(house, name, folder, ceiling).Done();
    SetPoses(spec.get(), house, poses);
    Compile(spec.get(), nullptr, context, nullptr, JacobianGuard::kOn);
    mjs_setString(spec->modelfiledir, "");
    (ceiling ? out.ceiling_xml : out.xml) = SaveXmlString(spec.get(), context);
  }
  out.house = std::move(house);
  return out;
}

}  // namespace robocell::internal
