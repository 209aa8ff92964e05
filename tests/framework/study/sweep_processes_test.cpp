#include <atomic>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/output_file.hpp"
#include "framework/output/record.hpp"
#include "framework/study/sweep/bisection.hpp"
#include "framework/study/sweep/client.hpp"
#include "framework/study/sweep/journal.hpp"
#include "framework/study/sweep/messages.hpp"
#include "framework/study/sweep/process_link.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/server.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/ring_scenes.hpp"

/// A sweep that several processes share, with threads in the place of processes.
namespace tomlin::test {
namespace {

constexpr const char* kSharedTip = R"(
[parameters]
v = 1e-2
[[body]]
type = "point"
position = [0.5]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = ["v"]
[[force]]
type = "viscous_damping"
coefficient = 2.0
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0
[run]
duration = 5.0
integrator = { type = "rk4", dt = 2e-2 }
)";

SweepPlan shared_plan(const std::string& values = "0.01:0.1:20",
                      const std::vector<Setting>& settings = {}, bool continues = false,
                      const std::string& refine = "") {
  SweepSettings sweep;
  if (!refine.empty()) {
    sweep.refine.what = {refine, {"--refine"}, ""};
    sweep.refine.along = {"v", {"--refine-along"}, ""};
  }
  sweep.over.push_back({"v", std::get<SweepValues>(SweepValues::parse(values)), {"--over"}, ""});
  sweep.over.push_back(
      {"run.integrator.dt", std::get<SweepValues>(SweepValues::parse("2e-2,-1")), {"--over"}, ""});
  // Lines of many points, then.
  sweep.continues = continues;
  if (continues) std::swap(sweep.over[0], sweep.over[1]);
  sweep.observables = {"driver.mean_force.x"};
  return SweepPlan(SceneDocument(kSharedTip, "test.toml"), standard(), settings, std::move(sweep),
                   "1.2.3");
}

/// Mail between threads: a queue for each receiver and sender.
class Mailboxes {
 public:
  explicit Mailboxes(int size) {
    for (int rank = 0; rank < size; ++rank) {
      ends_.push_back(std::make_unique<End>(End{*this, rank, {}}));
      ProcessLink& link = ends_.back()->link;
      link.format = kProcessLinkFormat;
      link.rank = rank;
      link.size = size;
      link.context = ends_.back().get();
      link.send = &send;
      link.poll = &poll;
      link.receive = &receive;
    }
  }

  const ProcessLink& link(int rank) const { return ends_[static_cast<std::size_t>(rank)]->link; }
  /// All that was sent has been received.
  bool empty() {
    const std::lock_guard lock(mutex_);
    return mail_.empty();
  }

 private:
  struct End {
    Mailboxes& boxes;
    int rank;
    ProcessLink link;
  };
  struct Letter {
    int from;
    int to;
    std::vector<std::byte> bytes;
  };

  static void send(void* context, int to, const void* bytes, std::size_t size) {
    const End& end = *static_cast<End*>(context);
    const auto* first = static_cast<const std::byte*>(bytes);
    const std::lock_guard lock(end.boxes.mutex_);
    end.boxes.mail_.push_back({end.rank, to, {first, first + size}});
  }
  static std::ptrdiff_t poll(void* context, int* from) {
    const End& end = *static_cast<End*>(context);
    const std::lock_guard lock(end.boxes.mutex_);
    for (const Letter& letter : end.boxes.mail_) {
      if (letter.to != end.rank) continue;
      *from = letter.from;
      return static_cast<std::ptrdiff_t>(letter.bytes.size());
    }
    return -1;
  }
  static void receive(void* context, int from, void* bytes, std::size_t size) {
    const End& end = *static_cast<End*>(context);
    const std::lock_guard lock(end.boxes.mutex_);
    auto& mail = end.boxes.mail_;
    for (auto letter = mail.begin(); letter != mail.end(); ++letter) {
      if (letter->to != end.rank || letter->from != from) continue;
      ASSERT_EQ(letter->bytes.size(), size);
      std::memcpy(bytes, letter->bytes.data(), size);
      mail.erase(letter);
      return;
    }
    FAIL() << "nothing to receive";
  }

  std::mutex mutex_;
  std::deque<Letter> mail_;
  std::vector<std::unique_ptr<End>> ends_;
};

class SharedRows : public SweepRows {
 public:
  bool has(std::size_t point) const override { return before == point; }
  void keep(std::size_t point, const SweepRow& row) override {
    if (rows.size() == most) throw OutputError("no room");
    EXPECT_TRUE(rows.emplace(point, row).second) << "twice: " << point;
  }

