#pragma once

#include <cstdint>
#include <vector>

#include "framework/core/records/body.hpp"

/// Common parts of bodies made of whole cells of a lattice in space.
namespace tomlin {

/// How many cells of this length fit into a length, however either was rounded; none of a negative
/// one, and beyond 1e15 no more.
std::int64_t whole_cells(double length, double cell);

/// Whether a periodic box of this length repeats a body of that length, but for rounding.
bool fills_box(double length, double box);

/// Their product, or where that is beyond 1e18 this number.
std::int64_t particles_in(std::int64_t per_cell, std::int64_t one, std::int64_t other);

/// Returns these pairs, each once and of two different particles, in ascending order.
std::vector<IndexPair> each_pair_once(std::vector<IndexPair> pairs);

/// Complaints about the dimension of the scene, for a body in space whose `centre` may be left out;
/// `body` is "a nanotube", say.
std::vector<Complaint> complaints_without_space(const char* body, const SpaceVector& centre,
                                                int dimension);

/// Complaints about two keys of which one has to be given.
std::vector<Complaint> complaints_unless_one(const char* one, bool has_one, const char* other,
                                             bool has_other);

/// The origin where it is left out.
std::vector<double> centre_or_origin(const SpaceVector& centre);

}  // namespace tomlin
