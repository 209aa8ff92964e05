#include "forcefields/sheet_field.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/elements/neighbour_list.hpp"
#include "framework/core/elements/shared_sites.hpp"
#include "framework/core/elements/site_force.hpp"
#include "framework/core/records/facets.hpp"
#include "framework/core/text/axis_names.hpp"

TOMLIN_DECLARE_KERNELS(SheetField)

namespace tomlin {
namespace {

using Description = SheetFieldDescription;

/// In spacings of atoms, how far from one plane a sheet may be.
constexpr double kFlat = 1e-7;

[[noreturn]] void refuse_sheet(const std::string& name, const std::string& why,
                               std::string admissible) {
  throw BindError({.key = "bodies",
                   .why = "\"" + name + "\" is no periodic sheet: " + why,
                   .admissible = std::move(admissible),
                   .code = FaultCode::component_unsuitable});
}

SheetLaw law_of(const Description& d) {
  const auto p = LennardJonesSmooth::parameters<double, 3>(d);
  return {p.four_epsilon, p.sigma_squared, p.at_cutoff, p.slope, p.cutoff};
}

/// The atoms of a sheet, of which the box continues x and y.
template <class Real>
SheetAtoms atoms_of(const BoundBody<Real>& sheet, const std::array<double, 3>& box) {
  std::vector<SheetPoint> atoms;
  for (const std::array<double, 3>& x : sheet.start) atoms.push_back({x[0], x[1]});
  SheetAtoms found(std::move(atoms), {box[0], box[1]});
  for (std::size_t i = 0; i < sheet.start.size(); ++i) {
    if (std::abs(sheet.start[i][2] - sheet.start[0][2]) <= kFlat * found.spacing()) continue;
    refuse_sheet(sheet.name, fmt::format("particle {} is at another height than the first", i),
                 "all particles at one height z");
  }
  return found;
}

template <class Real>
std::shared_ptr<const SheetTable> table_of(const Description& d, const BoundBody<Real>& sheet,
                                           const std::array<double, 3>& box) {
  const SheetAtoms atoms = atoms_of(sheet, box);
  FoundLattice found = find_lattice(atoms);
  if (!found.fault.empty()) {
    refuse_sheet(sheet.name, found.fault,
                 "a lattice of at most two particles a cell that the box continues");
  }
  double best = HUGE_VAL;
  for (int attempt = 0; attempt < kSheetAttempts; ++attempt) {
    SheetTable table = make_sheet_table(found.lattice, law_of(d), d.sigma, d.tolerance, attempt);
    table.centre[2] = sheet.start[0][2];
    table.error = measure_sheet_error(table, atoms);
    if (table.error.relative <= d.tolerance) return std::make_shared<SheetTable>(std::move(table));
    best = std::min(best, table.error.relative);
  }
  throw BindError({.key = "tolerance",
                   .why = fmt::format("the error of the harmonics is {:.2g} at least", best),
                   .admissible = fmt::format("{:.2g} or more, or lennard_jones", 1.1 * best),
                   .code = FaultCode::scene_out_of_range});
}

template <class Real>
class SheetForce : public ParticleForce<SheetField, Real, 3>,
                   public Diagnosis<Real>,
                   public SharesWork {
  using Base = ParticleForce<SheetField, Real, 3>;

 public:
  SheetForce(const Description& d, const Binding<Real>& binding, std::string sheet)
      : Base(d, binding, kernels::SheetField, kRankTranscendental), sheet_(std::move(sheet)) {}

  void share_with(const Team& team) override { team_ = &team; }

  std::vector<Pass<Real>> passes() override {
    std::vector<Pass<Real>> all = Base::passes();
    if (team_ != nullptr) shared_.share(all.front(), *team_);
    return all;
  }

  std::string why_not_finite(const Stage<Real>& stage) const override {
    const SheetTable& table = *this->description_.sheet;
    for (std::size_t i = 0; i < this->body_.slot.count; ++i) {
      const auto x = vector_at<3>(this->body_.slot, stage.position, stage.mapped_position, i);
      Real z = x[2] - this->parameters_.height;
      z = z - this->parameters_.box_height *
                  floor(fma(z, this->parameters_.inverse_box_height, Real(0.5)));
      const auto height = static_cast<double>(abs(z));
      if (!(height < table.nearest)) continue;
      return fmt::format(
          "particle {} of \"{}\" is {:.3g} from the sheet \"{}\", whose field begins at {:.3g}", i,
          this->body_.name, height, sheet_, table.nearest);
    }
    return {};
  }

  std::string note() const override {
    const SheetTable& table = *this->description_.sheet;
    const auto length = [](const SheetPoint& a) { return std::hypot(a[0], a[1]); };
    return fmt::format(
        "lattice vectors of {:.6g} and {:.6g}, {} particles a cell; well at the height {:.6g}, "
        "{:.4g} deep; first harmonics {:.4g} there, {} by exp({:.4g} z); {} stars, {} "
        "intervals of height from {:.4g} on; measured error {:.2g}: {:.2g} in energy and {:.2g} in "
        "a component of the force, from the well on",
        length(table.lattice.vectors[0]), length(table.lattice.vectors[1]),
        table.lattice.atoms.size(), table.equilibrium, table.depth, table.first,
        table.first_decay < 0.0 ? "rising" : "falling", -table.first_decay, table.stars(),
        table.intervals, table.nearest, table.error.relative, table.error.energy,
        table.error.force);
  }

 private:
  std::string sheet_;
  const Team* team_ = nullptr;
  SharedSites<Real> shared_;
};

/// Refuses a start within the field's beginning, where it is not known. Throws a BindError.
void check_heights(const StartingParticles& body, const std::string& sheet, const SheetTable& table,
                   double box_height) {
  std::optional<std::size_t> nearest;
  double least = table.nearest;
  double lowest = 0.0;
  double highest = 0.0;
  for (std::size_t i = 0; i < body.positions.size(); ++i) {
    double height = body.positions[i][2] - table.centre[2];
    if (box_height > 0.0) height -= box_height * std::floor(height / box_height + 0.5);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
    if (!(std::abs(height) < least)) continue;
    least = std::abs(height);
    nearest = i;
  }
  if (!nearest) return;
  const std::string through = lowest < 0.0 && highest > 0.0
                                  ? fmt::format("\"{}\" passes through \"{}\": ", body.name, sheet)
                                  : std::string();
  throw BindError(
      {.key = "bodies",
       .why = fmt::format("{}{} is {:.3g} from the sheet \"{}\" at the start", through,
                          name_of(body, *nearest), least, sheet),
       .admissible = fmt::format("at least {:.4g}, where the field begins", table.nearest),
       .code = FaultCode::body_invalid_coordinates});
}

template <class Real>
std::unique_ptr<BoundForce<Real>> bind(const Description& d, const Binding<Real>& binding) {
  const BoundBody<Real>* body = binding.bodies.front();
  const BoundBody<Real>* sheet = binding.bodies.back();
  if (sheet->coordinates != Coordinates::fixed) std::swap(body, sheet);
  if (sheet->coordinates != Coordinates::fixed) {
    throw BindError({.key = "bodies",
                     .why = fmt::format("neither \"{}\" nor \"{}\" is fixed: there is no sheet",
                                        sheet->name, body->name),
                     .admissible = "a sheet with coordinates = \"fixed\", or lennard_jones",
                     .code = FaultCode::component_unsuitable});
  }
  Description bound = d;
  bound.sheet = table_of(d, *sheet, binding.box);
  bound.first_origin = binding.origin;
  bound.box_height = binding.box[2];
  check_heights(starting(*body), sheet->name, *bound.sheet, bound.box_height);
  Binding<Real> on_body = binding;
  on_body.bodies = {body};
  return std::make_unique<SheetForce<Real>>(bound, on_body, sheet->name);
}

std::vector<Complaint> complaints(const Description& d, const SceneOutline& scene) {
  const auto complain = [](const char* key, std::string why, std::string admissible) {
    return std::vector<Complaint>{{.key = key,
                                   .why = std::move(why),
                                   .admissible = std::move(admissible),
                                   .code = FaultCode::component_unsuitable}};
  };
  if (scene.dimension != 3) {
    return complain("bodies", "a sheet is one in three dimensions", "a scene in three dimensions");
  }
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (scene.box[axis] > 0.0) continue;
    return complain(
        "bodies",
        fmt::format("the box is not periodic along {}, so that the sheet ends", kAxisNames[axis]),
        "a [box] that is periodic along x and y, or lennard_jones");
  }
  if (d.at_cutoff != AtCutoff::smooth) {
    return complain("at_cutoff", "the force of each atom jumps, that of the harmonics does not",
                    "\"smooth\", or lennard_jones");
  }
  if (!(d.cutoff > d.sigma)) {
    return complain("cutoff", "not beyond the height of the well", "more than sigma");
  }
  if (scene.box[2] > 0.0 && scene.box[2] < 2.0 * d.cutoff) {
    return complain("cutoff",
                    fmt::format("the periodic box is {:.6g} long along z, less than twice as long",
                                scene.box[2]),
                    fmt::format("at most {:.6g}, or a longer box", 0.5 * scene.box[2]));
  }
  return {};
}

}  // namespace