  std::size_t before = ~std::size_t{0};  ///< the one that has a row
  std::size_t most = ~std::size_t{0};
  std::map<std::size_t, SweepRow> rows;
};

/// What the clients of a test do; each has a plan of its own, as processes have.
struct SharedSweep {
  int clients = 2;
  std::string values = "0.01:0.1:20";
  std::vector<Setting> settings = {};
  bool continues = false;
  std::string refine = "";
  SweepOptions options = {};
  std::map<int, std::string> values_of_others = {};  ///< of clients with another plan
  std::map<int, InputError> refused = {};            ///< of clients without a plan
  int stopped = 0;                                   ///< a client that a signal stops
  std::filesystem::path folder = {};                 ///< of the clients

  /// What `serve` does as process 0.
  void run(const std::function<void(SweepServer&, SweepPlan&)>& serve) {
    Mailboxes boxes(clients + 1);
    std::vector<std::thread> threads;
    for (int rank = 1; rank <= clients; ++rank) {
      threads.emplace_back([this, rank, &boxes] { be_client(boxes.link(rank)); });
    }
    SweepPlan plan = shared_plan(values, settings, continues, refine);
    try {
      SweepServer server(boxes.link(0));
      serve(server, plan);
    } catch (...) {
      for (std::thread& thread : threads) thread.join();
      EXPECT_TRUE(boxes.empty());
      throw;
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_TRUE(boxes.empty()) << "mail that nobody has received";
  }

 private:
  void be_client(const ProcessLink& link) const {
    if (const auto found = refused.find(link.rank); found != refused.end()) {
      SweepClient::refuse(link, found->second);
      return;
    }
    const auto other = values_of_others.find(link.rank);
    SweepPlan plan = shared_plan(other == values_of_others.end() ? values : other->second, settings,
                                 continues, refine);
    std::atomic<bool> stop = link.rank == stopped;
    SweepClient client(link, stop, [&stop] { stop = true; });
    client.run(plan, options, [this] { return folder; });
  }
};

std::string bytes_of_row(const SweepRow& row) {
  std::string text = std::string(to_string(row.status)) + row.reason + row.warnings.to_string();
  for (const double x : row.numbers) text += std::to_string(std::bit_cast<std::uint64_t>(x)) + " ";
  return text;
}

TEST(SweepProcesses, MessagesArriveAsTheyAre) {
  SweepMessage message;
  message.kind = SweepMessage::Kind::row;
  message.point = 1234567890123;
  message.row.status = SweepStatus::failed;
  message.row.numbers = {0.1, -0.0, std::numeric_limits<double>::quiet_NaN()};
  message.row.reason = "too \"long\"\n";
  message.row.warnings.set(3).set(kMostWarningCodes - 1);
  const std::vector<std::byte> bytes = encoded(message);
  const SweepMessage same = decoded(bytes);
  EXPECT_EQ(same.point, message.point);
  EXPECT_EQ(bytes_of_row(same.row), bytes_of_row(message.row));
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    auto changed = bytes;
    changed[k] ^= std::byte{4};
    EXPECT_THROW(decoded(changed), DamagedFile) << k;
    EXPECT_THROW(decoded({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(k)}),
                 DamagedFile)
        << k;
  }
  message = {};
  message.kind = SweepMessage::Kind::points;
  message.points = {0, 7, ~std::size_t{0}};
  EXPECT_EQ(decoded(encoded(message)).points, message.points);
  EXPECT_TRUE(decoded(encoded(message)).values.empty());
  message.values = {0.1, -0.0, 1e300};
  EXPECT_EQ(decoded(encoded(message)).values, message.values);
  EXPECT_EQ(decoded(encoded(message)).points, message.points);
}

/// Whether points continue from their neighbour or not.
class SweepProcessesOf : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Points, SweepProcessesOf, testing::Bool());

