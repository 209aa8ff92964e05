#include "framework/scene/table_reader.hpp"

#include <algorithm>
#include <utility>

#include "framework/core/text/nearest_name.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/engine_units.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {

void TableReading::complain(FaultList& faults, const std::string& key, Wrong wrong) const {
  wrong.key = key.empty() ? path : path + "." + key;
  const Node* value = given ? given->find(key) : nullptr;
  // A complaint about { particle = 3 } is about the 3, which may be given elsewhere (`--set`).
  while (value && value->as<Table>() && value->as<Table>()->entries.size() == 1) {
    const Entry& only = value->as<Table>()->entries.front();
    wrong.key += "." + only.key;
    value = &only.value;
  }
  if (value) {
    faults.of_value(*value, std::move(wrong));
  } else {
    faults.of_key(where, std::move(wrong));
  }
}

void TableReading::complain_inside(FaultList& faults, const std::string& key, std::size_t index,
                                   std::size_t byte, Wrong wrong) const {
  const Node* value = given ? given->find(key) : nullptr;
  const List* list = value ? value->as<List>() : nullptr;
  if (list != nullptr && index < list->size()) value = &(*list)[index];
  if (value == nullptr || value->as<std::string>() == nullptr) {
    complain(faults, key, std::move(wrong));
    return;
  }
  wrong.key = path + "." + key;
  faults.inside(*value, byte, std::move(wrong));
}

namespace {

/// The value of a row as descriptions have it; nothing where that is out of range, and reported.
std::optional<ParameterValue> for_description(const Parameter& row, ParameterValue value,
                                              const TableReading& reading, FaultList& faults) {
  const double unit = scene_unit(reading.units, row.dimension);
  if (unit == 1.0) return value;
  value = in_engine_units(std::move(value), unit);
  if (contains_all(row.interval, value)) return value;
  reading.complain(faults, row.key,
                   {FaultCode::scene_out_of_range, "", "out of range in the units of the engine",
                    admissible_values(row)});
  return std::nullopt;
}

}  // namespace

TableReading read_table(const Table& table, const Extent& where, const TableLayout& layout,
                        std::string path, void* description, const ValueReader& values,
                        const Source& source, FaultList& faults) {
  TableReading reading;
  reading.path = std::move(path);
  reading.where = where;
  reading.given = &table;
  reading.units = values.units();

  for (const Entry& entry : table.entries) {
    reading.locations[entry.key] = source.location(entry.value.where);
    const bool known = layout.row(entry.key) != nullptr || layout.is_own_key(entry.key);
    if (!known) report_key(entry, reading.path, layout, faults);
  }

  for (const Parameter& row : layout.rows) {
    const std::string key = reading.path + "." + row.key;
    std::optional<ParameterValue> value;
    if (const Node* node = table.find(row.key)) {
      if (row.per_particle && values.is_for_each(row, *node)) {
        reading.deferred.push_back(row.key);
        reading.effective.set(row.key, *node);
        continue;
      }
      value = values.read(row, *node, key);
      if (!value) {
        reading.valid = false;
        continue;
      }
      reading.effective.set(row.key, *node);
    } else if (row.standard) {
      value = row.standard;
      if (auto written = to_node(*value)) reading.effective.set(row.key, *std::move(written));
    } else if (row.required()) {
      faults.of_key(where, {FaultCode::scene_missing_key, key, "missing", admissible_values(row)});
      reading.valid = false;
      continue;
    } else {
      continue;
    }
    value = for_description(row, *std::move(value), reading, faults);
    if (!value) {
      reading.valid = false;
      continue;
    }
    row.assign(description, *value);
    reading.values.emplace(row.key, *std::move(value));
  }
  return reading;
}

void read_deferred(TableReading& reading, const std::vector<Parameter>& rows, void* description,
                   std::optional<std::int64_t> count, const ValueReader& values,
                   FaultList& faults) {
  for (const Parameter& row : rows) {
    const auto& keys = reading.deferred;
    if (std::find(keys.begin(), keys.end(), row.key) == keys.end()) continue;
    std::optional<ParameterValue> value;
    if (count) {
      const Node& node = *reading.given->find(row.key);
      value = values.read_for_each(row, node, reading.path + "." + row.key, *count);
    }
    if (value) value = for_description(row, *std::move(value), reading, faults);
    if (!value) {
      reading.valid = false;
      continue;
    }
    if (can_vary(row)) {
      const Variation variation{&row, *std::move(value)};
      value = representative(variation);
      reading.variations.emplace(row.key, variation);
    }
    row.assign(description, *value);
    reading.values.emplace(row.key, *std::move(value));
  }
}

namespace {

/// "run.integrator", "output or measure": the tables that take the key; empty where none does.
std::string table_of(const std::string& key, const TableLayout& layout) {
  std::string tables;
  const auto add = [&tables](const std::string& table) {
    tables += (tables.empty() ? "" : " or ") + ("[" + table + "]");
  };
  for (const OwnKey& one : layout.elsewhere) {
    if (one.key == key) return one.doc;
  }
  for (const SceneTable& table : scene_tables()) {
    if (table.layout.row(key) != nullptr) add(table.name);
  }
  return tables;
}

}  // namespace

void report_key(const Entry& entry, const std::string& path, const TableLayout& layout,
                FaultList& faults) {
  Wrong wrong{FaultCode::scene_unknown_key,
              (path.empty() ? "" : path + ".") + key_text(shortened(entry.key, kLongestShownValue)),
              "unknown key"};
  const auto keys = layout.keys();
  wrong.nearest = nearest_name(entry.key, keys).value_or("");
  // "every" is that of [output] rather than checkpoint_every.
  const std::string& near = wrong.nearest;
  const bool part = near.ends_with("_" + entry.key) || near.starts_with(entry.key + "_");
  const std::string other = near.empty() || part ? table_of(entry.key, layout) : "";
  if (!other.empty()) {
    wrong.nearest.clear();
    wrong.why += " here: it is one of " + other;
  }
  if (wrong.nearest.empty() && entry.key == "gamma" && layout.row("coefficient") != nullptr) {
    wrong.nearest = "coefficient";
    wrong.why += " here: coefficient is the particle's mass times the rate gamma";
  }
  wrong.admissible = listed(keys);
  if (entry.key == "plugins") wrong.admissible = "plugins stands above the first [table]";
  faults.of_key(entry.where, std::move(wrong));
}

}  // namespace tomlin
