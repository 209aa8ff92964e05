#include "framework/scene/freedom_checks.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "framework/core/text/axis_names.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr const char* kRotation = "rotation";

class FreedomCheck {
 public:
  FreedomCheck(BodyDraft& body, std::optional<int> dimension, FaultList& faults)
      : body_(body), dimension_(dimension), faults_(faults) {
    const auto found = body.reading.values.find("coordinates");
    if (found == body.reading.values.end()) return;
    coordinates_ = value_named<Coordinates>(std::get<std::string>(found->second));
  }

  void run() {
    if (!coordinates_) return;  // unfit, and reported
    check_whether_held();
    for (const std::string& name : body_.hold) check_held(name);
    check_axes_of_rotation();
    check_whether_in_motion();
    if (body_.motion && dimension_) check_motion(*body_.motion);
  }

 private:
  bool is_given(const char* key) const { return body_.reading.given->find(key) != nullptr; }

  void complain(const std::string& key, std::string why, std::string admissible = "") {
    const Entry* entry = body_.reading.given->find_entry(key);
    const Extent& where = entry ? entry->where : body_.reading.where;
    faults_.of_key(where, {FaultCode::body_invalid_coordinates, body_.reading.path + "." + key,
                           std::move(why), std::move(admissible)});
    body_.valid = false;
  }

  void check_whether_held() {
    if (follows_forces(*coordinates_) || body_.hold.empty()) return;
    complain("hold",
             fmt::format("a {} body has no free coordinates to hold", to_string(*coordinates_)),
             "coordinates = \"particles\" or \"rigid\"");
    body_.hold.clear();  // more about it is no news
  }

  void check_held(const std::string& name) {
    if (name == kRotation) {
      if (coordinates_ == Coordinates::rigid) return;
      complain("hold", "only a rigid body has a rotation", "coordinates = \"rigid\"");
      return;
    }
    if (name.starts_with(kRotation)) {
      if (coordinates_ == Coordinates::rigid && dimension_.value_or(3) == 3) return;
      complain("hold", quoted_text(name) + " is of a rigid body in space", "\"rotation\"");
      return;
    }
    const auto* axis = std::find(std::begin(kAxisNames), std::end(kAxisNames), name);
    const auto index = static_cast<std::size_t>(axis - std::begin(kAxisNames));
    if (dimension_ && index >= static_cast<std::size_t>(*dimension_)) {
      complain("hold", fmt::format("{} is not an axis of a scene with {} dimension{}",
                                   quoted_text(name), *dimension_, *dimension_ == 1 ? "" : "s"));
    } else if (starts_along(index)) {
      complain("velocity", fmt::format("a held coordinate does not move: {} is held", name),
               fmt::format("0 along {}", name));
    }
  }

  /// No equations of motion exist here for a body that rotates about two axes fixed in space.
  void check_axes_of_rotation() {
    const auto held = std::count_if(body_.hold.begin(), body_.hold.end(), [](const auto& name) {
      return name.starts_with(kRotation) && name != kRotation;
    });
    if (held != 1 || coordinates_ != Coordinates::rigid) return;
    complain("hold", "a rigid body rotates about one axis of space, freely, or not at all",
             "two of \"rotation_x\", \"rotation_y\", \"rotation_z\", or \"rotation\"");
  }

  bool is_warm() const {
    const auto found = body_.reading.values.find("start_temperature");
    return found != body_.reading.values.end() && std::get<double>(found->second) > 0.0;
  }

  bool starts_along(std::size_t axis) const {
    const auto found = body_.reading.values.find("velocity");
    if (found == body_.reading.values.end()) return false;
    const auto& vectors = std::get<PerParticleVector>(found->second).values;
    return std::any_of(vectors.begin(), vectors.end(), [axis](const SpaceVector& velocity) {
      return axis < velocity.components.size() && velocity.components[axis] != 0.0;
    });
  }

  void check_whether_in_motion() {
    const bool prescribed = coordinates_ == Coordinates::prescribed;
    if (prescribed && !is_given("motion")) {
      complain("motion", "missing: a prescribed body needs a motion",
               "{ velocity = [..], angular_velocity = .. }");
    }
    if (!prescribed && is_given("motion")) {
      complain("motion", "only a prescribed body has a motion", "coordinates = \"prescribed\"");
    }
    if (!follows_forces(*coordinates_) && is_warm()) {
      complain("start_temperature",
               fmt::format("a {} body does not move by forces", to_string(*coordinates_)),
               "coordinates = \"particles\" or \"rigid\"");
    }
    if (prescribed && is_given("velocity")) {
      complain("velocity", "a prescribed body has the velocity of its motion",
               "motion = { velocity = [..] }");
    }
  }

  void check_motion(Motion& motion) {
    const Table& given = *body_.reading.given->find("motion")->as<Table>();
    const auto dimension = static_cast<std::size_t>(*dimension_);
    if (motion.velocity.empty()) motion.velocity.resize(dimension);
    const std::size_t length = motion.velocity.size();
    if (length != dimension) {
      refuse(FaultCode::scene_wrong_count, given, "velocity",
             fmt::format(
                 "mixed dimensions: {} component{}, but the first body sets the dimension to {}",
                 length, length == 1 ? "" : "s", dimension));
    }
    if (dimension != 2 && given.find("angular_velocity") != nullptr) {
      refuse(FaultCode::body_invalid_coordinates, given, "angular_velocity",
             "only a body in two dimensions has a scalar angular velocity");
    }
  }

  void refuse(FaultCode code, const Table& motion, const std::string& key, std::string why) {
    faults_.of_value(*motion.find(key),
                     {code, body_.reading.path + ".motion." + key, std::move(why)});
    body_.valid = false;
  }

  BodyDraft& body_;
  std::optional<int> dimension_;
  FaultList& faults_;
  std::optional<Coordinates> coordinates_;  ///< nothing where they are unfit
};

}  // namespace

void check_freedom(std::vector<BodyDraft>& bodies, std::optional<int> dimension,
                   FaultList& faults) {
  for (BodyDraft& body : bodies) {
    if (body.record != nullptr) FreedomCheck(body, dimension, faults).run();
  }
}

}  // namespace tomlin
