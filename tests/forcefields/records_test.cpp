#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/records/force.hpp"
#include "framework/core/text/citation.hpp"
#include "framework/core/text/fault.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"

// Records of components are complete and true: examples, ranges, names.

namespace tomlin::test {
namespace {

TEST(Conformance, ExamplesUseTheirComponentAndRun) {
  const auto runs = [](const ComponentRecord& record) {
    SCOPED_TRACE(record.name);
    const auto scene = scene_of(record.example);
    const bool used =
        std::any_of(scene->forces.begin(), scene->forces.end(),
                    [&](const auto& force) { return force.record->name == record.name; }) ||
        std::any_of(scene->bodies.begin(), scene->bodies.end(),
                    [&](const auto& body) { return body.record->name == record.name; }) ||
        scene->run.integrator.record->name == record.name;
    EXPECT_TRUE(used);
    const RunResult result = run(scene);
    EXPECT_EQ(result.status, RunStatus::finished)
        << (result.failure ? to_string(*result.failure) : "");
    EXPECT_GT(result.steps, 0u);
  };
  for (const auto& record : standard().bodies()) runs(*record);
  for (const auto& record : standard().forces()) runs(*record);
  for (const auto& record : standard().integrators()) runs(*record);
}

/// So that metal units take them in K.
TEST(Conformance, TemperaturesAreOfTheDimensionOfTemperature) {
  int found = 0;
  const auto check = [&](const ComponentRecord& record) {
    for (const Parameter& row : record.parameters) {
      if (!row.key.ends_with("temperature")) continue;
      ++found;
      EXPECT_EQ(row.dimension, dimension::temperature) << record.name << " " << row.key;
    }
  };
  for (const auto& record : standard().bodies()) check(*record);
  for (const auto& record : standard().forces()) check(*record);
  EXPECT_GE(found, 3);
}

/// Faults of the component's example with another value; paths name a force by its type.
std::vector<Fault> faults_with(const ComponentRecord& record, const std::string& path,
                               const std::string& value) {
  try {
    (void)scene_of(record.example, {{path, value}});
  } catch (const InputError& error) {
    return error.faults();
  }
  return {};
}

/// That the value is refused, not the key: a key that no parameter has is refused as well.
bool refuses_value(const ComponentRecord& record, const std::string& path,
                   const std::string& value) {
  const std::vector<Fault> faults = faults_with(record, path, value);
  return std::any_of(faults.begin(), faults.end(),
                     [&](const Fault& fault) { return fault.key == path && fault.value == value; });
}

TEST(Conformance, ParametersOutOfRangeAreRefused) {
  int bounded = 0;
  const ForceRecord& damping = *standard().force("viscous_damping");
  EXPECT_FALSE(refuses_value(damping, "force.viscous_damping.no_such_key", "-1.0"))
      << "negative control";
  const auto look_at = [&](const ComponentRecord& record, const std::string& component) {
    for (const Parameter& row : record.parameters) {
      if (!std::holds_alternative<double>(row.prototype)) continue;
      const std::string path = component + "." + row.key;
      SCOPED_TRACE(path);
      for (const char* value : {"nan", "inf", "-inf"}) {
        EXPECT_TRUE(refuses_value(record, path, value)) << value;
      }
      if (row.interval.low == 0.0) {
        ++bounded;
        EXPECT_TRUE(refuses_value(record, path, "-1e-300"));
        if (row.interval.low_open) {
          EXPECT_TRUE(refuses_value(record, path, "0.0"));
        }
      }
    }
  };
  for (const auto& record : standard().forces()) look_at(*record, "force." + record->name);
  for (const auto& record : standard().integrators()) look_at(*record, "run.integrator");
  EXPECT_GT(bounded, 5);
}

TEST(Conformance, TheEdgeOfARangeIsAccepted) {
  const ForceRecord* damping = standard().force("viscous_damping");
  EXPECT_TRUE(faults_with(*damping, "force.viscous_damping.coefficient", "0.0").empty());
  EXPECT_TRUE(faults_with(*damping, "force.viscous_damping.coefficient", "1e-300").empty());
}

// ---- sources

/// A DOI, or what finds a work from before there were any.
bool can_be_found(const std::string& work) {
  // "doi:10.1016/x", at the end since what follows it would be a position in the work.
  static const std::regex doi(".*, doi:10\\.[0-9]{4,}/[^ ]+");
  static const std::regex book(".*, ISBN [0-9-]{13,}");
  static const std::regex journal(".* [0-9]+ \\((18|19|20)[0-9]{2}\\) [0-9]+");  // 8 (1938) 89
  static const std::regex chapter(".*, in .*\\((.*), (19|20)[0-9]{2}\\) [0-9]+");
  return std::regex_match(work, doi) || std::regex_match(work, book) ||
         std::regex_match(work, journal) || std::regex_match(work, chapter);
}

TEST(Sources, CanBeCited) {
  std::map<std::string, std::string> works;  // by what they are known by
  const auto look_at = [&](const ComponentRecord& record) {
    SCOPED_TRACE(record.name);
    if (record.source == kSourceIsTheScene) return;  // no work of its own
    const auto cited = citations(record.source);
    EXPECT_FALSE(cited.empty());
    for (const Citation& citation : cited) {
      EXPECT_TRUE(can_be_found(citation.work)) << citation.work;
      // Every citation writes a work in the same way.
      EXPECT_EQ(works.try_emplace(identity_of(citation), citation.work).first->second,
                citation.work);
    }
  };
  for (const auto& record : standard().bodies()) look_at(*record);
  for (const auto& record : standard().forces()) look_at(*record);
  for (const auto& record : standard().integrators()) look_at(*record);
  EXPECT_GT(works.size(), 10U);
  for (const char* vague : {"Prandtl (1928)", "textbook", "doi:", "W. Kutta (1901)"}) {
    EXPECT_FALSE(can_be_found(vague)) << vague;
  }
}

// ---- names

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string camel_case(const std::string& name) {
  std::string camel;
  bool up = true;
  for (const char c : name) {
    if (c == '_') {
      up = true;
    } else {
      camel += up ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      up = false;
    }
  }
  return camel;
}

/// type = "..." is the file's name and, in CamelCase, the class's.
TEST(Names, TypeFileAndClassAgree) {
  const std::filesystem::path source = paths::source;
  const auto look_at = [&](const std::string& folder, const std::string& name,
                           const std::string& declared) {
    SCOPED_TRACE(folder + "/" + name);
    const std::string header = contents(source / folder / (name + ".hpp"));
    const bool alone = header.find("struct " + declared + " {") != std::string::npos;
    const bool derived = header.find("struct " + declared + " : ") != std::string::npos;
    EXPECT_TRUE(alone || derived) << declared;
    EXPECT_NE(header.find(name + "_record()"), std::string::npos);
    EXPECT_NE(contents(source / folder / (name + ".cpp")).find("\"" + name + "\""),
              std::string::npos);
  };
  for (const auto& force : standard().forces()) {
    // A formula is no evaluator: it has a description only.
    const bool formula = force->source == kSourceIsTheScene;
    // Nothing but noise is its own: its evaluator is that of friction.
    if (force->name == "langevin") continue;
    look_at("forcefields", force->name, camel_case(force->name) + (formula ? "Description" : ""));
  }
  for (const auto& scheme : standard().integrators()) {
    SCOPED_TRACE(scheme->name);
    const std::filesystem::path file = source / "integrators" / scheme->name;
    EXPECT_NE(contents(file.string() + ".hpp").find(scheme->name + "_record()"), std::string::npos);
    // A class of its own, or kernels of its own in a class that it shares with others of its kind.
    const std::string code = contents(file.string() + ".cpp");
    const std::string name = camel_case(scheme->name);
    EXPECT_NE(code.find("\"" + scheme->name + "\""), std::string::npos);
    EXPECT_TRUE(code.find("class " + name + " ") != std::string::npos ||
                code.find(name + "Kernels") != std::string::npos ||
                code.find("struct " + name + " {") != std::string::npos);
  }
  for (const auto& body : standard().bodies()) {
    const std::string header = contents(source / "framework/bodies" / (body->name + ".hpp"));
    EXPECT_NE(header.find("struct " + camel_case(body->name) + "Description "), std::string::npos)
        << body->name;
  }
}

/// Whether a file is a part of a component, whose name comes first: FORCE_part.cpp.
bool is_part_of_a_force(const std::string& stem) {
  return std::any_of(standard().forces().begin(), standard().forces().end(),
                     [&](const auto& force) { return stem.starts_with(force->name + "_"); });
}

/// No file of a component without its component.
TEST(Names, EveryFilePairIsRegistered) {
  const std::filesystem::path source = paths::source;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source / "forcefields")) {
    if (entry.path().extension() != ".cpp" || entry.path().stem() == "register_forces") continue;
    if (is_part_of_a_force(entry.path().stem().string())) continue;
    EXPECT_NE(standard().force(entry.path().stem().string()), nullptr) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, static_cast<int>(standard().forces().size()));
}

