// Sides of a row, timed by hand, and main(). Includes nothing of robocell, so that programs of
// peers with incompatible headers can use it too.
//
//   void Register(const std::string& file) {
//     const auto arm = std::make_shared<Arm>(file);
//     Add({.row = arm->name, .side = "reset", .count = 200, .run = [=] { arm->Reset(200); }});
//     Add({.row = arm->name, .side = "forward", .count = 200, .run = [=] { arm->Forward(200); }});
//   }
//   int main(int argc, char** argv) { return robocell::bench::Main(argc, argv, Register); }
//
// bench_program.py runs such a program and reads the counter `each_s`. Where a part of a percent
// counts, use turns.h.
#pragma once

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace robocell::bench {

struct Side {
  std::string row, side;                  // registered as "row/side"
  double count = 1;                       // units of `each_s`: ticks, resets, frames
  std::function<void()> prepare = [] {};  // before each run, not timed
  std::function<void()> run;
  // Runs after each run, not timed: returns the problem of its result, or "". A problem makes the
  // row an error.
  std::function<std::string()> problem = [] { return ""; };
};

// Returns the seconds of a run. `problem` gets the problem of its result, unless it already has
// one.
inline double Seconds(const Side& side, std::string* problem) {
  side.prepare();
  const auto begin = std::chrono::steady_clock::now();
  side.run();
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  if (problem->empty()) *problem = side.problem();
  return passed.count();
}

inline void Time(benchmark::State& state, const Side& side) {
  double total = 0;
  std::string problem;
  for (auto _ : state) {
    const double s = Seconds(side, &problem);
    state.SetIterationTime(s);
    total += s;
    if (!problem.empty()) return state.SkipWithError(problem.c_str());
  }
  state.counters["each_s"] = total / static_cast<double>(state.iterations()) / side.count;
}

inline void Add(Side side) {
  const std::string name = side.row + "/" + side.side;
  benchmark::RegisterBenchmark(
      name.c_str(), [side = std::move(side)](benchmark::State& state) { return Time(state, side); })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

// Calls `add` with each file on the command line, by default with `file`.
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
