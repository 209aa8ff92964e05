#include "framework/study/sweep/server.hpp"

#include <algorithm>
#include <chrono>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/output_file.hpp"

namespace tomlin {
namespace {

using Kind = SweepMessage::Kind;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kShowEvery{500};
/// Of the points that are left a client gets this part at most, divided by the number of clients,
/// so that none is busy long after the others.
constexpr std::size_t kShareOfTheRest = 4;

std::string name_of(int rank) { return fmt::format("process {}", rank); }

[[noreturn]] void throw_trouble(const SweepFarewell& trouble) {
  if (trouble.why == SweepFarewell::Why::no_memory) throw std::bad_alloc();
  if (trouble.why == SweepFarewell::Why::not_written) throw OutputError(trouble.what);
  throw std::runtime_error(trouble.what);
}

}  // namespace

SweepServer::SweepServer(const ProcessLink& link) : link_(link) {}

SweepServer::~SweepServer() {
  stop();
  MailPause pause;
  while (!all_have_gone()) {
    try {
      const auto mail = next_mail(link_);
      if (!mail) {
        pause.sleep();
      } else if (mail->message.kind == Kind::farewell) {
        ++gone_;
      }
    } catch (...) {  // a message that is none: the end is waited for all the same
    }
  }
}

void SweepServer::send_to_all(Kind kind) {
  for (int rank = 1; rank < link_.size; ++rank) send(link_, rank, {.kind = kind});
}

void SweepServer::stop() {
  if (!std::exchange(stopped_, true)) send_to_all(Kind::stop);
}

void SweepServer::note(const SweepFarewell& farewell) {
  ++gone_;
  traces_ += farewell.traces;
  if (farewell.why == SweepFarewell::Why::done) return;
  // One that was stopped by itself takes the others along.
  if (farewell.why != SweepFarewell::Why::stopped && !trouble_) trouble_ = farewell;
  stop();
}

void SweepServer::hand_out(int to, const SweepPlan& plan, std::vector<std::size_t> points) {
  SweepMessage message;
  message.kind = Kind::points;
  if (plan.refinement()) {
    for (const std::size_t point : points) {
      message.values.push_back(plan.number(plan.refinement()->axis, point));
    }
  }
  message.points = std::move(points);
  send(link_, to, message);
}

void SweepServer::meet(const SweepPlan& plan) {
  std::vector<Fault> faults;
  MailPause pause;
  for (int met = 0; met < clients();) {
    const auto mail = next_mail(link_);
    if (!mail) {
      pause.sleep();
      continue;
    }
    ++met;  // all that a client says before it is welcome
    const SweepGreeting& greeting = mail->message.greeting;
    if (!greeting.fault.empty()) {
      faults.emplace_back(greeting.code, Place{name_of(mail->from)}, "", "", greeting.fault);
    } else if (greeting.identity != plan.identity()) {
      faults.emplace_back(FaultCode::resume_other_scene, Place{name_of(mail->from)}, "", "",
                          "it has another scene, plugin or version of tomlin",
                          "the same files in every process");
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

SweepProgress SweepServer::run(const SweepPlan& plan, SweepRows& rows,
                               const SweepOptions& options) {
  std::optional<SweepQueue> queue;
  queue.emplace(plan, rows, options.part);
  int ready = 0;  // clients that have no more points
  SweepProgress progress = progress_before(plan, rows, options);
  const auto started = Clock::now();
  const auto elapsed = [&started] {
    return std::chrono::duration<double>(Clock::now() - started).count();
  };
  auto next_shown = started + kShowEvery;
  MailPause pause;
  if (!stopped_) send_to_all(Kind::welcome);
  while (!all_have_gone()) {
    if (options.stop != nullptr && options.stop->load()) stop();
    if (options.on_progress && Clock::now() >= next_shown) {
      next_shown = Clock::now() + kShowEvery;
      progress.seconds = elapsed();
      options.on_progress(progress);
    }
    const auto mail = next_mail(link_);
    if (!mail) {
      pause.sleep();
      continue;
    }
    pause.reset();
    const SweepMessage& message = mail->message;
    if (message.kind == Kind::row) {
      rows.keep(message.point, message.row);
      ++progress.done[static_cast<std::size_t>(message.row.status)];
    } else if (message.kind == Kind::farewell) {
      note(message.farewell);
    } else if (message.kind == Kind::request && !stopped_) {
      const std::size_t left = progress.points - progress.with_row();
      const std::size_t share = left / (kShareOfTheRest * static_cast<std::size_t>(clients()));
      const std::size_t most = std::min(message.wanted, std::max<std::size_t>(1, share));
      hand_out(mail->from, plan, queue->take(most));
    } else if (message.kind == Kind::ready && ++ready == clients() && !stopped_) {
      ready = 0;
      const bool has_more = progress.complete() && options.add_points && options.add_points();
      progress = progress_before(plan, rows, options, progress);
      if (has_more) {
        queue.emplace(plan, rows, options.part);
        send_to_all(Kind::welcome);
      } else {
        for (int rank = 1; rank < link_.size; ++rank) hand_out(rank, plan, {});
      }
    }
  }
  if (trouble_) throw_trouble(*trouble_);
  // It may have been stopped before the next round was made of the last one.
  if (progress.complete() && options.add_points && options.add_points()) {
    progress = progress_before(plan, rows, options, progress);
  }
  progress.traces_left -= std::min(traces_, progress.traces_left);
  progress.seconds = elapsed();
  return progress;
}

}  // namespace tomlin