/// In any number of processes and threads each point is run once, and the rows are those of one.
TEST_P(SweepProcessesOf, HaveTheRowsOfOne) {
  const SweepPlan plan = shared_plan("0.01:0.1:20", {}, GetParam());
  SharedRows alone;
  run_sweep(plan, alone, {});
  for (const int clients : {1, 2, 5}) {
    for (const std::size_t threads : {1, 3}) {
      SharedSweep sweep;
      sweep.continues = GetParam();
      sweep.clients = clients;
      sweep.options.threads = threads;
      SharedRows rows;
      rows.before = 3;
      sweep.run([&](SweepServer& server, const SweepPlan& of_server) {
        server.meet(of_server);
        SweepOptions options;
        const SweepProgress progress = server.run(of_server, rows, options);
        EXPECT_TRUE(progress.complete());
        EXPECT_EQ(progress.points, 40);
        EXPECT_EQ(progress.before, 1);
      });
      EXPECT_EQ(rows.rows.size(), 39);
      EXPECT_FALSE(rows.rows.contains(3));
      for (const auto& [point, row] : rows.rows) {
        EXPECT_EQ(bytes_of_row(row), bytes_of_row(alone.rows[point])) << point;
      }
    }
  }
}

/// Process 0 adds the points, whatever the others are.
TEST(SweepProcesses, RefineLikeOne) {
  const std::string refine = "driver.mean_force.x=0.2";
  const auto read_all = [](const SweepPlan& plan, const SweepJournal& journal) {
    std::map<std::string, std::string> rows;
    for (std::size_t point = 0; point < plan.point_numbers(); ++point) {
      if (!plan.exists(point)) continue;
      SweepRow row;
      journal.read(point, {&row, 1});
      rows[plan.text(0, point) + " " + plan.text(1, point)] = bytes_of_row(row);
    }
    return rows;
  };
  const TemporaryFolder folder;
  SweepPlan plan = shared_plan("0.01:0.3:4", {}, false, refine);
  SweepJournal alone(folder.path() / "alone", plan);
  SweepBisection bisection(plan, alone);
  SweepOptions of_one;
  of_one.add_points = [&bisection] { return bisection.add_points(); };
  run_sweep(plan, alone, of_one);
  const auto rows = read_all(plan, alone);
  EXPECT_EQ(bisection.all().at(0).status, BisectionStatus::found);
  EXPECT_EQ(rows.size(), 8 + 12);  // 1e-4 of the axis is a third of it, halved 12 times
  for (const int clients : {1, 2, 5}) {
    for (const bool has_grid : {false, true}) {
      SharedSweep sweep;
      sweep.values = "0.01:0.3:4";
      sweep.refine = refine;
      sweep.clients = clients;
      sweep.run([&](SweepServer& server, SweepPlan& of_server) {
        const std::string name = std::to_string(clients) + (has_grid ? "+" : "");
        SweepJournal journal(folder.path() / name, of_server);
        SweepBisection of_process_0(of_server, journal);
        SweepOptions options;
        // All rows of the grid are there already.
        if (has_grid) run_sweep(of_server, journal, options);
        options.add_points = [&of_process_0] { return of_process_0.add_points(); };
        server.meet(of_server);
        const SweepProgress progress = server.run(of_server, journal, options);
        EXPECT_TRUE(progress.complete());
        EXPECT_EQ(progress.points, 20);
        EXPECT_EQ(progress.before, has_grid ? 8 : 0);
        EXPECT_EQ(read_all(of_server, journal), rows);
      });
    }
  }
}

/// Rows of a journal, until so many have come: then the sweep is to stop.
class StoppingRows : public SweepRows {
 public:
  StoppingRows(SweepJournal& journal, std::size_t most, std::atomic<bool>& stop)
      : journal_(journal), left_(most), stop_(stop) {}
  bool has(std::size_t point) const override { return journal_.has(point); }
  void keep(std::size_t point, const SweepRow& row) override {
    journal_.keep(point, row);
    if (left_ > 0 && --left_ == 0) stop_ = true;
  }

 private:
  SweepJournal& journal_;
  std::size_t left_;
  std::atomic<bool>& stop_;
};

/// Stopped after any row: it is complete only where the refinement has come to its end.
TEST(SweepProcesses, ARefinementThatIsStoppedIsNotComplete) {
  constexpr std::size_t kPoints = 20;  // as in RefineLikeOne
  const TemporaryFolder folder;
  for (std::size_t most = 1; most <= kPoints; ++most) {
    SharedSweep sweep;
    sweep.values = "0.01:0.3:4";
    sweep.refine = "driver.mean_force.x=0.2";
    sweep.run([&](SweepServer& server, SweepPlan& plan) {
      SweepJournal journal(folder.path() / std::to_string(most), plan);
      std::atomic<bool> stop = false;
      StoppingRows rows(journal, most, stop);
      SweepBisection bisection(plan, journal);
      SweepOptions options;
      options.stop = &stop;
      options.add_points = [&bisection] { return bisection.add_points(); };
      server.meet(plan);
      const SweepProgress progress = server.run(plan, rows, options);
      EXPECT_EQ(progress.complete(), progress.with_row() == kPoints) << most;
      if (!progress.complete()) return;
      EXPECT_EQ(bisection.all().at(0).status, BisectionStatus::found) << most;
    });
  }
}

