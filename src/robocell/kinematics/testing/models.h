// Models for the tests of this folder: the Menagerie's robots and random chains, with their data.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/kinematics/chain.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/owners.h"
#include "robocell/testing/menagerie.h"

namespace robocell {

// A compiled model with its data; everything at the reference position until changed.
class TestModel {
 public:
  // Loads a model without its shapes, which kinematics do not need and which take most of the
  // loading time. The file must give inertias.
  static TestModel FromFile(const std::string& path) {
    SpecPtr spec = ParseXmlFile(path, path);
    for (const mjtObj kind : {mjOBJ_GEOM, mjOBJ_MESH}) {
      while (mjsElement* element = mjs_firstElement(spec.get(), kind))
        mjs_delete(spec.get(), element);
    }
    return TestModel(std::move(spec));
  }
  static TestModel FromXml(const std::string& xml) { return TestModel(ParseXmlString(xml, xml)); }

  mjModel* model() const { return model_.get(); }
  mjData* data() const { return data_.get(); }

  // Sets every joint at random (scalar ones in their limits, else within +-pi), then runs forward
  // kinematics.
  void Randomise(Rng* rng) {
    mjModel* m = model();
    for (int j = 0; j < m->njnt; ++j) {
      double* q = data()->qpos + m->jnt_qposadr[j];
      if (m->jnt_type[j] == mjJNT_HINGE || m->jnt_type[j] == mjJNT_SLIDE) {
        const mjtNum* range = m->jnt_range + 2 * j;
        *q = m->jnt_limited[j] ? rng->Uniform(range[0], range[1]) : rng->Uniform(-mjPI, mjPI);
      } else {
        double* quat = m->jnt_type[j] == mjJNT_FREE ? q + 3 : q;
        for (int k = 0; k < 4; ++k) quat[k] = rng->Normal();
        mju_normalize4(quat);
      }
    }
    Forward();
  }
  void Forward() {
    mj_kinematics(model(), data());
    mj_comPos(model(), data());
  }

  // Displaces and tilts the body, like a displaced mount.
  void Displace(std::string_view body, Rng* rng) {
    const int id = mj_name2id(model(), mjOBJ_BODY, std::string(body).c_str());
    for (int k = 0; k < 3; ++k) model()->body_pos[3 * id + k] = rng->Uniform(-2, 2);
    for (int k = 0; k < 4; ++k) model()->body_quat[4 * id + k] = rng->Normal();
    mju_normalize4(model()->body_quat + 4 * id);
    Forward();
  }

  // Returns the values of the chain's joints in mjData.qpos.
  JointVector ChainPositions(const Chain& chain) const {
    JointVector q(chain.n_joints());
    for (int i = 0; i < q.size(); ++i) q[i] = data()->qpos[chain.joints()[i].qpos_address];
    return q;
  }

  Transform BodyInWorld(std::string_view name) const {
    const int id = mj_name2id(model(), mjOBJ_BODY, std::string(name).c_str());
    return InWorld(data()->xpos + 3 * id, data()->xmat + 9 * id);
  }
  Transform TipInWorld(const ChainTip& tip) const {
    if (tip.kind == ChainTip::Kind::kBody) return BodyInWorld(tip.name);
    const int id = mj_name2id(model(), mjOBJ_SITE, tip.name.c_str());
    return InWorld(data()->site_xpos + 3 * id, data()->site_xmat + 9 * id);
  }
  // Returns the tip in the base's frame by the engine's kinematics.
  Transform TipInBase(const Chain& chain) const {
    return BodyInWorld(chain.base_body()).inverse() * TipInWorld(chain.tip());
  }

 private:
  explicit TestModel(SpecPtr spec)
      : model_(Compile(spec.get(), nullptr, "test model")), data_(MakeData(model_.get())) {
    Forward();
  }
  static Transform InWorld(const mjtNum* position, const mjtNum* rotation) {
    Transform out;
    out.translation = Eigen::Map<const Eigen::Vector3d>(position);
    out.rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation);
    return out;
  }

  ModelPtr model_;
  DataPtr data_;
};

// A robot of the Menagerie and a chain in it.
struct MenagerieArm {
  std::string folder, file, base;
  ChainTip tip;
};

inline void PrintTo(const MenagerieArm& arm, std::ostream* out) { *out << arm.folder; }

inline std::vector<MenagerieArm> MenagerieArms() {
  return {{"ufactory_xarm7", "xarm7.xml", "link_base", ChainTip::Site("link_tcp")},
          {"kinova_gen3", "gen3.xml", "base_link", ChainTip::Site("pinch_site")},
          {"franka_fr3", "fr3.xml", "base", ChainTip::Site("attachment_site")},
          {"franka_emika_panda", "panda.xml", "link0", ChainTip::Body("hand")}};
}

inline std::vector<MenagerieArm> MenagerieRobots() {
  std::vector<MenagerieArm> robots = MenagerieArms();
  robots.push_back({"robotiq_2f85", "2f85.xml", "base_mount", ChainTip::Body("left_pad")});
  return robots;
}

inline std::string ArmName(const testing::TestParamInfo<MenagerieArm>& info) {
  return info.param.folder;
}

// The elements that a random chain may contain.
struct RandomChainOptions {
  int joints = 7;
  double slide_share = 0.2;  // of the joints
  bool awkward =
      true;  // anchors, reference positions, two joints on a body, fixed bodies, side branches
  double limited_share = 0.7;  // of the hinges
  bool narrow = false;         // limits of hinges are 0.8 to 3 rad from 0, not 1.5 to 3
  double tiny_share = 0;       // of the joints: with limits a thousandth of a radian or metre apart
  double whole_turn_share = 0;  // of the other hinges: with limits one to two turns apart
  double size = 1;              // multiplies all lengths of the chain, those of slides too
  bool square = false;          // axes are along x, y or z of the base for joint values 0
};

