// Keeps a few expensive values between their uses: open files, running decoders. The caller alone
// owns a taken value until it gives it back. Above its limit the pool destroys the value that was
// idle longest.
//
//   IdlePool<Decoder> pool(8);
//   std::optional<Decoder> decoder = pool.Take([&](const Decoder& d) { return d.path == path; });
//   if (!decoder) decoder.emplace(path);
//   decoder->Read(pixels);            // an exception here destroys the decoder, as it should
//   pool.Give(std::move(*decoder));
//
// Any thread may use it. Before a fork all pools are emptied: both processes would share their
// values (pipes, file positions), and a child that closes descriptors would have values that use
// others.
#pragma once

#include <cstddef>
#include <iterator>
#include <list>
#include <mutex>
#include <optional>
#include <utility>

namespace robocell::internal {

// The part of a pool that a fork empties. All pools share one mutex. It is otherwise held for a few
// instructions, and never while something is opened or read.
class ForkSafePool {
 public:
  ForkSafePool(const ForkSafePool&) = delete;
  ForkSafePool& operator=(const ForkSafePool&) = delete;

 protected:
  ForkSafePool();
  // The derived class calls Leave() first, while it is complete.
  ~ForkSafePool() = default;
  void Leave();
  static std::mutex& Mutex();

 private:
  friend void EmptyBeforeFork();
  virtual void DropIdle() = 0;  // called with the mutex held
};

template <typename Value>
class IdlePool : private ForkSafePool {
 public:
  explicit IdlePool(size_t limit) : limit_(limit) {}
  ~IdlePool() { Leave(); }

  // Returns the most recently used idle value for which `fits(value)` holds; unset if there is
  // none.
  template <typename Fits>
  std::optional<Value> Take(const Fits& fits) {
    const std::lock_guard lock(Mutex());
    for (auto it = idle_.begin(); it != idle_.end(); ++it) {
      if (!fits(std::as_const(*it))) continue;
      std::optional<Value> found(std::move(*it));
      idle_.erase(it);
      return found;
    }
    return std::nullopt;
  }

  // Returns a copy of such a value, which stays in the pool: for values that many may use at once.
  template <typename Fits>
  std::optional<Value> Copy(const Fits& fits) {
    const std::lock_guard lock(Mutex());
    for (auto it = idle_.begin(); it != idle_.end(); ++it) {
      if (!fits(std::as_const(*it))) continue;
      idle_.splice(idle_.begin(), idle_, it);
      return idle_.front();
    }
    return std::nullopt;
  }

  void Give(Value value) {
    std::list<Value> own, dropped;  // destroyed after the lock is released
    own.push_back(std::move(value));
    const std::lock_guard lock(Mutex());
    idle_.splice(idle_.begin(), own);
    if (idle_.size() > limit_) dropped.splice(dropped.end(), idle_, std::prev(idle_.end()));
  }

  // Destroys the idle values.
  void Clear() {
    std::list<Value> dropped;
    const std::lock_guard lock(Mutex());
    dropped.swap(idle_);
  }

  size_t idle() const {
    const std::lock_guard lock(Mutex());
    return idle_.size();
  }

 private:
  void DropIdle() override { idle_.clear(); }

  size_t limit_;
  std::list<Value> idle_;  // most recently used first
};

}  // namespace robocell::internal
