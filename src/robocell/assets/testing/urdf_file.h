// For tests only: a small URDF in a folder of its own, whose errors name file and line.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "robocell/assets/urdf.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {

namespace fs = std::filesystem;

inline constexpr const char* kTriangles = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\n";
inline constexpr const char* kMass =
    "<inertial><mass value=\"1\"/><inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" "
    "izz=\"0.01\"/></inertial>";

// The text of a URDF of two links, beside the links themselves.
struct Text {
  std::string upper = kMass;      // content of the link `upper`, line 3
  std::string type = "revolute";  // of the joint `turn`, line 4
  std::string inside = "";        // of that joint
  std::string rest = "";          // after it, line 5
  std::string head = "";          // line 1, in the robot
  std::string child = "upper";
};

inline std::string UrdfText(const Text& t) {
  return fmt::format(
      "<robot name=\"arm\">{}\n<link name=\"base\"/>\n<link name=\"upper\">{}</link>\n"
      "<joint name=\"turn\" type=\"{}\"><parent link=\"base\"/><child link=\"{}\"/><axis xyz=\"0 0 "
      "1\"/><limit lower=\"-1\" upper=\"2\" effort=\"5\" velocity=\"3\"/>{}</joint>\n{}</robot>\n",
      t.head, t.upper, t.type, t.child, t.inside, t.rest);
}

inline std::string Mesh(const std::string& name) {
  return "<collision><geometry><mesh filename=\"" + name + "\"/></geometry></collision>";
}

// A joint with a link, after the two of UrdfText.
inline std::string Next(const std::string& joint, const std::string& inside) {
  return fmt::format(
      "<link name=\"l_{0}\">{1}</link><joint name=\"{0}\" type=\"revolute\"><parent "
      "link=\"base\"/><child link=\"l_{0}\"/><limit lower=\"0\" upper=\"1\"/>{2}</joint>\n",
      joint, kMass, inside);
}

inline std::string Between(const std::string& text, const std::string& first,
                           const std::string& last) {
  const size_t begin = text.find(first), end = text.find(last, begin);
  EXPECT_NE(end, std::string::npos) << text;
  return end == std::string::npos ? "" : text.substr(begin, end + last.size() - begin);
}

// A URDF in the folder of its package, `arm_description`.
class UrdfFile : public ::testing::Test {
 protected:
  Urdf Read(const Text& text) {
    fs::create_directories(file_.parent_path());
    AtomicWrite(file_, UrdfText(text));
    return ReadUrdf(file_);
  }
  // Returns the message, which names file and line.
  std::string Bad(const Text& text, int line, const std::string& part) {
    const std::string place = fmt::format("{}:{}: ", file_.string(), line);
    std::string message;
    message = ExpectThrow<SpecError>([&] { Read(text); }, part);
    EXPECT_THAT(message, ::testing::HasSubstr(place));
    return message;
  }
  void WriteMesh(const fs::path& path) {
    fs::create_directories(path.parent_path());
    AtomicWrite(path, kTriangles);
  }

  TempDir folder_;
  const fs::path root_ = fs::absolute(folder_.path());
  const fs::path file_ = root_ / "arm_description/urdf/arm.urdf";
};

}  // namespace robocell::internal
