#include "robocell/assets/urdf.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "robocell/assets/ros_packages.h"
#include "robocell/assets/urdf_checks.h"
#include "robocell/base/error.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

constexpr size_t kHead = 1 << 16;  // bytes that contain the first element

std::string HeadOf(const fs::path& file) {
  std::string head(kHead, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(stream.gcount()));
  return head;
}

// Returns the name of the first element: "mujoco", "robot"; "" if there is none.
std::string RootElement(std::string_view xml) {
  for (size_t at = 0; (at = xml.find('<', at)) != std::string_view::npos; ++at) {
    const std::string_view rest = xml.substr(at + 1);
    if (rest.starts_with("!--")) {
      at = xml.find("-->", at);
      if (at == std::string_view::npos) return "";
    } else if (!rest.starts_with("?") && !rest.starts_with("!")) {
      return std::string(rest.substr(0, rest.find_first_of(" \t\r\n/>")));
    }
  }
  return "";
}

std::string Suffix(const fs::path& path) {
  std::string suffix = path.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return suffix;
}

bool IsReadableMesh(std::string_view suffix) {
  return suffix == ".stl" || suffix == ".obj" || suffix == ".msh";
}

// Returns "<xacro:macro>" for the first element that only xacro understands.
std::optional<std::pair<int, std::string>> FindXacro(const XMLElement& element) {
  const std::string_view name = element.Name();
  if (name.starts_with("xacro:")) return std::pair{element.GetLineNum(), fmt::format("<{}>", name)};
  for (const auto* it = element.FirstAttribute(); it; it = it->Next()) {
    const std::string_view value = it->Value();
    if (value.find("${") != std::string_view::npos || value.find("$(") != std::string_view::npos)
      return std::pair{element.GetLineNum(), fmt::format("{}=\"{}\"", it->Name(), value)};
  }
  for (const auto* child = element.FirstChildElement(); child;
       child = child->NextSiblingElement()) {
    if (auto found = FindXacro(*child)) return found;
  }
  return std::nullopt;
}

std::string XacroText(const fs::path& file, const std::string& what) {
  const std::string output =
      fs::path(file).replace_extension(file.extension() == ".urdf" ? ".plain.urdf" : "").string();
  const std::string target = fs::path(output).extension() == ".urdf" ? output : output + ".urdf";
  return fmt::format(
      "{} belongs to xacro, which makes URDFs from templates. Make the URDF, and give that: "
      "xacro {} > {} (xacro comes with ROS and with `pip install xacro`)",
      what, file.string(), target);
}

class Reader {
 public:
  explicit Reader(const fs::path& file) : packages_(file), problems_(file) { urdf_.file = file; }

