#include "robocell/spec/types.h"

#include "robocell/base/units.h"

namespace robocell {

Pose PlacementPose(const Vec3& pos, const Vec3& euler, const Vec4& quat) {
  if (quat != kIdentityQuat) return Pose(ToEigen(pos), quat);
  return Pose::FromRpy(ToEigen(pos), {internal::Radians(euler[0]), internal::Radians(euler[1]),
                                      internal::Radians(euler[2])});
}

}  // namespace robocell