// ---- registration

template <class Record, class Spoil>
bool refused(const Record& complete, Spoil&& spoil) {
  Registry registry;
  Record record = complete;
  spoil(record);
  try {
    registry.add(record);
  } catch (const std::invalid_argument& error) {
    return std::string(error.what()).size() > 10;
  }
  return false;
}

template <class Record>
void expect_completeness_is_required(const Record& record) {
  SCOPED_TRACE(record.name);
  EXPECT_FALSE(refused(record, [](Record&) {}));
  EXPECT_TRUE(refused(record, [](Record& r) { r.name.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.summary.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.equation.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.source.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.example.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.make_description = nullptr; }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.complaints = nullptr; }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.parameters.front().doc.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.parameters.front().key.clear(); }));
}

TEST(Registration, AnIncompleteRecordIsRejected) {
  for (const auto& force : standard().forces()) {
    expect_completeness_is_required(*force);
    EXPECT_TRUE(refused(*force, [](ForceRecord& r) { r.bind = nullptr; }));
    EXPECT_TRUE(refused(*force, [](ForceRecord& r) { r.period = nullptr; }));
  }
  for (const auto& scheme : standard().integrators()) {
    expect_completeness_is_required(*scheme);
    EXPECT_TRUE(refused(*scheme, [](IntegratorRecord& r) { r.bind = nullptr; }));
    EXPECT_TRUE(refused(*scheme, [](IntegratorRecord& r) { r.step = nullptr; }));
    // A record has to state its stability, in either way.
    EXPECT_TRUE(refused(*scheme, [](IntegratorRecord& r) {
      r.growth = nullptr;
      r.stable_step = nullptr;
    }));
  }
  for (const auto& body : standard().bodies()) {
    expect_completeness_is_required(*body);
    EXPECT_TRUE(refused(*body, [](BodyRecord& r) { r.build = nullptr; }));
  }
}

TEST(Registration, ANameIsTakenOnce) {
  Registry registry = standard_registry();
  const ForceRecord force = *registry.force("viscous_damping");
  EXPECT_THROW(registry.add(force), std::invalid_argument);
  // Nor by a component of another kind.
  BodyRecord body = *registry.body("point");
  body.name = "viscous_damping";
  EXPECT_THROW(registry.add(body), std::invalid_argument);
}

}  // namespace
}  // namespace tomlin::test
