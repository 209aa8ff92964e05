#include "framework/output/hdf5_file.hpp"

#include <algorithm>
#include <memory>
#include <span>

#include <fmt/format.h>

#if __has_include(<H5FDdevelop.h>)
#include <H5FDdevelop.h>  // HDF5 1.14 has moved the interface of drivers there
#endif

namespace tomlin {
namespace {

using Disk = Hdf5File::Disk;

// ---- the driver: functions that the library calls, which must not throw

struct Driven {
  H5FD_t common;  // the library's part comes first
  Disk* disk;
  haddr_t allocated;  // the end of what the library has given out
  haddr_t end;        // of the file
};

Driven& driven(H5FD_t* file) { return *reinterpret_cast<Driven*>(file); }
const Driven& driven(const H5FD_t* file) { return *reinterpret_cast<const Driven*>(file); }

H5FD_t* open_driven(const char*, unsigned, hid_t properties, haddr_t) {
  const void* disk = H5Pget_driver_info(properties);
  if (disk == nullptr) return nullptr;
  return &std::make_unique<Driven>(Driven{{}, *static_cast<Disk* const*>(disk), 0, 0})
              .release()
              ->common;
}

herr_t close_driven(H5FD_t* file) {
  const std::unique_ptr<Driven> last(&driven(file));
  return 0;
}

herr_t features(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t allocated(const H5FD_t* file, H5FD_mem_t) { return driven(file).allocated; }

herr_t allocate(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  driven(file).allocated = end;
  return 0;
}

haddr_t end_of(const H5FD_t* file, H5FD_mem_t) { return driven(file).end; }

/// Keeps the first trouble; what follows it is not even tried.
template <class Action>
void attempt(Disk& disk, Action action) {
  if (disk.trouble) return;
  try {
    action();
  } catch (const OutputError& error) {
    disk.trouble = error.what();
  }
}

herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t offset, size_t size, void* bytes) {
  Disk& disk = *driven(file).disk;
  attempt(disk, [&] { disk.output.read_at(offset, {static_cast<std::byte*>(bytes), size}); });
  return disk.trouble ? -1 : 0;
}

herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t offset, size_t size, const void* bytes) {
  Driven& self = driven(file);
  attempt(*self.disk, [&] {
    self.disk->output.write_at(offset, {static_cast<const std::byte*>(bytes), size});
  });
  self.end = std::max<haddr_t>(self.end, offset + size);
  return 0;
}

herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  Driven& self = driven(file);
  attempt(*self.disk, [&] { self.disk->output.resize(self.allocated); });
  self.end = self.allocated;
  return 0;
}

H5FD_class_t driver() {
  H5FD_class_t driver = {};
#ifdef H5FD_CLASS_VERSION
  driver.version = H5FD_CLASS_VERSION;
  driver.value = static_cast<H5FD_class_value_t>(H5_VFD_RESERVED);
#endif
  driver.name = "tomlin_output";
  driver.maxaddr = static_cast<haddr_t>(HADDR_MAX) >> 1U;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.fapl_size = sizeof(Disk*);
  driver.open = &open_driven;
  driver.close = &close_driven;
  driver.query = &features;
  driver.get_eoa = &allocated;
  driver.set_eoa = &allocate;
  driver.get_eof = &end_of;
  driver.read = &read;
  driver.write = &write;
  driver.truncate = &truncate;
  constexpr H5FD_mem_t kinds[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(kinds), std::end(kinds), driver.fl_map);
  return driver;
}

/// The library's reason: where the trouble began.
std::string innermost_reason() {
  std::string reason;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned n, const H5E_error2_t* error, void* into) -> herr_t {
        if (n == 0 && error->desc != nullptr) *static_cast<std::string*>(into) = error->desc;
        return 0;
      },
      &reason);
  return reason.empty() ? "unknown trouble" : reason;
}

}  // namespace

std::mutex& hdf5_mutex() {
  static std::mutex mutex;
  return mutex;
}

Hdf5Silence::Hdf5Silence() {
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Silence::~Hdf5Silence() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

Hdf5File::Hdf5File(const std::filesystem::path& file, Order order)
    : name_(file.string() + std::string(kUnfinished)), disk_{OutputFile(file), {}} {
  const Hdf5Silence silence;
  static const H5FD_class_t kDriver = driver();
  driver_ = hold(H5FDregister(&kDriver));
  const Hdf5Handle access = hold(H5Pcreate(H5P_FILE_ACCESS));
  Disk* const disk = &disk_;
  check(H5Pset_driver(access, driver_, &disk));
  // Every HDF5 of this decade reads this version.
  check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18));
  const Hdf5Handle creation = hold(H5Pcreate(H5P_FILE_CREATE));
  // Equal runs leave the same bytes, whenever they are made.
  check(H5Pset_obj_track_times(creation, false));
  if (order == Order::as_made) {
    constexpr unsigned kAsMade = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
    check(H5Pset_link_creation_order(creation, kAsMade));
    check(H5Pset_attr_creation_order(creation, kAsMade));
  }
  file_ = hold(H5Fcreate(name_.c_str(), H5F_ACC_TRUNC, creation, access));
}

Hdf5File::~Hdf5File() {
  const Hdf5Silence silence;
  // A file that was not published is not worth its last bytes.
  if (file_ >= 0 && !disk_.trouble) disk_.trouble = "given up";
  file_.close();
}

void Hdf5File::publish() {
  {
    const Hdf5Silence silence;
    check(H5Fflush(file_, H5F_SCOPE_GLOBAL));
    check(H5Fget_obj_count(file_, H5F_OBJ_ALL | H5F_OBJ_LOCAL) == 1 ? 0 : -1);
    file_.close();
    check(0);
  }
  disk_.output.publish();
}

void Hdf5File::fail() const {
  throw OutputError(disk_.trouble
                        ? *disk_.trouble
                        : fmt::format("cannot write {}: HDF5: {}", name_, innermost_reason()));
}

Hdf5Numbers read_hdf5(const std::filesystem::path& file, const char* dataset) {
  const std::lock_guard lock(hdf5_mutex());
  const Hdf5Silence silence;
  const auto check = [&](auto returned) {
    if (returned >= 0) return returned;
    throw OutputError(fmt::format("cannot read {}: HDF5: {}", file.string(), innermost_reason()));
  };
  const Hdf5Handle opened(check(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)));
  const Hdf5Handle numbers(check(H5Dopen2(opened, dataset, H5P_DEFAULT)));
  const Hdf5Handle space(check(H5Dget_space(numbers)));
  Hdf5Numbers found;
  found.shape.resize(static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space))));
  check(H5Sget_simple_extent_dims(space, found.shape.data(), nullptr));
  found.numbers.resize(static_cast<std::size_t>(check(H5Sget_simple_extent_npoints(space))));
  check(H5Dread(numbers, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, found.numbers.data()));
  return found;
}

}  // namespace tomlin
