#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "framework/core/text/axis_names.hpp"
#include "framework/run/observers/kinds.hpp"
#include "framework/run/steps/run_plan.hpp"
#include "framework/run/window/blocking.hpp"

/// Statistical errors of means over the window, where there is a thermostat: each mean over equal
/// parts of the window is a series, whose scatter gives the error (blocking.hpp). A part is a
/// period of the first driver that has one, where the window has enough of them, else a block of
/// steps; doubled until there are not too many.
namespace tomlin::observers {
namespace {

constexpr std::size_t kMostParts = 1024;

/// A mean: what has been gained of some integrals, or of a centre's way.
struct Series {
  std::string path;
  std::string key;  ///< of its row
  struct Term {
    std::ptrdiff_t rate;
    double weight;
  };
  std::vector<Term> terms;
  std::size_t index = 0;  ///< body * dimension + axis, without terms
};

class MeanErrors : public RunObserver, public BlockObserver, public ErrorEstimator {
 public:
  explicit MeanErrors(const ObserverParts& parts) : parts_(parts) {
    find_series();
    now_.assign(series_.size(), 0.0);
    at_.assign(series_.size(), 0.0);
    means_.assign(kMostParts, 0.0);
  }

  ObserverFacets facets() override { return {.at_block_ends = this, .errors = this}; }

  void declare(StateLayout& layout) const override {
    layout.add_reals("mean_errors.sums", (kMostParts + 1) * series_.size());
    layout.add_reals("mean_errors.last", series_.size() + 2);
    layout.add_integers("mean_errors.count", 1);
  }
  void attach(RunState& state) override {
    sums_ = state.reals("mean_errors.sums");
    last_ = state.reals("mean_errors.last");
    last_time_ = last_ + series_.size();
    length_ = last_time_ + 1;
    count_ = state.integers("mean_errors.count");
  }

  /// The state's own integrals, at the edges those there.
  void edge(const RunMoment& moment) override {
    read_sums(moment.position, moment.integrals);
    if (*count_ != 0) {
      follow(moment.time);
      return;
    }
    *length_ = first_part();
    keep(now_);
    remember(moment.time);
  }

  void block_ended() override {
    if (*count_ == 0 || !parts_.window.is_open()) return;
    const SystemView<double>& view = parts_.run.model.system().view;
    read_sums(view.position, view.integrals);
    follow(parts_.run.clock.time());
  }

  /// Only the two ends of blocks around the end of a part are needed.
  double idle_until() const override {
    if (*count_ == 0 || !parts_.window.is_open()) return std::numeric_limits<double>::infinity();
    return end_of_part();
  }

  void results(ResultTable& table, const double*) const override {
    if (!parts_.window.is_over()) return;
    for (std::size_t k = 0; k < series_.size(); ++k) {
      if (!parts_.selection.wants(series_[k].key)) continue;
      const BlockedMean mean = blocked_mean_of(k);
      const double seen = mean.correlation_times;
      const double longer = !mean.error && seen > 0.0 ? kFewestCorrelationTimes / seen : 0.0;
      table.add_error(series_[k].path, mean.error, longer);
    }
  }

  std::vector<std::string> estimated() const override {
    std::vector<std::string> paths;
    for (const Series& one : series_) paths.push_back(one.path);
    return paths;
  }
  std::optional<double> error_so_far(std::string_view path) const override {
    const auto found = std::find_if(series_.begin(), series_.end(),
                                    [path](const Series& one) { return one.path == path; });
    if (found == series_.end()) return std::nullopt;
    return blocked_mean_of(static_cast<std::size_t>(found - series_.begin())).error;
  }

 private:
  /// Length that parts end up with in this window; shorter where the window may end before.
  double first_part() const {
    const RunContext& run = parts_.run;
    double length = part_of_window(run.model, run.plan.dt, parts_.window.length());
    if (run.scene->run.until) return length;
    while (length * static_cast<double>(kMostParts + 1) <= parts_.window.length()) length *= 2.0;
    return length;
  }

