// SceneUse: which thread uses a scene now. One thread at a time may use a scene and everything that
// belongs to it. Where callers cannot know of each other, like the threads of Python, whose lock
// long calls release, a call claims the scene for its duration:
//
//   const SceneUse::Claim claim(scene.use(), "Env::Step");  // Error when another thread has it
//
// A claim never waits, so there is no deadlock: a reset hook that waits for another thread would
// wait for ever if that one waited for the reset.
//
// Any thread may use it. A claim costs a few nanoseconds.
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
  // calls them. `call` names the call in messages, and must outlive the claim. Each Begin needs an
  // End in the same thread. Throws Error if another thread has it: "scene 'pick' is in use by
  // another thread (Scene.step): ...".
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

  std::atomic<std::thread::id> thread_;  // the default: no thread
  std::atomic<const char*> call_ = nullptr;
  int depth_ = 0;  // depth on that thread
  std::string scene_;
};

}  // namespace robocell
