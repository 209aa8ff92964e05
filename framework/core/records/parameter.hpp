#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "framework/core/text/words.hpp"

/// Parameters declared once: a row names key, member, dimension, default, interval and doc; the
/// same row reads a scene, validates, documents and writes the effective scene.
namespace tomlin {

/// Exponents of mass, length, time and temperature. In the engine Boltzmann's constant is 1, so
/// that a temperature is an energy there; the scene's units say which one (unit_system.hpp).
struct Dimension {
  int mass = 0;
  int length = 0;
  int time = 0;
  int temperature = 0;
  friend bool operator==(const Dimension&, const Dimension&) = default;
};

/// "mass/time", "length", "1" for a pure number.
std::string to_string(const Dimension& dimension);
/// "a*b^2/c" of {a, 1}, {b, 2}, {c, -1}; "1" where all exponents are 0.
std::string product_of_powers(std::span<const std::pair<std::string_view, int>> factors);

namespace dimension {
inline constexpr Dimension none{};
inline constexpr Dimension mass{1, 0, 0};
inline constexpr Dimension length{0, 1, 0};
inline constexpr Dimension time{0, 0, 1};
inline constexpr Dimension velocity{0, 1, -1};
inline constexpr Dimension rate{0, 0, -1};
inline constexpr Dimension force{1, 1, -2};
inline constexpr Dimension energy{1, 2, -2};
inline constexpr Dimension stiffness{1, 0, -2};
inline constexpr Dimension friction{1, 0, -1};
inline constexpr Dimension inverse_area{0, -2, 0};
inline constexpr Dimension temperature{0, 0, 0, 1};
}  // namespace dimension

/// Admissible values of a number; nan and inf are never admissible.
struct Interval {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = true;
  bool high_open = true;

  bool contains(double x) const;
  /// "> 0", ">= 0", "0 to 1", "any finite number".
  std::string to_string() const;
};

inline constexpr Interval any_number{};
inline constexpr Interval positive{.low = 0.0};
inline constexpr Interval non_negative{.low = 0.0, .low_open = false};

/// Selection of particle pairs of a body: `pairs = "all"`, `"neighbours"` or `[[0, 1], ...]`.
struct PairSelection {
  enum class Kind { all, neighbours, list } kind = Kind::neighbours;
  std::vector<std::array<std::int64_t, 2>> list;
  friend bool operator==(const PairSelection&, const PairSelection&) = default;
};

constexpr auto word_table(PairSelection::Kind) {
  using enum PairSelection::Kind;
  return std::to_array<Word<PairSelection::Kind>>(
      {{all, "all"}, {neighbours, "neighbours"}, {list, nullptr}});
}

/// A word or numbers: `rest_lengths = "initial"`, `1.0` or `[1.0, ...]`.
struct WordOrNumbers {
  std::string word;             ///< one of the row's choices, or empty when numbers are given
  std::vector<double> numbers;  ///< one for all, or one each
  friend bool operator==(const WordOrNumbers&, const WordOrNumbers&) = default;
};

/// `attach = "centre_of_mass"`, `"each_particle"` or `{ particle = 3 }`.
struct Attachment {
  enum class Kind { centre_of_mass, each_particle, particle } kind = Kind::centre_of_mass;
  std::int64_t particle = 0;
  friend bool operator==(const Attachment&, const Attachment&) = default;
};

constexpr auto word_table(Attachment::Kind) {
  using enum Attachment::Kind;
  return std::to_array<Word<Attachment::Kind>>(
      {{centre_of_mass, "centre_of_mass"}, {each_particle, "each_particle"}, {particle, nullptr}});
}

/// One number per space dimension; empty when not given.
struct SpaceVector {
  std::vector<double> components;
  friend bool operator==(const SpaceVector&, const SpaceVector&) = default;
};

/// One number for all particles, or one each.
struct PerParticle {
  std::vector<double> values;
  friend bool operator==(const PerParticle&, const PerParticle&) = default;
};

/// One vector for all particles, or one each; empty when not given.
struct PerParticleVector {
  std::vector<SpaceVector> values;
  friend bool operator==(const PerParticleVector&, const PerParticleVector&) = default;
};

/// One name for all particles, or one each; empty when not given.
struct NamePerParticle {
  std::vector<std::string> names;
  const std::string& of(std::size_t particle) const {
    return names.size() == 1 ? names.front() : names[particle];
  }
  friend bool operator==(const NamePerParticle&, const NamePerParticle&) = default;
};

/// `positions = [[0.0, 1.0], ...]`; in one dimension `[0.0, 1.0]` too. Empty when not given.
struct PointList {
  std::size_t dimension = 0;
  std::vector<double> coordinates;  ///< point after point
  std::size_t count() const { return dimension == 0 ? 0 : coordinates.size() / dimension; }
  friend bool operator==(const PointList&, const PointList&) = default;
};

/// `energies = [[0.0, 0.1], [0.2, 0.3]]`: rows of equal length, or a list, of one column. Empty
/// when not given.
struct NumberTable {
  std::size_t columns = 0;
  std::vector<double> numbers;  ///< row after row
  std::size_t rows() const { return columns == 0 ? 0 : numbers.size() / columns; }
  friend bool operator==(const NumberTable&, const NumberTable&) = default;
};

/// `hold = ["x", "rotation"]`: names, each once.
struct WordList {
  std::vector<std::string> words;
  friend bool operator==(const WordList&, const WordList&) = default;
};

/// `periodic = [true, false]`.
struct FlagList {
  std::vector<bool> flags;
  friend bool operator==(const FlagList&, const FlagList&) = default;
};

/// `reverse = { when = "bodies.ring.centre_of_mass.x", above = 10.0, times = 1 }`: an observable
/// that passes a value upwards (above) or downwards (below), and how often that counts. Empty
/// `when`: not given.
struct Passing {
  std::string when;
  std::optional<double> above;
  std::optional<double> below;
  std::int64_t times = 1;
  friend bool operator==(const Passing&, const Passing&) = default;
};

/// `energy = "V0 * cos(2*pi*x/a)"`: text over a force's variables and the scene's parameters, with
/// the values of those that it names. Parsed already: it has no fault of form.
struct Formula {
  std::string text;
  std::vector<std::pair<std::string, double>> parameters;
  friend bool operator==(const Formula&, const Formula&) = default;
};

/// `force = ["-k * x", "0"]`: one formula per space dimension; empty when not given.
struct FormulaList {
  std::vector<Formula> components;
  friend bool operator==(const FormulaList&, const FormulaList&) = default;
};

/// `angles = "neighbours"` or `[[0, 1, 2], ...]`: particles whose bonds meet in the middle one.
struct AngleSelection {
  bool neighbours = true;
  std::vector<std::array<std::int64_t, 3>> list;
  friend bool operator==(const AngleSelection&, const AngleSelection&) = default;
};

using ParameterValue = std::variant<double, std::int64_t, bool, std::string, SpaceVector,
                                    PerParticle, PerParticleVector, PairSelection, WordOrNumbers,
                                    Attachment, PointList, NumberTable, WordList, FlagList, Passing,
                                    Formula, FormulaList, AngleSelection, NamePerParticle>;

/// One row of a parameter table; the member is reached through `assign` and `read`.
struct Parameter {
  std::string key;
  std::string doc;
  Dimension dimension;
  Interval interval;                       ///< for each number in the value
  std::vector<std::string> choices;        ///< for a string, or the words of WordOrNumbers
  ParameterValue prototype;                ///< its alternative tells the kind of value
  std::optional<ParameterValue> standard;  ///< the default; without one the key is required
  bool optional = false;                   ///< may be absent without a default (value stays empty)
  /// May be a list with a value for each particle of the component's body, or an expression in the
  /// particle's index `i`.
  bool per_particle = false;
  bool uniform = false;  ///< never so, even where the force's numbers may differ: as a period

