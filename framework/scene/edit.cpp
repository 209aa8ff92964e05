#include "framework/scene/edit.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "framework/core/text/fault_code.hpp"
#include "framework/core/text/utf8.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/settings.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

/// One setting on its way into the text.
class Edit {
 public:
  Edit(std::string text, const std::string& file) : text_(std::move(text)), file_(file) {}

  std::string with(const Setting& setting) {
    setting_ = &setting;
    std::vector<std::string> parts = parts_of(setting.path);
    if (parts.size() == 1) parts.insert(parts.begin(), "parameters");
    put(parts, value_text(parse_setting(setting.value, 1)));
    return std::move(text_);
  }

 private:
  [[noreturn]] void refuse(FaultCode code, std::string why) const {
    throw InputError({Fault(code, {file_}, setting_->path, setting_->value, std::move(why))});
  }

  /// Indices in the text at which an extent begins and ends.
  std::pair<std::size_t, std::size_t> span(const Extent& extent) const {
    const Source source(file_, text_, no_settings_);
    const std::string_view slice = source.slice(extent);
    const auto begin = static_cast<std::size_t>(slice.data() - text_.data());
    return {begin, begin + slice.size()};
  }

  bool is_inline(const Node& table) const {
    const auto [begin, end] = span(table.where);
    return begin < text_.size() && text_[begin] == '{';
  }

  std::size_t start_of_line(std::size_t at) const {
    const std::size_t before = at == 0 ? std::string::npos : text_.rfind('\n', at - 1);
    return before == std::string::npos ? 0 : before + 1;
  }

  /// Behind the line break; one is added where the text ends without.
  std::size_t start_of_next_line(std::size_t at) {
    const std::size_t end = text_.find('\n', at);
    if (end != std::string::npos) return end + 1;
    if (text_.ends_with('\n')) return text_.size();
    text_ += '\n';
    return text_.size();
  }

  void put(const std::vector<std::string>& parts, const std::string& value) {
    document_ = parse_document(text_, file_);
    const Table* table = &document_;
    const Node* node = nullptr;  // of that table; none: the document's own
    std::size_t next = 0;
    if (parts[0] == "body" || parts[0] == "force") {
      node = component(parts);
      table = node->as<Table>();
      next = 2;
    }
    for (; next + 1 < parts.size(); ++next) {
      const Node* below = table->find(parts[next]);
      if (below == nullptr) return begin_table(parts, next, value);
      if (below->as<Table>() == nullptr) {
        refuse(FaultCode::scene_unknown_key, parts[next] + " is not a table");
      }
      node = below;
      table = below->as<Table>();
    }
    const Entry* entry = table->find_entry(parts.back());
    if (entry == nullptr) {
      insert(*table, *node, parts.back(), value);
    } else if (entry->value.as<Table>() != nullptr && !is_inline(entry->value)) {
      replace_table(parts, value);
    } else {
      const auto [begin, end] = span(entry->value.where);
      text_.replace(begin, end - begin, value);
    }
  }

  const Node* component(const std::vector<std::string>& parts) const {
    const Node* list = document_.find(parts[0]);
    if (list != nullptr && list->as<List>() != nullptr) {
      for (const Node& one : *list->as<List>()) {
        const Table* table = one.as<Table>();
        if (table != nullptr && name_of(*table) == parts[1]) return &one;
      }
    }
    refuse(FaultCode::scene_unknown_name, "there is no " + parts[0] + " of that name");
  }

  /// A table that is not there yet: at the end where it is one of the scene's own.
  void begin_table(const std::vector<std::string>& parts, std::size_t next,
                   const std::string& value) {
    const std::vector<std::string>& own = top_level_keys();
    const bool known = std::find(own.begin(), own.end(), parts[0]) != own.end();
    if (next != 0 || parts.size() != 2 || !known) {
      refuse(FaultCode::scene_unknown_key,
             "there is no table " + parts[next] + " to insert the key into");
    }
    start_of_next_line(text_.size());
    text_ += "\n[" + key_text(parts[0]) + "]\n" + key_text(parts[1]) + " = " + value + "\n";
  }

  /// A new line below the last of the table's own.
  void insert(const Table& table, const Node& node, const std::string& key,
              const std::string& value) {
    if (is_inline(node)) {
      refuse(FaultCode::command_invalid_value, "the table is an inline table");
    }
    std::size_t last = span(node.where).first;
    std::size_t end = last;
    for (const Entry& entry : table.entries) {
      if (entry.value.as<Table>() != nullptr && !is_inline(entry.value)) continue;
      const auto [begin, behind] = span(entry.value.where);
      if (behind <= end) continue;
      last = span(entry.where).first;
      end = behind;
    }
    const std::size_t line = start_of_line(last);
    const std::size_t text = text_.find_first_not_of(" \t", line);
    const std::string indent = text_.substr(line, text - line);
    text_.insert(start_of_next_line(end), indent + key_text(key) + " = " + value + "\n");
  }

  /// A table under a header of its own: its lines one by one.
  void replace_table(const std::vector<std::string>& parts, const std::string& value) {
    const Node replacement = parse_setting(value, 1);
    const Table* table = replacement.as<Table>();
    if (table == nullptr) refuse(FaultCode::scene_wrong_type, parts.back() + " is a table");
    for (const Entry& entry : table->entries) put_below(parts, entry);
    comment_out(parts, *table);
  }

  void put_below(std::vector<std::string> parts, const Entry& entry) {
    parts.push_back(entry.key);
    put(parts, value_text(entry.value));
  }

  /// The lines of a table whose keys the new one does not have.
  void comment_out(const std::vector<std::string>& parts, const Table& kept) {
    document_ = parse_document(text_, file_);
    const Table* table = &document_;
    for (const std::string& part : parts) table = table->find(part)->as<Table>();
    std::vector<std::size_t> starts;
    for (const Entry& entry : table->entries) {
      if (kept.find(entry.key) == nullptr) starts.push_back(start_of_line(span(entry.where).first));
    }
    std::sort(starts.rbegin(), starts.rend());
    for (const std::size_t start : starts) text_.insert(start, "# ");
  }

  std::string text_;
  const std::string& file_;
  const Setting* setting_ = nullptr;
  Table document_;
  const std::vector<Setting> no_settings_;
};

}  // namespace

std::string edited(std::string_view text, const std::string& file,
                   const std::vector<Setting>& settings) {
  const bool marked = text.starts_with(kByteOrderMark);
  if (marked) text.remove_prefix(kByteOrderMark.size());
  std::string result(text);
  for (const Setting& setting : settings) result = Edit(std::move(result), file).with(setting);
  return marked ? std::string(kByteOrderMark) + result : result;
}

}  // namespace tomlin
