#include "framework/study/accuracy/kept_choice.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/output/record.hpp"
#include "framework/study/tradeoff/variants.hpp"

namespace tomlin {
namespace {

/// The name in the store.
constexpr const char* kChoice = "integrator";

ChosenIntegrator choice_in(RecordReader record) {
  ChosenIntegrator chosen;
  chosen.text = record.text();
  chosen.companions.resize(record.count(sizeof(std::uint64_t)));
  for (Companion& one : chosen.companions) {
    one.text = record.text();
    one.share = record.number<double>();
    one.other_family = record.number<std::uint8_t>() != 0;
  }
  chosen.length = record.number<double>();
  chosen.pilot_cost = record.number<std::uint64_t>();
  while (record.left() > 0) {
    const std::optional<FaultCode> code = fault_code_of(record.text());
    if (!code) record.refuse("no such warning");
    std::string text = record.text();
    chosen.warnings.push_back({*code, std::move(text), record.text()});
  }
  return chosen;
}

}  // namespace

void keep_choice(RunStore& store, const ChosenIntegrator& chosen) {
  RecordWriter record(RecordKind::store);
  record.text(chosen.text);
  record.number(static_cast<std::uint64_t>(chosen.companions.size()));
  for (const Companion& one : chosen.companions) {
    record.text(one.text);
    record.number(one.share);
    record.number(static_cast<std::uint8_t>(one.other_family));
  }
  record.number(chosen.length);
  record.number(chosen.pilot_cost);
  for (const Warning& warning : chosen.warnings) {
    record.text(id_of(warning.code));
    record.text(warning.text);
    record.text(warning.key);
  }
  store.keep(kChoice, {record.content().begin(), record.content().end()});
}

std::optional<ChosenIntegrator> kept_choice(const RunStore& store,
                                            const std::shared_ptr<const Scene>& scene,
                                            const Registry& registry) {
  const std::vector<std::byte> bytes = store.kept(kChoice);
  if (bytes.empty()) return std::nullopt;
  try {
    ChosenIntegrator chosen = choice_in(RecordReader("the choice of an integrator", bytes));
    const Variants variants(scene, registry);
    chosen.scene = variants.with_integrator(chosen.text);
    for (Companion& one : chosen.companions) one.scene = variants.with_integrator(one.text);
    return chosen;
  } catch (const DamagedFile&) {
    return std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;  // it is looked for again, which says itself what is wrong
  }
}

}  // namespace tomlin
