// sweep.h5. The conventions of netCDF-4 in an HDF5 file: a dimension is a dimension scale with its
// number in _Netcdf4Dimid, to which each variable is attached. See "File Format Specifications" of
// the netCDF manual.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include "framework/output/checkpoint.hpp"
#include "framework/output/hdf5_file.hpp"
#include "framework/study/sweep/files.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kElementsAtOnce = 4096;

/// Returns the type of UTF-8 strings of variable length.
Hdf5Handle string_type(const Hdf5File& file) {
  Hdf5Handle type = file.hold(H5Tcopy(H5T_C_S1));
  file.check(H5Tset_size(type, H5T_VARIABLE));
  file.check(H5Tset_cset(type, H5T_CSET_UTF8));
  return type;
}

/// The file of a sweep while it is written.
class SweepArrays {
 public:
  SweepArrays(const std::filesystem::path& file, const SweepPlan& plan)
      : plan_(plan),
        order_(plan),
        file_(file, Hdf5File::Order::as_made),
        strings_(string_type(file_)) {
    text_attribute(file_.root(), "Conventions", "CF-1.8");
    text_attribute(file_.root(), "title", plan.scene().name);
    text_attribute(file_.root(), "source", "tomlin " + release_of(plan.program_version()));
    if (plan.refinement()) {
      shape_.push_back(order_.size());
      add_scale("point", H5T_STD_I64LE);
      write_numbers(scales_.front());
      for (std::size_t axis = 0; axis < plan.axes().size(); ++axis) add_axis_of_points(axis);
      return;
    }
    for (const SweepDimension& dimension : plan.dimensions()) shape_.push_back(dimension.count);
    for (std::size_t d = 0; d < plan.dimensions().size(); ++d) add_dimension(d);
    for (std::size_t d = 0; d < plan.dimensions().size(); ++d) {
      if (plan.dimensions()[d].axes.size() == 1) continue;
      for (const std::size_t axis : plan.dimensions()[d].axes) add_zipped_axis(d, axis);
    }
  }

  void write(const SweepJournal& journal) {
    std::vector<Hdf5Handle> columns;
    for (const SweepColumn& column : plan_.columns()) columns.push_back(column_variable(column));
    const Hdf5Handle status = variable("status", H5T_STD_I8LE, all_dimensions());
    text_attribute(status, "long_name", "how the run of a point ended");
    std::vector<std::int8_t> flags(kSweepStatuses);
    std::iota(flags.begin(), flags.end(), std::int8_t{0});
    attribute(status, "flag_values", flags.size(), H5T_STD_I8LE, H5T_NATIVE_INT8, flags.data());
    text_attribute(status, "flag_meanings", "finished failed refused");
    const Hdf5Handle reason = variable("reason", strings_, all_dimensions());
    text_attribute(reason, "long_name", "why a run has not finished");

    for_each_block([&](std::size_t first, const Hdf5Handle& selection, std::size_t count) {
      std::vector<SweepRow> rows(count);
      order_.read(journal, first, rows);
      const Hdf5Handle memory = simple({count});
      std::vector<double> numbers(count);
      for (std::size_t k = 0; k < columns.size(); ++k) {
        std::transform(rows.begin(), rows.end(), numbers.begin(),
                       [k](const SweepRow& row) { return row.numbers[k]; });
        write_block(columns[k], H5T_NATIVE_DOUBLE, memory, selection, numbers.data());
      }
      std::vector<std::int8_t> statuses(count);
      std::vector<const char*> reasons(count);
      for (std::size_t k = 0; k < count; ++k) {
        statuses[k] = static_cast<std::int8_t>(rows[k].status);
        reasons[k] = rows[k].reason.c_str();
      }
      write_block(status, H5T_NATIVE_INT8, memory, selection, statuses.data());
      write_block(reason, strings_, memory, selection, reasons.data());
    });
    scales_.clear();
    for (Hdf5Handle& column : columns) column.close();
  }

  void publish() {
    strings_.close();
    file_.publish();
  }

