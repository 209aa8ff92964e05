#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/records/parameter.hpp"
#include "framework/core/records/variation.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/value_reader.hpp"

namespace tomlin {

/// One table of a scene while it is read: what was found in it.
struct TableReading {
  std::string path;  ///< "body.ring", for messages
  Extent where;      ///< of the table
  const Table* given = nullptr;
  UnitSystem units = UnitSystem::reduced;  ///< of its numbers
  /// Values of the valid keys, defaults included; in the engine's units, as the description.
  std::map<std::string, ParameterValue> values;
  std::map<std::string, SourceLocation> locations;  ///< of the keys that were given
  Table effective;    ///< what was given with every default filled in, in declared order
  bool valid = true;  ///< no fault among its rows
  /// Values of rows that differ between particles: one for each. `values` has what stands for
  /// all.
  std::map<std::string, Variation> variations;
  /// Keys of such rows that wait until the particles are counted.
  std::vector<std::string> deferred;

  /// Whether the key's row has no fault.
  bool has(const std::string& key) const { return values.contains(key); }
  /// A fault of a key's value, or of the table when the key was not given.
  void complain(FaultList& faults, const std::string& key, Wrong wrong) const;
  /// A fault in the middle of a formula, `byte` into its text; of a list of them, of the one there.
  void complain_inside(FaultList& faults, const std::string& key, std::size_t index,
                       std::size_t byte, Wrong wrong) const;
};

/// Read a table by its layout: assign every row to the description, fill in defaults, report
/// unknown, reserved, missing and unfit keys. The layout's own keys are left to the caller.
TableReading read_table(const Table& table, const Extent& where, const TableLayout& layout,
                        std::string path, void* description, const ValueReader& values,
                        const Source& source, FaultList& faults);

/// Reads the deferred rows for a body of so many particles; not known: its faults are reported.
void read_deferred(TableReading& reading, const std::vector<Parameter>& rows, void* description,
                   std::optional<std::int64_t> count, const ValueReader& values, FaultList& faults);

/// "not in this version", or unknown with the nearest of the admissible keys.
void report_key(const Entry& entry, const std::string& path, const TableLayout& layout,
                FaultList& faults);

}  // namespace tomlin
