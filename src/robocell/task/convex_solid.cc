#include "robocell/task/convex_solid.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robocell/motion/convex_shape.h"
#include "robocell/task/geometry_text.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kParallel = 1e-12;
constexpr double kTouching = 1e-7;  // m between parts of a line that count as one

}  // namespace

bool ConvexSolid::Supports(const mjModel* m, int geom) {
  return m->geom_type[geom] != mjGEOM_PLANE && m->geom_type[geom] != mjGEOM_HFIELD;
}

ConvexSolid::ConvexSolid(const mjModel* m, const mjData* d, int geom, const Pose& frame)
    : geom_(geom), type_(m->geom_type[geom]), size_(m->geom_size + 3 * geom) {
  const Pose in_frame =
      RoundedPose(frame.inverse() *
                  Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * geom, d->geom_xmat + 9 * geom));
  axes_ = in_frame.rotation();
  origin_ = in_frame.translation();
  const double* box = m->geom_aabb + 6 * geom;
  centre_ = in_frame * Vector3d(box);
  radius_ = Vector3d(box + 3).norm();
  if (type_ == mjGEOM_SPHERE) radius_ = size_[0];
  if (type_ == mjGEOM_CAPSULE) radius_ = size_[0] + size_[1];
  if (type_ == mjGEOM_SPHERE || type_ == mjGEOM_CAPSULE || type_ == mjGEOM_CYLINDER ||
      type_ == mjGEOM_ELLIPSOID || type_ == mjGEOM_BOX)
    return;
  const ConvexShape hull = ConvexShapesOf(m, geom, std::numeric_limits<int>::max()).front();
  normals_.resize(static_cast<Eigen::Index>(hull.planes.size()), 3);
  offsets_.resize(normals_.rows());
  for (Eigen::Index i = 0; i < normals_.rows(); ++i) {
    normals_.row(i) = hull.planes[static_cast<size_t>(i)].normal.transpose();
    offsets_[i] = hull.planes[static_cast<size_t>(i)].offset;
  }
}

bool ConvexSolid::Through(const Vector3d& from, const Vector3d& direction, SolidSpan* span) const {
  const Vector3d to = centre_ - from;
  const double along = to.dot(direction);
  if (to.squaredNorm() - along * along > (radius_ + kTouching) * (radius_ + kTouching))
    return false;
  const Vector3d p = axes_.transpose() * (from - origin_), d = axes_.transpose() * direction;
  if (!ThroughLocal(p, d, span)) return false;
  span->begin_normal = axes_ * span->begin_normal;
  span->end_normal = axes_ * span->end_normal;
  span->begin_geom = span->end_geom = geom_;
  return true;
}

bool ConvexSolid::ThroughLocal(const Vector3d& p, const Vector3d& d, SolidSpan* span) const {
  switch (type_) {
    case mjGEOM_SPHERE:
    case mjGEOM_CAPSULE:
      return ThroughCapsule(p, d, span);
    case mjGEOM_CYLINDER:
      return ThroughCylinder(p, d, span);
    case mjGEOM_ELLIPSOID: {  // a unit ball after scaling
      const Vector3d q = p.cwiseQuotient(size_), e = d.cwiseQuotient(size_);
      const double a = e.squaredNorm(), b = q.dot(e), c = q.squaredNorm() - 1;
      const double root = b * b - a * c;
      if (root <= 0) return false;
      const auto normal = [&](double t) {
        return (p + t * d).cwiseQuotient(size_.cwiseAbs2()).normalized().eval();
      };
      span->begin = (-b - std::sqrt(root)) / a;
      span->end = (-b + std::sqrt(root)) / a;
      span->begin_normal = normal(span->begin);
      span->end_normal = normal(span->end);
      return true;
    }
    case mjGEOM_BOX: {
      double begin = -kInfinity, end = kInfinity;
      int first = 0, last = 0;
      for (int i = 0; i < 3; ++i) {
        if (std::abs(d[i]) < kParallel) {
          if (std::abs(p[i]) >= size_[i]) return false;
          continue;
        }
        const double half = d[i] > 0 ? size_[i] : -size_[i];
        const double in = (-half - p[i]) / d[i], out = (half - p[i]) / d[i];
        if (in > begin) begin = in, first = i;
        if (out < end) end = out, last = i;
      }
      if (begin >= end) return false;
      span->begin = begin;
      span->end = end;
      span->begin_normal = Vector3d::Unit(first) * (d[first] > 0 ? -1 : 1);
      span->end_normal = Vector3d::Unit(last) * (d[last] > 0 ? 1 : -1);
      return true;
    }
    default:
      return ThroughPlanes(p, d, span);
  }
}

