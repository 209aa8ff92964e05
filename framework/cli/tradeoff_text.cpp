#include "framework/cli/tradeoff_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/scene/title.hpp"

namespace tomlin {
namespace {

constexpr int kMostDecades = 16;

/// Labels in a column, and what belongs to them.
class Rows {
 public:
  void add(std::string label, std::string content) {
    width_ = std::max(width_, label.size());
    rows_.emplace_back(std::move(label), std::move(content));
  }
  std::string text() const {
    std::string text;
    for (const auto& [label, content] : rows_) {
      fmt::format_to(std::back_inserter(text), "  {:<{}}  {}\n", label, width_, content);
    }
    return text;
  }

 private:
  std::vector<std::pair<std::string, std::string>> rows_;
  std::size_t width_ = 0;
};

std::string error_text(const Tradeoff& tradeoff, double error) {
  if (!tradeoff.scale.resolved) return fmt::format("{:.1e}", error);
  return fmt::format("{:.1e} ({:.1e} of {})", error, error / tradeoff.scale.size,
                     tradeoff.scale.relative ? "it" : fmt::format("{:.2g}", tradeoff.scale.size));
}

std::string second_text(const Tradeoff& tradeoff) {
  const Reference& reference = *tradeoff.reference;
  if (!reference.second_differs) return "no other scheme got through";
  std::string text = fmt::format("{} differs by {}", reference.second,
                                 error_text(tradeoff, *reference.second_differs));
  if (reference.second_agrees) return text;
  return text + (reference.second_settled ? ", and neither moves any more"
                                          : ", still moving when its part of the budget was over");
}

std::string quadruple_text(const Tradeoff& tradeoff) {
  const Reference& reference = *tradeoff.reference;
  if (!reference.quadruple_differs) return "not checked: " + reference.unchecked;
  return fmt::format("{} differs by {} over {:.3g} % of the run", reference.quadruple,
                     error_text(tradeoff, *reference.quadruple_differs),
                     100.0 * reference.quadruple_part);
}

std::string sensitivity_text(const Sensitivity& sensitivity, const ErrorScale& scale) {
  if (sensitivity.values.empty()) return "not known: " + sensitivity.why;
  std::string spread =
      fmt::format("starts that differ by {:g} and {:g} move it by {:.1e}",
                  sensitivity.sizes.front(), sensitivity.sizes.back(), sensitivity.spread);
  // Zero has no digits.
  if (scale.relative) spread += fmt::format(", {:.1f} digits are shared", sensitivity.digits);
  switch (sensitivity.verdict) {
    case Sensitivity::Verdict::determined:
      return "yes: " + spread;
    case Sensitivity::Verdict::not_determined:
      return fmt::format("NO: {}, {:.6g} to {:.6g}", spread, sensitivity.min, sensitivity.max);
    case Sensitivity::Verdict::unknown:
      break;
  }
  return "not known: " + sensitivity.why;
}

void add_reference(Rows& rows, const Tradeoff& tradeoff) {
  const Reference& reference = *tradeoff.reference;
  rows.add("reference", fmt::format("{:.12g}, error {}{}", reference.value,
                                    error_text(tradeoff, reference.error),
                                    reference.settled ? "" : "; it has not stopped moving"));
  rows.add("  by", fmt::format("{}, {} = {:g}, {} evaluations, {:.2g} s", reference.method,
                               to_string(reference.resolution), reference.knob_value,
                               reference.cost, reference.seconds));
  rows.add("  other scheme", second_text(tradeoff));
  rows.add("  quadruple", quadruple_text(tradeoff));
  if (tradeoff.scale.resolved && !tradeoff.scale.relative) {
    rows.add("  zero", fmt::format("as far as it is known: errors are parts of {:.2g}, which the "
                                   "scene's own units have for it",
                                   tradeoff.scale.size));
  }
  rows.add("determined", sensitivity_text(tradeoff.sensitivity, tradeoff.scale));
}

/// "1e-2 to 1e-4" of 2, 3, 4.
std::string accuracies(const std::vector<int>& powers) {
  if (powers.size() == 1) return fmt::format("1e-{}", powers.front());
  return fmt::format("1e-{} to 1e-{}", powers.front(), powers.back());
}

std::string marks_of(const Tradeoff& tradeoff, std::size_t index) {
  const TradeoffPoint& point = tradeoff.points[index];
  std::string marks;
  const auto add = [&marks](const std::string& mark) {
    marks += (marks.empty() ? "" : ", ") + mark;
  };
  if (tradeoff.recommendation && tradeoff.recommendation->point == index) add("recommended");
  if (!point.cheapest_at.empty()) add("cheapest at " + accuracies(point.cheapest_at));
  if (!point.fastest_at.empty()) add("fastest at " + accuracies(point.fastest_at));
  return marks;
}

/// Of each method and each power of ten of the error the cheapest point, and all that have a mark.
std::vector<std::size_t> shown_points(const Tradeoff& tradeoff) {
  std::map<std::pair<std::size_t, int>, std::size_t> cheapest;
  std::vector<std::size_t> shown;
  for (std::size_t p = 0; p < tradeoff.points.size(); ++p) {
    const TradeoffPoint& point = tradeoff.points[p];
    const double error = tradeoff.error_of(point);
    const int decade =
        error > 0.0 ? std::clamp(static_cast<int>(std::floor(std::log10(error))), -kMostDecades, 1)
                    : -kMostDecades;
    const auto [place, is_new] = cheapest.try_emplace({point.method, decade}, p);
    if (!is_new && point.cost() < tradeoff.points[place->second].cost()) place->second = p;
    if (!marks_of(tradeoff, p).empty()) shown.push_back(p);
  }
  for (const auto& [key, p] : cheapest) shown.push_back(p);
  std::sort(shown.begin(), shown.end());
  shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
  return shown;
}

std::string table(const Tradeoff& tradeoff) {
  std::size_t width = 4;
  for (const TradeoffPoint& point : tradeoff.points) {
    width = std::max(width, tradeoff.methods[point.method].name.size());
  }
  std::string text = fmt::format("  {:<{}}  {:>9}  {:>8}  {:>8}  {:>12}  {:>9}  {:>8}\n", "rung",
                                 width, "", "", "error", "evaluations", "columns", "seconds");
  for (const std::size_t p : shown_points(tradeoff)) {
    const TradeoffPoint& point = tradeoff.points[p];
    const Method& method = tradeoff.methods[point.method];
    const std::string line =
        fmt::format("  {:<{}}  {:>9}  {:>8.2g}  {:>8.1e}  {:>12}  {:>9}  {:>8.2g}  {}", method.name,
                    width, to_string(method.resolution), point.resolution, tradeoff.error_of(point),
                    point.evaluations, point.columns, point.seconds, marks_of(tradeoff, p));
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

/// Methods that are left out for the same reason stand together.
std::string gaps(const Tradeoff& tradeoff) {
  std::vector<std::pair<std::string, std::string>> by_reason;
  for (const TradeoffGap& gap : tradeoff.gaps) {
    const std::string reason = fmt::format("{}: {}", to_string(gap.kind), gap.why);
    const auto same = std::find_if(by_reason.begin(), by_reason.end(),
                                   [&](const auto& one) { return one.first == reason; });
    if (same == by_reason.end()) {
      by_reason.emplace_back(reason, gap.method);
    } else {
      same->second += "; " + gap.method;
    }
  }
  std::string text;
  for (const auto& [reason, methods] : by_reason) {
    fmt::format_to(std::back_inserter(text), "  {}: {}\n", methods, reason);
  }
  return text;
}

std::string recommendation(const Tradeoff& tradeoff) {
  if (!tradeoff.recommendation) return "no recommendation: " + tradeoff.why_none + "\n";
  const Recommendation& chosen = *tradeoff.recommendation;
  const TradeoffPoint& point = tradeoff.points[chosen.point];
  std::string text = fmt::format(
      "recommended for {} error of {:.2g}: {}, error {:.1e}, {} evaluations, {:.2g} s\n\n",
      tradeoff.scale.relative ? "a relative" : "an",
      chosen.tolerance * (tradeoff.scale.relative ? 1.0 : tradeoff.scale.size),
      tradeoff.methods[point.method].name, tradeoff.error_of(point), point.cost(), point.seconds);
  for (const std::string& line : scene_lines(chosen.settings)) text += "  " + line + "\n";
  return text;
}

}  // namespace

std::string tradeoff_text(const Scene& scene, const Tradeoff& tradeoff, const std::string& where) {
  std::string text = title_of(scene) + "\n";
  Rows rows;
  rows.add("observable", tradeoff.observable);
  if (tradeoff.reference) {
    add_reference(rows, tradeoff);
  } else {
    rows.add("reference", "none: " + tradeoff.why_none);
  }
  rows.add("budget", fmt::format("{:.3g} of {:g} s used{}", tradeoff.seconds, tradeoff.budget,
                                 tradeoff.interrupted ? ", then interrupted" : ""));
  rows.add("results", where);
  text += rows.text();
  if (!tradeoff.points.empty()) text += "\n" + table(tradeoff);
  if (tradeoff.sensitivity.verdict == Sensitivity::Verdict::not_determined) {
    text += "\nErrors below the spread have no meaning: other rounding would give others.\n";
  }
  const std::string left_out = gaps(tradeoff);
  if (!left_out.empty()) text += "\nleft out\n" + left_out;
  return text + "\n" + recommendation(tradeoff);
}

}  // namespace tomlin
