// Plugins: shared libraries that register kinds of tasks, experts, scene sources, samplers and
// features, for programs that name them (`robocell generate run.yaml --import libstack.so`, or
// `imports:` of a run file). A plugin has one function that registers, and declares it once:
//
//   void RegisterStack() { robocell::RegisterTask<StackConfig>(...); ... }
//   ROBOCELL_PLUGIN(RegisterStack)
//
// It is linked with robocell::robocell of the same version; others are rejected, because the layout
// of classes may differ. A dataset that names a plugin never loads it.
#pragma once

#include <string>
#include <type_traits>

#include "robocell/base/version.h"

namespace robocell {

// Loads a plugin and lets it register, once in a process: loading the path again does nothing.
// Returns the file's full path. Throws IoError for a file that does not exist or cannot be loaded;
// ArgumentError for one that is not a plugin, was built for another version, or whose registration
// failed before in this process, with that failure; and the exceptions of its function.
std::string LoadPlugin(const std::string& path);

// Returns the full path of the plugin that is registering on this thread; "" outside of LoadPlugin.
const std::string& PluginBeingLoaded();

// Returns the plugin that defines the class of an object with virtual functions; "" for a class of
// the program or of robocell.
std::string PluginOfTable(const void* table_of_virtual_functions);
template <class T>
requires std::is_polymorphic_v<T> std::string PluginOf(const T& object) {
  return PluginOfTable(*reinterpret_cast<const void* const*>(&object));
}

}  // namespace robocell

// Use it in one source file of a plugin, outside of namespaces: `function` takes no arguments and
// registers.
#define ROBOCELL_PLUGIN(function)                                                           \
  extern "C" __attribute__((visibility("default"))) const char* robocell_plugin_version() { \
    return robocell::kHeaderVersion;                                                        \
  }                                                                                         \
  extern "C" __attribute__((visibility("default"))) void robocell_plugin_register() { function(); }
