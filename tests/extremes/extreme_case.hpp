#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/scene/scene.hpp"

/// Extreme scenes as data: what is extreme, and what has to come of it.
namespace tomlin::test {

/// How a run has to come out.
enum class Outcome {
  finished,  ///< the values are right
  refused,   ///< before anything is made: the input is at fault
  failed,    ///< results say `failed`, with position and cause
};

/// "finished", "refused", "failed".
const char* to_string(Outcome outcome);

/// A number of the summary and what it has to be.
struct Value {
  std::string path;               ///< as in summary.json, components by letter
  std::function<double()> right;  ///< closed form, limit, or a run of another kind
  double tolerance = 0.0;         ///< absolute
  std::string reason;             ///< where the right number comes from, and the tolerance
};

struct ExtremeCase {
  std::string name;     ///< unique; letters, digits and underscores
  std::string extreme;  ///< what is extreme, in a few words
  std::string scene;    ///< the scene's name on the page
  std::string text;     ///< its text
  std::vector<Setting> settings;
  Outcome outcome = Outcome::finished;
  std::vector<Value> values;
  std::vector<FaultCode> warnings = {};  ///< of a run that finishes: these and no others
  std::vector<std::string> words = {};   ///< in the refusal or the failure
  bool slow = false;
  double seconds = 20.0;  ///< what takes longer hangs
};

/// The cases of one subject: a table of the page.
struct Subject {
  std::string name;   ///< of its ctest
  std::string title;  ///< of its section
  std::vector<ExtremeCase> cases;
};

Subject stiffness();
Subject geometry();
Subject driving();
Subject damping();
Subject size();
Subject far_away();
Subject steps();
Subject units();
Subject degenerate();

/// All of them, in the order of the page.
std::vector<Subject> subjects();

}  // namespace tomlin::test