  std::function<void(void* description, ParameterValue value)> assign;
  std::function<ParameterValue(const void* description)> read;

  bool required() const { return !standard && !optional; }

  // Chained modifiers, so that a row reads as a sentence.
  Parameter in(Interval admissible) && {
    interval = admissible;
    return std::move(*this);
  }
  Parameter one_of(std::vector<std::string> words) && {
    choices = std::move(words);
    return std::move(*this);
  }
  template <class T>
  Parameter by_default(T value) && {
    if constexpr (std::is_same_v<T, const char*>) {
      standard = ParameterValue(std::string(value));
    } else if constexpr (Worded<T>) {
      standard = ParameterValue(std::string(to_string(value)));
    } else {
      standard = ParameterValue(std::move(value));
    }
    return std::move(*this);
  }
  Parameter or_absent() && {
    optional = true;
    return std::move(*this);
  }
  Parameter for_each_particle() && {
    per_particle = true;
    return std::move(*this);
  }
  Parameter one_for_all_particles() && {
    uniform = true;
    return std::move(*this);
  }
};

/// A row for `member` of the description struct D. The member's type tells what a scene may give:
/// for an enumeration with words (framework/core/text/words.hpp) one of them.
template <class D, class Base, class T>
Parameter parameter_of(std::string key, T Base::*member, Dimension dimension, std::string doc) {
  Parameter row;
  row.key = std::move(key);
  row.doc = std::move(doc);
  row.dimension = dimension;
  if constexpr (Worded<T>) {
    row.choices = words_of<T>();
    row.prototype = std::string();
    row.assign = [member](void* description, ParameterValue value) {
      static_cast<D*>(description)->*member = value_named<T>(std::get<std::string>(value)).value();
    };
    row.read = [member](const void* description) {
      const char* word = to_string(static_cast<const D*>(description)->*member);
      return ParameterValue(std::string(word == nullptr ? "" : word));
    };
  } else {
    row.prototype = T{};
    row.assign = [member](void* description, ParameterValue value) {
      static_cast<D*>(description)->*member = std::get<T>(std::move(value));
    };
    row.read = [member](const void* description) {
      return ParameterValue(static_cast<const D*>(description)->*member);
    };
  }
  return row;
}

template <class D, class T>
Parameter parameter(std::string key, T D::*member, Dimension dimension, std::string doc) {
  return parameter_of<D, D, T>(std::move(key), member, dimension, std::move(doc));
}

}  // namespace tomlin
