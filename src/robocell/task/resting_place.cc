#include "robocell/task/resting_place.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <Eigen/Geometry>

#include "robocell/base/units.h"
#include "robocell/math/pose.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/sleeping.h"
#include "robocell/mujoco/step.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

constexpr const char* kContext = "trying whether an object can rest at its goal";
constexpr double kSeconds = 1.5;      // time for an object to come to rest ...
constexpr double kLook = 0.05;        // ... and between two checks
constexpr double kStillSpeed = 0.01;  // m/s
constexpr double kStillTurn = 0.1;    // rad/s
constexpr double kInside = 0.002;     // m; contacts at rest are less deep
constexpr double kLost = 0.05;        // m beyond the tolerance, from which it does not come back
constexpr double kAside = 0.8;        // share of the tolerance for a try beside the place

// The object's rotations to try: as it is, turned about the vertical, and lying on each side.
std::array<Eigen::Quaterniond, 8> Turns() {
  std::array<Eigen::Quaterniond, 8> turns;
  const std::array<Vector3d, 8> rpy = {{{0, 0, 0},
                                        {0, 0, kPi / 2},
                                        {0, 0, kPi / 4},
                                        {kPi / 2, 0, 0},
                                        {-kPi / 2, 0, 0},
                                        {0, kPi / 2, 0},
                                        {0, -kPi / 2, 0},
                                        {kPi, 0, 0}}};
  for (size_t i = 0; i < rpy.size(); ++i)
    turns[i] = Pose::FromRpy(Vector3d::Zero(), rpy[i]).rotation();
  return turns;
}

void RemoveContacts(mjModel* model, int body) {
  for (int g = 0; body >= 0 && g < model->ngeom; ++g) {
    if (!IsInSubtree(model, model->geom_bodyid[g], body)) continue;
    model->geom_contype[g] = 0;
    model->geom_conaffinity[g] = 0;
  }
}

// Returns the same scene without the motors and the contacts of the robots, and without the
// contacts of the `ignored` bodies.
ModelPtr WithoutRobots(const Scene& scene, std::span<const int> ignored) {
  ModelPtr model = CopyModel(scene.model());
  for (const RobotRecord& robot : scene.compiled()->robots())
    RemoveContacts(model.get(), FindId(model.get(), mjOBJ_BODY, robot.base_body));
  for (const int body : ignored) RemoveContacts(model.get(), body);
  model->opt.disableflags |= mjDSBL_ACTUATION;
  return model;
}

class Trial {
 public:
  Trial(const Scene& scene, int object, double tolerance, std::span<const int> ignored)
      : scene_(scene),
        model_(WithoutRobots(scene, ignored)),
        data_(CopyData(scene.model(), scene.data())),
        start_(CopyData(scene.model(), scene.data())),
        object_(object),
        tolerance_(tolerance) {}

  bool Rests(const RestPlace& place, const Vector3d& aside, const Eigen::Quaterniond& turn) {
    for (const double up : {0.0, 0.5 * tolerance_, tolerance_}) {
      PutAt(place, aside + up * Vector3d::UnitZ(), turn);
      if (Deepest() < 0 && ComesToRest(place)) return true;
    }
    return false;
  }

  // Describes what happens to the object at a place in its present orientation.
  std::string Fate(const RestPlace& place) {
    PutAt(place, Vector3d::Zero(), Eigen::Quaterniond::Identity());
    if (const int contact = Deepest(); contact >= 0) return Inside(contact);
    const Vector3d from = Position();
    for (double t = 0; t < kSeconds; t += kLook) {
      if (!Advance()) break;
    }
    const Vector3d displacement = Position() - from;
    if (-displacement.z() > displacement.head<2>().norm())
      return fmt::format("put down there it falls by at least {:.2f} m", -displacement.z());
    return fmt::format("put down there it ends up {:.2f} m away", displacement.norm());
  }

 private:
  Vector3d Position() const { return Vector3d(data_->xpos + 3 * object_); }
  Vector3d InWorld(const RestPlace& place) const {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> frame(data_->xmat +
                                                                               9 * place.frame);
    return Vector3d(data_->xpos + 3 * place.frame) + frame * place.at;
  }

  void PutAt(const RestPlace& place, const Vector3d& offset, const Eigen::Quaterniond& turn) {
    mj_copyData(data_.get(), model_.get(), start_.get());
    const Vector3d at = InWorld(place) + offset;
    const mjtNum* was = start_->xquat + 4 * object_;
    const Eigen::Quaterniond quat = turn * Eigen::Quaterniond(was[0], was[1], was[2], was[3]);
    const int joint = model_->body_jntadr[object_];
    mjtNum* q = data_->qpos + model_->jnt_qposadr[joint];
    std::copy_n(at.data(), 3, q);
    q[3] = quat.w();
    std::copy_n(quat.vec().data(), 3, q + 4);
    std::fill_n(data_->qvel, model_->nv, 0);
    Forward(model_.get(), data_.get(), kContext);
  }