  Urdf Read() {
    const std::string text = ReadRealFile(urdf_.file);
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
      problems_.Add(document.ErrorLineNum(),
                    fmt::format("not an XML file: {}. Correct it there, or get the file again",
                                document.ErrorStr()));
      problems_.Throw();
    }
    const XMLElement* root = document.RootElement();
    if (!root || std::string_view(root->Name()) != "robot") {
      problems_.Add(root ? root->GetLineNum() : 0,
                    "no URDF: its first element is not <robot>. Give the file whose is");
      problems_.Throw();
    }
    if (const auto xacro = FindXacro(*root)) {
      problems_.Add(xacro->first, XacroText(urdf_.file, xacro->second));
      problems_.Throw();
    }
    if (const char* name = root->Attribute("name")) urdf_.name = name;
    ReadMaterials(*root);
    for (const auto* it = root->FirstChildElement(); it; it = it->NextSiblingElement()) {
      const std::string_view kind = it->Name();
      if (kind == "link") ReadLink(*it);
      if (kind == "joint") ReadJoint(*it);
      if (kind == "transmission" || kind == "ros2_control") ReadTransmission(*it);
      if (kind == "mujoco") ReadMujoco(*it);
    }
    ReportUnreadableMeshes();
    for (UrdfJoint& joint : urdf_.joints)
      joint.has_transmission = transmitted_.contains(joint.name);
    ValidateUrdf(urdf_, problems_);
    problems_.Throw();
    urdf_.manifests = packages_.manifests();
    return std::move(urdf_);
  }

 private:
  void ReadMaterials(const XMLElement& element) {
    const char* name = element.Attribute("name");
    const XMLElement* color = element.FirstChildElement("color");
    if (std::string_view(element.Name()) == "material" && name && color) {
      if (const auto rgba = Numbers<4>(*color, "rgba", "material", name))
        materials_.emplace(name, *rgba);
    }
    for (const auto* it = element.FirstChildElement(); it; it = it->NextSiblingElement())
      ReadMaterials(*it);
  }

  // Sections for MuJoCo, which the engine itself reads.
  void ReadMujoco(const XMLElement& element) {
    tinyxml2::XMLPrinter printer(nullptr, true);
    element.Accept(&printer);
    urdf_.mujoco = printer.CStr();
    const XMLElement* compiler = element.FirstChildElement("compiler");
    const char* folder = compiler ? compiler->Attribute("meshdir") : nullptr;
    if (folder) meshdir_ = folder;
    strips_paths_ = compiler && compiler->Attribute("strippath", "true");
  }

  void ReadTransmission(const XMLElement& element) {
    const bool is_control = std::string_view(element.Name()) == "ros2_control";
    for (const auto* it = element.FirstChildElement("joint"); it;
         it = it->NextSiblingElement("joint")) {
      if (is_control && !it->FirstChildElement("command_interface")) continue;
      if (const char* name = it->Attribute("name")) transmitted_.insert(name);
    }
    urdf_.has_transmissions = !transmitted_.empty();
  }

  std::string Name(const XMLElement& element, const char* kind) {
    const char* name = element.Attribute("name");
    if (name && *name) return name;
    problems_.Add(element.GetLineNum(),
                  fmt::format("a <{}> has no name. Give it one: name=\"...\"", kind));
    return "";
  }

  void ReadLink(const XMLElement& element) {
    UrdfLink link{.name = Name(element, "link"), .line = element.GetLineNum()};
    const std::string place = fmt::format("link '{}'", link.name);
    if (const auto* inertial = element.FirstChildElement("inertial"))
      link.inertial = Inertial(*inertial, place);
    for (const auto* it = element.FirstChildElement(); it; it = it->NextSiblingElement()) {
      const std::string_view kind = it->Name();
      if (kind == "visual" || kind == "collision") ReadGeometry(*it, place, link);
    }
    urdf_.links.push_back(std::move(link));
  }

  UrdfInertial Inertial(const XMLElement& element, const std::string& place) {
    UrdfInertial inertial{.origin = Origin(element, place), .line = element.GetLineNum()};
    const auto* mass = element.FirstChildElement("mass");
    const auto* inertia = element.FirstChildElement("inertia");
    if (mass) inertial.mass = Number(*mass, "value", place, 0);
    constexpr std::array kNames = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
    for (size_t i = 0; inertia && i < kNames.size(); ++i)
      inertial.inertia[i] = Number(*inertia, kNames[i], place, 0);
    return inertial;
  }

  void ReadGeometry(const XMLElement& element, const std::string& place, UrdfLink& link) {
    UrdfGeometry out{.collision = std::string_view(element.Name()) == "collision",
                     .origin = Origin(element, place),
                     .line = element.GetLineNum()};
    if (const char* name = element.Attribute("name")) out.name = name;
    if (const auto* material = element.FirstChildElement("material")) {
      const char* name = material->Attribute("name");
      if (const auto* color = material->FirstChildElement("color")) {
        out.rgba = Numbers<4>(*color, "rgba", "material", name ? name : "");
      } else if (name && materials_.contains(name)) {
        out.rgba = materials_.at(name);
      }
    }
    const auto* geometry = element.FirstChildElement("geometry");
    const auto* shape = geometry ? geometry->FirstChildElement() : nullptr;
    const std::string kind = shape ? shape->Name() : "";
    if (kind == "box") {
      out.shape = UrdfShape::kBox;
      if (const auto size = Numbers<3>(*shape, "size", "", place)) out.size = *size;
    } else if (kind == "cylinder" || kind == "capsule") {
      out.shape = kind == "capsule" ? UrdfShape::kCapsule : UrdfShape::kCylinder;
      out.size = {Number(*shape, "radius", place), Number(*shape, "length", place), 0};
    } else if (kind == "sphere") {
      out.shape = UrdfShape::kSphere;
      out.size = {Number(*shape, "radius", place), 0, 0};
    } else if (kind == "mesh") {
      out.shape = UrdfShape::kMesh;
      out.size = {1, 1, 1};
      if (shape->Attribute("scale")) {
        if (const auto scale = Numbers<3>(*shape, "scale", "", place)) out.size = *scale;
      }
      if (!FindMesh(*shape, place, out)) return;
    } else {
      problems_.Add(
          out.line,
          fmt::format("{}: its <{}> has {}. Use box, cylinder, sphere, capsule or mesh", place,
                      element.Name(),
                      kind.empty() ? "no <geometry>" : "the unknown shape <" + kind + ">"));
      return;
    }
    const int sizes = out.shape == UrdfShape::kBox ? 3 : out.shape == UrdfShape::kSphere ? 1 : 2;
    for (int i = 0; out.shape != UrdfShape::kMesh && i < sizes; ++i) {
      if (out.size[static_cast<size_t>(i)] > 0) continue;
      problems_.Add(shape->GetLineNum(), fmt::format("{}: the size of its <{}> is not positive. "
                                                     "Give metres, or remove the shape",
                                                     place, kind));
      return;
    }
    link.geometry.push_back(std::move(out));
  }

  // Finds the file of a mesh; a Collada file is replaced by an OBJ or STL beside it.
  bool FindMesh(const XMLElement& element, const std::string& place, UrdfGeometry& out) {
    const char* name = element.Attribute("filename");
    const int line = element.GetLineNum();
    if (!name || !*name) {
      problems_.Add(line, place + ": a <mesh> has no filename. Give it one, or another shape");
      return false;
    }
    out.written = name;
    fs::path path;
    try {
      path = packages_.File(InMeshFolder(name));
    } catch (const Error& error) {
      problems_.Add(line, fmt::format("{}: its mesh: {}", place, error.what()));
      return false;
    }
    path = ReadableMesh(path);
    if (!CanReadFile(path)) {
      std::vector<std::string> neighbours;
      std::error_code error;
      for (fs::directory_iterator it(path.parent_path(), error), end; !error && it != end;
           it.increment(error))
        neighbours.push_back(it->path().filename().string());
      problems_.Add(line,
                    fmt::format("{}: there is no mesh file '{}' (named '{}').{} Put it there, or "
                                "correct the name",
                                place, path.string(), name,
                                DidYouMean(path.filename().string(), neighbours)));
      return false;
    }
    if (!IsReadableMesh(Suffix(path))) {
      if (unreadable_.empty()) unreadable_line_ = line;
      unreadable_.insert(path);
      return false;
    }
    out.mesh = path.string();
    return true;
  }

  // One command converts all meshes in formats that the engine does not read.
  void ReportUnreadableMeshes() {
    if (unreadable_.empty()) return;
    fs::path folder = unreadable_.begin()->parent_path();
    std::set<std::string> suffixes;
    std::vector<std::string> names;
    for (const fs::path& mesh : unreadable_) {
      while (!folder.empty() && folder.has_relative_path() &&
             *mesh.lexically_relative(folder).begin() == "..")
        folder = folder.parent_path();
      suffixes.insert(mesh.extension().string());
      names.push_back(mesh.filename().string());
    }
    std::string commands;
    for (const std::string& suffix : suffixes)
      commands += fmt::format(
          "python -c \"import pathlib, trimesh; [trimesh.load(f, force='mesh').export("
          "f.with_suffix('.obj')) for f in pathlib.Path('{}').rglob('*{}')]\"; ",
          folder.string(), suffix);
    commands.resize(commands.size() - 2);
    problems_.Add(
        unreadable_line_,
        fmt::format("{} in {} cannot be read: {}. MuJoCo reads OBJ, STL and MSH. Convert them to "
                    ".obj files beside them, which are then read in their place: pip install "
                    "trimesh pycollada; {}",
                    Counted(std::ssize(names), "mesh file"),
                    suffixes.contains(".dae") || suffixes.contains(".DAE") ? "Collada (.dae)"
                                                                           : *suffixes.begin(),
                    ListNames(names, 6), commands));
  }

  // Applies meshdir and strippath of <mujoco><compiler>, as the engine does.
  std::string InMeshFolder(const std::string& name) const {
    const std::string written = strips_paths_ ? fs::path(name).filename().string() : name;
    if (meshdir_.empty() || written.find("://") != std::string::npos) return written;
    return (fs::path(meshdir_) / written).string();
  }

  void ReadJoint(const XMLElement& element) {
    UrdfJoint joint{.name = Name(element, "joint"), .line = element.GetLineNum()};
    const std::string place = fmt::format("joint '{}'", joint.name);
    joint.parent = LinkOf(element, "parent", place);
    joint.child = LinkOf(element, "child", place);
    joint.origin = Origin(element, place);
    if (const auto* axis = element.FirstChildElement("axis")) {
      if (const auto xyz = Numbers<3>(*axis, "xyz", "", place)) joint.axis = *xyz;
    }
    ReadType(element, place, joint);
    if (const auto* dynamics = element.FirstChildElement("dynamics")) {
      joint.damping = Number(*dynamics, "damping", place, 0);
      joint.friction = Number(*dynamics, "friction", place, 0);
    }
    if (const auto* limit = element.FirstChildElement("limit")) {
      joint.effort = std::abs(Number(*limit, "effort", place, 0));
      joint.velocity = std::abs(Number(*limit, "velocity", place, 0));
    }
    ReadRange(element.FirstChildElement("limit"), place, joint);
    const auto* mimic = element.FirstChildElement("mimic");
    if (mimic && joint.type != UrdfJointType::kFixed) {
      joint.mimic = UrdfMimic{.multiplier = Number(*mimic, "multiplier", place, 1),
                              .offset = Number(*mimic, "offset", place, 0),
                              .line = mimic->GetLineNum()};
      if (const char* leader = mimic->Attribute("joint")) joint.mimic->joint = leader;
    }
    const double length = std::hypot(joint.axis[0], joint.axis[1], joint.axis[2]);
    if (joint.type != UrdfJointType::kFixed && joint.type != UrdfJointType::kFloating &&
        !(length > 1e-9))
      problems_.Add(joint.line, place +
                                    ": its axis has no length. Give a direction: <axis "
                                    "xyz=\"0 0 1\"/>");
    urdf_.joints.push_back(std::move(joint));
  }

  void ReadType(const XMLElement& element, const std::string& place, UrdfJoint& joint) {
    const char* written = element.Attribute("type");
    const std::string type = written ? written : "";
    if (type == "revolute") {
      joint.type = UrdfJointType::kRevolute;
    } else if (type == "continuous") {
      joint.type = UrdfJointType::kContinuous;
    } else if (type == "prismatic") {
      joint.type = UrdfJointType::kPrismatic;
    } else if (type == "fixed") {
      joint.type = UrdfJointType::kFixed;
    } else if (type == "floating") {
      joint.type = UrdfJointType::kFloating;
    } else if (type == "planar") {
      problems_.Add(joint.line,
                    place +
                        ": type=\"planar\" is not read. Write type=\"fixed\"; a robot that "
                        "drives over the floor says so in its robot file: base: {kind: planar}");
    } else {
      problems_.Add(joint.line,
                    fmt::format("{}: unknown type '{}'. The types: revolute, continuous, "
                                "prismatic, fixed, floating.{}",
                                place, type,
                                DidYouMean(type, {"revolute", "continuous", "prismatic", "fixed",
                                                  "floating"})));
    }
  }

  // A revolute joint without a range turns freely, as in other simulators; a URDF without `lower`
  // or `upper` means 0 there.
  void ReadRange(const XMLElement* limit, const std::string& place, UrdfJoint& joint) {
    if (joint.type != UrdfJointType::kRevolute && joint.type != UrdfJointType::kPrismatic) return;
    const bool given = limit && (limit->Attribute("lower") || limit->Attribute("upper"));
    const double lower = limit ? Number(*limit, "lower", place, 0) : 0;
    const double upper = limit ? Number(*limit, "upper", place, 0) : 0;
    if (given && lower < upper) {
      joint.range = {lower, upper};
      return;
    }
    urdf_.notes.push_back(fmt::format(
        "{}:{}: {} has no range ({}), so that it moves without limits: give lower < upper in "
        "<limit>",
        urdf_.file.string(), limit ? limit->GetLineNum() : joint.line, place,
        given ? fmt::format("lower {:g}, upper {:g}", lower, upper) : "no lower and upper"));
  }

  std::string LinkOf(const XMLElement& joint, const char* kind, const std::string& place) {
    const auto* element = joint.FirstChildElement(kind);
    const char* link = element ? element->Attribute("link") : nullptr;
    if (link && *link) return link;
    problems_.Add(
        joint.GetLineNum(),
        fmt::format("{}: it has no {}. Give it one: <{} link=\"...\"/>", place, kind, kind));
    return "";
  }

  UrdfOrigin Origin(const XMLElement& element, const std::string& place) {
    UrdfOrigin origin;
    const auto* written = element.FirstChildElement("origin");
    if (!written) return origin;
    if (written->Attribute("xyz")) {
      if (const auto xyz = Numbers<3>(*written, "xyz", "", place)) origin.xyz = *xyz;
    }
    if (written->Attribute("rpy")) {
      if (const auto rpy = Numbers<3>(*written, "rpy", "", place)) origin.rpy = *rpy;
    }
    return origin;
  }

  // Reads an attribute of `n` numbers. `what` and `name` are the place: "link 'arm'".
  template <size_t n>
  std::optional<std::array<double, n>> Numbers(const XMLElement& element, const char* attribute,
                                               const std::string& what, const std::string& name) {
    const char* text = element.Attribute(attribute);
    std::array<double, n> values{};
    std::string_view rest = text ? text : "";
    size_t count = 0;
    bool ok = true;
    while (ok) {
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
      if (rest.empty()) break;
      if (rest.front() == '+') rest.remove_prefix(1);
      double value = 0;
      const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
      ok = error == std::errc() && std::isfinite(value);
      rest.remove_prefix(static_cast<size_t>(end - rest.data()));
      ok &=
          rest.empty() || std::string_view(" \t\r\n").find(rest.front()) != std::string_view::npos;
      if (count < n) values[count] = value;
      ++count;
    }
    if (ok && count == n) return values;
    const std::string place = what.empty() ? name : fmt::format("{} '{}'", what, name);
    problems_.Add(element.GetLineNum(),
                  fmt::format("{}: {}=\"{}\" of <{}> is not {}. Write {} there", place, attribute,
                              text ? text : "", element.Name(), Counted(n, "finite number"),
                              n == 1 ? "a number" : Counted(n, "number")));
    return std::nullopt;
  }

  double Number(const XMLElement& element, const char* attribute, const std::string& place,
                std::optional<double> otherwise = std::nullopt) {
    if (otherwise && !element.Attribute(attribute)) return *otherwise;
    const auto value = Numbers<1>(element, attribute, "", place);
    return value ? (*value)[0] : otherwise.value_or(1);
  }

  Urdf urdf_;
  RosPackages packages_;
  UrdfProblems problems_;
  std::map<std::string, std::array<double, 4>> materials_;
  std::set<std::string> transmitted_;
  std::set<fs::path> unreadable_;  // meshes in other formats
  int unreadable_line_ = 0;
  std::string meshdir_;
  bool strips_paths_ = false;
};

}  // namespace

