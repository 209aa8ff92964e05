#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "framework/study/sweep/row.hpp"
#include "framework/study/sweep/sweep_plan.hpp"
#include "tests/support/scenes.hpp"

/// Sweeps of scenes that are written in a test, with rows in memory.
namespace tomlin::test {

/// Names of axes, each with its values as they are given to --over.
using AxisTexts = std::vector<std::pair<std::string, std::string>>;

inline SweepSettings sweep_over(const AxisTexts& over,
                                const std::vector<std::vector<std::string>>& zips = {}) {
  SweepSettings settings;
  for (const auto& [name, values] : over) {
    settings.over.push_back(
        {name, std::get<SweepValues>(SweepValues::parse(values)), {"--over"}, values});
  }
  for (const auto& zip : zips) settings.zips.push_back({zip, {"--zip"}});
  return settings;
}

inline SweepPlan plan_of(const std::string& text, SweepSettings sweep,
                         const std::vector<Setting>& settings = {},
                         const std::string& version = "1.2.3") {
  return SweepPlan(SceneDocument(text, "test.toml"), standard(), settings, std::move(sweep),
                   version);
}

/// The plan of the [sweep] in a scene.
inline SweepPlan plan_in(const std::string& scene) {
  SceneDocument document(scene, "scene.toml");
  std::vector<Fault> faults;
  auto settings = document.sweep(faults);
  EXPECT_TRUE(settings && faults.empty());
  return SweepPlan(std::move(document), standard(), {}, std::move(settings).value(), "1.2.3");
}

/// Rows by point, in memory.
class RowsInMemory : public SweepRows {
 public:
  bool has(std::size_t point) const override { return before.contains(point); }
  void keep(std::size_t point, const SweepRow& row) override {
    const std::lock_guard lock(mutex_);
    EXPECT_TRUE(rows.emplace(point, row).second) << "twice: " << point;
  }
  std::vector<double> numbers(std::size_t column = 0) const {
    std::vector<double> all;
    for (const auto& [point, row] : rows) all.push_back(row.numbers[column]);
    return all;
  }

  std::set<std::size_t> before;
  std::map<std::size_t, SweepRow> rows;

 private:
  std::mutex mutex_;
};

/// A stop that is asked for after a time; its end waits for that.
class StopAfter {
 public:
  explicit StopAfter(std::chrono::microseconds wait)
      : thread_([this, wait] {
          std::this_thread::sleep_for(wait);
          stop_ = true;
        }) {}
  ~StopAfter() { thread_.join(); }
  StopAfter(const StopAfter&) = delete;
  StopAfter& operator=(const StopAfter&) = delete;

  const std::atomic<bool>* flag() const { return &stop_; }

 private:
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace tomlin::test