ForceRecord sheet_field_record() {
  ForceRecord record = record_of<Description>();
  record.name = "sheet_field";
  record.summary = "lennard_jones with a fixed periodic sheet, as a function of position";
  record.equation =
      "V = V_0(z) + sum over reciprocal vectors G of V_G(z) cos(2 pi G.R): the sum over the sheet "
      "of V_LJ(r) - V_LJ(cutoff) - (r - cutoff) V_LJ'(cutoff), V_LJ(r) = 4 * epsilon * "
      "((sigma/r)^12 - (sigma/r)^6)";
  record.source =
      "W. A. Steele, Surf. Sci. 36 (1973) 317, doi:10.1016/0039-6028(73)90264-1; the shifted "
      "force: S. Toxvaerd and J. C. Dyre, J. Chem. Phys. 134, 081102 (2011), "
      "doi:10.1063/1.3558787";
  record.element = Element::site;
  record.traits = {.conservative = true};
  record.fewest_bodies = 2;
  record.most_bodies = 2;
  record.complaints = of_description<&complaints>;
  record.bind = {of_description<&bind<double>>, of_description<&bind<Quad>>};
  record.parameters = {
      parameter_of<Description>("epsilon", &LennardJonesDescription::epsilon, dimension::energy,
                                "depth of the well of a pair")
          .in(positive),
      parameter_of<Description>("sigma", &LennardJonesDescription::sigma, dimension::length,
                                "where the energy of a pair passes zero; particles may come as "
                                "near to the sheet as 0.6 times this")
          .in(positive),
      parameter_of<Description>("cutoff", &LennardJonesDescription::cutoff, dimension::length,
                                "pairs further apart than this do not interact")
          .in(positive),
      parameter_of<Description>("at_cutoff", &LennardJonesDescription::at_cutoff, dimension::none,
                                "as of lennard_jones; there is \"smooth\" only")
          .by_default(AtCutoff::smooth),
      parameter("tolerance", &Description::tolerance, dimension::none,
                "largest error of the energy of a particle relative to the depth of its well over "
                "the sheet, and of its force relative to the largest attraction; in the repulsive "
                "region relative to the largest value at that height")
          .in({.low = 1e-8, .high = 0.1})};
  record.example = R"(# An atom pulled over graphene at the height that it takes by itself.
[scene]
units = "metal"

[parameters]
b = 1.42                             # length of a bond

[box]
lengths = ["4 * 3 * b", "6 * sqrt(3) * b", 40.0]
periodic = [true, true, false]

[[body]]
name = "sheet"
type = "graphene"
bond_length = "b"
cells = [4, 6]
particle_mass = 12.011
coordinates = "fixed"

[[body]]
name = "atom"
type = "point"
position = [0.3, 0.2, 3.5]
particle_mass = 39.948

[[force]]
type = "sheet_field"
bodies = ["atom", "sheet"]
epsilon = 0.005
sigma = 3.4
cutoff = 10.0
tolerance = 1e-4

[[force]]
type = "driving_spring"
body = "atom"
stiffness = 0.1
velocity = [0.1, 0.0, 0.0]

[run]
duration = 20.0
integrator = { type = "velocity_verlet", dt = 5e-3 }
)";
  return record;
}

}  // namespace tomlin
