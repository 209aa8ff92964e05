#include "framework/scene/parameter_table.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "framework/core/text/nearest_name.hpp"
#include "framework/scene/units.hpp"

namespace tomlin {
namespace {

// The nearest of ten thousand names takes a millisecond to find; nobody reads a thousand faults.
constexpr std::size_t kMostSuggestions = 200;

// Keeps the message of a long cycle on a screen.
constexpr std::size_t kLongestCycleShown = 12;

/// Name of the number of particles in expressions.
constexpr std::string_view kCount = "count";

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 60;
  if (text.size() <= longest) return '\'' + std::string(text) + '\'';
  return '\'' + std::string(text.substr(0, longest)) + "...'";
}

bool is_variable(std::string_view name) {
  const auto variables = expression_variables();
  return std::find(variables.begin(), variables.end(), name) != variables.end();
}

bool is_particle_variable(std::string_view name) {
  const auto variables = particle_variables();
  return std::find(variables.begin(), variables.end(), name) != variables.end();
}

bool is_function(std::string_view name) {
  const auto functions = expression_functions();
  return std::any_of(functions.begin(), functions.end(),
                     [name](const ExpressionFunction& one) { return one.name == name; });
}

/// The message for "2.5 nm".
ExpressionError explain_unit(const NumberWithUnit& found) {
  const std::string number(found.number);
  const std::string unit(found.unit);
  const std::string written = written_without_unit(found);
  std::string why = std::string(kNumbersHaveNoUnits) + "; write " + written;
  if (is_identifier(unit) && written == number) {
    why += ", or '" + number + " * " + unit + "' where " + unit + " is a parameter";
  }
  return {found.column, std::move(why)};
}

template <class Result>
Result parsed(std::string_view text) {
  auto result = Expression::parse(text);
  if (auto* error = std::get_if<ExpressionError>(&result)) {
    if (const auto unit = unit_in(text)) return explain_unit(*unit);
    return std::move(*error);
  }
  return std::get<Expression>(std::move(result));
}

}  // namespace

void ParameterTable::add(std::string name, double value) { append(std::move(name), value); }

void ParameterTable::add(std::string name, std::string_view expression) {
  append(std::move(name), parsed<Source>(expression));
}

void ParameterTable::append(std::string name, Source source) {
  by_name_.try_emplace(name, entries_.size());
  entries_.push_back({std::move(name), std::move(source)});
}

std::optional<std::size_t> ParameterTable::find(std::string_view name) const {
  const auto found = by_name_.find(name);
  if (found == by_name_.end()) return std::nullopt;
  return found->second;
}

void ParameterTable::fault(std::size_t entry, ParameterFault::Part part, ExpressionError error) {
  faults_.push_back({entries_[entry].name, entry, part, error.column, std::move(error.why),
                     std::move(error.nearest), error.code});
}

void ParameterTable::check_names() {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const std::string& name = entries_[i].name;
    FaultCode code = FaultCode::scene_invalid_name;
    std::string why;
    if (!is_identifier(name)) {
      why = "a parameter's name is a letter or '_' followed by letters, digits and '_'";
    } else if (is_function(name) && is_reserved_name(name)) {
      why = in_quotes(name) + " is a function of expressions; choose another name";
    } else if (name == "pi") {
      why = "'pi' is a constant of expressions; choose another name";
    } else if (is_variable(name)) {
      why = in_quotes(name) + " is a variable of expressions; choose another name";
    } else if (by_name_.at(name) != i) {
      code = FaultCode::scene_duplicate_key;
      why = "the parameter is given twice";
    }
    if (!why.empty()) fault(i, ParameterFault::Part::name, {.why = std::move(why), .code = code});
  }
}