  void find_series() {
    const Model& model = parts_.run.model;
    for (const Model::Driver& driver : parts_.signals.drivers()) {
      std::vector<Series::Term> along;
      const double speed = drags(*driver.drive) ? speed_of(*driver.drive) : 0.0;
      for (std::size_t d = 0; d < parts_.axes(); ++d) {
        const auto rate = driver.first_rate + static_cast<std::ptrdiff_t>(d);
        series_.push_back({fmt::format("drivers.{}.mean_force.{}", driver.name, kAxisNames[d]),
                           "mean_force",
                           {{rate, 1.0}}});
        if (speed > 0.0) along.push_back({rate, driver.drive->velocity[d] / speed});
      }
      if (!along.empty()) {
        series_.push_back({fmt::format("drivers.{}.mean_force_along", driver.name),
                           "mean_force_along", std::move(along)});
      }
    }
    const SystemView<double>& view = model.system().view;
    std::size_t kinetic = 0;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      const Model::Body& body = model.bodies()[b];
      if (body.bound.slot.mapped && !body.bound.slot.rigid) continue;
      for (std::size_t d = 0; d < parts_.axes(); ++d) {
        series_.push_back(
            {fmt::format("bodies.{}.mean_velocity.{}", body.bound.name, kAxisNames[d]),
             "mean_velocity",
             {},
             b * parts_.axes() + d});
      }
      if (body.kinetic_rate == kNoRate) continue;
      const double* inverse = view.inverse_mass + view.kinetic[kinetic].first;
      const auto free = std::count_if(inverse, inverse + view.kinetic[kinetic].length,
                                      [](double inverse_mass) { return inverse_mass > 0.0; });
      ++kinetic;
      if (free == 0) continue;
      series_.push_back({fmt::format("bodies.{}.temperature", body.bound.name),
                         "temperature",
                         {{body.kinetic_rate, 2.0 / static_cast<double>(free)}}});
    }
  }

  void read_sums(const double* position, const double* integrals) {
    const Model& model = parts_.run.model;
    for (std::size_t k = 0; k < series_.size(); ++k) {
      const Series& one = series_[k];
      now_[k] = 0.0;
      for (const Series::Term& term : one.terms) now_[k] += term.weight * integrals[term.rate];
      if (!one.terms.empty()) continue;
      const std::size_t body = one.index / parts_.axes();
      const auto axis = static_cast<int>(one.index % parts_.axes());
      double centre[3];
      model.centre(body, position, centre);
      const DoubleDouble moved =
          model.placed(axis, centre[axis]) - parts_.window.from().position(one.index);
      now_[k] = static_cast<double>(moved);
    }
  }

  double end_of_part() const {
    return parts_.window.from().time + static_cast<double>(*count_) * *length_;
  }

  /// Sums at the ends of parts up to now, interpolated between the times that are looked at.
  void follow(double time) {
    for (;;) {
      const double end = end_of_part();
      if (!(end <= time)) break;
      const double part = time > *last_time_ ? (end - *last_time_) / (time - *last_time_) : 1.0;
      for (std::size_t k = 0; k < at_.size(); ++k) at_[k] = last_[k] + part * (now_[k] - last_[k]);
      keep(at_);
    }
    remember(time);
  }

  void remember(double time) {
    std::copy(now_.begin(), now_.end(), last_);
    *last_time_ = time;
  }

  void keep(const std::vector<double>& at) {
    const std::size_t width = series_.size();
    auto count = static_cast<std::size_t>(*count_);
    if (count == kMostParts + 1) {
      for (std::size_t j = 0; 2 * j <= kMostParts; ++j) {
        std::copy_n(sums_ + 2 * j * width, width, sums_ + j * width);
      }
      count = kMostParts / 2 + 1;
      *length_ *= 2.0;
      *count_ = static_cast<std::int64_t>(count);
      // This end is in the middle of a part now.
      return;
    }
    std::copy(at.begin(), at.end(), sums_ + count * width);
    *count_ = static_cast<std::int64_t>(count + 1);
  }

  BlockedMean blocked_mean_of(std::size_t k) const {
    const std::size_t width = series_.size();
    std::size_t count = 0;
    for (; static_cast<std::int64_t>(count) + 1 < *count_; ++count) {
      const double* sum = sums_ + count * width + k;
      means_[count] = (sum[width] - sum[0]) / *length_;
    }
    BlockedMean mean = blocked_mean_in_place({means_.data(), count});
    // Too few parts show no correlation: there are at most as many correlation times as parts.
    if (mean.correlation_times == 0.0) mean.correlation_times = static_cast<double>(count);
    return mean;
  }

  ObserverParts parts_;
  std::vector<Series> series_;
  std::vector<double> now_;
  std::vector<double> at_;             ///< scratch: at the end of a part
  mutable std::vector<double> means_;  ///< scratch: over parts
  double* sums_ = nullptr;             ///< [part][series], at the ends of parts
  double* last_ = nullptr;
  double* last_time_ = nullptr;
  double* length_ = nullptr;  ///< of a part
  std::int64_t* count_ = nullptr;
};

std::unique_ptr<RunObserver> make_mean_errors(const ObserverParts& parts) {
  if (!has_thermostat(*parts.run.scene)) return nullptr;
  return std::make_unique<MeanErrors>(parts);
}

}  // namespace

ObserverKind mean_errors() { return {.rows = {}, .make = make_mean_errors}; }

}  // namespace tomlin::observers
