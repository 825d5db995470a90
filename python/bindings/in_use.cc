#include "in_use.h"

#include <fmt/format.h>

#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include "robocell/base/error.h"

namespace robocell::python {
namespace {

struct Uses {
  std::mutex mutex;
  std::unordered_map<const void*, Use> of;
  std::unordered_map<const void*, std::vector<std::function<void()>>> when_idle;
};

// They live as long as the module.
Uses& AllUses() {
  static auto* uses = new Uses;
  return *uses;
}

}  // namespace

std::optional<Use> Claim(const void* object, const char* done) {
  Uses& uses = AllUses();
  const std::lock_guard lock(uses.mutex);
  const auto [found, free] = uses.of.try_emplace(object, Use{std::this_thread::get_id(), done});
  return free ? std::nullopt : std::optional(found->second);
}

void Release(const void* object) {
  Uses& uses = AllUses();
  for (;;) {
    std::vector<std::function<void()>> waiting;
    {
      const std::lock_guard lock(uses.mutex);
      const auto found = uses.when_idle.find(object);
      if (found == uses.when_idle.end()) {
        uses.of.erase(object);
        return;
      }
      waiting = std::move(found->second);
      uses.when_idle.erase(found);
    }
    for (const std::function<void()>& f : waiting) f();  // the object is still claimed
  }
}

void WhenIdle(const void* object, std::function<void()> f) {
  Uses& uses = AllUses();
  {
    const std::lock_guard lock(uses.mutex);
    uses.when_idle[object].push_back(std::move(f));
    if (!uses.of.try_emplace(object, Use{std::this_thread::get_id(), "let go"}).second) return;
  }
  Release(object);
}

std::optional<Use> UseByOthers(const void* object) {
  Uses& uses = AllUses();
  const std::lock_guard lock(uses.mutex);
  const auto found = uses.of.find(object);
  if (found == uses.of.end() || found->second.thread == std::this_thread::get_id())
    return std::nullopt;
  return found->second;
}

void ThrowInUse(const std::string& thing, const Use& use) {
  const bool own = use.thread == std::this_thread::get_id();
  throw Error(fmt::format("{} is being {} by {}: one call at a time", thing, use.done,
                          own ? "this thread already" : "another thread"));
}

}  // namespace robocell::python
