#include "framework/plugin/load.hpp"

#include <cstdlib>
#include <regex>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/plugin/registration.hpp"
#include "framework/standard_registry.hpp"
#include "tests/framework/plugin/plugin_files.hpp"
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

/// What is said of a library that is not taken; empty when it is.
std::string refusal(const std::filesystem::path& path, Registry& registry) {
  try {
    load_plugins({request(path)}, registry);
  } catch (const InputError& error) {
    return error.faults().front().why;
  }
  return "";
}

std::string refusal(const std::filesystem::path& path) {
  Registry registry = standard_registry();
  return refusal(path, registry);
}

std::size_t components(const Registry& registry) {
  return registry.bodies().size() + registry.forces().size() + registry.integrators().size() +
         registry.observers().size();
}

void expect_refused(const std::filesystem::path& path, const std::string& part) {
  Registry registry = standard_registry();
  const std::size_t before = components(registry);
  const std::string why = refusal(path, registry);
  EXPECT_NE(why.find(part), std::string::npos) << why;
  EXPECT_NE(why.find("the plugin " + path.string() + ": "), std::string::npos) << why;
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
  EXPECT_NE(morse->bind.in_float, nullptr);
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
  EXPECT_EQ(force->bind.in_float, nullptr) << "the record has one, the note has not";
  EXPECT_EQ(force->bind.in_quadruple, nullptr);
}

TEST(Plugins, FilesThatAreNone) {
  const TemporaryFolder folder;
  expect_refused(folder / "absent.so", "there is no such file");
  expect_refused(folder.path(), "directory");
  write(folder / "text.so", "[[body]]\n");
  expect_refused(folder / "text.so", "not a shared library");
  write(folder / "empty.so", "");
  expect_refused(folder / "empty.so", "not a shared library");
  expect_refused(plugin("no_note"), "not a plugin of tomlin");
  expect_refused(plugin("no_entry"), "it has no tomlin_register_plugin");
  expect_refused(plugin("missing_symbol"), "undefined symbol");
  expect_refused("/dev/zero", "a device or a socket, where a file is expected");
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
  expect_refused(folder / "other.so", "the library was built with other headers of tomlin");
  write(folder / "api.so", patched(whole, "api=1;", "api=2;"));
  expect_refused(folder / "api.so", "registered by interface 2, the program loads by 1");
  write(folder / "abi.so", patched(whole, "abi=libstdc++ ", "abi=libfoo+++ "));
  expect_refused(folder / "abi.so", "the library was built with libfoo+++ ");
  write(folder / "same.so", whole);
  expect_refused(folder / "same.so", "it crashed while registering");
}

TEST(Plugins, ThatFailWhileRegistering) {
  const struct {
    const char* fault;
    const char* said;
  } cases[] = {
      {"throw_registering", "registering failed: not today"},
      {"throw_int", "registering failed: an exception that is no std::exception"},
      {"crash", "it crashed while registering: Segmentation fault (signal 11)"},
      {"abort", "it crashed while registering: Aborted (signal 6)"},
      {"exit", "it left the program while registering, with status 7"},
      {"nothing", "it registers no component"},
      {"twice", "registering failed: component \"faulty\" is registered twice"},
      {"incomplete", "registering failed: component \"faulty\" has no source"},
      {"two_keys", "registering failed: component \"faulty\" has two keys \"strength\""},
      {"type_as_key", "registering failed: component \"faulty\" has two keys \"type\""},
      {"not_utf8", "registering failed: component \"faulty\" has text that is not UTF-8"},
      {"odd_name", "registering failed: a component's name has more in it than letters"},
      {"throw_making", "the description of \"faulty\" cannot be made: not made, as planned"},
      {"nothing_made", "the description of \"faulty\" cannot be made: "},
      {"taken_name", "its component \"harmonic_bonds\" has the name of one of tomlin's own"},
  };
  for (const auto& one : cases) {
    SCOPED_TRACE(one.fault);
    const WithFault fault(one.fault);
    expect_refused(plugin("faulty"), one.said);
    EXPECT_FALSE(has_children());
  }
  EXPECT_EQ(refusal(plugin("faulty")), "") << "the same without a fault";
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
  EXPECT_EQ(refusal(folder / "copy.so", registry),
            "the plugin " + (folder / "copy.so").string() +
                ": its component \"morse\" has the name of one from " + plugin("morse").string());
}

/// Each virtual function of a contract is passed on by its guard, `call` at a time: "force_->".
void expect_whole(const std::string& header, const std::string& contract, const std::string& call,
                  std::size_t at_least) {
  const std::string folder = std::string(paths::source) + "/framework/";
  const std::string text = content(folder + header);
  const std::string guard = content(folder + "model/plugin_code.cpp");
  const std::size_t begin = text.find("class " + contract + " {");
  ASSERT_NE(begin, std::string::npos);
  const std::string body = text.substr(begin, text.find("\n};", begin) - begin);
  const std::regex function(R"(virtual [^~(;]*?(\w+)\()");
  std::size_t count = 0;
  for (std::sregex_iterator match(body.begin(), body.end(), function), end; match != end; ++match) {
    const std::string name = (*match)[1];
    EXPECT_NE(guard.find(call + name + "("), std::string::npos) << name;
    ++count;
  }
  EXPECT_GE(count, at_least) << "the contract was not understood";
}

/// What a force or an integrator of a plugin is asked, its guard passes on.
TEST(Plugins, TheGuardOfForcesIsWhole) {
  expect_whole("core/records/bound_force.hpp", "BoundForce", "force_->", 20);
}
TEST(Plugins, TheGuardOfIntegratorsIsWhole) {
  expect_whole("core/system/scheme.hpp", "Integrator", "integrator_->", 14);
  expect_whole("core/system/scheme.hpp", "EquilibriumPath", "path_.", 6);
}

/// Beside one that is refused the others are loaded, and all refusals are told.
TEST(Plugins, AllFaultsTogether) {
  Registry registry = standard_registry();
  try {
    load_plugins({request("/nowhere/a.so"), request(plugin("morse")), request("/nowhere/b.so")},
                 registry);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.faults().size(), 2U);
  }
  EXPECT_NE(registry.force("morse"), nullptr);
}

}  // namespace
}  // namespace tomlin::test