ExpressionError ParameterTable::explain_unknown(std::string_view name, std::size_t column,
                                                std::optional<std::size_t> user) const {
  if (is_variable(name)) {
    return {.column = column,
            .why = in_quotes(name) + " is a variable; it has no value here",
            .code = FaultCode::expression_unknown_name};
  }
  if (is_particle_variable(name)) {
    const bool is_count = name == kCount;
    return {.column = column,
            .why = "there is no parameter " + in_quotes(name) + ", and " +
                   (is_count ? "here is no force on one body whose particles it could count"
                             : "this value is one for all particles"),
            .code = FaultCode::expression_unknown_name};
  }
  if (is_function(name)) {
    return {.column = column,
            .why = in_quotes(name) + " is a function; its argument follows in parentheses",
            .code = FaultCode::expression_unknown_name};
  }
  ExpressionError error{.column = column,
                        .why = "there is no parameter " + in_quotes(name),
                        .code = FaultCode::expression_unknown_name};
  if (faults_.size() >= kMostSuggestions) return error;
  std::vector<std::string> valid_names{std::string("pi")};
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const std::string& valid = entries_[i].name;
    if (i != user && is_identifier(valid) && !is_reserved_name(valid)) valid_names.push_back(valid);
  }
  const auto nearest = nearest_name(name, valid_names);
  if (name == "j" || name == "k" || name == "n" || name == "index") {
    error.why += "; in values of particles the index is 'i'";
  }
  if (!nearest && is_unit(name)) {
    error.why += ", and no units are known: give it a value in [parameters], or leave it out";
  }
  error.nearest = nearest.value_or("");
  return error;
}

std::vector<std::vector<ParameterTable::Edge>> ParameterTable::find_references() {
  std::vector<std::vector<Edge>> references(entries_.size());
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Expression* expression = std::get_if<Expression>(&entries_[i].source);
    if (expression == nullptr) continue;
    for (const Expression::Name& used : expression->names()) {
      if (const auto target = find(used.name)) {
        references[i].push_back({*target, used.column});
      } else {
        fault(i, ParameterFault::Part::value, explain_unknown(used.name, used.column, i));
      }
    }
  }
  return references;
}

void ParameterTable::report_cycle(std::vector<std::size_t> cycle,
                                  const std::vector<std::vector<Edge>>& edges) {
  // Told from the parameter that comes first, whichever the search came upon.
  std::rotate(cycle.begin(), std::min_element(cycle.begin(), cycle.end()), cycle.end());
  std::string path;
  for (std::size_t i = 0; i < cycle.size(); ++i) {
    if (i + 1 >= kLongestCycleShown && i + 1 < cycle.size()) {
      path += "... (" + std::to_string(cycle.size()) + " in all) -> ";
      break;
    }
    path += entries_[cycle[i]].name + " -> ";
  }
  path += entries_[cycle[0]].name;
  const std::size_t next = cycle[cycle.size() > 1 ? 1 : 0];
  const auto edge =
      std::find_if(edges[cycle[0]].begin(), edges[cycle[0]].end(),
                   [next](const Edge& candidate) { return candidate.target == next; });
  fault(cycle[0], ParameterFault::Part::value,
        {.column = edge->column,
         .why = "the parameter depends on itself: " + path,
         .code = FaultCode::expression_cycle});
}

void ParameterTable::compute(std::size_t index) {
  Entry& entry = entries_[index];
  if (const double* number = std::get_if<double>(&entry.source)) {
    if (std::isfinite(*number)) {
      entry.value = *number;
    } else {
      fault(index, ParameterFault::Part::value,
            {.why = "the number is not finite", .code = FaultCode::scene_not_finite});
    }
  } else if (const auto* error = std::get_if<ExpressionError>(&entry.source)) {
    fault(index, ParameterFault::Part::value, *error);
  } else {
    const Expression& expression = std::get<Expression>(entry.source);
    // A name that lacks a value has its own fault, or is part of a cycle.
    const auto& names = expression.names();
    const bool ready = std::all_of(names.begin(), names.end(), [this](const auto& used) {
      return value(used.name).has_value();
    });
    if (!ready) return;
    auto result = expression.evaluate([this](std::string_view name) { return value(name); });
    if (auto* failure = std::get_if<ExpressionError>(&result)) {
      fault(index, ParameterFault::Part::value, std::move(*failure));
    } else {
      entry.value = std::get<double>(result);
    }
  }
}

