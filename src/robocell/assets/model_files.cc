#include "robocell/assets/model_files.h"

#include <strings.h>
#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "robocell/assets/ros_packages.h"
#include "robocell/assets/urdf.h"
#include "robocell/base/error.h"
#include "robocell/base/lfs_pointer.h"
#include "robocell/base/real_file.h"

namespace robocell::internal {
namespace {

// The file references of one XML file of a model, as the engine's own parser (tinyxml2) reads them.

enum class NameKind { kAsset, kInclude, kModel };

struct FileName {
  NameKind kind = NameKind::kAsset;
  std::string name;  // folders are separated by `/`; the engine accepts `\` too
};

struct ModelText {
  std::string problem;  // why it is not XML; "" if it is
  std::vector<FileName> names;
  std::vector<std::string> folders;  // folders of assets: meshdir, texturedir, assetdir
  bool strips_paths = false;         // the engine removes folders from names
  bool is_urdf = false;
};

using tinyxml2::XMLElement;

std::string WithSlashes(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

bool Is(const XMLElement& element, const char* name) {
  return ::strcasecmp(element.Name(), name) == 0;
}

NameKind KindOf(const XMLElement& element) {
  if (Is(element, "include")) return NameKind::kInclude;
  return Is(element, "model") ? NameKind::kModel : NameKind::kAsset;
}

// Reads the attributes of all elements alike, to find elements that name files in the next engine
// too.
void ReadAttributes(const XMLElement& element, ModelText& text) {
  for (const auto* it = element.FirstAttribute(); it; it = it->Next()) {
    const std::string_view attribute = it->Name();
    const std::string value = WithSlashes(it->Value());
    if (attribute == "meshdir" || attribute == "texturedir" || attribute == "assetdir")
      text.folders.push_back(value);
    if (attribute == "strippath") text.strips_paths |= value == "true";
    if (attribute.starts_with("file") && !value.empty())
      text.names.push_back({KindOf(element), value});
  }
}

void ReadElements(const XMLElement& element, ModelText& text) {
  ReadAttributes(element, text);
  for (const auto* child = element.FirstChildElement(); child; child = child->NextSiblingElement())
    ReadElements(*child, text);
}

ModelText ReadModelText(std::string_view xml) {
  ModelText text;
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) {
    text.problem = document.ErrorStr();
  } else if (const XMLElement* root = document.RootElement()) {
    text.is_urdf = Is(*root, "robot");
    ReadElements(*root, text);
  } else {
    text.problem = "it has no element";
  }
  return text;
}

namespace fs = std::filesystem;

constexpr const char* kScheme = "it may be no file at all";

// Returns true for names like "package://arm/link.stl", which the engine first passes to the
// provider registered for "package".
bool HasScheme(std::string_view name) {
  const size_t colon = name.find(':');
  return colon != std::string_view::npos && colon > 0 &&
         std::all_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(colon), [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) || c == '+' || c == '-' || c == '.';
         });
}

bool MayNeverEnd(fs::file_type type) {
  return type == fs::file_type::fifo || type == fs::file_type::socket ||
         type == fs::file_type::character || type == fs::file_type::block;
}

// Joins them like the engine: a name that it takes for absolute stands alone.
fs::path Join(const fs::path& folder, const fs::path& name) {
  return name.native().find(":/") == std::string::npos ? folder / name : fs::absolute(name);
}

// Walks from a model to all files that it names. Includes are followed first: an asset folder set
// anywhere applies to the names in all of them.
class Walk {
 public:
  explicit Walk(const fs::path& model) { ReadModel(model); }

  ModelFiles Take() {
    return {.files = {files_.begin(), files_.end()},
            .missing = std::move(missing_),
            .no_files = std::move(no_files_)};
  }

 private:
  // One model with its includes. Other models that it names have asset folders of their own.
  struct Model {
    fs::path folder;
    std::set<fs::path> documents;
    std::set<std::string> folders = {""};
    bool strips_paths = false, is_urdf = false;
    struct Named {
      fs::path document;
      FileName name;
    };
    std::vector<Named> names;
  };

  void ReadModel(const fs::path& path) {
    if (!models_.insert(path).second) return;
    Model model{.folder = path.parent_path()};
    ReadDocument(model, path);
    if (model.is_urdf) return ReadMeshes(model, path);
    for (const auto& [document, name] : model.names) {
      for (const fs::path& found : Find(model, document, name)) {
        files_.insert(found);
        if (name.kind == NameKind::kModel) ReadModel(found);
      }
    }
  }

