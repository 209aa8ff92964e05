#include "framework/core/records/registry.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "framework/core/records/body.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/core/records/variation.hpp"
#include "framework/core/text/utf8.hpp"

namespace tomlin {
namespace {

template <class Record>
const Record* find(const std::vector<std::unique_ptr<Record>>& records, std::string_view name) {
  for (const auto& record : records) {
    if (record->name == name) return record.get();
  }
  return nullptr;
}

void require(bool present, const ComponentRecord& record, const char* what) {
  if (!present) {
    throw std::invalid_argument("component \"" + record.name + "\" has no " + what);
  }
}

bool is_word(std::string_view name) {
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

/// Each key once; `type` is how the component itself is named.
void check_rows(const ComponentRecord& record) {
  std::set<std::string> keys = {"type"};
  for (const Parameter& row : record.parameters) {
    require(!row.key.empty() && !row.doc.empty(), record, "key or doc in a parameter row");
    require(row.assign && row.read, record, "member behind a parameter row");
    if (!keys.insert(row.key).second) {
      throw std::invalid_argument("component \"" + record.name + "\" has two keys \"" + row.key +
                                  "\"");
    }
  }
}

/// All that a record says is shown, much of it as JSON.
void check_text(const ComponentRecord& record) {
  std::vector<std::string> texts = {record.summary, record.equation, record.source, record.example};
  for (const Parameter& row : record.parameters) {
    texts.insert(texts.end(), {row.key, row.doc});
    texts.insert(texts.end(), row.choices.begin(), row.choices.end());
  }
  if (!std::all_of(texts.begin(), texts.end(), [](const auto& text) { return is_utf8(text); })) {
    throw std::invalid_argument("component \"" + record.name + "\" has text that is not UTF-8");
  }
}

}  // namespace

std::shared_ptr<void> with_defaults(const ComponentRecord& record) {
  auto description = record.make_description();
  require(description != nullptr, record, "description");
  for (const Parameter& row : record.parameters) {
    if (row.standard) row.assign(description.get(), *row.standard);
  }
  return description;
}

Registry::Registry() = default;
Registry::~Registry() = default;
Registry::Registry(Registry&&) noexcept = default;
Registry& Registry::operator=(Registry&&) noexcept = default;

void Registry::refuse_if_unfit(const ComponentRecord& record) const {
  if (record.name.empty()) throw std::invalid_argument("a component has no name");
  if (!is_word(record.name)) {
    throw std::invalid_argument("a component's name has more in it than letters, digits, _ and -");
  }
  require(!record.summary.empty(), record, "summary");
  require(!record.equation.empty(), record, "equation");
  require(!record.source.empty(), record, "source");
  require(!record.example.empty(), record, "example");
  require(record.make_description != nullptr, record, "description");
  check_text(record);
  check_rows(record);
  if (body(record.name) || force(record.name) || integrator(record.name) || observer(record.name)) {
    throw std::invalid_argument("component \"" + record.name + "\" is registered twice");
  }
}

void Registry::add(BodyRecord record) {
  refuse_if_unfit(record);
  require(record.common && record.dimension && record.count && record.complaints && record.ends &&
              record.build,
          record, "geometry");
  bodies_.push_back(std::make_unique<BodyRecord>(std::move(record)));
}

void Registry::add(ForceRecord record) {
  refuse_if_unfit(record);
  require(record.complaints && record.pairs && record.period && record.bind.in_double, record,
          "factory");
  for (Parameter& row : record.parameters) {
    row.per_particle = record.varies && can_vary(row) && !row.uniform;
  }
  // A build without kernels of a number type binds nothing in it.
#if defined(TOMLIN_WITHOUT_QUAD)
  record.bind.in_quadruple = nullptr;
#endif
  forces_.push_back(std::make_unique<ForceRecord>(std::move(record)));
}

void Registry::add(IntegratorRecord record) {
  refuse_if_unfit(record);
  require((record.growth || record.stable_step) && record.step && record.complaints &&
              record.bind.in_double,
          record, "factory");
  integrators_.push_back(std::make_unique<IntegratorRecord>(std::move(record)));
}

void Registry::add(ObserverRecord record) {
  refuse_if_unfit(record);
  // Each list of numbers comes with the function that writes them.
  const auto comes_with = [](auto* list, auto* writes) {
    return (list != nullptr) == (writes != nullptr);
  };
  const bool valid = record.complaints != nullptr && comes_with(record.columns, record.observe) &&
                     comes_with(record.integrals, record.integrands) &&
                     comes_with(record.results, record.conclude);
  const bool any = record.columns || record.integrals || record.step;
  require(valid && any && (record.step || !(record.events || record.state_size)), record,
          "function");
  observers_.push_back(std::make_unique<ObserverRecord>(std::move(record)));
}

void Registry::add(Library library) { libraries_.push_back(std::move(library)); }

const BodyRecord* Registry::body(std::string_view name) const { return find(bodies_, name); }
const ForceRecord* Registry::force(std::string_view name) const { return find(forces_, name); }
const IntegratorRecord* Registry::integrator(std::string_view name) const {
  return find(integrators_, name);
}
const ObserverRecord* Registry::observer(std::string_view name) const {
  return find(observers_, name);
}
const Library* Registry::library(std::string_view path) const {
  for (const Library& library : libraries_) {
    if (library.path == path) return &library;
  }
  return nullptr;
}

}  // namespace tomlin
