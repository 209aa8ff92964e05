#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Enumerations whose values have words in scenes, results or messages. The words stand in one
/// table, which is found by argument-dependent lookup and read both ways:
///
///   enum class Side { left, right };
///   constexpr auto word_table(Side) {
///     return std::to_array<Word<Side>>({{Side::left, "left"}, {Side::right, "right"}});
///   }
///
/// A parameter row takes such an enumeration as its member (framework/core/records/parameter.hpp).
namespace tomlin {

template <class E>
struct Word {
  E value;
  const char* word;  ///< null for a value that no word stands for
};

template <class E>
concept Worded = std::is_enum_v<E> && requires(E value) {
  word_table(value);
};

/// Whether an enumeration has a name for this value.
template <auto value>
constexpr bool is_enumerator() {
  // Ends in "E::name]" or in "(E)7]".
  const std::string_view text = __PRETTY_FUNCTION__;
  const char behind = text[text.rfind(')') + 1];
  return behind < '0' || behind > '9';
}

/// Whether the values count up from 0.
template <class E, std::size_t n>
constexpr bool is_in_order(const std::array<Word<E>, n>& table) {
  for (std::size_t k = 0; k < n; ++k) {
    if (table[k].value != static_cast<E>(k)) return false;
  }
  return true;
}

/// The table of E.
template <Worded E>
inline constexpr auto kWordTable = [] {
  constexpr auto table = word_table(E{});
  static_assert(is_in_order(table), "words stand in the order of the values");
  static_assert(!is_enumerator<static_cast<E>(table.size())>(), "each value stands in the table");
  return table;
}();

/// Null for a value that no word stands for.
template <Worded E>
constexpr const char* to_string(E value) {
  return kWordTable<E>[static_cast<std::size_t>(value)].word;
}

/// Nothing where the word stands for no value.
template <Worded E>
constexpr std::optional<E> value_named(std::string_view word) {
  for (const Word<E>& entry : kWordTable<E>) {
    if (entry.word != nullptr && entry.word == word) return entry.value;
  }
  return std::nullopt;
}

/// All words, in the order of their values.
template <Worded E>
std::vector<std::string> words_of() {
  std::vector<std::string> words;
  for (const Word<E>& entry : kWordTable<E>) {
    if (entry.word != nullptr) words.emplace_back(entry.word);
  }
  return words;
}

}  // namespace tomlin
