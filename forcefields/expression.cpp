#include "forcefields/expression.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "framework/core/elements/bonds.hpp"
#include "framework/core/formula/formula.hpp"
#include "framework/core/formula/formula_force.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/text/fault_code.hpp"

namespace tomlin {
namespace {

namespace variable = formula_variable;
using Description = ExpressionDescription;

FormulaLaw law_of(const Description& d) { return FormulaLaw(d.energy, d.force); }

std::array<double, 3> periods(const Description& d) {
  std::array<double, 3> period{};
  for (std::size_t axis = 0; axis < d.period.numbers.size() && axis < 3; ++axis) {
    period[axis] = d.period.numbers[axis];
  }
  return period;
}

double period_on(const Description& d, int axis) {
  return periods(d)[static_cast<std::size_t>(axis)];
}

/// Departure of a formula from a quadratic one at a length L: its third difference there, if above
/// rounding; 0 where it is not finite, as functions of large arguments may be.
double departs(const FormulaLaw& law, std::size_t component, FormulaLaw::Values at,
               std::uint32_t variable, double length) {
  // Away from zero, where formulas often are symmetric.
  constexpr double kFrom = 0.37;
  constexpr double kWeights[] = {-1.0, 3.0, -3.0, 1.0};
  constexpr double kRounding = 1e-13;
  double difference = 0.0;
  double largest = 0.0;
  for (int k = 0; k < 4; ++k) {
    at[variable] = (kFrom + k) * length;
    const auto value = law.evaluate(component, at);
    const double* number = std::get_if<double>(&value);
    if (number == nullptr || !std::isfinite(*number)) {
      return 0.0;
    }
    difference += kWeights[k] * *number;
    largest = std::max(largest, std::abs(*number));
  }
  return std::abs(difference) > kRounding * largest ? std::abs(difference) : 0.0;
}

/// The length at which what is periodic, or confined to a region, departs from a quadratic formula
/// by an eighth of the most that it ever does; 0 for what departs ever more.
double length_along(const FormulaLaw& law, std::size_t component, const FormulaLaw::Values& at,
                    std::uint32_t variable) {
  constexpr int kOctaves = 120;
  constexpr int kLast = 2 * kOctaves - 3;  // beyond it what grows has grown by more than kGrowth
  constexpr double kGrowth = 4.0;
  constexpr double kPart = 1.0 / 8.0;
  std::array<double, 2 * kOctaves + 1> found{};
  double most = 0.0;
  double before = 0.0;
  for (int k = 0; k <= 2 * kOctaves; ++k) {
    found[k] = departs(law, component, at, variable, std::ldexp(1.0, k - kOctaves));
    most = std::max(most, found[k]);
    if (k == kLast) before = most;
  }
  if (!(before > 0.0) || !(most <= kGrowth * before)) return 0.0;
  int k = 0;
  while (found[k] < kPart * most) ++k;
  return k == 0 ? 0.0 : std::ldexp(1.0, k - kOctaves);
}

double length_of_law(const Description& d) {
  // The body is not known here; where particles differ, the first few stand for all.
  constexpr int kParticles = 4;
  const FormulaLaw law = law_of(d);
  double shortest = std::numeric_limits<double>::infinity();
  FormulaLaw::Values at{};
  at[variable::count] = kParticles;
  for (int particle = 0; particle < (law.depends_on_particle() ? kParticles : 1); ++particle) {
    at[variable::index] = particle;
    for (std::size_t component = 0; component < law.components(); ++component) {
      for (const std::uint32_t first : {variable::position, variable::centre}) {
        for (std::uint32_t along = first; along < first + 3; ++along) {
          if (!law.uses(along)) continue;
          at[variable::time] = 0.0;
          double length = length_along(law, component, at, along);
          if (length == 0.0 && law.depends_on_time()) {
            at[variable::time] = 1.0;  // nothing acts at the start
            length = length_along(law, component, at, along);
          }
          if (length > 0.0) shortest = std::min(shortest, length);
        }
      }
    }
  }
  return std::isfinite(shortest) ? shortest : 0.0;
}

Element element_of_law(const Description& d) {
  switch (law_of(d).element()) {
    case FormulaElement::particle:
      return Element::site;
    case FormulaElement::centre:
      return Element::body;
    case FormulaElement::pair:
      return Element::pair;
    case FormulaElement::angle:
      return Element::triple;
  }
  return Element::site;
}

Traits traits_of_law(const Description& d) {
  const FormulaLaw law = law_of(d);
  const FormulaElement element = law.element();
  Traits traits;
  traits.depends_on_time = law.depends_on_time();
  traits.conservative = law.has_energy();
  traits.depends_on_velocity = law.depends_on_velocity();
  traits.internal = element == FormulaElement::pair || element == FormulaElement::angle;
  for (const double period : d.period.numbers) traits.periodic = traits.periodic || period > 0.0;
  return traits;
}

std::uint64_t pairs(const Description& d, const SceneOutline& scene) {
  const FormulaElement element = law_of(d).element();
  const auto n = static_cast<std::uint64_t>(scene.bodies.front().count);
  if (element == FormulaElement::angle) {
    if (!d.angles.neighbours) return d.angles.list.size();
    const NeighbourList& bonds = scene.bodies.front().neighbours;
    return bonds ? angles_between(bonds(), n).size() : n;
  }
  if (element != FormulaElement::pair) return 0;
  return count_of(d.pairs, scene);
}

// ---- complaints ---------------------------------------------------------------------------------

class Examiner {
 public:
  Examiner(const Description& d, const SceneOutline& scene)
      : d_(d), scene_(scene), law_(d.energy, d.force) {}

