// Pairs: two sides (sides.h) that take turns, for rows in which a part of a percent counts.
// README.md, "Turns of a pair", gives the reasons.
//
//   void Register(const std::string& file) {
//     const auto arm = std::make_shared<Arm>(file);
//     AddPair({.ours = {.row = arm->name, .run = [=] { arm->Loop(); }},
//              .peer = {.run = [=] { arm->Replay(); }}});
//   }
//   int main(int argc, char** argv) { return robocell::bench::MainOfPairs(argc, argv, Register); }
//
// bench_program.py runs such a program and reads the counters `ours_s`, `peer_s` and `ratio`.
// `PROGRAM --turns ROW FILE` is ours of a pair alone, for a peer in another process (Python).
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <functional>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "sides.h"

namespace robocell::bench {

// Two sides with about the same work. They take turns: ours, the peer, the peer, ours, and so on.
// Neighbours, once in each order, make a ratio, and the median of all ratios counts: a changing
// clock affects both of them, a disturbance affects few short turns (less than a millisecond), and
// both orders are equally frequent. Times are medians of turns too.
struct Pair {
  Side ours, peer;                     // of the row of ours
  std::function<void()> next = [] {};  // before a round's turns, if it is about something else
};

inline double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Turns {
 public:
  explicit Turns(const Pair& pair) : pair_(pair) {}

  // Runs two turns of both sides; returns their seconds.
  double Round() {
    pair_.next();
    const size_t lower = random_() % 256 * 16;
    const double ours = Turn(lower, pair_.ours), peer = Turn(lower, pair_.peer);
    const double peer_again = Turn(lower, pair_.peer), ours_again = Turn(lower, pair_.ours);
    Take(ours, peer);
    Take(ours_again, peer_again);
    return ours + peer + peer_again + ours_again;
  }
  void Tell(benchmark::State& state) const {
    state.counters["ours_s"] = Median(ours_);
    state.counters["peer_s"] = Median(peer_);
    state.counters["ratio"] = Median(ratios_);
  }
  const std::string& problem() const { return problem_; }

 private:
  // The position of the stack beside the data, modulo a page, changes the time of microsecond tasks
  // by a percent or two, differently for both sides: a process would have only one of the possible
  // positions. Each round uses another one, the same for both.
  [[gnu::noinline]] double Turn(size_t lower, const Side& side) {
    volatile char* room = static_cast<char*>(__builtin_alloca(lower + 1));
    *room = 0;
    const double s = Seconds(side, &problem_);
    *room = 0;
    return s;
  }
  void Take(double ours, double peer) {
    ours_.push_back(ours / pair_.ours.count);
    peer_.push_back(peer / pair_.peer.count);
    ratios_.push_back(ours_.back() / peer_.back());
  }

  const Pair& pair_;
  std::minstd_rand random_;
  std::vector<double> ours_, peer_, ratios_;
  std::string problem_;
};

inline void TimePair(benchmark::State& state, const Pair& pair) {
  Turns warm_up(pair), turns(pair);
  warm_up.Round();  // the caches contain another row
  for (auto _ : state) {
    state.SetIterationTime(turns.Round());
    if (!turns.problem().empty()) return state.SkipWithError(turns.problem().c_str());
  }
  turns.Tell(state);
}

inline std::vector<Pair>& Pairs() {
  static std::vector<Pair> pairs;
  return pairs;
}

inline void AddPair(const Pair& pair) {
  Pairs().push_back(pair);
  const std::string name = pair.ours.row + "/turns";
  benchmark::RegisterBenchmark(name.c_str(),
                               [pair](benchmark::State& state) { return TimePair(state, pair); })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

// Returns true if another process requests one more turn. `said` is the message to it.
inline bool WaitForTurn(const std::string& said = "ready") {
  std::string line;
  std::cout << said << std::endl;
  return static_cast<bool>(std::getline(std::cin, line));
}

// Runs ours of a pair in turns and prints each in nanoseconds. The first run of a turn finds the
// caches full of the other process's data, and does not count.
inline void TakeTurns(const std::string& row) {
  const auto pair = std::find_if(Pairs().begin(), Pairs().end(),
                                 [&](const Pair& each) { return each.ours.row == row; });
  if (pair == Pairs().end()) throw std::runtime_error("there is no pair '" + row + "'");
  std::string problem, said = "ready";
  while (problem.empty() && WaitForTurn(said)) {
    pair->next();
    Seconds(pair->ours, &problem);
    said = std::to_string(1e9 * Seconds(pair->ours, &problem) / pair->ours.count);
  }
  if (!problem.empty()) throw std::runtime_error(row + ": " + problem);
}

// Like Main(), for a program with pairs.
inline int MainOfPairs(int argc, char** argv, void (*add)(const std::string&),
                       const std::string& file) {
  if (argc != 4 || argv[1] != std::string("--turns")) return Main(argc, argv, add, file);
  try {
    add(argv[3]);
    TakeTurns(argv[2]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  }
}

}  // namespace robocell::bench
