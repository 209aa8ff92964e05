#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/records/parameter.hpp"
#include "framework/core/records/unit_system.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/parameter_table.hpp"

namespace tomlin {

/// Values that a row admits, for people: "a number > 0", "\"a\" or \"b\"", "an integer >= 1".
std::string admissible_values(const Parameter& row);

/// The words that a row admits, alone or beside other kinds of values; none for a free text.
std::vector<std::string> expected_words(const Parameter& row);

/// Turns what stands in a scene into the value of a parameter row.
class ValueReader {
 public:
  /// Both must outlive the reader; the parameters are resolved.
  ValueReader(const ParameterTable& parameters, FaultList& faults)
      : parameters_(parameters), faults_(faults) {}

  /// Units of the numbers of the scene; known once its heading has been read.
  void set_units(UnitSystem units) { units_ = units; }
  UnitSystem units() const { return units_; }

  /// The number of particles of the one body that a component acts on: `count` in its expressions.
  struct CountInExpressions {
    std::optional<std::int64_t> value = {};
    bool hidden = false;  ///< by a fault of the bodies, of which another one follows
  };
  /// From here on a component is read that has this count; for messages its keys with values that
  /// may differ between particles.
  void begin_component(CountInExpressions count, std::vector<std::string> keys) {
    count_ = count;
    keys_of_particles_ = std::move(keys);
  }

  /// In the units of the scene. Nothing when the value is unfit; then the list has a fault that
  /// says why. At most one fault per key: the first.
  std::optional<ParameterValue> read(const Parameter& row, const Node& node,
                                     const std::string& key) const;

  /// Whether a value for a row with `per_particle` is one for each particle: a list where one
  /// number or vector is expected, or an expression in `i` or `count`.
  bool is_for_each(const Parameter& row, const Node& node) const;
  /// Such a value for a body of `count` particles: PerParticle, of vectors PerParticleVector.
  std::optional<ParameterValue> read_for_each(const Parameter& row, const Node& node,
                                              const std::string& key, std::int64_t count) const;

 private:
  /// Row and key that are being read, for messages.
  struct Subject {
    const Parameter& row;
    const std::string& key;
  };

  /// A number within the row's interval.
  std::optional<double> number(const Subject& subject, const Node& node) const;
  /// An integer, to which the row's interval does not apply.
  std::optional<std::int64_t> index(const Subject& subject, const Node& node) const;
  /// A list with entries; null with a fault where there is none.
  const List* filled_list(const Subject& subject, const Node& node) const;

  // One for each kind of value; false with a fault where there is none.
  bool read_into(double& value, const Subject& subject, const Node& node) const;
  bool read_into(std::int64_t& value, const Subject& subject, const Node& node) const;
  bool read_into(bool& value, const Subject& subject, const Node& node) const;
  bool read_into(std::string& value, const Subject& subject, const Node& node) const;
  bool read_into(std::vector<double>& value, const Subject& subject, const Node& node) const;
  bool read_into(SpaceVector& value, const Subject& subject, const Node& node) const;
  bool read_into(PerParticle& value, const Subject& subject, const Node& node) const;
  bool read_into(PerParticleVector& value, const Subject& subject, const Node& node) const;
  bool read_into(PairSelection& value, const Subject& subject, const Node& node) const;
  bool read_into(WordOrNumbers& value, const Subject& subject, const Node& node) const;
  bool read_into(Attachment& value, const Subject& subject, const Node& node) const;
  bool read_into(PointList& value, const Subject& subject, const Node& node) const;
  bool read_into(WordList& value, const Subject& subject, const Node& node) const;
  bool read_into(NumberTable& value, const Subject& subject, const Node& node) const;
  bool read_into(FlagList& value, const Subject& subject, const Node& node) const;
  bool read_into(Formula& value, const Subject& subject, const Node& node) const;
  bool read_into(FormulaList& value, const Subject& subject, const Node& node) const;
  bool read_into(AngleSelection& value, const Subject& subject, const Node& node) const;
  bool read_into(NamePerParticle& value, const Subject& subject, const Node& node) const;
  bool read_into(Passing& value, const Subject& subject, const Node& node) const;
  template <std::size_t N>
  bool read_tuples(std::vector<std::array<std::int64_t, N>>& tuples, const char* name,
                   const Subject& subject, const Node& node) const;
  template <class ReadRow, class NameRow>
  bool read_rows(std::size_t& columns, std::vector<double>& all, const Subject& subject,
                 const Node& node, ReadRow&& read_row, NameRow&& name_row) const;

  bool names_particles(const Node& node) const;
  std::string keys_of_particles() const;
  bool read_for_each(std::vector<double>& values, const Subject& subject, const Node& node,
                     std::int64_t count) const;
  bool read_for_each(std::vector<SpaceVector>& values, const Subject& subject, const Node& node,
                     std::int64_t count) const;
  bool has_count(const List& list, const Subject& subject, const Node& node,
                 std::int64_t count) const;

  std::optional<double> evaluated(const Subject& subject, const Node& node) const;
  bool in_range(const Subject& subject, const Node& node, double x) const;
  bool is_word(const Subject& subject, const Node& node, const std::string& word,
               const std::vector<std::string>& words) const;

  // Each reports and returns false.
  bool wrong_kind(const Subject& subject, const Node& node) const;
  bool wrong(FaultCode code, const Subject& subject, const Node& node, std::string why) const;

  const ParameterTable& parameters_;
  FaultList& faults_;
  UnitSystem units_ = UnitSystem::reduced;
  CountInExpressions count_;
  std::vector<std::string> keys_of_particles_;
};

}  // namespace tomlin
