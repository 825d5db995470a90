#include "robocell/scene/urdf_model.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <Eigen/Eigenvalues>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/math/pose.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/servo_proposal.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

constexpr int kVisualGroup = 2, kCollisionGroup = 3;  // as in the Menagerie

Pose PoseOf(const UrdfOrigin& origin) {
  return Pose::FromRpy(Eigen::Vector3d(origin.xyz.data()), Eigen::Vector3d(origin.rpy.data()));
}

void SetLine(mjString* info, int line) {
  mjs_setString(info, fmt::format("line {}", line).c_str());
}

bool IsFree(const std::string& name, const std::set<std::string>& taken) {
  return !name.empty() && !taken.contains(name);
}

std::string FreeName(const std::string& name, std::set<std::string>& taken) {
  std::string free = name;
  for (int i = 2; !IsFree(free, taken); ++i) free = fmt::format("{}_{}", name, i);
  taken.insert(free);
  return free;
}

// Starts with the file's sections for MuJoCo.
SpecPtr StartSpec(const Urdf& urdf) {
  SpecPtr spec;
  if (urdf.mujoco.empty()) {
    spec = MakeSpec();
  } else {
    try {
      spec = ParseXmlString(urdf.mujoco);
    } catch (const SpecError& error) {
      throw SpecError(
          fmt::format("{}: its <mujoco> element: {}", urdf.file.string(), error.what()));
    }
  }
  spec->compiler.degree = false;
  spec->compiler.fusestatic = false;
  spec->strippath = false;
  mjs_setString(spec->compiler.meshdir, "");  // its meshes have been found
  mjs_setString(spec->modelfiledir, urdf.file.parent_path().c_str());
  mjs_setString(spec->modelname, urdf.name.c_str());
  return spec;
}

class UrdfBuilder {
 public:
  explicit UrdfBuilder(const Urdf& urdf) : urdf_(urdf), spec_(StartSpec(urdf)) {
    for (const UrdfLink& link : urdf.links) {
      names_.insert(link.name);
      has_visuals_ |= std::any_of(link.geometry.begin(), link.geometry.end(),
                                  [](const UrdfGeometry& each) { return !each.collision; });
    }
    has_visuals_ &= !spec_->compiler.discardvisual;
  }

  SpecPtr Build() {
    AddLink(*urdf_.link(urdf_.root), WorldBody(spec_.get()));
    for (const UrdfJoint& joint : urdf_.joints) {
      if (joint.mimic) AddMimic(joint);
    }
    return std::move(spec_);
  }

 private:
  std::vector<const UrdfJoint*> JointsBelow(const UrdfLink& link) const {
    std::vector<const UrdfJoint*> found;
    for (const UrdfJoint& joint : urdf_.joints) {
      if (joint.parent == link.name) found.push_back(&joint);
    }
    return found;
  }

  // Returns true for a root link that only says where the robot is.
  bool IsWorld(const UrdfLink& link) const {
    const auto below = JointsBelow(link);
    if (link.name != urdf_.root || !link.is_bare() || below.size() != 1) return false;
    const UrdfJointType type = below[0]->type;
    return type == UrdfJointType::kFloating ||
           (link.name == "world" && type == UrdfJointType::kFixed);
  }

  void AddLink(const UrdfLink& link, mjsBody* parent) {
    if (IsWorld(link)) return AddChildren(link, parent);
    mjsBody* body = mjs_addBody(parent, nullptr);
    SetSpecName(body->element, BodyName(link.name), urdf_.file.string());
    SetLine(body->info, link.line);
    if (const UrdfJoint* joint = urdf_.parent_joint(link.name)) {
      SetPose(body, PoseOf(joint->origin));
      AddJoint(*joint, body);
    }
    AddInertial(link, body);
    for (const UrdfGeometry& geometry : link.geometry) {
      if (geometry.collision || has_visuals_) AddGeometry(link, geometry, body);
    }
    AddChildren(link, body);
  }

  void AddChildren(const UrdfLink& link, mjsBody* body) {
    for (const UrdfJoint* joint : JointsBelow(link)) AddLink(*urdf_.link(joint->child), body);
  }

