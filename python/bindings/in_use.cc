#include "in_use.h"

#include <fmt/format.h>

#include <mutex>
#include <thread>
#include <unordered_map>

#include "robocell/base/error.h"

namespace robocell::python {
namespace {

struct Use {
  std::thread::id thread;
  const char* done = "";
};

struct Uses {
  std::mutex mutex;
  std::unordered_map<const void*, Use> of;
};

// They live as long as the module.
Uses& AllUses() {
  static auto* uses = new Uses;
  return *uses;
}

[[noreturn]] void ThrowInUse(const std::string& thing, const Use& use) {
  const bool own = use.thread == std::this_thread::get_id();
  throw Error(fmt::format("{} is being {} by {}: one call at a time", thing, use.done,
                          own ? "this thread already" : "another thread"));
}

}  // namespace

InUse::InUse(const void* object, const std::string& thing, const char* done) : object_(object) {
  Uses& uses = AllUses();
  const std::lock_guard lock(uses.mutex);
  const auto [found, free] = uses.of.try_emplace(object, Use{std::this_thread::get_id(), done});
  if (!free) ThrowInUse(thing, found->second);
}

InUse::~InUse() {
  Uses& uses = AllUses();
  const std::lock_guard lock(uses.mutex);
  uses.of.erase(object_);
}

void RequireIdle(const void* object, const std::string& thing) {
  Uses& uses = AllUses();
  const std::lock_guard lock(uses.mutex);
  const auto found = uses.of.find(object);
  if (found == uses.of.end() || found->second.thread == std::this_thread::get_id()) return;
  ThrowInUse(thing, found->second);
}

}  // namespace robocell::python
