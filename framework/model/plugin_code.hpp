#pragma once

#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "framework/core/records/force.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/model/own_arithmetic.hpp"
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

/// Returns the result of `action`; whatever it throws comes out as a PluginError, and the
/// arithmetic is as it was `before`.
template <class Action>
auto in_plugin(const std::string& component, const std::string& library, Action action,
               OwnArithmetic::Mode before = OwnArithmetic::mode()) {
  const OwnArithmetic own(before);
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

/// Error of a component that has made something other than it should.
struct UnfitPart : std::logic_error {
  using std::logic_error::logic_error;
};

/// Returns the product of a factory, which must not be null.
template <class Pointer>
Pointer something(Pointer made) {
  if (made == nullptr) throw UnfitPart("its factory has returned a null pointer");
  return made;
}

/// Returns the result of `action`, which binds a component. An exception of a plugin is a fault of
/// the scene that names it. `kind`: "force", say.
template <class Component, class Action>
auto bound_by(const Component& component, const char* kind, Action action) {
  if (component.record->library.empty()) return action();
  const std::string thrown = " has thrown an exception while binding: ";
  std::string did = thrown + "an exception that is no std::exception";
  const OwnArithmetic own;
  try {
    return action();
  } catch (const InputError&) {
    throw;
  } catch (const BindError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const UnfitPart& part) {
    did = std::string(": ") + part.what();
  } catch (const std::exception& error) {
    did = thrown + error.what();
  } catch (...) {
    // The text stays as it is.
  }
  throw InputError(
      {Fault(FaultCode::plugin_error, component.location, std::string(kind) + "." + component.name,
             "", "the plugin " + component.record->library + did)});
}

/// Whether forces or the integrator of a scene, or functions of its records, are those of plugins.
bool uses_plugins(const Scene& scene);

/// An exception that came out of a run of this scene, whose plugins are in use: names their forces
/// and integrator, and else the libraries alone.
PluginError thrown_by_plugins(const Scene& scene, const std::string& said);

}  // namespace tomlin
