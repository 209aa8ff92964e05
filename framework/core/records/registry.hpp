#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/core/records/parameter.hpp"

/// The components that scenes are assembled from. Registration is an explicit call on a Registry
/// object; there are no globals and no static initialisers.
namespace tomlin {

/// The source of a component that says nothing of its own: there is no work to cite for it.
inline constexpr const char* kSourceIsTheScene = "the scene that gives it";

struct Complaint;  // framework/core/records/body.hpp

/// Common data of all components. A record without these is rejected when registered.
struct ComponentRecord {
  std::string name;  ///< `type = "..."` in a scene; the file's and, in CamelCase, the class's name
  std::string summary;   ///< one line
  std::string equation;  ///< in plain text or TeX-like notation, with the sign convention
  std::string source;    ///< paper with equation number, DOI or textbook
  std::string example;   ///< a whole scene that runs
  std::vector<Parameter> parameters;

  /// A default-constructed description; the rows of `parameters` assign its members.
  std::shared_ptr<void> (*make_description)() = nullptr;

  /// Fetches what the description of a body or force refers to, by paths relative to the scene's
  /// folder; null where there is no such thing. Afterwards the description holds it by value, so
  /// that the effective scene runs anywhere. Called once, when all keys have been read.
  std::vector<Complaint> (*prepare)(void* description,
                                    const std::filesystem::path& folder) = nullptr;
  /// The file that was fetched; empty: none.
  const std::filesystem::path& (*read_from)(const void* description) = nullptr;

  /// Path of the shared library that it comes from, set when that is loaded; empty: the program's.
  std::string library;
};

/// A shared library whose components are in a registry; see framework/plugin.
struct Library {
  std::string given;        ///< as it was named: in a scene, or on the command line
  std::string path;         ///< absolute
  std::string hash;         ///< of its content: XXH3-128, 32 hexadecimal digits
  bool everywhere = false;  ///< for all scenes, whether they name it or not
};

template <class D>
std::shared_ptr<void> make_description() {
  return std::make_shared<D>();
}

/// `of_description<&f>` is f(const Description&, arguments...) as records hold functions, which do
/// not know the type of a description; of f(Description&, ...) one that takes a `void*`.
template <auto f>
struct OfDescription;
template <class Result, class Description, class... Arguments,
          Result (*f)(Description&, Arguments...)>
struct OfDescription<f> {
  using Untyped = std::conditional_t<std::is_const_v<Description>, const void, void>;
  static Result call(Untyped* description, Arguments... arguments) {
    return f(*static_cast<Description*>(description), std::forward<Arguments>(arguments)...);
  }
};
template <auto f>
inline constexpr auto of_description = &OfDescription<f>::call;

/// A description with the defaults of all rows that have one.
std::shared_ptr<void> with_defaults(const ComponentRecord& record);

struct BodyRecord;        // framework/core/records/body.hpp
struct ForceRecord;       // framework/core/records/force.hpp
struct IntegratorRecord;  // framework/core/records/integrator.hpp
struct ObserverRecord;    // framework/core/records/observer.hpp

class Registry {
 public:
  Registry();
  ~Registry();
  Registry(Registry&&) noexcept;
  Registry& operator=(Registry&&) noexcept;

  /// Take a complete record. Throws std::invalid_argument for an incomplete one or a taken name.
  void add(BodyRecord record);
  void add(ForceRecord record);
  void add(IntegratorRecord record);
  void add(ObserverRecord record);
  /// Components of this library have been added.
  void add(Library library);

  /// nullptr when there is none of that name.
  const BodyRecord* body(std::string_view name) const;
  const ForceRecord* force(std::string_view name) const;
  const IntegratorRecord* integrator(std::string_view name) const;
  const ObserverRecord* observer(std::string_view name) const;
  /// By its absolute path.
  const Library* library(std::string_view path) const;

  const std::vector<std::unique_ptr<BodyRecord>>& bodies() const { return bodies_; }
  const std::vector<std::unique_ptr<ForceRecord>>& forces() const { return forces_; }
  const std::vector<std::unique_ptr<IntegratorRecord>>& integrators() const { return integrators_; }
  const std::vector<std::unique_ptr<ObserverRecord>>& observers() const { return observers_; }
  const std::vector<Library>& libraries() const { return libraries_; }

 private:
  void refuse_if_unfit(const ComponentRecord& record) const;

  std::vector<std::unique_ptr<BodyRecord>> bodies_;
  std::vector<std::unique_ptr<ForceRecord>> forces_;
  std::vector<std::unique_ptr<IntegratorRecord>> integrators_;
  std::vector<std::unique_ptr<ObserverRecord>> observers_;
  std::vector<Library> libraries_;
};

}  // namespace tomlin