  std::vector<Complaint> complaints() {
    if (d_.energy.text.empty() == d_.force.components.empty()) {
      const bool none = d_.energy.text.empty();
      complain(none ? FaultCode::scene_missing_key : FaultCode::scene_conflict, "energy",
               none ? "there is neither an energy nor a force"
                    : "there are an energy and a force, and one of them it is",
               "energy = \"...\", or force = [\"...\"] with a formula per dimension");
      return found_;
    }
    look_at_variables();
    look_at_particles();
    look_at_bodies();
    look_at_selections();
    look_at_period();
    if (found_.empty()) try_to_compile();
    if (found_.empty()) look_at_repetition();
    return found_;
  }

 private:
  const char* key() const { return law_.has_energy() ? "energy" : "force"; }

  Complaint& complain(FaultCode code, const char* at, const std::string& why,
                      const char* admissible = "") {
    Complaint& complaint = found_.emplace_back();
    complaint.key = at;
    complaint.why = why;
    complaint.admissible = admissible;
    complaint.code = code;
    return complaint;
  }

  /// Adds a complaint about a variable, where the formula names it.
  void refuse(FaultCode code, std::uint32_t index, const std::string& why,
              const char* admissible = "") {
    const auto use = law_.use_of(index);
    if (!use) return;
    Complaint& complaint = complain(
        code, key(), fmt::format("'{}' {}", formula_variable_name(index), why), admissible);
    complaint.column = use->column;
    complaint.index = use->component;
  }

  /// Numbers that differ between particles, and random numbers.
  void look_at_particles() {
    const std::size_t before = found_.size();
    if (const auto& use = law_.misplaced_random()) {
      Complaint& complaint =
          complain(FaultCode::component_invalid, key(),
                   "a random number belongs to a particle, not to a position, a velocity or a time",
                   "a seed and a number that follow from i, count and parameters");
      complaint.column = use->column;
      complaint.index = use->component;
    }
    if (law_.element() != FormulaElement::particle) {
      for (const std::uint32_t index : {variable::index, variable::count}) {
        refuse(FaultCode::expression_unknown_name, index,
               fmt::format("is a variable of particles, and this energy is over {}",
                           name_of_element(law_.element())),
               "i and count in an energy over particles (x, y, z) or in a force; a parameter");
      }
    }
    if (law_.particle_numbers() > FormulaLaw::kMostParticleNumbers) {
      complain(FaultCode::scene_too_large, key(),
               fmt::format("{} different subexpressions depend on the index of the particle alone, "
                           "and at most {} can be kept",
                           law_.particle_numbers(), FormulaLaw::kMostParticleNumbers),
               "fewer of them, or several forces");
    }
    if (found_.size() > before || scene_.bodies.empty()) return;
    const auto numbers =
        law_.numbers_of_particles(static_cast<std::size_t>(scene_.bodies.front().count));
    if (const auto* trouble = std::get_if<FormulaLaw::Trouble>(&numbers)) {
      found_.push_back(complaint_about(law_, *trouble));
    }
  }

