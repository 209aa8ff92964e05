#include "framework/study/sweep/client.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <new>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/output/output_file.hpp"

namespace tomlin {
namespace {

using Kind = SweepMessage::Kind;
using Clock = std::chrono::steady_clock;

/// What a process has of points in advance: so many that the way to the server costs little where
/// points are short. The server gives fewer when few are left.
constexpr double kSecondsInAdvance = 20e-3;
constexpr double kMostInAdvance = 256;

}  // namespace

/// The server's queue.
class SweepClient::Queue : public PointQueue {
 public:
  Queue(SweepClient& client, SweepPlan& plan) : client_(client), plan_(plan) {}

  std::vector<std::size_t> take(std::size_t most) override {
    const std::lock_guard lock(client_.mutex_);
    if (ready_.empty() && !is_empty_) fetch(most);
    std::size_t count = std::min(most, ready_.size());
    while (count > 0 && count < ready_.size() &&
           ready_[count] / plan_.line() == ready_[count - 1] / plan_.line()) {
      ++count;
    }
    std::vector<std::size_t> taken(ready_.begin(), ready_.begin() + static_cast<int>(count));
    ready_.erase(ready_.begin(), ready_.begin() + static_cast<int>(count));
    return taken;
  }

 private:
  void fetch(std::size_t least) {
    if (client_.was_sent_home_) return;
    const std::chrono::duration<double> since = Clock::now() - fetched_at_;
    const double pace = static_cast<double>(fetched_) / since.count();  // points per second
    const auto wanted =
        static_cast<std::size_t>(std::min(kMostInAdvance, kSecondsInAdvance * pace));
    send(client_.link_, 0, {.kind = Kind::request, .wanted = std::max(least, wanted)});
    const SweepMessage answer = client_.wait();
    ready_.assign(answer.points.begin(), answer.points.end());
    for (std::size_t k = 0; k < answer.values.size(); ++k) {
      if (answer.points[k] >= plan_.points()) plan_.add(answer.points[k], answer.values[k]);
    }
    is_empty_ = ready_.empty();
    fetched_ = ready_.size();
    fetched_at_ = Clock::now();
  }

  SweepClient& client_;
  SweepPlan& plan_;
  std::deque<std::size_t> ready_;
  bool is_empty_ = false;  ///< the server has no more
  std::size_t fetched_ = 0;
  Clock::time_point fetched_at_ = Clock::now();
};

/// The server's rows.
class SweepClient::Rows : public SweepRows {
 public:
  explicit Rows(SweepClient& client) : client_(client) {}

  /// The server hands out none that has.
  bool has(std::size_t) const override { return false; }
  void keep(std::size_t point, const SweepRow& row) override {
    const std::lock_guard lock(client_.mutex_);
    send(client_.link_, 0, {.kind = Kind::row, .point = point, .row = row});
  }

 private:
  SweepClient& client_;
};

SweepMessage SweepClient::wait() {
  MailPause pause;
  auto mail = next_mail(link_);
  for (; !mail; mail = next_mail(link_)) pause.sleep();
  heed(mail->message);
  return std::move(mail->message);
}

void SweepClient::heed(const SweepMessage& message) {
  if (message.kind != Kind::stop) return;
  was_sent_home_ = true;
  request_stop_();
}

/// While points are run. What comes unasked is a stop.
void SweepClient::look_for_stop() {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock() || was_sent_home_) return;
  if (const auto mail = next_mail(link_)) heed(mail->message);
}

/// Whether the server adds points to those that have all been run.
bool SweepClient::has_more() {
  if (was_sent_home_) return false;
  send(link_, 0, {.kind = Kind::ready});
  return wait().kind == Kind::welcome;
}

/// The last message; that of the server is a stop.
void SweepClient::say_farewell(const SweepFarewell& farewell) {
  send(link_, 0, {.kind = Kind::farewell, .farewell = farewell});
  while (!was_sent_home_) wait();
}

void SweepClient::refuse(const ProcessLink& link, const InputError& error) {
  SweepGreeting greeting;
  greeting.fault = error.what();
  if (!error.faults().empty()) greeting.code = error.faults().front().code;
  send(link, 0, {.kind = Kind::greeting, .greeting = greeting});
  const std::atomic<bool> stop = false;
  SweepClient client(link, stop, [] {});
  client.wait();  // for the stop
  client.say_farewell({});
}

void SweepClient::run(SweepPlan& plan, SweepOptions options,
                      const std::function<std::filesystem::path()>& folder) {
  SweepMessage greeting;
  greeting.kind = Kind::greeting;
  greeting.greeting.identity = plan.identity();
  send(link_, 0, greeting);
  SweepFarewell farewell;
  if (wait().kind == Kind::stop) {
    say_farewell(farewell);
    return;
  }
  Rows rows(*this);
  options.stop = &stop_;
  options.folder = folder();
  options.on_progress = [this](const SweepProgress&) { look_for_stop(); };
  const auto clients = static_cast<std::size_t>(link_.size - 1);
  options.processes = clients;
  std::vector<std::size_t> traced;
  for (std::size_t k = static_cast<std::size_t>(link_.rank - 1); k < options.traced.size();
       k += clients) {
    traced.push_back(options.traced[k]);
  }
  options.traced = std::move(traced);
  using Why = SweepFarewell::Why;
  const auto failed = [&](Why why, const char* what) {
    farewell = {why, fmt::format("process {}: {}", link_.rank, what)};
  };
  try {
    do {
      Queue queue(*this, plan);
      options.queue = &queue;
      const SweepProgress progress = run_sweep(plan, rows, options);
      farewell.traces = options.traced.size() - progress.traces_left;
    } while (plan.refinement() && !stop_ && has_more());
    if (stop_) farewell.why = Why::stopped;
  } catch (const std::bad_alloc& error) {
    failed(Why::no_memory, error.what());
  } catch (const OutputError& error) {
    failed(Why::not_written, error.what());
  } catch (const std::exception& error) {
    failed(Why::failed, error.what());
  }
  say_farewell(farewell);
}

}  // namespace tomlin
