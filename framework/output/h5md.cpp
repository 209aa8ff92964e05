#include "framework/output/h5md.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <string_view>
#include <type_traits>

namespace tomlin {
namespace {

/// Readers' caches hold this by default; it is so large that few pieces make up a long run.
constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

constexpr const char* kUnknownAuthor = "unknown";

template <class Number>
hid_t memory_type() {
  return std::is_same_v<Number, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
}

template <class Number>
hid_t file_type() {
  return std::is_same_v<Number, double> ? H5T_IEEE_F64LE : H5T_STD_I64LE;
}

/// Makes the parts of a file other than series, by calls of the library.
class Builder {
 public:
  explicit Builder(const Hdf5File& file) : file_(file) {}

  Hdf5Handle group(hid_t above, const char* name) const {
    const Hdf5Handle properties = file_.hold(H5Pcreate(H5P_GROUP_CREATE));
    file_.check(H5Pset_obj_track_times(properties, false));
    return file_.hold(H5Gcreate2(above, name, H5P_DEFAULT, properties, H5P_DEFAULT));
  }

  /// Writes a text of fixed length, padded with zeros.
  void text(hid_t object, const char* name, std::string_view value) const {
    const Hdf5Handle type = text_type(value.size());
    const std::string padded(value.empty() ? std::string(1, '\0') : std::string(value));
    attribute(object, name, scalar(), type, type, padded.data());
  }

  void texts(hid_t object, const char* name, const std::vector<std::string>& values) const {
    std::size_t length = 0;
    const std::string block = packed(values, length);
    const Hdf5Handle type = text_type(length);
    attribute(object, name, simple({values.size()}), type, type, block.data());
  }

  /// Writes a text as the module "units" wants it.
  void text_of_any_length(hid_t object, const char* name, const std::string& value) const {
    const Hdf5Handle type = file_.hold(H5Tcopy(H5T_C_S1));
    file_.check(H5Tset_size(type, H5T_VARIABLE));
    const char* const text = value.c_str();
    attribute(object, name, scalar(), type, type, &text);
  }

  void integers(hid_t object, const char* name, const std::vector<std::int64_t>& values) const {
    attribute(object, name, simple({values.size()}), H5T_STD_I32LE, H5T_NATIVE_INT64,
              values.data());
  }

  void integer(hid_t object, const char* name, std::int64_t value) const {
    attribute(object, name, scalar(), H5T_STD_I32LE, H5T_NATIVE_INT64, &value);
  }

