// Plugins: shared libraries that register kinds of tasks, experts, scene sources, samplers and
// features, for programs that name them (`robocell generate run.yaml --import libstack.so`, or
// `imports:` of a run file). A plugin has one function that registers, and says so once:
//
//   void RegisterStack() { robocell::RegisterTask<StackConfig>(...); ... }
//   ROBOCELL_PLUGIN(RegisterStack)
//
// It is linked with robocell::robocell of the same version; another one is refused, since the
// layout of classes may differ. Nothing loads a plugin because a dataset names it.
#pragma once

#include <string>
#include <type_traits>

#include "robocell/base/version.h"

namespace robocell {

// Loads a plugin and lets it register, once in a process: the path again does nothing. Returns the
// file's full path. IoError for a file that is not there or that cannot be loaded; ArgumentError
// for one that is no plugin, was built for another version, or whose registration failed before in
// this process, with that failure; what its function throws.
std::string LoadPlugin(const std::string& path);

// The full path of the plugin that registers on this thread just now; "" outside of LoadPlugin.
const std::string& PluginBeingLoaded();

// The plugin that defines the class of an object with virtual functions; "" for what belongs to the
// program or to robocell.
std::string PluginOfTable(const void* table_of_virtual_functions);
template <class T>
requires std::is_polymorphic_v<T> std::string PluginOf(const T& object) {
  return PluginOfTable(*reinterpret_cast<const void* const*>(&object));
}

}  // namespace robocell

// In one source file of a plugin, outside of namespaces: `function` takes nothing and registers.
#define ROBOCELL_PLUGIN(function)                                                           \
  extern "C" __attribute__((visibility("default"))) const char* robocell_plugin_version() { \
    return robocell::kHeaderVersion;                                                        \
  }                                                                                         \
  extern "C" __attribute__((visibility("default"))) void robocell_plugin_register() { function(); }
