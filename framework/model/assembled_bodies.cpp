#include "framework/model/assembled_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "framework/core/numbers/sum.hpp"

namespace tomlin {
namespace {

/// Distance from one axis of a body's particles to the next, kept off multiples of a page so that
/// the axes do not compete for the same cache lines.
std::size_t stride_for(std::size_t count) {
  const std::size_t length = padded(count);
  return length % 512 == 0 ? length + 3 * kGroup : length;
}

/// Positions so far away that they cannot be counted in periods come out as no numbers.
bool placed_finitely(const std::vector<std::array<double, 3>>& start) {
  for (const auto& particle : start) {
    for (const double x : particle) {
      if (!std::isfinite(x)) return false;
    }
  }
  return true;
}

double per_particle(const PerParticle& given, std::size_t i) {
  return given.values.size() == 1 ? given.values.front() : given.values[i];
}

bool names(const std::vector<std::string>& words, const char* word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

template <class Real>
void list_species(BoundBody<Real>& body, const NamePerParticle& given, std::size_t count,
                  const std::vector<std::string>& names) {
  body.species_names = names;
  if (given.names.empty()) return;
  std::map<std::string, std::int32_t> indices;
  for (const std::string& name : names) {
    indices.emplace(name, static_cast<std::int32_t>(indices.size()));
  }
  for (std::size_t i = 0; i < count; ++i) body.species.push_back(indices.at(given.of(i)));
}

/// All but its offsets in the arrays.
template <class Real>
AssembledBody<Real> described(const SceneBody& from, std::size_t index, const AssemblyPlan& plan) {
  const BodyDescription& common = from.record->common(from.description.get());
  const BodyGeometry& geometry = (*plan.geometry)[index];
  const std::size_t count = geometry.relative.size();
  AssembledBody<Real> body;
  body.rolling_radius = geometry.rolling_radius;
  body.rolling_rise = geometry.rolling_rise;
  body.rotation_held = names(from.hold, "rotation");
  if (common.coordinates == Coordinates::rigid && plan.dimension() == 3) {
    constexpr std::array kRotations = {"rotation_x", "rotation_y", "rotation_z"};
    body.free_rotations =
        static_cast<int>(std::count_if(kRotations.begin(), kRotations.end(),
                                       [&](const char* name) { return !names(from.hold, name); }));
    for (std::size_t d = 0; d < kRotations.size(); ++d) {
      body.rotation_free[d] = !names(from.hold, kRotations[d]);
    }
    body.rotation_held = body.rotation_held || body.free_rotations == 0;
  }
  if (geometry.rolling_axis >= 0) {
    // With z, or else y, pointing up, as in the plane.
    constexpr std::array<std::array<int, 2>, 3> kPlanes = {{{1, 2}, {0, 2}, {0, 1}}};
    body.plane = kPlanes[static_cast<std::size_t>(geometry.rolling_axis)];
    const bool rotates = common.coordinates == Coordinates::rigid && !body.rotation_held;
    body.turns_in_space = common.coordinates == Coordinates::particles || rotates;
  }
  body.bound.name = from.name;
  body.bound.index = index;
  body.bound.coordinates = common.coordinates;
  const BodyEnds ends = from.record->ends(from.description.get(), plan.dimension());
  body.bound.closed = ends.closed;
  body.dimension = plan.dimension();
  body.bound.open_along = ends.open_along;
  body.bound.neighbours = neighbour_list(*from.record, from.description, plan.box);
  list_species(body.bound, common.species, count, plan.scene->species);
  if (from.motion) body.motion = &*from.motion;
  for (int d = 0; d < plan.dimension(); ++d) body.held[d] = names(from.hold, kAxisNames[d]);

  // Positions relative to the origin, to the last digit however far away the body is.
  body.bound.start.assign(count, {});
  for (int d = 0; d < plan.dimension(); ++d) {
    const double anchor = relative_to(plan.origin, d, geometry.anchor[d]);
    for (std::size_t i = 0; i < count; ++i) {
      body.bound.start[i][d] = anchor + geometry.relative[i][d];
    }
  }
  InterleavedSum<double> mass;
  for (std::size_t i = 0; i < count; ++i) {
    body.bound.mass.push_back(per_particle(common.particle_mass, i));
    mass.add(i, body.bound.mass[i]);
  }
  body.total_mass = mass.total();
  return body;
}

/// Whether its image in a periodic box is about as near to it as its own particles are to each
/// other along the axis.
template <class Real>
bool is_continued(const AssembledBody<Real>& body, int axis, double box) {
  constexpr double kMostBondRatio = 1.5;
  std::vector<double> positions;
  for (const auto& start : body.bound.start)
    positions.push_back(start[static_cast<std::size_t>(axis)]);
  std::sort(positions.begin(), positions.end());
  double widest = 0.0;
  for (std::size_t i = 1; i < positions.size(); ++i) {
    widest = std::max(widest, positions[i] - positions[i - 1]);
  }
  return box > 0.0 && widest > 0.0 &&
         box - (positions.back() - positions.front()) <= kMostBondRatio * widest;
}

template <class Real>
void check(const AssembledBody<Real>& body, const SceneBody& from, const AssemblyPlan& plan,
           std::vector<Fault>& faults) {
  for (int d = 0; d < plan.dimension() && body.bound.slot.rigid && !body.rotation_held; ++d) {
    const std::size_t axis = static_cast<std::size_t>(d);
    if (plan.dimension() != 3 || !is_continued(body, d, plan.box[axis])) continue;
    const bool about_axis = body.free_rotations == 1 && body.rotation_free[axis];
    if (about_axis) continue;
    faults.emplace_back(
        FaultCode::component_unsuitable, from.location_of("coordinates"),
        "body." + from.name + ".coordinates", "\"rigid\"",
        fmt::format("the periodic box continues it along {}: it may only rotate about this axis",
                    kAxisNames[axis]),
        fmt::format("hold = [\"rotation_{}\", \"rotation_{}\"] beside it",
                    kAxisNames[(axis + 1) % 3], kAxisNames[(axis + 2) % 3]));
    break;
  }
  if (!std::isfinite(body.total_mass)) {
    faults.emplace_back(FaultCode::scene_not_finite, from.location_of("particle_mass"),
                        "body." + from.name + ".particle_mass", "",
                        "the body's total mass overflows", "smaller masses");
  }
  if (!placed_finitely(body.bound.start)) {
    faults.emplace_back(FaultCode::scene_out_of_range, from.location, "body." + from.name, "",
                        "too far from the origin: the number of periods cannot be represented",
                        "a position nearer the origin");
  }
}

/// A smaller moment, as a part of the largest, is that of a rod about its axis.
constexpr double kLeastMomentRatio = 1e-12;

/// A body without extent (one particle) has no rotation to speak of.
template <class Real>
void find_principal_axes(AssembledBody<Real>& body) {
  if (body.rotation_held || !(body.inertia > 0.0)) return;
  std::array<InterleavedSum<double>, 9> sums;
  for (std::size_t i = 0; i < body.arms.size(); ++i) {
    const std::array<double, 3>& arm = body.arms[i];
    const double square = arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2];
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) {
        sums[3 * a + b].add(i, body.bound.mass[i] * ((a == b ? square : 0.0) - arm[a] * arm[b]));
      }
    }
  }
  Matrix3 inertia;
  for (std::size_t k = 0; k < inertia.size(); ++k) inertia[k] = sums[k].total();
  // One that rotates about an axis of space keeps that axis, whatever its tensor of inertia is.
  constexpr Quaternion kUnturned = {1.0, 0.0, 0.0, 0.0};
  body.orientation = body.free_rotations == 3 ? principal_axes(inertia) : kUnturned;
  body.rotor = true;
  // From the arms themselves: the tensor's differences would lose a thin body's smallest moment.
  std::array<InterleavedSum<double>, 3> moments;
  for (std::size_t i = 0; i < body.arms.size(); ++i) {
    const std::array<double, 3> arm = body.reference_arm(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const double one = arm[(k + 1) % 3];
      const double other = arm[(k + 2) % 3];
      moments[k].add(i, body.bound.mass[i] * (one * one + other * other));
    }
  }
  for (std::size_t k = 0; k < 3; ++k) body.moments[k] = moments[k].total();
  const double most = *std::max_element(body.moments.begin(), body.moments.end());
  for (std::size_t k = 0; k < 3; ++k) {
    const bool free = body.free_rotations == 3 || body.rotation_free[k];
    if (!free || !(body.moments[k] > kLeastMomentRatio * most)) body.moments[k] = 0.0;
  }
  body.rotor = *std::max_element(body.moments.begin(), body.moments.end()) > 0.0;
}