  // The meshes of a URDF, as ReadUrdf finds them.
  void ReadMeshes(const Model& model, const fs::path& urdf) {
    std::optional<RosPackages> packages;
    try {
      packages.emplace(urdf);
    } catch (const ArgumentError& error) {  // in ROBOCELL_PACKAGES
      missing_.push_back({urdf, "", error.what()});
      return;
    }
    const std::string folder = model.folders.size() > 1 ? *model.folders.rbegin() : "";
    for (const auto& [document, named] : model.names) {
      std::string name = named.name;
      if (model.strips_paths) name = fs::path(name).filename().string();
      if (!HasScheme(name)) name = (fs::path(folder) / name).string();
      try {
        const fs::path mesh = ReadableMesh(packages->File(name));
        std::error_code error;
        const fs::file_type type = fs::status(mesh, error).type();
        if (type == fs::file_type::regular) {
          files_.insert(mesh);
        } else if (MayNeverEnd(type)) {
          no_files_.push_back(
              {document, named.name, fmt::format("'{}' is {}", mesh.string(), WhatIsAt(mesh))});
        } else {
          missing_.push_back({document, named.name, "there is no such file"});
        }
      } catch (const Error& error) {
        missing_.push_back({document, named.name, error.what()});
      }
    }
    files_.insert(packages->manifests().begin(), packages->manifests().end());
  }

  void ReadDocument(Model& model, const fs::path& document) {
    files_.insert(document);
    if (!model.documents.insert(document).second) return;
    const ModelText text = ReadModelText(ReadRealFile(document));
    if (!text.problem.empty()) missing_.push_back({document, "", text.problem});
    model.strips_paths |= text.strips_paths;
    model.is_urdf |= text.is_urdf;
    for (const std::string& folder : text.folders) {
      if (HasScheme(folder)) missing_.push_back({document, folder, kScheme});
      model.folders.insert(folder);
    }
    for (const FileName& name : text.names) {
      if (name.kind != NameKind::kInclude) {
        model.names.push_back({document, name});
        continue;
      }
      for (const fs::path& found : Find(model, document, name)) ReadDocument(model, found);
    }
  }

  // Returns every file that the engine might open for it: from the folder of the model or of the
  // document, assets from the asset folders, with and without the folder in their name.
  static std::vector<fs::path> Candidates(const Model& model, const fs::path& document,
                                          const FileName& named) {
    const bool asset = named.kind == NameKind::kAsset;
    std::vector<fs::path> names = {named.name}, folders = {model.folder, document.parent_path()};
    if (asset && model.strips_paths) names.push_back(fs::path(named.name).filename());
    if (asset) {
      for (const std::string& folder : model.folders) folders.push_back(Join(model.folder, folder));
    }
    std::vector<fs::path> candidates;
    for (const fs::path& name : names) {
      for (const fs::path& folder : folders) candidates.push_back(Join(folder, name));
    }
    return candidates;
  }

  std::vector<fs::path> Find(const Model& model, const fs::path& document, const FileName& named) {
    std::vector<fs::path> found;
    for (const fs::path& candidate : Candidates(model, document, named)) {
      std::error_code error;
      const fs::path path = candidate.lexically_normal();
      const fs::file_type type = fs::status(path, error).type();
      if (type == fs::file_type::regular) found.push_back(path);
      if (MayNeverEnd(type))
        no_files_.push_back(
            {document, named.name, fmt::format("'{}' is {}", path.string(), WhatIsAt(path))});
    }
    const bool other = named.kind != NameKind::kAsset && HasScheme(named.name);
    if (found.empty() || other)
      missing_.push_back({document, named.name, other ? kScheme : "there is no such file"});
    return found;
  }

  std::set<fs::path> files_, models_;
  std::vector<MissingFile> missing_, no_files_;
};

}  // namespace

ModelFiles FindModelFiles(const fs::path& model) {
  return Walk(fs::absolute(model).lexically_normal()).Take();
}

void RequireOnlyFiles(const fs::path& model) {
  ModelFiles found;
  try {
    found = FindModelFiles(model);
  } catch (const IoError&) {
    return;
  }
  if (found.no_files.empty()) return;
  const MissingFile& first = found.no_files.front();
  throw SpecError(fmt::format(
      "model file '{}' names the file '{}', and {}, not a file. Write its content to a file first",
      first.document.string(), first.name, first.reason));
}

std::string AdviceAboutPointers(const fs::path& model) {
  try {
    return LfsPointerAdvice(FindModelFiles(model).files);
  } catch (const IoError&) {
    return "";
  }
}

FileSet ModelFileSet(const fs::path& model, const Hashing& hashing) {
  const fs::path absolute = fs::absolute(model).lexically_normal();
  return MakeFileSet(absolute, FindModelFiles(absolute).files, hashing);
}

}  // namespace robocell::internal