  // `world` is the name of the engine's own.
  std::string BodyName(const std::string& link) {
    return link == "world" ? FreeName("world_link", names_) : link;
  }

  void AddJoint(const UrdfJoint& joint, mjsBody* body) {
    if (joint.type == UrdfJointType::kFixed) return;
    mjsJoint* out = mjs_addJoint(body, nullptr);
    SetSpecName(out->element, joint.name, urdf_.file.string());
    SetLine(out->info, joint.line);
    if (joint.type == UrdfJointType::kFloating) {
      out->type = mjJNT_FREE;
      return;
    }
    out->type = joint.type == UrdfJointType::kPrismatic ? mjJNT_SLIDE : mjJNT_HINGE;
    std::copy(joint.axis.begin(), joint.axis.end(), out->axis);
    out->limited = joint.range ? mjLIMITED_TRUE : mjLIMITED_FALSE;
    if (joint.range) std::copy(joint.range->begin(), joint.range->end(), out->range);
    out->damping[0] = joint.damping;
    out->frictionloss = joint.friction;
    if (joint.effort > 0) {
      out->actfrclimited = mjLIMITED_TRUE;
      out->actfrcrange[0] = -joint.effort;
      out->actfrcrange[1] = joint.effort;
    }
  }

  // The inertia is given in the axes of its origin.
  static void AddInertial(const UrdfLink& link, mjsBody* body) {
    if (!link.has_mass()) return;
    const UrdfInertial& given = *link.inertial;
    body->explicitinertial = true;
    body->mass = given.mass;
    PoseOf(given.origin).ToWxyz(body->ipos, body->iquat);
    const auto& i = given.inertia;
    // A point mass keeps the engine's default of no inertia.
    if (std::all_of(i.begin(), i.end(), [](double value) { return value == 0; })) return;
    Eigen::Matrix3d inertia;
    inertia << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
    // Largest first, as the engine sorts them; it rejects small moments that are not principal.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia);
    Eigen::Matrix3d axes = principal.eigenvectors().rowwise().reverse();
    if (axes.determinant() < 0) axes.col(2) *= -1;
    const Pose frame = PoseOf(given.origin) * Pose(Eigen::Vector3d::Zero(), axes);
    frame.ToWxyz(body->ipos, body->iquat);
    for (int k = 0; k < 3; ++k) body->inertia[k] = std::max(0.0, principal.eigenvalues()[2 - k]);
  }

  void AddGeometry(const UrdfLink& link, const UrdfGeometry& geometry, mjsBody* body) {
    mjsGeom* geom = mjs_addGeom(body, nullptr);
    SetLine(geom->info, geometry.line);
    if (IsFree(geometry.name, geom_names_)) {
      geom_names_.insert(geometry.name);
      SetSpecName(geom->element, geometry.name, urdf_.file.string());
    }
    SetPose(geom, PoseOf(geometry.origin));
    if (geometry.rgba) std::copy(geometry.rgba->begin(), geometry.rgba->end(), geom->rgba);
    if (geometry.collision) {
      geom->group = has_visuals_ ? kCollisionGroup : 0;
    } else {
      geom->group = kVisualGroup;
      geom->contype = geom->conaffinity = 0;
    }
    // A link without <inertial> that is fixed to one with it weighs nothing.
    const bool weighs = geometry.collision && !urdf_.IsWeighed(link);
    if (!weighs) geom->density = 0;
    const auto& size = geometry.size;
    switch (geometry.shape) {
      case UrdfShape::kBox:
        geom->type = mjGEOM_BOX;
        for (size_t i = 0; i < 3; ++i) geom->size[i] = size[i] / 2;
        break;
      case UrdfShape::kSphere:
        geom->type = mjGEOM_SPHERE;
        geom->size[0] = size[0];
        break;
      case UrdfShape::kCylinder:
      case UrdfShape::kCapsule:
        geom->type = geometry.shape == UrdfShape::kCapsule ? mjGEOM_CAPSULE : mjGEOM_CYLINDER;
        geom->size[0] = size[0];
        geom->size[1] = size[1] / 2;
        break;
      case UrdfShape::kMesh:
        geom->type = mjGEOM_MESH;
        mjs_setString(geom->meshname, MeshOf(geometry, weighs).c_str());
        break;
    }
  }

