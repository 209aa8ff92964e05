#pragma once

#include <cstddef>
#include <vector>

/// Coordinates that meet in a force, and an order that keeps those that do close together.
namespace tomlin {

/// A graph over particles (or rigid bodies), edges between those that share an element.
class CouplingGraph {
 public:
  explicit CouplingGraph(std::size_t nodes) : neighbours_(nodes) {}
  std::size_t size() const { return neighbours_.size(); }
  void join(std::size_t one, std::size_t other);
  /// Each neighbour once, in ascending order. To be called before what follows.
  void settle();

  /// The nodes in an order that keeps neighbours near each other.
  /// Source: E. Cuthill and J. McKee, Proc. 24th ACM Nat. Conf. (1969) 157,
  /// doi:10.1145/800195.805928, reversed.
  std::vector<std::size_t> narrow_order() const;

  /// Groups of nodes no two of which are neighbours or share one: their columns of a Jacobian can
  /// be had from one difference. The group of each node, first come first served.
  /// Source: A. R. Curtis, M. J. D. Powell and J. K. Reid, IMA J. Appl. Math. 13 (1974) 117,
  /// doi:10.1093/imamat/13.1.117.
  std::vector<std::size_t> groups() const;

  const std::vector<std::size_t>& neighbours(std::size_t node) const { return neighbours_[node]; }

 private:
  std::size_t far_end(std::size_t start) const;
  /// Nodes that can be reached from this one, nearest first, among equals those with few
  /// neighbours.
  std::vector<std::size_t> by_distance(std::size_t start) const;

  std::vector<std::vector<std::size_t>> neighbours_;
};

}  // namespace tomlin
