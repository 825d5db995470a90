#include "robocell/render/graphics_advice.h"

#include <unistd.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>

#include "robocell/base/suggestions.h"
#include "robocell/render/egl_devices.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVendorFile = "/usr/share/glvnd/egl_vendor.d/10_nvidia.json";
constexpr const char* kVendorFolders[] = {"usr/share/glvnd/egl_vendor.d", "etc/glvnd/egl_vendor.d"};
constexpr const char* kLibraryFolders[] = {"usr/lib/x86_64-linux-gnu",
                                           "usr/lib/aarch64-linux-gnu",
                                           "usr/lib64",
                                           "usr/lib",
                                           "usr/local/nvidia/lib64",
                                           "usr/lib/nvidia",
                                           "usr/lib/x86_64-linux-gnu/nvidia/current"};

std::string FromEnvironment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// Returns "NAME=value" of the first variable that is set and, with `only`, has that value; else "".
std::string Setting(std::initializer_list<const char*> names, std::string_view only = "") {
  for (const char* name : names) {
    const std::string value = FromEnvironment(name);
    if (value.empty()) continue;
    return only.empty() || value == only ? std::string(name) + "=" + value : "";
  }
  return "";
}

bool HasDigitAfter(const std::string& name, const std::string& stem) {
  return name.size() > stem.size() && name.starts_with(stem) &&
         std::isdigit(static_cast<unsigned char>(name[stem.size()])) != 0;
}

// Returns the names in a folder, sorted; none if it is missing or may not be read.
std::vector<std::string> FileNames(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (fs::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    if (ignored) break;
    names.push_back(at->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> Nodes(const fs::path& root, const std::string& folder,
                               const std::string& stem, std::vector<std::string>& unreadable) {
  std::vector<std::string> nodes;
  for (const std::string& name : FileNames(root / folder)) {
    if (!HasDigitAfter(name, stem)) continue;
    nodes.push_back((fs::path("/") / folder / name).string());
    if (access((root / folder / name).c_str(), R_OK | W_OK) != 0)
      unreadable.push_back(nodes.back());
  }
  return nodes;
}

bool Mentions(const std::string& text, std::string_view what) {
  return text.find(what) != std::string::npos;
}

// The back end that draws where there is no OpenGL.
bool IsSoft(std::string_view description) { return description.starts_with("soft"); }

std::string NvidiaRemedy(std::string_view description, const GraphicsFacts& facts) {
  if (!facts.nvidia_library && facts.container) {
    const std::string now =
        facts.driver_capabilities.empty() ? "" : ", not " + facts.driver_capabilities + " as now";
    return fmt::format(
        "This container was started without the driver's graphics libraries. Start it with "
        "NVIDIA_DRIVER_CAPABILITIES=all{} (`docker run --gpus all -e "
        "NVIDIA_DRIVER_CAPABILITIES=all ...`)",
        now);
  }
  if (!facts.nvidia_library) {
    return "The driver's EGL library libEGL_nvidia.so.0 is missing. Install it: `sudo apt install "
           "libegl-nvidia0` (Debian), `sudo apt install libnvidia-gl-<version of the driver>` "
           "(Ubuntu)";
  }
  if (!facts.vendor_files.empty() && !Mentions(facts.vendor_files, "nvidia")) {
    return fmt::format(
        "__EGL_VENDOR_LIBRARY_FILENAMES={} hides the card's driver from EGL. Unset it, or put {} "
        "in front",
        facts.vendor_files, kVendorFile);
  }
  if (!facts.nvidia_vendor_file) {
    return fmt::format(
        "EGL does not know the driver. Write {} with the text "
        R"({{"file_format_version": "1.0.0", "ICD": {{"library_path": "libEGL_nvidia.so.0"}}}})",
        kVendorFile);
  }
  if (IsSoft(description)) return "OpenGL is missing. Install it: `sudo apt install libegl1`";
  return "The driver does not open the card. See what `nvidia-smi` says: library and kernel module "
         "may be of different versions";
}

std::string Remedy(std::string_view description, const GraphicsFacts& facts) {
  if (description.starts_with("osmesa") && !facts.gl_variable.empty()) {
    return fmt::format("{} selects OSMesa, which always draws on the processor. Unset the variable",
                       facts.gl_variable);
  }
  if (!facts.device_variable.empty())
    return fmt::format("{} chooses a device that is software. Unset it", facts.device_variable);
  if (!facts.nvidia.empty()) return NvidiaRemedy(description, facts);
  if (!facts.unreadable.empty()) {
    return fmt::format(
        "This user may not open {}. Join the group that it belongs to: `sudo "
        "usermod -aG render,video $USER`, then log in again",
        ListNames(facts.unreadable));
  }
  return "Install the card's OpenGL driver: `sudo apt install libegl1 libegl-mesa0 "
         "libgl1-mesa-dri`";
}

}  // namespace

GraphicsFacts ReadGraphicsFacts(const std::string& root) {
  const fs::path at = root;
  GraphicsFacts facts;
  facts.nvidia = Nodes(at, "dev", "nvidia", facts.unreadable);
  facts.dri = Nodes(at, "dev/dri", "renderD", facts.unreadable);
  std::error_code ignored;
  for (const char* folder : kLibraryFolders)
    facts.nvidia_library |= fs::exists(at / folder / "libEGL_nvidia.so.0", ignored);
  for (const char* folder : kVendorFolders) {
    for (const std::string& name : FileNames(at / folder))
      facts.nvidia_vendor_file |= Mentions(name, "nvidia");
  }
  facts.container =
      fs::exists(at / ".dockerenv", ignored) || fs::exists(at / "run/.containerenv", ignored);
  facts.vendor_files = FromEnvironment("__EGL_VENDOR_LIBRARY_FILENAMES");
  facts.driver_capabilities = FromEnvironment("NVIDIA_DRIVER_CAPABILITIES");
  facts.device_variable = Setting({"ROBOCELL_EGL_DEVICE", "MUJOCO_EGL_DEVICE_ID"});
  facts.gl_variable = Setting({"ROBOCELL_GL", "MUJOCO_GL"}, "osmesa");
  return facts;
}

std::string GraphicsAdvice(std::string_view description, const GraphicsFacts& facts) {
  if (!facts.has_gpu() || !(IsSoftwareRenderer(description) || IsSoft(description))) return "";
  return fmt::format(
      "images are drawn on the processor ({}), although this machine has a graphics "
      "card ({}). {}",
      description, (facts.nvidia.empty() ? facts.dri : facts.nvidia).front(),
      Remedy(description, facts));
}

}  // namespace robocell