  Hdf5Handle dataset(hid_t above, const char* name, const Hdf5Handle& space, hid_t type,
                     hid_t memory, const void* values) const {
    const Hdf5Handle properties = file_.hold(H5Pcreate(H5P_DATASET_CREATE));
    file_.check(H5Pset_obj_track_times(properties, false));
    Hdf5Handle made =
        file_.hold(H5Dcreate2(above, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT));
    file_.check(H5Dwrite(made, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
    return made;
  }

  template <class Number>
  Hdf5Handle list(hid_t above, const char* name, const std::vector<Number>& values) const {
    return dataset(above, name, simple({values.size()}), file_type<Number>(), memory_type<Number>(),
                   values.data());
  }

  void text_dataset(hid_t above, const char* name, const std::string& value) const {
    const Hdf5Handle type = text_type(value.size());
    dataset(above, name, scalar(), type, type, value.c_str());
  }

  void texts_dataset(hid_t above, const char* name, const std::vector<std::string>& values) const {
    std::size_t length = 0;
    const std::string block = packed(values, length);
    const Hdf5Handle type = text_type(length);
    dataset(above, name, simple({values.size()}), type, type, block.data());
  }

 private:
  Hdf5Handle scalar() const { return file_.hold(H5Screate(H5S_SCALAR)); }

  Hdf5Handle simple(const std::vector<hsize_t>& extent) const {
    return file_.hold(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr));
  }

  /// There are no strings of length 0.
  Hdf5Handle text_type(std::size_t length) const {
    Hdf5Handle type = file_.hold(H5Tcopy(H5T_C_S1));
    file_.check(H5Tset_size(type, std::max<std::size_t>(1, length)));
    file_.check(H5Tset_strpad(type, H5T_STR_NULLPAD));
    file_.check(H5Tset_cset(type, H5T_CSET_UTF8));
    return type;
  }

  static std::string packed(const std::vector<std::string>& values, std::size_t& length) {
    length = 1;
    for (const std::string& value : values) length = std::max(length, value.size());
    std::string block;
    for (std::string value : values) {
      value.resize(length, '\0');
      block += value;
    }
    return block;
  }

  void attribute(hid_t object, const char* name, const Hdf5Handle& space, hid_t type, hid_t memory,
                 const void* value) const {
    const Hdf5Handle made =
        file_.hold(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
    file_.check(H5Awrite(made, memory, value));
  }

  const Hdf5File& file_;
};

/// The names of the species, and one for particles that have none.
std::vector<std::string> names_of_species(const RunLayout& layout) {
  std::vector<std::string> names = layout.species;
  if (std::find(names.begin(), names.end(), kNoSpecies) == names.end()) {
    names.emplace_back(kNoSpecies);
  }
  return names;
}

/// Describes a dataset's numbers: their dimension and, where it has a symbol, their unit.
void describe_numbers(const Builder& build, hid_t dataset, const NumbersOfDataset& numbers) {
  if (numbers.dimension == dimension::none) return;
  build.text(dataset, "dimension", to_string(numbers.dimension));
  if (numbers.units == UnitSystem::reduced) return;
  const std::string symbol = unit_symbol(numbers.units, numbers.dimension);
  build.text_of_any_length(dataset, "unit", symbol == "A" ? "Angstrom" : symbol);
}

}  // namespace

// ---- series

template <class Number>
Hdf5Series<Number>::Hdf5Series(const Hdf5File& file, std::string name, std::vector<hsize_t> shape,
                               const NumbersOfDataset& numbers)
    : file_(file),
      name_(std::move(name)),
      shape_(std::move(shape)),
      numbers_(numbers),
      per_frame_(std::accumulate(shape_.begin(), shape_.end(), std::size_t{1},
                                 std::multiplies<std::size_t>())),
      most_frames_(std::max<std::size_t>(1, kChunkBytes / (sizeof(Number) * per_frame_))) {}

template <class Number>
std::span<Number> Hdf5Series<Number>::next(hid_t group) {
  if (held_.size() == most_frames_ * per_frame_) flush(group);
  held_.resize(held_.size() + per_frame_);
  return std::span(held_).last(per_frame_);
}

template <class Number>
void Hdf5Series<Number>::make_dataset(hid_t group) {
  std::vector<hsize_t> extent = {0};
  std::vector<hsize_t> limit = {H5S_UNLIMITED};
  std::vector<hsize_t> chunk = {std::max<hsize_t>(1, held_.size() / per_frame_)};
  for (const hsize_t length : shape_) {
    extent.push_back(length);
    limit.push_back(length);
    chunk.push_back(length);
  }
  // A frame that is larger than a chunk should be is cut between particles, evenly.
  const std::size_t pieces = (sizeof(Number) * per_frame_ + kChunkBytes - 1) / kChunkBytes;
  if (pieces > 1) chunk[1] = (shape_.front() + pieces - 1) / pieces;
  const Hdf5Handle space =
      file_.hold(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), limit.data()));
  const Hdf5Handle properties = file_.hold(H5Pcreate(H5P_DATASET_CREATE));
  file_.check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()));
  file_.check(H5Pset_obj_track_times(properties, false));
  dataset_ = file_.hold(H5Dcreate2(group, name_.c_str(), file_type<Number>(), space, H5P_DEFAULT,
                                   properties, H5P_DEFAULT));
  describe_numbers(Builder(file_), dataset_, numbers_);
}

