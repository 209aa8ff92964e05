#include "framework/core/registry.hpp"

#include <stdexcept>
#include <utility>

#include "framework/core/body.hpp"
#include "framework/core/force.hpp"
#include "framework/core/integrator.hpp"
#include "framework/core/observer.hpp"

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

}  // namespace

std::shared_ptr<void> with_defaults(const ComponentRecord& record) {
  auto description = record.make_description();
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
  require(!record.summary.empty(), record, "summary");
  require(!record.equation.empty(), record, "equation");
  require(!record.source.empty(), record, "source");
  require(!record.example.empty(), record, "example");
  require(record.make_description != nullptr, record, "description");
  for (const Parameter& row : record.parameters) {
    require(!row.key.empty() && !row.doc.empty(), record, "key or doc in a parameter row");
  }
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
  require(record.complaints && record.columns && record.observe, record, "function");
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
