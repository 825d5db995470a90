#include "robocell/base/plugin.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <utility>

#include "robocell/base/error.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

// A plugin whose function threw keeps its file here, because its earlier registrations stay valid
// and their code belongs in hashes.
struct PluginState {
  bool failed = false;  // its registration threw
  std::string failure;  // its text
};

struct LoadedPlugins {
  // One thread at a time loads; a plugin's function may load another plugin.
  std::recursive_mutex loading;
  std::mutex mutex;  // guards `files`
  std::map<std::string, PluginState> files;
};

LoadedPlugins& Loaded() {
  static LoadedPlugins plugins;
  return plugins;
}

// Returns null if the library has no such function.
template <class Function>
Function* FunctionOf(void* library, const char* name) {
  return reinterpret_cast<Function*>(dlsym(library, name));
}

thread_local std::string being_loaded;

// Names the plugin that registers on this thread, and restores the outer one at the end.
class BeingLoaded {
 public:
  explicit BeingLoaded(const std::string& file) : outer_(std::exchange(being_loaded, file)) {}
  ~BeingLoaded() { being_loaded = std::move(outer_); }
  BeingLoaded(const BeingLoaded&) = delete;
  BeingLoaded& operator=(const BeingLoaded&) = delete;

 private:
  std::string outer_;
};

void SetState(const std::string& file, PluginState state) {
  const std::lock_guard lock(Loaded().mutex);
  Loaded().files[file] = std::move(state);
}

// Returns true if the file is already loaded. Throws ArgumentError if its registration failed.
bool IsKnown(const std::string& file) {
  const std::lock_guard lock(Loaded().mutex);
  const auto found = Loaded().files.find(file);
  if (found == Loaded().files.end()) return false;
  if (!found->second.failed) return true;
  throw ArgumentError(fmt::format(
      "cannot load plugin '{}': its registration failed before: {}; start a new process", file,
      found->second.failure));
}

}  // namespace

const std::string& PluginBeingLoaded() { return being_loaded; }

std::string LoadPlugin(const std::string& path) {
  std::error_code error;
  const std::string file = fs::canonical(path, error).string();
  if (error) throw IoError(fmt::format("cannot load plugin '{}': {}", path, error.message()));
  const std::lock_guard loading(Loaded().loading);
  if (IsKnown(file)) return file;
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw IoError(fmt::format("cannot load plugin '{}': {}", path, dlerror()));
  auto* const version = FunctionOf<const char*()>(library, "robocell_plugin_version");
  auto* const registers = FunctionOf<void()>(library, "robocell_plugin_register");
  if (version == nullptr || registers == nullptr) {
    dlclose(library);
    throw ArgumentError(fmt::format(
        "'{}' is not a plugin: none of its source files contains ROBOCELL_PLUGIN(function), see "
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
  // Set before it registers: kinds are asked for their origin as soon as they exist. The library
  // stays loaded, because kinds are never unregistered.
  SetState(file, {});
  try {
    const BeingLoaded scope(file);
    registers();
  } catch (const Error& failure) {
    SetState(file, {.failed = true, .failure = failure.what()});
    throw;
  } catch (const std::exception& failure) {
    SetState(file, {.failed = true, .failure = failure.what()});
    throw Error(fmt::format("plugin '{}' failed to register: {}", path, failure.what()));
  } catch (...) {
    SetState(file, {.failed = true, .failure = "it threw no std::exception"});
    throw Error(fmt::format("plugin '{}' failed to register: it threw no std::exception", path));
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
