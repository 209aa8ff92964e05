#include "framework/cli/node_json.hpp"

#include <type_traits>
#include <variant>

namespace tomlin {

nlohmann::ordered_json json_of(const Node& node) {
  using Json = nlohmann::ordered_json;
  return std::visit(
      [](const auto& given) -> Json {
        using Kind = std::decay_t<decltype(given)>;
        if constexpr (std::is_same_v<Kind, List>) {
          Json list = Json::array();
          for (const Node& element : given) list.push_back(json_of(element));
          return list;
        } else if constexpr (std::is_same_v<Kind, Table>) {
          Json object = Json::object();
          for (const Entry& entry : given.entries) object[entry.key] = json_of(entry.value);
          return object;
        } else if constexpr (std::is_same_v<Kind, Moment>) {
          return nullptr;
        } else {
          return given;
        }
      },
      node.value);
}

}  // namespace tomlin
