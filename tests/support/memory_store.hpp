#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "framework/run/run.hpp"

namespace tomlin::test {

/// A store in memory that counts what is kept.
class MemoryStore : public RunStore {
 public:
  std::vector<std::byte> kept(const std::string& name) const override {
    const auto found = all.find(name);
    return found == all.end() ? std::vector<std::byte>() : found->second;
  }
  void keep(const std::string& name, std::vector<std::byte> bytes) override {
    all[name] = std::move(bytes);
    ++counts[name];
  }

  std::map<std::string, std::vector<std::byte>> all;
  std::map<std::string, int> counts;  ///< how often each was kept
};

}  // namespace tomlin::test
