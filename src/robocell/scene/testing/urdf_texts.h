// For tests only: URDFs made of links and joints with uneven numbers.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "robocell/assets/urdf.h"
#include "robocell/base/files.h"
#include "robocell/mujoco/compile.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scene/urdf_model.h"

namespace robocell::internal {

class UrdfTexts : public ::testing::Test {
 protected:
  static std::string Inertial(double mass, const std::string& rpy = "0 0 0") {
    return fmt::format(
        "<inertial><origin xyz=\"0.01 0.02 0.03\" rpy=\"{1}\"/><mass value=\"{0}\"/><inertia "
        "ixx=\"0.02\" ixy=\"0.001\" ixz=\"0.002\" iyy=\"0.03\" iyz=\"0.003\" "
        "izz=\"0.04\"/></inertial>",
        mass, rpy);
  }

  static std::string Collision(const std::string& shape) {
    return "<collision><origin xyz=\"0 0 0.1\" rpy=\"0.1 0.2 0.3\"/><geometry>" + shape +
           "</geometry></collision>";
  }

  static std::string Link(const std::string& name, const std::string& inside) {
    return "<link name=\"" + name + "\">" + inside + "</link>";
  }

  static std::string Joint(const std::string& name, const std::string& type,
                           const std::string& parent, const std::string& child,
                           const std::string& inside = "") {
    return fmt::format(
        "<joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/><origin "
        "xyz=\"0.1 0.2 0.3\" rpy=\"0.4 -0.5 0.6\"/><axis xyz=\"0 0.6 0.8\"/><limit lower=\"-1\" "
        "upper=\"2\" effort=\"40\" velocity=\"3\"/>{}</joint>",
        name, type, parent, child, inside);
  }

  // An arm of a hinge and a slide, with a fixed link between them.
  static std::string Arm() {
    return Link("base", Inertial(3) + Collision("<box size=\"0.2 0.1 0.3\"/>")) +
           Link("upper", Inertial(2) + Collision("<cylinder radius=\"0.05\" length=\"0.3\"/>")) +
           Link("flange", Inertial(0.5)) +
           Link("slider", Inertial(1) + Collision("<sphere radius=\"0.1\"/>")) +
           Joint("turn", "revolute", "base", "upper",
                 "<dynamics damping=\"2\" friction=\"0.5\"/>") +
           Joint("mount", "fixed", "upper", "flange") +
           Joint("slide", "prismatic", "flange", "slider");
  }

  std::string Write(const std::string& inside) {
    const std::filesystem::path file = folder_.path() / "arm.urdf";
    AtomicWrite(file, "<robot name=\"arm\">\n" + inside + "\n</robot>\n");
    return file.string();
  }
  ModelPtr Model(const std::string& inside) {
    const SpecPtr spec = MakeUrdfSpec(ReadUrdf(Write(inside)));
    return Compile(spec.get());
  }
  ModelFolder folder_;
};

}  // namespace robocell::internal
