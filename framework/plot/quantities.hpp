#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/plot/figure.hpp"
#include "framework/plot/sample_table.hpp"
#include "framework/plot/stored_run.hpp"

/// What figures show, by name: quantities made of columns of observables.csv, and the figures of
/// one quantity over another.
namespace tomlin {

/// Whose columns a quantity is made of.
enum class Owner { nobody, driver, body };

/// How a number is made of the columns' numbers.
enum class Measure {
  component,    ///< the one column's number
  size,         ///< of the vector
  signed_size,  ///< of the vector, with the sign of its x component
};

struct Quantity {
  std::string_view name;    ///< "force_size"
  std::string_view words;   ///< for an axis: "lateral force"
  std::string_view symbol;  ///< behind the words, in gnuplot's enhanced text
  Owner owner;
  std::string_view column;  ///< behind the owner's name; of a vector without the axis
  Measure measure;
  std::string_view summary;
};

/// One quantity over another.
struct FigureKind {
  std::string_view name;  ///< "hysteresis"
  std::string_view y;     ///< names of quantities
  std::string_view x;
  std::string_view summary;
};

std::span<const Quantity> quantities();
std::span<const FigureKind> figure_kinds();

/// Null when there is none of this name.
const Quantity* find_quantity(std::string_view name);
const FigureKind* find_figure_kind(std::string_view name);

/// A quantity, or a plain column, found in a run's table.
struct Series {
  std::string name;    ///< as asked for
  std::string words;   ///< of a quantity; a column has none
  std::string symbol;  ///< of a quantity, in gnuplot's enhanced text; a column's name
  bool enhanced = false;
  std::string unit;
  Measure measure = Measure::component;
  std::vector<std::size_t> columns;  ///< of the table
};

/// Which driver and which body are meant; empty: the only one.
struct Owners {
  std::string driver;
  std::string body;
};

/// Names of the drivers and bodies that have such a column, as "driver" has "driver.force.x".
std::vector<std::string> owners_of(const SampleTable& table, std::string_view column);

/// `name` is a quantity's or else a column's. `option` is what asked for it, for messages. Throws
/// InputError that names the columns when it is not there, or the candidates when several are.
Series find_series(const SampleTable& table, const std::string& name, const Owners& owners,
                   const std::string& option);

/// The driver or body whose columns are meant. Throws InputError like find_series.
std::string chosen_owner(const SampleTable& table, Owner owner, std::string_view column,
                         const Owners& owners);

/// Beside an axis, as the run's scene calls the unit.
FigureText axis_label(const StoredRun& run, const Series& series);

/// The same in words for a column, too: "support position y" of "driver.position.y".
FigureText axis_label_in_words(const StoredRun& run, const Series& series);

/// In a key, where the axis stands for several.
std::string key_text_of(const Series& series);

/// Of one sample.
double value_of(Measure measure, std::span<const double> components);

}  // namespace tomlin
