#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <random>
#include <variant>
#include <vector>

#include "framework/core/records/force.hpp"

/// Descriptions of a force drawn at random from the rows of its own record.
namespace tomlin::test {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline std::size_t below(Random& random, std::size_t n) {
  return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
}

/// The bodies that the force acts on.
struct Arrangement {
  int dimension = 1;
  std::size_t count = 1;
  bool closed = false;  ///< a ring, or else particles in a row
  bool rigid = false;
  bool boxed = false;       ///< a periodic box along x joins the ends of the row
  std::size_t second = 0;   ///< particles of a second body; 0: there is none
  bool prescribed = false;  ///< the second body moves by a given motion

  /// Neighbours stand about one apart, those through the box's side too.
  /// Odd: no two particles are half a box apart, where the nearest image changes.
  double box_length() const {
    return boxed ? static_cast<double>(count + (count % 2 == 0 ? 1 : 0)) : 0.0;
  }
};

/// Arrangements with this many particles: rows and rings in 1, 2 and 3 dimensions, free and rigid,
/// closed by a box, and beside a second body where the force takes two.
inline std::vector<Arrangement> arrangements_of(const ForceRecord& record, std::size_t count) {
  std::vector<Arrangement> all;
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const bool closed : {false, true}) {
      if (closed && (dimension == 1 || count < 3)) continue;
      if (record.fewest_bodies == 1) {
        all.push_back({.dimension = dimension, .count = count, .closed = closed});
        all.push_back({.dimension = dimension, .count = count, .closed = closed, .rigid = true});
      }
      if (record.most_bodies > 1) {
        // The second body has another length, and is once the longer of the two.
        const std::size_t second = closed ? count + 2 : (count + 1) / 2;
        for (const bool prescribed : {false, true}) {
          all.push_back({.dimension = dimension,
                         .count = count,
                         .closed = closed,
                         .second = second,
                         .prescribed = prescribed});
        }
      }
    }
    if (record.fewest_bodies > 1 || count < 2) continue;
    all.push_back({.dimension = dimension, .count = count, .boxed = true});
  }
  return all;
}

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

/// Whether a key may be left out of a scene, so that at times it is: a number that may have either
/// sign, or numbers.
inline bool may_be_left_out(const Parameter& row) {
  if (std::holds_alternative<WordOrNumbers>(row.prototype)) return row.optional;
  if (!std::holds_alternative<double>(row.prototype)) return false;
  return row.optional || (row.standard && row.interval.low < 0.0);
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
      if (may_be_left_out(row) && below(random, 2) == 0) continue;
      row.assign(description.get(), random_value(row, arrangement, random));
    }
    const auto found = record.complaints(description.get(), outline);
    const auto is_fault = [](const Complaint& one) {
      return kind_of(one.code).severity == Severity::error;
    };
    if (std::none_of(found.begin(), found.end(), is_fault)) return description;
  }
  return nullptr;
}

}  // namespace tomlin::test
