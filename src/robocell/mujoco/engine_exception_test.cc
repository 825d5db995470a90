#include "robocell/mujoco/engine_exception.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <stdexcept>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/owners.h"
#include "robocell/testing/leaks_of_others.h"

namespace robocell::internal {
namespace {

// A grid with so many points that the engine's container rejects them on any machine.
constexpr char kTooLarge[] = R"(<mujoco><asset>
  <mesh name="m" builtin="plate" params="100000 100000"/></asset></mujoco>)";

// Parses in the engine. Returns true if it threw.
bool Throws(const char* xml) {
  struct Call {
    const char* xml;
    mjSpec* spec;
    static void Run(void* self) {
      auto* call = static_cast<Call*>(self);
      call->spec = mj_parseXMLString(call->xml, nullptr, nullptr, 0);
    }
  } call{xml, nullptr};
  const LeaksOfOthers leaks;  // the engine leaks its objects when it throws
  EngineExceptions exceptions;
  const bool threw = !Guarded("parsing", [&] { return exceptions.Catch(&Call::Run, &call); });
  const SpecPtr spec(call.spec);
  return threw;
}

TEST(EngineExceptions, EngineExceptionsAreCaughtRepeatedly) {
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(Throws(kTooLarge));
    EXPECT_FALSE(Throws("<mujoco/>"));
  }
}

TEST(EngineExceptions, EachThreadCatchesItsOwnExceptions) {
  std::vector<int> caught(4);
  std::vector<std::thread> threads;
  for (int& count : caught) {
    threads.emplace_back([&count] {
      for (int i = 0; i < 50; ++i) count += Throws(kTooLarge) ? 1 : 0;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(caught, std::vector<int>(4, 50));
}

TEST(EngineExceptions, OtherExceptionsPassThroughAndUnwind) {
  struct Counted {
    int* left;
    ~Counted() { ++*left; }
  };
  static int left = 0;
  const auto call = [](void*) {
    const Counted counted{&left};
    throw std::runtime_error("ours");
  };
  EngineExceptions exceptions;
  EXPECT_THROW(exceptions.Catch(call, nullptr), std::runtime_error);
  EXPECT_EQ(left, 1);
  try {
    try {
      exceptions.Catch(call, nullptr);
    } catch (...) {
      exceptions.Catch([](void*) { throw; }, nullptr);
    }
    FAIL();
  } catch (const std::runtime_error&) {
  }
}

TEST(EngineExceptions, TheGuardStillHandlesEngineErrors) {
  const auto fail = [](void*) { mju_error("no %s", "way"); };
  for (int i = 0; i < 3; ++i) {
    EngineExceptions exceptions;
    EXPECT_THROW(Guarded("trying", [&] { exceptions.Catch(fail, nullptr); }), EngineError);
  }
  EXPECT_TRUE(Throws(kTooLarge));
}

TEST(EngineExceptions, TheInnermostHandlerCatches) {
  const auto outer = [](void* caught) { *static_cast<bool*>(caught) = Throws(kTooLarge); };
  bool caught = false;
  EngineExceptions exceptions;
  EXPECT_TRUE(exceptions.Catch(outer, &caught));
  EXPECT_TRUE(caught);
}

}  // namespace
}  // namespace robocell::internal
