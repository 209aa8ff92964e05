#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/scene/scene.hpp"

/// A TOML document as a plain tree in file order, each key and value with its position. The TOML
/// library itself is seen by document.cpp only.
namespace tomlin {

inline constexpr std::size_t kLargestSceneFile = std::size_t{16} << 20;  ///< bytes
inline constexpr int kDeepestNesting = 32;  ///< of brackets, and of the parts of one dotted key
/// Values, lists and tables of a scene together: some 0.4 GB while it is read.
inline constexpr std::size_t kMostValues = 1'000'000;

/// Line and column, from 1, in characters.
struct TextPosition {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};

/// Position of a key or a value: in the file, or in the n-th `--set` (setting = n, from 1).
struct Extent {
  TextPosition begin;
  TextPosition end;
  std::uint32_t setting = 0;
};

struct Entry;
struct Node;
using List = std::vector<Node>;

struct Table {
  std::vector<Entry> entries;

  const Node* find(std::string_view key) const;
  Node* find(std::string_view key);
  const Entry* find_entry(std::string_view key) const;
  /// Replace the value of a key, or add the key at the end.
  void set(std::string_view key, Node value);
};

/// A date or a time: legal TOML, but nothing in a scene is one.
struct Moment {};

struct Node {
  std::variant<bool, std::int64_t, double, std::string, List, Table, Moment> value;
  Extent where;

  template <class T>
  const T* as() const {
    return std::get_if<T>(&value);
  }
  template <class T>
  T* as() {
    return std::get_if<T>(&value);
  }
};

struct Entry {
  std::string key;
  Extent where;
  Node value;
};

/// "an integer", "text", "a list": how a fault names what it found.
std::string kind_of(const Node& node);

/// Throws InputError where a text holds more than parse_document takes of nesting, values and
/// alphabets.
void check_outline(std::string_view text, const std::string& file);

/// Throws InputError: the file has more than kLargestSceneFile bytes.
[[noreturn]] void refuse_too_large(const std::string& file);

/// Whether a scene that is read keeps the text of its effective scene. Writing and checking it
/// takes a third of the time in which a small scene is read, and a point of a sweep has no use for
/// it.
enum class EffectiveText { written, left_out };

/// The text of a scene; throws InputError with the one fault that stops the reading.
Table parse_document(std::string_view text, const std::string& file);

/// How often parse_document() was called in this process, which takes most of the time in which a
/// scene is read.
std::size_t parsed_documents();

/// The value of the n-th `--set`: a TOML value, or else text. Never fails.
Node parse_setting(std::string_view text, std::uint32_t setting);

/// Fault of a `--set` that begins as a list, a table or a string in quotes and is none,
/// so that it would be taken for plain text. Its position means nothing.
std::optional<Fault> explain_setting(std::string_view text);

/// Text and settings as they were written, for messages.
class Source {
 public:
  /// Text and settings must outlive the source.
  Source(std::string file, std::string_view text, const std::vector<Setting>& settings);

  SourceLocation location(const Extent& extent) const;
  /// On one line and shortened to fit a message.
  std::string written(const Extent& extent) const;
  /// The extent as the text, or the setting, has it.
  std::string_view slice(const Extent& extent) const;
  /// Position of a byte of a string's contents; that of the string where escapes hide it.
  SourceLocation location_inside(const Node& text, std::size_t byte) const;

 private:
  std::size_t offset(const TextPosition& mark) const;

  std::string file_;
  std::string_view text_;
  const std::vector<Setting>& settings_;
  // The last search ended here: faults come mostly in order, and lines may be megabytes long.
  mutable TextPosition last_mark_{1, 1};
  mutable std::size_t last_offset_ = 0;
};

}  // namespace tomlin
