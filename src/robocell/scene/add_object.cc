#include "robocell/scene/add_object.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/mujoco/engine_exception.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

mjtGeom GeomType(Shape shape) {
  return shape == Shape::kBox      ? mjGEOM_BOX
         : shape == Shape::kSphere ? mjGEOM_SPHERE
                                   : mjGEOM_CYLINDER;
}

void AddPrimitiveGeom(const SceneObject& object, mjsBody* body, const std::string& context) {
  mjsGeom* geom = mjs_addGeom(body, nullptr);
  SetSpecName(geom->element, object.name + "_geom", context);
  geom->type = GeomType(*object.shape);
  for (int i = 0; i < 3; ++i) {
    geom->size[i] = (*object.size)[i];
    geom->friction[i] = (*object.friction)[i];
  }
  for (int i = 0; i < 4; ++i) geom->rgba[i] = static_cast<float>((*object.rgba)[i]);
  geom->mass = *object.mass;
  if (object.condim) geom->condim = static_cast<int>(*object.condim);
}

ObjectPart MakePrimitive(const SceneObject& object, const std::string& place) {
  ObjectPart out{{place, "", "", MakeSpec(), {}}, nullptr, "", {object.name, object.name, {}}};
  out.root = mjs_addBody(WorldBody(out.part.spec.get()), nullptr);
  SetSpecName(out.root->element, object.name, place);
  AddPrimitiveGeom(object, out.root, place);
  if (object.fixed.value_or(false)) return out;
  out.record.free_joint = object.name + "_joint";
  SetSpecName(mjs_addFreeJoint(out.root)->element, *out.record.free_joint, place);
  return out;
}

// Names an element without a name, so that the scene can find it.
std::string NameOr(mjsElement* element, const std::string& fallback, const std::string& context) {
  if (SpecName(element).empty()) SetSpecName(element, fallback, context);
  return SpecName(element);
}

// The first joint of the root that is no free joint; nullptr without one.
mjsElement* OtherJointOf(mjsBody* root) {
  for (mjsElement* joint : BodyElements(root, mjOBJ_JOINT)) {
    if (mjs_asJoint(joint)->type != mjJNT_FREE) return joint;
  }
  return nullptr;
}

// Returns why the root can be made neither free nor fixed.
std::string OwnJointText(mjsElement* joint) {
  const std::string name = SpecName(joint);
  return fmt::format(
      "its root body has {}, which it moves on, so that it can be neither fixed nor free; put a "
      "body without joints around it in its model, or leave `fixed` out",
      name.empty() ? "a joint" : "the joint '" + name + "'");
}

// Returns true for a mounted object, which keeps its own joints; only a free joint is removed.
bool MayKeepJoints(const SceneObject& object) {
  const AttachKind target = object.attach_to.kind;
  return object.fixed == true && target != AttachKind::kWorld && target != AttachKind::kRoot &&
         target != AttachKind::kSharedBase;
}

// Makes the root free or fixed as the object requires; unset: as authored.
void SettleFreeJoint(const SceneObject& object, ObjectPart& out, CompileLog& log) {
  mjsElement* joint = FreeJointOf(out.root);
  mjsElement* other = OtherJointOf(out.root);
  if (object.fixed && other && !MayKeepJoints(object))
    log.Problem(out.part.place, OwnJointText(other), "fixed");
  if (object.fixed == false && out.root->mocap) {
    log.Problem(out.part.place,
                "its root is a mocap body, which moves only where it is put; delete `mocap` in its "
                "model, or leave `fixed` out",
                "fixed");
  } else if (object.fixed == true && joint) {
    Tried(out.part.place, [&] { mjs_delete(out.part.spec.get(), joint); });
    joint = nullptr;
  } else if (object.fixed == false && !joint && !other) {
    joint = mjs_addFreeJoint(out.root)->element;
  }
  if (joint) out.record.free_joint = out.prefix + NameOr(joint, "joint", out.part.place);
}

}  // namespace

std::optional<ObjectPart> LoadObject(const SceneObject& object, const SceneSpec& scene,
                                     CompileLog& log) {
  const std::string place = "object '" + object.name + "'";
  if (object.shape) return MakePrimitive(object, place);
  auto part =
      LoadPart(object.mjcf_path, scene.source_dir, place, "mjcf_path", scene.options, "", log);
  if (!part) return std::nullopt;
  ObjectPart out{
      std::move(*part), nullptr, SceneObjectElementName(object.name, ""), {object.name, "", {}}};
  out.root = ChooseRoot(out.part, std::nullopt, log);
  if (!out.root) return std::nullopt;
  SettleFreeJoint(object, out, log);
  out.record.root_body = out.prefix + NameOr(out.root->element, "body", place);
  return out;
}

void AttachObject(const SceneObject& object, ObjectPart& loaded, const Placement& placement,
                  CompileLog& log) {
  Placement at = placement;
  if (object.parked && !loaded.record.free_joint) {
    mjsElement* own = OtherJointOf(loaded.root);
    log.Problem(
        loaded.part.place,
        std::string("parked: only what can move freely comes and goes without compiling; ") +
            (own ? OwnJointText(own) : "set fixed: false, or leave parked unset"),
        "parked");
    return;
  }
  if (loaded.record.free_joint) {
    const auto target = object.attach_to.kind;
    if (target != AttachKind::kWorld && target != AttachKind::kRoot &&
        target != AttachKind::kSharedBase) {
      log.Problem(loaded.part.place,
                  fmt::format("can move freely, so it cannot be attached to {}; attach it to "
                              "the world, or set fixed: true",
                              DescribeTarget(object.attach_to)),
                  "attach_to");
      return;
    }
  }
  const Pose authored = object.reset_root_pose ? Pose() : PoseInParent(loaded.root->element);
  AttachPart(at.parent, loaded.part, loaded.root, at.pose * authored, loaded.prefix, log);
  loaded.part.keys.PlaceFree(at.pose, FreeKeys::kNone);
}

}  // namespace robocell::internal
