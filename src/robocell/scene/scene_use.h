// SceneUse: which thread uses a scene now. A scene, with all that belongs to it, is used by one
// thread at a time. Where those who call cannot know of each other, as the threads of Python, whose
// lock long calls let go of, a call claims the scene for as long as it lasts:
//
//   const SceneUse::Claim claim(scene.use(), "Env::Step");  // Error when another thread has it
//
// Nobody waits, so there is no deadlock: a reset hook that waits for another thread would wait for
// ever if that one waited for the reset.
//
// Threads: all. A claim costs a few nanoseconds.
#pragma once

#include <atomic>
#include <string>
#include <thread>

namespace robocell {

class SceneUse {
 public:
  class Claim {
   public:
    Claim(SceneUse& use, const char* call) : use_(use) { use_.Begin(call); }
    ~Claim() { use_.End(); }
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

   private:
    SceneUse& use_;
  };

  // `scene`: "scene 'pick'", for messages.
  explicit SceneUse(std::string scene) : scene_(std::move(scene)) {}

  // Claims it for this thread, which may do so again before it ends: hooks call the scene that
  // calls them. `call` says in messages what it is for, and lives as long as this. Each Begin has
  // its End in the same thread.
  // Error when another thread has it: "scene 'pick' is in use by another thread (Scene.step): ...".
  void Begin(const char* call) {
    const std::thread::id self = std::this_thread::get_id();
    if (thread_.load(std::memory_order_relaxed) != self) {
      std::thread::id nobody;
      if (!thread_.compare_exchange_strong(nobody, self, std::memory_order_acquire,
                                           std::memory_order_relaxed))
        ThrowInUse();
      call_.store(call, std::memory_order_relaxed);
    }
    ++depth_;
  }
  void End() {
    if (--depth_ != 0) return;
    call_.store(nullptr, std::memory_order_relaxed);
    thread_.store({}, std::memory_order_release);
  }

  bool by_another_thread() const {
    const std::thread::id user = thread_.load(std::memory_order_relaxed);
    return user != std::thread::id() && user != std::this_thread::get_id();
  }

 private:
  [[noreturn]] void ThrowInUse() const;

  std::atomic<std::thread::id> thread_;  // the default: nobody's
  std::atomic<const char*> call_ = nullptr;
  int depth_ = 0;  // of that thread
  std::string scene_;
};

}  // namespace robocell
