#include "framework/scene/scene_document.hpp"

#include <utility>

#include "framework/core/text/text_file.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/reader.hpp"
#include "framework/scene/settings.hpp"
#include "framework/scene/size_checks.hpp"

namespace tomlin {

namespace {

std::string contents_of(const std::string& file) {
  TextFile contents = read_text_file(file, kLargestSceneFile);
  if (contents.too_large) refuse_too_large(file);
  if (contents.why.empty()) return std::move(contents.text);
  throw InputError(
      {Fault(FaultCode::file_cannot_read, {file, 1, 1}, "", "", std::move(contents.why))});
}

}  // namespace

SceneDocument::SceneDocument(const std::string& file) : file_(file) {
  try {
    text_ = contents_of(file_);
    parse();
  } catch (const InputError& error) {
    fault_ = error;
  }
}

SceneDocument::SceneDocument(std::string text, std::string file)
    : file_(std::move(file)), text_(std::move(text)) {
  try {
    parse();
  } catch (const InputError& error) {
    fault_ = error;
  }
}

void SceneDocument::parse() {
  contents_ = parse_document(text_, file_);
  std::map<std::string, std::string> texts = texts_of_files(*contents_);
  if (!texts.empty()) texts_ = std::make_shared<FileTexts>(texts);
}

void SceneDocument::keep_files() { texts_ = std::make_shared<FileTexts>(files()); }

std::map<std::string, std::string> SceneDocument::files() const {
  return texts_ ? texts_->accepted() : std::map<std::string, std::string>();
}

Table SceneDocument::with(const std::vector<Setting>& settings) const {
  if (fault_) throw InputError(*fault_);
  const Source source(file_, text_, settings);
  FaultList faults(source);
  Table changed = *contents_;
  apply_settings(settings, changed, faults);
  faults.throw_if_any();
  return changed;
}

std::vector<NamedLibrary> SceneDocument::libraries() const {
  if (!contents_) return {};
  const std::vector<Setting> none;
  const Source source(file_, text_, none);
  FaultList faults(source);
  return named_libraries(*contents_, file_, source, faults);
}

std::optional<SweepSettings> SceneDocument::sweep(std::vector<Fault>& found) const {
  if (fault_) throw InputError(*fault_);
  const std::vector<Setting> none;
  return sweep_settings(*contents_, Source(file_, text_, none), found);
}

void SceneDocument::drop_sweep() {
  if (!contents_) return;
  std::erase_if(contents_->entries, [](const Entry& entry) { return entry.key == "sweep"; });
}

std::shared_ptr<const Scene> SceneDocument::read(const Registry& registry,
                                                 const std::vector<Setting>& settings,
                                                 EffectiveText text) const {
  if (fault_) throw InputError(*fault_);
  FileTextsInUse texts(texts_.get());
  const Source source(file_, text_, settings);
  FaultList faults(source);
  Table changed;
  if (!settings.empty()) {
    changed = *contents_;
    apply_settings(settings, changed, faults);
  }
  const Table& document = settings.empty() ? *contents_ : changed;
  // The reading that follows evaluates them.
  if (!check_expressions(document, faults)) faults.throw_if_any();
  auto scene = read_document(document, file_, source, registry, faults, text);
  texts.accept();
  return scene;
}

std::shared_ptr<const Scene> read_scene(const std::string& file, const Registry& registry,
                                        const std::vector<Setting>& settings) {
  return SceneDocument(file).read(registry, settings);
}

std::shared_ptr<const Scene> parse_scene(std::string_view text, const std::string& file,
                                         const Registry& registry,
                                         const std::vector<Setting>& settings) {
  return SceneDocument(std::string(text), file).read(registry, settings);
}

}  // namespace tomlin
