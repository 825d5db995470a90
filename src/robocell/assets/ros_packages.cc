#include "robocell/assets/ros_packages.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <system_error>

#include "robocell/assets/resolve.h"
#include "robocell/assets/roots.h"
#include "robocell/assets/urdf.h"
#include "robocell/base/error.h"
#include "robocell/base/paths.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = "package.xml";
constexpr int kParents = 4;  // folders around a URDF that may be or contain its package

std::vector<std::string> FoldersOf(const char* variable) {
  std::vector<std::string> folders;
  std::string rest = Environment(variable);
  while (!rest.empty()) {
    const size_t colon = rest.find(':');
    if (colon != 0) folders.push_back(rest.substr(0, colon));
    rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
  }
  return folders;
}

// Returns the name of the package in this folder; "" without a manifest that can be read.
std::string NameInManifest(const fs::path& folder) {
  if (!CanReadFile(folder / kManifest)) return "";
  tinyxml2::XMLDocument document;
  try {
    const std::string text = ReadRealFile(folder / kManifest);
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return "";
  } catch (const IoError&) {
    return "";
  }
  const auto* root = document.RootElement();
  const auto* name = root ? root->FirstChildElement("name") : nullptr;
  std::string text = name && name->GetText() ? name->GetText() : "";
  std::erase_if(text, [](unsigned char c) { return std::isspace(c); });
  return text;
}

bool IsFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool IsPackage(const fs::path& folder, const std::string& name) {
  if (!IsFolder(folder)) return false;
  const std::string declared = NameInManifest(folder);
  return declared.empty() ? folder.filename() == name : declared == name;
}

std::vector<fs::path> SortedChildren(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> children;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    children.push_back(it->path());
  std::sort(children.begin(), children.end());
  return children;
}

// Returns the package in a folder of packages: the folder itself, a child, or a child of a
// repository with several packages.
std::optional<fs::path> PackageBelow(const fs::path& root, const std::string& name) {
  if (IsPackage(root, name)) return root;
  if (IsPackage(root / name, name)) return root / name;
  for (const fs::path& child : SortedChildren(root)) {
    if (NameInManifest(child) == name) return child;
    if (IsPackage(child / name, name)) return child / name;
  }
  return std::nullopt;
}

// Returns the package that a manifest declares in a folder that nobody gave as one of packages.
std::optional<fs::path> DeclaredBelow(const fs::path& root, const std::string& name) {
  for (const fs::path& child : SortedChildren(root)) {
    for (const fs::path& folder : {child, child / name}) {
      if (NameInManifest(folder) == name) return folder;
    }
  }
  return std::nullopt;
}

std::optional<fs::path> PackageOfVariables(const std::string& name) {
  for (const std::string& root : FoldersOf("ROS_PACKAGE_PATH")) {
    if (const auto found = PackageBelow(root, name)) return found;
  }
  for (const std::string& prefix : FoldersOf("AMENT_PREFIX_PATH")) {
    const fs::path share = fs::path(prefix) / "share" / name;
    if (IsFolder(share)) return share;
  }
  for (const std::string& root : assets::ModelPathRoots()) {
    if (const auto found = PackageBelow(root, name)) return found;
  }
  return std::nullopt;
}

fs::path Confined(const fs::path& root, const std::string& rest, const std::string& name) {
  try {
    return fs::absolute(ConfinedPath(root, rest)).lexically_normal();
  } catch (const ArgumentError&) {
    throw ArgumentError(
        fmt::format("'{}' leads out of '{}'. Files of a URDF lie below its package; put the file "
                    "there, or name the package that it is in: package://NAME/{}",
                    name, root.string(), fs::path(rest).filename().string()));
  }
}

// Removes "..", as far as the path has folders for it.
std::string Normal(const std::string& path) { return fs::path(path).lexically_normal().string(); }

bool IsBelow(const fs::path& path, const fs::path& root) {
  const fs::path relative = path.lexically_relative(root);
  return !relative.empty() && *relative.begin() != "..";
}

}  // namespace

std::pair<std::string, std::string> ParsePackage(std::string_view text) {
  const size_t equal = text.find('=');
  const std::string name(text.substr(0, equal));
  const std::string folder(equal == std::string_view::npos ? "" : text.substr(equal + 1));
  if (!ValidFileName(name) || folder.empty())
    throw ArgumentError(fmt::format(
        "package '{}': write the package's name and its folder: arm_description=../arm_description",
        text));
  if (!IsFolder(folder))
    throw ArgumentError(fmt::format(
        "package '{}': there is no folder '{}'. Give the folder that contains the package's "
        "package.xml or its meshes",
        name, folder));
  return {name, fs::absolute(folder).lexically_normal().string()};
}

RosPackages::RosPackages(const fs::path& urdf) {
  for (const std::string& entry : FoldersOf("ROBOCELL_PACKAGES"))
    given_.insert_or_assign(ParsePackage(entry).first, ParsePackage(entry).second);
  folder_ = fs::absolute(urdf).lexically_normal().parent_path();
  for (fs::path each = folder_; std::ssize(parents_) <= kParents && each.has_relative_path();
       each = each.parent_path())
    parents_.push_back(each);
  // Without a manifest: urdf/arm.urdf often names ../meshes/link1.stl.
  own_ = parents_.size() > 1 ? parents_[1] : folder_;
  for (const fs::path& parent : parents_) {
    if (!CanReadFile(parent / kManifest)) continue;
    own_ = parent;
    Remember(parent);
    break;
  }
}