  bool IsObjects(int geom) const {
    return geom >= 0 && IsInSubtree(model_.get(), model_->geom_bodyid[geom], object_);
  }

  // Returns the contact in which the object is deepest inside something, or -1 without one.
  int Deepest() const {
    int deepest = -1;
    double depth = kInside;
    for (int c = 0; c < data_->ncon; ++c) {
      const mjContact& contact = data_->contact[c];
      if (IsObjects(contact.geom[0]) == IsObjects(contact.geom[1]) || -contact.dist <= depth)
        continue;
      depth = -contact.dist;
      deepest = c;
    }
    return deepest;
  }

  std::string Inside(int index) const {
    const mjContact& contact = data_->contact[index];
    const int other = IsObjects(contact.geom[0]) ? contact.geom[1] : contact.geom[0];
    const int body = other < 0 ? 0 : model_->geom_bodyid[other];
    std::string name = ElementName(model_.get(), mjOBJ_BODY, body);
    if (body == 0) name = other < 0 ? "the world" : ElementName(model_.get(), mjOBJ_GEOM, other);
    return fmt::format("there it is {:.0f} mm inside {}", -1000 * contact.dist,
                       name.empty() ? "the world" : "'" + name + "'");
  }

  bool Advance() {
    const int steps = std::max(1, static_cast<int>(std::lround(kLook / model_->opt.timestep)));
    return Step(model_.get(), data_.get(), steps, kContext).ok();
  }

  bool ComesToRest(const RestPlace& place) {
    const int dof = model_->body_dofadr[object_];
    for (double t = 0; t < kSeconds; t += kLook) {
      if (!Advance()) return false;
      const double away = (Position() - InWorld(place)).norm();
      if (away > tolerance_ + kLost) return false;
      const mjtNum* v = data_->qvel + dof;
      const bool rests = mju_norm3(v) < kStillSpeed && mju_norm3(v + 3) < kStillTurn;
      if (rests && away <= tolerance_ && IsTouching()) return true;
    }
    return false;
  }

  bool IsTouching() const {
    if (Sleeps(model_.get(), data_.get(), object_)) return true;  // without a contact
    for (int c = 0; c < data_->ncon; ++c) {
      const mjContact& contact = data_->contact[c];
      if (contact.exclude == 0 && IsObjects(contact.geom[0]) != IsObjects(contact.geom[1]))
        return true;
    }
    return false;
  }

  Scene scene_;  // owns the sources of the copies
  ModelPtr model_;
  DataPtr data_, start_;
  int object_;
  double tolerance_;
};

}  // namespace

std::string WhyNoRest(const Scene& scene, int object, std::span<const RestPlace> places,
                      double tolerance, std::span<const int> ignored) {
  scene.SyncPoses();
  Trial trial(scene, object, tolerance, ignored);
  const double far = kAside * tolerance;
  const std::array<Vector3d, 5> asides = {
      {{0, 0, 0}, {far, 0, 0}, {-far, 0, 0}, {0, far, 0}, {0, -far, 0}}};
  for (const Eigen::Quaterniond& turn : Turns()) {
    for (const RestPlace& place : places) {
      for (const Vector3d& aside : asides) {
        if (trial.Rests(place, aside, turn)) return "";
      }
    }
  }
  return trial.Fate(places.front());
}

double HeightOverSupport(const Scene& scene, const Vector3d& place, int without) {
  constexpr int kMostLayers = 32;                 // layers that do not count
  constexpr double kFromAbove = 0.1, kOn = 1e-4;  // m
  const mjModel* m = scene.model();
  std::vector<int> bases;
  for (const RobotRecord& robot : scene.compiled()->robots())
    bases.push_back(FindId(m, mjOBJ_BODY, robot.base_body));
  const auto counts = [&](int geom) {
    const int body = m->geom_bodyid[geom];
    if (!IsCollisionGeom(m, geom) || IsInSubtree(m, body, without)) return false;
    return std::ranges::none_of(bases,
                                [&](int base) { return base > 0 && IsInSubtree(m, body, base); });
  };
  Vector3d from = place + kFromAbove * Vector3d::UnitZ();
  const Vector3d down = -Vector3d::UnitZ();
  for (int layer = 0; layer < kMostLayers; ++layer) {
    int geom = -1;
    const double hit = Guarded("looking for what is under a goal", [&] {
      return mj_ray(m, scene.data(), from.data(), down.data(), nullptr, 1, -1, &geom, nullptr);
    });
    if (hit < 0) break;
    from += hit * down;
    if (counts(geom)) return place.z() - from.z();
    from += kOn * down;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace robocell::internal
