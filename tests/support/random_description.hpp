#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "framework/core/records/force.hpp"
#include "tests/support/force_bench.hpp"

/// Descriptions of a force drawn at random from the rows of its own record.
namespace tomlin::test {

inline double random_number(const Interval& interval, Random& random) {
  const bool from_zero = interval.low == 0.0;
  if (from_zero && !interval.low_open && below(random, 3) == 0) return 0.0;
  const double low = from_zero ? 0.3 : std::max(interval.low, -2.0);
  return uniform(random, low, std::min(interval.high, from_zero ? 3.0 : 2.0));
}

/// About a third of all pairs, each once and at least one.
inline std::vector<std::array<std::int64_t, 2>> random_pairs(const Arrangement& arrangement,
                                                             Random& random) {
  std::vector<std::array<std::int64_t, 2>> pairs;
  const bool two = arrangement.second > 0;
  const auto first = static_cast<std::int64_t>(arrangement.count);
  const auto second = two ? static_cast<std::int64_t>(arrangement.second) : first;
  for (std::int64_t i = 0; i < first; ++i) {
    for (std::int64_t j = two ? 0 : i + 1; j < second; ++j) {
      if (below(random, 3) != 0) continue;
      // Within a body either way round: a pair is a pair.
      const bool turned = !two && below(random, 2) == 0;
      pairs.push_back(turned ? std::array{j, i} : std::array{i, j});
    }
  }
  if (pairs.empty()) pairs.push_back({0, two ? 0 : 1});
  return pairs;
}

inline ParameterValue random_value(const Parameter& row, const Arrangement& arrangement,
                                   Random& random) {
  const std::size_t n = arrangement.count;
  const std::size_t other = arrangement.second;
  const auto sometimes = [&] { return below(random, 2) == 0; };
  if (std::holds_alternative<double>(row.prototype)) return random_number(row.interval, random);
  if (std::holds_alternative<SpaceVector>(row.prototype)) {
    SpaceVector vector;
    if (row.optional && sometimes()) return vector;
    for (int d = 0; d < arrangement.dimension; ++d) {
      vector.components.push_back(uniform(random, -2.0, 2.0));
    }
    return vector;
  }
  if (std::holds_alternative<PairSelection>(row.prototype)) {
    PairSelection pairs;
    // Between two bodies there are no neighbours.
    const std::size_t kind = other > 0 ? 2 * below(random, 2) : below(random, 3);
    if (kind == 0 || (n < 2 && other == 0)) {
      pairs.kind = PairSelection::Kind::all;
    } else if (kind == 2) {
      pairs.kind = PairSelection::Kind::list;
      pairs.list = random_pairs(arrangement, random);
    }
    return pairs;
  }
  if (std::holds_alternative<Attachment>(row.prototype)) {
    Attachment attachment;
    const std::size_t kind = below(random, 3);
    if (kind == 1) attachment.kind = Attachment::Kind::each_particle;
    if (kind == 2) {
      attachment.kind = Attachment::Kind::particle;
      attachment.particle = static_cast<std::int64_t>(below(random, n));
    }
    return attachment;
  }
  if (std::holds_alternative<WordOrNumbers>(row.prototype)) {
    WordOrNumbers value;
    const std::size_t kind = below(random, 3);
    if (kind == 0 && !row.choices.empty()) {
      value.word = row.choices[below(random, row.choices.size())];
      return value;
    }
    const std::size_t lengths[] = {1, n - 1, n, n * (n - 1) / 2, n * other};
    const std::size_t length = kind == 1 ? 1 : lengths[below(random, std::size(lengths))];
    for (std::size_t k = 0; k < std::max<std::size_t>(length, 1); ++k) {
      value.numbers.push_back(uniform(random, 0.3, 2.0));
    }
    return value;
  }
  if (std::holds_alternative<std::string>(row.prototype) && !row.choices.empty()) {
    return row.choices[below(random, row.choices.size())];
  }
  return row.standard.value_or(row.prototype);
}

/// Random parameters within the record's rows that its own checks accept; null when no draw does.
inline std::shared_ptr<void> random_description(const ForceRecord& record,
                                                const Arrangement& arrangement, Random& random) {
  SceneOutline outline;
  outline.dimension = arrangement.dimension;
  outline.box[0] = arrangement.box_length();
  const bool joined = arrangement.closed || arrangement.boxed;
  outline.bodies.push_back({"body", static_cast<std::int64_t>(arrangement.count), joined});
  if (arrangement.second > 0) {
    outline.bodies.push_back({"other", static_cast<std::int64_t>(arrangement.second), joined});
  }
  constexpr int kDraws = 200;
  for (int draw = 0; draw < kDraws; ++draw) {
    auto description = record.make_description();
    for (const Parameter& row : record.parameters) {
      row.assign(description.get(), random_value(row, arrangement, random));
    }
    if (record.complaints(description.get(), outline).empty()) return description;
  }
  return nullptr;
}

/// A copy with every number changed by up to `size`, relatively.
inline std::shared_ptr<void> shaken(const ForceRecord& record, const void* description, double size,
                                    Random& random) {
  const auto shake = [&](double& number) { number *= 1.0 + size * uniform(random, -1.0, 1.0); };
  auto copy = record.make_description();
  for (const Parameter& row : record.parameters) {
    ParameterValue value = row.read(description);
    if (auto* number = std::get_if<double>(&value)) shake(*number);
    if (auto* vector = std::get_if<SpaceVector>(&value)) {
      for (double& component : vector->components) shake(component);
    }
    // The period of a formula belongs to the formula.
    auto* numbers = std::get_if<WordOrNumbers>(&value);
    if (numbers != nullptr && row.key != "period") {
      for (double& number : numbers->numbers) shake(number);
    }
    row.assign(copy.get(), std::move(value));
  }
  return copy;
}

}  // namespace tomlin::test