fs::path RosPackages::File(const std::string& name) const {
  RequireNoNul("mesh", name);
  for (const std::string scheme : {"package://", "model://"}) {
    if (!name.starts_with(scheme)) continue;
    const std::string path =  // package:///NAME/FILE is seen too
        name.substr(std::min(name.find_first_not_of('/', scheme.size()), name.size()));
    const size_t slash = path.find('/');
    const std::string package = path.substr(0, slash);
    const std::string rest = slash == std::string::npos ? "" : path.substr(slash + 1);
    if (!ValidFileName(package) || rest.empty())
      throw ArgumentError(
          fmt::format("'{}' names no file of a package: package://NAME/FILE", name));
    return InPackage(package, rest, name);
  }
  if (name.starts_with("file://")) return Absolute(name.substr(7), name);
  if (const size_t colon = name.find("://"); colon != std::string::npos)
    throw ArgumentError(fmt::format(
        "'{}': files are read as package://NAME/FILE, file:///PATH or a path beside the URDF. "
        "Download the file, and name it in one of these ways",
        name));
  const fs::path path = name;
  if (path.is_absolute()) return Absolute(path, name);
  // `..` is followed within the URDF's own package.
  const fs::path full = (folder_ / path).lexically_normal();
  return IsBelow(full, own_) ? Confined(own_, full.lexically_relative(own_).string(), name)
                             : Absolute(full, name);
}

// Absolute names are read below declared roots only.
fs::path RosPackages::Absolute(const fs::path& path, const std::string& name) const {
  const fs::path full = path.lexically_normal();
  std::vector<std::string> roots;
  for (const auto& [package, folder] : given_) roots.push_back(folder);
  for (const char* variable : {"ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "ROBOCELL_MODEL_PATH"}) {
    for (const std::string& root : FoldersOf(variable)) roots.push_back(root);
  }
  roots.push_back(own_.string());
  for (const std::string& root : roots) {
    const fs::path normal = fs::absolute(root).lexically_normal();
    if (IsBelow(full, normal))
      return Confined(normal, full.lexically_relative(normal).string(), name);
  }
  throw ArgumentError(fmt::format(
      "'{}' is outside the URDF's folders ({}). Move the file there, or declare its folder: "
      "export ROBOCELL_PACKAGES=NAME={}",
      name, ListNames(roots), ShellWord(full.parent_path().string())));
}

fs::path RosPackages::InPackage(const std::string& package, const std::string& rest,
                                const std::string& name) const {
  const auto given = given_.find(package);
  if (given != given_.end()) {
    Remember(given->second);
    return Confined(given->second, rest, name);
  }
  if (const auto found = PackageOfVariables(package)) {
    Remember(*found);
    return Confined(*found, rest, name);
  }
  for (const fs::path& parent : parents_) {
    for (const fs::path& folder : {parent, parent / package}) {
      if (!IsPackage(folder, package)) continue;
      Remember(folder);
      return Confined(folder, rest, name);
    }
  }
  // Packages of other repositories of the same workspace.
  const auto in_workspace = [&]() -> std::optional<fs::path> {
    for (const fs::path& parent : parents_) {
      const auto found = DeclaredBelow(parent, package);
      if (!found) continue;
      Remember(*found);
      return Confined(*found, rest, name);
    }
    return std::nullopt;
  };
  // A package whose folder was renamed, such as a checkout or a copy, which may have only the file
  // that is read in the place of this one.
  const auto in_renamed = [&]() -> std::optional<fs::path> {
    for (const fs::path& parent : parents_) {
      std::error_code error;
      if (IsBelow(parent / Normal(rest), parent) &&
          fs::is_regular_file(ReadableMesh(parent / rest), error))
        return Confined(parent, rest, name);
    }
    return std::nullopt;
  };
  // A URDF without a package around it is a copy, with its files beside it.
  const bool is_copy = NameInManifest(own_).empty();
  if (const auto found = is_copy ? in_renamed() : in_workspace()) return *found;
  if (const auto found = is_copy ? in_workspace() : in_renamed()) return *found;
  std::vector<std::string> known;
  for (const auto& [each, folder] : given_) known.push_back(each);
  throw NotFoundError(fmt::format(
      "no package '{}' for '{}'. Looked in ROBOCELL_PACKAGES, ROS_PACKAGE_PATH, "
      "AMENT_PREFIX_PATH, ROBOCELL_MODEL_PATH and around the URDF{}. Say where it is: export "
      "ROBOCELL_PACKAGES={}=FOLDER, or --package {}=FOLDER, or put the folder that contains it "
      "into ROS_PACKAGE_PATH",
      package, name,
      known.empty() ? ""
                    : fmt::format("; given: {}.{}", ListNames(known), DidYouMean(package, known)),
      package, package));
}

void RosPackages::Remember(const fs::path& package) const {
  const fs::path manifest = fs::absolute(package / kManifest).lexically_normal();
  if (CanReadFile(manifest) &&
      std::find(manifests_.begin(), manifests_.end(), manifest) == manifests_.end())
    manifests_.push_back(manifest);
}

}  // namespace robocell::internal