template <class Real>
int freedom_of(const AssembledBody<Real>& body, int dimension) {
  const BodySlot<Real>& slot = body.bound.slot;
  if (slot.mapped && !slot.rigid) return 0;
  int axes = 0;
  for (int d = 0; d < dimension; ++d) axes += body.held[d] ? 0 : 1;
  if (!slot.rigid) return axes * static_cast<int>(slot.count);
  if (body.rotor) {
    return axes + static_cast<int>(std::count_if(body.moments.begin(), body.moments.end(),
                                                 [](double moment) { return moment > 0.0; }));
  }
  const bool turns = dimension == 2 && body.inertia > 0.0 && !body.rotation_held;
  return axes + (turns ? 1 : 0);
}

}  // namespace

template <class Real>
std::array<double, 3> AssembledBody<Real>::reference_arm(std::size_t particle) const {
  const std::array<double, 3>& arm = arms[particle];
  if (!rotor) return arm;
  const Matrix3 axes = matrix_of(orientation);
  std::array<double, 3> along{};
  for (std::size_t k = 0; k < 3; ++k) {
    along[k] = axes[k] * arm[0] + axes[3 + k] * arm[1] + axes[6 + k] * arm[2];
  }
  return along;
}

/// First the sizes, since views point into arrays that must not move afterwards.
template <class Real>
AssembledBodies<Real>::AssembledBodies(const AssemblyPlan& plan) {
  const int dimension = plan.dimension();
  std::vector<Fault> faults;
  for (const SceneBody& from : plan.scene->bodies) {
    all.push_back(described<Real>(from, all.size(), plan));
    give_slot(all.back(), from, dimension);
    check(all.back(), from, plan, faults);
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  for (AssembledBody<Real>& body : all) {
    place(body, plan);
    if (dimension == 3 && body.bound.slot.rigid) find_principal_axes(body);
    if (body.bound.slot.rigid || body.prescribed()) keep_shape(body, dimension);
    body.bound.freedom = freedom_of(body, dimension);
  }
}

template <class Real>
void AssembledBodies<Real>::give_slot(AssembledBody<Real>& body, const SceneBody& from,
                                      int dimension) {
  const Coordinates coordinates = from.record->common(from.description.get()).coordinates;
  BodySlot<Real>& slot = body.bound.slot;
  slot.count = body.bound.start.size();
  slot.stride = stride_for(slot.count);
  slot.mapped = coordinates != Coordinates::particles;
  slot.rigid = coordinates == Coordinates::rigid;
  const std::size_t block = slot.stride * dimension;
  if (slot.mapped) {
    slot.offset = mapped_size;
    mapped_size += block + 2 * kGroup;
  } else {
    slot.offset = dofs;
    dofs += padded(block);
  }
  if (slot.rigid) {
    slot.centre = dofs;
    dofs += kGroup;
  }
}

/// The centre of mass, and the particles about it.
template <class Real>
void AssembledBodies<Real>::place(AssembledBody<Real>& body, const AssemblyPlan& plan) {
  const int dimension = plan.dimension();
  const std::size_t count = body.bound.slot.count;
  const BodyGeometry& geometry = (*plan.geometry)[body.bound.index];
  std::vector<double> share(count);
  for (std::size_t i = 0; i < count; ++i) share[i] = body.bound.mass[i] / body.total_mass;
  share_.emplace_back(padded(count), Real(0.0));
  for (std::size_t i = 0; i < count; ++i) {
    share_.back()[i] = Real(body.bound.mass[i]) / Real(body.total_mass);
  }
  body.bound.slot.share = share_.back().data();

  std::vector<double> middle(dimension);
  for (int d = 0; d < dimension; ++d) {
    InterleavedSum<double> mean;
    for (std::size_t i = 0; i < count; ++i) mean.add(i, share[i] * geometry.relative[i][d]);
    middle[d] = mean.total();
    body.bound.start_centre.push_back(relative_to(plan.origin, d, geometry.anchor[d]) + middle[d]);
  }
  InterleavedSum<double> inertia;
  body.arms.assign(count, {});
  for (std::size_t i = 0; i < count; ++i) {
    double square = 0.0;
    for (int d = 0; d < dimension; ++d) {
      body.arms[i][d] = geometry.relative[i][d] - middle[d];
      square = std::fma(body.arms[i][d], body.arms[i][d], square);
    }
    inertia.add(i, body.bound.mass[i] * square);
  }
  body.inertia = inertia.total();
}

template <class Real>
void AssembledBodies<Real>::keep_shape(AssembledBody<Real>& body, int dimension) {
  const BodySlot<Real>& slot = body.bound.slot;
  arms_.emplace_back(dimension * slot.stride, Real(0.0));
  reference.emplace_back(dimension * slot.stride, Real(0.0));
  for (std::size_t i = 0; i < slot.count; ++i) {
    const std::array<double, 3> arm = body.reference_arm(i);
    for (int d = 0; d < dimension; ++d) reference.back()[d * slot.stride + i] = Real(arm[d]);
  }
  RigidArguments<Real>& arguments = rigid.emplace_back();
  body.rigid = &arguments;
  arguments.body = slot;
  arguments.reference = reference.back().data();
  arguments.arm = arms_.back().data();
  rigid_body.push_back(body.bound.index);
  if (!body.rotor) return;
  std::array<Real, 18>& axes = axes_.emplace_back();
  arguments.axes = axes.data();
  arguments.turned = axes.data() + 9;
  const double most = *std::max_element(body.moments.begin(), body.moments.end());
  for (std::size_t k = 0; k < 3; ++k) {
    const double moment = body.moments[k];
    arguments.moments[k] = Real(moment);
    arguments.inverse_moments[k] = moment > 0.0 ? Real(1.0) / Real(moment) : Real(0.0);
    arguments.masses[k] = Real(moment > 0.0 ? moment : most);
  }
  orient(axes_.size() - 1, body.orientation);
}

template <class Real>
void AssembledBodies<Real>::orient(std::size_t rotor, const Quaternion& orientation) {
  const Matrix3 axes = matrix_of(orientation);
  for (std::size_t k = 0; k < axes.size(); ++k) axes_[rotor][k] = Real(axes[k]);
}

template struct AssembledBody<double>;
template struct AssembledBody<Quad>;
template class AssembledBodies<double>;
template class AssembledBodies<Quad>;

}  // namespace tomlin
