#include "framework/plugin/kim/kim_model.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/elements/neighbour_list.hpp"
#include "framework/plugin/kim/kim_force.hpp"

namespace tomlin {
namespace {

constexpr const char* kKey = "model";

Complaint complaint_of_model(std::string why, std::string admissible,
                             FaultCode code = FaultCode::component_unsuitable) {
  return {.key = kKey, .why = std::move(why), .admissible = std::move(admissible), .code = code};
}

std::vector<Complaint> prepare_model(KimModelDescription& d, const std::filesystem::path& folder) {
  (void)folder;
  d.facts = std::make_shared<kim::ModelFacts>(kim::examine_model(d.model));
  if (d.facts->why.empty()) return {};
  Complaint complaint = complaint_of_model(d.facts->why, d.facts->admissible, d.facts->code);
  complaint.nearest = d.facts->nearest;
  return {complaint};
}

/// Returns the facts also of a description that has not been prepared.
kim::ModelFacts facts_of(const KimModelDescription& d) {
  return d.facts ? *d.facts : kim::examine_model(d.model);
}

std::string words(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

std::vector<Complaint> complaints_of_scene(const KimModelDescription& d,
                                           const SceneOutline& scene) {
  const kim::ModelFacts facts = facts_of(d);
  if (!facts.why.empty()) return {complaint_of_model(facts.why, facts.admissible, facts.code)};
  std::vector<Complaint> found;
  if (scene.dimension != 3) {
    found.push_back(complaint_of_model("models are of three dimensions, and the scene is not",
                                       "a scene in three dimensions"));
  }
  if (scene.units != UnitSystem::metal) {
    found.push_back(complaint_of_model(
        "the model is in eV and Angstrom, and the scene's units are reduced ones",
        "units = \"metal\" in [scene]"));
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneOutline::Body& body = scene.bodies[b];
    const auto complain_of_species = [&](std::string why) {
      found.push_back(complaint_of_model(std::move(why), words(facts.species)));
      found.back().key = "species";
      found.back().body = b;
    };
    if (body.species.empty()) {
      complain_of_species(fmt::format("the particles of \"{}\" have no species", body.name));
    }
    for (const std::string& species : body.species) {
      if (std::find(facts.species.begin(), facts.species.end(), species) != facts.species.end()) {
        continue;
      }
      complain_of_species(fmt::format("the model has no numbers for {}, which \"{}\" is made of",
                                      species, body.name));
    }
  }
  const double reach = facts.reach();
  for (Complaint& complaint : cutoff_complaints(kKey, reach, scene)) {
    complaint.admissible = fmt::format("a box of at least {:.6g}: the model reaches {:.6g}",
                                       2.0 * single_list(reach).reach, reach);
    found.push_back(std::move(complaint));
  }
  return found;
}

/// Over which bonds change, of any element, in Angstrom: models do not say.
double bond_length_scale(const KimModelDescription& d) {
  (void)d;
  return 0.3;
}

std::string note_on_model(const KimModelDescription& d) {
  const kim::ModelFacts facts = facts_of(d);
  if (!facts.why.empty()) return {};
  std::string lists;
  for (const double cutoff : facts.cutoffs) {
    lists += fmt::format("{}{:.6g}", lists.empty() ? "" : ", ", cutoff);
  }
  std::string text = fmt::format("{} for {}; influence {:.6g} A, neighbour lists up to {} A",
                                 d.model, words(facts.species), facts.influence_distance, lists);
  if (!facts.id.empty()) text += "; KIM-ID " + facts.id;
  if (!facts.citation.empty()) text += "; " + facts.citation;
  return text;
}

}  // namespace

ForceRecord kim_model_record() {
  using Description = KimModelDescription;
  ForceRecord record = record_of<Description>();
  record.name = "kim_model";
  record.summary = "an interatomic potential by its name in the KIM API, among the atoms of bodies";
  record.equation = "V = sum_i V_i, the energy of each atom as the model gives it";
  record.source =
      "E. B. Tadmor, R. S. Elliott, J. P. Sethna, R. E. Miller and C. A. Becker, JOM 63, 17 "
      "(2011), "
      "doi:10.1007/s11837-011-0102-6; the model's own source: `tomlin explain`";
  record.element = Element::surroundings;
  record.traits = {.conservative = true, .internal = true};
  record.most_bodies = 1000;
  record.prepare = of_description<&prepare_model>;
  record.complaints = of_description<&complaints_of_scene>;
  record.length = of_description<&bond_length_scale>;
  record.note = of_description<&note_on_model>;
  record.bind = {of_description<&kim::bind_model>};
  record.parameters = {parameter("model", &Description::model, dimension::none,
                                 "a portable model that is installed, by its whole name; "
                                 "`kim-api-collections-management list` shows all")};
  record.example = R"(# Four atoms of silicon, released.
[scene]
units = "metal"

[[body]]
type = "particles"
positions = [[0.0, 0.0, 0.0], [2.4, 0.0, 0.0], [0.0, 2.4, 0.0], [0.0, 0.0, 2.4]]
species = "Si"
particle_mass = 28.0855

[[force]]
type = "kim_model"
model = "SW_StillingerWeber_1985_Si__MO_405512056662_005"

[run]
duration = 0.1
integrator = { type = "velocity_verlet", dt = 1e-3 }
)";
  return record;
}

}  // namespace tomlin
