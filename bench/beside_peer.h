#pragma once

#include <benchmark/benchmark.h>

#include <chrono>
#include <utility>

namespace diminish {

template <class Work>
double milliseconds(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// Runs our code and the peer's in turn, so that a machine whose speed drifts slows both. The
/// benchmark's time is ours; `peer_ms` is the peer's, and `ratio` is the peer's time divided by
/// ours.
template <class Ours, class Peers>
void run_beside_peer(benchmark::State& state, Ours&& ours, Peers&& peers) {
  double ours_ms = 0;
  double peers_ms = 0;
  for (auto _ : state) {
    const double ms = milliseconds(ours);
    ours_ms += ms;
    state.SetIterationTime(ms / 1000);
    peers_ms += milliseconds(peers);
  }
  state.counters["peer_ms"] = peers_ms / static_cast<double>(state.iterations());
  state.counters["ratio"] = peers_ms / ours_ms;
}

}  // namespace diminish
