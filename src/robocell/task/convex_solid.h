// The exact shapes of collision geoms for grasping: where lines enter and leave them, and which
// points are inside. A mesh counts as its convex hull, as it does for the engine's contacts.
//
//   const BodySolids solids(model, data, body_in_world, geoms);
//   for (const SolidSpan& span : solids.Through(point, direction)) ...   // solid from begin to end
#pragma once

#include <vector>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robocell/math/pose.h"
#include "robocell/mujoco/forward.h"

namespace robocell::internal {

// A part of a line that is inside, with the outward normals of the surface at its ends.
struct SolidSpan {
  double begin = 0, end = 0;  // coordinates along the line, m
  Eigen::Vector3d begin_normal, end_normal;
  int begin_geom = -1, end_geom = -1;  // ids of the geoms at the ends
};

// One convex geom in the frame of a body.
class ConvexSolid {
 public:
  // `frame`: the world pose of the frame that the solid is in. Unset for planes and height fields.
  static bool Supports(const mjModel* model, int geom);
  ConvexSolid(const mjModel* model, const mjData* data, int geom, const Pose& frame);

  // Returns true if the line enters the solid. `direction` has unit length.
  bool Through(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
               SolidSpan* span) const;
  // Returns true if the point is more than `depth` (m, 0 or more) inside.
  bool Contains(const Eigen::Vector3d& point, double depth) const;

  int geom() const { return geom_; }
  const Eigen::Vector3d& centre() const { return centre_; }  // of the bounding ball
  double radius() const { return radius_; }

 private:
  bool ThroughLocal(const Eigen::Vector3d& p, const Eigen::Vector3d& d, SolidSpan* span) const;
  bool ThroughPlanes(const Eigen::Vector3d& p, const Eigen::Vector3d& d, SolidSpan* span) const;
  bool ThroughCapsule(const Eigen::Vector3d& p, const Eigen::Vector3d& d, SolidSpan* span) const;
  bool ThroughCylinder(const Eigen::Vector3d& p, const Eigen::Vector3d& d, SolidSpan* span) const;

  int geom_ = -1, type_ = 0;
  Eigen::Vector3d size_ = Eigen::Vector3d::Zero(), centre_ = Eigen::Vector3d::Zero();
  double radius_ = 0;
  Eigen::Matrix3d axes_;    // of the geom in the frame
  Eigen::Vector3d origin_;  // of the geom in the frame
  // Hulls of meshes and boxes around other geoms: normal . x <= offset, in the geom's frame.
  Eigen::Matrix<double, Eigen::Dynamic, 3> normals_;
  Eigen::VectorXd offsets_;
};

// The union of several geoms.
class BodySolids {
 public:
  BodySolids() = default;
  BodySolids(const mjModel* model, const mjData* data, const Pose& frame,
             const std::vector<int>& geoms);

  const std::vector<ConvexSolid>& solids() const { return solids_; }
  bool empty() const { return solids_.empty(); }
  // Returns the parts of the line inside the union, by increasing coordinate. Parts that touch are
  // one.
  void Through(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
               std::vector<SolidSpan>* spans) const;
  std::vector<SolidSpan> Through(const Eigen::Vector3d& from,
                                 const Eigen::Vector3d& direction) const;
  bool Contains(const Eigen::Vector3d& point, double depth = 0) const;
  const Eigen::Vector3d& centre() const { return centre_; }  // of a ball around the union
  double radius() const { return radius_; }

 private:
  std::vector<ConvexSolid> solids_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double radius_ = 0;
};

}  // namespace robocell::internal