 private:
  Hdf5Handle simple(const std::vector<hsize_t>& extent) const {
    return file_.hold(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr));
  }

  void attribute(hid_t object, const char* name, std::size_t count, hid_t type, hid_t memory,
                 const void* values) const {
    const Hdf5Handle space = simple({count});
    const Hdf5Handle made =
        file_.hold(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
    file_.check(H5Awrite(made, memory, values));
  }

  void text_attribute(hid_t object, const char* name, const std::string& text) const {
    if (text.empty()) return;
    const Hdf5Handle space = file_.hold(H5Screate(H5S_SCALAR));
    const Hdf5Handle type = file_.hold(H5Tcopy(H5T_C_S1));
    file_.check(H5Tset_size(type, text.size()));
    file_.check(H5Tset_strpad(type, H5T_STR_NULLPAD));
    file_.check(H5Tset_cset(type, H5T_CSET_UTF8));
    const Hdf5Handle made =
        file_.hold(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
    file_.check(H5Awrite(made, type, text.data()));
  }

  /// A dataset of this shape, without times.
  Hdf5Handle dataset(const std::string& name, hid_t type, const Hdf5Handle& space) const {
    const Hdf5Handle properties = file_.hold(H5Pcreate(H5P_DATASET_CREATE));
    file_.check(H5Pset_obj_track_times(properties, false));
    file_.check(
        H5Pset_attr_creation_order(properties, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
    // All of it is written.
    if (H5Tis_variable_str(type) <= 0) {
      file_.check(H5Pset_fill_time(properties, H5D_FILL_TIME_NEVER));
    }
    return file_.hold(
        H5Dcreate2(file_.root(), name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT));
  }

  std::vector<std::size_t> all_dimensions() const {
    std::vector<std::size_t> all(shape_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }

  Hdf5Handle variable(const std::string& name, hid_t type,
                      const std::vector<std::size_t>& dimensions) const {
    std::vector<hsize_t> extent;
    extent.reserve(dimensions.size());
    for (const std::size_t d : dimensions) extent.push_back(shape_[d]);
    Hdf5Handle made = dataset(name, type, simple(extent));
    for (std::size_t k = 0; k < dimensions.size(); ++k) {
      file_.check(H5DSattach_scale(made, scales_[dimensions[k]], static_cast<unsigned>(k)));
    }
    return made;
  }

  Hdf5Handle column_variable(const SweepColumn& column) const {
    const SweepObservable& observable = plan_.observables()[column.observable];
    Hdf5Handle made = variable(column.name, H5T_IEEE_F64LE, all_dimensions());
    std::string meaning = observable.meaning;
    if (column.kind == SweepColumn::Kind::error) meaning = "estimated error: " + meaning;
    if (column.kind == SweepColumn::Kind::spread) {
      meaning = "largest less smallest value from perturbed starts: " + meaning;
    }
    text_attribute(made, "long_name", meaning);
    text_attribute(made, "units", observable.unit);
    return made;
  }

  /// The values of an axis at `count` points.
  void write_values(const Hdf5Handle& into, std::size_t axis, std::size_t count,
                    const std::function<std::size_t(std::size_t)>& point_of) const {
    const SweepValues& values = plan_.axes()[axis].values;
    const Hdf5Handle space = file_.hold(H5Dget_space(into));
    for (std::size_t first = 0; first < count; first += kElementsAtOnce) {
      const std::size_t now = std::min(kElementsAtOnce, count - first);
      const hsize_t from[] = {first};
      const hsize_t length[] = {now};
      file_.check(H5Sselect_hyperslab(space, H5S_SELECT_SET, from, nullptr, length, nullptr));
      const Hdf5Handle memory = simple({now});
      if (values.numeric()) {
        std::vector<double> numbers;
        numbers.reserve(now);
        for (std::size_t k = 0; k < now; ++k) {
          numbers.push_back(plan_.number(axis, point_of(first + k)));
        }
        write_block(into, H5T_NATIVE_DOUBLE, memory, space, numbers.data());
      } else {
        std::vector<std::string> texts;
        texts.reserve(now);
        for (std::size_t k = 0; k < now; ++k) {
          texts.push_back(values.plain_text(plan_.index(axis, point_of(first + k))));
        }
        std::vector<const char*> pointers;
        pointers.reserve(now);
        for (const std::string& text : texts) pointers.push_back(text.c_str());
        write_block(into, strings_, memory, space, pointers.data());
      }
    }
  }

  /// Writes the values of an axis, one for each index of its dimension.
  void write_values(const Hdf5Handle& into, std::size_t axis) const {
    write_values(into, axis, plan_.axes()[axis].values.size(),
                 [this, axis](std::size_t k) { return k * plan_.stride(axis); });
  }

  void write_block(const Hdf5Handle& into, hid_t type, const Hdf5Handle& memory,
                   const Hdf5Handle& selection, const void* values) const {
    file_.check(H5Dwrite(into, type, memory, selection, H5P_DEFAULT, values));
  }

  hid_t type_of(const SweepValues& values) const {
    return values.numeric() ? hid_t{H5T_IEEE_F64LE} : hid_t{strings_};
  }

  /// Its scale: the values of its axis, or numbers of points where axes are zipped.
  void add_dimension(std::size_t d) {
    const SweepDimension& dimension = plan_.dimensions()[d];
    const bool zipped = dimension.axes.size() > 1;
    std::string name;
    if (zipped) {
      ++zipped_;
      name = zipped_ == 1 ? "point" : fmt::format("point_{}", zipped_);
    } else {
      name = plan_.axis_title(dimension.axes.front());
    }
    const std::size_t axis = dimension.axes.front();
    add_scale(name, zipped ? hid_t{H5T_STD_I64LE} : type_of(plan_.axes()[axis].values));
    if (zipped) {
      write_numbers(scales_.back());
    } else {
      write_values(scales_.back(), axis);
    }
  }

  /// Adds the scale of the next dimension.
  void add_scale(const std::string& name, hid_t type) {
    const auto number = static_cast<std::int32_t>(scales_.size());
    Hdf5Handle scale = dataset(name, type, simple({shape_[scales_.size()]}));
    file_.check(H5DSset_scale(scale, name.c_str()));
    const Hdf5Handle space = file_.hold(H5Screate(H5S_SCALAR));
    const Hdf5Handle made = file_.hold(
        H5Acreate2(scale, "_Netcdf4Dimid", H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT));
    file_.check(H5Awrite(made, H5T_NATIVE_INT32, &number));
    scales_.push_back(std::move(scale));
  }

  /// The numbers of the points of the last dimension that was added.
  void write_numbers(const Hdf5Handle& scale) const {
    std::vector<std::int64_t> numbers(shape_[scales_.size() - 1]);
    std::iota(numbers.begin(), numbers.end(), std::int64_t{0});
    file_.check(H5Dwrite(scale, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()));
  }

  void add_axis_of_points(std::size_t axis) const {
    const Hdf5Handle made =
        variable(plan_.axis_title(axis), type_of(plan_.axes()[axis].values), {0});
    write_values(made, axis, order_.size(), [this](std::size_t k) { return order_.point(k); });
  }

  void add_zipped_axis(std::size_t d, std::size_t axis) const {
    write_values(variable(plan_.axis_title(axis), type_of(plan_.axes()[axis].values), {d}), axis);
  }

  /// Parts of all points in their order, each with its index among the dimensions: the first
  /// indices are fixed, the next one runs over a range, and the last ones over all values.
  void for_each_block(
      const std::function<void(std::size_t, const Hdf5Handle&, std::size_t)>& visit) const {
    std::size_t ranged = shape_.size();
    std::size_t inner = 1;  // points for one value of the ranged dimension
    do {
      --ranged;
      if (ranged + 1 < shape_.size()) inner *= shape_[ranged + 1];
    } while (ranged > 0 && inner * shape_[ranged] <= kElementsAtOnce);
    const std::size_t most = std::max<std::size_t>(1, kElementsAtOnce / inner);
    const Hdf5Handle space = simple(shape_);
    std::vector<hsize_t> from(shape_.size(), 0);
    std::vector<hsize_t> length = shape_;
    std::fill_n(length.begin(), ranged, hsize_t{1});
    for (std::size_t first = 0; first < order_.size();) {
      std::size_t rest = first / inner;
      for (std::size_t d = ranged + 1; d-- > 0; rest /= shape_[d]) from[d] = rest % shape_[d];
      length[ranged] = std::min<std::size_t>(most, shape_[ranged] - from[ranged]);
      file_.check(
          H5Sselect_hyperslab(space, H5S_SELECT_SET, from.data(), nullptr, length.data(), nullptr));
      const std::size_t count = length[ranged] * inner;
      visit(first, space, count);
      first += count;
    }
  }

  const SweepPlan& plan_;
  RowOrder order_;
  Hdf5File file_;
  Hdf5Handle strings_;  ///< their type
  std::vector<hsize_t> shape_;
  std::vector<Hdf5Handle> scales_;  ///< [dimension]
  std::size_t zipped_ = 0;
};

}  // namespace

void write_sweep_arrays(const std::filesystem::path& file, const SweepPlan& plan,
                        const SweepJournal& journal) {
  const std::lock_guard lock(hdf5_mutex());
  const Hdf5Silence silence;
  SweepArrays arrays(file, plan);
  arrays.write(journal);
  arrays.publish();
}

}  // namespace tomlin
