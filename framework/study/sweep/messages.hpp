#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/text/fault_code.hpp"
#include "framework/study/sweep/process_link.hpp"
#include "framework/study/sweep/row.hpp"

/// What the processes of a sweep say to each other. Process 0, the server, has the queue and the
/// rows; the others, its clients, run points.
namespace tomlin {

/// A client's first message: which sweep it has, or why it has none.
struct SweepGreeting {
  std::uint64_t identity = 0;  ///< of the plan
  std::string fault;           ///< of the input; empty: none
  FaultCode code = FaultCode::program_internal_error;
};

/// A client's last message.
struct SweepFarewell {
  enum class Why : std::uint32_t { done, stopped, no_memory, not_written, failed } why = Why::done;
  std::string what;        ///< of an error
  std::size_t traces = 0;  ///< that it has completed
};

struct SweepMessage {
  enum class Kind : std::uint32_t {
    greeting,  ///< from clients
    request,   ///< from clients: so many points are wanted
    row,       ///< from clients
    ready,     ///< from clients, with a refinement: all points have been run
    farewell,  ///< from clients
    welcome,   ///< from the server: begin, or begin again: there are more points
    points,    ///< from the server: of a request; none are left
    stop       ///< from the server, and nothing after it
  } kind = Kind::stop;
  SweepGreeting greeting = {};
  std::size_t wanted = 0;
  std::size_t point = 0;
  SweepRow row = {};
  SweepFarewell farewell = {};
  std::vector<std::size_t> points = {};
  std::vector<double> values = {};  ///< of the refined axis at these points
};

std::vector<std::byte> encoded(const SweepMessage& message);
/// Throws DamagedFile where it is none.
SweepMessage decoded(std::vector<std::byte> bytes);

struct SweepMail {
  int from = 0;
  SweepMessage message;
};

void send(const ProcessLink& link, int to, const SweepMessage& message);
/// Nothing when nothing has come.
std::optional<SweepMail> next_mail(const ProcessLink& link);

/// Sleeps between looks for messages, longer and longer until one comes.
class MailPause {
 public:
  void sleep();
  void reset();

 private:
  double seconds_ = 0.0;
};

}  // namespace tomlin
