#include "framework/study/accuracy/kept_choice.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/study/tradeoff/variants.hpp"

namespace tomlin {
namespace {

constexpr const char* kName = "integrator";

/// Numbers as they are, texts with a zero behind them.
class Writer {
 public:
  template <class Number>
  void number(Number x) {
    const auto bytes = std::as_bytes(std::span(&x, 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void text(const std::string& words) {
    const auto bytes = std::as_bytes(std::span(words.c_str(), words.size() + 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class Number>
  void number(Number& x) {
    if (rest_.size() < sizeof x) return fail();
    std::memcpy(&x, rest_.data(), sizeof x);
    rest_ = rest_.subspan(sizeof x);
  }
  void text(std::string& words) {
    const auto end = std::find(rest_.begin(), rest_.end(), std::byte{0});
    if (end == rest_.end()) return fail();
    words.assign(reinterpret_cast<const char*>(rest_.data()),
                 static_cast<std::size_t>(end - rest_.begin()));
    rest_ = rest_.subspan(words.size() + 1);
  }
  /// Everything was there, and nothing else.
  bool whole() const { return valid_ && rest_.empty(); }
  bool more() const { return valid_ && !rest_.empty(); }

 private:
  void fail() { valid_ = false; }

  std::span<const std::byte> rest_;
  bool valid_ = true;
};

/// The scene as it was asked for, with nothing but the integrator replaced.
std::shared_ptr<const Scene> with_integrator(const Variants& variants, const std::string& line) {
  auto result = std::make_shared<Scene>(variants.scene());
  result->run.integrator = variants.with({{"run.integrator", line}})->run.integrator;
  return result;
}

}  // namespace

void keep_choice(RunStore& store, const ChosenIntegrator& chosen) {
  Writer writer;
  writer.text(chosen.text);
  writer.number(chosen.companions.size());
  for (const Companion& one : chosen.companions) {
    writer.text(one.text);
    writer.number(one.share);
    writer.number(one.other_family);
  }
  writer.number(chosen.length);
  writer.number(chosen.pilot_cost);
  for (const Warning& warning : chosen.warnings) {
    writer.text(std::string(id_of(warning.code)));
    writer.text(warning.text);
    writer.text(warning.key);
  }
  store.keep(kName, writer.take());
}

std::optional<ChosenIntegrator> kept_choice(const RunStore& store,
                                            const std::shared_ptr<const Scene>& scene,
                                            const Registry& registry) {
  const std::vector<std::byte> bytes = store.kept(kName);
  if (bytes.empty()) return std::nullopt;
  ChosenIntegrator chosen;
  Reader reader(bytes);
  reader.text(chosen.text);
  std::size_t companions = 0;
  reader.number(companions);
  if (companions > kCompanions + 1) return std::nullopt;
  chosen.companions.resize(companions);
  for (Companion& one : chosen.companions) {
    reader.text(one.text);
    reader.number(one.share);
    reader.number(one.other_family);
  }
  reader.number(chosen.length);
  reader.number(chosen.pilot_cost);
  while (reader.more()) {
    std::string code;
    Warning warning = {};
    reader.text(code);
    reader.text(warning.text);
    reader.text(warning.key);
    const std::optional<FaultCode> known = fault_code_of(code);
    if (!known) return std::nullopt;
    warning.code = *known;
    chosen.warnings.push_back(std::move(warning));
  }
  if (!reader.whole()) return std::nullopt;
  try {
    const Variants variants(scene, registry);
    chosen.scene = with_integrator(variants, chosen.text);
    for (Companion& one : chosen.companions) one.scene = with_integrator(variants, one.text);
  } catch (const InputError&) {
    return std::nullopt;  // it is looked for again, and says itself what is wrong
  }
  return chosen;
}

}  // namespace tomlin