  static const char* name_of_element(FormulaElement element) {
    switch (element) {
      case FormulaElement::particle:
        return "particles";
      case FormulaElement::centre:
        return "the centre of mass (xc, yc, zc)";
      case FormulaElement::pair:
        return "pairs (r)";
      case FormulaElement::angle:
        return "angles (theta)";
    }
    return "";
  }

  void look_at_variables() {
    const FormulaElement element = law_.element();
    for (std::uint32_t index = 0; index < variable::distance; ++index) {
      if (static_cast<int>(index % 3) < scene_.dimension) continue;
      refuse(FaultCode::expression_unknown_name, index,
             fmt::format("is no coordinate of a scene with {} dimension{}", scene_.dimension,
                         scene_.dimension == 1 ? "" : "s"));
    }
    if (!law_.has_energy()) {
      if (law_.components() != static_cast<std::size_t>(scene_.dimension)) {
        complain(FaultCode::scene_wrong_count, "force",
                 fmt::format("{} formula{} for {} dimension{}", law_.components(),
                             law_.components() == 1 ? "" : "s", scene_.dimension,
                             scene_.dimension == 1 ? "" : "s"),
                 "one formula per dimension");
      }
      for (std::uint32_t index = variable::centre; index < variable::time; ++index) {
        refuse(FaultCode::expression_unknown_name, index, "is a variable of energies",
               "x, y, z, vx, vy, vz, t, i and count in a force");
      }
      return;
    }
    for (std::uint32_t index = variable::velocity; index < variable::centre; ++index) {
      refuse(FaultCode::expression_unknown_name, index, "is a velocity, and an energy has none",
             "force = [\"...\"], which may name velocities");
    }
    bool any = false;
    for (std::uint32_t index = 0; index < variable::time; ++index) any = any || law_.uses(index);
    if (!any) {
      complain(FaultCode::component_invalid, "energy",
               "names no coordinate: there is no force in it");
    }
    for (std::uint32_t index = 0; index < variable::time; ++index) {
      if (element_named_by(index) == element) continue;
      if (index >= variable::velocity && index < variable::centre) continue;
      refuse(FaultCode::component_invalid, index,
             "does not go together with what else the energy is over",
             "an energy over particles (x, y, z), the centre of mass (xc, yc, zc), pairs (r) or "
             "angles (theta); a force for each");
    }
  }

  static FormulaElement element_named_by(std::uint32_t index) {
    if (index == variable::distance) return FormulaElement::pair;
    if (index == variable::angle) return FormulaElement::angle;
    return index < variable::centre ? FormulaElement::particle : FormulaElement::centre;
  }

  void look_at_bodies() {
    const FormulaElement element = law_.element();
    if (scene_.bodies.size() > 1 && element != FormulaElement::pair) {
      complain(FaultCode::component_unsuitable, "bodies",
               "only a formula of r acts between two bodies", "body = \"...\", one of them");
    }
    if (element == FormulaElement::angle && scene_.dimension == 1) {
      refuse(FaultCode::expression_unknown_name, variable::angle,
             "is no variable of a scene on a line: there are no angles");
    }
    if (element == FormulaElement::angle && scene_.bodies.front().count < 3) {
      complain(FaultCode::component_unsuitable, "energy", "an angle takes three particles");
    }
  }