const UrdfLink* Urdf::link(std::string_view link_name) const {
  const auto it = std::find_if(links.begin(), links.end(),
                               [&](const UrdfLink& each) { return each.name == link_name; });
  return it == links.end() ? nullptr : &*it;
}

const UrdfJoint* Urdf::joint(std::string_view joint_name) const {
  const auto it = std::find_if(joints.begin(), joints.end(),
                               [&](const UrdfJoint& each) { return each.name == joint_name; });
  return it == joints.end() ? nullptr : &*it;
}

const UrdfJoint* Urdf::parent_joint(std::string_view link_name) const {
  const auto it = std::find_if(joints.begin(), joints.end(),
                               [&](const UrdfJoint& each) { return each.child == link_name; });
  return it == joints.end() ? nullptr : &*it;
}

std::vector<const UrdfLink*> Urdf::RigidWith(const UrdfLink& link) const {
  const UrdfLink* top = &link;
  for (const UrdfJoint* above = parent_joint(top->name);
       above && above->type == UrdfJointType::kFixed; above = parent_joint(top->name))
    top = this->link(above->parent);
  std::vector<const UrdfLink*> found = {top};
  for (size_t i = 0; i < found.size(); ++i) {
    for (const UrdfJoint& joint : joints) {
      if (joint.parent == found[i]->name && joint.type == UrdfJointType::kFixed)
        found.push_back(this->link(joint.child));
    }
  }
  return found;
}

bool Urdf::IsWeighed(const UrdfLink& link) const {
  const std::vector<const UrdfLink*> rigid = RigidWith(link);
  return std::any_of(rigid.begin(), rigid.end(),
                     [](const UrdfLink* each) { return each->has_mass(); });
}

fs::path ReadableMesh(const fs::path& mesh) {
  if (IsReadableMesh(Suffix(mesh))) return mesh;
  for (const char* other : {".obj", ".stl", ".OBJ", ".STL"}) {
    const fs::path beside = fs::path(mesh).replace_extension(other);
    if (CanReadFile(beside)) return beside;
  }
  return mesh;
}

bool IsUrdf(const fs::path& file) { return RootElement(HeadOf(file)) == "robot"; }

Urdf ReadUrdf(const fs::path& file) {
  const fs::path path = fs::absolute(file).lexically_normal();
  try {
    return Reader(path).Read();
  } catch (const ArgumentError& error) {
    throw SpecError(fmt::format("{}: ROBOCELL_PACKAGES: {}", path.string(), error.what()));
  }
}

}  // namespace robocell::internal
