#pragma once

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

  std::optional<double> number(const Subject& subject, const Node& node) const;
  std::optional<std::int64_t> integer(const Subject& subject, const Node& node) const;
  std::optional<std::int64_t> index(const Subject& subject, const Node& node) const;
  std::optional<std::vector<double>> numbers(const Subject& subject, const List& list,
                                             const Node& whole) const;
  std::optional<std::string> text(const Subject& subject, const Node& node) const;
  std::optional<SpaceVector> space_vector(const Subject& subject, const Node& node) const;
  std::optional<PerParticle> per_particle(const Subject& subject, const Node& node) const;
  std::optional<PerParticleVector> per_particle_vector(const Subject& subject,
                                                       const Node& node) const;
  std::optional<PairSelection> pair_selection(const Subject& subject, const Node& node) const;
  std::optional<WordOrNumbers> word_or_numbers(const Subject& subject, const Node& node) const;
  std::optional<Attachment> attachment(const Subject& subject, const Node& node) const;
  std::optional<PointList> point_list(const Subject& subject, const Node& node) const;
  std::optional<WordList> word_list(const Subject& subject, const Node& node) const;
  std::optional<NumberTable> number_table(const Subject& subject, const Node& node) const;
  std::optional<FlagList> flag_list(const Subject& subject, const Node& node) const;
  std::optional<Formula> formula(const Subject& subject, const Node& node) const;
  std::optional<FormulaList> formula_list(const Subject& subject, const Node& node) const;
  std::optional<AngleSelection> angle_selection(const Subject& subject, const Node& node) const;
  std::optional<NamePerParticle> names_of_particles(const Subject& subject, const Node& node) const;
  std::optional<Passing> passing(const Subject& subject, const Node& node) const;

  bool names_particles(const Node& node) const;
  std::string keys_of_particles() const;
  std::optional<std::vector<double>> numbers_for_each(const Subject& subject, const Node& node,
                                                      std::int64_t count) const;
  std::optional<std::vector<SpaceVector>> vectors_for_each(const Subject& subject, const Node& node,
                                                           std::int64_t count) const;

  std::optional<double> evaluated(const Subject& subject, const Node& node) const;
  bool in_range(const Subject& subject, const Node& node, double x) const;
  bool is_word(const Subject& subject, const Node& node, const std::string& word,
               const std::vector<std::string>& words) const;

  // Each reports and gives nothing.
  std::nullopt_t wrong_kind(const Subject& subject, const Node& node) const;
  std::nullopt_t wrong(FaultCode code, const Subject& subject, const Node& node,
                       std::string why) const;

  const ParameterTable& parameters_;
  FaultList& faults_;
  UnitSystem units_ = UnitSystem::reduced;
  CountInExpressions count_;
  std::vector<std::string> keys_of_particles_;
};

}  // namespace tomlin
