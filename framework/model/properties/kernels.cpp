#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "framework/model/properties/force_under_test.hpp"

/// The several kernels of one force against each other: those that set against those that add, and
/// the one of a single particle on a line against the loop over particles.
namespace tomlin::properties {
namespace {

/// Content of arrays before a kernel that sets: it must not matter.
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

/// The numbers of forces that a pass writes, region by region.
class Written {
 public:
  Written(const ForceTwin<double>& twin, const Region& region, int axes)
      : slot_(twin.body(region.body).bound.slot),
        centre_(region.centre),
        from_(centre_        ? twin.view().force + slot_.centre
              : slot_.mapped ? twin.view().mapped_force + slot_.offset
                             : twin.view().force + slot_.offset),
        axes_(static_cast<std::size_t>(axes)) {}

  void fill(double value) const {
    for_all([&](std::size_t at, bool) { from_[at] = value; });
  }
  /// Numbers of the particles, or of the centre with its rotation.
  std::vector<double> numbers() const {
    std::vector<double> all;
    for_all([&](std::size_t at, bool padding) {
      if (!padding) all.push_back(from_[at]);
    });
    return all;
  }
  /// The largest number in the padding; NaN if there is one.
  double padding() const {
    double most = 0.0;
    for_all([&](std::size_t at, bool padding) {
      const double size = padding ? std::abs(from_[at]) : 0.0;
      if (!(size <= most)) most = std::isnan(most) ? most : size;
    });
    return most;
  }

 private:
  template <class Use>
  void for_all(Use&& use) const {
    // A centre's coordinates and its rotation, which is left zero where there is none.
    const std::size_t used = centre_ ? std::max<std::size_t>(axes_, kRotation + 1) : slot_.count;
    const std::size_t all = centre_ ? kGroup : (slot_.count + kGroup - 1) / kGroup * kGroup;
    for (std::size_t d = 0; d < (centre_ ? 1 : axes_); ++d) {
      for (std::size_t i = 0; i < all; ++i) use(d * slot_.stride + i, i >= used);
    }
  }

  const BodySlot<double>& slot_;
  bool centre_;
  double* from_;
  std::size_t axes_;
};

/// Passes that may set: the first on a region, of one region.
std::vector<Pass<double>> setting_passes(ForceTwin<double>& twin) {
  std::vector<Pass<double>> passes = twin.force().bound->passes();
  std::erase_if(passes, [](const Pass<double>& pass) {
    return pass.set == nullptr || pass.add == nullptr || pass.writes.size() != 1;
  });
  return passes;
}

/// Each pass that may set, over arrays of NaN; then `use` of it and what it wrote.
template <class Use>
void for_settings(ForceUnderTest& e, const State& state, ForceTwin<double>& twin, Use&& use) {
  e.put(state, twin);
  twin.evaluate(state.time);
  for (const Pass<double>& pass : setting_passes(twin)) {
    const Written written(twin, pass.writes.front(), e.alone().model().dimension());
    written.fill(kNoNumber);
    pass.set(pass.arguments, twin.stage());
    use(pass, written);
  }
}

void compare_set_with_add(ForceUnderTest& e, const State& state, ForceTwin<double>& twin) {
  for_settings(e, state, twin, [&](const Pass<double>& pass, const Written& written) {
    const std::vector<double> set = written.numbers();
    written.fill(0.0);
    pass.add(pass.arguments, twin.stage());
    e.note_same_numbers(set, written.numbers(), state);
  });
}

/// The first variable of the force's first body; the number of variables where it has none.
std::size_t variable_of_point(ForceUnderTest& e) {
  std::size_t first = 0;
  while (first < e.count() && e.variable(first).body != e.alone().force().bodies.front()) ++first;
  return first;
}

}  // namespace

bool has_setting_passes(ForceUnderTest& e) { return !setting_passes(e.twin()).empty(); }

/// On every instruction set, since each has kernels of its own.
bool set_and_add(ForceUnderTest& e, const State& state) {
  for (const InstructionSet set : supported_sets()) {
    compare_set_with_add(e, state, e.twin(set));
  }
  return true;
}

/// Sums over whole groups take it in.
bool padding(ForceUnderTest& e, const State& state) {
  for (const InstructionSet set : supported_sets()) {
    ForceTwin<double>& twin = e.twin(set);
    for_settings(e, state, twin, [&](const Pass<double>&, const Written& written) {
      e.note(written.padding(), 0.0, 0.0, 0.0, state);
    });
    twin.evaluate(state.time);
    for (const std::size_t b : twin.force().bodies) {
      const Written written(twin, {b, false}, e.alone().model().dimension());
      e.note(written.padding(), 0.0, 0.0, 0.0, state);
    }
  }
  return true;
}

PointForce<double> point_force_of(const ForceTwin<double>& twin) {
  const std::vector<Pass<double>> passes = twin.force().bound->passes();
  return passes.empty() ? PointForce<double>{} : passes.front().point;
}

bool has_point_kernel(ForceUnderTest& e) {
  const std::size_t variable = variable_of_point(e);
  return variable < e.count() && !e.twin().body(e.variable(variable).body).bound.slot.mapped &&
         point_force_of(e.twin()).run != nullptr;
}

/// Its force and, of a driver, its power. Of several bodies it acts on one.
bool point(ForceUnderTest& e, const State& state) {
  const std::size_t variable = variable_of_point(e);
  for (const InstructionSet set : supported_sets()) {
    ForceTwin<double>& twin = e.twin(set);
    const PointForce<double> point = point_force_of(twin);
    e.put(state, twin);
    twin.evaluate(state.time);
    const PointResult<double> result =
        point.run(point.parameters, state.x[variable], state.v[variable], point.start, 0.0);
    std::vector<double> found{result.force};
    std::vector<double> expected{twin.force_at(e.variable(variable).at)};
    if (point.rate != kNoRate) {
      const auto rate = static_cast<std::size_t>(point.rate);
      found.insert(found.end(), {result.force, result.power});
      expected.insert(expected.end(), {twin.rate(rate), twin.rate(rate + 1)});
    }
    e.note_same_numbers(found, expected, state);
  }
  return true;
}

}  // namespace tomlin::properties
