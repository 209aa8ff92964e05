#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/scene/document.hpp"

namespace tomlin {

/// Fault at one position of a scene.
struct Wrong {
  FaultCode code;
  std::string key;  ///< dotted path
  std::string why;
  std::string admissible = {};
  std::string nearest = {};
};

/// A fault, and in the how manyeth `--set`; 0: in the file.
struct FoundFault {
  std::uint32_t setting = 0;
  Fault fault;
};

/// The faults of a scene, collected so that they are all shown together.
class FaultList {
 public:
  /// The source must outlive the list.
  explicit FaultList(const Source& source) : source_(source) {}

  // Each of these throws InputError when there are too many to be of use.

  /// A fault of a value; the message shows the value as written.
  void of_value(const Node& value, Wrong wrong);
  /// A value of another kind than is expected at a key.
  void of_wrong_type(const Node& value, std::string key, std::string admissible);
  /// A fault of a key or a table; the message shows no value.
  void of_key(const Extent& key, Wrong wrong);
  /// A fault in the middle of an expression, `byte` into its text.
  void inside(const Node& text, std::size_t byte, Wrong wrong);

  /// One of the file that was put together elsewhere.
  void take(Fault fault);

  bool empty() const { return faults_.empty(); }
  /// Throws InputError with all of them by position, those of the file first.
  void throw_if_any() const;

 private:
  void add(std::uint32_t setting, SourceLocation location, std::string value, Wrong wrong);
  void add(FoundFault found);
  std::vector<Fault> in_order() const;

  // A file of junk may hold a million faults; nobody reads them, and to find them all takes long.
  static constexpr std::size_t kMostFaults = 200;

  const Source& source_;
  std::vector<FoundFault> faults_;
};

}  // namespace tomlin
