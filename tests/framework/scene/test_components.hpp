#pragma once

#include <cmath>
#include <complex>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/records/body.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/records/registry.hpp"

/// A private registry for the tests of the scene layer: nothing in it can be bound.
namespace tomlin::test {

template <class Record>
void describe(Record& record, const char* name, std::vector<Parameter> parameters) {
  record.name = name;
  record.summary = "a component of the tests";
  record.equation = "none";
  record.source = "none";
  record.example = "none";
  record.parameters = std::move(parameters);
}

struct Dot : BodyDescription {
  SpaceVector position;
};

inline BodyRecord dot() {
  BodyRecord record;
  describe(record, "dot",
           with_body_parameters<Dot>(
               {parameter("position", &Dot::position, dimension::length, "where it is")}));
  record.make_description = make_description<Dot>;
  record.common = body_part<Dot>;
  record.dimension = [](const void* description) {
    return static_cast<int>(static_cast<const Dot*>(description)->position.components.size());
  };
  record.count = [](const void*) -> std::int64_t { return 1; };
  record.complaints = [](const void*, int) { return std::vector<Complaint>(); };
  record.build = [](const void* description, int) {
    const auto& position = static_cast<const Dot*>(description)->position.components;
    return BodyGeometry{position, {std::vector<double>(position.size(), 0.0)}, 0.0};
  };
  return record;
}

/// Closed, planar.
struct Loop : BodyDescription {
  std::int64_t count = 0;
  double radius = 0.0;
  SpaceVector centre;
};

inline BodyRecord loop() {
  BodyRecord record;
  describe(record, "loop",
           with_body_parameters<Loop>(
               {parameter("count", &Loop::count, dimension::none, "particles")
                    .in({.low = 2.0, .low_open = false}),
                parameter("radius", &Loop::radius, dimension::length, "radius").in(positive),
                parameter("centre", &Loop::centre, dimension::length, "centre")}));
  record.make_description = make_description<Loop>;
  record.common = body_part<Loop>;
  record.dimension = [](const void* description) {
    return static_cast<int>(static_cast<const Loop*>(description)->centre.components.size());
  };
  record.count = [](const void* description) {
    return static_cast<const Loop*>(description)->count;
  };
  record.complaints = [](const void*, int dimension) {
    std::vector<Complaint> complaints;
    if (dimension != 2) complaints.push_back({"centre", "a loop is planar", "2 components"});
    return complaints;
  };
  record.build = [](const void* description, int) {
    const auto* loop = static_cast<const Loop*>(description);
    BodyGeometry geometry;
    geometry.anchor = loop->centre.components;
    geometry.relative.assign(static_cast<std::size_t>(loop->count), {0.0, 0.0});
    return geometry;
  };
  record.ends = [](const void*, int) { return BodyEnds{.closed = true}; };
  return record;
}

/// Its shape has no vectors; open, along x.
struct Row : BodyDescription {
  std::int64_t count = 0;
};

inline BodyRecord row() {
  BodyRecord record;
  describe(record, "row",
           with_body_parameters<Row>(
               {parameter("count", &Row::count, dimension::none, "particles").in(positive)}));
  record.make_description = make_description<Row>;
  record.common = body_part<Row>;
  record.dimension = [](const void*) { return 0; };
  record.count = [](const void* description) {
    return static_cast<const Row*>(description)->count;
  };
  record.complaints = [](const void*, int) { return std::vector<Complaint>(); };
  record.build = [](const void*, int) { return BodyGeometry(); };
  record.ends = [](const void*, int) { return BodyEnds{.open_along = 0}; };
  return record;
}

inline std::vector<Complaint> no_complaints(const void*, const SceneOutline&) { return {}; }
inline double no_period(const void*, int) { return 0.0; }
inline std::unique_ptr<BoundForce<double>> no_force(const void*, const Binding<double>&) {
  throw std::logic_error("nothing is bound in these tests");
}

struct Pull {
  SpaceVector velocity;
  double stiffness = 0.0;
  Attachment attach;
};

inline ForceRecord pull() {
  ForceRecord record;
  describe(
      record, "pull",
      {parameter("stiffness", &Pull::stiffness, dimension::stiffness, "of the spring").in(positive),
       parameter("velocity", &Pull::velocity, dimension::velocity, "of its end"),
       parameter("attach", &Pull::attach, dimension::none, "where it is attached")
           .by_default(Attachment{})});
  record.make_description = make_description<Pull>;
  record.complaints = no_complaints;
  record.period = no_period;
  record.bind = no_force;
  return record;
}

struct Bonds {
  PairSelection pairs;
  WordOrNumbers rest_lengths;
  PerParticle charge;
};

/// Within a body or between two.
inline ForceRecord bonds() {
  ForceRecord record;
  record.most_bodies = 2;
  describe(record, "bonds",
           {parameter("pairs", &Bonds::pairs, dimension::none, "which").by_default(PairSelection{}),
            parameter("rest_lengths", &Bonds::rest_lengths, dimension::length, "how long")
                .in(positive)
                .one_of({"initial"})
                .by_default(WordOrNumbers{.word = "initial", .numbers = {}}),
            parameter("charge", &Bonds::charge, dimension::none, "of each particle")
                .by_default(PerParticle{{1.0}})});
  record.make_description = make_description<Bonds>;
  record.complaints = [](const void* description, const SceneOutline& scene) {
    const auto* bonds = static_cast<const Bonds*>(description);
    const auto& body = scene.bodies.at(0);
    const auto neighbours = static_cast<std::size_t>(body.count - (body.closed ? 0 : 1));
    std::vector<Complaint> complaints;
    if (bonds->pairs.kind == PairSelection::Kind::neighbours &&
        bonds->rest_lengths.numbers.size() > 1 &&
        bonds->rest_lengths.numbers.size() != neighbours) {
      complaints.push_back({"rest_lengths", "not one for each bond",
                            "one number, or " + std::to_string(neighbours)});
    }
    return complaints;
  };
  record.period = no_period;
  record.bind = no_force;
  return record;
}

struct Wave {
  double period = 0.0;
};

/// Periodic along x.
inline ForceRecord wave() {
  ForceRecord record;
  describe(record, "wave",
           {parameter("period", &Wave::period, dimension::length, "along x").in(positive)});
  record.make_description = make_description<Wave>;
  record.complaints = no_complaints;
  record.period = [](const void* description, int axis) {
    return axis == 0 ? static_cast<const Wave*>(description)->period : 0.0;
  };
  record.bind = no_force;
  return record;
}

inline std::unique_ptr<Integrator<double>> no_integrator(const void*, System<double>&) {
  throw std::logic_error("nothing is bound in these tests");
}

struct Euler {
  double dt = 0.0;
  bool verbose = false;
};

inline IntegratorRecord euler() {
  IntegratorRecord record;
  describe(record, "euler",
           {parameter("dt", &Euler::dt, dimension::time, "the step").in(positive),
            parameter("verbose", &Euler::verbose, dimension::none, "talk").by_default(false)});
  record.growth = [](std::complex<double> z) { return std::abs(1.0 + z); };
  record.step = [](const void* description) { return static_cast<const Euler*>(description)->dt; };
  record.complaints = [](const void* description) {
    std::vector<Complaint> complaints;
    if (static_cast<const Euler*>(description)->dt > 100.0) {
      complaints.push_back({"dt", "a step for the patient", "<= 100"});
    }
    return complaints;
  };
  record.bind = no_integrator;
  record.make_description = make_description<Euler>;
  return record;
}

inline Registry components() {
  Registry registry;
  registry.add(dot());
  registry.add(loop());
  registry.add(row());
  registry.add(pull());
  registry.add(bonds());
  registry.add(wave());
  registry.add(euler());
  return registry;
}

}  // namespace tomlin::test