template <class Number>
void Hdf5Series<Number>::flush(hid_t group) {
  const Hdf5Silence silence;
  if (dataset_ < 0) make_dataset(group);
  std::vector<hsize_t> start(1 + shape_.size(), 0);
  std::vector<hsize_t> count = {held_.size() / per_frame_};
  count.insert(count.end(), shape_.begin(), shape_.end());
  start[0] = written_;
  written_ += count[0];
  std::vector<hsize_t> extent = count;
  extent[0] = written_;
  file_.check(H5Dset_extent(dataset_, extent.data()));
  const Hdf5Handle there = file_.hold(H5Dget_space(dataset_));
  file_.check(
      H5Sselect_hyperslab(there, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
  const Hdf5Handle here =
      file_.hold(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr));
  file_.check(H5Dwrite(dataset_, memory_type<Number>(), here, there, H5P_DEFAULT, held_.data()));
  held_.clear();
}

template <class Number>
void Hdf5Series<Number>::finish(hid_t group) {
  flush(group);
  dataset_.close();
}

template class Hdf5Series<double>;
template class Hdf5Series<std::int64_t>;

// ---- the trajectory

double h5md_bytes_per_frame(const RunLayout& layout) {
  const std::size_t edges = TrajectoryBox(layout).any() ? kTrajectoryAxes : 0;
  const std::size_t positions = layout.particles() * kTrajectoryAxes;
  return static_cast<double>((positions + edges + 1) * sizeof(double) + sizeof(std::int64_t));
}

double h5md_bytes_besides(const RunLayout& layout, const TrajectoryFacts& facts) {
  // Groups, attributes and indices of chunks; each of the four series may end in a chunk that is
  // all but empty.
  constexpr double kStructure = 65536.0;
  constexpr double kSeries = 4.0;
  double bytes = kStructure + static_cast<double>(facts.scene.size() + facts.source.size());
  // Mass, number and species of each particle, and its body where that is no species.
  const std::size_t numbers = layout.species.empty() ? 3 : 4;
  for (const TrajectoryBody& body : layout.bodies) {
    bytes += static_cast<double>(body.mass.size() * numbers * sizeof(double) + body.name.size());
  }
  // Names take as much as the longest.
  std::size_t longest = 1;
  for (const std::string& name : layout.species) longest = std::max(longest, name.size());
  bytes += static_cast<double>((layout.species.size() + 1) * longest);
  const double full = layout.most_samples * h5md_bytes_per_frame(layout);
  return bytes + std::min(full, kSeries * static_cast<double>(kChunkBytes));
}

H5mdWriter::H5mdWriter(const std::filesystem::path& file, const RunLayout& layout,
                       const TrajectoryFacts& facts)
    : TrajectoryWriter(file, layout),
      hdf5_(file),
      box_(layout),
      positions_(hdf5_, "value", {layout.particles(), kTrajectoryAxes},
                 {dimension::length, facts.units}),
      times_(hdf5_, "time", {}, {dimension::time, facts.units}),
      steps_(hdf5_, "step", {}, {dimension::none, facts.units}),
      lengths_(hdf5_, "value", {kTrajectoryAxes}, {dimension::length, facts.units}) {
  const Hdf5Silence silence;
  const Builder build(hdf5_);
  describe_file(facts);
  describe_scene(facts);
  const Hdf5Handle particles = build.group(hdf5_.root(), "particles");
  const Hdf5Handle all = build.group(particles, "all");
  list_particles(all, facts.units);
  position_ = build.group(all, "position");
  describe_box(all);
}

H5mdWriter::~H5mdWriter() = default;

void H5mdWriter::describe_file(const TrajectoryFacts& facts) {
  const Builder build(hdf5_);
  const Hdf5Handle h5md = build.group(hdf5_.root(), "h5md");
  build.integers(h5md, "version", {1, 1});
  build.text(build.group(h5md, "author"), "name", kUnknownAuthor);
  const Hdf5Handle creator = build.group(h5md, "creator");
  build.text(creator, "name", "tomlin");
  build.text(creator, "version", facts.version);
  const Hdf5Handle modules = build.group(h5md, "modules");
  const Hdf5Handle units = build.group(modules, "units");
  build.integers(units, "version", {1, 0});
  build.text_of_any_length(units, "system", to_string(facts.units));
}

void H5mdWriter::describe_scene(const TrajectoryFacts& facts) {
  const Builder build(hdf5_);
  const Hdf5Handle parameters = build.group(hdf5_.root(), "parameters");
  build.text(parameters, "name", facts.name);
  build.text(parameters, "source", facts.source);
  build.text_dataset(parameters, "scene", facts.scene);
  std::vector<std::string> bodies;
  for (const TrajectoryBody& body : layout_.bodies) bodies.push_back(body.name);
  build.texts_dataset(parameters, "bodies", bodies);
  if (!layout_.species.empty()) {
    build.texts_dataset(parameters, "species", names_of_species(layout_));
  }
}

void H5mdWriter::list_particles(hid_t all, UnitSystem units) {
  const std::vector<std::string> names = names_of_species(layout_);
  const auto none = std::find(names.begin(), names.end(), kNoSpecies) - names.begin();
  std::vector<double> mass;
  std::vector<std::int64_t> species;
  std::vector<std::int64_t> body_of;
  for (std::size_t b = 0; b < layout_.bodies.size(); ++b) {
    const TrajectoryBody& body = layout_.bodies[b];
    mass.insert(mass.end(), body.mass.begin(), body.mass.end());
    species.insert(species.end(), body.species.begin(), body.species.end());
    body_of.insert(body_of.end(), body.mass.size(), static_cast<std::int64_t>(b));
    species.resize(mass.size(), none);
  }
  std::vector<std::int64_t> id(mass.size());
  std::iota(id.begin(), id.end(), 0);
  const Builder build(hdf5_);
  describe_numbers(build, build.list(all, "mass", mass), {dimension::mass, units});
  build.list(all, "species", layout_.species.empty() ? body_of : species);
  if (!layout_.species.empty()) build.list(all, "body", body_of);
  build.list(all, "id", id);
}

void H5mdWriter::describe_box(hid_t all) {
  const Builder build(hdf5_);
  const Hdf5Handle box = build.group(all, "box");
  build.integer(box, "dimension", kTrajectoryAxes);
  std::vector<std::string> boundary;
  for (const bool periodic : box_.periodic) boundary.emplace_back(periodic ? "periodic" : "none");
  build.texts(box, "boundary", boundary);
  if (box_.any()) edges_ = build.group(box, "edges");
}

void H5mdWriter::write(double time, std::span<const double> positions) {
  const auto axes = static_cast<std::size_t>(layout_.dimension);
  const std::span<double> row = positions_.next(position_);
  for (std::size_t i = 0; i < layout_.particles(); ++i) {
    for (std::size_t d = 0; d < axes; ++d) {
      row[i * kTrajectoryAxes + d] = positions[i * axes + d];
    }
  }
  times_.next(position_).front() = time;
  steps_.next(position_).front() = static_cast<std::int64_t>(frames());
  if (box_.any()) std::ranges::copy(box_.length, lengths_.next(edges_).begin());
}

void H5mdWriter::finish() {
  positions_.finish(position_);
  times_.finish(position_);
  steps_.finish(position_);
  if (box_.any()) {
    lengths_.finish(edges_);
    const Hdf5Silence silence;
    for (const char* name : {"step", "time"}) {
      hdf5_.check(H5Lcreate_hard(position_, name, edges_, name, H5P_DEFAULT, H5P_DEFAULT));
    }
  }
  position_.close();
  edges_.close();
  hdf5_.publish();
}

}  // namespace tomlin
