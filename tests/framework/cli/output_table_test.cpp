#include "framework/cli/output_table.hpp"

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tomlin::test {
namespace {

struct TableRow {
  std::string name;
  std::optional<double> value;
  int count = 0;
};

OutputTable example_table() {
  const std::vector<TableRow> rows = {
      {"a, \"b\"", 0.1, 3},
      {"c", std::nullopt, 20},
      {"longer than its name", std::numeric_limits<double>::infinity(), 0}};
  OutputTable table;
  table.add({.key = "name", .csv = "the name", .quoted = true, .text = "name"}, rows,
            [](const TableRow& row) { return row.name; });
  table.add(
      {.key = "value", .csv = "value [force]", .text = "value", .width = 8, .format = "{:.1e}"},
      rows, [](const TableRow& row) {
        return row.value ? OutputTable::Json(*row.value) : OutputTable::Json();
      });
  table.add({.key = "odd", .csv = "odd"}, rows, [](const TableRow& row) -> OutputTable::Cell {
    if (row.count % 2 == 0) return std::nullopt;
    return row.count;
  });
  table.add({.text = "n", .width = 3}, rows, [](const TableRow& row) { return row.count; });
  return table;
}

TEST(OutputTable, ColumnsAreInEveryFormThatNamesThem) {
  const OutputTable table = example_table();
  EXPECT_EQ(table.csv(),
            "the name,value [force],odd\n"
            "\"a, \"\"b\"\"\",0.10000000000000001,3\n"
            "\"c\",,\n"
            "\"longer than its name\",,\n");
  EXPECT_EQ(table.text_names(), "  name                     value    n");
  EXPECT_EQ(table.text(0), "  a, \"b\"                 1.0e-01    3");
  EXPECT_EQ(table.text(1), "  c                            -   20");
  EXPECT_EQ(table.text(2), "  longer than its name       inf    0");
}

TEST(OutputTable, JsonHasKeysInOrderAndNoInfinity) {
  const OutputTable table = example_table();
  EXPECT_EQ(table.json(0).dump(), R"({"name":"a, \"b\"","value":0.1,"odd":3})");
  EXPECT_EQ(table.json(1).dump(), R"({"name":"c","value":null})");
  EXPECT_EQ(table.json(2).dump(), R"({"name":"longer than its name","value":null})");
}

}  // namespace
}  // namespace tomlin::test
