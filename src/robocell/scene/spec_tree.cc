#include "robocell/scene/spec_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/mujoco/engine_exception.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

Pose ResolvedPose(const double pos[3], const double quat[4], const mjsOrientation& alt,
                  mjsElement* element) {
  std::array<double, 4> q = {quat[0], quat[1], quat[2], quat[3]};
  if (alt.type != mjORIENTATION_QUAT) {
    const mjsCompiler* compiler = mjs_getCompiler(element);
    const std::string sequence(compiler->eulerseq, 3);
    if (const char* error =
            mjs_resolveOrientation(q.data(), compiler->degree, sequence.c_str(), &alt)) {
      throw SpecError(fmt::format("orientation of '{}': {}", SpecName(element), error));
    }
  }
  mju_normalize4(q.data());
  return Pose::FromWxyz(pos, q.data());
}

}  // namespace

std::vector<mjsElement*> SpecElements(const mjSpec* spec, mjtObj kind) {
  std::vector<mjsElement*> elements;
  for (mjsElement* e = mjs_firstElement(spec, kind); e; e = mjs_nextElement(spec, e))
    elements.push_back(e);
  return elements;
}

std::string SpecName(mjsElement* element) { return mjs_getString(mjs_getName(element)); }

std::vector<std::string> SpecNames(const mjSpec* spec, mjtObj kind) {
  std::vector<std::string> names;
  for (mjsElement* element : SpecElements(spec, kind)) {
    if (std::string name = SpecName(element); !name.empty()) names.push_back(std::move(name));
  }
  return names;
}

std::string DescribeSpecElement(mjsElement* element) {
  const char* kind = KindName(element->elemtype);
  if (const std::string name = SpecName(element); !name.empty())
    return fmt::format("{} '{}'", kind, name);
  mjsBody* body = mjs_getParent(element);
  if (!body) return fmt::format("{} (unnamed)", kind);
  const std::vector<mjsElement*> all = BodyElements(body, element->elemtype);
  const auto index = std::find(all.begin(), all.end(), element) - all.begin();
  if (!mjs_getParent(body->element)) return fmt::format("{} {} (unnamed)", kind, index);
  return fmt::format("{} {} (unnamed, of {})", kind, index, DescribeSpecElement(body->element));
}

void SetSpecName(mjsElement* element, const std::string& name, const std::string& context) {
  if (Tried(context, [&] { return mjs_setName(element, name.c_str()); }) != 0) {
    throw SpecError(
        fmt::format("{}: there is a {} '{}' already", context, KindName(element->elemtype), name));
  }
}

std::vector<mjsElement*> BodyElements(mjsBody* body, mjtObj kind, bool whole_subtree) {
  std::vector<mjsElement*> elements;
  const int recurse = whole_subtree ? 1 : 0;
  for (mjsElement* e = mjs_firstChild(body, kind, recurse); e;
       e = mjs_nextChild(body, e, recurse)) {
    elements.push_back(e);
  }
  return elements;
}

mjsElement* FindSpecElement(const mjSpec* spec, mjtObj kind, const std::string& name) {
  if (name.empty()) return nullptr;
  if (kind == mjOBJ_FRAME) {
    mjsFrame* frame = mjs_findFrame(spec, name.c_str());
    return frame ? frame->element : nullptr;
  }
  return mjs_findElement(spec, kind, name.c_str());
}

mjtObj TargetKind(mjtTrn transmission) {
  switch (transmission) {
    case mjTRN_JOINT:
    case mjTRN_JOINTINPARENT:
      return mjOBJ_JOINT;
    case mjTRN_TENDON:
      return mjOBJ_TENDON;
    case mjTRN_SITE:
    case mjTRN_SLIDERCRANK:
      return mjOBJ_SITE;
    case mjTRN_BODY:
      return mjOBJ_BODY;
    default:
      return mjOBJ_UNKNOWN;
  }
}

mjsBody* WorldBody(mjSpec* spec) { return mjs_findBody(spec, "world"); }

Pose OwnPose(mjsElement* element) {
  switch (element->elemtype) {
    case mjOBJ_BODY: {
      const mjsBody* body = mjs_asBody(element);
      return ResolvedPose(body->pos, body->quat, body->alt, element);
    }
    case mjOBJ_FRAME: {
      const mjsFrame* frame = mjs_asFrame(element);
      return ResolvedPose(frame->pos, frame->quat, frame->alt, element);
    }
    case mjOBJ_SITE: {
      const mjsSite* site = mjs_asSite(element);
      if (!std::isnan(site->fromto[0])) {
        throw SpecError(
            fmt::format("site '{}' is written with fromto, which gives it no unique orientation; "
                        "attach to a site with pos and quat",
                        SpecName(element)));
      }
      return ResolvedPose(site->pos, site->quat, site->alt, element);
    }
    case mjOBJ_GEOM: {
      const mjsGeom* geom = mjs_asGeom(element);
      return ResolvedPose(geom->pos, geom->quat, geom->alt, element);
    }
    case mjOBJ_CAMERA: {
      const mjsCamera* camera = mjs_asCamera(element);
      return ResolvedPose(camera->pos, camera->quat, camera->alt, element);
    }
    default:
      throw Error("OwnPose: not a body, frame, site, geom or camera");
  }
}

Pose FramePoseInParent(mjsElement* element) {
  Pose pose;
  for (mjsFrame* frame = mjs_getFrame(element); frame; frame = mjs_getFrame(frame->element)) {
    pose = OwnPose(frame->element) * pose;
  }
  return pose;
}

Pose PoseInParent(mjsElement* element) { return FramePoseInParent(element) * OwnPose(element); }

Pose PoseInWorld(mjsElement* element) {
  Pose pose;
  for (mjsBody* parent = mjs_getParent(element); parent; parent = mjs_getParent(element)) {
    pose = PoseInParent(element) * pose;
    element = parent->element;
  }
  return pose;
}

mjsElement* FreeJointOf(mjsBody* body) {
  for (mjsElement* joint : BodyElements(body, mjOBJ_JOINT)) {
    if (mjs_asJoint(joint)->type == mjJNT_FREE) return joint;
  }
  return nullptr;
}

bool IsStatic(mjsBody* body) {
  for (; body; body = mjs_getParent(body->element)) {
    if (body->mocap || mjs_firstChild(body, mjOBJ_JOINT, 0)) return false;
  }
  return true;
}

mjsBody* TopBody(mjsBody* body) {
  for (mjsBody* parent = mjs_getParent(body->element); parent;
       parent = mjs_getParent(body->element)) {
    if (!mjs_getParent(parent->element)) return body;
    body = parent;
  }
  return body;
}

void AttachBody(mjsBody* parent, mjsBody* child, const Pose& pose, const std::string& prefix,
                const std::string& context) {
  mjSpec* spec = mjs_getSpec(parent->element);
  mjs_setDeepCopy(spec, 1);
  SetPose(child, pose);
  mjsFrame* frame = mjs_addFrame(parent, nullptr);
  const WarningCapture kept_in_spec;  // read after compiling
  if (!Tried(context,
             [&] { return mjs_attach(frame->element, child->element, prefix.c_str(), ""); })) {
    throw SpecError(context + ": " + mjs_getError(spec));
  }
}

}  // namespace robocell::internal
