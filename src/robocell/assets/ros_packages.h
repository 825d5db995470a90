// Private to assets and scene: the files that a URDF names, as `package://NAME/rest`,
// `model://NAME/rest`, `file:///path` or a path beside the URDF.
//
// A package is searched in this order: ROBOCELL_PACKAGES, which lists NAME=FOLDER, separated by
// ':' (`--package NAME=FOLDER` adds to it); ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and
// ROBOCELL_MODEL_PATH, which list folders of packages; and the folders around the URDF. A folder
// is the package NAME if its package.xml says so, or if it is called NAME.
//
//   const RosPackages packages("/ws/arm/urdf/arm.urdf");
//   packages.File("package://arm/meshes/link1.stl");   // /ws/arm/meshes/link1.stl
//
// Every file lies below its package, below a folder of these variables, or below the URDF's own
// package: names that lead out, also through links, are rejected.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace robocell::internal {

// Parses "NAME=FOLDER". Throws ArgumentError for other texts and for a missing folder.
std::pair<std::string, std::string> ParsePackage(std::string_view text);

class RosPackages {
 public:
  // Throws ArgumentError for an entry of ROBOCELL_PACKAGES that is not NAME=FOLDER.
  explicit RosPackages(const std::filesystem::path& urdf);

  // Returns the absolute path of the file that the URDF calls `name`. Throws NotFoundError for an
  // unknown package, ArgumentError for a name that leads out of its root. The file may be missing.
  std::filesystem::path File(const std::string& name) const;

  // Returns the package.xml files of the packages that `File` has found, and of the URDF's own:
  // with them a copy of these files resolves the same names.
  const std::vector<std::filesystem::path>& manifests() const { return manifests_; }

 private:
  std::filesystem::path InPackage(const std::string& package, const std::string& rest,
                                  const std::string& name) const;
  std::filesystem::path Absolute(const std::filesystem::path& path, const std::string& name) const;
  void Remember(const std::filesystem::path& package) const;

  std::filesystem::path folder_;                // of the URDF
  std::vector<std::filesystem::path> parents_;  // that folder and those around it
  std::filesystem::path own_;                   // root of names without a package
  std::map<std::string, std::string> given_;    // folders by the name of their package
  mutable std::vector<std::filesystem::path> manifests_;
};

}  // namespace robocell::internal
