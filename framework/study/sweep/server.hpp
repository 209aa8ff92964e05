#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "framework/study/sweep/messages.hpp"
#include "framework/study/sweep/plan.hpp"
#include "framework/study/sweep/process_link.hpp"
#include "framework/study/sweep/runner.hpp"

namespace tomlin {

/// Process 0 of a sweep that several processes run together: it hands out points and keeps their
/// rows, and runs none itself. Whatever happens to it, its clients are sent home when it ends.
class SweepServer {
 public:
  /// The link must outlive it.
  explicit SweepServer(const ProcessLink& link);
  /// Stops the clients and waits until all have ended.
  ~SweepServer();
  SweepServer(const SweepServer&) = delete;
  SweepServer& operator=(const SweepServer&) = delete;

  /// Waits until all clients have read their input. Throws InputError where one has another sweep
  /// or none.
  void meet(const SweepPlan& plan);
  /// As run_sweep() does, with the threads and checkpoints of the clients. Throws also what a
  /// client has thrown.
  SweepProgress run(const SweepPlan& plan, SweepRows& rows, const SweepOptions& options);

 private:
  int clients() const { return link_.size - 1; }
  bool all_have_gone() const { return gone_ == clients(); }
  void send_to_all(SweepMessage::Kind kind);
  void stop();
  void note(const SweepFarewell& farewell);
  void hand_out(int to, const SweepPlan& plan, std::vector<std::size_t> points);

  const ProcessLink& link_;
  int gone_ = 0;          ///< clients that have said farewell
  bool stopped_ = false;  ///< the clients know
  std::size_t traces_ = 0;
  std::optional<SweepFarewell> trouble_;  ///< the first
};

}  // namespace tomlin
