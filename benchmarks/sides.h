// Sides of a row, timed by hand, and main(). Includes nothing of robocell's: also for programs of
// peers whose headers do not go together with ours.
//
//   void Register(const std::string& file) {
//     const auto arm = std::make_shared<Arm>(file);
//     Add({.row = arm->name, .side = "reset", .count = 200, .run = [=] { arm->Reset(200); }});
//     Add({.row = arm->name, .side = "forward", .count = 200, .run = [=] { arm->Forward(200); }});
//   }
//   int main(int argc, char** argv) { return robocell::bench::Main(argc, argv, Register); }
//
// bench_program.py runs such a program and reads the counter `each_s`.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace robocell::bench {

struct Side {
  std::string row, side;  // registered as "row/side"
  double count = 1;       // of what `each_s` is the time of one: ticks, resets, frames
  // Of a repetition's runs the fastest counts and not their mean: where all do the same, and take
  // so little that a machine that slows down for a tenth of a second would be in every mean.
  bool fastest = false;
  std::function<void()> prepare = [] {};  // before each run, not timed
  std::function<void()> run;
  // After each run, not timed: what is wrong with its result, or "". An error instead of a row.
  std::function<std::string()> problem = [] { return ""; };
};

inline void Time(benchmark::State& state, const Side& side) {
  double total = 0, fastest = HUGE_VAL;
  for (auto _ : state) {
    side.prepare();
    const auto begin = std::chrono::steady_clock::now();
    side.run();
    const double s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    state.SetIterationTime(s);
    total += s;
    fastest = std::min(fastest, s);
    if (const std::string problem = side.problem(); !problem.empty())
      return state.SkipWithError(problem.c_str());
  }
  const double run = side.fastest ? fastest : total / static_cast<double>(state.iterations());
  state.counters["each_s"] = run / side.count;
}

inline void Add(Side side) {
  const std::string name = side.row + "/" + side.side;
  benchmark::RegisterBenchmark(
      name.c_str(), [side = std::move(side)](benchmark::State& state) { return Time(state, side); })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

// `add` is called with each file on the command line, by default with `file`.
inline int Main(int argc, char** argv, void (*add)(const std::string&), const std::string& file) {
  try {
    benchmark::Initialize(&argc, argv);
    std::vector<std::string> files(argv + 1, argv + argc);
    if (files.empty()) files.push_back(file);
    for (const std::string& each : files) add(each);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  }
}

}  // namespace robocell::bench