TEST(SweepProcesses, APartIsSharedToo) {
  SharedSweep sweep;
  SharedRows rows;
  sweep.run([&](SweepServer& server, const SweepPlan& plan) {
    server.meet(plan);
    SweepOptions options;
    options.part = {1, 4};
    EXPECT_TRUE(server.run(plan, rows, options).complete());
  });
  EXPECT_EQ(rows.rows.size(), 10);
  EXPECT_TRUE(rows.rows.contains(1));
}

/// Points that would take for ever end soon when the server is stopped, or any other process.
TEST(SweepProcesses, AStopReachesAll) {
  for (const int stopped : {0, 1}) {
    SharedSweep sweep;
    sweep.settings = {{"run.duration", "1e9"}};
    sweep.options.threads = 2;
    sweep.stopped = stopped;
    SharedRows rows;
    std::atomic<bool> stop = false;
    const auto started = std::chrono::steady_clock::now();
    sweep.run([&](SweepServer& server, const SweepPlan& plan) {
      server.meet(plan);
      std::thread stopper([&stop, stopped] {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        if (stopped == 0) stop = true;
      });
      SweepOptions options;
      options.stop = &stop;
      const SweepProgress progress = server.run(plan, rows, options);
      EXPECT_FALSE(progress.complete());
      stopper.join();
    });
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - started;
    EXPECT_LT(seconds.count(), 20.0);  // it would be hours
  }
}

/// A server that never begins, as for --dry-run, sends its clients home.
TEST(SweepProcesses, EndWithoutABeginning) {
  SharedSweep sweep;
  sweep.refused.emplace(2, InputError({Fault(FaultCode::file_cannot_read)}));
  sweep.run([](SweepServer&, const SweepPlan&) {});
  EXPECT_THROW(sweep.run([](SweepServer&, const SweepPlan&) {
    throw InputError({Fault(FaultCode::file_cannot_read)});
  }),
               InputError);
}

TEST(SweepProcesses, InputThatDiffersIsRefusedOnce) {
  SharedSweep sweep;
  sweep.clients = 4;
  sweep.values_of_others = {{2, "0.01:0.1:21"}};
  sweep.refused.emplace(
      3, InputError({Fault(FaultCode::file_cannot_read, {"x.toml"}, "", "", "it is not there")}));
  try {
    sweep.run([](SweepServer& server, const SweepPlan& plan) { server.meet(plan); });
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    ASSERT_EQ(error.faults().size(), 2);
    std::map<std::string, FaultCode> codes;
    for (const Fault& fault : error.faults()) codes.emplace(fault.place.file, fault.code);
    EXPECT_EQ(codes["process 2"], FaultCode::resume_other_scene);
    EXPECT_EQ(codes["process 3"], FaultCode::file_cannot_read);
    EXPECT_NE(std::string(error.what()).find("it is not there"), std::string::npos);
  }
}

TEST(SweepProcesses, WhatCannotBeKeptEndsAll) {
  SharedSweep sweep;
  sweep.clients = 3;
  SharedRows rows;
  rows.most = 5;
  EXPECT_THROW(sweep.run([&](SweepServer& server, const SweepPlan& plan) {
    server.meet(plan);
    server.run(plan, rows, {});
  }),
               OutputError);
  EXPECT_EQ(rows.rows.size(), 5);
}

/// Traces are shared as well, and an error of any process is that of the sweep.
TEST(SweepProcesses, TracesAndErrorsOfClients) {
  const TemporaryFolder folder;
  SharedSweep sweep;
  sweep.options.traced = {0, 2, 4, 6, 8};
  sweep.folder = folder / "points";
  SharedRows rows;
  SweepOptions of_server;
  of_server.traced = sweep.options.traced;
  const auto serve = [&](SweepServer& server, const SweepPlan& plan) {
    server.meet(plan);
    EXPECT_EQ(server.run(plan, rows, of_server).traces_left, 0);
  };
  sweep.run(serve);
  for (const char* point : {"0", "2", "4", "6", "8"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "points" / point / "summary.json")) << point;
  }
  write(folder / "a file", "");
  sweep.folder = folder / "a file";
  rows.rows.clear();
  EXPECT_THROW(sweep.run(serve), std::exception);
}

}  // namespace
}  // namespace tomlin::test
