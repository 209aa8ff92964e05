#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <mutex>
#include <utility>

#include "framework/core/text/fault.hpp"
#include "framework/study/sweep/messages.hpp"
#include "framework/study/sweep/plan.hpp"
#include "framework/study/sweep/process_link.hpp"
#include "framework/study/sweep/runner.hpp"

namespace tomlin {

/// Any other process of a sweep that several run together: it runs the points that SweepServer
/// hands out.
class SweepClient {
 public:
  /// `stop` is set by a signal, and by `request_stop` at the server's word. It and the link must
  /// outlive the client.
  SweepClient(const ProcessLink& link, const std::atomic<bool>& stop,
              std::function<void()> request_stop)
      : link_(link), stop_(stop), request_stop_(std::move(request_stop)) {}

  /// There is nothing to run: the server says why, in place of this process.
  static void refuse(const ProcessLink& link, const InputError& error);
  /// Until the server has no more points, with the threads of the options. `folder`, which is asked
  /// for once the server has begun, and the traced points are as in SweepOptions; every process has
  /// its share of the latter. Errors are the server's to report.
  void run(SweepPlan& plan, SweepOptions options,
           const std::function<std::filesystem::path()>& folder);

 private:
  class Queue;
  class Rows;

  /// The next message of the server, which comes. It may be stop.
  SweepMessage wait();
  void heed(const SweepMessage& message);
  void look_for_stop();
  bool has_more();
  void say_farewell(const SweepFarewell& farewell);

  const ProcessLink& link_;
  const std::atomic<bool>& stop_;
  std::function<void()> request_stop_;
  bool was_sent_home_ = false;  ///< the server says nothing more
  std::mutex mutex_;            ///< of the link
};

}  // namespace tomlin
