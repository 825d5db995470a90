#include "robocell/base/plugin.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <set>

#include "robocell/base/error.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

struct LoadedPlugins {
  std::mutex mutex;
  std::set<std::string> files;
};

LoadedPlugins& Loaded() {
  static LoadedPlugins plugins;
  return plugins;
}

// Null when the library has no such function.
template <class Function>
Function* FunctionOf(void* library, const char* name) {
  return reinterpret_cast<Function*>(dlsym(library, name));
}

thread_local std::string being_loaded;

}  // namespace

const std::string& PluginBeingLoaded() { return being_loaded; }

std::string LoadPlugin(const std::string& path) {
  std::error_code error;
  const std::string file = fs::canonical(path, error).string();
  if (error) throw IoError(fmt::format("cannot load plugin '{}': {}", path, error.message()));
  {
    const std::lock_guard lock(Loaded().mutex);
    if (Loaded().files.contains(file)) return file;
  }
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw IoError(fmt::format("cannot load plugin '{}': {}", path, dlerror()));
  auto* const version = FunctionOf<const char*()>(library, "robocell_plugin_version");
  auto* const registers = FunctionOf<void()>(library, "robocell_plugin_register");
  if (version == nullptr || registers == nullptr) {
    dlclose(library);
    throw ArgumentError(
        fmt::format("'{}' is no plugin: no source file of it says ROBOCELL_PLUGIN(function), see "
                    "robocell/base/plugin.h",
                    path));
  }
  if (const std::string built_for = version(); built_for != Version()) {
    dlclose(library);
    throw ArgumentError(
        fmt::format("plugin '{}' was built for robocell {}, and this is {}; build "
                    "it again",
                    path, built_for, Version()));
  }
  {
    // Before it registers: kinds are asked where they come from as soon as they are known. The
    // library stays, since kinds are never forgotten.
    const std::lock_guard lock(Loaded().mutex);
    Loaded().files.insert(file);
  }
  being_loaded = file;
  try {
    registers();
    being_loaded.clear();
  } catch (...) {
    being_loaded.clear();
    const std::lock_guard lock(Loaded().mutex);
    Loaded().files.erase(file);
    throw;
  }
  return file;
}

std::string PluginOfTable(const void* table) {
  {
    const std::lock_guard lock(Loaded().mutex);
    if (Loaded().files.empty()) return "";
  }
  Dl_info info;
  if (dladdr(table, &info) == 0 || info.dli_fname == nullptr) return "";
  std::error_code error;
  const std::string file = fs::canonical(info.dli_fname, error).string();
  const std::lock_guard lock(Loaded().mutex);
  return !error && Loaded().files.contains(file) ? file : "";
}

}  // namespace robocell
