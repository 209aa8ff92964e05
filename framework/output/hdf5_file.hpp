#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

#include "framework/output/output_file.hpp"

/// The HDF5 library with owners for its handles and exceptions for its complaints.
namespace tomlin {

/// The library serves one thread at a time: whoever writes files in threads holds this meanwhile.
std::mutex& hdf5_mutex();

/// Owns an HDF5 handle of any kind; an empty one is negative.
class Hdf5Handle {
 public:
  Hdf5Handle() = default;
  explicit Hdf5Handle(hid_t id) : id_(id) {}
  ~Hdf5Handle() { close(); }
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    if (this == &other) return *this;
    close();
    id_ = std::exchange(other.id_, -1);
    return *this;
  }

  operator hid_t() const { return id_; }  // NOLINT: stands in for it in calls
  void close() {
    if (id_ >= 0) H5Idec_ref(std::exchange(id_, -1));
  }

 private:
  hid_t id_ = -1;
};

/// Numbers of a dataset, the last index fastest.
struct Hdf5Numbers {
  std::vector<hsize_t> shape;
  std::vector<double> numbers;
};

/// Reads a dataset by its path in a file, under hdf5_mutex(). Throws OutputError.
Hdf5Numbers read_hdf5(const std::filesystem::path& file, const char* dataset);

/// While one exists, the HDF5 library keeps its complaints to itself instead of printing them.
class Hdf5Silence {
 public:
  Hdf5Silence();
  ~Hdf5Silence();
  Hdf5Silence(const Hdf5Silence&) = delete;
  Hdf5Silence& operator=(const Hdf5Silence&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// A new HDF5 file that appears complete or not at all, see OutputFile. The library cannot close a
/// file that it cannot write; so it writes through a driver of ours that, once the disk has refused
/// a write, remembers the reason and takes everything else without writing it.
class Hdf5File {
 public:
  /// How the members of a group and the attributes of an object are listed.
  enum class Order { by_name, as_made };

  /// Opens NAME.part, which must not exist. Throws OutputError.
  explicit Hdf5File(const std::filesystem::path& file, Order order = Order::by_name);
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  hid_t root() const { return file_; }

  /// Takes what an HDF5 function returned: negative is an error. Throws OutputError with the
  /// disk's reason where there is one, and the library's otherwise. Call it with Hdf5Silence.
  template <class Returned>
  Returned check(Returned returned) const {
    if (returned < 0 || disk_.trouble) fail();
    return returned;
  }
  /// Checks a handle that has to be closed again.
  Hdf5Handle hold(hid_t id) const {
    Hdf5Handle handle(id);
    check(id);
    return handle;
  }

  /// All handles of the file are closed: it is complete and gets its name. Throws OutputError.
  void publish();

  /// Data that the driver works on.
  struct Disk {
    OutputFile output;
    std::optional<std::string> trouble;  ///< the first
  };

 private:
  [[noreturn]] void fail() const;

  std::string name_;
  Disk disk_;
  Hdf5Handle driver_;
  Hdf5Handle file_;
};

}  // namespace tomlin
