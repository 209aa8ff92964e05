#pragma once

#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "framework/core/bound_force.hpp"
#include "framework/core/fault.hpp"
#include "framework/scene/scene.hpp"

/// The code of plugins at work: what it throws is its own, and said to be.
namespace tomlin {

/// An exception that came out of a plugin's code.
class PluginError : public std::runtime_error {
 public:
  /// `component`: "force morse", say.
  PluginError(std::string component, std::string library, std::string said);

  const std::string& component() const { return component_; }
  const std::string& library() const { return library_; }
  const std::string& said() const { return said_; }

 private:
  std::string component_;
  std::string library_;
  std::string said_;
};

/// What `action` returns; whatever it throws comes out as a PluginError.
template <class Action>
auto in_plugin(const std::string& component, const std::string& library, Action action) {
  try {
    return action();
  } catch (const PluginError&) {
    throw;
  } catch (const std::exception& error) {
    throw PluginError(component, library, error.what());
  } catch (...) {
    throw PluginError(component, library, "an exception that is no std::exception");
  }
}

/// What `action` makes of a component when the scene is bound. What a plugin throws is a fault of
/// the scene that names it. `kind`: "force", say.
template <class Component, class Action>
auto bound_by(const Component& component, const char* kind, Action action) {
  if (component.record->library.empty()) return action();
  std::string said = "an exception that is no std::exception";
  try {
    return action();
  } catch (const InputError&) {
    throw;
  } catch (const BindError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    said = error.what();
  } catch (...) {
    // As it says.
  }
  throw InputError({{component.place, std::string(kind) + "." + component.name, "",
                     "the plugin " + component.record->library +
                         " has thrown an exception while binding: " + said,
                     "", ""}});
}

/// The force of a plugin, with each of its functions and kernels called as by in_plugin().
template <class Real>
std::unique_ptr<BoundForce<Real>> guarded(std::unique_ptr<BoundForce<Real>> force,
                                          std::string component, std::string library);

}  // namespace tomlin
