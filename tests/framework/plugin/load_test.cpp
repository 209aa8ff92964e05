#include "framework/plugin/load.hpp"

#include <cstdlib>
#include <optional>
#include <regex>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/plugin/registration.hpp"
#include "framework/standard_registry.hpp"
#include "tests/framework/plugin/plugin_files.hpp"
#include "tests/support/faults.hpp"
#include "tests/support/paths.hpp"

namespace tomlin::test {
namespace {

/// FAULT for as long as it lives; see faulty.cpp.
class WithFault {
 public:
  explicit WithFault(const char* fault) { ::setenv("FAULT", fault, 1); }
  ~WithFault() { ::unsetenv("FAULT"); }
  WithFault(const WithFault&) = delete;
  WithFault& operator=(const WithFault&) = delete;
};

PluginRequest request(const std::filesystem::path& path) {
  return {path.string(), path, {}, false};
}

/// The fault of a library that is not taken.
std::optional<Fault> refusal(const std::filesystem::path& path, Registry& registry) {
  return first_fault([&] { load_plugins({request(path)}, registry); });
}

std::size_t components(const Registry& registry) {
  return registry.bodies().size() + registry.forces().size() + registry.integrators().size() +
         registry.observers().size();
}

void expect_refused(const std::filesystem::path& path, const std::string& part,
                    FaultCode code = FaultCode::plugin_cannot_load) {
  Registry registry = standard_registry();
  const std::size_t before = components(registry);
  const auto fault = refusal(path, registry);
  ASSERT_TRUE(fault);
  EXPECT_EQ(brief(*fault), fmt::format("plugins = \"{}\" [{}]", path.string(), id_of(code)));
  EXPECT_NE(fault->why.find(part), std::string::npos) << fault->why;
  EXPECT_NE(fault->why.find(path.string()), std::string::npos) << fault->why;
  EXPECT_EQ(components(registry), before);
  EXPECT_TRUE(registry.libraries().empty());
}

bool has_children() { return ::waitpid(-1, nullptr, WNOHANG) != -1; }

TEST(Plugins, AddTheirComponents) {
  Registry registry = standard_registry();
  load_plugins({request(plugin("morse")), request(plugin("parts")), request(plugin("morse"))},
               registry);
  const ForceRecord* morse = registry.force("morse");
  ASSERT_NE(morse, nullptr);
  EXPECT_EQ(morse->library, plugin("morse").string());
  EXPECT_NE(morse->bind.in_quadruple, nullptr);
  EXPECT_NE(registry.body("dumbbell"), nullptr);
  EXPECT_NE(registry.integrator("symplectic_euler"), nullptr);
  EXPECT_NE(registry.observer("particle_distance"), nullptr);
  ASSERT_EQ(registry.libraries().size(), 2U);
  EXPECT_EQ(registry.libraries()[0].hash, examine_plugin(plugin("morse")).hash);
  EXPECT_EQ(registry.libraries()[0].hash.size(), 32U);
  EXPECT_EQ(registry.force("harmonic_bonds")->library, "");
  EXPECT_FALSE(has_children());
}

TEST(Plugins, WhatTheyHaveNoKernelsForIsLeftOut) {
  Registry registry = standard_registry();
  load_plugins({request(plugin("faulty"))}, registry);
  const ForceRecord* force = registry.force("faulty");
  ASSERT_NE(force, nullptr);
  EXPECT_NE(force->bind.in_double, nullptr);
  EXPECT_EQ(force->bind.in_quadruple, nullptr) << "the record has one, the note has not";
}

TEST(Plugins, FilesThatAreNone) {
  const TemporaryFolder folder;
  expect_refused(folder / "absent.so", "no such file");
  expect_refused(folder.path(), "directory");
  write(folder / "text.so", "[[body]]\n");
  expect_refused(folder / "text.so", "shared library");
  write(folder / "empty.so", "");
  expect_refused(folder / "empty.so", "shared library");
  expect_refused(plugin("no_note"), "plugin of tomlin");
  expect_refused(plugin("no_entry"), "tomlin_register_plugin");
  expect_refused(plugin("missing_symbol"), "forgotten_record");
  expect_refused("/dev/zero", "device");
}

/// The note is read first: nothing of a library that does not fit is run.
TEST(Plugins, OfAnotherBuildAreRefused) {
  const TemporaryFolder folder;
  const std::string whole = content(plugin("faulty"));
  const WithFault crash("crash");
  const auto at = whole.find(";border=");
  ASSERT_NE(at, std::string::npos);
  std::string other = whole;
  other[at + 8] = other[at + 8] == '0' ? '1' : '0';
  write(folder / "other.so", other);
  expect_refused(folder / "other.so", "headers", FaultCode::plugin_mismatch);
  write(folder / "api.so", patched(whole, "api=1;", "api=2;"));
  expect_refused(folder / "api.so", "interface 2", FaultCode::plugin_mismatch);
  write(folder / "abi.so", patched(whole, "abi=libstdc++ ", "abi=libfoo+++ "));
  expect_refused(folder / "abi.so", "libfoo+++ ", FaultCode::plugin_mismatch);
  write(folder / "same.so", whole);
  expect_refused(folder / "same.so", "(signal 11)");
}

TEST(Plugins, ThatFailWhileRegistering) {
  const struct {
    const char* fault;
    const char* part;
  } cases[] = {
      {"throw_registering", "not today"},
      {"throw_int", "std::exception"},
      {"crash", "(signal 11)"},
      {"abort", "(signal 6)"},
      {"exit", "status 7"},
      {"nothing", "no component"},
      {"twice", "\"faulty\" is registered twice"},
      {"incomplete", "\"faulty\" has no source"},
      {"two_keys", "two keys \"strength\""},
      {"type_as_key", "two keys \"type\""},
      {"not_utf8", "UTF-8"},
      {"odd_name", "component's name"},
      {"throw_making", "not made, as planned"},
      {"nothing_made", "description of \"faulty\""},
      {"taken_name", "\"harmonic_bonds\""},
  };
  for (const auto& one : cases) {
    SCOPED_TRACE(one.fault);
    const WithFault fault(one.fault);
    expect_refused(plugin("faulty"), one.part);
    EXPECT_FALSE(has_children());
  }
  Registry registry = standard_registry();
  EXPECT_FALSE(refusal(plugin("faulty"), registry)) << "the same without a fault";
}

TEST(Plugins, ThatNeverEndRegistering) {
  const WithFault fault("hang");
  EXPECT_EQ(probe_registration(plugin("faulty"), 0.2), "registering did not end within 0.2 s");
  EXPECT_FALSE(has_children());
}

TEST(Plugins, TwoThatHaveTheSameName) {
  const TemporaryFolder folder;
  write(folder / "copy.so", content(plugin("morse")));
  Registry registry = standard_registry();
  load_plugins({request(plugin("morse"))}, registry);
  const auto fault = refusal(folder / "copy.so", registry);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->code, FaultCode::plugin_cannot_load);
  for (const std::string& part :
       {(folder / "copy.so").string(), std::string("\"morse\""), plugin("morse").string()}) {
    EXPECT_NE(fault->why.find(part), std::string::npos) << fault->why;
  }
}

/// Beside one that is refused the others are loaded, and all refusals are told.
TEST(Plugins, AllFaultsTogether) {
  Registry registry = standard_registry();
  const auto faults = thrown_faults([&] {
    load_plugins({request("/nowhere/a.so"), request(plugin("morse")), request("/nowhere/b.so")},
                 registry);
  });
  EXPECT_EQ(faults.size(), 2U);
  EXPECT_NE(registry.force("morse"), nullptr);
}

}  // namespace
}  // namespace tomlin::test