bool ParameterTable::resolve() {
  faults_.clear();
  for (Entry& entry : entries_) entry.value.reset();
  check_names();
  const auto references = find_references();

  // Depth first with a stack of our own: chains may be long.
  enum class Mark : std::uint8_t { untouched, open, done };
  struct Visit {
    std::size_t entry;
    std::size_t next_reference;
  };
  std::vector<Mark> marks(entries_.size(), Mark::untouched);
  std::vector<Visit> path;
  for (std::size_t root = 0; root < entries_.size(); ++root) {
    if (marks[root] != Mark::untouched) continue;
    marks[root] = Mark::open;
    path.push_back({root, 0});
    while (!path.empty()) {
      Visit& visit = path.back();
      if (visit.next_reference == references[visit.entry].size()) {
        compute(visit.entry);
        marks[visit.entry] = Mark::done;
        path.pop_back();
        continue;
      }
      const std::size_t target = references[visit.entry][visit.next_reference++].target;
      if (marks[target] == Mark::untouched) {
        marks[target] = Mark::open;
        path.push_back({target, 0});
      } else if (marks[target] == Mark::open) {
        std::vector<std::size_t> cycle;
        for (auto step = path.rbegin();; ++step) {
          cycle.push_back(step->entry);
          if (step->entry == target) break;
        }
        std::reverse(cycle.begin(), cycle.end());
        report_cycle(std::move(cycle), references);
      }
    }
  }

  // A key comes before its value.
  std::stable_sort(faults_.begin(), faults_.end(), [](const auto& a, const auto& b) {
    return std::tie(a.entry, a.part, a.column) < std::tie(b.entry, b.part, b.column);
  });
  return faults_.empty();
}

std::optional<double> ParameterTable::value(std::string_view name) const {
  const auto entry = find(name);
  return entry ? entries_[*entry].value : std::nullopt;
}

std::vector<std::pair<std::string, double>> ParameterTable::values() const {
  std::vector<std::pair<std::string, double>> result;
  for (const Entry& entry : entries_) {
    if (entry.value) result.emplace_back(entry.name, *entry.value);
  }
  return result;
}

std::variant<double, ExpressionError> ParameterTable::evaluate(
    std::string_view text, std::optional<std::int64_t> count) const {
  const bool counted = count && !contains(kCount);
  const std::span<const std::string_view> variables(&kCount, counted ? 1 : 0);
  const auto bound = bind(text, variables);
  if (const auto* error = std::get_if<ExpressionError>(&bound)) return *error;
  return std::get<BoundExpression>(bound).expression.evaluate(
      [&](std::string_view name) -> std::optional<double> {
        if (counted && name == kCount) return static_cast<double>(*count);
        return value(name);
      });
}

std::variant<BoundExpression, ExpressionError> ParameterTable::bind(
    std::string_view text, std::span<const std::string_view> variables) const {
  auto source = parsed<Source>(text);
  if (const auto* error = std::get_if<ExpressionError>(&source)) return *error;
  BoundExpression bound{std::get<Expression>(std::move(source)), {}};
  random_was_bound_ = random_was_bound_ || bound.expression.random_call() != nullptr;
  std::optional<ExpressionError> consequence;
  for (const Expression::Name& used : bound.expression.names()) {
    if (std::find(variables.begin(), variables.end(), used.name) != variables.end()) continue;
    if (!contains(used.name)) return explain_unknown(used.name, used.column, std::nullopt);
    if (const auto known = value(used.name)) {
      bound.parameters.emplace_back(used.name, *known);
    } else if (!consequence) {
      consequence = ExpressionError{.column = used.column,
                                    .why = "parameter " + in_quotes(used.name) + " has no value",
                                    .consequence = true,
                                    .code = FaultCode::expression_not_finite};
    }
  }
  if (consequence) return *consequence;
  return bound;
}

bool ParameterTable::draws_random() const {
  return random_was_bound_ || std::any_of(entries_.begin(), entries_.end(), [](const Entry& entry) {
           const auto* expression = std::get_if<Expression>(&entry.source);
           return expression != nullptr && expression->random_call() != nullptr;
         });
}

}  // namespace tomlin
