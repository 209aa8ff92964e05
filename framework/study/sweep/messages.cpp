#include "framework/study/sweep/messages.hpp"

#include <algorithm>
#include <bitset>
#include <chrono>
#include <span>
#include <thread>
#include <utility>

#include "framework/output/record.hpp"

namespace tomlin {
namespace {

constexpr const char* kMessage = "a message between processes";
constexpr double kShortestPause = 50e-6;  // seconds
constexpr double kLongestPause = 2e-3;    // likewise

void put_row(RecordWriter& record, const SweepRow& row) {
  record.number(static_cast<std::uint32_t>(row.status));
  record.number(static_cast<std::uint64_t>(row.numbers.size()));
  record.numbers(row.numbers);
  record.text(row.reason);
  record.text(row.warnings.to_string());
}

SweepRow row_from(RecordReader& record) {
  SweepRow row;
  const auto status = record.number<std::uint32_t>();
  if (status >= kSweepStatuses) record.refuse("no status of a point");
  row.status = static_cast<SweepStatus>(status);
  row.numbers.resize(record.count(sizeof(double)));
  record.numbers(row.numbers);
  row.reason = record.text();
  const std::string warnings = record.text();
  if (warnings.size() != kMostWarningCodes) record.refuse("no warnings of a point");
  row.warnings = std::bitset<kMostWarningCodes>(warnings);
  return row;
}

}  // namespace

std::vector<std::byte> encoded(const SweepMessage& message) {
  using Kind = SweepMessage::Kind;
  RecordWriter record(RecordKind::sweep);
  record.number(static_cast<std::uint32_t>(message.kind));
  switch (message.kind) {
    case Kind::greeting:
      record.number(message.greeting.identity);
      record.text(message.greeting.fault);
      record.number(static_cast<std::uint32_t>(message.greeting.code));
      break;
    case Kind::request:
      record.number(static_cast<std::uint64_t>(message.wanted));
      break;
    case Kind::row:
      record.number(static_cast<std::uint64_t>(message.point));
      put_row(record, message.row);
      break;
    case Kind::farewell:
      record.number(static_cast<std::uint32_t>(message.farewell.why));
      record.text(message.farewell.what);
      record.number(static_cast<std::uint64_t>(message.farewell.traces));
      break;
    case Kind::points:
      record.number(static_cast<std::uint64_t>(message.points.size()));
      for (const std::size_t point : message.points) {
        record.number(static_cast<std::uint64_t>(point));
      }
      record.numbers(message.values);
      break;
    case Kind::ready:
    case Kind::welcome:
    case Kind::stop:
      break;
  }
  std::uint64_t checksum = kFirstChecksum;
  const auto sealed = record.seal(checksum);
  return {sealed.begin(), sealed.end()};
}

SweepMessage decoded(std::vector<std::byte> bytes) {
  using Kind = SweepMessage::Kind;
  std::uint64_t checksum = kFirstChecksum;
  RecordReader record(kMessage, record_content(kMessage, bytes, checksum));
  SweepMessage message;
  const auto kind = record.number<std::uint32_t>();
  if (kind > static_cast<std::uint32_t>(Kind::stop)) record.refuse("its kind is unknown");
  message.kind = static_cast<Kind>(kind);
  switch (message.kind) {
    case Kind::greeting:
      message.greeting.identity = record.number<std::uint64_t>();
      message.greeting.fault = record.text();
      message.greeting.code = static_cast<FaultCode>(record.number<std::uint32_t>());
      break;
    case Kind::request:
      message.wanted = record.number<std::uint64_t>();
      break;
    case Kind::row:
      message.point = record.number<std::uint64_t>();
      message.row = row_from(record);
      break;
    case Kind::farewell:
      message.farewell.why = static_cast<SweepFarewell::Why>(record.number<std::uint32_t>());
      message.farewell.what = record.text();
      message.farewell.traces = record.number<std::uint64_t>();
      break;
    case Kind::points:
      message.points.resize(record.count(sizeof(std::uint64_t)));
      for (std::size_t& point : message.points) point = record.number<std::uint64_t>();
      if (record.left() > 0) message.values.resize(message.points.size());
      record.numbers(message.values);
      break;
    case Kind::ready:
    case Kind::welcome:
    case Kind::stop:
      break;
  }
  record.end();
  return message;
}

void send(const ProcessLink& link, int to, const SweepMessage& message) {
  const std::vector<std::byte> bytes = encoded(message);
  link.send(link.context, to, bytes.data(), bytes.size());
}

std::optional<SweepMail> next_mail(const ProcessLink& link) {
  int from = 0;
  const std::ptrdiff_t size = link.poll(link.context, &from);
  if (size < 0) return std::nullopt;
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  link.receive(link.context, from, bytes.data(), bytes.size());
  return SweepMail{from, decoded(std::move(bytes))};
}

void MailPause::sleep() {
  seconds_ = std::clamp(2.0 * seconds_, kShortestPause, kLongestPause);
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds_));
}

void MailPause::reset() { seconds_ = 0.0; }

}  // namespace tomlin