  /// A selection of what the formula is not over would be passed by in silence.
  void look_at_selections() {
    const FormulaElement element = law_.element();
    if (element != FormulaElement::pair && d_.pairs != Description{}.pairs) {
      complain(FaultCode::scene_conflict, "pairs", "the formula is not over pairs",
               "pairs beside an energy of r");
    }
    if (element != FormulaElement::angle && d_.angles != Description{}.angles) {
      complain(FaultCode::scene_conflict, "angles", "the formula is not over angles",
               "angles beside an energy of theta");
    }
  }

  void look_at_period() {
    const auto& numbers = d_.period.numbers;
    if (numbers.empty()) return;
    const FormulaElement element = law_.element();
    if (element == FormulaElement::pair || element == FormulaElement::angle) {
      complain(FaultCode::scene_conflict, "period", "distances and angles have no period in space");
    } else if (numbers.size() > static_cast<std::size_t>(scene_.dimension)) {
      complain(FaultCode::scene_wrong_count, "period", "more periods than the scene has dimensions",
               "along x, or one per dimension with 0 where there is none");
    }
  }

  void try_to_compile() {
    try {
      law_.compiled(scene_.dimension, {true, true, true});
    } catch (const std::length_error&) {
      complain(FaultCode::scene_too_large, key(),
               "the formula becomes too large when it is differentiated",
               "a shorter one, or a user-defined force in C++");
    }
  }

  /// A wrong period would shift a run by its error at each cell: it has to be one.
  void look_at_repetition() {
    const auto period = periods(d_);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (period[axis] > 0.0 && !repeats_along(axis, period[axis])) return;
    }
  }

  bool repeats_along(std::size_t axis, double length) {
    constexpr int kPoints = 97;
    constexpr double kRounding = 1e-9;  // of formulas with some dozens of operations
    constexpr double kFar = 1000.0;     // every other point is compared with one so far away
    constexpr double kFarRounding = 1e-6;
    const std::uint32_t first =
        law_.element() == FormulaElement::centre ? variable::centre : variable::position;
    for (std::size_t component = 0; component < law_.components(); ++component) {
      for (int k = 0; k < kPoints; ++k) {
        // Points that no symmetry links: multiples of the golden mean, modulo one.
        FormulaLaw::Values at{};
        at[variable::count] = static_cast<double>(scene_.bodies.front().count);
        at[variable::index] = static_cast<double>(k % scene_.bodies.front().count);
        for (std::size_t d = 0; d <= variable::time; ++d) {
          const double turn = 0.6180339887498949 * (k + 1) + 0.7548776662466927 * double(d);
          at[d] = length * (turn - std::floor(turn) - 0.5);
        }
        at[first + axis] -= 0.5 * length;
        FormulaLaw::Values after = at;
        const bool far = k % 2 == 1;
        const double periods = far ? kFar : 1.0;
        after[first + axis] += periods * length;
        const auto here = law_.evaluate(component, at);
        const auto there = law_.evaluate(component, after);
        if (here.index() != 0 || there.index() != 0) continue;
        const double one = std::get<double>(here);
        const double other = std::get<double>(there);
        largest_ = std::max({largest_, std::abs(one), std::abs(other)});
        if (std::abs(one - other) <= (far ? kFarRounding : kRounding) * largest_) continue;
        const std::string_view name = formula_variable_name(first + axis);
        complain(FaultCode::component_invalid, "period",
                 fmt::format("\"{}\" does not repeat: it is {:.9g} at {} = {:.6g}, and {:.9g} {}",
                             law_.text(component), one, name, at[first + axis], other,
                             far ? "a thousand periods further" : "a period further"),
                 "a length after which the formula is as it was, or no period");
        return false;
      }
    }
    return true;
  }