bool ConvexSolid::ThroughPlanes(const Vector3d& p, const Vector3d& d, SolidSpan* span) const {
  double begin = -kInfinity, end = kInfinity;
  Eigen::Index first = 0, last = 0;
  for (Eigen::Index i = 0; i < normals_.rows(); ++i) {
    const double speed = normals_.row(i).dot(d), room = offsets_[i] - normals_.row(i).dot(p);
    if (std::abs(speed) < kParallel) {
      if (room <= 0) return false;
      continue;
    }
    const double t = room / speed;
    if (speed > 0 && t < end) end = t, last = i;
    if (speed < 0 && t > begin) begin = t, first = i;
    if (begin >= end) return false;
  }
  span->begin = begin;
  span->end = end;
  span->begin_normal = normals_.row(first);
  span->end_normal = normals_.row(last);
  return true;
}

// The union of two balls and the cylinder between them.
bool ConvexSolid::ThroughCapsule(const Vector3d& p, const Vector3d& d, SolidSpan* span) const {
  const double r = size_[0], half = type_ == mjGEOM_CAPSULE ? size_[1] : 0;
  double begin = kInfinity, end = -kInfinity;
  const auto add = [&](double in, double out) {
    begin = std::min(begin, in);
    end = std::max(end, out);
  };
  for (const double z : {-half, half}) {
    const Vector3d q = p - Vector3d(0, 0, z);
    const double b = q.dot(d), root = b * b - q.squaredNorm() + r * r;
    if (root > 0) add(-b - std::sqrt(root), -b + std::sqrt(root));
  }
  const double a = d.head<2>().squaredNorm();
  if (half > 0 && a > kParallel) {
    const double b = p.head<2>().dot(d.head<2>()),
                 root = b * b - a * (p.head<2>().squaredNorm() - r * r);
    if (root > 0) {
      for (const double t : {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a})
        if (std::abs(p.z() + t * d.z()) <= half) add(t, t);
    }
  }
  if (begin >= end) return false;
  const auto normal = [&](double t) {
    const Vector3d at = p + t * d;
    return (at - Vector3d(0, 0, std::clamp(at.z(), -half, half))).normalized().eval();
  };
  span->begin = begin;
  span->end = end;
  span->begin_normal = normal(begin);
  span->end_normal = normal(end);
  return true;
}

bool ConvexSolid::ThroughCylinder(const Vector3d& p, const Vector3d& d, SolidSpan* span) const {
  const double r = size_[0], half = size_[1];
  double begin = -kInfinity, end = kInfinity;
  bool begin_at_cap = false, end_at_cap = false;
  const double a = d.head<2>().squaredNorm();
  if (a > kParallel) {
    const double b = p.head<2>().dot(d.head<2>()),
                 root = b * b - a * (p.head<2>().squaredNorm() - r * r);
    if (root <= 0) return false;
    begin = (-b - std::sqrt(root)) / a;
    end = (-b + std::sqrt(root)) / a;
  } else if (p.head<2>().squaredNorm() >= r * r) {
    return false;
  }
  if (std::abs(d.z()) > kParallel) {
    const double top = d.z() > 0 ? half : -half;
    const double in = (-top - p.z()) / d.z(), out = (top - p.z()) / d.z();
    if (in > begin) begin = in, begin_at_cap = true;
    if (out < end) end = out, end_at_cap = true;
  } else if (std::abs(p.z()) >= half) {
    return false;
  }
  if (begin >= end) return false;
  const auto normal = [&](double t, bool at_cap, double side) {
    if (at_cap) return Vector3d(0, 0, d.z() > 0 ? side : -side);
    const Vector3d at = p + t * d;
    return Vector3d(at.x(), at.y(), 0).normalized().eval();
  };
  span->begin = begin;
  span->end = end;
  span->begin_normal = normal(begin, begin_at_cap, -1);
  span->end_normal = normal(end, end_at_cap, 1);
  return true;
}