  // Returns the mesh of a file and a scale, which geoms share. Meshes that need not enclose a volume
  // are shells, which may be flat or open.
  std::string MeshOf(const UrdfGeometry& geometry, bool weighs) {
    const auto key = std::tuple{geometry.mesh, geometry.size, weighs};
    const auto found = meshes_.find(key);
    if (found != meshes_.end()) return found->second;
    const std::string name =
        FreeName(std::filesystem::path(geometry.mesh).stem().string(), mesh_names_);
    mjsMesh* mesh = mjs_addMesh(spec_.get(), nullptr);
    SetSpecName(mesh->element, name, urdf_.file.string());
    SetLine(mesh->info, geometry.line);
    mjs_setString(mesh->file, geometry.mesh.c_str());
    std::copy(geometry.size.begin(), geometry.size.end(), mesh->scale);
    if (!weighs) mesh->inertia = mjMESH_INERTIA_SHELL;
    return meshes_[key] = name;
  }

  // q = offset + multiplier * q of the leader.
  void AddMimic(const UrdfJoint& joint) {
    mjsEquality* equality = mjs_addEquality(spec_.get(), nullptr);
    SetSpecName(equality->element, joint.name + "_mimic", urdf_.file.string());
    SetLine(equality->info, joint.mimic->line);
    equality->type = mjEQ_JOINT;
    equality->objtype = mjOBJ_JOINT;
    mjs_setString(equality->name1, joint.name.c_str());
    mjs_setString(equality->name2, joint.mimic->joint.c_str());
    std::fill_n(equality->data, mjNEQDATA, 0.0);
    equality->data[0] = joint.mimic->offset;
    equality->data[1] = joint.mimic->multiplier;
    // Stiff, as gears are: the Menagerie's values for couplings.
    equality->solref[0] = 0.005;
    equality->solref[1] = 1;
    equality->solimp[0] = 0.95;
    equality->solimp[1] = 0.99;
  }

  const Urdf& urdf_;
  SpecPtr spec_;
  std::set<std::string> names_, geom_names_, mesh_names_;
  std::map<std::tuple<std::string, std::array<double, 3>, bool>, std::string> meshes_;
  bool has_visuals_ = false;
};

std::vector<const UrdfJoint*> JointsWithServo(const Urdf& urdf) {
  std::vector<const UrdfJoint*> joints;
  for (const UrdfJoint& joint : urdf.joints) {
    const bool moves =
        joint.type != UrdfJointType::kFixed && joint.type != UrdfJointType::kFloating;
    const bool rolls = joint.type == UrdfJointType::kContinuous && urdf.has_transmissions &&
                       !joint.has_transmission;
    if (moves && !joint.mimic && !rolls) joints.push_back(&joint);
  }
  return joints;
}

}  // namespace

SpecPtr MakeUrdfSpec(const Urdf& urdf) { return UrdfBuilder(urdf).Build(); }

std::vector<std::string> AddUrdfServos(const Urdf& urdf, mjSpec* spec) {
  const std::vector<const UrdfJoint*> joints = JointsWithServo(urdf);
  if (joints.empty()) return {};
  const SpecPtr copy = CopySpec(spec);  // compiling changes options
  const ModelPtr model = Compile(copy.get(), nullptr, urdf.file.string());
  std::vector<std::string> names;
  std::vector<ServoProposal> servos;
  for (const UrdfJoint* joint : joints) {
    names.push_back(joint->name);
    servos.push_back(ProposeServo(model.get(), FindId(model.get(), mjOBJ_JOINT, joint->name)));
  }
  for (size_t i = 0; i < joints.size(); ++i) AddServo(spec, names[i], servos[i]);
  return {
      fmt::format("a URDF has no actuators: position servos were made for {}, as stiff as the "
                  "inertia that they move needs, no stronger than `effort`. To tune them: "
                  "edits: [{{actuator: {}, kp: {:g}, kv: {:g}}}]",
                  ListNames(names), names[0], servos[0].kp, servos[0].kv)};
}

}  // namespace robocell::internal
