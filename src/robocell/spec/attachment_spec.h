// A tool, sensor or other model mounted on a robot (or on an earlier attachment of it).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

struct AttachmentSpec {
  std::string mjcf_path = {};
  AttachTarget attach_to = {};
  std::string prefix = {};
  Vec3 pos = {};
  Vec3 euler = {};
  Vec4 quat = kIdentityQuat;
  std::vector<std::array<std::string, 2>> contact_exclusions = {};
  bool reset_root_pose = false;

  static constexpr const char* kTypeName = "AttachmentSpec";
  template <class V>
  static void Fields(V&& v) {
    v("mjcf_path", &AttachmentSpec::mjcf_path,
      "Model file: path, `menagerie:...` or built-in name.");
    v("attach_to", &AttachmentSpec::attach_to,
      "Body, site or frame of the robot or of an earlier attachment, by its name without the "
      "robot's prefix.");
    v("prefix", &AttachmentSpec::prefix, "Prefix of every name of the attached model.");
    v("pos", &AttachmentSpec::pos, "Offset in the parent, metres.");
    v("euler", &AttachmentSpec::euler, "Rotation in the parent, degrees, extrinsic xyz.");
    v("quat", &AttachmentSpec::quat, "Rotation in the parent, quaternion xyzw; instead of euler.");
    v("contact_exclusions", &AttachmentSpec::contact_exclusions,
      "Pairs of bodies that do not collide, names without the robot's prefix.");
    v("reset_root_pose", &AttachmentSpec::reset_root_pose,
      "Drop the pose that the model file gives its root instead of composing with it.");
  }
  Pose pose() const { return PlacementPose(pos, euler, quat); }
  // Names it by its prefix, else by its file, as scenes do.
  std::string Label() const { return LabelOf("attachment", prefix.empty() ? mjcf_path : prefix); }
  void Validate(Problems& problems) const;
};

// Adds a problem at attachments[i] if an earlier one has the same model at the same place or under
// the same prefix.
void ValidateAttachments(const List<AttachmentSpec>& attachments, Problems& problems);

}  // namespace robocell