bool ConvexSolid::Contains(const Vector3d& point, double depth) const {
  if ((point - centre_).squaredNorm() >= radius_ * radius_) return false;
  const Vector3d p = axes_.transpose() * (point - origin_);
  switch (type_) {
    case mjGEOM_SPHERE:
      return p.norm() < size_[0] - depth;
    case mjGEOM_CAPSULE:
      return (p - Vector3d(0, 0, std::clamp(p.z(), -size_[1], size_[1]))).norm() < size_[0] - depth;
    case mjGEOM_CYLINDER:
      return p.head<2>().norm() < size_[0] - depth && std::abs(p.z()) < size_[1] - depth;
    case mjGEOM_ELLIPSOID: {
      const Vector3d inner = size_.array() - depth;
      return inner.minCoeff() > 0 && p.cwiseQuotient(inner).squaredNorm() < 1;
    }
    case mjGEOM_BOX:
      return ((size_ - p.cwiseAbs()).array() > depth).all();
    default:
      return ((offsets_ - normals_ * p).array() > depth).all();
  }
}

BodySolids::BodySolids(const mjModel* m, const mjData* d, const Pose& frame,
                       const std::vector<int>& geoms) {
  Eigen::AlignedBox3d box;
  for (const int g : geoms) {
    if (!ConvexSolid::Supports(m, g)) continue;
    const ConvexSolid& solid = solids_.emplace_back(m, d, g, frame);
    const Vector3d r = Vector3d::Constant(solid.radius());
    box.extend(Eigen::AlignedBox3d(solid.centre() - r, solid.centre() + r));
  }
  if (solids_.empty()) return;
  centre_ = box.center();
  for (const ConvexSolid& solid : solids_)
    radius_ = std::max(radius_, (solid.centre() - centre_).norm() + solid.radius());
}

void BodySolids::Through(const Vector3d& from, const Vector3d& direction,
                         std::vector<SolidSpan>* spans) const {
  spans->clear();
  SolidSpan span;
  for (const ConvexSolid& solid : solids_) {
    if (solid.Through(from, direction, &span)) spans->push_back(span);
  }
  if (spans->size() < 2) return;
  std::sort(spans->begin(), spans->end(),
            [](const SolidSpan& a, const SolidSpan& b) { return a.begin < b.begin; });
  size_t last = 0;
  for (size_t i = 1; i < spans->size(); ++i) {
    SolidSpan& joined = (*spans)[last];
    const SolidSpan& next = (*spans)[i];
    if (next.begin > joined.end + kTouching) {
      (*spans)[++last] = next;
    } else if (next.end > joined.end) {
      joined.end = next.end;
      joined.end_normal = next.end_normal;
      joined.end_geom = next.end_geom;
    }
  }
  spans->resize(last + 1);
}

std::vector<SolidSpan> BodySolids::Through(const Vector3d& from, const Vector3d& direction) const {
  std::vector<SolidSpan> spans;
  Through(from, direction, &spans);
  return spans;
}

bool BodySolids::Contains(const Vector3d& point, double depth) const {
  if ((point - centre_).squaredNorm() >= radius_ * radius_) return false;
  return std::ranges::any_of(
      solids_, [&](const ConvexSolid& solid) { return solid.Contains(point, depth); });
}

}  // namespace robocell::internal