// Writes the MJCF of a random chain "base" -> site "tip", on a base that itself moves.
class RandomChainXml {
 public:
  RandomChainXml(Rng* rng, const RandomChainOptions& options) : rng_(rng), options_(options) {}

  std::string Write() {
    std::string links;
    int joints = 0;
    int bodies = 0;
    while (joints < options_.joints) {
      const bool two = options_.awkward && joints + 1 < options_.joints && rng_->Uniform() < 0.2;
      const bool none = options_.awkward && rng_->Uniform() < 0.15;
      links += fmt::format("<body name='link{}' {} gravcomp='{}'>{}", bodies++, ChainPlace(0.3),
                           Gravcomp(), Inertial());
      for (int k = 0; k < (none ? 0 : two ? 2 : 1); ++k)
        links += Joint(fmt::format("j{}", joints++));
      if (options_.awkward && rng_->Uniform() < 0.3) links += Branch(bodies);
    }
    links += fmt::format("<site name='tip' {}/>", ChainPlace(0.2));
    for (int k = 0; k < bodies; ++k) links += "</body>";
    return fmt::format(
        "<mujoco><compiler angle='radian'/><option gravity='{} {} {}'/><worldbody><body "
        "name='mount' {}>"
        "<joint name='mount_x' type='slide' axis='1 0 0'/><joint name='mount_turn' axis='0 1 1'/>{}"
        "<body name='base' {}>{}{}</body></body></worldbody></mujoco>",
        U(-5, 5), U(-5, 5), U(-9, -2), Place(1), Inertial(), Place(0.5), Inertial(), links);
  }

 private:
  double U(double low, double high) { return rng_->Uniform(low, high); }
  std::string Place(double reach) {
    return fmt::format("pos='{} {} {}' quat='{} {} {} {}'", U(-reach, reach), U(-reach, reach),
                       U(-reach, reach), rng_->Normal(), rng_->Normal(), rng_->Normal(),
                       rng_->Normal());
  }
  std::string ChainPlace(double reach) {
    const double size = options_.size * reach;
    if (!options_.square) return Place(size);
    return fmt::format("pos='{} {} {}'", U(-size, size), U(-size, size), U(-size, size));
  }
  std::string Axis() {
    if (options_.square) return std::array{"1 0 0", "0 1 0", "0 0 1"}[static_cast<size_t>(U(0, 3))];
    return fmt::format("{} {} {}", rng_->Normal(), rng_->Normal(), rng_->Normal());
  }
  double Gravcomp() { return options_.awkward && rng_->Uniform() < 0.4 ? U(0, 1.2) : 0; }
  std::string Inertial() {
    return fmt::format("<inertial mass='{}' {} diaginertia='{} {} {}'/>", U(0.1, 3), Place(0.1),
                       U(.01, .019), U(.01, .019), U(.01, .019));
  }
  std::string Joint(const std::string& name) {
    const bool slide = rng_->Uniform() < options_.slide_share;
    const double size = options_.size, unit = slide ? size : 1;
    const double ref = options_.awkward && rng_->Uniform() < 0.5 ? unit * U(-0.5, 0.5) : 0;
    std::string text = fmt::format("<joint name='{}' type='{}' axis='{}' armature='{}' ref='{}'",
                                   name, slide ? "slide" : "hinge", Axis(), U(0, 0.2), ref);
    if (options_.awkward && rng_->Uniform() < 0.5) {
      text +=
          fmt::format(" pos='{} {} {}'", size * U(-.2, .2), size * U(-.2, .2), size * U(-.2, .2));
    }
    if (options_.tiny_share > 0 && rng_->Uniform() < options_.tiny_share) {
      const double lower = slide ? U(-0.4, 0.4) : U(-1.5, 1.5);
      text += fmt::format(" range='{} {}'", unit * lower, unit * (lower + 1e-3));
    } else if (!slide && options_.whole_turn_share > 0 &&
               rng_->Uniform() < options_.whole_turn_share) {
      const double lower = U(-6, 1), turns = rng_->Uniform() < 0.5 ? 1 : U(1, 2);
      text += fmt::format(" range='{} {}'", lower, lower + turns * 2 * std::numbers::pi);
    } else if (slide) {
      text += fmt::format(" range='{} {}'", size * U(-0.4, -0.1), size * U(0.1, 0.4));
    } else if (rng_->Uniform() < options_.limited_share) {
      const double least = options_.narrow ? 0.8 : 1.5;
      text += fmt::format(" range='{} {}'", U(-3, -least), U(least, 3));
    }
    return text + "/>";
  }
  // Returns a side branch with joints of its own, which hangs on the chain but does not belong to
  // it.
  std::string Branch(int k) {
    return fmt::format(
        "<body name='branch{0}' {1} gravcomp='{2}'><joint name='branch_hinge{0}' ref='0.2' pos='.1 "
        "0 .05'/>{3}"
        "<body {4}><joint name='branch_ball{0}' type='ball' pos='0 .1 0'/>{5}</body>"
        "<body {6}><joint name='branch_slide{0}' type='slide' ref='.1'/>{7}</body></body>",
        k, Place(0.2), Gravcomp(), Inertial(), Place(0.2), Inertial(), Place(0.2), Inertial());
  }

  Rng* rng_;
  RandomChainOptions options_;
};

}  // namespace robocell
