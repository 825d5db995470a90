#include "robocell/mujoco/guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mjbatch.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <stdexcept>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/step.h"

namespace robocell::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <class Function>
std::string MessageOf(Function fn) {
  try {
    fn();
  } catch (const EngineError& error) {
    return error.what();
  }
  return "no error";
}

ModelPtr Ball() {
  return Compile(
      ParseXmlString(
          "<mujoco><worldbody><body><freejoint/><geom size='.1'/></body></worldbody></mujoco>")
          .get());
}

TEST(Guard, ReturnsTheResultOfTheFunction) {
  EXPECT_EQ(Guarded("", [] { return 42; }), 42);
  int side_effect = 0;
  Guarded("", [&] { side_effect = 7; });
  EXPECT_EQ(side_effect, 7);
}

TEST(Guard, AnEngineErrorBecomesAnExceptionWithContextAndText) {
  EXPECT_EQ(MessageOf([] { Guarded("scene 'pick'", [] { mju_error("arm number %d broke", 3); }); }),
            "scene 'pick': arm number 3 broke");
  EXPECT_EQ(MessageOf([] { Guarded("", [] { mju_error("broke"); }); }), "broke");
}

TEST(Guard, VeryLongErrorTextIsCutNotOverrun) {
  const std::string longest(5000, 'x');
  const std::string text =
      MessageOf([&] { Guarded("here", [&] { mju_error("%s", longest.c_str()); }); });
  EXPECT_THAT(text, HasSubstr("here: xxxx"));
  EXPECT_LT(text.size(), 2100u);
}

TEST(Guard, NestedErrorsReachTheInnermostGuardAndTheOuterOneStillWorks) {
  const std::string text = MessageOf([] {
    Guarded("outer", [] {
      // Behaves like one of robocell's callbacks in the engine. The string lives outside of the
      // inner guard's frames only while the inner error is handled.
      const bool caught =
          MessageOf([] { Guarded("inner", [] { mju_error("first"); }); }) == "inner: first";
      mju_error(caught ? "second" : "inner error was lost");
    });
  });
  EXPECT_EQ(text, "outer: second");
}

TEST(Guard, ConcurrentErrorsOfTwoThreadsAreNotMixed) {
  constexpr int kErrors = 4000;
  int wrong[2] = {0, 0};
  auto work = [&](int thread) {
    for (int i = 0; i < kErrors; ++i) {
      const std::string tag = std::to_string(thread) + ":" + std::to_string(i);
      const std::string text =
          MessageOf([&] { Guarded(tag, [&] { mju_error("error %s", tag.c_str()); }); });
      if (text != tag + ": error " + tag) ++wrong[thread];
    }
  };
  std::thread first(work, 0), second(work, 1);
  first.join();
  second.join();
  EXPECT_EQ(wrong[0], 0);
  EXPECT_EQ(wrong[1], 0);
}

TEST(Guard, AnExceptionOfTheFunctionItselfPassesThrough) {
  EXPECT_THROW(Guarded("", [] { throw std::out_of_range("mine"); }), std::out_of_range);
  EXPECT_EQ(MessageOf([] { Guarded("after", [] { mju_error("x"); }); }), "after: x");
}

TEST(Guard, WarningsOfTheEngineGoToTheLog) {
  std::vector<std::string> lines;
  const ScopedLogSink sink([&](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarn) lines.emplace_back(text);
  });
  Guarded("", [] { mju_warning("contact buffer is full"); });
  mju_warning("outside of a guard");
  EXPECT_THAT(lines, ElementsAre("MuJoCo: contact buffer is full", "MuJoCo: outside of a guard"));
}

TEST(Guard, ACaptureKeepsWarningsFromTheLogAndNests) {
  std::vector<std::string> lines;
  const ScopedLogSink sink([&](LogLevel, std::string_view text) { lines.emplace_back(text); });
  WarningCapture outer;
  Guarded("", [] { mju_warning("one"); });
  {
    WarningCapture inner;
    Guarded("", [] { mju_warning("two"); });
    EXPECT_THAT(inner.messages(), ElementsAre("two"));
  }
  EXPECT_THAT(outer.messages(), ElementsAre("one"));
  EXPECT_TRUE(lines.empty());
}

TEST(Guard, DataIsUsableAfterAnErrorInTheMiddleOfAStep) {
  ModelPtr model = Ball();
  DataPtr data = MakeData(model.get()), fresh = MakeData(model.get());
  for (int i = 0; i < 100; ++i) {
    EXPECT_THROW(Guarded("", data.get(),
                         [&] {
                           mj_markStack(data.get());
                           mj_stackAllocNum(data.get(), 1000);
                           mju_error("in the middle");
                         }),
                 EngineError);
  }
  EXPECT_EQ(data->pstack, fresh->pstack);
  EXPECT_EQ(data->pbase, fresh->pbase);
  mj_resetData(model.get(), data.get());
  for (DataPtr* d : {&data, &fresh}) EXPECT_TRUE(Step(model.get(), d->get(), 50).ok());
  EXPECT_EQ(data->qpos[2], fresh->qpos[2]);
  EXPECT_NE(CopyData(model.get(), data.get()),
            nullptr);  // the engine rejects it while its stack is in use
}

TEST(Guard, ARealErrorOfTheEngineIsCaught) {
  ModelPtr model = Ball();
  DataPtr data = MakeData(model.get());
  const std::string text = MessageOf([&] {
    Guarded("asking too much", data.get(), [&] {
      mj_markStack(data.get());
      mj_stackAllocNum(data.get(), 1u << 30);
    });
  });
  EXPECT_THAT(text, HasSubstr("asking too much: "));
  EXPECT_THAT(text, HasSubstr("stack"));
}

thread_local std::string foreign_text;
void ForeignHandler(const mjLogMessage* message) { foreign_text = message->subject; }

TEST(Guard, WorksWithAForeignProcessWideHandler) {
  Guarded("", [] {});
  mjfLogHandler ours = mju_setLogHandler(&ForeignHandler);
  const std::string text = MessageOf([] { Guarded("here", [] { mju_error("mine"); }); });
  mju_warning("theirs");
  mju_setLogHandler(ours);
  EXPECT_EQ(text, "here: mine");
  EXPECT_EQ(foreign_text, "theirs");
}

void FailInEverySecondSimulation(const mjModel*, mjData*, int simulation, void* texts) {
  auto* text = static_cast<std::string*>(texts) + simulation;
  *text = MessageOf([&] {
    Guarded("in a batch", [&] {
      if (simulation % 2) mju_error("simulation %d", simulation);
    });
  });
}

TEST(Guard, WorksInsideABatchCallback) {
  ModelPtr model = Ball();
  mjBatch* batch = mjb_makeBatch(model.get(), 8, nullptr, nullptr, 0);
  std::string texts[8];
  EXPECT_EQ(mjb_apply(batch, nullptr, 8, &FailInEverySecondSimulation, texts, 0), 0);
  mjb_deleteBatch(batch);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(texts[i], i % 2 ? "in a batch: simulation " + std::to_string(i) : "no error");
  }
}

TEST(Guard, NoLogFileIsWritten) {
  std::filesystem::remove("MUJOCO_LOG.TXT");
  EXPECT_THROW(Guarded("", [] { mju_error("broke"); }), EngineError);
  const WarningCapture quiet;
  Guarded("", [] { mju_warning("careful"); });
  EXPECT_FALSE(std::filesystem::exists("MUJOCO_LOG.TXT"));
  EXPECT_FALSE(mju_getLogConfig().logto_file);
}

}  // namespace
}  // namespace robocell::internal
