#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/records/parameter.hpp"
#include "framework/core/records/unit_system.hpp"
#include "framework/core/text/words.hpp"

/// Results of a run, declared once: a quantity is a row, and summary.json, dotted observables,
/// the reference page of results and the summary's JSON Schema walk the rows.
namespace tomlin {

/// The part of a run that a quantity describes.
enum class Scope {
  window,  ///< the time between [measure] from and to; undefined when the run does not reach its
           ///< end
  end,     ///< the moment at which the run ends
  run,     ///< all of the run
};

enum class Shape {
  number,
  vector,  ///< a number per axis
  count,   ///< a whole number
};

constexpr auto word_table(Scope) {
  using enum Scope;
  return std::to_array<Word<Scope>>({{window, "window"}, {end, "end"}, {run, "run"}});
}

constexpr auto word_table(Shape) {
  using enum Shape;
  return std::to_array<Word<Shape>>({{number, "number"}, {vector, "vector"}, {count, "count"}});
}

struct ResultQuantity {
  std::string key;  ///< in summary.json: "mean_force"
  Dimension dimension;
  Shape shape = Shape::number;
  Scope scope = Scope::window;
  std::string meaning;    ///< one line
  std::string unit = {};  ///< in place of the dimension's name: "rad", "s"
  /// Quantities of the same group of which it is a sum or a difference: so is its error.
  std::vector<std::string> made_of = {};
};

/// "force", "length/time", "rad", "1".
std::string unit_of(const ResultQuantity& quantity);
/// The unit in tables: "force", "energy", "length/time", "rad"; in metal units "eV/A".
std::string unit_in_tables(UnitSystem units, const ResultQuantity& quantity);

/// The value of a quantity. Numbers that are not finite are null in files.
class ResultValue {
 public:
  /// Undefined.
  ResultValue(std::shared_ptr<const ResultQuantity> quantity, std::size_t count)
      : quantity_(std::move(quantity)), count_(count) {}

  const ResultQuantity& quantity() const { return *quantity_; }
  /// Numbers that it has where it is defined: its axes, or 1.
  std::size_t count() const { return count_; }
  void set(std::span<const double> numbers);
  /// Numbers in the engine's units become those of a scene.
  void convert_to(UnitSystem units);

  bool has_value() const { return defined_; }
  explicit operator bool() const { return defined_; }
  /// The value of a number or a count. Throws std::bad_optional_access where it is undefined.
  double value() const;
  double operator*() const { return value(); }
  double value_or(double otherwise) const { return defined_ ? numbers_[0] : otherwise; }

  /// Components of a vector; none where it is undefined.
  bool empty() const { return !defined_; }
  std::size_t size() const { return defined_ ? count_ : 0; }
  /// Throws std::out_of_range where it has no such component.
  double at(std::size_t k) const;
  double operator[](std::size_t k) const { return at(k); }
  double front() const { return at(0); }
  const double* begin() const { return numbers_.data(); }
  const double* end() const { return numbers_.data() + size(); }

  /// A component; nothing where it is undefined or not finite.
  std::optional<double> finite(std::size_t k) const;

  friend bool operator==(const ResultValue& a, const ResultValue& b) {
    return a.defined_ == b.defined_ && a.count_ == b.count_ && a.numbers_ == b.numbers_;
  }
  /// Compares a number or a count.
  friend bool operator==(const ResultValue& a, double b) {
    return a.defined_ && a.numbers_[0] == b;
  }

 private:
  std::shared_ptr<const ResultQuantity> quantity_;
  std::size_t count_;
  bool defined_ = false;
  std::array<double, 3> numbers_{};
};

/// The quantities of one driver, one body, or of the run as a whole.
class ResultGroup {
 public:
  std::string family;  ///< "drivers", "bodies", "observers", "events", "energy", ...
  std::string name;    ///< of the driver or body; empty: of the run
  std::vector<ResultValue> values;

  /// Throws std::out_of_range where there is none of that key.
  const ResultValue& operator[](std::string_view key) const;
  const ResultValue* find(std::string_view key) const;

  /// A row that outlives all results.
  ResultValue& add_row(const ResultQuantity& quantity, std::size_t axes = 1);
  ResultValue& add_row(std::shared_ptr<const ResultQuantity> quantity, std::size_t axes = 1);
  void add(const ResultQuantity& quantity, std::optional<double> value);
  /// Undefined where there are no components.
  void add(const ResultQuantity& quantity, std::size_t axes, const std::vector<double>& components);
};

/// A family of groups, and the rows that any of them may have.
struct ResultFamily {
  std::string_view family;
  std::string_view of;    ///< "each driver"; empty where the run has one
  std::string_view when;  ///< "with run.ledger = true"; empty: always
  std::vector<ResultQuantity> quantities;
};

}  // namespace tomlin
