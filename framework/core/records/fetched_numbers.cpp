#include "framework/core/records/fetched_numbers.hpp"

#include <utility>

#include <fmt/format.h>

#include "framework/core/text/text_file.hpp"
#include "framework/core/text/utf8.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kLargestFile = std::size_t{16} << 20;  // bytes; as of a scene

FileTextsInUse*& texts_of_this_thread() {
  thread_local FileTextsInUse* texts = nullptr;
  return texts;
}

}  // namespace

FileTexts::FileTexts(const std::map<std::string, std::string>& accepted) {
  for (const auto& [name, text] : accepted) texts_[name] = {text, true};
}

std::map<std::string, std::string> FileTexts::accepted() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, std::string> found;
  for (const auto& [name, one] : texts_) {
    if (one.accepted) found[name] = one.text;
  }
  return found;
}

std::optional<std::string> FileTexts::find(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = texts_.find(name);
  return found == texts_.end() ? std::nullopt : std::optional(found->second.text);
}

void FileTexts::keep(const std::string& name, std::string_view text) {
  const std::lock_guard lock(mutex_);
  texts_.try_emplace(name, Text{std::string(text)});
}

void FileTexts::accept(const std::set<std::string>& names) {
  const std::lock_guard lock(mutex_);
  for (const std::string& name : names) texts_[name].accepted = true;
}

FileTextsInUse::FileTextsInUse(FileTexts* texts)
    : texts_(texts), before_(std::exchange(texts_of_this_thread(), this)) {}

FileTextsInUse::~FileTextsInUse() { texts_of_this_thread() = before_; }

std::optional<std::string> FileTextsInUse::find(const std::string& name) {
  std::optional<std::string> text = texts_ != nullptr ? texts_->find(name) : std::nullopt;
  if (text) names_.insert(name);
  return text;
}

void FileTextsInUse::keep(const std::string& name, std::string& text) {
  if (texts_ == nullptr) return;
  std::size_t at = valid_utf8_prefix(text);
  while (at < text.size()) {
    text[at] = '?';
    at += valid_utf8_prefix(std::string_view(text).substr(at));
  }
  texts_->keep(name, text);
  names_.insert(name);
}

void FileTextsInUse::accept() {
  if (texts_ != nullptr) texts_->accept(names_);
}

FetchedText fetch_text(const std::string& name, const std::filesystem::path& folder,
                       const std::string& key) {
  FetchedText fetched;
  const auto refuse = [&](FaultCode code, std::string why, std::string admissible = "") {
    fetched.complaints.push_back(
        {.key = key, .why = std::move(why), .admissible = std::move(admissible), .code = code});
  };
  if (name.find('\0') != std::string::npos) {
    refuse(FaultCode::file_cannot_read, "not the name of a file");
    return fetched;
  }
  fetched.path = folder / name;
  FileTextsInUse* const texts = texts_of_this_thread();
  if (auto text = texts != nullptr ? texts->find(name) : std::nullopt) {
    fetched.text = *std::move(text);
    return fetched;
  }
  TextFile contents = read_text_file(fetched.path, kLargestFile);
  if (!contents.why.empty()) {
    refuse(FaultCode::file_cannot_read, fetched.path.string() + ": " + contents.why);
  } else if (contents.too_large) {
    refuse(FaultCode::scene_too_large, fetched.path.string() + ": the file is too large",
           fmt::format("at most {} MB", kLargestFile >> 20));
  }
  fetched.text = std::move(contents.text);
  if (texts != nullptr && fetched.complaints.empty()) texts->keep(name, fetched.text);
  return fetched;
}

FetchedNumbers fetch_numbers(const std::string& name, const std::filesystem::path& folder,
                             const std::string& key, std::size_t most_columns,
                             const std::string& why_most) {
  FetchedText text = fetch_text(name, folder, key);
  FetchedNumbers fetched{{}, std::move(text.path), std::move(text.complaints)};
  if (!fetched.complaints.empty()) return fetched;
  fetched.file = parse_numbers(text.text, fetched.path.string(), most_columns, why_most);
  for (std::string& fault : fetched.file.faults) {
    fetched.complaints.push_back(
        {.key = key, .why = std::move(fault), .code = FaultCode::file_invalid});
  }
  return fetched;
}

}  // namespace tomlin