  const Description& d_;
  const SceneOutline& scene_;
  FormulaLaw law_;
  double largest_ = 0.0;
  std::vector<Complaint> found_;
};

std::vector<Complaint> complaints(const Description& d, const SceneOutline& scene) {
  return Examiner(d, scene).complaints();
}

// ---- binding ------------------------------------------------------------------------------------

template <class Real, class Force, class... Arguments>
std::unique_ptr<BoundForce<Real>> checked(Arguments&&... arguments) {
  auto force = std::make_unique<Force>(arguments...);
  force->check_start();
  return force;
}

template <class Real>
std::unique_ptr<BoundForce<Real>> bind(const Description& d, const Binding<Real>& binding) {
  const FormulaLaw law = law_of(d);
  switch (law.element()) {
    case FormulaElement::particle:
      return checked<Real, ParticleFormula<Real>>(law, binding, periods(d));
    case FormulaElement::centre:
      return checked<Real, CentreFormula<Real>>(law, binding, periods(d));
    case FormulaElement::pair:
      return checked<Real, PairFormula<Real>>(law, binding, d.pairs);
    case FormulaElement::angle:
      return checked<Real, AngleFormula<Real>>(law, binding, d.angles);
  }
  return nullptr;
}

}  // namespace

ForceRecord expression_record() {
  auto record = record_of<Description>();
  record.name = "expression";
  record.summary = "a force given as a formula in the scene";
  record.equation =
      "F = -dV/dx of an energy V(x, y, z, t; i), V(xc, yc, zc, t), V(r, t) or V(theta, t); or F(x, "
      "y, z, vx, vy, vz, t; i) itself";
  record.source = kSourceIsTheScene;
  record.element = Element::site;
  record.traits_of = of_description<&traits_of_law>;
  record.element_of = of_description<&element_of_law>;
  record.most_bodies = 2;
  record.parameters = {
      parameter("energy", &Description::energy, dimension::energy,
                "of one element, over x, y, z (particles), xc, yc, zc (the centre of mass), r "
                "(pairs) or theta (angles), and t; of a particle also over its index i and the "
                "count of particles, with random numbers of these")
          .or_absent(),
      parameter("force", &Description::force, dimension::force,
                "on each particle, a formula per dimension over x, y, z, vx, vy, vz, t, i and "
                "count: where there is no energy")
          .or_absent(),
      parameter(
          "pairs", &Description::pairs, dimension::none,
          "of an energy over r: \"all\", \"neighbours\" or a list of index pairs; between two "
          "bodies the first index of a pair is in the first. In a periodic box r is that of the "
          "nearest images at every time; neighbours along a chain keep theirs, and join the last "
          "particle to the first in a closed body such as a ring, and in a chain along a periodic "
          "axis; in a flake they are the nearest neighbours of its lattice")
          .by_default(PairSelection{.kind = PairSelection::Kind::all, .list = {}}),
      parameter("angles", &Description::angles, dimension::none,
                "of an energy over theta: \"neighbours\", each particle with those before and "
                "behind (in a flake each two bonds that meet in a particle), or a list of index "
                "triples with the vertex in the middle")
          .by_default(AngleSelection{}),
      parameter("period", &Description::period, dimension::length,
                "length along x, or one per dimension (0: none), after which the formula repeats: "
                "keeps its digits however far a body goes")
          .in(non_negative)
          .or_absent()};
  record.complaints = of_description<&complaints>;
  record.pairs = of_description<&pairs>;
  record.period = of_description<&period_on>;
  record.length = of_description<&length_of_law>;
  record.bind = {of_description<&bind<double>>, of_description<&bind<Quad>>};
  record.example =
      R"toml(# The substrate of a rolling ring as a formula: a particle swings about the minimum.
[parameters]
V0 = 0.1
a = 1.0
lambda = 1.0

[[body]]
type = "point"
position = [0.4, 0.1]
particle_mass = 1.0

[[force]]
type = "expression"
energy = "V0 * exp(-lambda * y^2) * cos(2*pi*x/a)"
period = "a"

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)toml";
  return record;
}

}  // namespace tomlin
